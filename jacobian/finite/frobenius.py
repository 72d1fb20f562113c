"""The characteristic polynomial of Frobenius by the fastest applicable method."""

from __future__ import annotations

import signal
from functools import cache, lru_cache
from threading import current_thread, main_thread
from typing import Any

from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import FieldError
from jacobian.fields.extension import ExtensionField
from jacobian.finite import complex_multiplication, counting, weil
from jacobian.finite.search import counting_is_quick, search

PARI_FROM, PARI_TO = 1 << 24, 10**22
"""The range of p for which PARI counts points in genus 1. At its lower end importing PARI takes as long as a search,
50 ms; its upper end is the limit of the search."""


@lru_cache(maxsize=256)
def _cached_polynomial(C: HyperellipticCurve) -> tuple[int, ...]:
    K: Any = C.field
    p = K.characteristic
    if isinstance(K, ExtensionField) and all(c < p for c in (*C.f, *C.h)):
        below = HyperellipticCurve(K.base, C.f, C.h)
        return tuple(weil.extend(list(_cached_polynomial(below)), p, K.degree))
    if K.order**C.genus <= counting_is_quick(C):
        return tuple(counting.frobenius_polynomial(C))
    return tuple(complex_multiplication.frobenius_polynomial(C) or by_pari(C) or search(C))


def frobenius_polynomial(C: HyperellipticCurve) -> list[int]:
    """The characteristic polynomial of Frobenius on the Jacobian, ascending, of degree 2g.

    A curve whose coefficients all lie in GF(p) is treated over GF(p). The first of these methods that applies is used:

    * counting points, where that is fast (:mod:`jacobian.finite.counting`);
    * complex multiplication over GF(p), for y² = bx⁵ + a, and for y² = bx⁷ + a where p ≢ 2, 4 modulo 7
      (:mod:`jacobian.finite.complex_multiplication`);
    * PARI in genus 1 over large prime fields, if the extra ``pari`` is installed;
    * :func:`jacobian.finite.search.search`, which raises Infeasible beyond its limits.
    """
    if C.field.order is None:
        raise FieldError(f"field = {C.field.name}: points are counted over finite fields")
    return list(_cached_polynomial(C))


def by_pari(C: HyperellipticCurve) -> list[int] | None:
    """The characteristic polynomial by PARI's ``ellap``, proven, in genus 1 over GF(p), p from PARI_FROM to PARI_TO.

    None for other curves, without cypari, and off the main thread, the only one in which cypari runs.

    y² = F(x), deg F ≤ 4, has as many points as its Jacobian Y² = X³ − 27I·X − 27J with the invariants I and J of F
    (An, Kim, Marshall, Marshall, McCallum and Perlis 2001).
    """
    K: Any = C.field
    if C.genus > 1 or K.order != K.characteristic or not PARI_FROM <= K.order <= PARI_TO:
        return None
    if current_thread() is not main_thread() or (pari := _pari()) is None:
        return None
    e, d, c, b, a = [*map(int, C.discriminant), 0][:5]
    I = 12 * a * e - 3 * b * d + c * c  # noqa: E741
    J = 72 * a * c * e + 9 * b * c * d - 27 * (a * d * d + e * b * b) - 2 * c**3
    return [K.order, -int(pari.ellap(pari.ellinit([-27 * I, -27 * J], K.order))), 1]


@cache
def _pari() -> Any:
    """cypari's PARI, or None without cypari. Python's handler of Ctrl-C, which the import replaces, is restored."""
    handler = signal.getsignal(signal.SIGINT)
    try:
        from cypari import pari
    except ImportError:
        return None
    signal.signal(signal.SIGINT, handler)
    pari.allocatemem(max(1 << 26, pari.stacksize()), silent=True)
    return pari
