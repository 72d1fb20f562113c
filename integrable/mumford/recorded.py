"""The formulas that convert states of one kind of system to pairs (U, V) and back, recorded once as tapes.

An operation of a formula in Python takes microseconds. Evaluated from its tape it takes a tenth of that in long
numbers, and nanoseconds in double-doubles, where a compiled loop applies the tape to many pairs at once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import repeat
from math import log
from typing import Any

import gmpy2
import numpy as np

from integrable.moving_point.addition import Row
from integrable.moving_point.compiled import SPECIAL
from integrable.mumford.columns import Column
from integrable.mumford.motion import Start, Vectors
from integrable.portrait.oval_pairs import LiftedPairs, numbers_of, renewed
from integrable.series.symbols import Key, Symbol, SymbolField
from integrable.series.tape import (
    CONSTANT,
    DIFFERENCE,
    GROWTH,
    OPERATIONS,
    QUOTIENT,
    ROOT,
    SUM,
    VARIABLE,
    Recorded,
    Tape,
    recorded,
)
from jacobian.element import Real
from jacobian.inexact.long_field import LongField
from jacobian.native.kinds import INTS, WIDES
from jacobian.native.library import Library
from jacobian.numbers.abreast import abreast
from jacobian.numbers.double_double import double_double_row
from jacobian.numbers.roots import root
from jacobian.relatives.extended import Extended, Lift

# operations that only tapes of this module have
EXPONENTIAL, LOGARITHM = GROWTH + 1, GROWTH + 2
# the number of pairs to which the loop applies each operation of a tape in turn: so few that all values stay in a cache
BLOCK = 128


class PairField(SymbolField):
    """The field over which formulas are recorded."""

    class context(SymbolField.context):
        @staticmethod
        def exp(x: Recorded) -> Recorded:
            return x.function(EXPONENTIAL)

        @staticmethod
        def log(x: Recorded) -> Recorded:
            return x.function(LOGARITHM)


class PairFormulas:
    """The formulas of one kind of system.

    y are ``count`` numbers: q and p, then the constants and parameters of the system. ``start``(N, y) returns (q, p),
    projected onto its constraints, and the start of the motion; ``back``(N, y, D, time) returns (q, p) at a pair D of
    the motion. TypeError or ArgumentError if one of them calls a function that cannot be recorded.
    """

    def __init__(
        self,
        start: Callable[[PairField, Sequence[Real]], tuple[Vectors, Start]],
        back: Callable[[PairField, Sequence[Real], Extended, Real], Vectors],
        count: int,
    ) -> None:
        N, self._back, self._count, self._on_ovals = PairField(), back, count, dict[LiftedPairs, PointFormulas]()
        self._shape: tuple[Vectors, Start]

        def started(y: Sequence[Real]) -> list[Real]:
            self._shape = start(N, y)
            inner, found = self._shape
            return [*flat(inner), *flat(parts_of(found))]

        self._start = LongTape(recorded(started, count))
        _, found = self._shape
        pair = found.u[:-1], found.v, found.data

        def read(y: Sequence[Real]) -> list[Real]:
            values = iter(y[count:])
            u, v, data = shaped(pair, values)
            return [*flat(back(N, y[:count], Extended((*u, N.one), v, data), next(values)))]

        self.back = PointFormulas(recorded(read, count + len([*flat(pair)]) + 1), count)
        """``back`` at many pairs; the fixed variables are y, with q and p projected onto their constraints."""

    def start(self, N: LongField, numbers: Sequence[Real]) -> tuple[Vectors, Start]:
        """(q, p) and the start of a motion in long numbers."""
        results, (inner, found) = iter(self._start(N, numbers)), self._shape
        vectors, (f, u, v, direction, ends, data) = shaped(inner, results), shaped(parts_of(found), results)
        places = iter(ends)
        kinds = [Lift(next(places)) if isinstance(kind, Lift) else kind for kind in found.kinds]
        return vectors, Start(f, u, v, direction, kinds, data)

    def states(self, fixed: Row, D: Extended, times: np.ndarray) -> np.ndarray:
        """The states of N pairs, each at its own time: q and p, shape (N, 2, n). Every number of ``D`` is a
        :class:`integrable.mumford.columns.Column` of N numbers; ``fixed`` is the result of :meth:`PointFormulas.fixed`.
        """
        return self.back.states(fixed, [*flat((D.u[:-1], D.v, D.data))], times)

    def on_ovals(self, pairs: LiftedPairs) -> PointFormulas:
        """The formulas of states from points in ovals, whose variables are (sin ½φ, cos ½φ) of each point and the time.
        The fixed variables are those of :attr:`back`, then the numbers of ``pairs``.
        """
        shape, count, start = renewed(pairs, repeat(0.0)), self._count, self._count + len([*numbers_of(pairs)])

        def read(y: Sequence[Real]) -> list[Real]:
            own, halves = renewed(pairs, iter(y[count:start])), zip(y[start:-1:2], y[start + 1 : -1 : 2], strict=True)
            return [*flat(self._back(PairField(), y[:count], own.at(PairField(), [*halves]), y[-1]))]

        if shape not in self._on_ovals:
            self._on_ovals[shape] = PointFormulas(recorded(read, start + 2 * len(pairs.pairs.ovals) + 1), start)
        return self._on_ovals[shape]


class PointFormulas:
    """The formulas of a tape, applied in double-doubles to many points of a motion at once. The first ``count``
    variables are the same at all points.
    """

    def __init__(self, tape: Tape, count: int) -> None:
        self._codes, self._results, fixed = divided(tape, count)
        self._fixed, self._rooms = LongTape(fixed), list[np.ndarray]()

    def fixed(self, N: LongField, numbers: Sequence[Real]) -> Row:
        """The values of all operations that depend on the first ``count`` variables only, in double-doubles."""
        return double_double_row(self._fixed(N, numbers)).reshape(-1, 2)

    def states(self, fixed: Row, rows: Sequence[Column | Real | np.ndarray], times: np.ndarray) -> np.ndarray:
        """The results as (q, p), shape (N, 2, n), where the last variable is the time. ``rows`` are the others:
        columns, numbers, or double-doubles (N, 2).
        """
        given = np.zeros((len(rows) + 1, len(times), 2))
        given[-1, :, 0] = times
        for row, x in zip(given, rows, strict=False):
            if isinstance(x, np.ndarray):
                row[:] = x
            else:
                row[:, 0], row[:, 1] = (x := Column.of(x)).hi, x.lo
        return self.at(fixed, given)[:, :, 0].reshape(len(times), 2, -1)

    def at(self, fixed: Row, given: np.ndarray) -> np.ndarray:
        """The results at N points, (N, results, 2). ``given``: the variables from ``count`` on, (variables, N, 2)."""
        (variables, count, _), codes, wide = given.shape, self._codes, len(self._results)
        out = np.empty((count * wide, 2))
        # memory is reused, because to allocate it takes as long as the operations on several points
        try:
            room = self._rooms.pop()
        except IndexError:
            room = np.empty(((len(fixed) + variables + len(codes) // 3) * BLOCK, 2))
        LIBRARY.applied(codes, self._results, fixed, given.reshape(-1, 2), room, out)
        self._rooms.append(room)
        return out.reshape(count, wide, 2)


def parts_of(start: Start) -> tuple[Sequence[Any], ...]:
    ends = tuple([kind.e for kind in start.kinds if isinstance(kind, Lift)])
    return start.f, start.u, start.v, tuple(start.direction), ends, start.data


def flat(parts: Any) -> Iterator[Any]:
    """The numbers in nested tuples."""
    for x in parts:
        if isinstance(x, tuple):
            yield from flat(x)
        else:
            yield x


def shaped(shape: Sequence[Any], values: Iterator[Real]) -> tuple[Any, ...]:
    """Nested tuples of the given ``shape``, filled with the next ``values``."""
    return tuple([shaped(x, values) if isinstance(x, tuple) else next(values) for x in shape])


def divided(tape: Tape, count: int) -> tuple[np.ndarray, np.ndarray, Tape]:
    """Divides a tape into the operations that depend on a variable after the first ``count``, and all others.

    The result is the ``codes`` and ``results`` of :func:`applied` for the dependent operations, and a tape whose
    results are the ``fixed`` numbers of :func:`applied`. TypeError if a dependent operation is an exponential, which no
    compiled loop computes.
    """
    fixed = list[bool]()
    for kind, left, right in tape.nodes:
        variable = kind == VARIABLE and -1 - left >= count
        fixed.append(not variable and (kind in (VARIABLE, CONSTANT) or (fixed[left] and fixed[right])))
    operations = [n for n, kind in enumerate(tape.kinds) if not fixed[n] and kind != VARIABLE]
    if any(tape.kinds[n] in (GROWTH, EXPONENTIAL) for n in operations):
        raise TypeError("an exponential of the numbers of a pair")
    used = {side for n in operations for side in (tape.left[n], tape.right[n])} | set(tape.results)
    shared = sorted(n for n in used if fixed[n])
    variables = {-1 - tape.left[n]: n for n, kind in enumerate(tape.kinds) if kind == VARIABLE}
    order = [*shared, *(variables[k] for k in range(count, len(variables))), *operations]
    place = {n: k for k, n in enumerate(order)}
    codes = [x for n in operations for x in (tape.kinds[n], place[tape.left[n]], place[tape.right[n]])]
    results = [place[n] for n in tape.results]
    return np.array(codes, dtype=np.int64), np.array(results, dtype=np.int64), tape._replace(results=shared)


class LongTape:
    """The nodes of a tape on which its results depend, for evaluation in long numbers."""

    def __init__(self, tape: Tape) -> None:
        functions = {ROOT: gmpy2.sqrt, GROWTH: gmpy2.expm1, EXPONENTIAL: gmpy2.exp, LOGARITHM: gmpy2.log}
        # the node of a function of one number has this number both as its left and as its right operand
        operations = OPERATIONS | {kind: lambda x, _, f=f: f(x) for kind, f in functions.items()}
        self._results, used = tape.results, set(tape.results)
        self._variables, self._constants = list[tuple[int, int]](), list[tuple[int, Any]]()
        self._operations = list[tuple[Callable[[Any, Any], Any], int, int, int]]()
        for n, (kind, left, right) in reversed(list(enumerate(tape.nodes))):
            if n not in used:
                continue
            if kind == VARIABLE:
                self._variables.append((n, -1 - left))
            elif kind == CONSTANT:
                self._constants.append((n, tape.constants[n]))
            else:
                used |= {left, right}
                self._operations.append((operations[kind], n, left, right))
        self._operations.reverse()
        self._known = dict[int, list[Real]]()
        self._size = len(tape.kinds)

    def __call__(self, N: LongField, given: Sequence[Real]) -> list[Real]:
        """The results for variables given as numbers of any kind."""
        found = [*(self._known.get(N.bits) or self._known.setdefault(N.bits, self._constants_in(N)))]
        for n, k in self._variables:
            found[n] = N.coerce(given[k])
        for operation, n, left, right in self._operations:
            found[n] = operation(found[left], found[right])
        return [found[n] for n in self._results]

    def _constants_in(self, N: LongField) -> list[Real]:
        found = [N.zero] * self._size
        for n, x in self._constants:
            found[n] = of_key(N, x.key) if isinstance(x, Symbol) else N.coerce(x)
        return found


def of_key(N: LongField, key: Key) -> Real:
    """The value of the symbol with this ``key``: a number, or an operation on the values of two keys."""
    if key[0] == "number":
        return N.coerce(key[1])
    return OPERATIONS[key[0]](of_key(N, key[1]), of_key(N, key[2]))


def applied(codes: Row, results: Row, fixed: Row, given: Row, room: Row, out: Row) -> None:
    """Evaluates a tape at all points and writes its results to ``out``.

    The values of the tape are numbered: first the ``fixed`` numbers, then the variables, then the values of the
    operations. ``codes`` has a triple (kind, left, right) for each operation, with the numbers of its two operands;
    ``results`` are the numbers of the results. ``given`` has for each variable its values at all points. ``room`` is
    memory for every value of the tape at BLOCK points.
    """
    count, wide = len(out) // len(results), len(results)
    variables = len(given) // count
    for begin in range(0, count, BLOCK):
        points = min(BLOCK, count - begin)
        for n in range(len(fixed)):
            for i in abreast(0, points):
                room[BLOCK * n + i] = fixed[n]
        for n in range(variables):
            for i in abreast(0, points):
                room[BLOCK * (len(fixed) + n) + i] = given[count * n + begin + i]
        for n in range(len(codes) // 3):
            here = BLOCK * (len(fixed) + variables + n)
            operate(codes[3 * n], BLOCK * codes[3 * n + 1], BLOCK * codes[3 * n + 2], room, here, points)
        for k in range(wide):
            for i in abreast(0, points):
                out[wide * (begin + i) + k] = room[BLOCK * results[k] + i]


def operate(kind: int, left: int, right: int, room: Row, here: int, points: int) -> None:
    """Sets room[here + i] to the result of an operation on room[left + i] and room[right + i], i = 0 … points − 1."""
    if kind == SUM:
        for i in abreast(0, points):
            room[here + i] = room[left + i] + room[right + i]
    elif kind == DIFFERENCE:
        for i in abreast(0, points):
            room[here + i] = room[left + i] - room[right + i]
    elif kind == QUOTIENT:
        for i in abreast(0, points):
            room[here + i] = room[left + i] / room[right + i]
    elif kind == ROOT:
        for i in abreast(0, points):
            room[here + i] = root(room[left + i])
    elif kind == LOGARITHM:
        for i in abreast(0, points):
            x = float(room[left + i])
            # log(x) is only a float, which suffices because results are rounded to floats
            room[here + i] = log(x) + (room[left + i] - x) / x
    else:
        for i in abreast(0, points):
            room[here + i] = room[left + i] * room[right + i]


LIBRARY = Library("recorded", {"applied": (applied, (INTS, INTS, WIDES, WIDES, WIDES, WIDES))}, SPECIAL)
