"""The characteristic polynomial of Frobenius by the fastest applicable method."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import FieldError
from jacobian.fields.extension import ExtensionField
from jacobian.finite import complex_multiplication, counting, weil
from jacobian.finite.search import counting_is_quick, search


@lru_cache(maxsize=256)
def _cached_polynomial(C: HyperellipticCurve) -> tuple[int, ...]:
    K: Any = C.field
    descended = _over_prime_field(C)
    if descended is not None:
        return tuple(weil.extend(list(_cached_polynomial(descended)), K.characteristic, K.degree))
    if K.order**C.genus <= counting_is_quick(C):
        return tuple(counting.frobenius_polynomial(C))
    return tuple(complex_multiplication.frobenius_polynomial(C) or search(C))


def frobenius_polynomial(C: HyperellipticCurve) -> list[int]:
    """The characteristic polynomial of Frobenius on the Jacobian, ascending, of degree 2g.

    Computed over GF(p) when all coefficients lie there; by counting points where that is fast
    (:mod:`jacobian.finite.counting`); for y² = bx⁵ + a, and bx⁷ + a where p ≢ 2, 4 modulo 7, over GF(p) of any size by
    complex multiplication (:mod:`jacobian.finite.complex_multiplication`); else by
    :func:`jacobian.finite.search.search`, whose limits raise Infeasible.
    """
    if C.field.order is None:
        raise FieldError(f"field = {C.field.name}: points are counted over finite fields")
    return list(_cached_polynomial(C))


def _over_prime_field(C: HyperellipticCurve) -> HyperellipticCurve | None:
    K = C.field
    if not isinstance(K, ExtensionField) or any(c >= K.characteristic for c in (*C.f, *C.h)):
        return None
    return HyperellipticCurve(K.base, C.f, C.h)
