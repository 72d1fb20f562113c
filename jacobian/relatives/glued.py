"""The generalized Jacobian of an elliptic curve with modulus ∞₊ + ∞₋ (Rosenlicht 1954; Serre 1959).

Its elements are divisors of degree zero away from infinity on y² = f(x), deg f = 4, up to the divisors of functions
that take the same value at both points at infinity. Its dimension is two: a general class is P₁ + P₂ − (∞₊ + ∞₋),
written as a Mumford pair with deg u = 2. The Euler top moves on this group, the Chaplygin ball on a Jacobian of genus
two, which tends to this group as the ball's d = mr² tends to 0.
"""

from __future__ import annotations

from collections.abc import Iterable
from random import Random
from typing import Any

from jacobian import poly
from jacobian.addition import cantor
from jacobian.addition.ladder import check_growth, multiple
from jacobian.curve.curve import HyperellipticCurve, check_curve
from jacobian.curve.points import AffinePoint, Given
from jacobian.element import Coefficients, Element, Other, Rng, Value
from jacobian.errors import ArgumentError, NotRepresentable, shown
from jacobian.fields.protocol import Field
from jacobian.group import Jacobian
from jacobian.law.divisor import Divisor
from jacobian.law.from_points import pair_of_points, repeated


class GeneralizedJacobian(Jacobian):
    """The classes modulo ∞₊ + ∞₋ on y² = f(x), deg f = 4, as Mumford pairs (u, v) with deg u = 2.

    It has the operators of :class:`~jacobian.group.Jacobian`. The kernel of the map to the Jacobian, a multiplicative
    group, has no such pairs; only its identity is represented. A sum equal to another element of the kernel raises
    NotRepresentable.
    """

    def __init__(self, curve: HyperellipticCurve) -> None:
        if check_curve(curve).h or len(curve.f) != 5:
            raise ArgumentError(f"curve = {curve!r}: the modulus ∞₊ + ∞₋ is implemented for h = 0 and deg f = 4")
        super().__init__(curve)
        self.weight_of_zero = None

    def __repr__(self) -> str:
        return f"Generalized Jacobian of {self.curve!r} with modulus ∞₊ + ∞₋"

    def __reduce__(self) -> tuple[object, ...]:
        return GeneralizedJacobian, (self.curve,)

    def explain(self) -> str:
        """A description of the algorithm of addition."""
        return "Cantor's composition, or the stacked system over inexact fields, and one reflection"

    def _check_representable(self) -> None:
        """Accepts every curve that the constructor accepts."""

    def from_mumford(self, u: Coefficients, v: Coefficients | Value, n: int | None = None) -> Divisor:
        """The class of the pair (u, v) of degree two, u monic, u | f − v²; ``n`` must be left out."""
        if n is not None:
            raise ArgumentError(f"n = {shown(n)}: the points at infinity are the modulus, leave n out")
        u = self._check_monic(poly.coerce(self.field, u, "u"))
        v = poly.coerce(self.field, v, "v")
        if len(u) != 3 or len(v) > 2:
            raise NotRepresentable(f"u and v have {len(u)} and {len(v)} coefficients: give deg u = 2 and deg v ≤ 1")
        if not self.field.exact:
            v = (*v, *[self.field.zero] * (2 - len(v)))
        self._check_on_curve(u, v)
        return Divisor(self, u, v, None)

    def from_points(
        self,
        points: Iterable[Given],
        *,
        multiplicities: Iterable[int] | None = None,
        extension: Field[Element] | None = None,
    ) -> Divisor:
        """The class of P + Q − (∞₊ + ∞₋) for two affine points (x, y); NotRepresentable for any other points."""
        if extension is not None:
            raise NotRepresentable(f"extension = {shown(extension)}: points modulo ∞₊ + ∞₋ lie over the field itself")
        pair = [self.curve.check_point(point) for point in repeated(points, multiplicities)]
        affine = [point for point in pair if isinstance(point, AffinePoint)]
        if len(pair) != 2 or len(affine) != 2:
            raise NotRepresentable(f"points = {pair}: a class modulo ∞₊ + ∞₋ is made from two affine points")
        if pair[1] == self.curve.involution(pair[0]):
            return self.zero()
        u, v = pair_of_points(self.curve, affine)
        return Divisor(self, u, v if self.field.exact else (*v, self.field.zero)[:2], None)

    def change_ring(self, K: Field[Other]) -> GeneralizedJacobian:
        """The generalized Jacobian of the curve over the field K."""
        return GeneralizedJacobian(self.curve.change_ring(K))

    def random(self, rng: Rng | None = None, size: int | None = None) -> Any:
        """The class of two random points, which is not uniform in the group. ``size`` must be None."""
        if size is not None:
            raise NotRepresentable(f"size = {shown(size)}: the classes of a generalized Jacobian are no rows of arrays")
        if rng is None:
            rng = Random()
        return self.from_points([self.curve.random_point(rng), self.curve.random_point(rng)])

    def points(self) -> Iterable[Divisor]:
        """Raises NotRepresentable: the classes are not listed."""
        raise NotRepresentable(
            "the classes of a generalized Jacobian at infinity have no Mumford pair: they are not listed"
        )

    def add(self, D: Divisor, E: Divisor) -> Divisor:
        """D + E."""
        if not D or not E:
            return D if D else E
        K = self.field
        if not K.exact:
            from jacobian.inexact import composition

            total = composition.compose(K, 2, self.curve.f, (list(D.u), list(D.v)), (list(E.u), list(E.v)))
            if len(total.u) == 1 and not total.q:
                return self.zero()
            return self._represented(tuple(total.u), tuple(total.v))
        u, p, _ = cantor.compose(self.curve, (D.u, D.v, None), (E.u, E.v, None))
        if len(u) <= 3:
            return self._represented(u, p) if len(u) == 3 else self.zero()
        u, v, _ = cantor.reflect(self.curve, u, p, None)
        return self._represented(u, v)

    def double(self, D: Divisor) -> Divisor:
        """D + D."""
        check_growth(self.field, D.u, D.v)
        return self.add(D, D)

    def negate(self, D: Divisor) -> Divisor:
        """−D."""
        return Divisor(self, D.u, poly.neg(self.field, D.v), None)

    def multiply(self, m: int, D: Divisor) -> Divisor:
        """m·D for any int m. The compiled code cannot be used here, because it adds in the Jacobian."""
        return multiple(m, D, self.add, self.double, self.negate, self.zero())

    def order(self) -> int:
        """Raises NotRepresentable: the order of a generalized Jacobian is not computed."""
        raise NotRepresentable("the order of a generalized Jacobian is not computed")

    def frobenius_polynomial(self) -> list[int]:
        """Raises NotRepresentable: the Frobenius polynomial of a generalized Jacobian is not computed."""
        raise NotRepresentable("the order of a generalized Jacobian is not computed")

    def _represented(self, u: poly.Poly, v: poly.Poly) -> Divisor:
        if len(u) != 3:
            raise NotRepresentable("the sum is a class at infinity, which no Mumford pair of degree two represents")
        return Divisor(self, u, v, None)
