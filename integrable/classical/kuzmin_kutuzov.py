"""Stars in the galaxy of Kuzmin and Kutuzov (1962; Dejonghe & de Zeeuw 1988), by spheroidal coordinates.

With R² = x² + y², P = √(a²c² + c²R² + a²z²) and S = √(R² + z² + a² + c² + 2P) the potential is −GM/S. S and P are the
sum and the product of √λ and √ν, the abscissas s of the pair; λ and ν are the roots of R²/(τ − a²) + z²/(τ − c²) = 1.
With A = (q, p), B = c²(xẋ + yẏ) + a²zż, the energy E, the angular momentum L about the axis, and I = ½(L_x² + L_y²) +
(a² − c²)(½ż² + GM z²/(S(c² + cS + P))),

    U = s² − Ss + P,   V = ASs − AP − B,   f = 2(s² − c²)P₄,
    P₄ = E(s² − a²)(s² − c²) + GM(s − c)(s² − a²) − ½L²(s² − c²) − I(s² − a²).

The genus is 2, Σs ds/y = 0 and dt = Σs(s² − c²)ds/y, which is −PS dτ in the direction e_0. The azimuth grows by LΣs(s²
− c²)/(s² − a²) ds/y, and p dq without the azimuth's part is Σs y ds/((s² − a²)(s² − c²)). z has the sign of a lift at
s = c. If L = 0, R has the sign of a lift at s = a.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from integrable.mumford.flow import ON_TORUS, TORUS, MumfordFlow, Point
from integrable.mumford.motion import Start, Vectors
from integrable.mumford.phase_torus import PhaseTorus
from integrable.mumford.system import IntegralsByName, MumfordSystem, Spectral, all_of
from integrable.phase.body import cross
from integrable.phase.enclosure import Enclosure
from integrable.portrait.point_ovals import Form, Separation
from jacobian import RR, poly
from jacobian.element import FormulaField, Real, Value
from jacobian.errors import ArgumentError, NotRepresentable, shown
from jacobian.fields.protocol import Field
from jacobian.relatives.extended import Extended, Lift


class SummedFlow(MumfordFlow):
    """The motion of a state by sums over ovals (:mod:`integrable.portrait.separated`) instead of additions."""

    # states in long numbers are computed by sums over the ovals, as those in floats are, so their ``way`` is TORUS too
    _long_way = TORUS

    def _budget(self, count: int) -> float:
        return ON_TORUS[3].of(count)

    def _made_torus(self) -> PhaseTorus:
        return self._made_phase_torus()

    def _row(self, time: Real) -> Vectors:
        return self._summed(time)

    def _enclosed(self, times: list[Real], digits: int, in_tau: bool) -> Enclosure:
        raise ArgumentError(f"times = {shown(times)}: the sums of {self.system!r} over ovals have no proven bounds")


class KuzminKutuzov(MumfordSystem):
    """A star in a galaxy with the axes (a, c), two different positive numbers, and the mass ``GM``.

    The galaxy is flattened for a > c. q is the position, z the axis of the galaxy, and p the velocity. The motion of an
    unbound star, E ≥ 0, is computed only at times near the start.
    """

    size, clocked, flow_type = 3, True, SummedFlow
    # orbits through the axis, L = 0, have one more lift
    _for_all_states = False

    def __init__(self, axes: Iterable[Value], GM: Value = 1, field: Field = RR) -> None:
        self._set_up(field, axes, "axes", 2)
        self.parameters, self.size = (self.field.coerce(GM, "GM"),), 3
        if len(self.constants) != 2 or not (field.exact or all(x > 0 for x in (*self.constants, *self.parameters))):
            raise ArgumentError(
                f"axes = {shown(axes)}, GM = {shown(GM)}: two different positive numbers and a positive one are needed"
            )

    def _squares(self, N: FormulaField) -> tuple[Real, Real]:
        a, c = self._constants_in(N)
        return a * a, c * c

    def _auxiliary(self, N: FormulaField, state: Point) -> tuple[Real, Real]:
        """The square roots P and S of the module's docstring; the potential is −GM/S."""
        a, c = self._squares(N)
        x, y, z = state.q
        product = N.sqrt(a * c + c * (x * x + y * y) + a * z * z)
        return product, N.sqrt(N.dot(state.q, state.q) + a + c + 2 * product)

    def _along(self, N: FormulaField, state: Point) -> tuple[Real, Real]:
        """A = (q, p) and B = c²(xẋ + yẏ) + a²zż."""
        a, c = self._squares(N)
        flat, high = N.dot(state.q[:2], state.p[:2]), state.q[2] * state.p[2]
        return flat + high, c * flat + a * high

    def _rational_rates(self, N: FormulaField, state: Point, auxiliary: tuple[Real, ...]) -> tuple[Real, ...]:
        (a, c), (x, y, z), (product, total) = self._squares(N), state.q, auxiliary
        A, B = self._along(N, state)
        pull, rate = -self._parameters_in(N)[0] / (total * total * total), B / product
        flat = pull * (1 + c / product)
        return (*state.p, flat * x, flat * y, pull * (1 + a / product) * z, rate, (A + rate) / total)

    def _vector_field(self, N: FormulaField, state: Point) -> Point:
        found = self._rational_rates(N, state, self._auxiliary(N, state))
        return Point(found[:3], found[3:6])

    def _integrals(self, N: FormulaField, state: Point) -> IntegralsByName:
        """The integrals: the energy E, the angular momentum L about the axis, and I."""
        (a, c), z, rise = self._squares(N), state.q[2], state.p[2]
        (product, total), mass = self._auxiliary(N, state), self._parameters_in(N)[0]
        first, second, along = cross(N, *state)
        pull = mass * z * z / (total * (c + self._constants_in(N)[1] * total + product))
        third = (first * first + second * second) / 2 + (a - c) * (rise * rise / 2 + pull)
        return {"E": N.dot(state.p, state.p) / 2 - mass / total, "L": along, "I": third}

    def _quartic(self, N: FormulaField, state: Point) -> poly.Poly:
        """The polynomial 2P₄ of the module's docstring."""
        (a, c), (energy, along, third) = self._squares(N), self._integrals(N, state).values()
        mass = 2 * self._parameters_in(N)[0]
        inner = (-2 * (energy * c + third) - mass * self._constants_in(N)[1], mass, 2 * energy)
        flat = poly.scale(N, along * along, (-c, N.zero, N.one))
        return poly.sub(N, poly.mul(N, (-a, N.zero, N.one), inner), flat)

    def _spectral(self, N: FormulaField, state: Point) -> Spectral:
        (product, total), (A, B) = self._auxiliary(N, state), self._along(N, state)
        f = poly.mul(N, self._quartic(N, state), (-self._squares(N)[1], N.zero, N.one))
        return all_of(N, (f, (product, -total, N.one), (-A * product - B, A * total)), 2)

    def _genus(self) -> int:
        return 2

    def _direction(self, N: FormulaField, genus: int) -> Sequence[Real]:
        return N.one, N.zero

    def _separation(self, N: FormulaField, state: Point) -> Separation:
        (a, c), (energy, along, _) = self._constants_in(N), self._integrals(N, state).values()
        if not energy < 0:
            raise NotRepresentable("E ≥ 0: this star is unbound, and its far motion lies on no torus")
        still, time = (N.zero, N.one), (N.zero, -c * c, N.zero, N.one)
        action = Form((N.zero, *self._quartic(N, state)), (a, -a))
        # if L = 0, the point s = a is a branch point, and the azimuth does not change
        turn = Form((N.zero,)) if along == 0 else Form(poly.scale(N, along, time), (a, -a))
        known = (c, -c) if along != 0 else (c, -c, a, -a)
        return Separation([Form(still), Form(time)], (N.zero, N.one), action, [(turn, N.zero)], (along,), known)

    def _start(self, N: FormulaField, state: Point) -> Start:
        """The lift of z at s = c; if L = 0, also that of R at s = a, where R is positive on the half plane of
        ``state``.

        |e² − e'²|x² = |U(e)|U(−e) for (e, x) = (c, z) and (a, R), where e' is the other axis; ẋ follows from V(e).
        """
        (f, u, v), (long, short), (q, p) = self._spectral(N, state), self._constants_in(N), state
        ahead, moved = self._ahead(N, state), [(short, self._side, q[2], p[2])]
        if self._integrals(N, state)["L"] == 0:
            moved.append((long, -self._side, N.dot(ahead, q[:2]), N.dot(ahead, p[:2])))
        data = []
        for e, kappa, x, rate in moved:
            wide, scale = self._scales(N, u, e)
            data.append((N.coerce(kappa), x / scale, v[1] / u[1] * x / scale - wide * scale * rate))
        return Start(f, u, v, self._direction(N, 2), [Lift(e) for e, *_ in moved], tuple(data))

    def _back(self, N: FormulaField, start: Point, D: Extended, time: Real) -> Point:
        """The state of ``D``, whose data are the lifts of :meth:`_start`, and cos and sin of the azimuth's change."""
        *lifts, (cosine, sine) = D.data
        (a, c), (x, y), turn, spin = self._constants_in(N), self._ahead(N, start), D.v[1] / D.u[1], N.zero
        if len(lifts) == 1:
            # if L ≠ 0, the star never meets the axis R = 0, and the lift σ at s = a is a positive root
            sigma = N.sqrt(-(self._side * poly.evaluate(N, D.u, a)))
            lifts.append((-self._side, sigma, -(self._side * poly.evaluate(N, D.v, a)) / sigma))
            spin = self._integrals(N, start)["L"] / (sigma * self._scales(N, D.u, a)[1])
        moved = []
        for e, (_, sigma, nu) in zip((c, a), lifts, strict=True):
            wide, scale = self._scales(N, D.u, e)
            moved.append((sigma * scale, (turn * sigma - nu) / (wide * scale)))
        (z, rise), (radius, rate) = moved
        x, y = x * cosine - y * sine, x * sine + y * cosine
        return Point((radius * x, radius * y, z), (rate * x - spin * y, rate * y + spin * x, rise))

    @property
    def _side(self) -> int:
        """The sign of a − c."""
        return 1 if self.constants[0] > self.constants[1] else -1

    def _scales(self, N: FormulaField, u: poly.Poly, e: Real) -> tuple[Real, Real]:
        """|a² − c²|, and √(U(−e)/|a² − c²|), by which the lift at s = e is multiplied to give z or R."""
        a, c = self._squares(N)
        wide = self._side * (a - c)
        return wide, N.sqrt(poly.evaluate(N, u, -e) / wide)

    @staticmethod
    def _ahead(N: FormulaField, state: Point) -> tuple[Real, Real]:
        """The horizontal unit vector of q, or of p if q is on the axis."""
        for x, y, _ in state:
            size = N.sqrt(x * x + y * y)
            if size != 0:
                return x / size, y / size
        return N.one, N.zero
