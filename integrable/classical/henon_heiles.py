"""The Hénon–Heiles system of ratio 1:6, with any frequencies, any number of axes and inverse-square terms.

(Fordy 1991; Eilbeck, Enolskii, Kuznetsov & Tsiganov 1994.)

    H = ½(p_0² + |p|²) − 4αq_0³ − 2αq_0|q|² − β(2q_0² + ½|q|²) − ½αΣa_i q_i² − γq_0 + ½Σl_i²/q_i²
    q_0'' = 12αq_0² + 2α|q|² + 4βq_0 + γ,   q_i'' = (4αq_0 + β + αa_i)q_i + l_i²/q_i³

With α = −½ and one axis the potential is 2q_0³ + q_0q_1² plus any quadratic terms. In the notation of
:mod:`integrable.mumford.quadrics`, u₀ = x − 2q_0, ε = −1, w₀ = αx² + bx + c, b = β + 2αq_0, c = γ + 2βq_0 + 4αq_0² +
α|q|²; the genus is n + 1. If q_0 reaches infinity in finite time, the formulas continue the motion beyond that time.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from integrable.mumford.flow import Point
from integrable.mumford.quadrics import QuadricSystem, Shape
from integrable.mumford.system import IntegralsByName
from integrable.phase.body import elements
from jacobian import RR, poly
from jacobian.element import FormulaField, Real, Value
from jacobian.errors import ArgumentError, shown
from jacobian.fields.protocol import Field, check_field
from jacobian.immutable import at_once


class HenonHeiles(QuadricSystem):
    """The Hénon–Heiles system of q = (q_0, q_1 … q_n), n = len(a) ≥ 1, with different a_i and α ≠ 0.

    ``barriers`` are the l_i in the terms ½l_i²/q_i² of H, by default all 0.
    """

    sign = -1
    before = 1
    _constraint_names = ("q_i ≠ 0 where l_i ≠ 0",)

    @at_once
    def __init__(
        self,
        a: Iterable[Value],
        alpha: Value = "-1/2",
        beta: Value = 0,
        gamma: Value = 0,
        barriers: Iterable[Value] | None = None,
        field: Field = RR,
    ) -> None:
        self._set_up(field, a, "a", 1)
        axes = len(self.constants)
        heights = [0] * axes if barriers is None else barriers
        shape = (self.field.coerce(x, name) for x, name in ((alpha, "alpha"), (beta, "beta"), (gamma, "gamma")))
        parameters = (*shape, *elements(self.field, heights, "barriers", axes))
        if parameters[0] == self.field.zero:
            raise ArgumentError(f"alpha = {shown(alpha)}: a number other than 0 is needed")
        vars(self).update(parameters=parameters, size=axes + 1)

    @classmethod
    def with_frequencies(cls, first: Value, second: Value, field: Field = RR) -> HenonHeiles:
        """The system with H = ½(p_0² + p_1² + ω_0²q_0² + ω_1²q_1²) + 2q_0³ + q_0q_1², for frequencies ω_0, ω_1."""
        K = check_field(field, "field")
        A, B = (K.mul(x, x) for x in (K.coerce(first, "first"), K.coerce(second, "second")))
        quarter = K.div(A, poly.integer(K, 4))
        # the coefficients of q_0² and q_1² in H give −2β = ½A and −½β + ¼a = ½B
        a = K.sub(K.mul(poly.integer(K, 2), B), K.add(quarter, quarter))
        return cls((a,), K.div(K.neg(K.one), poly.integer(K, 2)), K.neg(quarter), field=K)

    @property
    def arguments(self) -> dict[str, object]:
        alpha, beta, gamma, *barriers = self.parameters
        return {"a": self.constants, "alpha": alpha, "beta": beta, "gamma": gamma, "barriers": tuple(barriers)}

    @property
    def _varied(self) -> dict[str, float]:
        # for l_i ≠ 0 the motion turns back before q_i = 0, for l_i = 0 it does not, so at l_i = 0 the states are no
        # smooth functions of l_i
        found = super()._varied
        walls = list(found)[-len(self.constants) :]
        return {**found, **{name: 0.0 for name, x in zip(walls, self._barriers(), strict=True) if not self._stands(x)}}

    def _constraints(self, N: FormulaField, state: Point) -> Sequence[Real]:
        stands = any(self._stands(e) and x == N.zero for e, x in zip(self._barriers(), state.q[1:], strict=True))
        return (N.one if stands else N.zero,)

    def _barriers(self) -> Sequence[Real]:
        return self.parameters[3:]

    def _shape(self, N: FormulaField, state: Point) -> Shape:
        alpha, beta, gamma, *_ = self._parameters_in(N)
        first, *q = state.q
        b = beta + 2 * alpha * first
        c = gamma + 2 * beta * first + 4 * alpha * first * first + alpha * N.dot(q, q)
        return (-2 * first, N.one), (-state.p[0],), (c, b, alpha)

    def _genus(self) -> int:
        return self.size

    def _first(self, N: FormulaField, u: poly.Poly, v: poly.Poly) -> Point:
        return Point((-(sum(self._constants_in(N), u[-2])) / 2,), (-v[-1],))

    def _vector_field(self, N: FormulaField, state: Point) -> Point:
        alpha, beta, gamma, *_ = self._parameters_in(N)
        first, *q = state.q
        common = 4 * alpha * first + beta
        rates = [12 * alpha * first * first + 2 * alpha * N.dot(q, q) + 4 * beta * first + gamma]
        for a, barrier, x, pull in zip(self._constants_in(N), self._barriers(), q, self._pull(N, state), strict=True):
            rates.append((common + alpha * a) * x + (pull / x if self._stands(barrier) else pull))
        return Point(state.p, tuple(rates))

    def _integrals(self, N: FormulaField, state: Point) -> IntegralsByName:
        """The integrals: H, and the coefficients of f."""
        alpha, beta, gamma, *_ = self._parameters_in(N)
        first, *q = state.q
        square = N.dot(q, q)
        energy = (N.dot(state.p, state.p) + sum(self._pull(N, state), N.zero)) / 2
        energy = energy - 4 * alpha * first**3 - 2 * alpha * first * square - gamma * first
        energy = energy - beta * (2 * first * first + square / 2)
        energy = energy - alpha * N.dot([e * x for e, x in zip(self._constants_in(N), q, strict=True)], q) / 2
        return {"H": energy, "curve": self._spectral(N, state).f}
