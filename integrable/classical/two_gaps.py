"""A two-gap solution of the Korteweg–de Vries equation u_t = 6uu_x − u_xxx as a function of t at one fixed x.

(Novikov 1974; Dubrovin, Novikov & Matveev 1976.) A two-gap potential satisfies an ordinary differential equation of
order four in x. So the t-derivative of (u, u_x, u_xx, u_xxx) at a fixed x is a polynomial in these four numbers: the
partial differential equation is solved without a grid. In the notation of :mod:`integrable.classical.kdv`, with s_k the
elementary symmetric functions of the five edges,

    U = x² + Fx + G,   V = ½∂U/∂x,   F = (u − s_1)/2,   G = 3u²/8 − s_1u/4 − u_xx/8 + s_2/2 − s_1²/8
    ½G_xx = −s_3 − 2FG + u(F² + 2G) − ½FF_xx + ¼F_x²

The second line is the equation of order four. Its constants are s_1, s_2, s_3; its integrals are s_4 and s_5.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from integrable.mumford.flow import Point
from integrable.mumford.system import IntegralsByName, MumfordSystem, Spectral, all_of
from integrable.phase.body import Vector, elements
from jacobian import RR, poly
from jacobian.element import FormulaField, Real, Value
from jacobian.fields.protocol import Field, check_field
from jacobian.relatives.extended import Extended


class TwoGaps(MumfordSystem):
    """Two-gap solutions at a fixed x; a state has q = (u, u_xx) and p = (u_x, u_xxx).

    ``sums`` are the elementary symmetric functions s_1, s_2, s_3 of the edges.

    Example: ``system = TwoGaps((0, -5, 0))``, with the edges −2, −1, 0, 1, 2 and the state ``system.state((-4, 28), (0,
    0))``.
    """

    size = 2

    def __init__(self, sums: Iterable[Value], field: Field = RR) -> None:
        self.field = check_field(field, "field")
        wanted = "a sequence of the first three elementary symmetric functions of the five edges"
        self.parameters = elements(self.field, sums, "sums", 3, wanted)

    @property
    def arguments(self) -> dict[str, object]:
        return {"sums": self.parameters}

    def _jets(self, N: FormulaField, state: Point) -> tuple[Vector, Vector]:
        """(F, F_x, F_xx) and (G, G_x, G_xx)."""
        s1, s2, s3 = self._parameters_in(N)
        (u, u2), (u1, u3) = state
        F, F1, F2 = (u - s1) / 2, u1 / 2, u2 / 2
        G = (3 * u * u - 2 * s1 * u - u2 - s1 * s1) / 8 + s2 / 2
        G2 = 2 * (u * (F * F + 2 * G) - s3 - 2 * F * G) - F * F2 + F1 * F1 / 2
        return (F, F1, F2), (G, (6 * u * u1 - 2 * s1 * u1 - u3) / 8, G2)

    def _vector_field(self, N: FormulaField, state: Point) -> Point:
        s1, _, _ = self._parameters_in(N)
        (u, u2), (u1, u3) = state
        _, (G, G1, G2) = self._jets(N, state)
        G3 = 4 * u * G1 + 2 * u1 * G
        G4 = 6 * u1 * G1 + 4 * u * G2 + 2 * u2 * G
        # u4, u5 and u6 are the second, third and fourth derivatives of u_xx = 3u² − 2s_1u − 8G + const
        u4 = 6 * (u1 * u1 + u * u2) - 2 * s1 * u2 - 8 * G2
        u5 = 6 * (3 * u1 * u2 + u * u3) - 2 * s1 * u3 - 8 * G3
        u6 = 6 * (3 * u2 * u2 + 4 * u1 * u3 + u * u4) - 2 * s1 * u4 - 8 * G4
        return Point(
            (6 * u * u1 - u3, 6 * (3 * u1 * u2 + u * u3) - u5),
            (6 * (u1 * u1 + u * u2) - u4, 6 * (3 * u2 * u2 + 4 * u1 * u3 + u * u4) - u6),
        )

    def _integrals(self, N: FormulaField, state: Point) -> IntegralsByName:
        u = state.q[0]
        (F, F1, F2), (G, G1, G2) = self._jets(N, state)
        return {
            "s4": G * G - 2 * u * F * G + (F * G2 + G * F2 - F1 * G1) / 2,
            "s5": u * G * G - G * G2 / 2 + G1 * G1 / 4,
        }

    def _spectral(self, N: FormulaField, state: Point) -> Spectral:
        s1, s2, s3 = self._parameters_in(N)
        (F, F1, _), (G, G1, _) = self._jets(N, state)
        found = self._integrals(N, state)
        f = (found["s5"], -found["s4"], s3, -s2, s1, -N.one)
        return all_of(N, (f, (G, F, N.one), (G1 / 2, F1 / 2)), 2)

    def _direction(self, N: FormulaField, genus: int) -> Sequence[Real]:
        s1, _, _ = self._parameters_in(N)
        return (poly.integer(N, -8), -4 * s1)

    def _back(self, N: FormulaField, start: Point, D: Extended, time: Real) -> Point:
        s1, s2, _ = self._parameters_in(N)
        G, F = D.u[:2]
        G1, F1 = (2 * x for x in D.v)
        u, u1 = 2 * F + s1, 2 * F1
        u2 = 3 * u * u - 2 * s1 * u - s1 * s1 + 4 * s2 - 8 * G
        return Point((u, u2), (u1, 6 * u * u1 - 2 * s1 * u1 - 8 * G1))
