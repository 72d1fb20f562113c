"""The walk of a kind of systems along its tape, with the interface of a compiled one, until compiling pays off."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from integrable.series.room import FIRST, UNITS
from integrable.series.steps import Reached, Steps, bounds_of, inverses
from integrable.series.symbols import Key, key_of
from integrable.series.tape import (
    CONSTANT,
    DIFFERENCE,
    GROWTH,
    MULTIPLE,
    PRODUCT,
    QUOTIENT,
    ROOT,
    SUM,
    VARIABLE,
    Tape,
)
from integrable.series.taped import Lines, OnTape
from integrable.series.walk import LANES, Bounds, Given
from integrable.series.walk_text import MOVED, TIMES
from jacobian.inexact.long_field import LongField
from jacobian.numbers.double_double import split

# precision in bits of constants and of start values
BITS = 128
OPERATIONS: dict[Any, Callable[[Any, Any], Any]] = {
    SUM: lambda x, y: x + y,
    DIFFERENCE: lambda x, y: x - y,
    MULTIPLE: lambda x, y: x * y,
    PRODUCT: lambda x, y: x * y,
    QUOTIENT: lambda x, y: x / y,
}
OF_CONSTANTS = {"+": SUM, "-": DIFFERENCE, "*": PRODUCT, "/": QUOTIENT}


class TapeWalk:
    """The counterpart of :class:`integrable.series.kinds.Compiled` that interprets the recorded formulas of a kind."""

    def __init__(self, rates: Tape, start: Tape, half: int) -> None:
        self._rates, self._start, self._half = rates, start, half
        self._tape = tuple(np.array(x, dtype=np.int64) for x in (rates.kinds, rates.left, rates.right, rates.results))

    def __call__(
        self, constants: np.ndarray, state: Sequence[float], times: np.ndarray, steps: Steps, most: float
    ) -> Reached:
        """The states at times of one sign in ascending size; the number reached is −1 if they are not so ordered."""
        from integrable.series.walk_compiled import ON_TAPES

        half, (wide, order), parts = self._half, steps.orders, len(state) // self._half
        begin, width = self._begun(constants, state), parts * half
        count, highs = len(begin), UNITS + order + wide + 1
        spare = LANES * (highs + width * (FIRST + 2))
        floats, values = np.empty((count * (order + 1), LANES)), np.zeros((2, 2 * LANES))
        lines = Lines(
            self._tape, begin, np.empty((count, 2 * LANES)), np.empty((count * (wide + 1), 2 * LANES)), floats, values,
            floats.reshape(-1), values.reshape(-1), wide, order, width, highs,
        )  # fmt: skip
        given = Given(np.empty(0), np.empty(0), half, parts, order, highs, wide, spare, width)
        again, found = np.empty(4 * (len(times) + TIMES) * width), np.empty((len(times), parts, half))
        reached, wrong, gap, done = ON_TAPES.walked(
            OnTape(lines, lines, lines, lines), Bounds(*bounds_of(steps, most)), given, np.zeros(spare + 2 * TIMES),
            inverses(order), times, again, found.reshape(-1),
        )  # fmt: skip
        off = again.reshape(-1, 2 * width)[:reached, 0] != 0 if wrong else None
        return Reached(reached, found, off, gap, done)

    def _begun(self, constants: np.ndarray, state: Sequence[float]) -> np.ndarray:
        """The values of all variable and constant nodes at the start, for both walks."""
        with LongField(BITS) as N:
            variables = _results(N, self._start, constants, [N.coerce(x) for x in state])
            further = _constants(N, self._rates, constants)
            middles = np.array([split(x) for x in variables + further[len(variables) :]])
        moved = middles.copy()
        # relative changes differ between nodes, because equal ones could amount to a mere change of units
        moved[:, 1] += MOVED * (np.arange(len(middles)) % 5 - 2.5) * middles[:, 0]
        return np.stack([middles, moved], axis=-1).reshape(-1, 2 * LANES)


def _constants(N: LongField, tape: Tape, constants: np.ndarray) -> list[Any]:
    """The values of the constant nodes of a tape, and 0 for the others."""
    return [
        _number(N, key_of(x), constants) if kind == CONSTANT else N.zero
        for kind, x in zip(tape.kinds, tape.constants, strict=True)
    ]


def _number(N: LongField, key: Key, constants: np.ndarray) -> Any:
    sign, *rest = key
    if sign == "constant":
        return N.coerce(float(constants[rest[0]]))
    if sign == "number":
        return N.coerce(rest[0])
    return OPERATIONS[OF_CONSTANTS[sign]](*(_number(N, each, constants) for each in rest))


def _results(N: LongField, tape: Tape, constants: np.ndarray, given: Sequence[Any]) -> list[Any]:
    """The results of a tape for the given variables."""
    import gmpy2

    found = _constants(N, tape, constants)
    for n, (kind, p, q) in enumerate(zip(tape.kinds, tape.left, tape.right, strict=True)):
        if kind == VARIABLE:
            found[n] = given[n]
        elif kind == ROOT:
            found[n] = N.sqrt(found[p])
        elif kind == GROWTH:
            found[n] = gmpy2.expm1(found[p])
        elif kind != CONSTANT:
            found[n] = OPERATIONS[kind](found[p], found[q])
    return [found[n] for n in tape.results]
