"""Global quantities of a motion: frequencies, rates, drift, actions and angles, and its place among the motions of its
body.

M̃ = s(M − dkH1γ) and γ̃ ∥ γ + kM are the fixed vectors of Chaplygin's transformation (:mod:`integrable.phase.upright`).
Where (γ, M) = 0 they are M and γ themselves. M̃ circles the axis of the least a = 1/(I + d) where ζ = H̃1/H̃2 is below the
middle a, otherwise that of the largest. All means have closed forms, at any d and (γ, M), in the periods of
:mod:`integrable.portrait.ovals`: with D = A0B1 − A1B0 and N = √Π(1 − d̃a_i),

    ν1 = B1/(2D), ν2 = −A1/(2D), ⟨1/g⟩ = sN⟨1/√((1 − d̃u1)(1 − d̃u2))⟩, f = ν/⟨1/g⟩,
    J1 = (H̃1A0 − H̃2A1)/π, J2 = (H̃2B1 − H̃1B0)/π,

where u1 and u2 are the abscissas in the two ovals, and ⟨ ⟩ is the mean over the torus.

At (γ, M) = 0 the J_k = (1/2π)∮|p_k|du_k are the actions in the coordinates of
:func:`integrable.phase.separation.to_separated`; at (γ, M) ≠ 0 they are those of the upright body. (Chaplygin 1903; at
d = 0 Euler 1758, Jacobi 1849.)
"""

from __future__ import annotations

from functools import cached_property

from integrable.moving_point.elliptic_integrals import complete
from integrable.moving_point.problem import vectors
from integrable.moving_point.setup import Setup
from integrable.phase.space import PhaseSpace
from integrable.phase.state import State
from integrable.portrait.ovals import Level, Ovals
from integrable.torus.long_clock import phases
from integrable.torus.oval_modes import OvalTorus
from jacobian.element import Real
from jacobian.errors import NotRepresentable, PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.immutable import Immutable
from jacobian.notebook import named
from jacobian.numbers.long_reals import BallReals
from jacobian.numbers.roots import root

REGIONS = {
    "low": "ζ below the middle a_i: M̃ circles the axis of the least one, of the largest moment",
    "high": "ζ above the middle a_i: M̃ circles the axis of the largest one, of the least moment",
    "symmetric": "two moments are equal, and M̃ circles the axis of the third",
    "rotation": "M̃ rests along an axis of the body, or across the one of a symmetric body",
    "separatrix": "ζ is the middle a_i: the unstable rotation, or a motion that comes from one and goes to one",
    "homogeneous": "three moments are equal: ω is constant",
}
"""The values of :attr:`Portrait.region` and their meaning."""

# angles have SPARE digits beyond those of the set-up. Set-ups with LOST extra digits are tried in turn, since near a
# separatrix the ovals lose digits
SPARE, LOST = 4, (0, 40, 160, 640)


class Portrait(Immutable):
    """The global quantities of a motion, in the field of its system. Get one from ``flow.portrait``.

    ``region`` is a word of :data:`REGIONS`, ``axis`` (0, 1 or 2) the axis of the body that M̃ circles, or None.
    ``zeta`` is ζ = H̃1/H̃2. ``distance`` is (ζ − a₂)/(a₃ − a₁) with the sorted a_i: the distance to the separatrix,
    negative on its low side (0 where three moments are equal).

    ``frequencies`` (f1, f2) and ``tau_frequencies`` (ν1, ν2) are turns of u1 and of u2 per unit of t and of τ, signed;
    ``rotation_number`` is f1/f2. Rates are in radians per unit of t: ``precession`` of the axis about M̃ in space,
    ``spin`` of γ̃ about the axis and ``polhode`` of M̃ about the axis. ``spin`` and ``polhode`` are measured in the
    body, and positive by the right-hand rule about its axis. All three are None without an axis.

    ``drift`` is the mean velocity of the point of contact along −y of :attr:`Trajectory.attitude`, per unit of t:
    in radii if the system has no ``radius``, else in the unit of the radius. It is None for a body that does not roll.
    ``mean_spin`` is the mean of (γ, ω), and ``mean_g`` that of g = dτ/dt, both over t. ``wide_frequencies`` (f1, f2)
    and ``wide_tau_frequencies`` (ν1, ν2) have the digits of the set-up. ``ovals`` holds the periods, None where the
    ovals have met; ``level`` describes the curve.
    """

    def __init__(self, system: PhaseSpace, state: State, setup: Setup) -> None:
        self._field, self._given = system.field, (system, state, setup.wide, setup.digits)
        level = self.level = Level.of(setup)
        self.region = _region(level)
        self.ovals = Ovals.of(level) if level.parted else None
        number = system.field.coerce
        nu, mean = self._means(system.body.rolls)
        found = nu[0] * mean, nu[1] * mean
        self.tau_frequencies, self.frequencies = tuple(map(number, nu)), tuple(map(number, found))
        self.wide_tau_frequencies, self.wide_frequencies = nu, found
        self.rotation_number, self.mean_g = number(nu[0] / nu[1]), number(mean)
        self.zeta = number(level.zeta)
        a1, a2, a3 = level.a
        self.distance = number((level.zeta - a2) / (a3 - a1)) if a3 > a1 else number(0)
        self.axis = None if self.ovals is None else level.axes[0] if level.low else level.axes[2]
        self.precession, self.spin, self.polhode = self._rates(setup)
        self.drift, self.mean_spin = self._rolling(system, state, setup.wide)

    @property
    def wide_turns(self) -> tuple[Real, Real]:
        """precession/π, and spin/π times the sign of the start's M̃ along ``axis``; to the digits of the set-up."""
        first, second = self.wide_frequencies
        return (first, second) if self.level.low else (-second, -first)

    @cached_property
    def actions(self) -> tuple[Real, Real] | None:
        """(J1, J2), in the unit of M. The actions of the torus in (γ, M), whose periods are doubled, are twice as
        large.
        """
        ovals, level = self._compact("actions"), self.level
        h2, pi = level.momentum**2, level.pi
        h1 = level.zeta * h2
        first, second = (h1 * ovals.A0 - h2 * ovals.A1) / pi, (h2 * ovals.B1 - h1 * ovals.B0) / pi
        return self._field.coerce(first), self._field.coerce(second)

    @cached_property
    def angles(self) -> tuple[Real, Real]:
        """(θ1, θ2) of the start in turns, modulo 1; at τ they are θ + ντ. θ_k are conjugate to 2πJ_k.

        The angles depend on the divisor only, and are 0 at (u1, u2) = (a₁, a₃): the eight states that share a divisor
        have the same angles. NotRepresentable for equal moments and rotations, where one point of the divisor is at
        rest and has no angle.
        """
        first, second = self.wide_angles("angles")
        return self._field.coerce(first), self._field.coerce(second)

    def wide_angles(self, name: str) -> tuple[Real, Real]:
        """:attr:`angles` to the digits of the set-up. ``name`` is the requested quantity, for the message of
        NotRepresentable.
        """
        self.moving(name)
        return start_angles(*self._given)

    @cached_property
    def periods(self) -> tuple[Real, Real]:
        """1/|f1| and 1/|f2|. For ζ < a₂ the body's ``axis`` makes half a turn about M̃ in space in the first period,
        and γ̃ makes half a turn about this axis in the second; for ζ > a₂ the periods are exchanged.
        """
        one, two = (abs(1 / f) for f in self.frequencies)
        return one, two

    def moving(self, name: str) -> Ovals:
        """``ovals``; NotRepresentable, with a message that begins with ``name``, where a point of the divisor rests."""
        if self.region in ("symmetric", "rotation"):
            raise NotRepresentable(
                f"{name}: in this motion ({self.region}) a point of the divisor rests, which does not know its angle"
            )
        return self._compact(name)

    def _compact(self, name: str) -> Ovals:
        if self.ovals is None:
            raise NotRepresentable(
                f"{name}: this motion ({self.region}) lies on no torus of dimension two, its ovals have met"
            )
        return self.ovals

    def _means(self, rolls: bool) -> tuple[tuple[Real, Real], Real]:
        """The frequencies (ν1, ν2) and the mean of g over t, in wide numbers."""
        level, ovals = self.level, self.ovals
        if ovals is None:
            # on the separatrix the limit of the motion is the rotation about the middle axis, with the rate a₂√H̃2 in
            # the time of the upright body
            (r1, _, r3), pi = level.contact, level.pi
            one = r1 / r1
            mean = 2 * complete(root(r3 / r1), one, one, one, pi, float(level.eps) ** 0.5 / 16) / (pi * root(r1))
            rate = level.a[1] * level.momentum / (pi * mean)
            return (rate, -rate), mean / level.s
        (r1, r2, r3), D = level.contact, ovals.D
        mean = 1 / (level.s * root(r1 * r2 * r3) * ovals.slowness) if rolls else D / D
        return (ovals.B1 / (2 * D), -ovals.A1 / (2 * D)), mean

    def _rates(self, setup: Setup) -> tuple[Real | None, Real | None, Real | None]:
        """The mean rates of precession, spin and polhode."""
        if self.axis is None:
            return None, None, None
        (turn, rest), pi, number = self.wide_turns, self.level.pi, self._field.coerce
        momentum = vectors(setup.problem.start, setup.problem.momentum, None)[1][self.axis]
        sign = pi if momentum > 0 else -pi
        return number(pi * turn), number(sign * rest), number(sign * (turn + rest))

    def _rolling(self, system: PhaseSpace, state: State, K: MultiprecisionField) -> tuple[Real | None, Real]:
        """The mean velocity of the point of contact and the mean of (γ, ω)."""
        zeta, number = self.level.zeta, self._field.coerce
        gamma, M = (tuple(map(K.coerce, v)) for v in state.vectors)
        c, size = K.dot(gamma, M) if state.tilted else K.zero, K.dot(gamma, gamma)
        spin = number(c * zeta / (1 - K.coerce(system.d) * zeta))
        if not system.body.rolls:
            return None, spin
        horizontal = K.sqrt(max(K.dot(M, M) - c * c / size, K.zero))
        drift = number(zeta * horizontal)
        return drift if system.radius is None else system.radius * drift, spin

    def _repr_html_(self) -> str:
        names = "region axis distance frequencies rotation_number precession spin polhode drift"
        return named("what the motion is", [(name, getattr(self, name)) for name in names.split()])

    def __repr__(self) -> str:
        f1, f2 = (float(f) for f in self.frequencies)
        return f"<Portrait: {self.region}, frequencies {f1:.6g} and {f2:.6g}, distance {float(self.distance):.3g}>"


def _region(level: Level) -> str:
    a1, a2, a3 = level.a
    near = level.eps**0.75 * a3
    if a1 == a3:
        return "homogeneous"
    if level.zeta - a1 <= near or a3 - level.zeta <= near:
        return "rotation"
    if abs(level.zeta - a2) <= near:
        return "separatrix"
    if a2 in (a1, a3):
        return "symmetric"
    return "low" if level.low else "high"


def start_angles(system: PhaseSpace, state: State, wide: MultiprecisionField, digits: int) -> tuple[Real, Real]:
    """The angles θ of the start, Σ∫(dx, x dx)/y = θ1·2(A0, A1) + θ2·2(B0, B1), modulo 1, with the integrals of
    :class:`integrable.portrait.ovals.Ovals`.

    They are computed to ``digits`` in the ``wide`` field. PrecisionLoss if the ovals have nearly met.
    """
    for lost in LOST:
        setup = Setup(system.body, *state.vectors, state.tilted, digits=wide.dps + lost)
        balls = BallReals(setup.reals.bits + 32)
        try:
            with balls:
                found = balls.elements(wide, OvalTorus(setup, balls, digits + SPARE, (1, 0)).start)
            break
        except PrecisionLoss:
            if lost == LOST[-1]:
                raise
    # the phases of an OvalTorus are 0 at the inner end of the second oval
    return phases(wide.one, (found[0], found[1] + wide.one / 2), wide)
