"""From one field to another: reduction modulo p, finite fields inside larger ones, rounding."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jacobian.errors import FieldError
from jacobian.fields.embedding import embedding


def change_of_field(K: Any, L: Any) -> Callable[[Any], Any]:
    """The map from elements of K to elements of L; FieldError where there is none, or for an element that it misses.

    QQ goes to every field: modulo p, where p does not divide the denominator, and rounded. A finite field goes into
    those that contain it, by :func:`jacobian.fields.embedding.embedding`, and back as far as elements lie in the
    smaller one. Inexact fields go to inexact ones.
    """
    if K == L:
        return lambda x: x
    both_finite = K.order is not None and L.order is not None and K.characteristic == L.characteristic
    if both_finite and L.degree % K.degree == 0:
        return embedding(K, L)
    if both_finite and K.degree % L.degree == 0:
        return embedding(L, K).back
    if K.order is not None or (L.exact and not K.exact):
        raise FieldError(f"K = {L.name}: there is no map from {K.name} to it that respects + and ·")
    # elements of GF(p^k) are written as ints: rational numbers lie in GF(p)
    target = getattr(L, "base", L) if L.order is not None else L
    return lambda x: target.coerce(x, "coefficient")
