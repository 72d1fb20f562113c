"""The spherical pendulum: a heavy point on the sphere (Lagrange 1788).

q'' = −e_3 + (q_3 − |q'|²)q, |q| = 1, (q, q') = 0, in units where the length and the acceleration are 1. Let h = ½|q'|²
+ q_3, L = q_1q_2' − q_2q_1' and z = q_3. Then

    f = 2(1 − x²)(h − x) − L²,   U = x − z,   V = z',   m = (L, −L),   w = 0

in the notation of :mod:`integrable.classical.axial`, where g = q_1 + iq_2.
"""

from __future__ import annotations

from integrable.classical.axial import AxialSystem, Axis, heavy
from integrable.classical.axial_torus import AxialFlow
from integrable.mumford.flow import Point
from integrable.mumford.system import IntegralsByName
from jacobian import RR
from jacobian.element import FormulaField, Real
from jacobian.fields.protocol import Field, check_field
from jacobian.immutable import at_once


class SphericalPendulum(AxialSystem):
    """The spherical pendulum; a state has q, a point of the unit sphere with e_3 upwards, and p = q'."""

    flow_type = AxialFlow

    @at_once
    def __init__(self, field: Field = RR) -> None:
        vars(self)["field"] = check_field(field, "field")

    def _vector_field(self, N: FormulaField, state: Point) -> Point:
        # the division by |q|², which is 1 at a state, keeps (q, p) constant if rounding has moved q off the sphere
        rates = self._rational_rates(N, state, (self._auxiliary(N, state)[0] / N.dot(state.q, state.q),))
        return Point(rates[:3], rates[3:6])

    def _auxiliary(self, N: FormulaField, state: Point) -> tuple[Real, ...]:
        """The factor q_3 − |p|² = 3q_3 − 2h of q in q'': with it the equations of motion have the fewest products."""
        return (state.q[2] - N.dot(state.p, state.p),)

    def _rational_rates(self, N: FormulaField, state: Point, auxiliary: tuple[Real, ...]) -> tuple[Real, ...]:
        (x, y, z), (pull,) = state.q, auxiliary
        return *state.p, pull * x, pull * y, pull * z - 1, 3 * state.p[2]

    def _integrals(self, N: FormulaField, state: Point) -> IntegralsByName:
        q, p = state
        return {"h": N.dot(p, p) / 2 + q[2], "L": q[0] * p[1] - q[1] * p[0]}

    def _axis(self, N: FormulaField, state: Point) -> Axis:
        (x, y, z), (a, b, rate) = state
        along = self._integrals(N, state)["L"]
        return Axis(z, rate, (x, y), (a, b), (along, -along), N.zero)

    def _momentum(self, N: FormulaField, state: Point) -> Real:
        return self._integrals(N, state)["L"]

    def _curve(self, N: FormulaField, state: Point) -> tuple[Real, ...]:
        found = self._integrals(N, state)
        return heavy(N, found["h"], (found["L"],))
