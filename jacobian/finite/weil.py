"""Forms of the characteristic polynomial of Frobenius.

χ(T) = T^2g + a_1 T^(2g−1) + … + q^g = T^g·R(T + q/T), R(z) = z^g + r_1 z^(g−1) + … + r_g; the roots of R are real and
at most 2√q in size (Weil 1948). #J = χ(1) = R(1 + q), and χ(−1) is #J of the quadratic twist.
"""

from __future__ import annotations

from math import comb, isqrt

from jacobian.curve.zeta import power_sums


def extend(chi: list[int], q: int, degree: int) -> list[int]:
    """The characteristic polynomial of Frobenius over GF(q^degree) from that over GF(q), both ascending.

    The roots are raised to the power ``degree``, by Newton's identities for the sums of their powers.
    """
    g = len(chi) // 2
    sums = power_sums(chi[::-1], g * degree)
    a = leading([-sums[degree * j] for j in range(1, g + 1)])
    return from_leading(a, q**degree)


def from_leading(a: list[int], q: int) -> list[int]:
    """All coefficients of χ, ascending, from 1, a_1 … a_g, by the symmetry χ(T) = T^2g χ(q/T)/q^g."""
    g = len(a) - 1
    return [q ** (g - i) * a[i] for i in range(g)] + a[::-1]


def real_part(a: list[int], q: int, g: int) -> list[int]:
    """The coefficients 1, r_1 … r_k of R from those of χ, 1, a_1 … a_k: a_i = Σ C(g−i+2j, j) q^j r_(i−2j)."""
    r: list[int] = []
    for i, c in enumerate(a):
        r.append(c - sum(comb(g - i + 2 * j, j) * q**j * r[i - 2 * j] for j in range(1, i // 2 + 1)))
    return r


def from_real_part(r: list[int], q: int) -> list[int]:
    """The coefficients of χ, ascending, from ``r`` = 1, r_1 … r_g, those of R, descending (top of this file)."""
    g = len(r) - 1
    a = [sum(comb(g - i + 2 * j, j) * q**j * r[i - 2 * j] for j in range(i // 2 + 1)) for i in range(g + 1)]
    return from_leading(a, q)


def leading(excess: list[int]) -> list[int]:
    """The coefficients 1, a_1 … a_k of χ from S_i = #C(GF(q^i)) − q^i − 1, i = 1 … k.

    −S_i is the sum of the i-th powers of the roots of χ, so i·a_i = Σ S_j a_(i−j) (Newton's identities).
    """
    a = [1]
    for i in range(1, len(excess) + 1):
        a.append(sum(excess[j - 1] * a[i - j] for j in range(1, i + 1)) // i)
    return a


def order_bounds(q: int, g: int) -> tuple[int, int]:
    """The bounds of #J: the least and the largest int from (√q − 1)^2g = a − b√q to (√q + 1)^2g = a + b√q."""
    a, b = (sum(comb(2 * g, 2 * k + odd) * q**k for k in range(g + 1 - odd)) for odd in (0, 1))
    size = isqrt(b * b * q)
    return a - size, a + size
