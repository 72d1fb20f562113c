"""Neumann's system: a point on the sphere S^n in a quadratic potential (C. Neumann 1859; Moser 1980).

q, p ∈ R^(n+1), |q| = 1, (q, p) = 0, q' = p, p' = −a_i q_i + m q_i, m = Σa_i q_i² − |p|². With f₁ = Π(x − a_i):

    U = f₁Σ q_i²/(x − a_i),   V = f₁Σ q_i p_i/(x − a_i),   W = −f₁(1 + Σ p_i²/(x − a_i)),   f = V² + UW = −f₁f₂

of genus n, direction −2e_{n−1}; the roots of f₂ are constants. (q_i, p_i) is the lift at the branch point a_i, up to
f₁'(a_i), so that signs, and axes that the motion crosses, take care of themselves.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from integrable.mumford.motion import Start
from integrable.mumford.system import MumfordSystem, Point, Spectral, all_of, uhlenbeck
from jacobian import RR, poly
from jacobian.relatives.extended import Extended, Lift


class Neumann(MumfordSystem):
    """The motion on S^n in the potential ½Σa_i q_i², n + 1 = len(a) ≥ 2, the a_i different.

    ``Neumann((1, 2, 4)).flow(system.state(q, p)).at(times)``; time is physical, in units where a is 1/time².
    """

    _constraint_names = ("|q| = 1", "(q, p) = 0")

    def __init__(self, a: Any, field: Any = RR) -> None:
        self._set_up(field, a, "a", 2)

    def __repr__(self) -> str:
        return f"Neumann({self.constants}, {self.field.name})"

    def _constraints(self, N: Any, state: Point) -> Sequence[Any]:
        return N.dot(state.q, state.q) - N.one, N.dot(state.q, state.p)

    def _constrained(self, N: Any, state: Point) -> Point:
        size = N.sqrt(N.dot(state.q, state.q))
        q = tuple(x / size for x in state.q)
        along = N.dot(q, state.p)
        return Point(q, tuple(y - along * x for x, y in zip(q, state.p, strict=True)))

    def _spectral(self, N: Any, state: Point) -> Spectral:
        q, p = state
        u = self._sums(N, [x * x for x in q])
        v = self._sums(N, [x * y for x, y in zip(q, p, strict=True)])
        f1 = poly.from_roots(N, self._constants_in(N))
        w = poly.neg(N, poly.add(N, f1, self._sums(N, [y * y for y in p])))
        # the leading coefficients are those of the constraints, 1 and 0
        u, v = (*u[:-1], N.one), v[:-1]
        f = poly.add(N, poly.mul(N, v, v), poly.mul(N, u, w))
        return all_of(N, (f, u, v), self.size - 1)

    def _direction(self, N: Any, genus: int) -> Sequence[Any]:
        return (*[N.zero] * (genus - 1), N.coerce(poly.integer(N, -2)))

    def _vector_field(self, N: Any, state: Point) -> Point:
        q, p = state
        a = self._constants_in(N)
        m = N.dot(a, [x * x for x in q]) - N.dot(p, p)
        return Point(p, tuple((m - e) * x for e, x in zip(a, q, strict=True)))

    def _integrals(self, N: Any, state: Point) -> dict[str, Any]:
        """Uhlenbeck's F_i = q_i² + Σ_j (q_i p_j − q_j p_i)²/(a_i − a_j), ΣF_i = 1, and H = ½|p|² + ½Σa_i q_i²."""
        a, squares = self._constants_in(N), [x * x for x in state.q]
        return {"F": uhlenbeck(a, state, squares), "H": (N.dot(state.p, state.p) + N.dot(a, squares)) / 2}

    def _start(self, N: Any, state: Point) -> Start:
        f, u, v = self._spectral(N, state)
        a = self._constants_in(N)
        # U(a_i) = d_i q_i², V(a_i) = d_i q_i p_i with d_i = f₁'(a_i)
        slopes = poly.derivative(N, poly.from_roots(N, a))
        data = tuple((poly.evaluate(N, slopes, e), x, y) for e, x, y in zip(a, state.q, state.p, strict=True))
        return Start(f, u, v, self._direction(N, len(v)), [Lift(e) for e in a], data)

    def _back(self, N: Any, start: Point, D: Extended, time: Any) -> Point:
        return Point(tuple(x for _, x, _ in D.data), tuple(y for _, _, y in D.data))

    def step(self, state: Point, point: Sequence[Any], roots: Sequence[Any] | None = None) -> Point:
        """The state of D + (λ, μ) − ∞, one step of the discretization of Moser and Veselov (1991).

        ``point`` = (λ, μ) with μ² = f(λ); q̃ = A⁻¹(p + cq), p̃ = −Aq + cq̃, A = diag√(a_i − λ), ``roots`` over an
        exact field if other ones are to be taken; c = (μ − V(λ))/U(λ). For λ → −∞ it is a step of about 1/√−λ in time,
        or back, by the sign of μ. ArgumentError for a point that is not on the curve, NotASquare for a missing root.
        """

        def formula(N: Any, here: Point, x: Any, y: Any) -> Point:
            _, u, v = self._spectral(N, here)
            a = [N.sqrt(e - x) for e in self._constants_in(N)] if roots is None else [*map(N.coerce, roots)]
            c = (y - poly.evaluate(N, v, x)) / poly.evaluate(N, u, x)
            q = tuple((p + c * q) / r for q, p, r in zip(here.q, here.p, a, strict=True))
            return Point(q, tuple(c * new - r * old for new, old, r in zip(q, here.q, a, strict=True)))

        return self._mapped(state, point, formula)
