"""Motions of deformations with proven bounds: Taylor series of their equations in ball arithmetic, with bounds on their
remainders.

For the motion from every state, Picard's theorem gives a disc of complex times |t| ≤ r on which it stays in a box.
Cauchy's estimate on this disc bounds the truncation error of a step of r/8. Balls grow with every step, so the
precision is raised by the number of bits lost. The cost grows with the time, and with the number of digits that the
motion loses in this time. (Moore 1966, *Interval Analysis*; Tucker 2011, *Validated Numerics*.)
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, inf, log
from typing import TYPE_CHECKING, Any

from integrable.deformations.hamiltonian import Hamiltonian
from integrable.motion.near import right_hand_sides
from integrable.moving_point.balls import BOUND_BITS, Balls, picard_box
from integrable.moving_point.balls import around as widened
from integrable.phase.enclosure import Enclosure, exact_times, rounded_up, widest
from integrable.phase.state import State, onto_constraints
from integrable.series.recurrences import coefficients, values_at
from integrable.series.tape import CONSTANT, ROOT, recorded
from jacobian.element import Real
from jacobian.errors import Infeasible, PrecisionLoss, written
from jacobian.progress import Progress

__all__ = ["enclosed_states"]

if TYPE_CHECKING:
    from flint import acb, arb

    from integrable.phase.enclosure import Row

# a step relative to the radius of the disc of complex times where Picard's theorem bounds the motion; the fraction e⁻²
# would need the fewest products
STEP = 0.125
MOST_STEPS = 4_000
KNOWN_FROM = 16
"""Number of steps after which the remaining ones are estimated."""
SPARE_BITS = 64
"""Number of bits that the balls of the first attempt may lose."""
MOST_ATTEMPTS = 8
MOST_AHEAD = 16.0
"""Largest multiple of the time reached to which the bits lost so far are extrapolated."""
SMALLEST_DISC = 1e-15
"""Smallest disc relative to the largest: near a repelling pole b/γ_i² discs shrink to b/M², near an attracting one to
0.
"""


def enclosed_states(system: Hamiltonian, state: State, given: list[Real], digits: int, in_tau: bool) -> Enclosure:
    """Enclosures of the states at physical times, or at values of τ.

    The radius of M is relative to |M| at the start, unless that is 0. Infeasible if more than 4,000 steps are needed;
    PrecisionLoss if no such balls are found, as beyond the end of a motion.
    """
    rows: dict[int, Row] = {}
    for ahead in (True, False):
        order = sorted((i for i in range(len(given)) if (given[i] >= 0) == ahead), key=lambda i: abs(given[i]))
        found = _narrow(system, state, [given[i] for i in order], digits, in_tau) if order else []
        rows.update(zip(order, found, strict=True))
    times = None if in_tau and system.body.rolls else exact_times(given)
    return Enclosure(times, [rows[i] for i in range(len(given))])


def _narrow(system: Hamiltonian, state: State, times: list[Real], digits: int, in_tau: bool) -> list[Row]:
    """The rows at times of one sign in ascending size, computed with as many bits as they need."""
    # the number of bits lost to the growth of M beyond |M| at the start is independent of the time; other losses grow
    needed = ceil(3.33 * (digits + 2)) + _March(system, state, BOUND_BITS, in_tau).outgrown()
    bits = needed + SPARE_BITS
    for _ in range(MOST_ATTEMPTS):
        march = _March(system, state, bits, in_tau)
        with march.reals:
            rows, left = march.rows(times, digits), march.left(times[-1])
        if len(rows) == len(times):
            return rows
        # the bits lost so far are extrapolated to the whole time, plus 20 %
        bits = needed + SPARE_BITS + ceil(1.2 * (bits - needed) * min(left, MOST_AHEAD))
    raise PrecisionLoss(
        f"times: no balls of radius 1e-{written(digits)} were reached at t = {written(times[-1])} with {bits} bits; "
        "ask for fewer digits"
    )


class _March:
    """The motion in t, or in τ, in balls of ``bits`` bits, step by step; use it inside ``with march.reals``."""

    def __init__(self, system: Hamiltonian, state: State, bits: int, in_tau: bool = False) -> None:
        import flint

        self._flint = flint
        balls: Any = Balls(bits)
        self.reals = balls.reals
        with balls:
            wide = system.over(balls)
            start = onto_constraints(wide, state)
            rolls, zero = system.body.rolls, wide.field.zero
            # if d ≠ 0, a variable follows γ and M: τ, or t if the motion is in τ
            self._point = [*start.row, *([zero] if rolls else [])]
            self._finds_tau = rolls and not in_tau
            self._tape = recorded(right_hand_sides(wide, physical=not in_tau), len(self._point))
            # the unit of M is |M| at the start, or 1 for a start at rest
            M = start.vectors[1]
            self._momentum = wide.field.dot(M, M).sqrt() if any(state.vectors[1]) else wide.field.one
            self._now = zero
        self._order = ceil(bits * log(2) / -log(STEP))
        self._longest = 0.0
        self._steps = 0

    def rows(self, times: Sequence[Real], digits: int) -> list[Row]:
        """(τ, γ, M, radius) at the times, up to the first time whose balls are too large."""
        found: list[Row] = []
        least = self._flint.arb(10) ** -digits
        progress = Progress(f"enclosing the motion to t = {written(times[-1])}", abs(float(times[-1])))
        self._expand(0.0)
        for time in map(self.reals.number, times):
            while abs(time - self._now) > STEP * self._radius:
                step = self._flint.arb(STEP * self._radius)
                step = step if time > 0 else -step
                self._point, self._now = self._at(step), self._now + step
                if not widest((self._point[:3], 1), (self._point[3:6], self._momentum)) < least:
                    return found
                self._check(times[-1])
                progress.add(STEP * self._radius)
                self._expand(1.5 * self._radius)
            point = self._at(time - self._now)
            gamma, M = point[:3], point[3:6]
            width = widest((gamma, 1), (M, self._momentum))
            if not width < least:
                return found
            found.append((point[6] if self._finds_tau else time, gamma, M, rounded_up(width)))
        return found

    def left(self, end: Real) -> float:
        """|``end``| divided by the distance of the time reached from 0."""
        return float(abs(self.reals.number(end)) / (abs(self._now) + 2.0**-1000))

    def _check(self, end: Real) -> None:
        """Counts a step; raises Infeasible if too many steps are needed to reach ``end``."""
        self._steps += 1
        expected = self._steps * self.left(end) if self._steps >= KNOWN_FROM else 0
        if expected > MOST_STEPS:
            within = abs(float(self._now)) * MOST_STEPS / self._steps
            raise Infeasible(
                f"times: enclosing the motion to t = {written(end)} takes about {expected:.3g} steps, more than "
                f"{MOST_STEPS}; about |t| = {within:.3g} is within reach"
            )

    def outgrown(self) -> int:
        """The number of bits by which M grows beyond |M| at the start, the unit of its balls."""
        with self.reals:
            size = self._size([float(abs(x).abs_upper()) for x in self._velocity(self._point)])
            # balls are used, since |M| may be below the range of floats
            grown = (1 + self._flint.arb(size) / self._momentum).log().abs_upper()
            return ceil(float(grown) / log(2)) if grown.is_finite() else 0

    # --- one step

    def _expand(self, guess: float) -> None:
        """Makes the Taylor series about the present time and its disc, on which no coordinate moves by more than its
        reach; ``guess`` is a first radius of the disc, 0 for none.
        """
        self._radius, self._reach = self._disc(guess)
        self._taylor = self._series(self._point, self._order, self._flint.arb)

    def _at(self, distance: arb) -> list[arb]:
        """The point ``distance`` later: the value of the series, widened by Cauchy's bound on the remainder."""
        count = len(self._point)
        found = [self.reals.number(0)] * count
        values_at(distance, self._order, self._taylor, count, found, 0)
        part = (abs(distance) / self._radius).abs_upper()
        tail = part ** (self._order + 1) / (1 - part)
        return [widened(x, tail * size) for x, size in zip(found, self._reach, strict=True)]

    def _series(self, point: Sequence[arb | acb], order: int, kind: type[arb | acb]) -> list[arb | acb]:
        """The Taylor coefficients of all nodes of the tape about a point; ``kind`` is the type, arb or acb."""
        tape, width = self._tape, order + 1
        series = [kind(0)] * (width * len(tape.kinds))
        for n, given in enumerate(tape.kinds):
            if n < len(point):
                series[n * width] = point[n]
            elif given == CONSTANT:
                series[n * width] = kind(tape.constants[n])
        coefficients(tape.kinds, tape.left, tape.right, tape.results, 0, order, 1, series)
        return series

    def _velocity(self, point: Sequence[arb | acb]) -> list[arb | acb]:
        """The derivatives at a point, or on a complex box; NaN if a square root is not analytic on the box."""
        kind = type(point[0])
        series = self._series(point, 1, kind)
        if any(
            k == ROOT and not series[2 * i].real > 0 for k, i in zip(self._tape.kinds, self._tape.left, strict=True)
        ):
            return [kind("nan")] * len(point)
        return series[1 : 2 * len(point) : 2]

    def _size(self, speed: list[float]) -> float:
        """The unit of M in a disc: |M| at the start, or a larger one if a potential accelerates a body nearly at rest.

        The larger unit is the |M| that the potential produces while γ turns by a radian.
        """
        turning, pull = max(speed[:3]), max(speed[3:6])
        now = max(float(abs(x).abs_upper()) for x in self._point[3:6])
        return max(float(self._momentum), (pull * now / turning) ** 0.5 if turning else 0.0)

    def _disc(self, radius: float) -> tuple[float, list[arb]]:
        """(radius, reach): for complex times up to ``radius`` the motion exists and moves by at most ``reach``."""
        with self.reals.at(BOUND_BITS):
            speed = [float(abs(x).abs_upper()) for x in self._velocity(self._point)]
            size = self._size(speed)
            if not 0 < size < inf:
                raise PrecisionLoss(
                    f"|M| = {written(float(self._momentum))}: bounds of this motion are beyond the range of floats"
                )
            sizes = [*[1.0] * 3, *[size] * 3, 1.0]
            # τ is excluded: no rate depends on it, and its own rate has another unit
            rate = max(x / size for x, size in zip(speed[:6], sizes, strict=False)) or 1.0
            radius = radius or 1 / rate
            least = SMALLEST_DISC * (self._longest or radius)
            while radius > least:
                wide = [radius * (1.5 * x + 0.01 * rate * size) for x, size in zip(speed, sizes, strict=False)]
                found = picard_box(self._velocity, self._point, wide, radius)
                if found is not None:
                    self._longest = max(self._longest, radius)
                    return radius, found[1]
                radius *= 0.85
        raise PrecisionLoss(f"times: the motion ends, or cannot be followed, near t = {float(self._now):g}")
