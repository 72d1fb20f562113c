"""L-polynomials from their coefficients modulo p, for many primes.

For p > 16g² the residue of a_1 determines a_1, since |a_1| ≤ 2g√p. In genus 1 nothing else is needed. In genus 2 and 3
the group law determines the other a_i (:mod:`jacobian.arithmetic.decision_kernels`). Points are counted
(:mod:`jacobian.finite.frobenius`) for small p, and for those p at which several candidates remain, as happens if the
exponent of J(GF(p)) is small.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import isqrt
from typing import Any

import numpy as np

from jacobian.arithmetic.residues import modulo
from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import shown
from jacobian.fields import GF
from jacobian.finite.frobenius import frobenius_polynomial
from jacobian.numbers.threads import in_ranges


def least_prime(g: int) -> int:
    """16g²: for larger p the residue of a_1 modulo p determines a_1."""
    return 16 * g * g


def decided(F: Sequence[int], g: int, primes: Any, residues: Any) -> tuple[Any, Any]:
    """The a_1, …, a_g at N primes p > 16g² of good reduction of y² = F(x), (N, g), and whether they are known, (N,).

    ``residues``: the residues of the a_i modulo p.
    """
    balanced = residues.copy()
    balanced[:, 0] -= primes * (2 * residues[:, 0] > primes)
    if g == 1 or not len(primes):
        return balanced, np.ones(len(primes), bool)
    out = np.zeros((len(primes), g + 2), np.int64)
    out[:, 0] = primes
    padded = [*F, *[0] * (2 * g + 3 - len(F))]
    equations = np.stack([np.broadcast_to(modulo(c, primes), primes.shape) for c in padded], axis=1)

    def work(begin: int, end: int) -> None:
        library().decide(equations, balanced, _desk(g, int(primes[-1])), out, begin, end)

    in_ranges(len(primes), 256, work)
    if (wrong := primes[out[:, g + 1] == 0]).size:
        raise AssertionError(
            f"p = {shown(int(wrong[0]))}: no order within Weil's bounds annihilates a class of y² = F, F = {shown(F)}"
        )
    return out[:, 1 : g + 1], out[:, g + 1] == 1


def _desk(g: int, p: int) -> Any:
    from jacobian.addition.cantor_words import ROWS, width
    from jacobian.arithmetic.decision_kernels import MOST
    from jacobian.arithmetic.desk import HEAD, Desk

    n = 2 * g + 3
    # the number of baby steps is about the square root of the number of candidates (s, t). In genus 3 there are at most
    # 20 values of s, and at most 40√p values of t for each s
    steps = isqrt(1000 * isqrt(p)) if g == 3 else 4
    sizes = (HEAD + n + 2 * (g + 2), (ROWS, 4 * g + 8), (8, width(g)), n, n, (steps, width(g)), 4 * steps + 4, (24, 2))
    return Desk(*(np.zeros(size, np.int64) for size in (*sizes, (MOST, 2))))


@cache
def library() -> Any:
    """The loops of :mod:`jacobian.arithmetic.decision_kernels`, compiled."""
    from jacobian.arithmetic.decision_kernels import decide
    from jacobian.arithmetic.desk import Desk
    from jacobian.native.kinds import INT, INTS, ArrayKind, record
    from jacobian.native.library import Library

    rows = ArrayKind(INT, 2)
    desk = record(Desk, INTS, rows, rows, INTS, INTS, rows, INTS, rows, rows)
    return Library("decisions", {"decide": (decide, (rows, rows, desk, rows, INT, INT))})


def counted(C: HyperellipticCurve, p: int) -> list[int]:
    """a_1, …, a_g at one prime of good reduction, by counting points."""
    chi = frobenius_polynomial(C.change_ring(GF(p)))
    return chi[::-1][1 : C.genus + 1]
