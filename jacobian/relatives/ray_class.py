"""Generalized Jacobians whose modulus m is a fibre of (x, y) ↦ x: two points (x₀, y₀) and (x₀, −y₀ − h(x₀)), twice a
branch point, ∞₊ + ∞₋, or 2∞.

The group consists of divisors of degree zero prime to m, up to divisors of functions that are constant on m. It is the
ray class group of m, an extension of the Jacobian by A*/K*, where A is the ring of functions on m over the field K
(:mod:`jacobian.relatives.fibre`; Rosenlicht 1954; Serre 1959, chapters V and VII).

Here an element is a pair (D, c) of a reduced divisor D of the Jacobian, which may meet m, and a class c of A*/K*. It
represents the ideal of D together with its generator c·φ_D at m, where φ_D is a fixed function that has the divisor D
at the points of m. If D₁ + D₂ = D₃ + div F, then

    (D₁, c₁) + (D₂, c₂) = (D₃, c₁c₂ · φ₁φ₂/(F φ₃)),

and φ₁φ₂/(F φ₃) has no zeros or poles on m. Functions of x are constant on m and are left out of F, which therefore is
the product of the functions y − v of the reduction steps. (Déchène 2005 has this in genus 1 and in general position.)
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal, SupportsIndex

from jacobian import poly
from jacobian.addition import cantor
from jacobian.addition.ladder import check_growth, multiple
from jacobian.curve.curve import HyperellipticCurve, check_curve, coefficient
from jacobian.curve.points import AffinePoint
from jacobian.element import Coefficients, Rng, Value
from jacobian.errors import ArgumentError, CurveMismatch, FieldError, NotRepresentable, shown, written
from jacobian.fields.randomness import random_below
from jacobian.group import Jacobian
from jacobian.immutable import Immutable
from jacobian.law.divisor import Divisor, check_scalar, is_zero_int
from jacobian.law.from_points import pair_of_points
from jacobian.relatives.fibre import FibreGroup, Function, Unit, conjugate


class RayClassGroup(Immutable):
    """The generalized Jacobian of ``curve`` whose modulus consists of the points with x = ``x0``, None standing for ∞.

    The curve has any genus, and any model for which this package has a Jacobian. ``jacobian``: the Jacobian onto which
    this group maps; ``fibre``: the kernel, a :class:`~jacobian.relatives.fibre.FibreGroup`. FieldError over an inexact
    field. For an elliptic curve with modulus ∞₊ + ∞₋, :class:`jacobian.relatives.glued.GeneralizedJacobian` also
    computes over inexact fields.
    """

    def __init__(self, curve: HyperellipticCurve, x0: Any = None) -> None:
        if not check_curve(curve).field.exact:
            raise FieldError(f"field = {curve.field.name}: ray classes are computed over exact fields")
        self.curve = curve
        self.field: Any = curve.field
        self.jacobian: Jacobian = curve.jacobian()
        self.jacobian.zero()
        self.fibre = FibreGroup(curve, x0)
        self.x0 = self.fibre.x0

    def __repr__(self) -> str:
        return f"Generalized Jacobian of {self.curve!r} with modulus over x = {'∞' if self.x0 is None else self.x0}"

    def _value(self) -> tuple[object, ...]:
        return (self.fibre,)

    # --- elements

    def zero(self) -> RayClass:
        """The identity."""
        return RayClass(self, self.jacobian.zero(), self.fibre.identity)

    def lift(self, D: Divisor) -> RayClass:
        """The class (D, 1) over a divisor class D of the Jacobian: a section, not a homomorphism."""
        if not isinstance(D, Divisor) or D.jacobian != self.jacobian:
            raise CurveMismatch(f"D = {shown(D)} is not a divisor class of {self.jacobian!r}")
        return RayClass(self, D, self.fibre.identity)

    def from_fibre(self, a: Any, b: Any) -> RayClass:
        """The pair of the zero divisor and the class of a + b·y: an element of the kernel of the map to the Jacobian.
        ArgumentError where a + b·y is not a unit over x₀.
        """
        return RayClass(self, self.jacobian.zero(), self.fibre.element(a, b))

    def from_mumford(self, u: Coefficients, v: Coefficients | Value, n: int | None = None) -> RayClass:
        """The class of the divisor of a semi-reduced pair (u, v) prime to the modulus, of any degree.

        At finite x₀ the divisor is that of :meth:`jacobian.group.Jacobian.from_mumford`. At x₀ = ∞ it is div(u, v)
        minus deg u/2 times the fibre at infinity: deg u must be even and n left out. NotRepresentable where the divisor
        meets the modulus.
        """
        J, K = self.jacobian, self.field
        u = J._check_monic(poly.coerce(K, u, "u"))
        v = poly.mod(K, poly.coerce(K, v, "v"), u)
        if self.x0 is None:
            if n is not None:
                raise ArgumentError(f"n = {shown(n)}: the points at infinity are the modulus, leave n out")
            if len(u) % 2 == 0:
                raise NotRepresentable(
                    f"u of odd degree {len(u) - 1}: away from infinity a divisor of degree 0 needs an even one"
                )
        elif poly.evaluate(K, u, self.x0) == K.zero:
            raise NotRepresentable(
                f"u = {poly.text(K, u)} vanishes at x₀ = {written(self.x0)}: the divisor meets the modulus"
            )
        n = J._check_weight(n, len(u) - 1)
        J._check_on_curve(u, v)
        return self._reduced(J._in_triple(u, v, n), [], self.fibre.identity)

    def __call__(self, P: Any, Q: Any) -> RayClass:
        """The class of P − Q for affine points away from the modulus."""
        P, Q = self.curve.check_point(P), self.curve.check_point(Q)
        if not (isinstance(P, AffinePoint) and isinstance(Q, AffinePoint)):
            raise NotRepresentable(
                f"points {shown(P)} and {shown(Q)}: affine ones are needed; give others by from_mumford"
            )
        opposite = self.curve.involution(Q)
        assert isinstance(opposite, AffinePoint)
        if self.x0 in (P.x, Q.x):
            raise NotRepresentable(
                f"points {shown(P)} and {shown(Q)}: one of them lies over x₀ = {written(self.x0)}, in the modulus"
            )
        return self.zero() if P == Q else self.from_mumford(*pair_of_points(self.curve, [P, opposite]))

    def random(self, rng: Rng) -> RayClass:
        """A random class, uniform over a finite field. ``rng``: numpy Generator or random.Random."""
        units, K = self.fibre, self.field
        if K.order is None:
            while not units.is_unit(c := (K.random(rng), K.one)):
                pass
            return RayClass(self, self.jacobian.random(rng), c)
        while True:
            index = random_below(rng, K.order + 1)
            c = (K.element(index), K.one) if index < K.order else units.identity
            if units.is_unit(c):
                return RayClass(self, self.jacobian.random(rng), c)

    def points(self) -> Iterator[RayClass]:
        """All classes, over a small finite field."""
        units = list(self.fibre.elements())
        return (RayClass(self, D, c) for D in self.jacobian.points() for c in units)

    def order(self) -> int:
        """The order over GF(q): #J times q − 1 (two points over x₀), q (a branch point) or q + 1 (conjugate points)."""
        return self.jacobian.order() * self.fibre.order()

    # --- the group law

    def add(self, C: RayClass, D: RayClass) -> RayClass:
        """C + D."""
        J = self.jacobian
        a, b = J._in(C.divisor), J._in(D.divisor)
        functions = [*self._generator(a), *self._generator(b)]
        return self._reduced(cantor.compose(J._model, a, b), functions, self.fibre.multiply(C.unit, D.unit))

    def double(self, C: RayClass) -> RayClass:
        """C + C."""
        check_growth(self.field, C.divisor.u, C.divisor.v, C.unit)
        return self.add(C, C)

    def negate(self, C: RayClass) -> RayClass:
        """−C."""
        J = self.jacobian
        triple = J._in(C.divisor)
        functions = [conjugate(self.curve, function) for function in self._generator(triple)]
        return self._reduced(cantor.opposite(J._model, triple), functions, self.fibre._conjugate(C.unit))

    def multiply(self, m: int, C: RayClass) -> RayClass:
        """m·C for any int m, by signed windows (width-w non-adjacent form; Solinas 2000)."""
        return multiple(m, C, self.add, self.double, self.negate, self.zero())

    def _reduced(self, triple: cantor.Triple, functions: list[Function], unit: Unit) -> RayClass:
        """The element represented by the ideal of ``triple`` with the generator unit · Π ``functions`` at the modulus.

        ``triple`` is a divisor on the model of the curve on which the Jacobian computes.
        """
        opposite = []
        for line, below in cantor.reductions(self.jacobian._model, triple):
            opposite.append(self._minus(line))
            triple = below
        opposite += self._generator(triple)
        functions = [*functions, *(conjugate(self.curve, function) for function in opposite)]
        unit = self.fibre.multiply(unit, self.fibre.class_of(functions))
        return RayClass(self, self.jacobian._out(triple), unit)

    def _minus(self, v: poly.Poly) -> Function:
        """The function y − v on the curve, for a v on the model on which the Jacobian computes."""
        K, move = self.field, self.jacobian._move
        return poly.neg(K, v if move is None else poly.add(K, v, move)), (K.one,)

    def _generator(self, triple: cantor.Triple) -> list[Function]:
        """The factors of φ_D, a function that has the divisor D at the points over x₀.

        Factors that are functions of x alone are left out.
        """
        if self.x0 is None:
            return self._generator_at_infinity(triple)
        K, model, (u, v, _) = self.field, self.jacobian._model, triple
        if poly.evaluate(K, u, self.x0) != K.zero:
            return []
        if poly.evaluate(K, cantor.cofactor(model, u, v), self.x0) == K.zero:
            # y − v vanishes to a higher order than D at the point (x₀, v(x₀)). This is no branch point, so u has the
            # order of D there, and so does y − v − u
            v = poly.add(K, v, u)
        return [self._minus(v)]

    def _generator_at_infinity(self, triple: cantor.Triple) -> list[Function]:
        K, g, (u, _, n) = self.field, self.curve.genus, triple
        if n is None:
            if len(u) % 2 or self.curve.model == "inert":
                return []
            return [(poly.monomial(K, K.neg(self.curve.infinity_plus), g + 1), (K.one,))]
        # D has the coefficients m₊ at ∞₊ and m₋ at ∞₋, ``weight`` = m₊ − m₋; x^(−g−1) times ``zero`` has a simple zero
        # at ∞₊ and none at ∞₋
        weight = 2 * n + len(u) - 1 - 2 * ((g + 1) // 2)
        second = K.zero if coefficient(K, self.curve.principal_parts[0], g) != K.zero else K.one
        zero = poly.trim(K, (*[K.zero] * g, K.neg(second), K.neg(self.curve.infinity_plus))), (K.one,)
        return [zero if weight > 0 else conjugate(self.curve, zero)] * abs(weight)


class RayClass(Immutable):
    """A class of a :class:`RayClassGroup`, with ``+``, ``−``, ``m * C``, ``==`` and ``hash``; immutable.

    ``divisor``: its image in the Jacobian. ``unit``: the class of the unit a + b·y on the modulus up to constants, as
    the pair (a, 1) or (1, 0). ``bool(C)`` is False for the identity. CurveMismatch where classes of two groups are
    combined.
    """

    def __init__(self, group: RayClassGroup, divisor: Divisor, unit: Unit) -> None:
        self.group, self.divisor, self.unit = group, divisor, unit

    def _value(self) -> tuple[object, ...]:
        return self.group, self.divisor, self.unit

    def _compatible(self, other: RayClass) -> RayClass:
        if other.group != self.group:
            raise CurveMismatch(f"classes of two groups cannot be combined: {self.group!r} and {other.group!r}")
        return other

    def __add__(self, other: RayClass | Literal[0]) -> RayClass:
        if not isinstance(other, RayClass):
            return self if is_zero_int(other) else NotImplemented
        return self.group.add(self, self._compatible(other))

    __radd__ = __add__

    def __rsub__(self, other: RayClass | Literal[0]) -> RayClass:
        return -self if is_zero_int(other) else NotImplemented

    def __sub__(self, other: RayClass | Literal[0]) -> RayClass:
        if not isinstance(other, RayClass):
            return self if is_zero_int(other) else NotImplemented
        return self.group.add(self, self.group.negate(self._compatible(other)))

    def __neg__(self) -> RayClass:
        return self.group.negate(self)

    def double(self) -> RayClass:
        """C + C."""
        return self.group.double(self)

    def __mul__(self, scalar: SupportsIndex) -> RayClass:
        if isinstance(scalar, RayClass):
            return NotImplemented
        return self.group.multiply(check_scalar(scalar), self)

    __rmul__ = __mul__
    __array_ufunc__ = None

    def __bool__(self) -> bool:
        return bool(self.divisor) or self.unit != self.group.fibre.identity

    def __repr__(self) -> str:
        a, b = self.unit
        return f"({self.divisor!r}; {a} : {b})"
