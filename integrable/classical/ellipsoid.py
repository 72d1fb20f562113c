"""Geodesics on the ellipsoid Σx_i²/a_i = 1 in R^{n+1} (Jacobi 1839; Moser 1980).

The equation is x'' = −νA⁻¹x with v = x', constant |v| and ν = (Σv_i²/a_i)/(Σx_i²/a_i²). With f₁ = Π(x − a_i),
λ = Σx_iv_i, F_i = v_i² + Σ_j (x_iv_j − x_jv_i)²/(a_i − a_j):

    U = f₁Σ(x_i²/a_i)/(x − a_i),   V = f₁Σx_iv_i/(x − a_i) − λU,   f₁ΣF_i/(x − a_i) = xR(x),   f = −x·f₁·R

The roots of U are the elliptic coordinates, those of R the parameters of the caustics; the genus is n. The direction is
±2e_0 in τ with dt = |U(0)|dτ. With Ω = Σ∫x^n dx/y, of the second kind, t = −½Ω. Every addition of pairs also gives Ω,
so no quadrature is needed. At a branch point a_i the lift is (x_i, a_iv_i − λx_i).

The discretization adds (l, m) − (0, 0) to the divisor. The tangent meets the quadric Σy_i²/(a_i − l) = 1 at x + hv,
and Ivory's affinity y_i ↦ √(a_i/(a_i − l))·y_i leads back to the ellipsoid. The tangent backwards from the new point
meets this quadric after the same time h.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from integrable.mumford.flow import Point
from integrable.mumford.motion import Start
from integrable.mumford.surfaces import SurfaceSystem
from integrable.mumford.system import IntegralsByName, Spectral, all_of, uhlenbeck
from integrable.portrait.point_ovals import Form, Separation
from jacobian import RR, poly
from jacobian.element import FormulaField, Real, Value
from jacobian.errors import ArgumentError, PrecisionLoss, shown
from jacobian.fields.protocol import Field
from jacobian.immutable import at_once
from jacobian.inexact.long_field import LongField
from jacobian.relatives.extended import Extended, Lift, SecondKind

# largest number of Newton iterations for a step
MOST_STEPS = 100


class Ellipsoid(SurfaceSystem):
    """Geodesics on Σx_i²/a_i = 1, len(a) ≥ 2; the a_i are different, and positive over real fields.

    A state is a point q and a tangent vector p there. Time is length divided by |p|. With |p| = 1,
    ``flow(state).at(lengths)`` are the ends of geodesics of these lengths in the unit of √a (geodesy's direct problem).
    """

    _constraint_names = ("Σq_i²/a_i = 1", "Σq_i p_i/a_i = 0", "p ≠ 0")
    # with two axes the genus is 1, and t not linear in τ: these motions have no torus
    _least_axes = 3

    @at_once
    def __init__(self, a: Iterable[Value], field: Field = RR) -> None:
        self._set_up(field, a, "a", 2)
        if not field.exact and not all(isinstance(x, complex) or x > 0 for x in self.constants):
            raise ArgumentError(f"a = {shown(a)}: the squares of the semi-axes are positive")

    def _normal(self, N: FormulaField, q: Sequence[Real]) -> Sequence[Real]:
        return [x / e for x, e in zip(q, self._constants_in(N), strict=True)]

    def _spectral(self, N: FormulaField, state: Point) -> Spectral:
        q, p = state
        a = self._constants_in(N)
        u = (*self._sums(N, [x * x / e for x, e in zip(q, a, strict=True)])[:-1], N.one)
        slope = N.dot(q, p)
        mixed = self._sums(N, [x * y for x, y in zip(q, p, strict=True)])
        v = tuple(x - slope * y for x, y in zip(mixed[:-1], u, strict=False))
        # by the constraints Π(x − a_i)·ΣF_i/(x − a_i) vanishes at x = 0; ``rest`` is this polynomial divided by x
        rest = self._sums(N, self._momenta(N, state))[1:]
        f = poly.mul(N, poly.mul(N, (N.zero, -N.one), poly.from_roots(N, a)), rest)
        return all_of(N, (f, u, v), self.size - 1)

    def _momenta(self, N: FormulaField, state: Point) -> tuple[Real, ...]:
        """The integrals F_i."""
        return uhlenbeck(self._constants_in(N), state, [y * y for y in state.p])

    def _genus(self) -> int:
        return self.size - 1

    def _direction(self, N: FormulaField, genus: int) -> Sequence[Real]:
        return (poly.integer(N, 2 if genus % 2 == 0 else -2), *[N.zero] * (genus - 1))

    def _clock(self, N: FormulaField, D: Extended) -> tuple[Real, Real]:
        # dt/dτ = |U(0)|, and U(0) = (−1)^g·(the product of g positive roots)
        return -D.data[-1] / 2, D.u[0] if len(D.u) % 2 else -D.u[0]

    clocked = True

    def _separation(self, N: FormulaField, state: Point) -> Separation:
        f, genus = self._spectral(N, state).f, self._genus()
        forms = [Form((*[N.zero] * j, N.one)) for j in range(1, genus + 1)]
        # p dq = ½Σy dx/f₁, as for the systems of integrable.mumford.quadrics
        action = Form(poly.scale(N, N.one / 2, f), self._constants_in(N))
        known = (N.zero, *self._constants_in(N))
        return Separation(forms, (*[N.zero] * (genus - 1), -2 * N.one), action, known=known)

    def _vector_field(self, N: FormulaField, state: Point) -> Point:
        q, p = state
        normal = self._normal(N, q)
        pull = N.dot(self._normal(N, p), p) / N.dot(normal, normal)
        return Point(p, tuple(-(pull * x) for x in normal))

    def _integrals(self, N: FormulaField, state: Point) -> IntegralsByName:
        """The integrals F_i, |v|² = ΣF_i, and Joachimsthal's Σv_i²/a_i·Σx_i²/a_i²."""
        q, p = state
        normal = self._normal(N, q)
        return {
            "F": self._momenta(N, state),
            "speed squared": N.dot(p, p),
            "Joachimsthal": N.dot(self._normal(N, p), p) * N.dot(normal, normal),
        }

    def discrete(self, state: Point, h: Value) -> Point:
        """The state after a step that agrees with the motion for a time ``h`` to second order and preserves the
        integrals.

        It is the :meth:`step` by a point (λ, μ) with the λ < 0 for which q + hp is on the quadric Σy_i²/(a_i − λ) = 1.
        h < 0 is a step back.
        """
        step = self._time_step(h)

        def read(L: LongField) -> Point:
            inner, length = self._constrained(L, self._inside(L, state)), L.coerce(step)
            reached = [x + length * v for x, v in zip(*inner, strict=True)]
            squares, a, x = [y * y for y in reached], self._constants_in(L), L.zero
            for _ in range(MOST_STEPS):
                # Newton's method for 1/``total`` = 1. 1/``total`` is a concave function of −x, so the iterates decrease
                # monotonically from x = 0
                parts = [y / (e - x) for y, e in zip(squares, a, strict=True)]
                total = sum(parts, L.zero)
                slope = sum((part / (e - x) for part, e in zip(parts, a, strict=True)), L.zero)
                move = (total - 1) * total / slope
                if not move > L.eps * abs(x):
                    return self._moved(L, inner, x, length)
                x = x - move
            raise PrecisionLoss(f"h = {shown(step)}: the quadric that the step leads to was not found")

        return self._settled(read)

    def step(self, state: Point, point: Iterable[Value]) -> Point:
        """The state with the divisor D + (λ, μ) − (0, 0), where D is the divisor of ``state`` and (λ, μ) is ``point``.

        The tangents of both states meet the quadric Σy_i²/(a_i − λ) = 1. The new state is real for λ < 0. ArgumentError
        if the point is not on the curve; NotASquare if a_i/(a_i − λ) has no square root; NotRepresentable or
        PrecisionLoss if there is no such state, as for λ = a_i.
        """

        def formula(N: FormulaField, here: Point, x: Real, y: Real) -> Point:
            _, u, v = self._spectral(N, here)
            slope = (y - poly.evaluate(N, v, x)) / poly.evaluate(N, u, x) - N.dot(*here)
            return self._moved(N, here, x, x / slope)

        return self._mapped(state, point, formula)

    def _moved(self, N: FormulaField, state: Point, x: Real, h: Real) -> Point:
        """The state whose tangent, backwards, meets the quadric Σy_i²/(a_i − x) = 1 after the time ``h``, as the
        tangent of ``state`` does forwards.
        """
        a, slope = self._constants_in(N), x / h
        roots = [N.sqrt(e / (e - x)) for e in a]
        q = tuple(r * (y + h * v) for r, y, v in zip(roots, *state, strict=True))
        # p̃ = (q̃ − q/r)/h, in a form without cancellation for small steps
        return Point(q, tuple(r * (v + slope * y / e) for r, e, y, v in zip(roots, a, *state, strict=True)))

    def _start(self, N: FormulaField, state: Point) -> Start:
        f, u, v = self._spectral(N, state)
        a, slope = self._constants_in(N), N.dot(*state)
        slopes = poly.derivative(N, poly.from_roots(N, a))
        data = tuple((poly.evaluate(N, slopes, e) / e, x, e * y - slope * x) for e, x, y in zip(a, *state, strict=True))
        return Start(f, u, v, self._direction(N, len(v)), [*map(Lift, a), SecondKind()], (*data, N.zero))

    def _back(self, N: FormulaField, start: Point, D: Extended, time: Real) -> Point:
        slope = -D.v[0] / D.u[0]
        lifts = D.data[:-1]
        velocities = ((nu + slope * x) / e for e, (_, x, nu) in zip(self._constants_in(N), lifts, strict=True))
        return Point(tuple(x for _, x, _ in lifts), tuple(velocities))
