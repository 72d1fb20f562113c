"""Group orders over large primes: the Cartier–Manin matrix in Õ(√p), then baby steps.

The first rows compare the method that :mod:`jacobian.finite.hasse_witt` chooses for the matrix with the other one. The
other rows have orders of random curves, each checked by 100 random classes of the curve and as many of its twist;
"processor, s" is the time of all threads, "memory, MB" the peak of this process so far.
"""

from __future__ import annotations

import resource
from random import Random
from time import perf_counter, process_time

import numpy as np

from benchmarks.curves import genuine_curve, least_seconds
from jacobian import GF
from jacobian.fields.primality import is_prime
from jacobian.finite import hasse_witt

CHOICES = (10**5, 5 * 10**5, 2 * 10**6, 10**7)
ORDERS = ((10**9, 2), (10**9, 3), (10**12, 2), (10**12, 3), (10**14, 2))
WORSE = 2.0
COMPILED = 1.0
"""The seconds to compile the method of products, spent once. The recurrence needs no compilation."""


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows for the choice and for the orders. AssertionError if an order does not annihilate a class, or if the chosen
    method is much slower than the other.
    """
    rows = [_choice(start) for start in (CHOICES[:1] if smoke else CHOICES)]
    return rows + [_order(start, g) for start, g in (ORDERS[:1] if smoke else ORDERS)]


def _prime_from(p: int) -> int:
    return next(q for q in range(p, 2 * p) if is_prime(q))


def _choice(start: int) -> dict[str, object]:
    C = genuine_curve(GF(_prime_from(start)), 2, "ramified", Random(start))
    p, chosen, seconds = C.field.order, hasse_witt.PRODUCTS_FROM, []
    try:
        for limit in (p, p - 1):
            hasse_witt.PRODUCTS_FROM = limit
            seconds.append(least_seconds(lambda: hasse_witt.cartier_manin(C), 3))
    finally:
        hasse_witt.PRODUCTS_FROM = chosen
    recurrence, products = seconds
    taken, other = (products, recurrence) if p > chosen else (recurrence, products)
    # within a dozen calls the time saved must exceed the time of compiling
    if taken > WORSE * other + COMPILED / 12:
        raise AssertionError(f"p = {p}: {taken:.3f} s by the chosen method, the other takes {other:.3f} s")
    return {"p": p, "genus": 2, "recurrence, s": recurrence, "products, s": products}


def _order(start: int, g: int) -> dict[str, object]:
    C = genuine_curve(GF(_prime_from(start)), g, "ramified", Random(start))
    begun, busy = perf_counter(), process_time()
    chi = C.jacobian().frobenius_polynomial()
    wall, processor = perf_counter() - begun, process_time() - busy
    opposite = [c * (-1) ** i for i, c in enumerate(chi)]
    for E, order in ((C, sum(chi)), (C.quadratic_twist(), sum(opposite))):
        if any(order * D for D in E.jacobian().random(np.random.default_rng(1), size=100)):
            raise AssertionError(f"{E!r}: {order} does not annihilate a class")
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {"p": C.field.order, "genus": g, "wall, s": wall, "processor, s": processor, "memory, MB": memory}
