"""Lagrange's top: a heavy symmetric body with its centre of mass on its axis (Lagrange 1788).

M' = M×Ω + γ×e_3, γ' = γ×Ω, Ω = (M_1, M_2, jM_3), in units where the moments are 1, 1, 1/j and the weight times the
distance of the centre of mass is 1. Let c = M_3, L = (M, γ), h = ½(M_1² + M_2²) + γ_3 and z = γ_3. Then

    f = 2(1 − x²)(h − x) − (L − cx)²,   U = x − z,   V = z' = γ_1M_2 − γ_2M_1,   m = (L − c, L + c),   w = (1 − j)c

in the notation of :mod:`integrable.classical.axial`, where g = γ_1 + iγ_2, and M_1 + iM_2 = g((L − cz) + iz')/(1 − z²).
"""

from __future__ import annotations

from integrable.classical.axial import AxialSystem, Axis, heavy
from integrable.classical.axial_torus import AxialFlow
from integrable.mumford.flow import Point
from integrable.mumford.system import IntegralsByName
from integrable.phase.body import Vector, cross
from jacobian import RR
from jacobian.element import FormulaField, Real, Value
from jacobian.fields.protocol import Field, check_field
from jacobian.immutable import at_once


class LagrangeTop(AxialSystem):
    """Lagrange's top with ``j`` = I_1/I_3; a state has q = γ, the vertical, and p = M, the angular momentum.

    Both are in the body frame.
    """

    flow_type = AxialFlow
    _constraint_names = ("|γ| = 1",)

    @at_once
    def __init__(self, j: Value = 1, field: Field = RR) -> None:
        vars(self).update(field=check_field(field, "field"), parameters=(field.coerce(j, "j"),))

    def _vector_field(self, N: FormulaField, state: Point) -> Point:
        (x, y, _), (a, b, c) = state
        turn = self._parameters_in(N)[0] * c
        return Point(cross(N, state.q, (a, b, turn)), (b * (turn - c) + y, a * (c - turn) - x, a * b - b * a))

    def _integrals(self, N: FormulaField, state: Point) -> IntegralsByName:
        """The integrals h, L = (M, γ), c = M_3 and |γ|²."""
        (_, _, z), (a, b, c) = state
        return {"h": (a * a + b * b) / 2 + z, "L": N.dot(*state), "c": c, "gamma squared": N.dot(state.q, state.q)}

    def _axis(self, N: FormulaField, state: Point) -> Axis:
        (x, y, z), (_, _, c) = state
        rates = self._vector_field(N, state).q
        return Axis(z, rates[2], (x, y), rates[:2], self._at_ends(N, state), (1 - self._parameters_in(N)[0]) * c)

    @staticmethod
    def _at_ends(N: FormulaField, state: Point) -> tuple[Real, Real]:
        """m = ((M, q − e_3), (M, q + e_3)), without the difference 1 − |q_3|, which may round to 0."""
        (x, y, z), (a, b, c) = state
        along = x * a + y * b
        below, above = z - N.one, z + N.one
        if not N.exact and abs(z) > 0.5:
            flat = x * x + y * y
            below, above = (-flat / above, above) if z.real > 0 else (below, -flat / below)
        return along + c * below, along + c * above

    def _top(self, N: FormulaField, state: Point) -> Vector:
        c = state.p[2]
        return self._parameters_in(N)[0] * c, N.dot(*state), c

    def _momentum(self, N: FormulaField, state: Point) -> Real:
        # in the body frame γ turns against the rotation of the body
        return -state.p[2]

    def _curve(self, N: FormulaField, state: Point) -> tuple[Real, ...]:
        found = self._integrals(N, state)
        return heavy(N, found["h"], (found["L"], -found["c"]))
