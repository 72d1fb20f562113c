"""Orders of divisor classes, from a multiple of the order and its prime factors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from itertools import count, islice
from math import inf
from typing import Any

from jacobian.errors import ArgumentError, FieldError, JacobianError, shown
from jacobian.fields import GF
from jacobian.fields.primality import is_prime
from jacobian.finite.integers import factorization, value
from jacobian.law.divisor import Divisor, check_scalar


def order_of(D: Divisor, multiple: int | None = None, primes: Iterable[int] | None = None) -> int | float:
    """The order of D: the least m > 0 with m·D = 0; over QQ ``math.inf`` when there is none.

    ``multiple``: a multiple of the order, by default #J over a finite field; ``primes``: its prime factors, by default
    found (:mod:`jacobian.finite.integers`). Over QQ without a multiple the order comes from reductions. Reduction at an
    odd prime of good reduction is injective on torsion. So two different orders prove that D is of infinite order, and
    an order common to three reductions is tested. Raises ArgumentError for a multiple that does not annihilate D,
    FieldError over RR, CC and MP.
    """
    J = D.jacobian
    if not J.field.exact:
        raise FieldError(f"field = {J.field.name}: the order of a class is decided over exact fields only")
    if multiple is None:
        if J.field.order is None:
            return _rational_order(D)
        multiple = J.order()
    multiple = abs(check_scalar(multiple, "multiple"))
    if multiple == 0 or multiple * D:
        raise ArgumentError(f"multiple = {shown(multiple)}: a non-zero multiple of the order of D = {D} is needed")
    return reduce_order(D, factorization(multiple, primes))


def reduce_order(D: Divisor, factors: dict[int, int]) -> int:
    """The order of D from a factored multiple of the order."""
    multiple = value(factors)
    order = 1
    for prime, exponent in factors.items():
        rest = multiple // prime**exponent * D
        while rest:
            rest = prime * rest
            order *= prime
    return order


def _rational_order(D: Divisor) -> int | float:
    """The order of D over QQ: the common order of three good reductions if it annihilates D, else infinity."""
    orders = set(map(order_of, islice(reductions_of(D), 3)))
    if len(orders) > 1:
        return inf
    (order,) = orders
    return order if not int(order) * D else inf


def reductions_of(D: Any) -> Iterator[Any]:
    """Yields D, a class or a Jacobian over QQ, modulo the odd primes p of good reduction, ascending. Primes at which a
    point of the class goes to infinity are left out.
    """
    for p in filter(is_prime, count(3, 2)):
        with suppress(JacobianError):
            yield D.change_ring(GF(p))
