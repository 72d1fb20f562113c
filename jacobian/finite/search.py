"""The characteristic polynomial of Frobenius where counting all points one by one is out of reach.

In the notation of :mod:`jacobian.finite.weil`, counting over GF(q^i) gives some r_i, and the Cartier–Manin matrix gives
the other r_i modulo p (:mod:`jacobian.finite.hasse_witt`). Baby steps and giant steps search the remaining candidates
for orders that annihilate a random class (Gaudry and Harley 2000; Matsuo, Chao and Tsujii 2002; Sutherland 2009), on
the curve and on its quadratic twist, until one polynomial is left. Where several remain, as for groups of small
exponent, the structures of the two groups decide.

The result is proven: a candidate is eliminated only when its order does not annihilate a class, or is not divisible by
a known divisor of the order of the group.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import islice
from math import comb, gcd, isqrt, lcm, prod
from random import Random
from typing import Any

from jacobian import poly
from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import Infeasible
from jacobian.finite import counting, weil
from jacobian.finite.elimination import alone
from jacobian.finite.hasse_witt import PRODUCTS_TO, frobenius_modulo_p
from jacobian.finite.integers import factorization
from jacobian.finite.orders import reduce_order
from jacobian.finite.scalar import FixedBase
from jacobian.finite.structure import PrimaryGroup
from jacobian.law.divisor import Divisor
from jacobian.numbers.compiler import interpreted
from jacobian.progress import Progress

COUNT_LIMIT = 200_000
SEARCH_LIMIT = 10**12
_LONGEST_LIST = 20_000
_FEW = 100


@dataclass(frozen=True)
class Candidates:
    """The candidates for the polynomial R of :mod:`jacobian.finite.weil`, lists of its coefficients 1, r_1, … r_g.

    ``known`` are the first coefficients; the others are ≡ ``residues`` modulo ``modulus``.
    """

    q: int
    genus: int
    known: tuple[int, ...]
    residues: tuple[int, ...]
    modulus: int

    def interval(self, r: tuple[int, ...]) -> tuple[int, int]:
        """Bounds of the r_k after r, from r_1²/g ≤ Σ x_i² ≤ 4gq for the roots x_i of R and Maclaurin's inequality."""
        k, g = len(r), self.genus
        if k == 1:
            bound = isqrt(4 * g * g * self.q)
            return -bound, bound
        if k == 2:
            return -(-(r[1] ** 2 - 4 * g * self.q) // 2), r[1] ** 2 * (g - 1) // (2 * g)
        squares = r[1] ** 2 - 2 * r[2]
        bound = isqrt(comb(g, k) ** 2 * squares**k // g**k) + 1
        return -bound, bound

    def values(self, r: tuple[int, ...]) -> range:
        """The values of the next coefficient that may follow r = (1, r_1, …), in arithmetic progression."""
        low, high = self.interval(r)
        residue = self.residues[len(r) - len(self.known)]
        return range(low + (residue - low) % self.modulus, high + 1, self.modulus)

    def prefixes(self, r: tuple[int, ...] | None = None) -> Iterator[tuple[int, ...]]:
        """Yields all tuples (1, r_1 … r_(g−1)) of candidates that begin with r."""
        r = self.known if r is None else r
        if len(r) >= self.genus:
            yield r[: self.genus]
            return
        for value in self.values(r):
            yield from self.prefixes((*r, value))

    def last(self, prefix: tuple[int, ...]) -> range:
        """The values of r_g, the last coefficient of R, that may follow ``prefix`` = (1, r_1, …, r_(g−1))."""
        return range(self.known[-1], self.known[-1] + 1) if len(self.known) > self.genus else self.values(prefix)

    def size(self) -> int:
        """An upper estimate of the number of candidates."""
        r, total = self.known, 1
        while len(r) <= self.genus:
            low, high = self.interval(r)
            total *= (high - low) // self.modulus + 1
            # the interval of r_3 is widest for the least r_2
            r = (*r, low if len(r) == 2 else 0)
        return total

    def matching(self, sides: tuple[Side, Side]) -> Iterator[list[int]]:
        """Yields the candidates R such that on both sides the known ``divisor`` divides :meth:`Side.order`."""
        first, second = sorted(sides, key=lambda side: -side.divisor)
        for prefix in self.prefixes():
            constant, sign = first.constant(prefix, self.q)
            for value in _congruent(self.last(prefix), -sign * constant, first.divisor):
                r = [*prefix, value]
                if second.order(r, self.q) % second.divisor == 0 and _is_weil(r, self.q):
                    yield r


def _congruent(values: range, residue: int, modulus: int) -> range:
    """The members of an arithmetic progression that are ≡ residue modulo ``modulus``."""
    if not len(values):
        return values
    step, common = values.step, gcd(values.step, modulus)
    if (residue - values.start) % common:
        return range(0)
    rest = modulus // common
    skip = (residue - values.start) // common * pow(step // common, -1, rest) % rest
    return range(values.start + skip * step, values.stop, step * rest)


def _is_weil(r: list[int], q: int) -> bool:
    """Whether all roots of R, the polynomial with the coefficients r, are real and at most 2√q in size.

    A margin for rounding ensures that the right R is never rejected.
    """
    import numpy as np

    size = float(2 * q**0.5)
    roots = np.roots([float(c) / size**i for i, c in enumerate(r)])
    return bool(np.all(np.abs(roots.imag) < 1e-3) and np.all(np.abs(roots.real) < 1.001))


class Side:
    """The curve (sign 1) or its twist (sign −1): its Jacobian, and known divisors of its order and exponent."""

    def __init__(self, C: HyperellipticCurve, sign: int) -> None:
        self.J: Any = C.jacobian()
        self.sign = sign
        self.exponent = self.divisor = 1
        self._groups: dict[int, PrimaryGroup] = {}

    def order(self, r: list[int], q: int) -> int:
        """The order of ``J`` if the curve has the R = z^g + r_1 z^(g−1) + … of :mod:`jacobian.finite.weil`: R(1 + q)
        for the curve, (−1)^g R(−1 − q) for the twist.
        """
        return sum(c * self.sign**k * (1 + q) ** (len(r) - 1 - k) for k, c in enumerate(r))

    def constant(self, prefix: tuple[int, ...], q: int) -> tuple[int, int]:
        """(a, s) such that :meth:`order` is a + s·r_g for the coefficients ``prefix``, r_g of R."""
        return self.order([*prefix, 0], q), self.sign ** len(prefix)

    def learn(self, D: Divisor, candidates: Candidates) -> None:
        """Replaces ``exponent`` and ``divisor`` by their least common multiples with the order of D."""
        if self.exponent * D:
            r = next(self.annihilating(D, candidates), None)
            assert r is not None, f"no order within the Weil bounds annihilates {D} on {self.J.curve!r}"
            self.exponent = lcm(self.exponent, reduce_order(D, factorization(self.order(r, candidates.q))))
            self.divisor = lcm(self.divisor, self.exponent)

    def annihilating(self, D: Divisor, candidates: Candidates) -> Iterator[list[int]]:
        """Yields the candidates R whose orders annihilate D, found by baby steps and giant steps."""
        q, m = candidates.q, candidates.modulus
        lengths = [len(candidates.last(prefix)) for prefix in candidates.prefixes()]
        step = isqrt(sum(lengths)) + 1
        progress = Progress(f"the order of a class of {self.J.curve!r}", step + sum(-(-n // step) for n in lengths))
        sign = self.sign**candidates.genus
        table: dict[Divisor, list[int]] = {}
        small, baby = -sign * m * D, self.J.zero()
        for i in range(step):
            table.setdefault(baby, []).append(i)
            baby = baby + small
            progress.add(1)
        giant, multiples = -step * small, FixedBase(D)
        for prefix in candidates.prefixes():
            values = candidates.last(prefix)
            if not len(values):
                continue
            start = self.constant(prefix, q)[0] + sign * values[0]
            place = multiples(start)
            for j in range(0, len(values), step):
                yield from ([*prefix, values[j + i]] for i in table.get(place, ()) if j + i < len(values))
                place = place + giant
                progress.add(1)

    def grow(self, D: Divisor) -> None:
        """Adds D, whose order divides ``exponent``, to the known subgroup, the order of which divides ``divisor``."""
        for prime, e in factorization(self.exponent).items():
            group = self._groups.setdefault(prime, PrimaryGroup(self.J.zero(), prime))
            group.insert(self.exponent // prime**e * D)
        self.divisor = lcm(self.exponent, prod(group.order for group in self._groups.values()))


def search(C: HyperellipticCurve) -> list[int]:
    """The characteristic polynomial of Frobenius of C, ascending.

    Counting takes O(q) operations. The Cartier–Manin matrix takes O(g·p), or Õ(√p) from p = 2^20 on, and the search the
    square root of the number of candidates. Together they take seconds for prime fields up to 10^9 in genus 2 and 3
    and up to 10^3 in genus 4, and half a minute at 10^12 in genus 2. In genus 1 there is only the search, O(q^(1/4))
    over any field (Mestre's method, Schoof 1995). Infeasible from genus 2 on for prime q above 2^49 and other q above
    2^20, and where more than 10^12 candidates are left.
    """
    candidates = _candidates(C)
    rng = Random(0)
    sides = (Side(_with_classes(C, rng), 1), Side(_with_classes(C.quadratic_twist(), rng), -1))
    found = _without_factors(candidates, sides, rng)
    if found is not None:
        return weil.from_real_part(found, candidates.q)
    for effort in range(60):
        for side in sides:
            D = side.J.random(rng)
            side.learn(D, candidates)
            if effort:
                # the order of the known subgroup divides the right order; the exponent alone may allow several orders
                side.grow(D)
        left = list(islice(candidates.matching(sides), _LONGEST_LIST))
        if len(left) == 1:
            return weil.from_real_part(left[0], candidates.q)
    if candidates.q**C.genus <= counting.TABLE_SIZE:
        return counting.frobenius_polynomial(C)
    raise Infeasible(
        f"{C!r}: {len(left)} characteristic polynomials agree with the structures of its Jacobian and of its twist"
    )


def _without_factors(candidates: Candidates, sides: tuple[Side, Side], rng: Random) -> list[int] | None:
    """The only candidate whose order annihilates random classes. None if several are left, or more than _FEW after the
    first class. No order is factored.
    """
    q, (side, _) = candidates.q, sides
    few = list(islice(side.annihilating(side.J.random(rng), candidates), _FEW + 1))
    if len(few) > _FEW:
        return None
    return alone([r for r in few if _is_weil(r, q)], [(side.J, partial(side.order, q=q)) for side in sides], rng)


def _candidates(C: HyperellipticCurve) -> Candidates:
    q: Any = C.field.order
    g = C.genus
    prime = q == C.field.characteristic != 2
    if g == 1:
        # the search finds the order among 4√q candidates in O(q^(1/4)) steps, so no matrix and no count is needed
        found = Candidates(q, 1, (1,), (0,), 1)
        _check_size(C, found, f"{C.field.name} in genus 1")
        return found
    limit = counting.ARRAY_SIZE if prime else counting.TABLE_SIZE
    if q > limit and not (prime and q < PRODUCTS_TO and not interpreted()):
        raise Infeasible(
            f"field = {C.field.name}: characteristic polynomials of Frobenius are found for prime q up to "
            f"{PRODUCTS_TO}, other q up to {counting.TABLE_SIZE}, and for curves defined over a small prime field; "
            "if #J is known, give it to the functions that need it"
        )
    if q > limit:
        # the size does not depend on the residues, so it is checked before they are computed
        _check_size(C, Candidates(q, g, (1, 0), (0,) * (g - 1), q), f"{C.field.name} in genus {g}")
    residues = frobenius_modulo_p(C)
    excess = [_excess(C, residues)]
    candidates = _with_counts(C, excess, residues)
    # the points over one more extension are counted where that is fast, or faster than a search without this count: a
    # step of the search takes about as long as counting ``step`` elements
    step = 1000 if prime else 8
    while (i := len(excess) + 1) <= g and q**i <= limit:
        if q**i > counting_is_quick(C) and q**i > step * isqrt(candidates.size()):
            break
        excess.append(counting.count_points(C, i) - q**i - 1)
        candidates = _with_counts(C, excess, residues)
    _check_size(C, candidates, f"the counts over GF({q}^{len(excess)})")
    return candidates


def _check_size(C: HyperellipticCurve, candidates: Candidates, known: str) -> None:
    if candidates.size() > SEARCH_LIMIT:
        raise Infeasible(
            f"{C!r}: about {candidates.size():.1e} characteristic polynomials fit {known}; the search ends at "
            f"{SEARCH_LIMIT:.0e}"
        )


def _excess(C: HyperellipticCurve, residues: list[int] | None) -> int:
    """#C(GF(q)) − q − 1, at most 2g√q in size: from the residue modulo p if that determines it, else by counting."""
    q: Any = C.field.order
    if residues is None or q != C.field.characteristic or q <= 16 * C.genus**2:
        return counting.count_points(C) - q - 1
    return residues[0] - q if 2 * residues[0] > q else residues[0]


def counting_is_quick(C: HyperellipticCurve) -> int:
    """The field size up to which counting takes tenths of a second: by numpy over GF(p), by Python elsewhere."""
    return COUNT_LIMIT if C.field.order == C.field.characteristic != 2 else COUNT_LIMIT // 50


def _with_counts(C: HyperellipticCurve, excess: list[int], residues: list[int] | None) -> Candidates:
    q: Any = C.field.order
    g = C.genus
    known = weil.real_part(weil.leading(excess), q, g)
    # the coefficients r_i of R and a_i of χ differ by a multiple of q, so their residues modulo p are equal
    rest, p = ([0] * g, 1) if residues is None else (residues, C.field.characteristic)
    return Candidates(q, g, tuple(known), tuple(rest[len(excess) :]), p)


def _with_classes(C: HyperellipticCurve, rng: Random) -> HyperellipticCurve:
    """C itself, or, for an inert model of odd genus, an isomorphic curve with a rational point at infinity."""
    if C.model != "inert" or C.genus % 2 == 0:
        return C
    K, g = C.field, C.genus
    x = C.random_point(rng).x
    # the new coordinates X, Y have x = x₀ + 1/X and y = Y/X^(g+1), x₀ the abscissa of a random point
    f, h = poly.shift(K, C.f, x), poly.shift(K, C.h, x)
    f, h = (*f, *[K.zero] * (2 * g + 3 - len(f))), (*h, *[K.zero] * (g + 2 - len(h)))
    return HyperellipticCurve(K, f[::-1], h[::-1])
