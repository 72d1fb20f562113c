"""Veselova's system: a rigid body whose angular velocity stays orthogonal to a direction fixed in space.

(Veselov & Veselova 1986; Fedorov & Jovanović 2004.)

The equations are Iω' + ω×Iω = μγ with a multiplier μ, γ' = γ×ω and (γ, ω) = 0. With M = Iω − (Iω, γ)γ and A = I⁻¹:
γ' = γ×ω, M' = M×ω, (γ, M) = 0, ω = A(M − (γ, AM)γ/(γ, Aγ)). In the notation of :mod:`integrable.mumford.bodies`,
l(x) = x, a_i = 1/I_i,

    f = 4xΠ(a_i − x)(xH₂ − H₁),   dt = √(γ, Aγ) dτ

The point Aγ/√(γ, Aγ) moves along a geodesic of Σx_i²/a_i = 1. With respect to the time τ√(H₁ det A) the normal γ there
moves as the point of Neumann's system with the constants I_i.
"""

from __future__ import annotations

from collections.abc import Iterable

from integrable.mumford.bodies import BodySystem
from integrable.mumford.flow import Point
from jacobian import RR
from jacobian.element import FormulaField, Real, Value
from jacobian.errors import ArgumentError, shown
from jacobian.fields.protocol import Field
from jacobian.immutable import at_once


class Veselova(BodySystem):
    """A body with three different moments ``inertia``; a state has q = γ and p = M, the part of Iω orthogonal to γ.

    Example: ``system = Veselova((1, 2, 3))``, ``system.flow(system.state(q, p)).at(times)``. ``omega(state)`` is the
    angular velocity.
    """

    @at_once
    def __init__(self, inertia: Iterable[Value], field: Field = RR) -> None:
        self._set_up_moments(field, inertia)
        K = self.field
        if not K.exact and not all(isinstance(x, complex) or x > 0 for x in self.constants):
            raise ArgumentError(f"inertia = {shown(inertia)}: moments of inertia are positive")

    def omega(self, state: Point) -> tuple[Real, ...]:
        """The angular velocity ω in the body."""
        N = self.numbers
        return tuple(map(self._bare, self._omega(N, self._inside(N, state))))

    def _constants_in(self, N: FormulaField) -> tuple[Real, ...]:
        return tuple(N.one / N.coerce(moment) for moment in self.constants)

    def _light(self, N: FormulaField) -> tuple[Real, Real]:
        return N.zero, N.one

    def _weights(self, N: FormulaField) -> tuple[Real, ...]:
        return self._constants_in(N)
