"""Invariants modulo p of a curve over a finite field: its p-rank, the slopes of Frobenius."""

from __future__ import annotations

from typing import Any

from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import FieldError, Infeasible
from jacobian.fields.factor import factor
from jacobian.finite.frobenius import frobenius_polynomial
from jacobian.finite.hasse_witt import frobenius_modulo_p


def p_rank(C: HyperellipticCurve) -> int:
    """The number of roots of χ that are p-adic units, χ being the characteristic polynomial of Frobenius."""
    K: Any = C.field
    if K.order is None:
        raise FieldError(f"field = {K.name}: the p-rank is that of a curve over a finite field")
    if K.characteristic == 2:
        return _two_rank(C)
    try:
        a: Any = frobenius_modulo_p(C)
    except Infeasible:
        # χ may be known all the same, for example by complex multiplication
        a = [c % K.characteristic for c in frobenius_polynomial(C)[::-1][1 : C.genus + 1]]
    return max((i for i, c in enumerate(a, 1) if c), default=0)


def _two_rank(C: HyperellipticCurve) -> int:
    """The 2-rank in characteristic 2: one less than the number of branch points, which are the distinct zeros of h as
    a form of degree g + 1 (Deuring–Shafarevich; Subrao 1975).
    """
    return sum(len(P) - 1 for P, _ in factor(C.field, C.h)) + (len(C.h) < C.genus + 2) - 1


def is_supersingular(C: HyperellipticCurve) -> bool:
    """Whether the Newton polygon of the characteristic polynomial of Frobenius over GF(p^k) is the line of slope k/2:
    p^⌈ik/2⌉ divides the coefficient of T^(2g−i) for all i.

    In characteristic 2 and genus 1 or 2 the p-rank decides: no other polygon has the p-rank 0.
    """
    K: Any = C.field
    p, g = K.characteristic, C.genus
    rank = _two_rank(C) if p == 2 else 0
    if p == 2 and (rank > 0 or g <= 2):
        return rank == 0
    return all(c % p ** ((i * K.degree + 1) // 2) == 0 for i, c in enumerate(frobenius_polynomial(C)[::-1][: g + 1]))
