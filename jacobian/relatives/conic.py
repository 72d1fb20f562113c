"""The conic Picard group: the pencil of semi-reduced divisors of degree g+1 in one class, and steps along it.

A semi-reduced pair (U, V) of degree N = g+1 has one parameter more than a class of the Jacobian: each class contains a
pencil of pairs. With P = V + cU, the function y − P has N zeros besides the points of (U, V). The opposites of these N
zeros

    Ũ = (P² + hP − f)/U, made monic,    Ṽ = −P − h mod Ũ

form another member of the pencil, one for every c. The *step* through a plane point (x₀, y₀) takes c = (y₀ −
V(x₀))/U(x₀), so that the curve y = P(x) passes through that point, or c = y₀ for x₀ = ∞. The step through (0, 0) is
what Tsiganov calls addition in Pic Y, Y being the curve y = P(x). At the points over x₀ the function y − P has the
values of y − y₀. The step therefore adds the class of y − y₀ in the generalized Jacobian whose modulus is the fibre
over x₀. It leaves the class in the Jacobian unchanged. Steps at one x₀ compose by the group law of
:class:`jacobian.relatives.fibre.FibreGroup`,

    y₀ ∘ y₁ = (f(x₀) + y₀y₁)/(y₀ + y₁ + h(x₀)).

The identity is y₀ = ∞, the inverse of y₀ is −y₀ − h(x₀), and for h = 0 the element of order two is y₀ = 0.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from jacobian import poly
from jacobian.addition import cantor
from jacobian.curve.curve import HyperellipticCurve
from jacobian.curve.points import INFINITY_MINUS, AffinePoint, Given
from jacobian.element import Value
from jacobian.errors import ArgumentError, FieldError, NotRepresentable, shown, written
from jacobian.fields.protocol import Field
from jacobian.immutable import Immutable, replaced
from jacobian.law.divisor import Divisor, check_divisor
from jacobian.relatives.fibre import FibreGroup, Unit
from jacobian.relatives.ray_class import RayClass, RayClassGroup


class Representative(Immutable):
    """A semi-reduced pair (u, v) of degree g+1 on y² + hy = f over any field: u monic, u | v² + hv − f.

    All pairs of this degree in one class of the Jacobian are a *pencil*. Immutable; ``==`` and ``hash`` compare pairs.
    ArgumentError for another degree, FieldError and NotOnCurve as in :meth:`jacobian.group.Jacobian.from_mumford`.
    """

    def __init__(self, curve: HyperellipticCurve, u: Any, v: Any) -> None:
        K, J = curve.field, curve.jacobian()
        u = J._check_monic(poly.coerce(K, u, "u"))
        if len(u) != curve.genus + 2:
            raise ArgumentError(f"u = {poly.text(K, u)}: degree g + 1 = {curve.genus + 1} is needed")
        v = poly.mod(K, poly.coerce(K, v, "v"), u)
        J._check_on_curve(u, v)
        self.curve, self.u, self.v = curve, u, v

    def _value(self) -> tuple[Any, ...]:
        K = self.curve.field
        return self.curve, tuple(map(K.key, self.u)), tuple(map(K.key, self.v))

    def __repr__(self) -> str:
        K = self.curve.field
        return f"({poly.text(K, self.u)}, {poly.text(K, self.v)})"

    def __reduce__(self) -> tuple[object, ...]:
        return _rebuild, self._value()

    # --- the pencil

    def member(self, c: Any) -> Representative:
        """The pair (Ũ, Ṽ) of the module's docstring for P = V + cU; for ``c`` = None the pair itself.

        NotRepresentable where (Ũ, Ṽ) contains a point at infinity: c² + h_(g+1)·c = f_(2g+2).
        """
        if c is None:
            return self
        C, K = self.curve, self.curve.field
        c = K.coerce(c, "c")
        if not FibreGroup(C).is_unit((K.neg(c), K.one)):
            raise NotRepresentable(f"c = {written(c)}: that member of the pencil contains a point at infinity")
        multiple = poly.trim(K, poly.scale(K, c, self.u)) if K.exact else poly.scale(K, c, self.u)
        p = poly.add(K, self.v, multiple)
        sum_ = poly.add(K, p, C.h)
        u = poly.quotient(K, poly.sub(K, poly.mul(K, p, sum_), C.f), self.u)
        u = poly.monic(K, u[: C.genus + 2])
        return replaced(self, u=u, v=poly.mod(K, poly.neg(K, sum_), u))

    def members(self) -> Iterator[Representative]:
        """Yields the pairs of the pencil that have no points at infinity; FieldError over an infinite field."""
        K: Any = self.curve.field
        if K.order is None:
            raise FieldError(f"field = {K.name} is infinite: the pencil cannot be listed, use member(c)")
        yield self
        for c in K.elements():
            with suppress(NotRepresentable):
                yield self.member(c)

    def step(self, x0: Value | None, y0: Value) -> Representative:
        """The pair after the step through a plane point (x0, y0) not on the curve: the :meth:`member` with P(x0) = y0.

        ``x0`` = None is x₀ = ∞, where c = y0; ``y0`` = None gives the pair itself. ArgumentError for a point of the
        curve, NotRepresentable where the pair has a point over x₀, or the new pair has a point at infinity.
        """
        K, fibre = self.curve.field, FibreGroup(self.curve, x0)
        if y0 is None:
            return self
        y0 = K.coerce(y0, "y0")
        if not fibre.is_unit((K.neg(y0), K.one)):
            raise ArgumentError(
                f"(x0, y0) = ({written(x0)}, {written(y0)}) is a point of {self.curve!r}: the step through it has no "
                "inverse"
            )
        return self.member(parameter(K, (self.u, self.v), fibre.x0, y0))

    def translate(self, x0: Any, unit: Unit) -> Representative:
        """The pair after the step that adds a class (a : b) of ``FibreGroup(curve, x0)``.

        Two steps at one x₀ add the product of their classes.
        """
        return self.step(x0, FibreGroup(self.curve, x0)._height(unit, "unit"))

    def containing(self, point: Given) -> Representative:
        """The pair of the pencil that contains an affine point of the curve."""
        point = self.curve.check_point(point)
        if not isinstance(point, AffinePoint):
            raise NotRepresentable(f"point = {shown(point)}: a pair (u, v) contains affine points")
        opposite = self.curve.involution(point)
        assert isinstance(opposite, AffinePoint)
        K = self.curve.field
        if K.exact and poly.evaluate(K, self.u, point.x) == K.zero and poly.evaluate(K, self.v, point.x) == point.y:
            return self
        return self.member(parameter(K, (self.u, self.v), point.x, opposite.y))

    # --- the classes

    def divisor(self) -> Divisor:
        """The class ``from_mumford(u, v)`` in the Jacobian, the same for all pairs of the pencil (exact fields)."""
        return self.curve.jacobian().from_mumford(self.u, self.v)

    def ray_class(self, x0: Any = None) -> RayClass:
        """The class of the pair in ``RayClassGroup(curve, x0)`` (exact fields; g odd for ``x0`` = None, x₀ = ∞)."""
        return RayClassGroup(self.curve, x0).from_mumford(self.u, self.v)


def parameter(K: Field, pair: tuple[poly.Poly, poly.Poly], x0: Any, y0: Any) -> Any:
    """The c for which P = v + cu has P(x0) = y0 (:meth:`Representative.member`); c = y0 for ``x0`` = None, x₀ = ∞.

    NotRepresentable where u vanishes at x0.
    """
    if x0 is None:
        return y0
    u, v = pair
    value = poly.evaluate(K, u, x0)
    size = None if K.exact else poly.size_at(u, x0)
    if K.is_zero(value, size):
        raise NotRepresentable(
            f"x0 = {written(x0)}: the divisor ({poly.text(K, u)}, {poly.text(K, v)}) has a point there, no curve y = "
            "P(x) is free to pass elsewhere"
        )
    return K.div(K.sub(y0, poly.evaluate(K, v, x0)), value)


def representative(D: Divisor, point: Given) -> Representative:
    """The semi-reduced pair of degree g+1 in the class D that contains an affine point Q, over an exact field.

    It is the sum of Q and the reduced divisor of D − Q, and its :meth:`Representative.divisor` is D. NotRepresentable
    where the divisor of D − Q has weight below g or contains the opposite of Q. For almost every Q neither is the case.
    """
    J = check_divisor(D, "D").jacobian
    C, K = J.curve, J.field
    point = C.check_point(point)
    if not K.exact or not isinstance(point, AffinePoint):
        raise NotRepresentable(f"point = {shown(point)} over {K.name}: an affine point over an exact field is needed")
    rest = D - (J(point, INFINITY_MINUS) if C.model == "split" else J(point))
    if rest.degree < C.genus:
        raise NotRepresentable(f"point = {shown(point)}: the member through it has a point at infinity, choose another")
    # y = v passes through ``point`` and the points of ``rest``, tangent to the curve at a point that occurs twice
    u, v, _ = cantor.compose(C, (rest.u, rest.v, None), ((K.neg(point.x), K.one), poly.trim(K, (point.y,)), None))
    if len(u) != C.genus + 2:
        raise NotRepresentable(
            f"point = {shown(point)}: the member through it contains its opposite too, choose another"
        )
    return Representative(C, u, v)


def _rebuild(curve: HyperellipticCurve, u: Any, v: Any) -> Representative:
    K: Any = curve.field
    return Representative(curve, tuple(map(K.from_key, u)), tuple(map(K.from_key, v)))
