"""Hyperelliptic curves y² + h(x)y = f(x): the model at infinity, smoothness, points.

The points at infinity are read off the chart x = 1/t, y = w/t^(g+1): they are the roots z of z² + h_{g+1} z = f_{2g+2},
z being the value of y/x^(g+1). The model is ramified if there is a double root, split if there are two roots in the
field, and inert if there is none.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, overload

from jacobian import poly
from jacobian.curve import latex
from jacobian.curve.points import INFINITY, INFINITY_MINUS, INFINITY_PLUS, AffinePoint, Given, Point, PointAtInfinity
from jacobian.curve.questions import CurveQuestions
from jacobian.curve.rational_points import abscissas
from jacobian.element import Arithmetic, Coefficients, Element, Rng, Value
from jacobian.errors import (
    ArgumentError,
    FieldError,
    Infeasible,
    NotASquare,
    NotOnCurve,
    NotRepresentable,
    SingularCurve,
    flag,
    shown,
    whole,
    written,
)
from jacobian.fields.protocol import Field, check_field
from jacobian.fields.quadratic import quadratic_roots
from jacobian.fields.randomness import random_below
from jacobian.inexact.dense import absolute, value_at

if TYPE_CHECKING:
    from jacobian.group import Jacobian
    from jacobian.page.record import Page

MOST_BOUND = 10_000
"""The largest numerator and denominator of x: 10^8 values of x are sieved in half a second."""


class HyperellipticCurve(CurveQuestions[Element]):
    """The smooth projective curve y² + h(x)y = f(x) of genus g ≥ 1 over the field K.

    ``f``, ``h``: ascending coefficients or a galois.Poly, h also a number; max(deg f, 2 deg h) is 2g+1 or 2g+2 and f
    need not be monic. ``infinity_plus`` (split models): the value of y/x^(g+1) at the point to be called ∞₊; by default
    the smaller int over a finite field and the larger number elsewhere (by real, then imaginary part over CC).

    Attributes: ``genus``, ``f``, ``h`` (tuples, trimmed), ``field``; ``model`` is "ramified", "split" or "inert";
    ``infinity_plus`` and ``infinity_minus`` are the values of y/x^(g+1) at these points (equal on a ramified model,
    None on an inert one).

    Raises SingularCurve for a singular equation, decided exactly over exact fields. Over RR, CC and MP(dps) affine
    smoothness is not decided: rounding cannot distinguish a curve from a singular one nearby. Only the model at
    infinity is decided, relative to the size of its coefficients.
    """

    def __init__(
        self, K: Field[Element], f: Coefficients, h: Coefficients | Value = (), infinity_plus: Value | None = None
    ) -> None:
        self.field = check_field(K, "K")
        self.f = poly.trim(K, poly.coerce(K, f, "f"))
        self.h = poly.trim(K, poly.coerce(K, h, "h", constant=True))
        degree = max(len(self.f) - 1, 2 * len(self.h) - 2)
        self.genus = (degree - 1) // 2
        if self.genus < 1:
            formula = self._formula()
            raise ArgumentError(
                f"f and h of {formula} give genus {max(self.genus, 0)}: max(deg f, 2 deg h) must be 2g+1 or 2g+2 "
                "with g ≥ 1, that is 3 or more"
            )
        self._set_model(infinity_plus)
        self._check_smooth()

    def _set_model(self, infinity_plus: Value | None) -> None:
        K, g = self.field, self.genus
        b, c = coefficient(K, self.h, g + 1), coefficient(K, self.f, 2 * g + 2)
        roots = quadratic_roots(K, b, c)
        self.model = ("inert", "ramified", "split")[len(roots)]
        self.infinity_plus: Any = None
        self.infinity_minus: Any = None
        if self.model == "ramified":
            self.infinity_plus = self.infinity_minus = roots[0]
            self._check_infinity(roots[0])
        if self.model == "split":
            plus, minus = self._name_infinity(roots, infinity_plus)
            self.infinity_plus, self.infinity_minus = plus, minus
        elif infinity_plus is not None:
            raise ArgumentError(
                f"infinity_plus = {shown(infinity_plus)}: {self!r} is {self.model}, only a split model has ∞₊ and ∞₋"
            )

    def _name_infinity(self, roots: list[Any], chosen: Value | None) -> tuple[Element, Element]:
        K: Any = self.field
        if chosen is None:
            finite = K.order is not None
            first, second = sorted(roots, key=lambda z: (z.real, z.imag) if not finite else z, reverse=not finite)
            return first, second
        plus = K.coerce(chosen, "infinity_plus")
        matches = [z for z in roots if K.is_zero(K.sub(z, plus), None if K.exact else abs(z) + abs(plus))]
        if not matches:
            values = " and ".join(map(str, roots))
            raise ArgumentError(
                f"infinity_plus = {shown(chosen)}: y/x^{self.genus + 1} takes the values {values} at infinity"
            )
        return matches[0], next(z for z in roots if z is not matches[0])

    def _check_infinity(self, z: Element) -> None:
        """Raises SingularCurve if f_{2g+1} = h_g z for a double value z of y/x^(g+1) at infinity."""
        K: Any = self.field
        g = self.genus
        linear, product = coefficient(K, self.f, 2 * g + 1), K.mul(coefficient(K, self.h, g), z)
        scale = None if K.exact else abs(linear) + abs(product)
        if K.is_zero(K.sub(linear, product), scale):
            raise SingularCurve(
                f"{self!r} is singular at infinity: y/x^{g + 1} has the double value {written(z)} there, and "
                f"y → y + {written(z)}·x^{g + 1} lowers the degree of the equation: write the curve with that "
                "substitution"
            )

    def _check_smooth(self) -> None:
        K = self.field
        if not K.exact:
            return
        if K.characteristic == 2:
            if not self.h:
                raise SingularCurve(f"{self!r}: h = 0 leaves every curve of characteristic 2 singular; give h ≠ 0")
            slope, f_slope = poly.derivative(K, self.h), poly.derivative(K, self.f)
            test = poly.add(K, poly.mul(K, poly.mul(K, slope, slope), self.f), poly.mul(K, f_slope, f_slope))
            common = poly.gcd(K, self.h, test)
        else:
            common = poly.gcd(K, self.discriminant, poly.derivative(K, self.discriminant))
        if len(common) != 1:
            where = f"x with {poly.text(K, common)} = 0" if common else "every point"
            raise SingularCurve(f"{self!r} has a singular point at {where}: f and h must define a smooth curve")

    @cached_property
    def arithmetic_model(self) -> HyperellipticCurve[Element]:
        """The isomorphic curve on which divisors are added: this one, or its image under y → y + z₀x^(g+1).

        The image is taken for a ramified model with deg f = 2g+2 or deg h = g+1; z₀ is ``infinity_plus``. The new
        equation has deg f = 2g+1 and deg h ≤ g. A Mumford pair (u, v) is mapped to (u, v − z₀x^(g+1) mod u).
        """
        K, g = self.field, self.genus
        if self.model != "ramified" or (len(self.f) <= 2 * g + 2 and len(self.h) <= g + 1):
            return self
        move = poly.monomial(K, self.infinity_plus, g + 1)
        f = poly.sub(K, self.f, poly.mul(K, move, poly.add(K, move, self.h)))
        h = poly.add(K, self.h, poly.add(K, move, move))
        # the leading coefficients cancel identically; over an inexact field rounding may leave them nonzero
        return HyperellipticCurve(K, f[: 2 * g + 2], h[: g + 1])

    @cached_property
    def principal_parts(self) -> tuple[poly.Poly[Element], poly.Poly[Element]]:
        """(V₊, V₋) of a split model: the polynomial parts of y at ∞₊ and at ∞₋, of degree at most g+1.

        They are −h/2 ± the polynomial part of √(h²/4 + f), computed coefficient by coefficient, which also works in
        characteristic 2.
        """
        K, g = self.field, self.genus
        if self.model != "split":
            raise ArgumentError(f"{self!r} is {self.model}: only a split model has two principal parts at infinity")
        slope = K.inv(K.sub(self.infinity_plus, self.infinity_minus))
        descending = [self.infinity_plus]
        for i in range(1, g + 2):
            # the coefficient of x^(2g+2−i) in V² + hV − f, from the terms of V computed so far
            known = K.sub(K.dot(descending[1:], descending[:0:-1]), coefficient(K, self.f, 2 * g + 2 - i))
            for j, c in enumerate(descending):
                known = K.add(known, K.mul(c, coefficient(K, self.h, g + 1 - i + j)))
            descending.append(K.neg(K.mul(known, slope)))
        plus = tuple(reversed(descending))
        plus = poly.trim(K, plus) if K.exact else plus
        return plus, poly.neg(K, poly.add(K, plus, self.h))

    def jacobian(self) -> Jacobian[Element]:
        """The Jacobian of this curve, always the same object (:class:`jacobian.group.Jacobian`)."""
        return self._jacobian

    @cached_property
    def _jacobian(self) -> Jacobian[Element]:
        from jacobian.group import Jacobian

        return Jacobian(self)

    def summary(self, bound: int = 2**12, height: int = 1000, digits: int = 20) -> Page:
        """A report on this curve over QQ. Each line is marked as proven, computed or conjectural. The page has
        L-polynomials up to ``bound``, points whose x has a height up to ``height``, and periods to ``digits`` digits
        (:func:`jacobian.page.lines.summary`).
        """
        from jacobian.page.lines import summary

        return summary(self, bound, height, digits)

    # --- points

    def residual(self, x: Element, y: Element) -> Element:
        """y² + h(x)y − f(x) for raw elements."""
        K = self.field
        return K.sub(K.mul(y, K.add(y, poly.evaluate(K, self.h, x))), poly.evaluate(K, self.f, x))

    def is_on(self, point: Given[Element]) -> bool:
        """Whether a pair (x, y) or a PointAtInfinity is on this curve (up to rounding over an inexact field).

        PrecisionLoss where the terms of the equation exceed the range of floats, as in :meth:`point` and
        :meth:`lift_x`.
        """
        if isinstance(point, PointAtInfinity):
            return point in self.points_at_infinity()
        K: Any = self.field
        x, y = self._coerce_pair(point)
        value = self.residual(x, y)
        return bool(K.is_zero(value) if K.exact else K.is_rounding(value, self._size(x, y)))

    def _size(self, x: Any, y: Any) -> Any:
        """The sum of the absolute values of all terms of y² + h(x)y − f(x)."""
        h, f = (value_at(absolute(c), abs(x)) for c in (self.h, self.f))
        return abs(y) * (abs(y) + h) + f

    def _coerce_pair(self, point: Any) -> tuple[Element, Element]:
        try:
            x, y = point
        except Exception:
            raise ArgumentError(f"point = {shown(point)}: a pair (x, y) or a PointAtInfinity is needed") from None
        return self.field.coerce(x, "x"), self.field.coerce(y, "y")

    def point(self, x: Element | Value, y: Element | Value) -> AffinePoint[Element]:
        """The point (x, y), or NotOnCurve."""
        x, y = self._coerce_pair((x, y))
        if not self.is_on((x, y)):
            raise NotOnCurve(
                f"point = ({written(x)}, {written(y)}) is not on {self!r}: y² + h(x)y − f(x) is "
                f"{written(self.residual(x, y))}"
            )
        return AffinePoint(x, y)

    def check_point(self, point: Given[Element]) -> Point[Element]:
        """``point`` as an AffinePoint or a PointAtInfinity of this curve, or NotOnCurve."""
        if isinstance(point, PointAtInfinity):
            if point not in self.points_at_infinity():
                raise NotOnCurve(
                    f"point = {shown(point)} is not on {self!r}: rational points at infinity "
                    f"{self.points_at_infinity()}"
                )
            return point
        return self.point(*self._coerce_pair(point))

    def involution(self, point: Given[Element]) -> Point[Element]:
        """The image (x, −y − h(x)) of a point (x, y); ∞₊ and ∞₋ are exchanged."""
        point = self.check_point(point)
        if isinstance(point, PointAtInfinity):
            return PointAtInfinity(-point.sign)
        K = self.field
        return AffinePoint(point.x, K.neg(K.add(point.y, poly.evaluate(K, self.h, point.x))))

    def points_at_infinity(self) -> tuple[PointAtInfinity, ...]:
        """The rational points at infinity: (∞,), (∞₊, ∞₋) or ()."""
        return {"ramified": (INFINITY,), "split": (INFINITY_PLUS, INFINITY_MINUS), "inert": ()}[self.model]

    @overload
    def lift_x(self, x: Element | Value, *, all: Literal[False] = False) -> AffinePoint[Element]: ...

    @overload
    def lift_x(self, x: Element | Value, *, all: Literal[True]) -> list[AffinePoint[Element]]: ...

    def lift_x(self, x: Element | Value, *, all: bool = False) -> AffinePoint[Element] | list[AffinePoint[Element]]:
        """One affine point with this x, or NotASquare; with ``all``, the list of all such points (none, one or two)."""
        K, all = self.field, flag(all, "all")
        x = K.coerce(x, "x")
        found = quadratic_roots(K, poly.evaluate(K, self.h, x), poly.evaluate(K, self.f, x))
        points = [AffinePoint(x, y) for y in found]
        if all:
            return points
        if not points:
            raise NotASquare(f"x = {written(x)}: no point of {self!r} has this x")
        return points[0]

    def points(self, bound: int | None = None) -> Iterator[Point[Element]]:
        """All rational points, first the points at infinity. Over QQ, a sieve over small primes finds the points with
        numerator and denominator of x up to ``bound``, at most 10,000.

        Over a finite field the time is proportional to its order, and the logger ``jacobian.progress`` reports the
        remaining time. ArgumentError over RR, CC and MP.
        """
        return self._points(self._abscissas(bound))

    def _points(self, abscissas: Iterator[Element]) -> Iterator[Point[Element]]:
        yield from self.points_at_infinity()
        for x in abscissas:
            yield from self.lift_x(x, all=True)

    def _abscissas(self, bound: int | None) -> Iterator[Any]:
        K: Any = self.field
        if bound is not None:
            bound = whole(bound, "bound", "the largest numerator and denominator of x is an int ≥ 1", 1)
        if K.order is not None:
            from jacobian.progress import counted

            return counted(K.elements(), f"the points of {self!r}", K.order)
        if not K.exact:
            raise FieldError(f"field = {K.name}: a curve over it has a continuum of points; use lift_x")
        if bound is None:
            raise ArgumentError(
                "bound = None: over QQ points() needs the largest numerator and denominator of x to try"
            )
        if bound > MOST_BOUND:
            raise Infeasible(f"bound = {shown(bound)}: up to {MOST_BOUND}, some 10^8 x, they are sieved")
        return iter(sorted(abscissas(self.discriminant, 2 * self.genus + 2, bound)))

    def random_point(self, rng: Rng) -> AffinePoint[Element]:
        """A random affine point, uniform over a finite field. ``rng``: numpy Generator or random.Random.

        Over QQ it is one of the points of :meth:`points` with bound 12; NotRepresentable when no point is found.
        """
        K = self.field
        if K.order is None and K.exact:
            known = [point for point in self.points(bound=12) if isinstance(point, AffinePoint)]
            if known:
                return known[random_below(rng, len(known))]
        # about half of the x have points; over a small field there may be no point at all
        for _ in range(0 if K.order is None and K.exact else 10000):
            found = self.lift_x(K.random(rng), all=True)
            # a point that is the only one over its x is kept half of the time, so that all points are equally likely
            choice = random_below(rng, 2)
            if choice < len(found):
                return found[choice]
        raise NotRepresentable(f"no affine point was found on {self!r}")

    # --- as a value

    def _formula(self) -> str:
        K = self.field
        linear = latex.term_of_y(K, self.h, poly.text(K, self.h), "({})·y", "·")
        return f"y^2{linear} = {poly.text(K, self.f)}"

    def __repr__(self) -> str:
        return f"{self._formula()} over {self.field.name}"

    def _latex_(self) -> str:
        return rf"{latex.equation(self.field, self.f, self.h)} \text{{ over }} {latex.field(self.field)}"

    def _repr_latex_(self) -> str:
        return f"${self._latex_()}$"

    def _repr_html_(self) -> str:
        from jacobian.notebook import named

        facts = [
            ("equation", self._formula()),
            ("field", self.field.name),
            ("genus", self.genus),
            ("at infinity", self.model),
        ]
        return named("hyperelliptic curve", facts)

    def _value(self) -> tuple[object, ...]:
        K = self.field
        plus = K.key(self.infinity_plus) if self.model == "split" else None
        return K, tuple(map(K.key, self.f)), tuple(map(K.key, self.h)), plus

    def __reduce__(self) -> tuple[object, ...]:
        return _from_value, self._value()


def _from_value(K: Any, f: Any, h: Any, plus: Any) -> HyperellipticCurve:
    chosen = None if plus is None else K.from_key(plus)
    return HyperellipticCurve(K, [K.from_key(c) for c in f], [K.from_key(c) for c in h], chosen)


def check_curve(curve: HyperellipticCurve[Element]) -> HyperellipticCurve[Element]:
    """``curve`` itself; ArgumentError if it is not a HyperellipticCurve."""
    if not isinstance(curve, HyperellipticCurve):
        raise ArgumentError(f"curve = {shown(curve)}: a HyperellipticCurve is needed")
    return curve


def coefficient(K: Arithmetic[Element], a: poly.Poly[Element], i: int) -> Element:
    """The coefficient of x^i in a, zero beyond its length."""
    return a[i] if 0 <= i < len(a) else K.zero
