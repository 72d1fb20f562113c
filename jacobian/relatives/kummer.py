"""The Kummer surface of a curve of genus 2 over QQ or GF(p), and doubling on it (Flynn 1993; Cassels & Flynn 1996,
chapter 3). Sums on it are in :mod:`jacobian.relatives.pseudo_group`.

The surface is the Jacobian modulo D ↦ −D. For y² = f(x) the class of (x₁, y₁) + (x₂, y₂) − (∞₊ + ∞₋) is mapped by κ to
(1 : x₁+x₂ : x₁x₂ : (F₀(x₁, x₂) − 2y₁y₂)/(x₁−x₂)²), F₀ as in chapter 3. If f is integral, there are four quartic forms δ
with integral coefficients and κ(2D) = δ(κ(D)). They are found from doubled classes over finite fields, by linear
algebra and the Chinese remainder theorem.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import cached_property, lru_cache
from itertools import combinations_with_replacement
from math import lcm
from random import Random
from typing import Any

from jacobian import poly
from jacobian.curve.curve import HyperellipticCurve, check_curve
from jacobian.errors import CurveMismatch, FieldError, Infeasible, JacobianError
from jacobian.fields import GF, QQ
from jacobian.fields.primality import is_prime
from jacobian.fields.prime import PrimeField
from jacobian.fields.rational import primitive
from jacobian.group import Jacobian
from jacobian.immutable import Immutable
from jacobian.law.divisor import Divisor, check_divisor

# the quartic monomials in ξ₁ … ξ₄, {their exponents: the indices of their factors in two pairs}. ξ₂²ξ₄² is left out: it
# has the coefficient 1 in the equation of the surface, which expresses it by the others
FACTORS = {
    tuple(chosen.count(i) for i in range(4)): (chosen[:2], chosen[2:])
    for chosen in combinations_with_replacement(range(4), 4)
    if chosen != (1, 1, 3, 3)
}
MONOMIALS = list(FACTORS)
# the coefficients of δ are polynomials of degree 4 in those of f, of the size of max|f_i|⁴. They are computed modulo a
# product of primes with 2·SPARE_BITS bits more than this size; a result with SPARE_BITS bits more is refused
SPARE_BITS = 80
MOST_PRIMES = 200
# the number of classes D from whose κ(D) and κ(2D) δ is found
CLASSES = 60

Coordinates = tuple[Any, ...]


class KummerSurface(Immutable):
    """The Kummer surface of the Jacobian of a curve of genus 2 over QQ or GF(p), p odd, made by :func:`kummer_surface`.

    ``f``: seven integers, the coefficients of the curve Y² = f(x), where Y = ``scale``·(2y + h(x)).
    """

    def __init__(self, curve: HyperellipticCurve) -> None:
        K = check_curve(curve).field
        odd_prime = type(K) is PrimeField and K.p > 2
        if not (odd_prime or K == QQ) or curve.genus != 2:
            raise FieldError(
                f"curve = {curve!r}: Kummer surfaces are here those of curves of genus 2 over QQ or GF(p), p odd"
            )
        self.curve = curve
        self.scale = 1 if odd_prime else lcm(*(c.denominator for c in curve.discriminant))
        numbers = [int(c * self.scale**2) for c in curve.discriminant]
        self.f = tuple(numbers + [0] * (7 - len(numbers)))

    def _value(self) -> tuple[object, ...]:
        return (self.curve,)

    def __repr__(self) -> str:
        return f"Kummer surface of {self.curve!r}"

    def point(self, D: Divisor) -> Coordinates:
        """The image κ(D) of D, the same for −D; CurveMismatch for a class of another curve.

        Over QQ it is four integers without a common divisor, over GF(p) four residues, the first nonzero one being 1.
        """
        if check_divisor(D, "D").jacobian.curve != self.curve:
            raise CurveMismatch(f"D = {D} is not a divisor class of {self.curve!r}")
        K: Any = self.curve.field
        if K != QQ:
            return normalized(K.p, self._coordinates(D))
        return tuple(primitive(self._coordinates(D)))

    def _coordinates(self, D: Divisor) -> Sequence[Any]:
        f, K = self.f, self.curve.field
        double = poly.mod(K, poly.add(K, poly.scale(K, K.coerce(2), D.v), self.curve.h), D.u)
        v = [self.scale * c for c in double] + [K.zero] * 2
        if len(D.u) == 3:
            return coordinates(f, D.u, v)
        if len(D.u) == 2:
            x = -D.u[0]
            # the value of Y/x³ at the point at infinity of D
            h3 = self.curve.h[3] if len(self.curve.h) > 3 else 0
            slope = 0 if D.n is None else self.scale * (2 * self.curve.infinity_plus + h3)
            slope = slope if D.n in (1, None) else -slope
            return 0, 1, x, 2 * f[6] * x**3 + f[5] * x**2 - 2 * slope * v[0]
        if D.n in (1, None):
            return 0, 0, 0, 1
        return 0, 0, 1, K.sub(K.div(K.coerce(f[5] ** 2), K.coerce(4 * f[6])), K.coerce(f[4]))

    @cached_property
    def delta(self) -> list[dict[tuple[int, ...], int]]:
        """The doubling forms δ₁ … δ₄, each as {exponents: coefficient}.

        They are unique modulo the equation of the surface if the coefficient of ξ₄⁴ in δ₄ is 1.
        """
        rows = self.integers(len(MONOMIALS), self._delta_modulo)
        return [{m: c for m, c in zip(MONOMIALS, row, strict=True) if c} for row in rows]

    def integers(self, width: int, modulo: Callable[[Jacobian], list[int]]) -> list[list[int]]:
        """The integers whose residues modulo primes p are given by ``modulo``, in rows of ``width`` integers.

        They must be values of integral polynomials of degree 4 in the coefficients of f. ``modulo(J)`` returns all
        residues modulo p in one list, J being the Jacobian of y² = f(x) over GF(p).
        """
        size = max(map(abs, self.f)) ** 4
        modulus, residues = 1, list[int]()
        for J in self._reductions():
            p, found = J.field.characteristic, modulo(J)
            step = pow(modulus, -1, p)
            known = residues or [0] * len(found)
            residues = [r + modulus * ((c - r) * step % p) for r, c in zip(known, found, strict=True)]
            modulus *= p
            if modulus > size << (2 * SPARE_BITS):
                break
        whole = [r - modulus if 2 * r > modulus else r for r in residues]
        if max(map(abs, whole)) > size << SPARE_BITS:
            raise Infeasible(f"{self.curve!r}: the forms of its Kummer surface were not found")
        return [whole[i : i + width] for i in range(0, len(whole), width)]

    def _reductions(self) -> Iterator[Jacobian]:
        """Yields the Jacobians of y² = f(x) over GF(p) for primes p of good reduction, descending from 2⁶¹ − 1."""
        for p in filter(is_prime, range(2**61 - 1, 2**61 - 50 * MOST_PRIMES, -2)):
            with suppress(JacobianError):
                yield HyperellipticCurve(GF(p), [c % p for c in self.f]).jacobian()

    def _delta_modulo(self, J: Jacobian) -> list[int]:
        """All coefficients of δ modulo a prime, from the equations δ_1(x)·y_i = δ_i(x)·y_1 for x = κ(D), y = κ(2D)."""
        rows, p = [], J.field.characteristic
        for x, y in self._doubles(J):
            values = monomials(x).values()
            for i in range(1, 4):
                row = [0] * (4 * len(MONOMIALS))
                for k, value in enumerate(values):
                    row[k], row[i * len(MONOMIALS) + k] = value * y[i] % p, -value * y[0] % p
                rows.append(row)
        found = null_vector(rows, 3 * len(MONOMIALS) + MONOMIALS.index((0, 0, 0, 4)), p)
        if found is None:
            raise Infeasible(f"{self.curve!r}: the doubling on the Kummer surface was not found modulo {p}")
        return found

    def _doubles(self, J: Jacobian) -> Iterator[tuple[Coordinates, Coordinates]]:
        """Yields (κ(D), κ(2D)) modulo p for CLASSES classes D of weight 2 in arithmetic progression."""
        p = J.field.characteristic
        rng = Random(p)
        D, E = J.random(rng), J.random(rng)
        count = 0
        while count < CLASSES:
            D = D + E
            pair = [coordinates(self.f, G.u, [*G.v, 0, 0]) for G in (D, D + D) if len(G.u) == 3]
            if len(pair) == 2:
                yield tuple(x % p for x in pair[0]), tuple(x % p for x in pair[1])
                count += 1

    def double(self, x: Sequence[Any]) -> list[Any]:
        """δ(x) for integers or balls x. Common divisors are not removed, and nothing is reduced modulo p."""
        values = monomials(x)
        return [sum((c * values[m] for m, c in form.items()), 0 * x[0]) for form in self.delta]


def kummer_surface(curve: HyperellipticCurve) -> KummerSurface:
    """The KummerSurface of a curve of genus 2 over QQ or GF(p), p odd; FieldError over other fields.

    Calls with equal curves return one object, so that its forms are found once.
    """
    return _known_surface(check_curve(curve))


_known_surface = lru_cache(maxsize=32)(KummerSurface)


def null_vector(rows: Sequence[Sequence[int]], one: int, p: int) -> list[int] | None:
    """The vector that spans the kernel of the matrix ``rows`` modulo p, scaled so that its entry ``one`` is 1.

    None if the dimension of the kernel is not 1.
    """
    from flint import nmod_mat

    kernel, dimension = nmod_mat(len(rows), len(rows[0]), [c for row in rows for c in row], p).nullspace()
    if dimension != 1:
        return None
    column = [int(kernel[i, 0]) for i in range(len(rows[0]))]
    inverse = pow(column[one], -1, p)
    return [c * inverse % p for c in column]


def coordinates(f: Sequence[Any], u: Sequence[Any], v: Sequence[Any]) -> Coordinates:
    """κ of the class of (u, v), deg u = 2. Its last coordinate is a polynomial in the coefficients of f, u and v."""
    s, p = -u[1], u[0]
    last = s * s - p
    return 1, s, p, v[1] ** 2 - f[2] - s * f[3] - s * s * f[4] - s * last * f[5] - last * last * f[6]


def normalized(p: int, x: Sequence[int]) -> Coordinates:
    """The coordinates x of a point, multiplied modulo p so that the first nonzero one is 1."""
    inverse = pow(next(c for c in x if c % p), -1, p)
    return tuple(int(c * inverse % p) for c in x)


def monomials(x: Sequence[Any]) -> dict[tuple[int, ...], Any]:
    """The values at x of the quartic MONOMIALS, by their exponents."""
    pairs = {(i, j): x[i] * x[j] for i, j in combinations_with_replacement(range(4), 2)}
    return {m: pairs[first] * pairs[second] for m, (first, second) in FACTORS.items()}
