"""Formal sums of points, divisors of functions, and the curve y = P(x) through two divisors (exact fields).

A divisor Σ m_P P over the field is stored as

    div(u, v) + π*(r) + m₊∞₊ + m₋∞₋,

where (u, v) is a semi-reduced pair of any degree and r = numerator/denominator a rational function of x. π*(r) is the
affine part of the divisor of r on the curve: π*(x − e) = P + ιP for a point P over e, with the involution ι. The pair
contains no P together with ιP, which makes the form unique. No polynomial is factored: a sum composes the pairs by
Cantor's formulas and multiplies r by the polynomial of the points that cancel. Nothing is reduced; classes are computed
on request.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal, NamedTuple, SupportsIndex

from jacobian import poly
from jacobian.addition import cantor
from jacobian.addition.ladder import multiple
from jacobian.curve.curve import HyperellipticCurve, check_curve, coefficient
from jacobian.curve.points import AffinePoint, Given, Point, PointAtInfinity
from jacobian.errors import ArgumentError, CurveMismatch, FieldError, Infeasible, NotRepresentable, shown, whole
from jacobian.fields.factor import roots, without_root
from jacobian.immutable import Immutable, replaced
from jacobian.law.divisor import Divisor, check_divisor, check_scalar, is_zero_int
from jacobian.law.from_points import counted

MOST_POINTS = 2000


class FormalSum(Immutable):
    """A divisor Σ m_P P of ``curve``, rational over its exact field, with ``+``, ``−``, ``m * A``, ``==`` and ``hash``.

    ``u`` and ``v`` are the part without opposite points. ``numerator`` and ``denominator`` are coprime monic
    polynomials. The points over roots of ``numerator`` are added, those over roots of ``denominator`` are
    subtracted. ``weights`` are the multiplicities of ``curve.points_at_infinity()``, or of the one place of degree
    two of an inert model. Formal sums are made by :meth:`zero`, :meth:`from_points`, :meth:`from_divisor` and
    :func:`principal_divisor`.
    """

    def __init__(
        self,
        curve: HyperellipticCurve,
        pair: tuple[poly.Poly, poly.Poly] | None = None,
        fibres: tuple[poly.Poly, poly.Poly] | None = None,
        weights: tuple[int, ...] | None = None,
    ) -> None:
        K = curve.field
        one = (K.one,)
        self.curve = curve
        self.u, self.v = pair or (one, ())
        above, below = fibres or (one, one)
        common = poly.gcd(K, above, below)
        self.numerator, self.denominator = (poly.quotient(K, a, common) for a in (above, below))
        self.weights = weights or (0,) * len(curve.points_at_infinity() or (None,))

    @staticmethod
    def zero(curve: HyperellipticCurve) -> FormalSum:
        """The empty sum; FieldError over an inexact field."""
        if not check_curve(curve).field.exact:
            raise FieldError(f"field = {curve.field.name}: multiplicities are not decided over an inexact field")
        return FormalSum(curve)

    @staticmethod
    def from_points(
        curve: HyperellipticCurve, points: Iterable[Given], multiplicities: Iterable[int] | None = None
    ) -> FormalSum:
        """The sum Σ m_i P_i of ``points``, pairs (x, y) and points at infinity.

        ``multiplicities``: the ints m_i, of any sign, 1 by default. Infeasible for more than 2000 points.
        """
        total = FormalSum.zero(curve)
        given, numbers = counted(points, multiplicities)
        if len(given) > MOST_POINTS:
            raise Infeasible(f"points: {len(given)} of them; sums of more than {MOST_POINTS} points are not reduced")
        for i, (P, m) in enumerate(zip(given, numbers or [1] * len(given), strict=True)):
            total = total + whole(m, f"multiplicities[{i}]") * _of_point(curve, curve.check_point(P))
        return total

    @staticmethod
    def from_divisor(D: Divisor) -> FormalSum:
        """The formal sum of degree 0 that represents a divisor class: div(u, v) and its points at infinity."""
        C = check_divisor(D, "D").jacobian.curve
        zero, size = FormalSum.zero(C), D.degree
        weights: tuple[int, ...]
        if D.n is not None:
            weights = (D.n - (C.genus + 1) // 2, (C.genus + 1) // 2 - size - D.n)
        else:
            weights = (-size,) if C.model == "ramified" else (-(size // 2),) * len(zero.weights)
        return FormalSum(C, (D.u, D.v), weights=weights)

    # --- its points

    @property
    def degree(self) -> int:
        """The degree Σ m_P deg P."""
        ends = sum(self.weights) * (2 if self.curve.model == "inert" else 1)
        return len(self.u) - 1 + 2 * (len(self.numerator) - len(self.denominator)) + ends

    @property
    def effective(self) -> bool:
        """Whether no multiplicity is negative."""
        # a root of the denominator subtracts P and ιP, of which the pair contains at most one
        return min(self.weights) >= 0 and len(self.denominator) == 1

    def multiplicity(self, point: Given) -> int:
        """The multiplicity m_P of a point P of the curve over its field."""
        P, C, K = self.curve.check_point(point), self.curve, self.curve.field
        if isinstance(P, PointAtInfinity):
            return self.weights[C.points_at_infinity().index(P)]
        own = without_root(K, self.u, P.x)[0] if poly.evaluate(K, self.v, P.x) == P.y else 0
        above, below = (without_root(K, a, P.x)[0] for a in (self.numerator, self.denominator))
        return own + (2 if C.involution(P) == P else 1) * (above - below)

    def support(self) -> list[tuple[Point, int]]:
        """The points with their multiplicities, the affine ones by ascending x, over a finite field or QQ.

        NotRepresentable where a part of the sum has no rational points.
        """
        C, K = self.curve, self.curve.field
        whole_part = poly.mul(K, self.u, poly.mul(K, self.numerator, self.denominator))
        points: list[Point] = [P for x in roots(K, whole_part) for P in C.lift_x(x, all=True)]
        points += C.points_at_infinity()
        found = [(P, m) for P in points if (m := self.multiplicity(P))]
        numbers = [m for _, m in found]
        if sum(numbers) != self.degree or FormalSum.from_points(C, [P for P, _ in found], numbers) != self:
            raise NotRepresentable(f"{self!r}: not all of its points are over {K.name}")
        return found

    def divisor(self) -> Divisor:
        """The class in the Jacobian; ArgumentError for a degree other than 0."""
        C = self.curve
        if self.degree:
            raise ArgumentError(f"{self!r} has degree {self.degree}: a class of the Jacobian has degree 0")
        J = C.jacobian()
        J._check_representable()
        rise = len(self.numerator) - len(self.denominator)
        return J._reduced(self.u, self.v, self.weights[0] + rise + (C.genus + 1) // 2 if C.model == "split" else None)

    def is_principal(self) -> bool:
        """Whether the sum is the divisor of a function."""
        return self.degree == 0 and not self.divisor()

    # --- the group

    def _compatible(self, other: FormalSum) -> FormalSum:
        if other.curve != self.curve:
            raise CurveMismatch(f"formal sums of two curves cannot be combined: {self.curve!r} and {other.curve!r}")
        return other

    def __add__(self, other: FormalSum | Literal[0]) -> FormalSum:
        if not isinstance(other, FormalSum):
            return self if is_zero_int(other) else NotImplemented
        C, K = self._compatible(other).curve, self.curve.field
        parts = cantor.factors(C, (self.u, self.v, None), (other.u, other.v, None))
        u, v, _ = cantor.multiplied(C, *parts)
        above = poly.mul(K, poly.quotient(K, self.u, parts[0]), poly.mul(K, self.numerator, other.numerator))
        below = poly.mul(K, self.denominator, other.denominator)
        weights = tuple(x + y for x, y in zip(self.weights, other.weights, strict=True))
        return FormalSum(C, (u, v), (above, below), weights)

    __radd__ = __add__

    def __neg__(self) -> FormalSum:
        K, C = self.curve.field, self.curve
        v = poly.mod(K, poly.neg(K, poly.add(K, self.v, C.h)), self.u)
        fibres = self.denominator, poly.mul(K, self.numerator, self.u)
        return FormalSum(C, (self.u, v), fibres, tuple(-m for m in self.weights))

    def __sub__(self, other: FormalSum | Literal[0]) -> FormalSum:
        if not isinstance(other, FormalSum):
            return self if is_zero_int(other) else NotImplemented
        return self + -other

    def __rsub__(self, other: Any) -> FormalSum:
        return -self if is_zero_int(other) else NotImplemented

    def __mul__(self, scalar: SupportsIndex) -> FormalSum:
        if isinstance(scalar, FormalSum):
            return NotImplemented
        m = check_scalar(scalar)
        if abs(m) * max(len(part) - 1 for part in (self.u, self.numerator, self.denominator)) > MOST_POINTS:
            raise Infeasible(
                f"scalar = {shown(m)}: sums of more than {MOST_POINTS} points are not reduced by themselves"
            )
        return multiple(m, self, FormalSum.__add__, lambda A: A + A, FormalSum.__neg__, FormalSum(self.curve))

    __rmul__ = __mul__
    __array_ufunc__ = None

    def _value(self) -> tuple[object, ...]:
        key = self.curve.field.key
        parts = (self.u, self.v, self.numerator, self.denominator)
        return self.curve, tuple(tuple(map(key, part)) for part in parts), self.weights

    def __bool__(self) -> bool:
        return any(self.weights) or any(len(part) > 1 for part in (self.u, self.numerator, self.denominator))

    def __repr__(self) -> str:
        K = self.curve.field
        parts = [f"div({poly.text(K, self.u)}, {poly.text(K, self.v)})"] if len(self.u) > 1 else []
        if len(self.numerator) > 1:
            parts.append(f"π*({poly.text(K, self.numerator)})")
        if len(self.denominator) > 1:
            parts.append(f"(-1)·π*({poly.text(K, self.denominator)})")
        names = self.curve.points_at_infinity() or ("∞",)
        parts += [f"({m})·{name}" for m, name in zip(self.weights, names, strict=True) if m]
        return " + ".join(parts) or "0"


class Intersection(NamedTuple):
    """A curve Y: y = P(x) through two divisors D and E of the given curve X, and its intersection with X.

    Opposite points of D + E cancel; their abscissas are the roots of ``fibres``. Y contains the other points of D + E,
    with their multiplicities. ``abel`` is Abel's polynomial P² + hP − f, whose roots are the abscissas of X·Y;
    ``points`` is the affine part of X·Y. ``rest`` is the divisor of fibres·(y − P) minus D and E, so that D + E = −rest
    as classes.
    """

    P: poly.Poly
    fibres: poly.Poly
    abel: poly.Poly
    points: FormalSum
    rest: FormalSum


def principal_divisor(curve: HyperellipticCurve, a: Any, b: Any = ()) -> FormalSum:
    """div(a(x) + b(x)·y) on a curve over an exact field, for polynomials, ascending, that are not both 0.

    Let c = gcd(a, b), a = ca₀, b = cb₀ and N = a₀² − ha₀b₀ − fb₀². The affine part of the divisor is
    π*(c) + div(N, −a₀/b₀ mod N), because a₀ + b₀y does not vanish at two opposite points.
    """
    # zero() refuses inexact fields
    K = FormalSum.zero(curve).curve.field
    first, second = poly.coerce(K, a, "a"), poly.coerce(K, b, "b")
    if not first and not second:
        raise ArgumentError("a = b = 0: the function 0 has no divisor")
    content = poly.gcd(K, first, second)
    a, b = poly.quotient(K, first, content), poly.quotient(K, second, content)
    norm = poly.sub(K, poly.mul(K, a, poly.sub(K, a, poly.mul(K, curve.h, b))), poly.mul(K, curve.f, poly.mul(K, b, b)))
    u = poly.monic(K, norm)
    _, inverse = poly.half_xgcd(K, u, b) if b else ((), ())
    v = poly.neg(K, poly.mod(K, poly.mul(K, a, inverse), u))
    affine = FormalSum(curve, (u, v), (poly.monic(K, content), (K.one,)))
    return replaced(affine, weights=_at_infinity(affine, (a, b), content))


def intersection(D: Divisor, E: Divisor) -> Intersection:
    """The curve y = P(x) of lowest degree through two divisors of one group over an exact field, as an Intersection.

    In genus two let D and E have weight two and be in general position. Then P is a cubic, and y = P(x) meets the curve
    in the points of D, E and −(D + E) (Abel 1841). At a common point of D and E it is tangent to the curve; opposite
    points are recorded in ``fibres``. If D and E contain no points, the curve is y = 0. FieldError over an inexact
    field.
    """
    first, second = (FormalSum.from_divisor(check_divisor(X, name)) for X, name in ((D, "D"), (E, "E")))
    C, K = D._compatible(E).jacobian.curve, first.curve.field
    both = first + second
    P, fibres = both.v, both.numerator
    abel = poly.sub(K, poly.mul(K, P, poly.add(K, P, C.h)), C.f)
    of_line = principal_divisor(C, poly.neg(K, P), (K.one,))
    points = FormalSum(C, (of_line.u, of_line.v))
    rest = principal_divisor(C, poly.neg(K, poly.mul(K, fibres, P)), fibres) - both
    return Intersection(P, fibres, abel, points, rest)


def _at_infinity(affine: FormalSum, function: tuple[poly.Poly, poly.Poly], content: poly.Poly) -> tuple[int, ...]:
    """The orders at infinity of content·(a + by); ``affine`` is the affine part of its divisor, whose degree is 0."""
    C, K, (a, b) = affine.curve, affine.curve.field, function
    total = affine.degree
    if C.model != "split":
        return (-total if C.model == "ramified" else -total // 2,)
    # y = z·x^(g+1) + … with different z at ∞₊ and ∞₋. So the leading terms of a and by cancel at one of the two points
    # at most, and the order at the other is minus the degree in x
    g, rise = C.genus, len(content) - 1
    top = max(len(a) - 1, len(b) + g if b else 0)
    lead = K.add(coefficient(K, a, top), K.mul(coefficient(K, b, top - g - 1), C.infinity_plus))
    return (-top - rise, top + rise - total) if lead != K.zero else (top + rise - total, -top - rise)


def _of_point(C: HyperellipticCurve, P: Point) -> FormalSum:
    if isinstance(P, AffinePoint):
        return FormalSum(C, ((C.field.neg(P.x), C.field.one), poly.trim(C.field, (P.y,))))
    return FormalSum(C, weights=tuple(int(P == Q) for Q in C.points_at_infinity()))
