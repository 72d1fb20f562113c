"""Kowalevski's top: the map from a state to its divisor, whose class moves linearly (Kowalevski 1889).

ω = (p, q, r). In the units used the moments are 2, 2, 1, and the weight times the distance of the centre of mass, which
is on the first axis, is 1. Then 2p' = qr, 2q' = −pr − γ_3, r' = γ_2, γ' = γ×ω, and with |γ| = 1 the integrals are

    6l_1 = 2(p² + q²) + r² − 2γ_1,   2l = 2(pγ_1 + qγ_2) + rγ_3,   k² = |(p + iq)² + γ_1 + iγ_2|²

With X = p² + q², e = 1 − k², R = −X² + 6l_1X + 4lp + e, R_1 = −6l_1X² − 4ep² − 8lpX + 6l_1e − 4l², the pair and the
curve are

    U = x² + Rx/(2q²) + R_1/(4q²),   V = ½U',   f = −(4s³ − g_2s − g_3)(x² − k²),   s = ½(x + l_1)
    g_2 = k² − 1 + 3l_1²,   g_3 = l_1(k² − 1 − l_1²) + l²

The genus is 2 and the direction is −2e_1. The inverse map from divisors to states is not rational and not implemented.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

from integrable.mumford.flow import MumfordFlow, Point, element
from integrable.mumford.surfaces import SurfaceSystem
from integrable.mumford.system import IntegralsByName, Spectral, all_of
from integrable.phase.body import cross
from integrable.phase.ways import times_in
from jacobian import RR, poly
from jacobian.element import FormulaField, Numbers, Real
from jacobian.errors import NotRepresentable
from jacobian.fields.protocol import Field, check_field


class KowalevskiTop(SurfaceSystem):
    """Kowalevski's top; a state has q = γ, the vertical, and p = ω, the angular velocity, both in the body frame."""

    size = 3
    _constraint_names = ("|γ| = 1",)

    def __init__(self, field: Field = RR) -> None:
        self.field = check_field(field, "field")

    def _vector_field(self, N: FormulaField, state: Point) -> Point:
        (_, y, z), (p, q, r) = state
        return Point(cross(N, *state), (q * r / 2, -(p * r + z) / 2, y))

    def _integrals(self, N: FormulaField, state: Point) -> IntegralsByName:
        """The integrals l_1, l, k² and |γ|²."""
        (x, y, z), (p, q, r) = state
        real, imaginary = p * p - q * q + x, 2 * p * q + y
        return {
            "l1": (2 * (p * p + q * q) + r * r - 2 * x) / 6,
            "l": (2 * (p * x + q * y) + r * z) / 2,
            "k squared": real * real + imaginary * imaginary,
            "gamma squared": N.dot(state.q, state.q),
        }

    def _spectral(self, N: FormulaField, state: Point) -> Spectral:
        p, q, _ = state.p
        if q == N.zero:
            raise NotRepresentable(f"{self!r}: at q = 0 a point of the divisor is at infinity; give another state")
        l1, along, square, _ = self._integrals(N, state).values()
        e, X = 1 - square, p * p + q * q
        of_p, of_q, _ = self._vector_field(N, state).p
        of_X = 2 * (p * of_p + q * of_q)
        R = -X * X + 6 * l1 * X + 4 * along * p + e
        R1 = -6 * l1 * X * X - 4 * e * p * p - 8 * along * p * X + 6 * l1 * e - 4 * along * along
        of_R = (6 * l1 - 2 * X) * of_X + 4 * along * of_p
        of_R1 = -12 * l1 * X * of_X - 8 * e * p * of_p - 8 * along * (of_p * X + p * of_X)
        half, growth = 1 / (2 * q * q), -2 * of_q / q
        u = (R1 * half / 2, R * half, N.one)
        v = ((of_R1 / 2 * half + u[0] * growth) / 2, (of_R * half + u[1] * growth) / 2)
        g2 = square - 1 + 3 * l1 * l1
        g3 = l1 * (square - 1 - l1 * l1) + along * along
        s = (l1 / 2, N.one / 2)
        cubic = poly.sub(N, poly.mul(N, poly.mul(N, s, s), (2 * l1, 2 * N.one)), poly.scale(N, g2, s))
        f = poly.mul(N, poly.sub(N, cubic, (g3,)), (square, N.zero, -N.one))
        return all_of(N, (f, u, v), 2)

    def _direction(self, N: FormulaField, genus: int) -> Sequence[Real]:
        return N.zero, poly.integer(N, -2)

    def flow(self, state: Point, tolerance: float | None = None) -> NoReturn:
        """Raises NotRepresentable: divisors do not determine states rationally; ``line`` returns the divisors."""
        raise NotRepresentable(
            f"{self!r} has no way back from divisors to states: line(state, times) gives the divisors"
        )

    def line(self, state: Point, times: Numbers) -> list[Spectral]:
        """The curve f and the pair u, v at the given times, over RR or MP(digits)."""
        self._check(state)
        K, flow, f = self.field, MumfordFlow(self, state), self.spectral(state).f
        found = []
        for time in times_in(K, times, "times").tolist():
            rows = flow._motion.row(time, lambda N, D: (D.u, D.v), flow.digits)
            found.append(Spectral(f, *(tuple(element(K, x) for x in row) for row in rows)))
        return found
