"""Uniform random divisor classes, and all of them, over finite fields.

A class is one reduced (u, v, n). For a given u = Π P^e the v are counted place by place: two choices of v modulo P^e
where y² + hy − f has two roots modulo P, one where it has a double root and e = 1, none otherwise. So a uniform class
is had by rejection: draw the degree d of u with weight (2q)^d times the number of n, u uniformly among the monic
polynomials of that degree, and keep it with probability (number of v)/2^d. Sums of rational points would reach a
subgroup only.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

from jacobian import poly
from jacobian.addition import cantor
from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import NotRepresentable
from jacobian.fields.factor import factor, linear_part
from jacobian.fields.quadratic import quadratic_roots
from jacobian.fields.randomness import random_below
from jacobian.fields.residue import ResidueField, polynomial_number
from jacobian.law.divisor import Divisor, GroupLaw


def random_divisor(J: GroupLaw, rng: Any) -> Divisor:
    """A uniform class over a finite field; over other fields Σ of g random points (not uniform in any sense)."""
    if J.field.order is None:
        return J.from_points(_random_points(J.curve, rng))
    while True:
        found = _try_random(J, rng)
        if found is not None:
            return found


def _random_points(C: HyperellipticCurve, rng: Any) -> list[Any]:
    count = C.genus - C.genus % 2 if C.model == "inert" else C.genus
    if C.field.exact:
        return [C.random_point(rng) for _ in range(count)]
    points: list[Any] = []
    while len(points) < count:
        point = C.random_point(rng)
        # two points with one x would be P + P or P + ιP
        if all(point.x != other.x for other in points):
            points.append(point)
    return points


def _degrees(C: HyperellipticCurve) -> list[tuple[int, int]]:
    """(degree of u, number of weights n beside it) for the reduced divisors of C."""
    step = 2 if C.model == "inert" else 1
    return [(d, C.genus - d + 1 if C.model == "split" else 1) for d in range(0, C.genus + 1, step)]


def _try_random(J: GroupLaw, rng: Any) -> Divisor | None:
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
    # (number of v) ≤ 2^(number of places) must exceed the threshold: most u fail this before they are factored
    if degree > 1:
        linear = len(linear_part(K, u)) - 1
        if 1 << (linear + (degree - linear) // 2) <= threshold:
            return None
    choices = _local_choices(C, u)
    count = 1
    for _, pairs in choices:
        count *= len(pairs)
    if count <= threshold:
        return None
    pair = _combine(C, [pairs[random_below(rng, len(pairs))] for _, pairs in choices])
    return Divisor(J, *pair, random_below(rng, weights) if C.model == "split" else None)


def all_divisors(J: GroupLaw) -> Iterator[Divisor]:
    """Every class once, over a finite field (NotRepresentable elsewhere); about q^g factorisations."""
    C, K = J.curve, J.field
    if K.order is None:
        raise NotRepresentable(f"field = {K.name} is infinite: the classes cannot be listed")
    for degree, weights in _degrees(C):
        for number in range(K.order**degree):
            u = polynomial_number(K, number)
            u = (*u, *[K.zero] * (degree - len(u)), K.one)
            for pairs in product(*[pairs for _, pairs in _local_choices(C, u)]):
                u, v = _combine(C, list(pairs))
                for n in range(weights):
                    yield Divisor(J, u, v, n if C.model == "split" else None)


def _local_choices(C: HyperellipticCurve, u: poly.Poly) -> list[tuple[poly.Poly, list[tuple[poly.Poly, poly.Poly]]]]:
    """For each factor P^e of u: (P^e, the pairs (P^e, v) on the curve)."""
    K = C.field
    choices = []
    for P, multiplicity in factor(K, u):
        L = ResidueField(K, P)
        values = quadratic_roots(L, poly.mod(K, C.h, P), poly.mod(K, C.f, P))
        if len(values) == 1 and multiplicity > 1:
            values = []
        pairs = [_lift(C, P, v, multiplicity) for v in values]
        choices.append((P, pairs))
    return choices


def _lift(C: HyperellipticCurve, P: poly.Poly, v: poly.Poly, multiplicity: int) -> tuple[poly.Poly, poly.Poly]:
    """The pair (P^e, v) from v modulo P: e-fold composition, nothing reduced."""
    local = pair = (P, v, None)
    for _ in range(multiplicity - 1):
        pair = cantor.compose(C, pair, local)  # type: ignore[assignment]
    return pair[0], pair[1]


def _combine(C: HyperellipticCurve, pairs: list[tuple[poly.Poly, poly.Poly]]) -> tuple[poly.Poly, poly.Poly]:
    total: cantor.Triple = ((C.field.one,), (), None)
    for u, v in pairs:
        total = cantor.compose(C, total, (u, v, None))
    return total[0], total[1]
