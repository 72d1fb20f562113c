"""The flow in floats near its start, without compiling anything: additions of tabled translations, time by steps.

T of about 2^k basic steps are made once in extended precision, so that a time is reached in as many additions as its
number of steps has binary digits. Physical time comes from :mod:`integrable.motion.near_clock`.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from math import inf, isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.motion.near_clock import Clock
from integrable.moving_point import addition
from integrable.moving_point.problem import vectors
from integrable.phase.attitude import angular_velocities
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup

# motions are carried this many basic steps; beyond, the corners of the torus cost less
FARTHEST = 256
# steps that are measured first
FIRST = 8
# the error of γ and M/|M| that floats may make on the way there, that of their clock included, and the part of it that
# they may make where it is measured: additions next to the identity lose now more, now less
WORST = 1e-13
SAFE = 1 / 2
# where it is measured beside the whole steps: in half steps from them
OFFSETS = (1e-6, 0.03, 0.3, -0.7, 1e-3, 0.1, -0.5, 0.9)


class SteppedFlow:
    """γ and M near the start of a motion in floats: readable loops, in the user's units."""

    way = "stepped"

    def __init__(self, setup: Setup) -> None:
        self.setup = setup
        self._clocks = {sign: Clock(setup, sign) for sign in (1, -1)} if setup.problem.d != 0 else {}
        self._losses: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def carries(self, times: np.ndarray, clock: bool) -> bool:
        """Whether times, of the flow or (``clock``) physical, are near and floats lose nothing on the way there.

        Measured: γ, M and 1/g at all steps of the way, in floats beside the wide precision.
        """
        setup = self.setup
        # g is at most that of an axis, of the body that was given: a tilted motion runs on another one
        slowest = float(min(setup.body.contact)) ** 0.5 if clock else 1.0
        with np.errstate(over="ignore"):
            # far beyond any step for times near the end of the floats
            steps = times * float(setup.time_scale / setup.step_length) / slowest
        if np.abs(steps).max(initial=0) > FARTHEST:
            return False
        for sign in (1, -1):
            last = int((sign * steps).max(initial=0)) + 1
            # most bodies that are too much for floats are so from the start
            for reach in (min(last, FIRST), last):
                losses, delays = self._measured(sign, reach)
                if not losses[reach] + (delays[reach] if clock else 0) <= SAFE * WORST:
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
        """For every number of basic steps up to ``last`` or more: the largest error of γ and M/|M| until there, and the
        largest that an error of the clock makes there: itself times the speed of γ or M/|M|.
        """
        known = self._losses.get(sign)
        if known is not None and len(known[0]) > last:
            return known
        setup, floats, count = self.setup, self.setup.floats, max(FIRST, 1 << last.bit_length())
        levels = floats.table(sign, count)
        points = [addition.reach(floats.f, floats.axes, floats.start, *levels, steps) for steps in range(count + 1)]
        off, late = (np.array(part) for part in zip(*self._differences(sign, points), strict=True))
        if not np.isfinite(off).all() or not np.isfinite(late).all():
            self._losses[sign] = np.full(count + 1, inf), np.full(count + 1, inf)
            return self._losses[sign]
        rows = self._vectors(np.array(points))
        size = float(np.linalg.norm(rows[0, 3:]))
        omega, _ = angular_velocities(setup.body, rows[:, :3], rows[:, 3:])
        speeds = np.maximum(*(np.abs(np.cross(v, omega)).max(axis=1) for v in (rows[:, :3], rows[:, 3:] / size)))
        delays = np.abs(np.cumsum(late)) * float(setup.step_length / setup.time_scale) * np.maximum.accumulate(speeds)
        errors = np.maximum(off[:, :3].max(axis=1), off[:, 3:].max(axis=1) / size)
        self._losses[sign] = np.maximum.accumulate(errors), np.maximum.accumulate(delays)
        return self._losses[sign]

    def _differences(self, sign: int, points: list[Any]) -> Iterator[tuple[np.ndarray, float]]:
        """How far γ, M and 1/g are from those in the wide precision at the first basic steps, and γ and M a part of a
        step beyond: shape (6,), and a number.
        """
        reals, floats, bare = self.setup.reals, self.setup.floats, self.setup.bare
        problem, exact, step = (bare.f, bare.axes), bare.start, bare.table(sign, 1)[1][0]
        probes = self._probes
        for k, point in enumerate(points):
            off = np.zeros(6)
            # all of them at the start, where a single addition is all that is asked for
            for near, wide in (None, None), *(probes if k == 0 else probes[k % len(probes) :][:1]):
                with reals:
                    there = exact if wide is None else addition.shift(*problem, exact, wide)
                    true = self._wide_vectors(there)
                here = point if near is None else addition.shift(floats.f, floats.axes, point, near)
                found = self._vectors(np.array([here]))[0].tolist()
                off = np.maximum(off, [abs(self._gap(x, y)) for x, y in zip(found, true, strict=True)])
            with reals:
                late = self._gap(addition.rate_at(floats.axes, point), addition.rate_at(bare.axes, exact))
                exact = reals.plain_row(addition.shift(*problem, exact, step))
            yield off, late

    def _gap(self, x: float, y: Any) -> float:
        """x − y of a float and a bare real; inf where the float has overflowed."""
        with self.setup.reals as reals:
            return float(reals.number(x) - y) if isfinite(x) else inf

    @cached_property
    def _probes(self) -> list[tuple[Any, Any]]:
        """Translations by parts of a step, in floats and in the wide precision."""
        setup, reals = self.setup, self.setup.reals
        with reals:
            wide = [setup.translations.near(reals.number(x) * setup.bare.half_step) for x in OFFSETS]
        return [(setup.floats.near(x * setup.floats.half_step), row) for x, row in zip(OFFSETS, wide, strict=True)]

    def _wide_vectors(self, point: Any) -> list[Any]:
        """γ and M of a point of bare reals, side by side."""
        reals = self.setup.reals
        matrix = None if self._matrix is None else reals.row(self._matrix)
        gamma, M = vectors(point, self.setup.bare.momentum, matrix)
        return [*gamma, *M]

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,)."""
        if not self._clocks:
            return self.at_tau(times), times
        scaled = self._scaled(times)
        points, halves = np.empty((len(times), 10)), np.empty(len(times))
        for sign, chosen in _by_sign(scaled):
            clock = self._clocks[sign]
            high, low = (list(part) for part in zip(*(self._split(abs(scaled[i])) for i in chosen), strict=True))
            clock.extend(max(high))
            points[chosen], offsets = clock.states(high, low)
            halves[chosen] = sign * offsets
        return self._vectors(points), self._unscaled(halves * self.setup.floats.half_step)

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
        floats = self.setup.floats
        levels = floats.table(sign, max(steps))
        points = [addition.reach(floats.f, floats.axes, floats.start, *levels, step) for step in steps]
        series = floats.series, floats.roots, floats.half_step, floats.passes
        moved = [
            addition.offset_point(floats.f, floats.axes, point, *series, sign * offset)
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
            offsets.append(float(2 * (turns - whole)))
        return steps, offsets

    def _scaled(self, times: np.ndarray) -> list[Any]:
        """Times in the flow's units, in the wide precision."""
        coerce, scale = self.setup.wide.coerce, self.setup.time_scale
        return [coerce(t) * scale for t in times]

    def _unscaled(self, times: Any) -> np.ndarray:
        coerce, scale = self.setup.wide.coerce, self.setup.time_scale
        return np.array([float(coerce(t) / scale) for t in times])

    def _split(self, t: Any) -> tuple[float, float]:
        """A wide number as (high, low)."""
        high = float(t)
        return high, float(t - self.setup.wide.coerce(high))

    @cached_property
    def _matrix(self) -> tuple[Any, ...] | None:
        """The inverse of Chaplygin's transformation, wide."""
        return None if self.setup.tilt is None else self.setup.tilt.inverse_matrix()

    def _vectors(self, points: np.ndarray) -> np.ndarray:
        matrix = None if self._matrix is None else [float(x) for x in self._matrix]
        rows = [vectors(row, self.setup.floats.momentum, matrix) for row in points.tolist()]
        return np.array([(*gamma, *M) for gamma, M in rows]).reshape(-1, 6)


def _by_sign(values: list[Any]) -> list[tuple[int, np.ndarray]]:
    negative = np.array([bool(t < 0) for t in values], dtype=bool)
    groups = ((1, np.flatnonzero(~negative)), (-1, np.flatnonzero(negative)))
    return [(sign, chosen) for sign, chosen in groups if len(chosen)]
