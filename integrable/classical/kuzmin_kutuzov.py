"""Stars in the galaxy of Kuzmin and Kutuzov (1962; Dejonghe & de Zeeuw 1988), by spheroidal coordinates.

With P = √(a²c² + c²R² + a²z²) and S = √(R² + z² + a² + c² + 2P) the potential is −GM/S. S and P are the sum and the
product of s = √λ, √ν, where λ and ν are the roots of R²/(τ − a²) + z²/(τ − c²) = 1. With A = (q, p), B = c²(xẋ + yẏ) +
a²zż and the integrals E, L about the axis, and I = ½(L_x² + L_y²) + (a² − c²)(½ż² + GM z²/(S(c² + cS + P))),

    U = s² − Ss + P,   V = ASs − AP − B,   f = 2(s² − c²)P₄,
    P₄ = E(s² − a²)(s² − c²) + GM(s − c)(s² − a²) − ½L²(s² − c²) − I(s² − a²).

The genus is 2, Σs ds/y = 0 and dt = Σs(s² − c²)ds/y, which is −PS dτ in the direction e_0. The azimuth grows by
LΣs(s² − c²)/(s² − a²) ds/y, and p dq without it is Σs y ds/((s² − a²)(s² − c²)). z has the sign of a lift at s = c. If
L = 0, R has the sign of a lift at s = a.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from integrable.mumford.columns import Columns
from integrable.mumford.flow import BITS_OF_TORUS, ON_TORUS, TO_TORUS, TORUS, MumfordFlow, Path, Point
from integrable.mumford.motion import settled_digits
from integrable.mumford.phase_torus import PhaseTorus
from integrable.mumford.system import MumfordSystem, Spectral, all_of
from integrable.phase.enclosure import EnclosedPath
from integrable.portrait.point_ovals import Form, Separation
from integrable.portrait.separated import SeparatedTorus
from jacobian import RR, poly
from jacobian.errors import ArgumentError, NotRepresentable, shown
from jacobian.inexact.long_field import LongField
from jacobian.relatives.extended import Extended


class KuzminKutuzov(MumfordSystem):
    """A star in a galaxy with the axes (a, c), two different positive numbers, and the mass ``GM``.

    The galaxy is flattened for a > c. q is the position, z the axis of the galaxy, and p the velocity.
    """

    size = 3
    clocked = True

    def __init__(self, axes: Any, GM: Any = 1, field: Any = RR) -> None:
        self._set_up(field, axes, "axes", 2)
        self.parameters, self.size = (self.field.coerce(GM, "GM"),), 3
        if len(self.constants) != 2 or not (field.exact or all(x > 0 for x in (*self.constants, *self.parameters))):
            raise ArgumentError(
                f"axes = {shown(axes)}, GM = {shown(GM)}: two different positive numbers and a positive one are needed"
            )

    def _squares(self, N: Any) -> tuple[Any, Any]:
        a, c = self._constants_in(N)
        return a * a, c * c

    def _auxiliary(self, N: Any, state: Point) -> tuple[Any, Any]:
        """The roots P and S at a position, as in the potential."""
        a, c = self._squares(N)
        x, y, z = state.q
        flat, high = x * x + y * y, z * z
        product = N.sqrt(a * c + c * flat + a * high)
        return product, N.sqrt(flat + high + a + c + 2 * product)

    def _along(self, N: Any, state: Point) -> tuple[Any, Any]:
        """The sums A = (q, p) and B = c²(xẋ + yẏ) + a²zż."""
        a, c = self._squares(N)
        flat, high = N.dot(state.q[:2], state.p[:2]), state.q[2] * state.p[2]
        return flat + high, c * flat + a * high

    def _rational_rates(self, N: Any, state: Point, auxiliary: tuple[Any, ...]) -> tuple[Any, ...]:
        (a, c), (x, y, z), (product, total) = self._squares(N), state.q, auxiliary
        A, B = self._along(N, state)
        pull = -self._parameters_in(N)[0] / (total * total * total)
        flat = pull * (1 + c / product)
        rate = B / product
        return (*state.p, flat * x, flat * y, pull * (1 + a / product) * z, rate, (A + rate) / total)

    def _vector_field(self, N: Any, state: Point) -> Point:
        found = self._rational_rates(N, state, self._auxiliary(N, state))
        return Point(found[:3], found[3:6])

    def _integrals(self, N: Any, state: Point) -> dict[str, Any]:
        """The integrals: the energy E, the angular momentum L about the axis, and I."""
        (a, c), (x, y, z), (u, v, w), half = self._squares(N), state.q, state.p, 1 / N.coerce(poly.integer(N, 2))
        (product, total), mass = self._auxiliary(N, state), self._parameters_in(N)[0]
        first, second = y * w - z * v, z * u - x * w
        beyond = c + self._constants_in(N)[1] * total + product
        turned = half * (first * first + second * second)
        third = turned + (a - c) * (half * w * w + mass * z * z / (total * beyond))
        return {"E": half * N.dot(state.p, state.p) - mass / total, "L": x * v - y * u, "I": third}

    def _quartic(self, N: Any, state: Point) -> poly.Poly:
        """The polynomial 2P₄ of a state."""
        (a, c), (energy, along, third) = self._squares(N), self._integrals(N, state).values()
        round_, flat = (-a, N.zero, N.one), (-c, N.zero, N.one)
        found: poly.Poly = poly.scale(N, 2 * energy, poly.mul(N, round_, flat))
        mass = 2 * self._parameters_in(N)[0]
        found = poly.add(N, found, poly.scale(N, mass, poly.mul(N, (-self._constants_in(N)[1], N.one), round_)))
        rest = poly.add(N, poly.scale(N, along * along, flat), poly.scale(N, 2 * third, round_))
        return poly.sub(N, found, rest)

    def _spectral(self, N: Any, state: Point) -> Spectral:
        (product, total), (A, B) = self._auxiliary(N, state), self._along(N, state)
        f = poly.mul(N, self._quartic(N, state), (-self._squares(N)[1], N.zero, N.one))
        return all_of(N, (f, (product, -total, N.one), (-A * product - B, A * total)), 2)

    def _genus(self) -> int:
        return 2

    def _direction(self, N: Any, genus: int) -> Sequence[Any]:
        return N.one, N.zero

    def _time_rate(self, N: Any, u: poly.Poly) -> Any:
        return u[0] * u[1]

    def _separation(self, N: Any, state: Point) -> Separation:
        (a, c), along = self._constants_in(N), self._integrals(N, state)["L"]
        still, time = (N.zero, N.one), (N.zero, -c * c, N.zero, N.one)
        action = Form((N.zero, *self._quartic(N, state)), (a, -a))
        # the forms have no poles at L = 0, where a is a branch point
        turn = Form((N.zero,)) if along == 0 else Form(poly.scale(N, along, time), (a, -a))
        known = (c, -c) if along != 0 else (c, -c, a, -a)
        return Separation([Form(still), Form(time)], (N.zero, N.one), action, [(turn, N.zero)], (along,), known)

    def flow(self, state: Point, tolerance: float | None = None) -> StarFlow:
        """The motion of a star over RR or MP(digits), at any times; if it is unbound, E ≥ 0, at times near the start.

        ``tolerance`` is that of :meth:`integrable.mumford.system.MumfordSystem.flow`.
        """
        self._check_range(state)
        return StarFlow(self, state, self._tolerance(tolerance))

    def _back(self, N: Any, start: Point, D: Extended, time: Any) -> Point:
        """The state of a pair with (σ, V/σ) at c, and cos and sin of the azimuth since the start.

        If L = 0, (σ, V/σ) at a replaces cos and sin, and R, with a sign, is counted along the half plane of the start.
        """
        (a, c), (long, short) = self._squares(N), self._constants_in(N)
        side, (v0, v1), (product, total) = 1 if self.constants[0] > self.constants[1] else -1, D.v, (D.u[0], -D.u[1])
        wide, A = side * (a - c), v1 / total
        # z² = |U(c)|U(−c)/|a² − c²|, R² = |U(a)|U(−a)/|a² − c²|, and z ż and R R' follow from V there
        (sigma, slope), *axis = D.data
        scale = N.sqrt((c + short * total + product) / wide)
        z, rise = sigma * scale, -(side * slope + A * sigma) / (wide * scale)
        beyond, ahead = (a + long * total + product) / wide, self._ahead(N, start)
        if len(axis) == 1:
            ((sigma, slope),), scale = axis, N.sqrt(beyond)
            radius, rate, spin = sigma * scale, (side * slope - A * sigma) / (wide * scale), N.zero
        else:
            inside, (cosine, sine) = a - long * total + product, axis
            radius = N.sqrt(-side * inside * beyond)
            rate = side * (v0 + v1 * long + A * inside) / (wide * radius)
            spin = self._integrals(N, start)["L"] / radius
            ahead = ahead[0] * cosine - ahead[1] * sine, ahead[0] * sine + ahead[1] * cosine
        (x, y) = ahead
        return Point((radius * x, radius * y, z), (rate * x - spin * y, rate * y + spin * x, rise))

    def _ahead(self, N: Any, state: Point) -> tuple[Any, Any]:
        """The horizontal unit vector of q, or of p if q is on the axis."""
        for x, y, _ in state:
            size = N.sqrt(x * x + y * y)
            if size != 0:
                return x / size, y / size
        return N.one, N.zero


class StarFlow(MumfordFlow):
    """The motion of a star: far times by the sums over both ovals (:mod:`integrable.portrait.separated`)."""

    _takes_theta = False

    def __init__(self, system: KuzminKutuzov, state: Point, tolerance: float | None = None) -> None:
        super().__init__(system, state, tolerance)
        self._tori = dict[int, tuple[SeparatedTorus, Callable[[Any, Any, Any], Point]]]()

    def _budget(self, count: int) -> float:
        return TO_TORUS[3] + count * ON_TORUS[3]

    def _separated(self, N: LongField) -> SeparatedTorus:
        if not self.system.integrals(self.start)["E"] < 0:
            raise NotRepresentable("E ≥ 0: this star is unbound, and its far motion lies on no torus")
        return super()._separated(N)

    def _made_torus(self) -> PhaseTorus:
        with LongField(BITS_OF_TORUS) as N:
            torus = self._separated(N)
            read = self._states_on(N, torus)
            return PhaseTorus(torus, lambda halves, turned: read(Columns(), halves, turned))

    def _far(self, given: list[Any]) -> Path:
        # near the axis double-doubles may not resolve the motion; then the sums are computed in long numbers
        found = super()._far(given)
        return Path(found.times, found.q, found.p, TORUS)

    def _path(self, torus: Any, times: Any) -> Path:
        zero = 0 * times
        q, p = (np.stack([x.hi + zero for x in part], axis=1) for part in torus.at(times))
        return Path(times, q, p, TORUS)

    def _row(self, time: Any) -> Any:
        return settled_digits(lambda N: self._state(N, time), self.digits)

    def _state(self, N: LongField, time: Any) -> Point:
        """The state at a time in long numbers."""
        import gmpy2

        if N.bits not in self._tori:
            torus = self._separated(N)
            self._tori[N.bits] = torus, self._states_on(N, torus)
        torus, read = self._tori[N.bits]
        angles, turned = torus.angles_at(N.coerce(time))
        sine, cosine = gmpy2.sin_cos(turned[0])
        return read(N, [gmpy2.sin_cos(phi / 2) for phi in angles], [(cosine, sine)])

    def _ends(self, N: LongField) -> list[Any]:
        a, c = self.system._constants_in(N)
        return [c, a] if self.system._integrals(N, self._inner(N))["L"] == 0 else [c]

    def _states_on(self, N: LongField, torus: SeparatedTorus) -> Callable[[Any, Any, Any], Point]:
        ends, inner = self._ends(N), self._inner(N)

        def unsigned(K: Any, halves: Any, turned: Any) -> Point:
            u, v, lifts = torus.pair_at(K, halves, ends)
            data = lifts if len(lifts) == 2 else [*lifts, *turned[0]]
            start = Point(*(tuple(map(K.coerce, part)) for part in inner))
            found: Point = self.system._back(K, start, Extended(u, v, tuple(data)), None)
            return found

        # the signs of z and, if L = 0, of R
        found = unsigned(N, torus.halves, [(N.one, N.zero)])
        x, y, z = (a * b + c * d for a, b, c, d in zip(found.q, inner.q, found.p, inner.p, strict=True))
        signs = (out := -1 if x + y < 0 else 1, out, -1 if z < 0 else 1)

        def read(K: Any, halves: Any, turned: Any) -> Point:
            q, p = unsigned(K, halves, turned)
            return Point(*(tuple(s * x for s, x in zip(signs, part, strict=True)) for part in (q, p)))

        return read

    def enclosure(self, times: Any, digits: int | None = None) -> EnclosedPath:
        """Raises ArgumentError: the sums over ovals have no proven bounds."""
        raise ArgumentError(f"times = {shown(times)}: the sums of {self.system!r} over ovals have no proven bounds")

    def enclosure_at_tau(self, tau: Any, digits: int | None = None) -> EnclosedPath:
        """Raises ArgumentError: the sums over ovals have no proven bounds in τ either."""
        return self.enclosure(tau, digits)
