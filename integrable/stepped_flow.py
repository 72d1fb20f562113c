"""The flow in floats near its start, without compiling anything: additions of tabled translations, time by steps.

T of about 2^k basic steps are made once in extended precision, so that a time is reached in as many additions as its
number of steps has binary digits. Physical time comes from :mod:`integrable.clock`.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable import flow_kernel
from integrable.clock import Clock
from integrable.precise_flow import vectors
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.flow_setup import Setup

# motions are carried this many basic steps; beyond, the corners of the torus cost less
FARTHEST = 256
# the error of γ that floats may make on the way there, that of their clock included
WORST = 1e-13


class SteppedFlow:
    """γ and M near the start of a motion in floats: readable loops, in the user's units."""

    def __init__(self, setup: Setup) -> None:
        self.setup = setup
        self._clocks = {sign: Clock(setup, sign) for sign in (1, -1)} if setup.wide_d != 0 else {}
        self._losses: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def carries(self, times: np.ndarray, clock: bool) -> bool:
        """Whether times, of the flow or (``clock``) physical, are near and floats lose nothing on the way there.

        Measured: the points and 1/g at all steps of the way, in floats beside the wide precision.
        """
        setup = self.setup
        # g is at most that of an axis
        slowest = min(float(1 - setup.wide_d * a) for a in setup.wide_axes) ** 0.5
        steps = times * float(setup.clock / setup.step_length) / slowest
        if np.abs(steps).max(initial=0) > FARTHEST:
            return False
        for sign in (1, -1):
            last = int((sign * steps).max(initial=0)) + 1
            losses, delays = self._measured(sign, last)
            if losses[last] + (delays[last] if clock else 0) > WORST:
                return False
        return True

    @cached_property
    def keeps_time(self) -> bool:
        """Whether 1/g is resolved by the nodes of a step."""
        try:
            return all(len(clock.rule.nodes) for clock in self._clocks.values())
        except PrecisionLoss:
            return False

    def _measured(self, sign: int, last: int) -> tuple[np.ndarray, np.ndarray]:
        """For every number of basic steps up to ``last`` or more: the largest error of σ until there, in units of its
        size, and the largest of the clock, in those of its time, by which γ turns by half as much at the most.
        """
        known = self._losses.get(sign)
        if known is not None and len(known[0]) > last:
            return known
        setup, count = self.setup, 1 << max(3, last.bit_length())
        counts, table = setup.table(sign, count)
        with setup.reals:
            problem, exact = setup.bare_problem, setup.bare_start
            step = setup.bare_table(sign, 1)[1][0]
            errors, rates = [], []
            for steps in range(count + 1):
                found = flow_kernel.reach(setup.f, setup.axes, setup.start, counts, table, steps)
                size = max(abs(float(y)) for y in exact[4:7])
                number = setup.reals.number
                errors.append(
                    max(abs(float(number(x) - y)) for x, y in zip(found[4:7], exact[4:7], strict=True)) / size
                )
                rate = flow_kernel.rate_at(setup.axes, found)
                rates.append(float(number(rate) - flow_kernel.rate_at(problem[1], exact)))
                exact = setup.reals.plain_row(flow_kernel.shift(*problem, exact, step))
        delays = abs(np.cumsum(rates)) * float(setup.step_length) / 2
        self._losses[sign] = np.maximum.accumulate(errors), np.maximum.accumulate(delays)
        return self._losses[sign]

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,)."""
        if not self._clocks:
            return self.at_tau(times), times
        setup = self.setup
        scaled = self._scaled(times)
        points, halves = np.empty((len(times), 10)), np.empty(len(times))
        for sign, chosen in _by_sign(scaled):
            clock = self._clocks[sign]
            high, low = (list(part) for part in zip(*(setup.split(abs(scaled[i])) for i in chosen), strict=True))
            clock.extend(max(high))
            points[chosen], offsets = clock.states(high, low)
            halves[chosen] = sign * offsets
        return self._vectors(points), self._unscaled(halves * setup.half_step)

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ, shape (N, 6)."""
        scaled = self._scaled(tau)
        points = np.empty((len(tau), 10))
        for sign, chosen in _by_sign(scaled):
            points[chosen] = self._points(sign, *self._steps([scaled[i] for i in chosen]))
        return self._vectors(points)

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        scaled = self._scaled(tau)
        times = np.empty(len(tau))
        for sign, chosen in _by_sign(scaled):
            steps, offsets = self._steps([scaled[i] for i in chosen])
            clock = self._clocks[sign]
            clock.extend_to_step(max(steps) + 1)
            times[chosen] = [sign * clock.time(step, x) for step, x in zip(steps, offsets, strict=True)]
        return self._unscaled(times)

    def _points(self, sign: int, steps: list[int], offsets: list[Any]) -> np.ndarray:
        """The moving points ``offsets`` half steps beyond ``steps`` basic steps."""
        setup, levels = self.setup, self.setup.table(sign, max(steps))
        points = [flow_kernel.reach(setup.f, setup.axes, setup.start, *levels, step) for step in steps]
        moved = [
            flow_kernel.offset_point(
                setup.f, setup.axes, point, setup.series, setup.roots, setup.half_step, setup.passes, sign * offset
            )
            for point, offset in zip(points, offsets, strict=True)
        ]
        return np.array(moved, float)

    def _steps(self, scaled: list[Any]) -> tuple[list[int], list[Any]]:
        """Whole steps and half-step offsets in [−1, 1] of |τ|, divided in the wide precision."""
        setup, steps, offsets = self.setup, [], []
        for tau in scaled:
            turns = abs(tau) / setup.step_length
            whole = int(setup.wide.context.nint(turns))
            steps.append(whole)
            offsets.append(setup.number(2 * (turns - whole)))
        return steps, offsets

    def _scaled(self, times: np.ndarray) -> list[Any]:
        """Times in the flow's units, in the wide precision."""
        coerce, clock = self.setup.wide.coerce, self.setup.clock
        return [coerce(t) * clock for t in times]

    def _unscaled(self, times: Any) -> np.ndarray:
        return np.array([self.setup.unscaled(t) for t in times])

    def _vectors(self, points: np.ndarray) -> np.ndarray:
        setup = self.setup
        matrix = None if setup.tilt is None else [float(x) for x in setup.tilt.inverse_matrix()]
        rows = [vectors(row, setup.momentum, matrix) for row in points.tolist()]
        return np.array([(*gamma, *M) for gamma, M in rows]).reshape(-1, 6)


def _by_sign(values: list[Any]) -> list[tuple[int, np.ndarray]]:
    negative = np.array([bool(t < 0) for t in values], dtype=bool)
    groups = ((1, np.flatnonzero(~negative)), (-1, np.flatnonzero(negative)))
    return [(sign, chosen) for sign, chosen in groups if len(chosen)]
