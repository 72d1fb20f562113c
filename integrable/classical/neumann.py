"""Neumann's system: a point on the sphere S^n in a quadratic potential (C. Neumann 1859; Moser 1980).

q, p ∈ R^(n+1), |q| = 1, (q, p) = 0, q' = p, p_i' = (m − a_i)q_i, m = Σa_i q_i² − |p|². With f₁ = Π(x − a_i), the pair
and the curve are

    U = f₁Σ q_i²/(x − a_i),   V = f₁Σ q_i p_i/(x − a_i),   W = −f₁(1 + Σ p_i²/(x − a_i)),   f = V² + UW = −f₁f₂

The genus is n and the direction is −2e_{n−1}; the roots of f₂ are constants of motion. (q_i, p_i) is the lift at the
branch point a_i, with κ = f₁'(a_i). So the signs of q_i and p_i are determined, also after the motion crosses a
coordinate plane.
"""

from __future__ import annotations

from collections.abc import Iterable
from operator import attrgetter

from integrable.mumford.flow import Point
from integrable.mumford.quadrics import QuadricSystem, Shape
from integrable.mumford.surfaces import SurfaceSystem
from integrable.mumford.system import IntegralsByName, uhlenbeck
from jacobian import RR
from jacobian.element import FormulaField, Real, Value
from jacobian.fields.protocol import Field
from jacobian.immutable import at_once


class Neumann(SurfaceSystem, QuadricSystem):
    """The motion on S^n in the potential ½Σa_i q_i², n + 1 = len(a) ≥ 2, with different a_i.

    Example: ``system = Neumann((1, 2, 4))``, ``system.flow(system.state(q, p)).at(times)``. Time is physical, and the
    a_i are in 1/time². ``step`` by a point (λ, μ) is the discretization of Moser and Veselov (1991); for λ → −∞ its
    time step is about 1/√−λ.
    """

    _largest: int
    _least_axes = 2

    @at_once
    def __init__(self, a: Iterable[Value], field: Field = RR) -> None:
        self._set_up(field, a, "a", 2)
        largest = 0 if field.exact else self.constants.index(max(self.constants, key=attrgetter("real")))
        vars(self)["_largest"] = largest

    def _shape(self, N: FormulaField, state: Point) -> Shape:
        return (), (), (-N.one,)

    def _genus(self) -> int:
        return self.size - 1

    def _vector_field(self, N: FormulaField, state: Point) -> Point:
        # the division by |q|², which is 1 at a state, keeps (q, p) constant if rounding has moved q off the sphere
        rates = self._rational_rates(N, state, (self._auxiliary(N, state)[0] / N.dot(state.q, state.q),))
        return Point(state.p, rates[self.size : -1])

    def _auxiliary(self, N: FormulaField, state: Point) -> tuple[Real, ...]:
        """The multiplier m, which is 2c − 2H + 2Σ(a_i − c)q_i² for any c. Its derivative needs few products.

        By rounding |q|² − 1 is not exactly 0; it moves as a product of two solutions of u'' = (m − c)u. With the
        largest a_i as c, these solutions grow no faster than the effect of a small change of the start.
        """
        return (N.dot(self._constants_in(N), [x * x for x in state.q]) - N.dot(state.p, state.p),)

    def _rational_rates(self, N: FormulaField, state: Point, auxiliary: tuple[Real, ...]) -> tuple[Real, ...]:
        a, (q, p), (m,) = self._constants_in(N), state, auxiliary
        c = a[self._largest]
        turn = sum((4 * (e - c) * (x * y) for e, x, y in zip(a, q, p, strict=True) if e is not c), N.zero)
        return *p, *((m - e) * x for e, x in zip(a, q, strict=True)), turn

    @property
    def _alike(self) -> tuple[object, ...]:
        return type(self), self.size, self._largest

    def _integrals(self, N: FormulaField, state: Point) -> IntegralsByName:
        """Uhlenbeck's F_i = q_i² + Σ_j (q_i p_j − q_j p_i)²/(a_i − a_j), ΣF_i = 1, and H = ½|p|² + ½Σa_i q_i²."""
        a, squares = self._constants_in(N), [x * x for x in state.q]
        return {"F": uhlenbeck(a, state, squares), "H": (N.dot(state.p, state.p) + N.dot(a, squares)) / 2}

    def discrete(self, state: Point, h: Value) -> Point:
        """The state after the :meth:`step` by a point with λ = −1/h², which agrees with the motion for a time ``h`` to
        second order; h < 0 is a step back.
        """
        genus = self.size - 1
        step = self._time_step(h)
        sign = 1 if (step > 0) == (genus % 2 == 0) else -1
        new = self.step(state, self.curve_point(state, -1 / (step * step), sign))
        # ``step`` takes positive square roots; for h < 0 they must be negative, which changes the signs of q and p
        return new if step > 0 else Point(tuple(-x for x in new.q), tuple(-y for y in new.p))
