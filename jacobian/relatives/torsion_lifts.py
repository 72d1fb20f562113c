"""All classes of finite order over QQ in genus 2, lifted from classes modulo a prime.

Let the class T̄ of J(GF(p)) have order m, prime to p. It is the reduction of exactly one class T of order m over the
p-adic numbers. On the Kummer surface κ(T) is the only point that reduces to κ(T̄) and is mapped to itself by the map
φ: κ(D) ↦ κ((m + 1)D). The derivative of φ there is m + 1, so Newton's step x − (φ(x) − x)/m for φ(x) = x doubles the
number of correct p-adic digits.

If T is rational, its canonical height is 0, which bounds the integral coordinates of κ(T)
(:mod:`jacobian.relatives.doubling_bounds`). So once pᵏ exceeds twice the square of the bound, either a rational T is
found or none exists. Müller & Reitsma (2023) do the same in genus 3.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import ceil, gcd, lcm, log, prod
from typing import Any

from jacobian import poly
from jacobian.errors import JacobianError
from jacobian.fields import GF, QQ
from jacobian.finite.structure import PrimaryGroup
from jacobian.group import Jacobian
from jacobian.law.divisor import Divisor
from jacobian.numbers.two_words import Residues
from jacobian.relatives.doubling_bounds import bad_part, real_bounds
from jacobian.relatives.kummer import Coordinates, KummerSurface, kummer_surface
from jacobian.relatives.pseudo_group import equation, forms_of_surface
from jacobian.relatives.pseudo_sums import SCRATCH, multiple_of, unit


def grow(group: PrimaryGroup, reduced: PrimaryGroup, whole: PrimaryGroup) -> None:
    """Enlarges a ``group`` of rational classes of ℓ-power order to the group of all such classes.

    ``reduced``: the group of their reductions modulo a prime p of good reduction, p ≠ 2, ℓ; ``whole``: the group of all
    classes of ℓ-power order modulo p. For ℓ = 2 the group must already contain all classes of order two: their images
    are singular points of the surface, at which Newton's method fails.
    """
    lifts = TorsionLifts(group.zero.jacobian, whole.zero.jacobian.field.characteristic)  # type: ignore[arg-type]
    tried: set[Divisor] = set()
    classes = _divided(reduced, whole)
    while (T := next(classes, None)) is not None:
        if T in tried or (whole.prime == 2 and not 2 * T):
            continue
        found = lifts.lifted(T, whole.prime ** max(whole.exponents))
        if found is None:
            choices = product(*(range(whole.prime**e) for e in reduced.exponents))
            tried.update(c * T + reduced.combination(chosen) for chosen in choices for c in range(1, whole.prime))
        else:
            group.insert(found)
            reduced.insert(T)
            classes, tried = _divided(reduced, whole), set()


def _divided(group: PrimaryGroup, whole: PrimaryGroup) -> Iterator[Divisor]:
    """Yields classes T of ``whole`` outside ``group`` with ℓT in ``group``, at least one of each coset of ``group``."""
    ell = whole.prime
    # these multiples of the generators generate the classes of order ℓ
    socle = [ell ** (e - 1) for e in whole.exponents]
    for chosen in product(range(ell), repeat=len(group.generators)):
        known = whole.coordinates(group.combination(chosen)) or []
        if any(c % ell for c in known):
            continue
        for digits in product(range(ell), repeat=len(socle)):
            T = whole.combination([c // ell + d * s for c, d, s in zip(known, digits, socle, strict=True)])
            if group.coordinates(T) is None:
                yield T


class TorsionLifts:
    """Finds rational classes of finite order from their reductions modulo a prime p ≠ 2 of good reduction."""

    def __init__(self, J: Jacobian, p: int) -> None:
        self.J, self.p = J, p
        self.surface = kummer_surface(J.curve)
        self.reduced = kummer_surface(J.change_ring(GF(p)).curve)
        # 0 = ĥ(T) ≥ h(T) + low/3 − log(bad part)/3, which bounds h(T)
        low, _ = real_bounds(self.surface)
        self.bits = ceil((log(bad_part(self.surface)) - low) / 3 / log(2)) + 1
        self.digits = 1
        while p**self.digits <= 1 << (2 * self.bits + 1):
            self.digits *= 2
        self.forms = forms_of_surface(self.surface, p**self.digits, int)
        self.equation = equation(self.surface.f)

    def lifted(self, T: Divisor, m: int) -> Divisor | None:
        """A rational class that reduces to ±T and whose order divides m, or None. 2T ≠ 0 and p ∤ m are required."""
        x = list(self.reduced.point(T))
        # modulo p the surface is that of y² = F = h² + 4f, over QQ that of y² = scale²·F
        x[3] = x[3] * self.surface.scale**2 % self.p
        i = unit(x)
        others = [k for k in range(4) if k != i]
        dependent = next(k for k in others if self._slope(x, k) % self.p)
        modulus, bits = self.p, [int(bit) for bit in bin(m + 1)[2:]]
        for _ in range(self.digits.bit_length() - 1):
            modulus = modulus**2
            x[dependent] = self._solved(x, dependent, modulus)
            image = multiple_of(Residues(modulus), self.forms, [0] * SCRATCH, x, i, bits)
            step, scale = (pow(c, -1, modulus) for c in (m, image[i]))
            for k in others:
                if k != dependent:
                    x[k] = (x[k] - step * (scale * image[k] - x[k])) % modulus
            x[dependent] = self._solved(x, dependent, modulus)
        found = rational_class(self.surface, self.J, self._integers(x, modulus))
        return found if found is not None and not m * found else None

    def _solved(self, x: list[int], k: int, modulus: int) -> int:
        """The coordinate k of the point of the surface with the other coordinates of x, after one Newton step."""
        value = sum(c * prod(x[i] for i in indices) for indices, c in self.equation.items())
        return (x[k] - value * pow(self._slope(x, k), -1, modulus)) % modulus

    def _slope(self, x: list[int], k: int) -> int:
        """The derivative at x of the surface's equation by the coordinate k."""
        return sum(
            c * prod(x[i] for i in (*indices[:n], *indices[n + 1 :]))
            for indices, c in self.equation.items()
            for n, own in enumerate(indices)
            if own == k
        )

    def _integers(self, x: list[int], modulus: int) -> list[int] | None:
        """Integers without a common divisor that are proportional to x modulo ``modulus``, or None.

        Each x_k is read as the fraction whose numerator and denominator have at most ``bits`` bits.
        """
        fractions = [rational_of(c, modulus, 1 << self.bits) for c in x]
        if None in fractions:
            return None
        pairs: list[Any] = fractions
        common = lcm(*(d for _, d in pairs))
        return [n * common // d for n, d in pairs]


def rational_of(c: int, modulus: int, bound: int) -> tuple[int, int] | None:
    """The fraction (n, d) with n ≡ cd modulo ``modulus``, |n| ≤ bound, 0 < d ≤ bound and gcd(n, d) = 1, or None.

    It is found by Euclid's algorithm (Wang 1981), and is unique for 2·bound² < ``modulus``.
    """
    (r, s), (d, e) = (modulus, c % modulus), (0, 1)
    while s > bound:
        quotient = r // s
        (r, s), (d, e) = (s, r - quotient * s), (e, d - quotient * e)
    if abs(e) > bound or gcd(s, e) != 1:
        return None
    return (s, e) if e > 0 else (-s, -e)


def rational_class(surface: KummerSurface, J: Jacobian, x: Coordinates | list[int] | None) -> Divisor | None:
    """A rational class D of J with κ(D) = ±x, or None if there is none; the integers x have no common divisor."""
    if x is None:
        return None
    try:
        candidates = list(_of_weight_two(surface, J, x) if x[0] else _of_less_weight(J, x))
    except JacobianError:
        # a square root is not rational, or (u, v) is not on the curve: no rational class has the coordinates x
        return None
    return next((D for D in candidates if surface.point(D) in (tuple(x), tuple(-c for c in x))), None)


def _of_weight_two(surface: KummerSurface, J: Jacobian, x: Any) -> Iterator[Divisor]:
    K, f, h = QQ, surface.f, J.curve.h
    s, p, last = (K.div(K.coerce(c), K.coerce(x[0])) for c in x[1:])
    u = (p, -s, K.one)
    t = s * s - p
    # v₁² for v = v₁x + v₀ with v² ≡ f modulo u
    square = last + f[2] + s * f[3] + s * s * f[4] + s * t * f[5] + t * t * f[6]
    first, second = (*poly.mod(K, tuple(map(K.coerce, f)), u), K.zero, K.zero)[:2]
    if square:
        v1 = K.sqrt(square)
        v0 = (second - square * s) / (2 * v1)
    else:
        v0, v1 = K.sqrt(first), K.zero
    v = poly.scale(K, K.inv(K.coerce(surface.scale)), poly.trim(K, (v0, v1)))
    v = poly.scale(K, K.coerce("1/2"), poly.sub(K, v, poly.mod(K, h, u)))
    yield J.from_mumford(u, v)


def _of_less_weight(J: Jacobian, x: Any) -> Iterator[Divisor]:
    """Yields the classes of weight below two that may have κ = x: those of one affine point, ±(∞₊ − ∞₋) and 0."""
    K, weights = QQ, (0, 1, 2) if J.curve.model == "split" else (None,)
    if x[1]:
        a = K.div(K.coerce(x[2]), K.coerce(x[1]))
        y = K.sqrt(poly.evaluate(K, J.curve.discriminant, a))
        v = (y - poly.evaluate(K, J.curve.h, a)) / 2
        yield from (J.from_mumford((-a, K.one), (v,), n) for n in weights[:2])
    else:
        yield from (J.from_mumford((K.one,), (), n) for n in weights)
