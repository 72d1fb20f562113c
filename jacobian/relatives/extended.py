"""Extensions of a Jacobian of any genus: Mumford pairs together with data that the divisor does not determine.

A pair (U, V) on y² = f(x) can have any of the following data. Each kind of datum gives an extension of the Jacobian:

* at a root e of f the *lift* (κ, σ, ν), κσ² = U(e), κσν = V(e), κν² = −W(e), W = (f − V²)/U. σ gives the sign
  of √U(e); where U(e) = 0, ν gives the sign of √(−W(e)). (κ, σ, ν) and (κ/c², cσ, cν) are the same lift.
* at any other point (x₀, y₀) the triple (κ, σ, σ̄), κσσ̄ = Π(x_i − x₀), the same as (κ/c², cσ, cσ̄). Its group is the
  generalized Jacobian with modulus (x₀, y₀) + (x₀, −y₀) (Rosenlicht 1954).
* on a model of odd degree Ω = Σ∫x^g dx/y over the points of the divisor; x^g dx/y has a double pole at ∞.
* on a model of even degree Z = exp(rΣ∫x^g dx/y), where r² is the leading coefficient of f. The differential has simple
  poles at ∞₊ and ∞₋. The group is the generalized Jacobian with modulus ∞₊ + ∞₋.

A composition of pairs adds or multiplies these data. A reduction step, f − V² = −c·U·U', V' = −V mod U', changes them
by formulas that follow from the divisor of y − V. These two operations suffice for every degree and genus, and no root
is taken. Over inexact fields the degrees are assumed to be those of summands in general position, and the caller
compares results of two precisions. The sign-resolved group of :mod:`jacobian.relatives.signed` is the case of genus 2
with lifts; it also has sums in which a point goes to infinity.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from jacobian import poly
from jacobian.addition import cantor
from jacobian.addition.ladder import multiple
from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import ArgumentError, NotRepresentable, PrecisionLoss, shown, written
from jacobian.immutable import Immutable
from jacobian.linear import pivoted

# a value of a polynomial counts as zero below this fraction of the sum of the sizes of its terms
NEAR_ZERO = 2.0**-20


class Extended(NamedTuple):
    """A Mumford pair (u, v) and ``data``, one datum for each of the group's kinds."""

    u: poly.Poly
    v: poly.Poly
    data: tuple[Any, ...] = ()


class Composition(NamedTuple):
    """The unreduced pair (u, v) of a sum of two pairs (uᵢ, vᵢ).

    ``common``: the polynomial whose roots are the abscissas of the opposite points that cancelled; ``quotients``: the
    two polynomials (v − vᵢ)/uᵢ.
    """

    u: poly.Poly
    v: poly.Poly
    common: poly.Poly
    quotients: tuple[poly.Poly, poly.Poly]


class Reduction(NamedTuple):
    """A step from the pair (u, v) to (other, k·other − v), where f − v² = −scale·u·other and ``other`` is monic.

    ``degree`` and ``lead``: the degree and the leading coefficient of v; ``high``: whether the leading term of f − v²
    is that of −v², not that of f.
    """

    u: poly.Poly
    v: poly.Poly
    other: poly.Poly
    k: poly.Poly
    degree: int
    lead: Any
    scale: Any
    high: bool


class ExtendedGroup(Immutable):
    """The pairs of y² = f(x) with data of the given ``kinds``, over an exact or an inexact field.

    ``f``: ascending coefficients, degree 2g + 1 or 2g + 2, any leading coefficient. On a model of even degree the
    degree of a reduced pair is g or g + 1, whichever has the parity of the sum of the summands' degrees; ∞₊ and ∞₋ are
    subtracted equally often.
    """

    def __init__(self, field: Any, f: Any, kinds: Sequence[Kind] = ()) -> None:
        self.field = field
        self.f: poly.Poly = poly.coerce(field, f, "f")
        if len(self.f) < 4:
            raise ArgumentError(f"f = {shown(f)}: the degree of f must be 3 or more")
        self.genus = (len(self.f) - 2) // 2
        self.odd = len(self.f) % 2 == 0
        self.limit = self.genus if self.odd else self.genus + 1
        """The largest degree of a reduced pair."""
        self.kinds = tuple(kinds)
        self.curve = HyperellipticCurve(field, self.f) if field.exact else None

    def __repr__(self) -> str:
        return f"<pairs of y^2 = {poly.text(self.field, self.f)} over {self.field.name} with {len(self.kinds)} data>"

    def zero(self) -> Extended:
        """The identity."""
        return Extended((self.field.one,), (), tuple(kind.zero(self) for kind in self.kinds))

    def negate(self, D: Extended) -> Extended:
        """−D."""
        data = tuple(kind.negated(self, D, x) for kind, x in zip(self.kinds, D.data, strict=True))
        return Extended(D.u, poly.neg(self.field, D.v), data)

    def add(self, *summands: Extended) -> Extended:
        """The reduced sum of the summands."""
        total = summands[0]
        for D in summands[1:]:
            total = self.compose(total, D)
        while len(total.u) - 1 > self.limit:
            total = self.reduce(total)
        return total

    def multiple(self, m: int, D: Extended) -> Extended:
        """m·D for any int m."""
        return multiple(m, D, self.add, lambda E: self.add(E, E), self.negate, self.zero())

    def compose(self, D: Extended, E: Extended) -> Extended:
        """The unreduced pair of all points of D and E except those that cancel with opposite points."""
        step = self._exact_composition(D, E) if self.field.exact else self._general_composition(D, E)
        data = tuple(kind.composed(self, step, x, y) for kind, x, y in zip(self.kinds, D.data, E.data, strict=True))
        return Extended(step.u, step.v, data)

    def _exact_composition(self, D: Extended, E: Extended) -> Composition:
        assert self.curve is not None
        parts = cantor.factors(self.curve, (D.u, D.v, None), (E.u, E.v, None))
        u, v, _ = cantor.multiplied(self.curve, *parts)
        k, other = (poly.quotient(self.field, poly.sub(self.field, v, X.v), X.u) for X in (D, E))
        return Composition(u, v, poly.quotient(self.field, D.u, parts[0]), (k, other))

    def _general_composition(self, D: Extended, E: Extended) -> Composition:
        """The composition of pairs in general position: v = v₁ + u₁k with k·u₁ ≡ v₂ − v₁ mod u₂.

        For a double, k·2v ≡ (f − v²)/u mod u.
        """
        K = self.field
        if len(D.u) == 1 or len(E.u) == 1:
            return Composition(poly.mul(K, D.u, E.u), D.v or E.v, (K.one,), (E.v, D.v))
        if D is E:
            factor, right = poly.add(K, D.v, D.v), self.cofactor(D.u, D.v)
        else:
            factor, right = D.u, poly.sub(K, E.v, D.v)
        k = self._quotient_modulo(right, factor, E.u)
        v = poly.add(K, D.v, poly.mul(K, D.u, k))
        other = k if D is E else poly.quotient(K, poly.sub(K, v, E.v), E.u)
        return Composition(poly.mul(K, D.u, E.u), v, (K.one,), (k, other))

    def _quotient_modulo(self, a: poly.Poly, b: poly.Poly, u: poly.Poly) -> poly.Poly:
        """The polynomial k of degree below deg u with kb ≡ a modulo u."""
        K, size = self.field, len(u) - 1
        column = self._padded(poly.mod(K, b, u), size)
        columns = [column]
        for _ in range(size - 1):
            column = self._padded(poly.mod(K, (K.zero, *column), u), size)
            columns.append(column)
        right = self._padded(poly.mod(K, a, u), size)
        return self._solved([[*row, value] for row, value in zip(zip(*columns, strict=True), right, strict=True)])

    @staticmethod
    def _solved(rows: list[list[Any]]) -> poly.Poly:
        found = pivoted(rows)
        if found is None:
            raise PrecisionLoss("two divisors have a point in common, or are too near to that: use more digits")
        return tuple(found)

    def _padded(self, a: poly.Poly, size: int) -> poly.Poly:
        return (*a, *[self.field.zero] * (size - len(a)))

    def retracted(self, D: Extended) -> Extended:
        """A pair of degree g, moved by one Newton step towards U | f − V², over a :class:`LongField`.

        The step is the shortest (δU, δV) with WδU + 2VδV ≡ f − V² mod U. Without it f − V² mod U grows with every
        addition, on models of even degree by tens of bits. If U | f − V² holds, an error only doubles when the
        divisor is doubled.
        """
        K, g = self.field, len(D.u) - 1
        w, rest = poly.divide(K, poly.sub(K, self.f, poly.mul(K, D.v, D.v)), D.u)
        # x is of size 2^size at the points of the pair, and f of size 4^height. A column is scaled by the size of its
        # unknown, a coefficient of V or U, and a row by the size of f
        exponents = list(map(K.exponent, D.u[:-1]))
        size = max((-(-e // (g - i)) for i, e in enumerate(exponents) if e is not None), default=1)
        height = max(e + size * i for i, e in enumerate(map(K.exponent, self.f)) if e is not None) // 2
        units = [*(height - size * i for i in range(g)), *(size * (g - i) for i in range(g))]
        scales = [size * i - 2 * height for i in range(g)]
        columns: list[list[Any]] = []
        for b in (poly.add(K, D.v, D.v), w):
            column = self._padded(poly.mod(K, b, D.u), g)
            for j in range(g):
                if j:
                    column = self._padded(poly.mod(K, (K.zero, *column), D.u), g)
                unit = units[len(columns)]
                columns.append([K.doubled(c, unit + scale) for c, scale in zip(column, scales, strict=True)])
        by_row = list(zip(*columns, strict=True))
        rows = [[K.dot(a, b) for b in by_row] for a in by_row]
        # the normal equations are damped, because they are nearly singular if U, V and W nearly share a root
        damping = max(abs(rows[i][i]) for i in range(g)) * K.root_of_eps
        for i, (value, scale) in enumerate(zip(self._padded(rest, g), scales, strict=True)):
            rows[i][i] += damping
            rows[i].append(K.doubled(value, scale))
        weights = self._solved(rows)
        move = [K.doubled(K.dot(column, weights), unit) for column, unit in zip(columns, units, strict=True)]
        v = tuple(map(K.add, D.v, move[:g]))
        return self.with_true_lifts(D._replace(u=(*map(K.add, D.u[:-1], move[g:]), K.one), v=v))

    def with_true_lifts(self, D: Extended) -> Extended:
        """The pair with σ and ν of its lifts computed again from κσ² = U(e), κσν = V(e), over a :class:`LongField`.

        Each addition multiplies the errors in these equations, by up to 2^20 if branch points differ in size.
        """
        data = (x.nearest(self, D, a) if isinstance(x, Lift) else a for x, a in zip(self.kinds, D.data, strict=True))
        return D._replace(data=tuple(data))

    def size_of_x(self, u: poly.Poly) -> Any:
        """The approximate size of the largest root of u."""
        g = len(u) - 1
        return max(abs(c) ** (self.field.one.real / (g - i)) for i, c in enumerate(u[:-1])) or abs(self.field.one)

    def cofactor(self, u: poly.Poly, v: poly.Poly) -> poly.Poly:
        """W = (f − v²)/u."""
        K = self.field
        return poly.quotient(K, poly.sub(K, self.f, poly.mul(K, v, v)), u)

    def reduce(self, D: Extended) -> Extended:
        """The pair after one reduction step, in the same class: the opposites of the zeros of y − v outside D."""
        K = self.field
        cofactor = self.cofactor(D.u, D.v)
        if not K.exact:
            cofactor = cofactor[: max(len(self.f) - 1, 2 * len(D.v) - 2) + 2 - len(D.u)]
        if not self.odd and len(cofactor) + len(D.u) < len(self.f) + 1:
            raise NotRepresentable("no pair has this sum: its points at infinity are unevenly shared")
        inverse = K.inv(cofactor[-1])
        other = (*[K.mul(inverse, c) for c in cofactor[:-1]], K.one)
        k, rest = poly.divide(K, D.v, other)
        degree, lead = len(D.v) - 1, D.v[-1] if D.v else K.zero
        step = Reduction(D.u, D.v, other, k, degree, lead, K.neg(cofactor[-1]), degree > self.limit)
        data = tuple(kind.reduced(self, step, x) for kind, x in zip(self.kinds, D.data, strict=True))
        return Extended(other, poly.neg(K, rest), data)


class Lift(NamedTuple):
    """The kind of datum (κ, σ, ν) at a branch point e: κσ² = U(e), κσν = V(e)."""

    e: Any

    def of(self, group: ExtendedGroup, u: poly.Poly, v: poly.Poly, sigma: Any = None) -> Any:
        """The datum of the pair (u, v) with σ = 1 or the given σ, and κ = u(e)/σ²; u(e) must not be 0."""
        K = group.field
        value = poly.evaluate(K, u, self.e)
        sigma = K.one if sigma is None else sigma
        kappa = K.div(value, K.mul(sigma, sigma))
        return kappa, sigma, K.div(poly.evaluate(K, v, self.e), K.mul(kappa, sigma))

    def nearest(self, group: ExtendedGroup, D: Extended, datum: Any) -> Any:
        """The datum with σ after a Newton step for κσ² = U(e), and ν = V(e)/(κσ). If U(e) is nearly 0, ν takes a step
        for κν² = −W(e), W = (f − V²)/U, and σ = V(e)/(κν). If W(e) is nearly 0 too, the datum is returned unchanged.
        """
        K, e, (kappa, sigma, nu) = group.field, self.e, datum
        value, ordinate = (poly.evaluate(K, a, e) for a in (D.u, D.v))
        if abs(value) > NEAR_ZERO * poly.size_at(D.u, e):
            sigma = (sigma + value / (kappa * sigma)) / 2
            return kappa, sigma, ordinate / (kappa * sigma)
        w = group.cofactor(D.u, D.v)
        value = poly.evaluate(K, w, e)
        if abs(value) > NEAR_ZERO * poly.size_at(w, e):
            nu = (nu - value / (kappa * nu)) / 2
            sigma = ordinate / (kappa * nu)
        return kappa, sigma, nu

    def zero(self, group: ExtendedGroup) -> Any:
        return group.field.one, group.field.one, group.field.zero

    def negated(self, group: ExtendedGroup, D: Extended, datum: Any) -> Any:
        # (1/κ, κσ, −κν) is the same lift as (κ, σ, −ν); with 1/κ the sum D − E + E has the κ of D
        K, (kappa, sigma, nu) = group.field, datum
        return K.inv(kappa), K.mul(kappa, sigma), K.neg(K.mul(kappa, nu))

    def composed(self, group: ExtendedGroup, step: Composition, first: Any, second: Any) -> Any:
        K = group.field
        kappa, sigma = K.mul(first[0], second[0]), K.mul(first[1], second[1])
        both = f"both summands contain the branch point x = {written(self.e)}: add them in another order"
        if K.exact:
            if len(step.common) > 1:
                value = poly.evaluate(K, step.common, self.e)
                if value == K.zero:
                    raise NotRepresentable(both)
                sigma = K.div(sigma, value)
            if sigma != K.zero:
                return kappa, sigma, K.div(poly.evaluate(K, step.v, self.e), K.mul(kappa, sigma))
            swapped = first[1] != K.zero
        else:
            swapped = bool(abs(first[1]) > abs(second[1]))
        # ν = (ν₁ + σ₁k(e))/(κ₂σ₂): no division by the sum's σ, which may be 0
        near, far, k = (second, first, step.quotients[1]) if swapped else (first, second, step.quotients[0])
        top = K.add(near[2], K.mul(near[1], poly.evaluate(K, k, self.e)))
        bottom = K.mul(far[0], far[1])
        if K.exact and bottom == K.zero:
            raise NotRepresentable(both)
        return kappa, sigma, K.div(top, bottom)

    def reduced(self, group: ExtendedGroup, step: Reduction, datum: Any) -> Any:
        """(κ/c, ν, −cσ + k(e)ν), with c and k the ``scale`` and the ``k`` of the :class:`Reduction`.

        If deg f is odd, deg U even and deg V ≤ g, σ and ν are first replaced by −σ and −ν.
        """
        K, (kappa, sigma, nu) = group.field, datum
        k = poly.evaluate(K, step.k, self.e)
        if step.high:
            moved = K.div(nu, step.lead)
            return kappa, moved, K.add(K.neg(K.mul(step.lead, sigma)), K.mul(k, moved))
        if group.odd and len(step.u) % 2:
            sigma, nu = K.neg(sigma), K.neg(nu)
        return K.div(kappa, step.scale), nu, K.add(K.neg(K.mul(step.scale, sigma)), K.mul(k, nu))


class PointLift(NamedTuple):
    """The kind of datum (κ, σ, σ̄) at a point (x, y), which must be neither a branch point nor a point of a summand."""

    x: Any
    y: Any

    def zero(self, group: ExtendedGroup) -> Any:
        one = group.field.one
        return one, one, one

    def negated(self, group: ExtendedGroup, D: Extended, datum: Any) -> Any:
        K, (kappa, sigma, bar) = group.field, datum
        bar, sigma = K.mul(kappa, bar), K.mul(kappa, sigma)
        return (K.inv(kappa), bar, sigma) if len(D.u) % 2 else (K.inv(kappa), K.neg(bar), K.neg(sigma))

    def composed(self, group: ExtendedGroup, step: Composition, first: Any, second: Any) -> Any:
        K = group.field
        kappa, sigma, bar = map(K.mul, first, second)
        if len(step.common) > 1:
            # σσ̄ has the factor common(x₀)² from the points that cancel, so σ and σ̄ have the factor common(x₀) each
            scale = poly.evaluate(K, step.common, self.x)
            sigma, bar = K.div(sigma, scale), K.div(bar, scale)
        return kappa, sigma, bar

    def reduced(self, group: ExtendedGroup, step: Reduction, datum: Any) -> Any:
        K, (kappa, sigma, bar) = group.field, datum
        value = poly.evaluate(K, step.v, self.x)
        above, below = K.add(value, self.y), K.sub(value, self.y)
        if step.high:
            after, scale = kappa, K.mul(step.lead, kappa)
        else:
            after, scale = K.div(kappa, step.scale), kappa
            if group.odd:
                after, scale = K.neg(after), K.neg(scale)
        return after, K.div(above, K.mul(scale, bar)), K.div(below, K.mul(scale, sigma))


def scaled(K: Any, datum: Any, c: Any) -> Any:
    """(κ/c², cσ, cν) for a datum (κ, σ, ν) of a Lift, or (κ/c², cσ, cσ̄) for one of a PointLift: the same datum."""
    kappa, *others = datum
    return K.div(kappa, K.mul(c, c)), *(K.mul(c, x) for x in others)


class SecondKind(NamedTuple):
    """The kind of datum Ω = Σ∫x^g dx/y on a model of odd degree."""

    def zero(self, group: ExtendedGroup) -> Any:
        return group.field.zero

    def negated(self, group: ExtendedGroup, D: Extended, datum: Any) -> Any:
        return group.field.neg(datum)

    def composed(self, group: ExtendedGroup, step: Composition, first: Any, second: Any) -> Any:
        return group.field.add(first, second)

    def reduced(self, group: ExtendedGroup, step: Reduction, datum: Any) -> Any:
        """Ω after a reduction: Ω − 2/lead(V) for deg V = g + 1, Ω − 2·lead(V)/lead(f) for deg V = g, else Ω."""
        K, g = group.field, group.genus
        if step.degree == g + 1:
            return K.sub(datum, K.div(poly.integer(K, 2), step.lead))
        if step.degree == g:
            return K.sub(datum, K.div(K.add(step.lead, step.lead), group.f[-1]))
        return datum


class ThirdKind(NamedTuple):
    """The kind of datum Z = exp(rΣ∫x^g dx/y) on a model of even degree with leading coefficient r²."""

    r: Any

    def zero(self, group: ExtendedGroup) -> Any:
        return group.field.one

    def negated(self, group: ExtendedGroup, D: Extended, datum: Any) -> Any:
        return group.field.inv(datum)

    def composed(self, group: ExtendedGroup, step: Composition, first: Any, second: Any) -> Any:
        return group.field.mul(first, second)

    def reduced(self, group: ExtendedGroup, step: Reduction, datum: Any) -> Any:
        """Z(b − r)/(b + r) for deg V ≤ g + 1, where b is the coefficient of x^(g+1) in V; Z for a higher degree."""
        K, degree = group.field, step.degree
        if degree > group.genus + 1:
            return datum
        b = step.lead if degree == group.genus + 1 else K.zero
        return K.div(K.mul(datum, K.sub(b, self.r)), K.add(b, self.r))


Kind = Lift | PointLift | SecondKind | ThirdKind
"""The rules for one datum: its value for the class 0, and how −D, a composition and a reduction step change it."""
