"""The multiplicative group over one point x₀ of the line: (K[y]/(y² + h(x₀)y − f(x₀)))* / K*.

It is the kernel of the map from the generalized Jacobian whose modulus is the fibre over x₀ to the Jacobian (Rosenlicht
1954), and the group of the conic steps through the plane points (x₀, y₀) (:mod:`jacobian.relatives.conic`). The class
(a : b) is that of the function a + b·y, which has no zero over x₀. The group is the multiplicative group G_m if two
rational points lie over x₀, the additive group G_a at a branch point, and the elements of norm one in a quadratic
extension (a "circle") at a pair of conjugate points.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from jacobian import poly
from jacobian.addition.ladder import multiple
from jacobian.curve.curve import HyperellipticCurve, coefficient
from jacobian.errors import ArgumentError, FieldError, entries, shown, written
from jacobian.fields.quadratic import quadratic_roots
from jacobian.immutable import Immutable
from jacobian.law.divisor import check_scalar

Unit = tuple[Any, Any]
Function = tuple[poly.Poly, poly.Poly]


class FibreGroup(Immutable):
    """The group of classes (a : b) for which a + b·y has no zero over x₀; ``x0`` = None is x₀ = ∞.

    At infinity y stands for y/x^(g+1). ``kind``: "split" (G_m), "ramified" (G_a) or "inert" (a circle); ``values``: the
    values of y over x₀ that lie in the field; ``identity``: (1 : 0). Classes are pairs, written with b = 1 or as
    (1, 0). FieldError for an x0 outside the field.
    """

    def __init__(self, curve: HyperellipticCurve, x0: Any = None) -> None:
        K, g = curve.field, curve.genus
        self.curve = curve
        self.field: Any = K
        self.x0 = None if x0 is None else K.coerce(x0, "x0")
        if self.x0 is None:
            self.f0, self.h0 = coefficient(K, curve.f, 2 * g + 2), coefficient(K, curve.h, g + 1)
            known = {"split": (curve.infinity_plus, curve.infinity_minus), "ramified": (curve.infinity_plus,)}
            self.values: tuple[Any, ...] = known.get(curve.model, ())
        else:
            self.f0, self.h0 = poly.evaluate(K, curve.f, self.x0), poly.evaluate(K, curve.h, self.x0)
            self.values = tuple(quadratic_roots(K, self.h0, self.f0))
        self.kind = ("inert", "ramified", "split")[len(self.values)]
        self.identity: Unit = (K.one, K.zero)

    def _value(self) -> tuple[object, ...]:
        return self.curve, None if self.x0 is None else self.field.key(self.x0)

    def __repr__(self) -> str:
        return f"Fibre group over x = {'∞' if self.x0 is None else self.x0} of {self.curve!r}"

    def norm(self, c: Unit) -> Any:
        """The norm a² − h₀ab − f₀b² of a + b·y, h₀ = h(x₀), f₀ = f(x₀): 0 exactly if a + b·y vanishes over x₀."""
        K, (a, b) = self.field, c
        return K.sub(K.mul(a, K.sub(a, K.mul(self.h0, b))), K.mul(self.f0, K.mul(b, b)))

    def is_unit(self, c: Unit) -> bool:
        """Whether a + b·y vanishes at no point over x₀; over an inexact field the norm is compared with its terms."""
        K, (a, b) = self.field, c
        scale = None if K.exact else abs(a) ** 2 + abs(self.h0 * a * b) + abs(self.f0) * abs(b) ** 2
        return not K.is_zero(self.norm(c), scale)

    def element(self, a: Any, b: Any) -> Unit:
        """The class (a : b); ArgumentError where a + b·y is not a unit."""
        K = self.field
        c = K.coerce(a, "a"), K.coerce(b, "b")
        if not self.is_unit(c):
            raise ArgumentError(
                f"(a, b) = ({written(c[0])}, {written(c[1])}): a + b·y vanishes at a point over x₀, it must be a unit "
                "there"
            )
        return self.normal(c)

    def _checked(self, c: Any, argument: str = "c") -> Unit:
        wanted = "a class (a, b), a pair of elements of the field,"
        pair = entries(c, argument, wanted)
        if len(pair) != 2:
            raise ArgumentError(f"{argument} = {shown(c)}: {wanted} is needed")
        return self.element(*pair)

    def normal(self, c: Unit) -> Unit:
        """The normal form of a class: (a/b, 1), or (1, 0) if b = 0."""
        K, (a, b) = self.field, c
        return self.identity if b == K.zero else (K.div(a, b), K.one)

    def multiply(self, c: Unit, d: Unit) -> Unit:
        """The product of two classes."""
        return self.normal(self._product(c, d))

    def _product(self, c: Unit, d: Unit) -> Unit:
        K, (a, b), (a2, b2) = self.field, c, d
        last = K.mul(b, b2)
        first = K.add(K.mul(a, a2), K.mul(last, self.f0))
        return first, K.sub(K.add(K.mul(a, b2), K.mul(b, a2)), K.mul(last, self.h0))

    def inverse(self, c: Unit) -> Unit:
        """The inverse class, that of the conjugate function a − h₀b − b·y, h₀ = h(x₀)."""
        return self._conjugate(self._checked(c))

    def _conjugate(self, c: Unit) -> Unit:
        K, (a, b) = self.field, c
        return self.normal((K.sub(a, K.mul(self.h0, b)), K.neg(b)))

    def power(self, c: Unit, m: int) -> Unit:
        """c^m for any int m."""
        return multiple(
            check_scalar(m, "m"),
            self._checked(c),
            self.multiply,
            lambda d: self.multiply(d, d),
            self._conjugate,
            self.identity,
        )

    def through(self, y0: Any) -> Unit:
        """The class (−y₀ : 1) of y − y₀, which the conic step through (x₀, y₀) adds; ``y0`` = None is the identity."""
        K = self.field
        return self.identity if y0 is None else self.element(K.neg(K.coerce(y0, "y0")), K.one)

    def height(self, c: Unit) -> Any:
        """The number y₀ for which :meth:`through` gives the class c; None for the identity."""
        return self._height(c, "c")

    def _height(self, c: Unit, argument: str) -> Any:
        a, b = self._checked(c, argument)
        return None if b == self.field.zero else self.field.neg(a)

    def coordinate(self, c: Unit) -> Any:
        """The class as an element of G_m, (a + b·y₁)/(a + b·y₂) for ``values`` (y₁, y₂), or of G_a, b/(a + b·y₁).

        FieldError on an inert fibre, whose group is neither G_m nor G_a over this field.
        """
        self._check_not_inert()
        K, (a, b) = self.field, c
        first, *rest = [K.add(a, K.mul(b, y)) for y in self.values]
        return K.div(first, rest[0]) if rest else K.div(b, first)

    def from_coordinate(self, t: Any) -> Unit:
        """The class whose :meth:`coordinate` is t: t ≠ 0 for G_m, any t for G_a."""
        K = self.field
        t = K.coerce(t, "t")
        self._check_not_inert()
        if self.kind == "ramified":
            return self.element(K.sub(K.one, K.mul(t, self.values[0])), t)
        if t == K.zero:
            raise ArgumentError("t = 0: the group is G_m, give t ≠ 0")
        # a and b solve a + b·y₁ = t and a + b·y₂ = 1
        y1, y2 = self.values
        b = K.div(K.sub(t, K.one), K.sub(y1, y2))
        return self.element(K.sub(K.one, K.mul(b, y2)), b)

    def _check_not_inert(self) -> None:
        if self.kind == "inert":
            raise FieldError(f"{self!r} is inert: its group is a circle, not G_m or G_a over {self.field.name}")

    def order(self) -> int:
        """The order of the group over GF(q): q − 1 (split), q (ramified) or q + 1 (inert). FieldError over QQ or RR."""
        if self.field.order is None:
            raise FieldError(f"field = {self.field.name} is infinite, and so is this group")
        return int(self.field.order) + {"split": -1, "ramified": 0, "inert": 1}[self.kind]

    def elements(self) -> Iterator[Unit]:
        """Yields all classes over a finite field, the identity first."""
        self.order()
        yield self.identity
        for a in self.field.elements():
            if self.is_unit((a, self.field.one)):
                yield a, self.field.one

    # --- functions on the curve, up to functions of x

    def value(self, function: Function) -> Unit:
        """The numbers (a, b) for which a + b·y has the values of the function a(x) + b(x)·y at the points over x₀.

        These values may be 0. A common power of x − x₀ in a(x) and b(x) is divided out first; at infinity, a power of
        1/x.
        """
        K, (a, b) = self.field, function
        if self.x0 is None:
            g = self.curve.genus
            top = max(len(a) - 1, len(b) + g)
            return coefficient(K, a, top), coefficient(K, b, top - g - 1)
        linear = (K.neg(self.x0), K.one)
        while True:
            c = poly.evaluate(K, a, self.x0), poly.evaluate(K, b, self.x0)
            if c != (K.zero, K.zero) or not (a or b):
                return c
            a, b = poly.quotient(K, a, linear), poly.quotient(K, b, linear)

    def class_of(self, functions: list[Function]) -> Unit:
        """The class of the product of ``functions``; its zeros and poles over x₀ must be those of a power of x − x₀."""
        total, rest = self.identity, None
        for function in functions:
            c = self.value(function)
            if self.norm(c) != self.field.zero:
                total = self._product(total, c)
            else:
                rest = function if rest is None else multiply(self.curve, rest, function)
        return self.normal(total if rest is None else self._product(total, self.value(rest)))


def multiply(C: HyperellipticCurve, first: Function, second: Function) -> Function:
    """The product of two functions a(x) + b(x)·y on the curve."""
    K, (a, b), (a2, b2) = C.field, first, second
    last = poly.mul(K, b, b2)
    mixed = poly.add(K, poly.mul(K, a, b2), poly.mul(K, b, a2))
    return poly.add(K, poly.mul(K, a, a2), poly.mul(K, last, C.f)), poly.sub(K, mixed, poly.mul(K, last, C.h))


def conjugate(C: HyperellipticCurve, function: Function) -> Function:
    """The image a − h·b − b·y of a + b·y under the involution. The product of both is a function of x."""
    K, (a, b) = C.field, function
    return poly.sub(K, a, poly.mul(K, b, C.h)), poly.neg(K, b)
