"""The sign-resolved group: divisors together with square roots at chosen branch points.

Let W = (f − V²)/U for a Mumford pair (U, V). At a root e of f the symmetric matrix with the rows (U(e), V(e)) and
(V(e), −W(e)) has rank one, because V² + UW = f vanishes there. So for each constant κ ≠ 0 there are, perhaps in a
quadratic extension, σ and ν with

    κσ² = U(e),    κσν = V(e),    κν² = −W(e).

(σ, ν) is called the *pair* of the divisor at e. For a given κ the divisor determines it up to sign. The group consists
of divisors with pairs at chosen branch points. In its addition D' is the second summand and D'' the sum. Let
q·y − p vanish on D and D', let b² be the leading coefficient of (p² − q²f)/(U·U'), and let

    L = (p − qV)/U,    L'' = (p + qV'')/U'',    N = (L(V'' − V) + qW)/U''

Then (σ'', ν'') = (L(e)σ + qν, N(e)σ + L''(e)ν)/(bκ'σ') and κ'' = κκ'. With D and D' exchanged the formula gives the
same. This is a commutative group law on divisors of weight g = 2, with inverse (−D; σ, −ν). (Tsiganov's formula σ'' =
p(e)/(bσσ') for κ = κ' = 1 is singular where U(e) = 0 or U'(e) = 0; with ν the addition is regular there.)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from jacobian import poly
from jacobian.addition import cantor
from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import ArgumentError, NotRepresentable, written
from jacobian.fields.protocol import Field
from jacobian.immutable import Immutable
from jacobian.inexact import composition

Pair = tuple[Any, Any]


class SignedDivisor(NamedTuple):
    """A Mumford pair (u, v) with (σ, ν) and κ at every branch point of its :class:`SignedGroup`."""

    u: poly.Poly
    v: poly.Poly
    pairs: tuple[Pair, ...]
    kappas: tuple[Any, ...]


class Row(NamedTuple):
    """The equation divisor·x = value for an unknown number x; ``divisor`` is a number too. ``terms``: over an inexact
    field, the sum of the absolute values of the terms that were added to ``value``.
    """

    divisor: Any
    value: Any
    terms: Any


class SignedGroup(Immutable):
    """The group of divisors on y² = f(x) with pairs at the given branch points.

    The weight of the divisors, deg u, is two for deg f = 5, the Jacobian of a curve of genus 2, and for deg f = 4, the
    generalized Jacobian of an elliptic curve with modulus ∞₊ + ∞₋. The weight is one for deg f = 3, an elliptic curve.
    Summands of weight one are admitted for deg f = 5 and 3 if the field contains √(leading coefficient of f).
    """

    def __init__(self, curve: HyperellipticCurve, branch_points: Sequence[Any]) -> None:
        if curve.h or len(curve.f) not in (4, 5, 6):
            raise ArgumentError(f"curve = {curve!r}: sign-resolved divisors need h = 0 and deg f = 3, 4 or 5")
        self.curve = curve
        self.weight = 1 if len(curve.f) == 4 else 2
        self._full = ("one", "two")[self.weight - 1]
        self.field = curve.field
        self.branch_points = tuple(curve.field.coerce(e, "branch_points") for e in branch_points)
        for e in self.branch_points:
            if curve.field.exact and poly.evaluate(curve.field, curve.f, e) != curve.field.zero:
                raise ArgumentError(f"branch_points: {written(e)} is not a root of f")

    def __repr__(self) -> str:
        return f"<divisors of {self.curve!r} with signs at {len(self.branch_points)} branch points>"

    def lift(self, u: poly.Poly, v: poly.Poly, signs: Sequence[int] | None = None) -> SignedDivisor:
        """The pair (u, v) with κ = 1 (−1 for weight one), and σ = √(κu(e)) at each branch point e.

        (σ, ν) is multiplied by the sign ±1 that ``signs`` has for e, by default 1. NotASquare where the field has no
        such root.
        """
        K = self.field
        kappa = K.one if len(u) == 3 else K.neg(K.one)
        pairs = []
        for e, sign in zip(self.branch_points, signs or (1,) * len(self.branch_points), strict=True):
            value = K.mul(kappa, poly.evaluate(K, u, e))
            if value == K.zero:
                cofactor = poly.quotient(K, poly.sub(K, self.curve.f, poly.mul(K, v, v)), u)
                pair = (K.zero, K.sqrt(K.neg(K.mul(kappa, poly.evaluate(K, cofactor, e)))))
            else:
                sigma = K.sqrt(value)
                pair = (sigma, K.div(poly.evaluate(K, v, e), K.mul(kappa, sigma)))
            pairs.append(pair if sign > 0 else (K.neg(pair[0]), K.neg(pair[1])))
        return SignedDivisor(u, v, tuple(pairs), (kappa,) * len(pairs))

    def twist(self, u: poly.Poly, v: poly.Poly) -> SignedDivisor:
        """The pair (u, v) with σ = 1 and κ = u(e), which needs no square root.

        Its :meth:`double` has κ = 1 (−1 for weight one). NotRepresentable where u vanishes at a branch point.
        """
        K = self.field
        kappas = tuple(poly.evaluate(K, u, e) for e in self.branch_points)
        if any(kappa == K.zero for kappa in kappas):
            raise NotRepresentable(
                f"u = {poly.text(K, u)} vanishes at a branch point: a divisor there cannot be twisted"
            )
        pairs = tuple(
            (K.one, K.div(poly.evaluate(K, v, e), kappa)) for e, kappa in zip(self.branch_points, kappas, strict=True)
        )
        return SignedDivisor(u, v, pairs, kappas)

    def negate(self, D: SignedDivisor) -> SignedDivisor:
        """The inverse of D: (−D; σ, −ν), for weight one (−D; −σ, ν)."""
        K = self.field
        if len(D.u) == 2:
            pairs = tuple((K.neg(sigma), nu) for sigma, nu in D.pairs)
        else:
            pairs = tuple((sigma, K.neg(nu)) for sigma, nu in D.pairs)
        return D._replace(v=poly.neg(K, D.v), pairs=pairs)

    def double(self, D: SignedDivisor) -> SignedDivisor:
        """D + D with κ = 1 (−1 for weight one).

        The sum by :meth:`add` has κ² (−κ²), with the κ of D. It becomes 1 (−1) as σ and ν are multiplied by κ (−κ).
        """
        K = self.field
        total, sign = self.add(D, D), K.one if self.weight == 2 else K.neg(K.one)
        scales = [K.mul(sign, k) for k in D.kappas]
        pairs = tuple((K.mul(k, x), K.mul(k, y)) for k, (x, y) in zip(scales, total.pairs, strict=True))
        return total._replace(pairs=pairs, kappas=(sign,) * len(pairs))

    def multiple(self, m: int, D: SignedDivisor) -> SignedDivisor:
        """m·D for m ≠ 0, by doubling and adding; NotRepresentable where a partial sum has less than full weight."""
        if m == 0:
            raise NotRepresentable("m = 0: the identity has weight 0 and no pairs")
        if m < 0:
            return self.multiple(-m, self.negate(D))
        result = None
        while True:
            if m & 1:
                result = D if result is None else self.add(result, D)
            m >>= 1
            if not m:
                assert result is not None
                return result
            D = self.double(D)

    def add(self, D: SignedDivisor, E: SignedDivisor) -> SignedDivisor:
        """D + E. NotRepresentable if its weight is below the group's, or if D and E contain the same branch point."""
        K = self.field
        if len(D.u) < len(E.u):
            D, E = E, D
        if len(D.u) == self.weight == 2:
            return self._two_points(D, E)
        p, q, b, u, v = self._sum(D, E)
        of_first, of_second = (self._transfer(p, q, u, v, X.u, X.v) for X in (D, E))
        last = poly.quotient(K, poly.add(K, p, poly.scale(K, q, v) if v else v), u)
        pairs, kappas = [], []
        for i, e in enumerate(self.branch_points):
            (x, y), (x2, y2), k, k2 = D.pairs[i], E.pairs[i], D.kappas[i], E.kappas[i]
            rows = [
                self._row(e, q, transfer, last, pair, K.mul(b, K.mul(kappa, other)))
                for transfer, pair, kappa, other in ((of_first, (x, y), k2, x2), (of_second, (x2, y2), k, x))
            ]
            pairs.append(self._combine(e, rows))
            kappas.append(K.mul(k, k2) if len(E.u) == 3 else K.neg(K.mul(k, k2)))
        return SignedDivisor(u, v, tuple(pairs), tuple(kappas))

    def _two_points(self, D: SignedDivisor, E: SignedDivisor) -> SignedDivisor:
        """The sum of two divisors of weight one, without reduction: U'' = UU', V'' the line through both, σ'' = σσ'."""
        K = self.field
        if K.exact:
            u, v, _ = cantor.compose(self.curve, (D.u, D.v, None), (E.u, E.v, None))
        else:
            u, v, _, _ = self._composed(2, D, E)
        if len(u) != 3:
            raise NotRepresentable("the summands are opposite points: their sum is zero and has no pairs")
        pairs, kappas = [], []
        for e, (x, y), (x2, y2), k, k2 in zip(self.branch_points, D.pairs, E.pairs, D.kappas, E.kappas, strict=True):
            sigma, kappa = K.mul(x, x2), K.mul(k, k2)
            if sigma != K.zero:
                nu = K.div(poly.evaluate(K, v, e), K.mul(kappa, sigma))
            else:
                nu = K.div(K.sub(K.mul(y, x2), K.mul(y2, x)), K.sub(E.u[0], D.u[0]))
            pairs.append((sigma, nu))
            kappas.append(kappa)
        return SignedDivisor(u, v, tuple(pairs), tuple(kappas))

    def _sum(self, D: SignedDivisor, E: SignedDivisor) -> tuple[poly.Poly, Any, Any, poly.Poly, poly.Poly]:
        """(p, q, b, u, v) for D + E: p, q and b of the module's docstring, and the reduced sum (u, v)."""
        K, f = self.field, self.curve.f
        if K.exact:
            product, p, _ = cantor.compose(self.curve, (D.u, D.v, None), (E.u, E.v, None))
            q = K.one
            if len(product) != len(D.u) + len(E.u) - 1:
                raise NotRepresentable(
                    f"the summands share opposite points: their sum has weight below {self._full} and no pairs"
                )
            u, v, _ = cantor.reflect(self.curve, product, p, None)
        else:
            u, v, p, q = self._composed(self.weight, D, E)
        degree = len(D.u) + len(E.u) - 3
        if len(u) != self.weight + 1:
            raise NotRepresentable(f"the sum has weight below {self._full} and no pairs")
        return p, q, (p[degree] if len(E.u) == 3 else K.mul(q, K.sqrt(f[-1]))), u, v

    def _composed(self, genus: int, D: SignedDivisor, E: SignedDivisor) -> tuple[poly.Poly, poly.Poly, poly.Poly, Any]:
        pairs = (list(D.u), list(D.v)), (list(E.u), list(E.v))
        u, v, p, q, _ = composition.compose(self.field, genus, self.curve.f, *pairs)
        return tuple(u), tuple(v), tuple(p), q

    def _transfer(
        self, p: poly.Poly, q: Any, u: poly.Poly, v: poly.Poly, u1: poly.Poly, v1: poly.Poly
    ) -> tuple[poly.Poly, poly.Poly]:
        """The polynomials (L, N) of the module's docstring for the summand (u1, v1) and the sum (u, v)."""
        K, f = self.field, self.curve.f
        minus = K.neg(q)
        slope = poly.quotient(K, poly.add(K, p, poly.scale(K, minus, v1) if v1 else v1), u1)
        cofactor = poly.quotient(K, poly.sub(K, f, poly.mul(K, v1, v1)), u1)
        change = poly.add(K, poly.mul(K, slope, poly.sub(K, v, v1)), poly.scale(K, q, cofactor))
        return slope, poly.quotient(K, change, u)

    def _row(
        self, e: Any, q: Any, transfer: tuple[poly.Poly, poly.Poly], last: poly.Poly, pair: Pair, divisor: Any
    ) -> tuple[Row, Row]:
        """The equations divisor·σ'' = Lσ + qν and divisor·ν'' = Nσ + L''ν at e, from one summand.

        ``transfer`` is (L, N), ``last`` is L'' and ``pair`` is (σ, ν), in the letters of the module's docstring.
        """
        K = self.field
        (slope, lower), (sigma, nu) = transfer, pair
        first = K.add(K.mul(poly.evaluate(K, slope, e), sigma), K.mul(q, nu))
        second = K.add(K.mul(poly.evaluate(K, lower, e), sigma), K.mul(poly.evaluate(K, last, e), nu))
        if K.exact:
            return Row(divisor, first, 0), Row(divisor, second, 0)
        size = abs(sigma)
        terms = poly.size_at(slope, e) * size + abs(q * nu)
        lower_terms = poly.size_at(lower, e) * size + poly.size_at(last, e) * abs(nu)
        return Row(divisor, first, terms), Row(divisor, second, lower_terms)

    def _combine(self, e: Any, rows: list[tuple[Row, Row]]) -> Pair:
        """(σ'', ν'') from the equations of :meth:`_row`, of which ``rows`` has two for each summand.

        The equations of a summand whose divisor ≠ 0 are solved; over an inexact field, those of both, by least squares.
        """
        K = self.field
        used = [row for row in rows if row[0].divisor != K.zero]
        if not used:
            raise NotRepresentable(
                f"both summands contain the branch point x = {written(e)}: add them in another order"
            )
        if K.exact:
            first, second = used[0]
            return K.div(first.value, first.divisor), K.div(second.value, second.divisor)
        first, second = (_mean(part) for part in zip(*used, strict=True))
        return first, second


def sheared(K: Field, pairs: Sequence[Pair], c: Any) -> tuple[Pair, ...]:
    """The pairs (σ, ν + cσ) of the Mumford pair (U, V + cU), from the pairs (σ, ν) of (U, V)."""
    return tuple((sigma, K.add(nu, K.mul(c, sigma))) for sigma, nu in pairs)


def reflected(K: Field, pairs: Sequence[Pair], roots: Sequence[Any]) -> tuple[Pair, ...]:
    """The pairs (ν/ρ, −ρσ) of the Mumford pair (Ũ, −P), from the pairs (σ, ν) of (U, P) and ``roots``, the ρ.

    Here P² − f = R·U·Ũ and ρ² = R(e) ≠ 0, and both pairs have the same κ. R is the leading coefficient of P² − f for a
    step along the pencil of :mod:`jacobian.relatives.conic`, and −f₅(x − x') for the addition of the point (x', P(x')).
    """
    return tuple((K.div(nu, rho), K.neg(K.mul(rho, sigma))) for (sigma, nu), rho in zip(pairs, roots, strict=True))


def _mean(rows: Sequence[Row]) -> Any:
    """The least-squares solution x of the equations divisor·x = value, each divided by its ``terms``."""
    numerator = denominator = 0
    for divisor, value, terms in rows:
        unit = terms or 1
        d = divisor / unit
        numerator, denominator = numerator + d.conjugate() * (value / unit), denominator + d.conjugate() * d
    return numerator / denominator
