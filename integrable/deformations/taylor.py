"""Taylor series of any vector field that is rational in its variables, of any number of digits: variable steps.

The coefficients by the recurrences of :mod:`integrable.deformations.series`, interpreted on numbers of any precision
or compiled for double-double numbers, the steps from the last two of them (Jorba & Zou 2005).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, inf, log
from typing import Any, Protocol

import numpy as np

from integrable.deformations.series import coefficients, values_at
from integrable.deformations.tape import CONSTANT, PRODUCT, QUOTIENT, ROOT, Tape
from jacobian.errors import ArgumentError, Infeasible, PrecisionLoss
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.double_double import split
from jacobian.numbers.long_reals import BareReals

__all__ = ["integrate"]

MOST_OPERATIONS = {"compiled": 6e7, "interpreted": 3e7}
"""Products of coefficients that a motion may take: about a second compiled, half a minute interpreted."""
OVERHEAD = {"compiled": 3e4, "interpreted": 500}
"""What a step takes besides, in such products."""
DOUBLE_DOUBLE = 28
"""Digits that double-double numbers are good for."""
SMALLEST_STEP = 1e-6
# steps from which on what is left is judged from what is done, and the factor by which they may differ
KNOWN_FROM = 4
UNEVEN = 4


class _Loops(Protocol):
    """The loops on one kind of numbers."""

    kind: str

    def tape(self, arrays: Any) -> Any: ...
    def row(self, values: Sequence[Any]) -> Any: ...
    def room(self, count: int) -> Any: ...
    def wide(self, values: Any) -> list[Any]: ...
    def coefficients(self, tape: Any, order: int, series: Any) -> None: ...
    def values_at(self, x: Any, order: int, series: Any, out: Any) -> None: ...


class _Interpreted:
    kind = "interpreted"

    def __init__(self, field: Any) -> None:
        self._field, self._reals = field, BareReals(field.context.prec)

    def tape(self, arrays: Any) -> Any:
        return arrays

    def row(self, values: Sequence[Any]) -> Any:
        return list(self._reals.row(values))

    def room(self, count: int) -> Any:
        return [self._reals.number(0)] * count

    def wide(self, values: Any) -> list[Any]:
        return list(self._reals.elements(self._field, values))

    def coefficients(self, tape: Any, order: int, series: Any) -> None:
        kinds, left, right, rates = tape
        with self._reals:
            coefficients(kinds, left, right, rates, order, series)

    def values_at(self, x: Any, order: int, series: Any, out: Any) -> None:
        with self._reals:
            values_at(x, order, series, out)


class _Compiled:
    kind = "compiled"

    def __init__(self, field: Any) -> None:
        from integrable.deformations.series_compiled import LIBRARY

        self._field = field
        self.values_at: Any = LIBRARY.values_at
        self._coefficients: Any = LIBRARY.coefficients

    def tape(self, arrays: Any) -> Any:
        return tuple(np.array(x, dtype=np.int64) for x in arrays)

    def row(self, values: Sequence[Any]) -> Any:
        return np.array([split(x) for x in values])

    def room(self, count: int) -> Any:
        return np.zeros((count, 2))

    def wide(self, values: Any) -> list[Any]:
        if not np.isfinite(values).all():
            return [self._field.context.nan] * len(values)
        return [self._field.coerce(high) + self._field.coerce(low) for high, low in values.tolist()]

    def coefficients(self, tape: Any, order: int, series: Any) -> None:
        self._coefficients(*tape, order, series)


def integrate(
    field: Any,
    tape: Tape,
    start: Sequence[Any],
    times: Sequence[Any],
    digits: int,
    refused: dict[int, str] | None = None,
) -> list[list[Any]]:
    """The variables at ``times``, in any order and of either sign, from ``start`` at time 0: numbers of MP field.

    What a step neglects is below 10^−digits of the largest variable of its third of them. PrecisionLoss where the steps
    shrink to a millionth of the first, as at a singularity; Infeasible where they would be too many; into ``refused``,
    if given, the index of each such time and the reason.
    """
    rows: list[list[Any]] = [list(start)] * len(times)
    for sign in (1, -1):
        order = sorted((i for i in range(len(times)) if sign * times[i] > 0), key=lambda i: abs(times[i]))
        run = None
        for k, i in enumerate(order):
            try:
                run = run or _run(field, tape, start, digits)
                rows[i] = run.at(times[i], times[order[-1] if refused is None else i])
            except (PrecisionLoss, Infeasible) as error:
                if refused is None:
                    raise
                refused.update(dict.fromkeys(order[k:], str(error)))
                break
    return rows


def _run(field: Any, tape: Tape, start: Sequence[Any], digits: int) -> _Run:
    if digits <= DOUBLE_DOUBLE and not interpreted():
        try:
            return _Run(_Compiled(field), field, tape, start, digits)
        except ArgumentError:
            # numbers beyond the range of floats
            pass
    return _Run(_Interpreted(field), field, tape, start, digits)


class _Run:
    """One integration from time 0 in one direction."""

    def __init__(self, loops: _Loops, field: Any, tape: Tape, start: Sequence[Any], digits: int) -> None:
        self._loops, self._field, self._count = loops, field, len(start)
        self._tape = loops.tape((tape.kinds, tape.left, tape.right, tape.results))
        constants = [field.coerce(x) if k == CONSTANT else 0 for k, x in zip(tape.kinds, tape.constants, strict=True)]
        self._middles = loops.row(constants)
        # a step of radius/e² neglects e^{-2·order}
        self._order = ceil(digits * log(10) / 2) + 2
        self._tolerance = 10.0**-digits
        products = sum(k in (PRODUCT, QUOTIENT, ROOT) for k in tape.kinds)
        self._work = self._order * (self._order / 2 * products + len(tape.kinds)) + OVERHEAD[loops.kind]
        self._steps, self._first = 0, 0.0
        self._now = field.zero
        self._expand(list(start))

    def _expand(self, values: list[Any]) -> None:
        """The series about the state at the present time, and how far it reaches."""
        width = self._order + 1
        self._middles[: self._count] = self._loops.row(values)
        self._series = self._loops.room(len(self._middles) * width)
        self._series[::width] = self._middles
        self._loops.coefficients(self._tape, self._order, self._series)
        self._steps += 1
        self._step = self._reach(values)
        self._first = self._first or self._step

    def _reach(self, values: list[Any]) -> float:
        """The step after which the last two coefficients are as small as asked for."""
        width, reach = self._order + 1, inf
        for first in range(0, self._count, 3):
            group = values[first : first + 3]
            # what is at rest is measured by the others
            size = max(map(abs, group)) or max(map(abs, values))
            for k in (self._order - 1, self._order):
                last = self._loops.wide(self._series[first * width + k : (first + len(group)) * width : width])
                part = float(max(map(abs, last)) / size)
                if part != part:
                    return 0.0
                if part > 0:
                    reach = min(reach, (self._tolerance / part) ** (1 / k))
        return reach

    def at(self, time: Any, end: Any) -> list[Any]:
        """The variables at ``time``, farther from 0 than any before, on the way to ``end``."""
        while abs(time - self._now) > self._step:
            if not self._step > 0 or self._step < SMALLEST_STEP * self._first:
                raise PrecisionLoss(
                    f"times: the motion ends, or cannot be followed, near t = {float(self._now):g}, before "
                    f"{float(time):g}"
                )
            self._check_work(end)
            step = self._step if time > 0 else -self._step
            values = self._value(self._field.coerce(step))
            self._now += self._field.coerce(step)
            self._expand(values)
        return self._value(time - self._now)

    def _value(self, x: Any) -> list[Any]:
        out = self._loops.room(self._count)
        self._loops.values_at(self._loops.row([x]), self._order, self._series, out)
        return self._loops.wide(out)

    def _check_work(self, end: Any) -> None:
        """Infeasible where the work done, or what the steps so far lead to expect, is too much."""
        most = MOST_OPERATIONS[self._loops.kind] / self._work
        part = abs(float(self._now / end))
        expected = self._steps / part if self._steps >= KNOWN_FROM and part else 0
        if self._steps > most or expected > UNEVEN * most:
            reach = abs(float(self._now)) * most / self._steps
            raise Infeasible(
                f"times: the equations of motion are integrated, and t = {float(end):g} takes more than "
                f"{most:.0f} steps; about |t| = {reach:.2g} is within reach"
            )
