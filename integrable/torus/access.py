"""Random access to a motion: a state at any τ or t takes two phases and three theta functions.

A whole turn of a phase changes only signs: those of the γ_i of the upright body. Compiled loops use double-doubles and
round once, so no error grows with the time; interpreted loops use more digits. Physical time t = ∫dτ/g is a mean rate
times τ plus a Fourier series on the torus, inverted by Newton's method. (Fedorov 2009 writes t in theta functions.)
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import isfinite

import numpy as np

from integrable.moving_point.addition import Row
from integrable.moving_point.problem import HALF_STEP, HEAVINESS, TIME_SCALE
from integrable.moving_point.setup import Setup
from integrable.torus.clock import MOST_SAMPLES, TorusClock, check_turns, first_grid, resolved_spectrum, samples_of
from integrable.torus.lifts import AROUND, CHECKED, CLOSED, Limits, RateSums, Torus
from integrable.torus.loops import (
    BEYOND,
    CompiledLoops,
    Loops,
    PeriodBasis,
    in_basis,
    shortest,
    theta_sums,
)  # fmt: skip
from integrable.torus.panels import NODES, Panels, States, panel_length
from integrable.torus.states import BodyStates
from integrable.torus.theta_setup import CLASSES, FOUND, FREQUENCIES, IMAGINARY, MEAN, PLACING, rule_of_phases
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.periods.real_basis import Whole

# at DENSE_FROM or more ascending times, if panels have at least DENSE times per node, interpolation on them is faster
DENSE_FROM = 5000
DENSE = 3
# the states must satisfy the equations of motion up to RIGHT times the largest velocity
RIGHT = 1e-12


class BodyTorus:
    """The states of a motion on its torus, by loops of :mod:`integrable.torus.loops`.

    ``turns`` are the signs by which γ1, γ2, γ3 are multiplied after each period. ``basis`` has the periods as integer
    combinations of the periods around the two ovals; ``doubled`` has the periods of 1/g in units of those of the
    divisor. ``closure`` is the difference between the start and the state at the phases of the start. PrecisionLoss
    where the torus is not compact, and where its states are not those of the motion.
    """

    def __init__(self, setup: Setup, loops: Loops) -> None:
        self.setup, self.loops = setup, loops
        self.units, self._motion, self.tilt, start, self._problem, self._smallest = loops.begun(setup)
        found = loops.room(FOUND)
        m1, n1, m2, n2 = loops.periods(self._motion, loops.short, loops.room(4), found)
        self.basis = (m1, n1), (m2, n2)
        chars = characteristics(loops.floats(self._motion[4:8]).tolist(), self.basis)
        # θ changes its sign over period k where ε_k is 1
        self.turns = np.array([[1.0 - 2.0 * char[k] for char in chars] for k in (0, 1)])
        odd = [sum(char[k] for char in chars) % 2 == 1 for k in (0, 1)]
        self.odd = odd[0], odd[1]
        # for a tilted body, a sign change of an odd number of γ_i changes 1/g, whose period is then twice the divisor's
        self.doubled = (1 + odd[0], 1 + odd[1]) if loops.floats(self.tilt)[1] != 0 else (1, 1)
        self.rates, matrix, rate, units = loops.room(4), loops.room(4), loops.room(10), self.units
        loops.rates(self._problem, found, self._motion, self.tilt, (units.length, units.lift), matrix, self.rates, rate)
        self.torus = loops.packed(BodyStates(self._placed(start, found, chars), matrix))
        self._rate = RateSums(0, 3, True, self.doubled != (1, 1), rate)
        self._check(found)

    def _placed(self, start: Row, found: Row, chars: Sequence[Whole]) -> Torus:
        """The torus, packed for the loops, with the phases and the signs of the start."""
        loops = self.loops
        shape = found[IMAGINARY:MEAN]
        if not np.isfinite(loops.floats(shape)).all():
            raise PrecisionLoss(BEYOND)
        self._decay = shortest(loops.floats(shape[:3]).tolist())
        sums, scales = theta_sums(loops, shape, (0, 0, 0), chars)
        torus: Torus = loops.packed(Torus(sums, loops.room(2), loops.room(3)))
        limits = Limits(loops.noise * 1e-10, loops.nudge, self._smallest)
        self.closure = loops.placed(
            torus, self._motion, start, found, scales, rule_of_phases(), limits, loops.room(PLACING)
        )
        return torus

    def _check(self, found: Row) -> None:
        if not self.closure <= CLOSED:
            raise PrecisionLoss(f"the torus of this motion leads back to {self.closure:.1e} only; use more digits")
        frequencies = found[FREQUENCIES : FREQUENCIES + 2]
        room = self.loops.room(6 * (AROUND + 1) * CHECKED)
        self.loops.strayed(self.torus, self._motion, frequencies, room, gaps := np.empty(CHECKED))
        if not gaps.max() <= RIGHT:
            raise PrecisionLoss("the states on the torus of this motion do not obey its equations; use more digits")

    @property
    def compiled(self) -> bool:
        """Whether the loops are compiled. A state then takes microseconds, a thousandth of the interpreted time."""
        return isinstance(self.loops, CompiledLoops)

    @cached_property
    def frequencies(self) -> tuple[Real, Real]:
        """Turns of each phase per unit of τ, wide."""
        nu1, nu2 = self.loops.wide(self.rates[:2], self.setup.wide)
        return nu1, nu2

    @cached_property
    def mean(self) -> Real:
        """The mean of 1/g over the torus, wide: a determinant of elliptic integrals, computed without samples of 1/g.

        The tilt term of 1/g (:class:`~integrable.torus.lifts.RateSums`) has mean 0, because it changes its sign around
        an oval that contains one α_i.
        """
        return self.loops.wide(self.rates[2:3], self.setup.wide)[0]

    def at_phases(self, phases: np.ndarray) -> np.ndarray:
        """γ and M at points of the torus, shape (N, 6): ``phases`` in turns from the start, shape (N, 2)."""
        return self._read(self.loops.exact(phases.ravel()))

    def _read(self, phases: Row) -> np.ndarray:
        """γ and M, shape (N, 6), at N pairs of phases in the precision of the loops."""
        self.loops.states_at_phases(self.torus, phases, out := np.empty(3 * len(phases)))
        return out.reshape(-1, 6)

    def first_grid(self) -> tuple[int, int]:
        """The numbers of points of the first grid of 1/g."""
        return first_grid(self.loops.noise, self._decay)

    def samples(self, sizes: tuple[int, int], known: np.ndarray | None = None) -> np.ndarray:
        """1/g on a grid over its periods, with ``sizes`` points per period of the divisor, by :func:`samples_of`."""
        return samples_of(self.loops, self.torus[0], self._rate, self.odd, sizes, known)


def characteristics(points: list[float], basis: PeriodBasis) -> list[Whole]:
    """(ε₁, ε₂, δ₁, δ₂) of the theta functions that belong to the branch points α1, α2 and α3. ``points`` are α1, α2,
    α3 and ζ (:mod:`integrable.torus.states`).
    """
    # α_i that are equal in floats are distinguished by their index
    *axes, zeta = points
    low, middle, high = sorted(range(3), key=lambda i: axes[i])
    # e₂, the end of the first oval, is the lesser of the middle α_i and ζ
    classes = {low: CLASSES[0], middle: CLASSES[2 if zeta < axes[middle] else 1], high: CLASSES[3]}
    return in_basis([classes[i] for i in range(3)], basis)


class TorusFlow(BodyTorus):
    """γ and M at any times of a motion, in the user's units, from a :class:`~integrable.moving_point.setup.Setup`.

    PrecisionLoss where the torus is not compact, where 1/g needs more than MOST_SAMPLES samples, and where the loops
    lose too many digits.
    """

    way = "torus"

    def __init__(self, setup: Setup, loops: Loops) -> None:
        super().__init__(setup, loops)
        problem, (nu1, nu2, mean) = loops.floats(self._problem), loops.floats(self.rates[:3]).tolist()
        # ``scale`` is one unit of the user's τ in units of the problem
        rolls, scale = problem[HEAVINESS] != 0, float(problem[TIME_SCALE])
        # the turns of both phases per unit of τ, and per unit of t
        self._turns = [nu1, nu2]
        self._turns_in_t = [nu1 / mean, nu2 / mean] if rolls else self._turns
        if not all(map(isfinite, self._turns + self._turns_in_t)):
            raise PrecisionLoss(BEYOND)
        # a basic step (:attr:`Setup.step_length`) in the user's τ
        self._step = 2 * float(problem[HALF_STEP]) / scale
        self.clock: TorusClock | None = None
        self._lengths: dict[str, float] = {}
        if rolls:
            grid = self.samples, self.first_grid(), MOST_SAMPLES
            spectrum = resolved_spectrum(loops, *grid, self._turns, scale, loops.noise)
            noise = max(self.closure, loops.noise / 64)
            self.clock = TorusClock(loops, spectrum, self.rates, scale, noise, self.doubled)

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """γ and M, and τ, at physical times: arrays of shapes (N, 6) and (N,).

        Ascending times are interpolated by panels of Chebyshev series if there are many per panel.
        """
        if not self.clock:
            return self.at_tau(times), times
        panels = self._panels(self._rows_at, times)
        if panels is None:
            rows, tau, _ = self._rows_of_clock(times)
            return rows, tau
        rows = panels.at(times, self.loops.panel_values)
        return rows[:, :6], times / float(self.mean) + rows[:, 6]

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        if not self.clock:
            return tau
        check_turns(tau, self._turns, self.clock.most)
        return self.clock.times(tau)

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ, shape (N, 6)."""
        panels = self._panels(self._rows_at_tau, tau)
        return self._rows_at_tau(tau) if panels is None else panels.at(tau, self.loops.panel_values)

    def phases(self, times: np.ndarray, physical: bool, periods: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
        """Both phases at physical times, or at values of τ unless ``physical``. Each is divided by its entry of
        ``periods``, 1 or 2, and is determined modulo 1. The phases keep the digits that a rounded τ has lost.
        """
        if physical and self.clock:
            check_turns(times, self._turns_in_t, self.clock.most)
            rows = self.clock.phases(times)[0]
        else:
            check_turns(times, self._turns)
            self.loops.phases_at(self.rates, times, rows := self.loops.room(2 * len(times)))
        first, second = self.loops.floats(rows).reshape(-1, 2).T / np.array(periods)[:, None]
        return first, second

    def _panels(self, states: States, times: np.ndarray) -> Panels | None:
        """Panels over these times; None where evaluation time by time is faster or panels do not converge."""
        if len(times) < DENSE_FROM or not (np.diff(times) >= 0).all():
            return None
        start, end = float(times[0]), float(times[-1])
        if not start < end:
            return None
        if states.__name__ not in self._lengths:
            # the length does not depend on the requested times, so that one request does not change the bits of another
            self._lengths[states.__name__] = panel_length(states, self._step / 8)
        length = min(self._lengths[states.__name__], end - start)
        # panels account for the rounding of a time to first order only, which is enough if the rounding is this small
        near = np.spacing(max(abs(start), abs(end))) < 1e-9 * length
        if not near or len(times) < DENSE * NODES * (end - start) / length:
            return None
        try:
            return Panels(states, start, end, length)
        except PrecisionLoss:
            # motions with fast passages need too many panels; evaluation time by time is as accurate
            return None

    def _rows_at(self, times: np.ndarray) -> np.ndarray:
        """γ, M and τ − t/(mean of 1/g), shape (N, 7)."""
        rows, _, delays = self._rows_of_clock(times)
        return np.column_stack([rows, delays])

    def _rows_of_clock(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        assert self.clock
        check_turns(times, self._turns_in_t, self.clock.most)
        phases, tau, delays = self.clock.phases(times)
        return self._read(phases), tau, delays

    def _rows_at_tau(self, tau: np.ndarray) -> np.ndarray:
        check_turns(tau, self._turns)
        self.loops.phases_at(self.rates, tau, phases := self.loops.room(2 * len(tau)))
        return self._read(phases)
