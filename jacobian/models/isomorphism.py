"""Isomorphisms of hyperelliptic curves: x' = (ax + b)/(cx + d), y' = (ey + t(x))/(cx + d)^(g+1).

From genus 2 on every isomorphism over the field has this form. Let h₁ = eh − 2t and f₁ = e²f + eht − t², as forms of
degree g + 1 and 2g + 2 in (x, 1), and δ = ad − bc. Then y² + hy = f becomes

    y'² + h₁(dx' − b, a − cx')/δ^(g+1) y' = f₁(dx' − b, a − cx')/δ^(2g+2).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Any, overload

from jacobian import poly
from jacobian.curve.curve import HyperellipticCurve, check_curve, coefficient
from jacobian.curve.points import INFINITY, INFINITY_MINUS, INFINITY_PLUS, AffinePoint, Point, PointAtInfinity
from jacobian.errors import ArgumentError, CurveMismatch, FieldError, entries, shown
from jacobian.fields.factor import without_root
from jacobian.immutable import Immutable
from jacobian.law.divisor import Divisor
from jacobian.relatives.formal_sum import FormalSum


class Isomorphism(Immutable):
    """The isomorphism from ``source`` by ``matrix`` = (a, b, c, d), ``scale`` e and ``move`` t, the ascending
    coefficients of a polynomial of degree at most g + 1. The field is exact.

    ``target``: the curve that it maps to. ``iso(P)`` and ``iso(D)`` are the images of points and divisors; ``other *
    iso`` is ``iso`` followed by ``other``. ArgumentError for ad = bc, e = 0 and a longer t. The argument
    ``infinity_plus`` chooses the point ∞₊ of the target.
    """

    def __init__(
        self,
        source: HyperellipticCurve,
        matrix: Sequence[Any],
        scale: Any = 1,
        move: Any = (),
        infinity_plus: Any = None,
    ) -> None:
        K = check_curve(source).field
        if not K.exact:
            raise FieldError(f"field = {K.name}: isomorphisms are written over exact fields")
        self.source = source
        wanted = "the four numbers a, b, c, d"
        numbers = entries(matrix, "matrix", wanted)
        if len(numbers) != 4:
            raise ArgumentError(f"matrix = {shown(matrix)}: {wanted} are needed")
        self.matrix: tuple[Any, Any, Any, Any] = tuple(K.coerce(x, "matrix") for x in numbers)
        self.scale, self.move = K.coerce(scale, "scale"), poly.trim(K, poly.coerce(K, move, "move", constant=True))
        if K.is_zero(self.determinant) or K.is_zero(self.scale):
            raise ArgumentError(f"matrix = {shown(matrix)}, scale = {shown(scale)}: ad − bc and e must not vanish")
        if len(self.move) > source.genus + 2:
            raise ArgumentError(f"move = {poly.text(K, self.move)}: its degree is at most g + 1 = {source.genus + 1}")
        self.target = self._target(infinity_plus)

    @property
    def determinant(self) -> Any:
        """The determinant ad − bc of the matrix."""
        K, (a, b, c, d) = self.source.field, self.matrix
        return K.sub(K.mul(a, d), K.mul(b, c))

    def _target(self, infinity_plus: Any) -> HyperellipticCurve:
        C, e, t = self.source, self.scale, self.move
        K, n = C.field, C.genus + 1
        eh = poly.scale(K, e, C.h)
        h = poly.sub(K, eh, poly.add(K, t, t))
        f = poly.add(K, poly.scale(K, K.mul(e, e), C.f), poly.mul(K, t, poly.sub(K, eh, t)))
        size = K.inv(_power(K, self.determinant, n))
        h, f = self._back(h, n), self._back(f, 2 * n)
        return HyperellipticCurve(K, poly.scale(K, K.mul(size, size), f), poly.scale(K, size, h), infinity_plus)

    def _back(self, form: poly.Poly, degree: int) -> poly.Poly:
        """The form k(x, z) of this degree at (dx' − b, a − cx'), a polynomial in x'."""
        K, (a, b, c, d) = self.source.field, self.matrix
        return substituted(K, form, degree, (d, K.neg(b), K.neg(c), a))

    @overload
    def __call__(self, what: Divisor) -> Divisor: ...

    @overload
    def __call__(self, what: Any) -> Point: ...

    def __call__(self, what: Any) -> Any:
        """The image of a point or class of ``source``; NotOnCurve for other points, CurveMismatch for other classes."""
        if isinstance(what, Divisor):
            return self._divisor(what)
        P = self.source.check_point(what)
        return self._infinite(P) if isinstance(P, PointAtInfinity) else self._affine(P)

    def _affine(self, P: AffinePoint) -> Point:
        K, (a, b, c, d) = self.source.field, self.matrix
        below = K.add(K.mul(c, P.x), d)
        y = K.add(K.mul(self.scale, P.y), poly.evaluate(K, self.move, P.x))
        above, n = K.add(K.mul(a, P.x), b), self.source.genus + 1
        if K.is_zero(below):
            return self._named(K.div(y, _power(K, above, n)))
        return AffinePoint(K.div(above, below), K.div(y, _power(K, below, n)))

    def _infinite(self, P: PointAtInfinity) -> Point:
        C = self.source
        K, (a, _, c, _), n = C.field, self.matrix, C.genus + 1
        z = C.infinity_minus if P == INFINITY_MINUS else C.infinity_plus
        z = K.add(K.mul(self.scale, z), coefficient(K, self.move, n))
        if K.is_zero(c):
            return self._named(K.div(z, _power(K, a, n)))
        return AffinePoint(K.div(a, c), K.div(z, _power(K, c, n)))

    def _named(self, z: Any) -> PointAtInfinity:
        """The point at infinity of the target where y/x^(g+1) is z."""
        if self.target.model == "ramified":
            return INFINITY
        return INFINITY_PLUS if z == self.target.infinity_plus else INFINITY_MINUS

    def _divisor(self, D: Divisor) -> Divisor:
        C, E = self.source, self.target
        K, (_, _, c, d) = C.field, self.matrix
        if D.jacobian.curve != C:
            raise CurveMismatch(f"D = {D!r} lies on {D.jacobian.curve!r}, the isomorphism begins at {C!r}")
        weights, u = FormalSum.from_divisor(D).weights, D.u
        points: list[tuple[Any, int]] = []
        if not K.is_zero(c):
            x = K.neg(K.div(d, c))
            m, u = without_root(K, u, x)
            if m:
                points.append((AffinePoint(x, poly.evaluate(K, D.v, x)), m))
        total = FormalSum(E, self._pair(u, D.v))
        if C.model == "inert":
            total = total + self._fibre(weights[0])
        else:
            points += zip(C.points_at_infinity(), weights, strict=True)
        for P, count in points:
            total = total + count * FormalSum.from_points(E, [self(P)])
        return total.divisor()

    def _pair(self, u: poly.Poly, v: poly.Poly) -> tuple[poly.Poly, poly.Poly]:
        """The image of a pair (u, v) none of whose points is mapped to infinity."""
        K, (a, b, c, d) = self.source.field, self.matrix
        u = poly.monic(K, self._back(u, len(u) - 1))
        _, inverse = poly.half_xgcd(K, u, poly.trim(K, (a, K.neg(c)))) if len(u) > 1 else ((), ())
        x = poly.mod(K, poly.mul(K, poly.trim(K, (K.neg(b), d)), inverse), u)
        y: poly.Poly = ()
        for k in reversed(poly.add(K, poly.scale(K, self.scale, v), self.move)):
            y = poly.mod(K, poly.add(K, poly.mul(K, y, x), poly.trim(K, (k,))), u)
        # cx + d = δ/(a − cx')
        factor = poly.scale(K, K.inv(self.determinant), (a, K.neg(c)))
        for _ in range(self.source.genus + 1):
            y = poly.mod(K, poly.mul(K, y, poly.trim(K, factor)), u)
        return u, y

    def _fibre(self, weight: int) -> FormalSum:
        """``weight`` times the image of the sum of the two conjugate points at infinity of an inert model."""
        E, K, (a, _, c, _) = self.target, self.source.field, self.matrix
        if K.is_zero(c):
            return FormalSum(E, weights=(weight,))
        one, product = (K.one,), poly.from_roots(K, [K.div(a, c)] * abs(weight))
        return FormalSum(E, fibres=(product, one) if weight > 0 else (one, product))

    def inverse(self) -> Isomorphism:
        """The inverse isomorphism, from ``target`` to ``source``."""
        C, K, (a, b, c, d) = self.source, self.source.field, self.matrix
        n, e = C.genus + 1, K.inv(self.scale)
        move = poly.scale(K, K.neg(e), self._back(self.move, n))
        scale = K.mul(e, _power(K, self.determinant, n))
        plus = C.infinity_plus if C.model == "split" else None
        return Isomorphism(self.target, (d, K.neg(b), K.neg(c), a), scale, move, plus)

    def __mul__(self, other: Any) -> Isomorphism:
        if not isinstance(other, Isomorphism):
            return NotImplemented
        if other.target != self.source:
            raise CurveMismatch(f"the second isomorphism begins at {self.source!r}, the first ends at {other.target!r}")
        K, n = self.source.field, self.source.genus + 1
        (a, b, c, d), (p, q, r, s) = self.matrix, other.matrix
        rows = ((a, b), (c, d))
        matrix = [K.dot(row, column) for row in rows for column in ((p, r), (q, s))]
        move = poly.add(K, poly.scale(K, self.scale, other.move), substituted(K, self.move, n, other.matrix))
        plus = self.target.infinity_plus if self.target.model == "split" else None
        return Isomorphism(other.source, matrix, K.mul(self.scale, other.scale), move, plus)

    def _value(self) -> tuple[object, ...]:
        """The matrix M, e and t scaled: (λM, λ^(g+1)e, λ^(g+1)t) is the same map; λM begins with 1, or with 0 and 1."""
        K = self.source.field
        unit = K.inv(next(x for x in self.matrix if not K.is_zero(x)))
        power = _power(K, unit, self.source.genus + 1)
        numbers = [K.mul(unit, x) for x in self.matrix] + [K.mul(power, x) for x in (self.scale, *self.move)]
        return self.source, self.target, tuple(map(K.key, numbers))

    def __repr__(self) -> str:
        K, (a, b, c, d) = self.source.field, self.matrix
        above, below = poly.text(K, poly.trim(K, (b, a))), poly.text(K, poly.trim(K, (d, c)))
        n = self.source.genus + 1
        return f"x' = ({above})/({below}), y' = ({self.scale}·y + {poly.text(K, self.move)})/({below})^{n}"


def substituted(K: Any, form: poly.Poly, degree: int, matrix: Sequence[Any]) -> poly.Poly:
    """Σ k_i (ax + b)^i (cx + d)^(degree − i), where the k_i are the coefficients of ``form``."""
    a, b, c, d = matrix
    above, below = poly.trim(K, (b, a)), poly.trim(K, (d, c))
    result: poly.Poly = ()
    power: poly.Poly = (K.one,)
    # Horner's rule in ax + b; ``power`` is (cx + d)^(degree − i)
    for i in range(degree, -1, -1):
        result = poly.mul(K, result, above)
        result = poly.add(K, result, poly.scale(K, coefficient(K, form, i), power))
        power = poly.mul(K, power, below)
    return poly.trim(K, result)


def _power(K: Any, x: Any, n: int) -> Any:
    return reduce(K.mul, [x] * n, K.one)
