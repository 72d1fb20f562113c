"""Common formulas of the systems of Neumann, Garnier, and Hénon and Heiles, whose potentials separate in elliptic or
parabolic coordinates (Eilbeck, Enolskii, Kuznetsov & Tsiganov 1994).

Let f₁ = Π(x − a_i) with constants a_i, let l_i be constants, ε = ±1, and u₀ and w₀ polynomials. With the positions q_i
and momenta p_i on the axes

    U = f₁(u₀ + εΣ q_i²/(x − a_i)),   V = ½U',   W = f₁(w₀ − εΣ (p_i² + l_i²/q_i²)/(x − a_i)),   f = V² + UW

The direction is −2e_{g−1}. If l_i = 0, a_i is a branch point and (q_i, p_i) is the lift there. So the sign of q_i is
determined, also after q_i passes 0. If l_i ≠ 0, q_i does not vanish and keeps its sign.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from integrable.mumford.fields import padded
from integrable.mumford.flow import Point
from integrable.mumford.maps import plus_point
from integrable.mumford.motion import Start
from integrable.mumford.system import OFF, MumfordSystem, Spectral, all_of
from integrable.phase.body import elements
from integrable.portrait.point_ovals import Form
from jacobian import poly
from jacobian.element import FormulaField, Real
from jacobian.errors import ArgumentError, shown
from jacobian.relatives.extended import Extended, Lift

Shape = tuple[poly.Poly, poly.Poly, poly.Poly]
"""The polynomials u₀, ½u₀' and w₀ at a state."""


class QuadricSystem(MumfordSystem):
    """Base class of the systems of Neumann, Garnier, and Hénon and Heiles; ``constants`` are the a_i."""

    sign = 1
    """The sign ε."""
    before = 0
    """The number of coordinates q without an axis; they come first."""

    def _shape(self, N: FormulaField, state: Point) -> Shape:
        """Defined by subclasses: the polynomials u₀, ½u₀' and w₀ of a state."""
        raise NotImplementedError

    def _first(self, N: FormulaField, u: poly.Poly, v: poly.Poly) -> Point:
        """Defined by subclasses with ``before`` > 0: the first ``before`` coordinates q, to which no a_i belong, and
        their momenta p, from a pair.
        """
        return Point((), ())

    def _barriers(self) -> Sequence[Real]:
        """Defined by subclasses: the constants l_i of the terms l_i²/q_i² of W, elements of the field."""
        return [self.field.zero] * len(self.constants)

    # --- derived from the methods above

    def _axes(self, state: Point) -> Point:
        return Point(state.q[self.before :], state.p[self.before :])

    def _pull(self, N: FormulaField, state: Point) -> list[Real]:
        q, _ = self._axes(state)
        return [(N.coerce(e) / x) ** 2 if self._stands(e) else N.zero for e, x in zip(self._barriers(), q, strict=True)]

    def _stands(self, barrier: Real) -> bool:
        return bool(barrier != self.field.zero)

    def _spectral(self, N: FormulaField, state: Point) -> Spectral:
        (q, p), (u0, v0, w0) = self._axes(state), self._shape(N, state)
        f1 = poly.from_roots(N, self._constants_in(N))

        def with_poles(over: poly.Poly, weights: Sequence[Real]) -> poly.Poly:
            return poly.add(N, poly.mul(N, f1, over), self._sums(N, [self.sign * x for x in weights]))

        u = with_poles(u0, [x * x for x in q])
        v = with_poles(v0, [x * y for x, y in zip(q, p, strict=True)])
        w = with_poles(w0, [-(y * y + pull) for y, pull in zip(p, self._pull(N, state), strict=True)])
        # coefficients that the constraints fix are set to their exact values
        u, v = (*padded(N, u, self._genus()), N.one), padded(N, v, self._genus())
        f = poly.add(N, poly.mul(N, v, v), poly.mul(N, u, w))
        return all_of(N, (f, u, v), self._genus())

    def _direction(self, N: FormulaField, genus: int) -> Sequence[Real]:
        return (*[N.zero] * (genus - 1), poly.integer(N, -2))

    def _action(self, N: FormulaField, state: Point) -> Form:
        """The form ½εy dx/f₁, whose sum over the points of a pair is p dq.

        This follows from dq_i/q_i = ½Σdx/(x − a_i), p_i q_i = εV(a_i)/f₁'(a_i) and ΣV(a_i)/(f₁'(a_i)(x − a_i)) = V/f₁.
        """
        return Form(poly.scale(N, self.sign * N.one / 2, self._spectral(N, state).f), self._constants_in(N))

    def _branches(self, N: FormulaField) -> tuple[Real, ...]:
        found = zip(self._constants_in(N), self._barriers(), strict=True)
        return tuple(e for e, barrier in found if not self._stands(barrier))

    def _start(self, N: FormulaField, state: Point) -> Start:
        f, u, v = self._spectral(N, state)
        # U(a_i) = εd_i q_i², V(a_i) = εd_i q_i p_i with d_i = f₁'(a_i)
        free = [axis for axis in self._along_axes(N, state) if not self._stands(axis[2])]
        data = tuple((slope, x, y) for _, slope, _, x, y in free)
        return Start(f, u, v, self._direction(N, len(v)), [Lift(axis[0]) for axis in free], data)

    def _along_axes(self, N: FormulaField, state: Point) -> Iterator[tuple[Real, ...]]:
        """(a_i, εd_i, l_i, q_i, p_i) for each axis, with d_i = f₁'(a_i) and ε, l_i and f₁ of the module's docstring."""
        a = self._constants_in(N)
        slopes = poly.derivative(N, poly.from_roots(N, a))
        signed = [self.sign * poly.evaluate(N, slopes, e) for e in a]
        return zip(a, signed, self._barriers(), *self._axes(state), strict=True)

    def _back(self, N: FormulaField, start: Point, D: Extended, time: Real) -> Point:
        data, (q, p) = iter(D.data), self._first(N, D.u, D.v)
        for e, slope, barrier, before, _ in self._along_axes(N, start):
            if not self._stands(barrier):
                _, x, y = next(data)
            else:
                # q_i keeps its sign
                x = before * N.sqrt(poly.evaluate(N, D.u, e) / (slope * before * before))
                y = poly.evaluate(N, D.v, e) / (slope * x)
            q, p = (*q, x), (*p, y)
        return Point(q, p)

    def step(self, state: Point, point: tuple[Real, Real], roots: Sequence[Real] | None = None) -> Point:
        """The state of D + (λ, μ) − ∞, where D is the pair of ``state``; all l_i must be 0.

        The map is canonical and commutes with the motion. ``point`` is (λ, μ) with μ² = f(λ). On the axes
        q̃ = A⁻¹(p + cq), p̃ = −Aq + cq̃ with A = diag√(−ℓ(a_i − λ)), ℓ the leading coefficient of f, and
        c = (μ − V(λ))/U(λ). ``roots`` replaces the square roots in A. For large λ the map is a time step of about
        1/√(ℓλ), forward or backward by the sign of μ. ArgumentError if the point is not on the curve, NotASquare if a
        square root does not exist.
        """
        if any(map(self._stands, self._barriers())):
            raise ArgumentError(f"{self!r} has no steps: all its barriers would have to be 0")
        count = len(self.constants)
        wanted = f"a sequence of {count} square roots of ℓ(λ - a_i)"
        chosen = None if roots is None else elements(self.field, roots, "roots", count, wanted)

        def formula(N: FormulaField, here: Point, x: Real, y: Real) -> Point:
            f, u, v = self._spectral(N, here)
            given = [f[-1] * (x - e) for e in self._constants_in(N)]
            a = [*map(N.sqrt, given)] if chosen is None else [*map(N.coerce, chosen)]
            if chosen is not None and any(self._differ(r * r, x) for r, x in zip(a, given, strict=True)):
                raise ArgumentError(f"roots = {shown(roots)}: their squares are not ℓ(λ - a_i), {shown(given)}")
            c = (y - poly.evaluate(N, v, x)) / poly.evaluate(N, u, x)
            old = self._axes(here)
            q = tuple((p + c * q) / r for q, p, r in zip(*old, a, strict=True))
            p = tuple(c * new - r * old for new, old, r in zip(q, old.q, a, strict=True))
            first = self._first(N, *plus_point(N, f, (u, v), (x, y))) if self.before else Point((), ())
            return Point((*first.q, *q), (*first.p, *p))

        return self._mapped(state, point, formula)

    def _differ(self, x: Real, y: Real) -> bool:
        """Whether two numbers differ; over an inexact field, by more than rounding."""
        K: Any = self.field
        return bool(x != y if K.exact else abs(x - y) > OFF * K.eps * abs(y))
