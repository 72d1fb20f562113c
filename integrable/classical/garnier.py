"""Garnier's system: a point in a quartic potential of any dimension (Garnier 1919).

q_i'' = (αa_i + β − 2α|q|²)q_i, H = ½|p|² − ½Σ(αa_i + β)q_i² + ½α|q|⁴: an anisotropic oscillator with arbitrary
frequencies and an isotropic quartic term. In the notation of :mod:`integrable.mumford.quadrics`,

    u₀ = 1,   w₀ = αx + β − α|q|²

and the genus is n, the number of axes. For α > 0 all motions are bounded.
"""

from __future__ import annotations

from collections.abc import Iterable

from integrable.mumford.flow import Point
from integrable.mumford.quadrics import QuadricSystem, Shape
from integrable.mumford.system import IntegralsByName
from jacobian import RR
from jacobian.element import FormulaField, Value
from jacobian.errors import ArgumentError, shown
from jacobian.fields.protocol import Field
from jacobian.immutable import at_once


class Garnier(QuadricSystem):
    """Garnier's system with n = len(a) ≥ 1 axes, different a_i and α ≠ 0.

    Example: ``system = Garnier((0, 1, 3))``, ``system.flow(system.state(q, p)).at(times)``.

    The squared frequencies of small oscillations about q = 0 are −αa_i − β.
    """

    _least_axes = 1

    @at_once
    def __init__(self, a: Iterable[Value], alpha: Value = 1, beta: Value = 0, field: Field = RR) -> None:
        self._set_up(field, a, "a", 1)
        vars(self)["parameters"] = field.coerce(alpha, "alpha"), field.coerce(beta, "beta")
        if self.parameters[0] == self.field.zero:
            raise ArgumentError(f"alpha = {shown(alpha)}: a number other than 0 is needed")

    def _shape(self, N: FormulaField, state: Point) -> Shape:
        alpha, beta = self._parameters_in(N)
        return (N.one,), (), (beta - alpha * N.dot(state.q, state.q), alpha)

    def _genus(self) -> int:
        return self.size

    def _vector_field(self, N: FormulaField, state: Point) -> Point:
        alpha, beta = self._parameters_in(N)
        common = beta - 2 * alpha * N.dot(state.q, state.q)
        return Point(
            state.p, tuple((alpha * e + common) * x for e, x in zip(self._constants_in(N), state.q, strict=True))
        )

    def _integrals(self, N: FormulaField, state: Point) -> IntegralsByName:
        """The integrals: H, and the coefficients of f."""
        alpha, beta = self._parameters_in(N)
        square = N.dot(state.q, state.q)
        linear = N.dot([(alpha * e + beta) * x for e, x in zip(self._constants_in(N), state.q, strict=True)], state.q)
        return {
            "H": (N.dot(state.p, state.p) - linear + alpha * square * square) / 2,
            "curve": self._spectral(N, state).f,
        }
