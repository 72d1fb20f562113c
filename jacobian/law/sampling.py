"""Uniform random divisor classes, and lists of all classes, over finite fields.

Each class has exactly one reduced triple (u, v, n). For a given u = Π P^e, P irreducible, the number of v is a product
over the P. The factor is 2 if y² + hy − f has two roots modulo P, 1 if it has a double root and e = 1, otherwise 0. So
rejection gives a uniform class: draw the degree d of u with weight (2q)^d times the number of n, draw u uniformly among
the monic polynomials of degree d, and keep u with probability (number of v)/2^d. Sums of rational points may reach only
a subgroup.

Rejection keeps about one u in 2^g. In large genus a class is instead a sum of random places of a prime degree k. Such a
place consists of a point P over GF(q^k) and its conjugates. P → Σ σ(P) extends to the norm from J(GF(q^k)), which is
onto (Lang 1956). So the mean of a character χ ≠ 1 of J over the places is at most
ε = ((2g − 2)Q^(1/2) + s)/(Q − 1 − 2gQ^(1/2) − s) in absolute value. Here Q = q^k, and s is the number of points over
GF(q), which are left out (Weil 1948). The sum of t places is within √#J·ε^t/2 of uniform in total variation (Diaconis
1988, chapter 3).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count, product
from math import ceil, isqrt, log, log2, prod
from typing import Any

from jacobian import poly
from jacobian.addition import cantor
from jacobian.curve.curve import HyperellipticCurve
from jacobian.curve.points import Point
from jacobian.element import Rng
from jacobian.errors import Infeasible, NotRepresentable
from jacobian.fields import GF
from jacobian.fields.change import embedding
from jacobian.fields.factor import factor, linear_part
from jacobian.fields.irreducible import first_irreducible
from jacobian.fields.primality import is_prime
from jacobian.fields.prime import prime_field
from jacobian.fields.quadratic import quadratic_roots
from jacobian.fields.randomness import random_below
from jacobian.fields.residue import ResidueField, polynomial_number
from jacobian.law.divisor import Divisor, GroupLaw
from jacobian.law.from_points import Descent, divisor_of_points
from jacobian.progress import Progress

Pair = tuple[poly.Poly, poly.Poly]

MOST_GENUS, LARGEST_GENUS = 12, 500
"""The largest genus for rejection, which keeps one of 2^g pairs (u, v), and the largest for sums of places. The latter
take 0.4 s in genus 50, 2 s in 200, 44 s in 1000."""
DISTANCE = 50
"""− log₂ of the distance from the uniform distribution that sums of places may have."""
MOST_CLASSES = 10**9
"""The largest number of classes that are listed. Listing so many takes some hours, and they do not fit into memory."""


def random_divisor(J: GroupLaw, rng: Rng) -> Divisor:
    """A uniform class over a finite field; over other fields the sum of g random points, not uniform in any sense."""
    if J.field.order is None:
        return J.from_points(_random_points(J.curve, rng))
    if J.curve.genus > MOST_GENUS:
        return _by_places(J, rng)
    while True:
        found = _try_random(J, rng)
        if found is not None:
            return found


def _by_places(J: GroupLaw, rng: Rng) -> Divisor:
    C, K, g = J.curve, J.field, J.curve.genus
    if g > LARGEST_GENUS:
        raise Infeasible(
            f"genus {g}: a uniform class takes a minute or more; up to genus {LARGEST_GENUS} they are drawn. Sums of "
            "C.random_point(rng) are quick, and not uniform"
        )
    q: Any = K.order
    for k in filter(is_prime, count(2)):
        root, own = isqrt(q**k), q + 3 + 2 * g * (isqrt(q) + 1)
        above, below = (2 * g - 2) * (root + 1) + own, q**k - 1 - 2 * g * (root + 1) - own
        if 8 * above < below:
            break
    # the bound √#J·ε^t/2 for t places (:mod:`jacobian.law.sampling`) has ε = above/below, and √#J ≤ (1 + √q)^g. Inert
    # models need an even number of places
    places = ceil((g * log2(1 + q**0.5) + DISTANCE) / log2(below / above) / 2) * 2
    degree = k * round(log(q, K.characteristic))
    L = GF(K.characteristic, degree, first_irreducible(prime_field(K.characteristic), degree))
    descent = Descent(C.change_ring(L), embedding(K, L))
    total, points = J.zero(), list[Point]()
    while places:
        orbit = descent.orbit(descent.curve.random_point(rng))
        if len(orbit) == k:
            points += orbit
            places -= 1
            if places % 2 == 0:
                total, points = total + divisor_of_points(J, points, descent), []
    return total


def _random_points(C: HyperellipticCurve, rng: Rng) -> list[Any]:
    count = C.genus - C.genus % 2 if C.model == "inert" else C.genus
    if C.field.exact:
        return [C.random_point(rng) for _ in range(count)]
    points: list[Any] = []
    while len(points) < count:
        point = C.random_point(rng)
        # in floats a point P may be drawn twice, or P and ιP: both have probability 0 among real or complex points
        if all(point.x != other.x for other in points):
            points.append(point)
    return points


def _degrees(C: HyperellipticCurve) -> list[tuple[int, int]]:
    """(degree of u, number of weights n for this degree) for the reduced divisors of C."""
    step = 2 if C.model == "inert" else 1
    return [(d, C.genus - d + 1 if C.model == "split" else 1) for d in range(0, C.genus + 1, step)]


def _try_random(J: GroupLaw, rng: Rng) -> Divisor | None:
    C = J.curve
    K: Any = J.field
    degrees = _degrees(C)
    ticket = random_below(rng, sum(weights * (2 * K.order) ** d for d, weights in degrees))
    for degree, weights in reversed(degrees):
        ticket -= weights * (2 * K.order) ** degree
        if ticket < 0:
            break
    threshold = random_below(rng, 1 << degree)
    u = poly.random(K, degree, rng, monic=True)
    # u has at most 2^r polynomials v, r the number of its irreducible factors. Factors that are not linear have degree
    # 2 or more, which bounds r: enough to reject most u without a complete factorization
    if degree > 1:
        linear = len(linear_part(K, u)) - 1
        if 1 << (linear + (degree - linear) // 2) <= threshold:
            return None
    choices = _local_choices(C, u)
    if prod(map(len, choices)) <= threshold:
        return None
    pair = _composed(C, [pairs[random_below(rng, len(pairs))] for pairs in choices])
    return Divisor(J, *pair, random_below(rng, weights) if C.model == "split" else None)


def all_divisors(J: GroupLaw) -> Iterator[Divisor]:
    """Yields every class once, over a finite field (NotRepresentable elsewhere). This takes about q^g factorisations;
    Infeasible if q^g > 10^9. The logger ``jacobian.progress`` reports the remaining time.
    """
    C, K = J.curve, J.field
    if K.order is None:
        raise NotRepresentable(f"field = {K.name} is infinite: the classes cannot be listed")
    if K.order > MOST_CLASSES or K.order**C.genus > MOST_CLASSES:
        raise Infeasible(
            f"field = {K.name}: some 2^{(K.order.bit_length() - 1) * C.genus} classes; up to {MOST_CLASSES} are "
            "listed. random(rng) draws some"
        )
    return _listed(J)


def _listed(J: GroupLaw) -> Iterator[Divisor]:
    C = J.curve
    K: Any = J.field
    progress = Progress(f"the classes of {C!r}", sum(K.order**degree for degree, _ in _degrees(C)))
    for degree, weights in _degrees(C):
        for number in range(K.order**degree):
            progress.add(1)
            u = polynomial_number(K, number)
            u = (*u, *[K.zero] * (degree - len(u)), K.one)
            for pairs in product(*_local_choices(C, u)):
                u, v = _composed(C, pairs)
                for n in range(weights):
                    yield Divisor(J, u, v, n if C.model == "split" else None)


def _local_choices(C: HyperellipticCurve, u: poly.Poly) -> list[list[Pair]]:
    """For each factor P^e of u, P irreducible, all Mumford pairs (P^e, v) on the curve."""
    K: Any = C.field
    choices = []
    for P, multiplicity in factor(K, u):
        L = ResidueField(K, P)
        values = quadratic_roots(L, poly.mod(K, C.h, P), poly.mod(K, C.f, P))
        if len(values) == 1 and multiplicity > 1:
            values = []
        choices.append([_composed(C, [(P, v)] * multiplicity) for v in values])
    return choices


def _composed(C: HyperellipticCurve, pairs: Sequence[Pair]) -> Pair:
    """The sum of the divisors of Mumford pairs, not reduced."""
    (u, v), *others = pairs or [((C.field.one,), ())]
    total: cantor.Triple = u, v, None
    for u, v in others:
        total = cantor.compose(C, total, (u, v, None))
    return total[0], total[1]
