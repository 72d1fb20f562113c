"""The motion of a deformation on two elliptic curves at one precision, and the choice of the precision for a time.

For n requested digits a motion is computed with n + GUARD_DIGITS digits, and with as many more as the number of periods
until the given time has. Further loss is measured on every call. The integrals of each state and the state at τ = 0 are
compared with those of the start, and the rate of γ at τ = 0 with γ × Ω. The farthest state is computed again with more
digits, which also checks the signs of γ and M. If k digits are missing, everything is repeated with k more;
PrecisionLoss if this does not help.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, log2
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np

from integrable.deformations.hamiltonian import Hamiltonian
from integrable.deformations.oval import Pace, height
from integrable.motion.precise import SPARE, WIDER, Carrier, ManyDigits
from integrable.moving_point.losses import NOTHING, digits_of
from integrable.mumford.elliptic_torus import EllipticOval
from integrable.phase.body import Vector, cross
from integrable.phase.precisions import long_digits
from integrable.phase.state import State, onto_constraints, state_of_row
from integrable.torus.theta_series import long_numbers
from jacobian.element import FormulaField, Real
from jacobian.errors import PrecisionLoss, shown, written
from jacobian.inexact.long_field import LongField

if TYPE_CHECKING:
    from integrable.motion.precise import Compute, Found

GUARD_DIGITS = 18
ROUNDING = 6
"""Number of digits that the computation may lose for a τ within one period."""
OFF_COURSE = 1e-10
"""Largest relative error of the rate of γ at the start. Rounding and the finite step cause about 1e-13."""
LEAST_RATE = 1e-3
"""Errors of smaller rates are relative to this rate, because γ may rest. Its unit is one turn of the faster point."""

GammaM = tuple[Vector, Vector]
"""γ and M in wide numbers."""
CurvePoint = Sequence[Real]
"""A point of a curve: R₁, R₂, R₃ and the height z."""


class CurvesCarrier(Carrier):
    """The motion of a deformation at one precision, used by a :class:`DeformedFlow`. Its method ``point`` returns
    (γ, M) at a τ. All methods are called inside ``with field``, which :class:`OnCurves` enters.

    ``system`` and ``start`` are over long numbers, and ``before`` are H and K of ``start``. ``inner`` and ``origin``
    are the same system and state with the axes in ascending ``order`` of the moments of the tilde pair; M changes its
    sign if this order is an odd permutation. Changes of H and K are relative to ``sizes``. A point moves on each of
    ``curves`` for the time ``speed``·τ; from both points, and from the constants ``frame``, :meth:`read` computes the
    state of ``inner``. ``pace`` is dt/dτ if d ≠ 0.
    """

    sizes: tuple[Real, Real]
    curves: Sequence[EllipticOval]
    levels: Sequence[Sequence[Real]]
    """z at e₁, e₂ and e₃ of each curve, and 1/scale (:mod:`integrable.deformations.oval`)."""
    frame: NamedTuple
    shown: GammaM
    """The state at τ = 0, computed from the curves."""
    speed: Real = 1
    pace: Pace | None = None

    def __init__(self, system: Any, state: State) -> None:
        self.field: LongField = system.field
        self.system, self.start, self.before = system, state, system.integrals(state)[2:]
        isometry = system.isometry()
        inertia = system.body.inertia if isometry is None else isometry.pair.body.inertia
        self.order = sorted(range(3), key=lambda i: inertia[i])
        self.side = -1 if self.order in ([0, 2, 1], [1, 0, 2], [2, 1, 0]) else 1
        self.inner = system if self.order == [0, 1, 2] else with_axes(system, self.order)
        gamma, M = state.vectors
        self.origin = state_of_row([*(gamma[i] for i in self.order), *(self.side * M[i] for i in self.order)])

    @staticmethod
    def read(N: FormulaField, system: Any, frame: Any, first: CurvePoint, second: CurvePoint) -> GammaM:
        """Defined by subclasses: (γ, M) of ``system`` from the points on both curves."""
        raise NotImplementedError

    @property
    def digits(self) -> int:  # type: ignore[override]
        return int(self.field.bits / log2(10)) - GUARD_DIGITS

    @property
    def rolls(self) -> bool:  # type: ignore[override]
        return self.system.body.rolls

    @property
    def period(self) -> Real:
        """The shorter of the periods of the two curves."""
        return min(curve.period for curve in self.curves)

    def turns(self, tau: Real) -> Real:
        """|τ| in periods of the curve with the shorter period."""
        return abs(self.speed * tau) / self.period

    def point(self, tau: Real) -> GammaM:
        return self.moved([self.speed * tau] * 2)

    def moved(self, times: Sequence[Real]) -> GammaM:
        """(γ, M) after the point of each curve has moved for its time in ``times``."""
        gamma, M = self._state(*(curve.moved(time) for curve, time in zip(self.curves, times, strict=True)))
        i, j, k = (self.order.index(n) for n in range(3))
        return (gamma[i], gamma[j], gamma[k]), (self.side * M[i], self.side * M[j], self.side * M[k])

    def _state(self, *roots: tuple[Real, Real, Real]) -> GammaM:
        """(γ, M) of ``inner``, from R₁, R₂ and R₃ (:class:`EllipticOval`) on both curves."""
        first, second = ((*r, height(levels, r)) for r, levels in zip(roots, self.levels, strict=True))
        return self.read(self.field, self.inner, self.frame, first, second)

    def on_course(self) -> bool:
        """Whether the change of γ in a small τ agrees with dγ/dτ = γ × Ω/g at the start. The state at τ = 0, H and K
        show neither the direction in which the points move nor how fast.
        """
        K, (gamma, M), system = self.field, self.start.vectors, self.system
        turns, pace = K.coerce(10) ** -(self.digits // 2 + 6), self.speed / self.period
        slow, (x, y, z) = K.sqrt(system.body.conformal(gamma)), system.omega_at(system.scalars(lambda x: x, gamma, M))
        rates = [slow * x for x in cross(K, gamma, (x, y, z))]
        moved = [(x - y) * pace / turns for x, y in zip(self.point(turns / pace)[0], self.shown[0], strict=True)]
        most = OFF_COURSE * (max(map(abs, rates)) + abs(pace) * LEAST_RATE)
        return all(abs(x - y) <= most for x, y in zip(moved, rates, strict=True))

    def lost(self, tau: Real) -> int:
        return ceil((self.field.exponent(1 + self.turns(tau)) or 0) / log2(10))

    def drift(self, points: list[GammaM]) -> int:
        worst = -NOTHING
        for gamma, M in points:
            rows = zip(self.system.integrals(State(gamma, M))[2:], self.before, self.sizes, strict=True)
            worst = max(worst, *(digits_of(abs(x - y) / size) for x, y, size in rows))
        return worst

    def gap(self, point: GammaM, truth: Self, tau: Real) -> int:
        with truth.field:
            return super().gap(point, truth, truth.field.coerce(tau))

    # --- the torus of both points (integrable.portrait.torus_portrait.OvalsTorus). The separated variables ũ1 < ũ2 move
    # with ũ_k' = φ(ũ_k)p_k, where φ > 0 on the oval of ũ1 and φ < 0 on that of ũ2, so p_kdũ_k has these signs

    signs: Sequence[Real] = (1, -1)

    @property
    def ovals(self) -> Sequence[EllipticOval]:
        return self.curves

    @property
    def slowness(self) -> Real:
        """The mean of dt/dτ over the torus."""
        return self.field.one

    @property
    def tau_frequencies(self) -> list[Real]:
        """The turns of both points per unit of τ, in the direction of the motion on their curves."""
        return [self.speed / curve.period for curve in self.curves]

    @property
    def frequencies(self) -> list[Real]:
        """The turns of both points per unit of t."""
        slowness = self.slowness
        return [nu / slowness for nu in self.tau_frequencies]

    @property
    def phases(self) -> list[Real]:
        """The turns of both points at the start since the lower ends of the ovals of ũ_k."""
        half = self.field.one / 2
        return [c.phase + (half if z[3] < 0 else 0) for c, z in zip(self.curves, self.levels, strict=True)]

    @property
    def actions(self) -> list[Real]:
        """Defined by subclasses: (1/2π)∮p_kdũ_k, positive."""
        raise NotImplementedError

    def moves(self, curve: EllipticOval) -> bool:
        """Whether the point of a curve moves."""
        return True


class OnCurves(ManyDigits):
    """The states of a motion on curves; ``made`` is the class that computes it over the field of a given system."""

    carrier: CurvesCarrier
    expected = GUARD_DIGITS - SPARE - ROUNDING
    step = 16

    def __init__(self, system: Hamiltonian, state: State, made: type[CurvesCarrier]) -> None:
        self._system, self._state, self._made = system, state, made
        # carrier_of, called in the next line, reads ``digits``
        self.digits = long_digits(system.field)
        super().__init__(self.digits, self.carrier_of(self.digits))

    def settled(self, times: list[Real], compute: Compute[Found]) -> Found:
        def inside(carrier: Carrier, scaled: list[Real]) -> tuple[Found, int] | None:
            with self.carrier.field:
                return compute(carrier, scaled)

        return super().settled(times, inside)

    def at_phases(self, phases: np.ndarray) -> np.ndarray:
        """γ and M, in floats, at phases of both curves in turns since the start, (N, 2): shape (N, 6)."""
        curves, moved = self.carrier.curves, self.carrier.moved
        with self.carrier.field:
            points = [
                moved([x * curve.period for x, curve in zip(row, curves, strict=True)]) for row in phases.tolist()
            ]
        return np.array(points, dtype=float).reshape(-1, 6)

    def carrier_of(self, digits: int) -> CurvesCarrier:
        """The motion with ``digits`` digits, or more if its point at τ = 0 does not reproduce the state."""
        for _ in range(3):
            with long_numbers(ceil((digits + GUARD_DIGITS) * log2(10))) as numbers:
                carrier = self._made(*widened(self._system, self._state, numbers))
                gap = carrier.difference(carrier.shown, carrier.start.vectors)
                on_course = carrier.on_course()
            missing = gap + self.digits + SPARE
            if missing <= 0 and on_course:
                return carrier
            digits += max(0, min(missing, digits)) + WIDER
        raise PrecisionLoss(
            f"{shown(self._state)}: the state or its rate does not follow from its two points "
            f"even with {written(digits)} digits"
        )


def with_axes(system: Any, order: Sequence[int]) -> Any:
    """The same system with its axes in another order."""
    moments, d, rest = system.body.inertia, system.constants[3], system.constants[4:]
    if rest:
        a, b, *poles = rest
        rest = a, b, *(poles[i] for i in order)
    return system._of_constants(system.field, (*(moments[i] for i in order), d, *rest))


def widened(system: Hamiltonian, state: State, numbers: Any) -> tuple[Any, State]:
    """The same system and state over a field of more digits, with the state projected onto the constraints."""
    wide = system._of_constants(numbers, [*map(numbers.coerce, system.constants)])
    return wide, onto_constraints(wide, state)
