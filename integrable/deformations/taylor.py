"""Integration of vector fields by Taylor series, to any number of digits, with variable steps.

The recurrences of :mod:`integrable.series.recurrences` give the coefficients. The loops run interpreted on numbers of
any precision, and compiled on double-doubles. The last two coefficients determine the step (Jorba & Zou 2005).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, exp, log
from typing import Any, NamedTuple

import numpy as np

from integrable.moving_point.addition import Row
from integrable.series.recurrences import coefficients, values_at
from integrable.series.tape import CONSTANT, PRODUCT, QUOTIENT, ROOT, Tape
from jacobian.element import Real
from jacobian.errors import ArgumentError, Infeasible, PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.fields.protocol import Field
from jacobian.native.kinds import BOOL, FLOAT, FLOATS, INT, INTS, WIDES, TupleKind, record
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.double_double import double_double_row
from jacobian.numbers.long_reals import BareReals

# the remaining steps are estimated after KNOWN_FROM steps; the estimate may be wrong by the factor UNEVEN
KNOWN_FROM = 4
UNEVEN = 4
# reasons why :func:`march_along` stops before the last time: steps shrink to 0 (ENDS), or would be too many (FAR)
ENDS, FAR = 1, 2
# indices in the report of :func:`march_along`: number of steps, lengths of the first and of the current step, number of
# times reached
STEPS, LONGEST, STEP, REACHED = range(4)


class SeriesRoom(NamedTuple):
    """The memory of :func:`march_along`.

    ``middles`` are the values of all nodes at the expansion point, ``now`` is its time, ``series`` are the
    coefficients, and ``told`` is the report, with the indices STEPS, LONGEST, STEP and REACHED.
    """

    middles: Row
    now: Row
    series: Row
    told: Row


def march_along(
    tape: tuple[Row, Row, Row, Row], order: int, tolerance: float, most: float, strict: bool, room: SeriesRoom,
    times: Row, out: Row,
) -> int:  # fmt: skip
    """Writes the variables at ``times``, which ascend or descend from 0, to ``out``, row by row.

    Returns 0 if all times are reached, otherwise the reason ENDS or FAR. ``tolerance`` is the logarithm of the error
    allowed per step. ``most`` is the largest number of steps: to the last time if ``strict``, otherwise to each time.
    """
    count, told, now = len(tape[3]), room.told, room.now
    expand_about(tape, order, tolerance, room)
    for i in range(len(times)):
        told[REACHED] = i
        while abs(float(times[i] - now[0])) > told[STEP]:
            # the motion ends if a step, relative to the time reached, is below the error allowed per step
            if not told[STEP] > exp(tolerance) * max(told[LONGEST], abs(float(now[0]))):
                return ENDS
            if too_long(told, most, float(now[0]), float(times[len(times) - 1 if strict else i])):
                return FAR
            step = told[STEP] if float(times[i]) > 0 else -told[STEP]
            values_at(0 * now[0] + step, order, room.series, count, room.middles, 0)
            now[0] = now[0] + step
            expand_about(tape, order, tolerance, room)
        values_at(times[i] - now[0], order, room.series, count, out, i * count)
    told[REACHED] = len(times)
    return 0


def expand_about(tape: tuple[Row, Row, Row, Row], order: int, tolerance: float, room: SeriesRoom) -> None:
    """Expands the series about the state in ``room.middles``, and stores the step that it allows."""
    kinds, left, right, rates = tape
    for n in range(len(room.middles)):
        room.series[n * (order + 1)] = room.middles[n]
    coefficients(kinds, left, right, rates, 0, order, 1, room.series)
    room.told[STEPS] += 1
    room.told[STEP] = step_within(order, tolerance, len(rates), room.series)
    if room.told[LONGEST] == 0:
        room.told[LONGEST] = room.told[STEP]


def step_within(order: int, tolerance: float, count: int, series: Row) -> float:
    """The largest step at which the last two terms of the series are below exp(``tolerance``); 0 if they are NaN.

    Terms are measured relative to the largest of the three variables of a vector.
    """
    width, found, most = order + 1, 1e300, abs(series[0])
    for n in range(1, count):
        most = max(most, abs(series[n * width]))
    for first in range(0, count, 3):
        last, size = min(first + 3, count), abs(series[first * width])
        for n in range(first + 1, last):
            size = max(size, abs(series[n * width]))
        # a vector that is 0 is measured relative to the largest variable
        size = size if size > 0 else most
        for k in range(order - 1, order + 1):
            part = 0.0
            for n in range(first, last):
                x = float(abs(series[n * width + k]) / size)
                part = x if not x <= part else part
            if part != part:
                return 0.0
            if part > 0:
                found = min(found, exp((tolerance - log(part)) / k))
    return found


def too_long(told: Row, most: float, now: float, end: float) -> bool:
    """Whether the steps so far exceed ``most``, or those expected until ``end`` exceed UNEVEN times ``most``."""
    part = abs(now / end)
    expected = told[STEPS] / part if told[STEPS] >= KNOWN_FROM and part > 0 else 0.0
    return told[STEPS] > most or expected > UNEVEN * most


_TAPE, _ROOM = TupleKind((INTS, INTS, INTS, INTS)), record(SeriesRoom, WIDES, WIDES, WIDES, FLOATS)
LIBRARY = Library(
    "taylor_series", {"march": (march_along, (_TAPE, INT, FLOAT, FLOAT, BOOL, _ROOM, WIDES, WIDES))}, SPECIAL
)


DOUBLE_DOUBLE = 28
"""Largest number of digits for which double-doubles are used."""


class _Interpreted:
    """The loops on bare reals with the digits of the field."""

    # ``most`` products of coefficients take half a minute; a step has the overhead of ``overhead`` products
    most, overhead = 3e7, 500

    def __init__(self, field: MultiprecisionField) -> None:
        self._field, self._reals = field, BareReals(field.context.prec)

    def tape(self, arrays: tuple[list[int], ...]) -> tuple[Row, ...]:
        return arrays

    def row(self, values: Sequence[Real]) -> Row:
        return list(self._reals.row(values))

    def room(self, count: int) -> Row:
        return [self._reals.number(0)] * count

    def wide(self, values: Row) -> list[Real]:
        return list(self._reals.elements(self._field, values))

    def march(self, *arguments: Any) -> int:
        with self._reals:
            return march_along(*arguments)


class _Compiled:
    """The loops compiled for double-doubles."""

    # ``most`` products of coefficients take a second; the overhead of a step takes as long as ``overhead`` products
    most, overhead = 6e7, 3e4

    def __init__(self, field: MultiprecisionField) -> None:
        self._field, self.march = field, LIBRARY.march

    def tape(self, arrays: tuple[list[int], ...]) -> tuple[Row, ...]:
        return tuple(np.array(x, dtype=np.int64) for x in arrays)

    def row(self, values: Sequence[Real]) -> Row:
        return double_double_row(values)

    def room(self, count: int) -> Row:
        return np.zeros((count, 2))

    def wide(self, values: Row) -> list[Real]:
        if not np.isfinite(values).all():
            return [self._field.context.nan] * len(values)
        made = self._field.context.mpf
        return [made(high) + low for high, low in values.tolist()]


def integrate(
    field: Field,
    tape: Tape,
    start: Sequence[Real],
    times: Sequence[Real],
    digits: int,
    refused: dict[int, str] | None = None,
    unit: float = 1.0,
) -> list[list[Real]]:
    """The variables at ``times``, in any order and of either sign, from ``start`` at time 0: numbers of an MP field.

    The truncation error of a step is below 10^−digits, relative to the largest of the three variables of a vector.
    PrecisionLoss if steps shrink to 10^−digits of the first step or of the time, as at a singularity; Infeasible if
    there would be too many steps. ``refused``, if given, receives the index and the reason of each time that fails.
    Reasons state times multiplied by ``unit``, as the user gave them.
    """
    rows: list[list[Real]] = [list(start)] * len(times)
    compiled = digits <= DOUBLE_DOUBLE and not interpreted()
    for sign in (1, -1):
        order = sorted((i for i in range(len(times)) if sign * times[i] > 0), key=lambda i: abs(times[i]))
        if not order:
            continue
        problem = field, tape, start, [times[i] for i in order], digits, refused is None, unit
        try:
            found, why = _marched(_Compiled if compiled else _Interpreted, *problem)
        except ArgumentError:
            # some numbers are beyond the range of floats
            found, why = _marched(_Interpreted, *problem)
        for i, row in zip(order, found, strict=False):
            rows[i] = row
        if why:
            if refused is None:
                raise why
            refused.update(dict.fromkeys(order[len(found) :], str(why)))
    return rows


def _marched(
    kind: type[_Interpreted] | type[_Compiled],
    field: Any,
    tape: Tape,
    start: Sequence[Real],
    times: Sequence[Real],
    digits: int,
    strict: bool,
    unit: float,
) -> tuple[list[list[Real]], Exception | None]:
    """The variables at the times that were reached, and the error that describes why later times were not, or None."""
    loops, count = kind(field), len(start)
    # with steps of e⁻² times the radius of convergence, the neglected terms are of the size e^(−2·order)
    order = ceil(digits * log(10) / 2) + 2
    products = sum(k in (PRODUCT, QUOTIENT, ROOT) for k in tape.kinds)
    work = order * (order / 2 * products + len(tape.kinds)) + loops.overhead
    most = loops.most / work
    constants = [field.coerce(x) if k == CONSTANT else 0 for k, x in zip(tape.kinds, tape.constants, strict=True)]
    packed = loops.tape((tape.kinds, tape.left, tape.right, tape.results))
    middles = loops.row([*start, *constants[count:]])
    room = SeriesRoom(middles, loops.room(1), loops.room(len(middles) * (order + 1)), np.zeros(4))
    out = loops.room(len(times) * count)
    status = loops.march(packed, order, -digits * log(10), most, strict, room, loops.row(times), out)
    done = int(room.told[REACHED])
    values = [loops.wide(out[i * count : (i + 1) * count]) for i in range(done)]
    if status == 0:
        return values, None
    now, time = unit * float(loops.wide(room.now)[0]), unit * float(times[done])
    if status == ENDS:
        return values, PrecisionLoss(
            f"times: the motion ends, or cannot be followed, near t = {now:g}, before {time:g}"
        )
    end = unit * float(times[-1]) if strict else time
    return values, Infeasible(
        f"times: the equations of motion are integrated, and t = {end:g} takes more than {most:.0f} steps; about |t| = "
        f"{abs(now) * most / room.told[STEPS]:.2g} is within reach"
    )
