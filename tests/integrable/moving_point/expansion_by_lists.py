"""The expansion of a translation in eps² by sums of products of lists: a readable oracle."""

from __future__ import annotations

from operator import mul
from typing import Any

Row = Any


def expansion(f: Row, count: int) -> tuple[list[Any], list[Any], list[Any], list[Any]]:
    """u0, u1, v0/eps and v1·eps of T(eps) as power series in z = eps², ``count`` coefficients each.

    They follow from u0' = v1u0 − u1v0, u1' = −v0, 2v0' = u1w0 − s0u0, 2v1' = w0 + u1w1 − s0u1 − w2u0, where
    W = (f − V²)/U and s0 = w1 − f5u0 (:meth:`integrable.motion.enclosure.BallMotion.velocity`). These equations leave
    two coefficients undetermined (resonance), so u0 = −f0z/4 + … and u1 = −f1z/12 + … are prescribed.
    """
    f0, f1, f2, f3, f4, f5 = f
    zero, one = 0 * f0, f0 / f0
    u0, u1, v0, v1 = [zero, -f0 / 4], [zero, -f1 / 12], [f1 / 6], [2 * one]
    # the series of s0, of w0 + v1²/z + u1w1, and of (v1·eps)²
    s0, rest, squares = [], [], [4 * one]
    for k in range(1, count):
        if k > 1:
            u1.append(-v0[k - 1] / (2 * k))
            u0.append((_product(v1, u0, k, k - 1) - _product(u1, v0, k - 1, k - 1)) / (2 * k - 2))
        s0.append(f5 * (_product(u1, u1, k - 1, k - 2) - 2 * u0[k - 1]) - f4 * u1[k - 1])
        rest.append(-_product(u1, s0, k - 1, k - 1) - f4 * u0[k - 1])
        if k == 1:
            s0[0], rest[0] = s0[0] + f3, rest[0] + f2
        own = _product(v1, v1, k, k - 1)
        mixed = 2 * f5 * _product(u0, u1, k - 1, k - 2)
        v1.append((rest[k - 1] - f4 * u0[k - 1] + mixed - own) / (4 * k + 2))
        squares.append(4 * v1[k] + own)
        total = _product(u1, rest, k, k) - _product(u1, squares, k + 1, k) - _product(u0, s0, k, k)
        v0.append(total / (2 * (2 * k + 1 - one / (k + 1))))
    return u0, u1, v0, v1


def _product(a: list[Any], b: list[Any], order: int, last: int) -> Any:
    """Σ a_i·b_(order − i) for i from 1 to ``last``."""
    if last < 1:
        return 0 * a[0]
    stop = order - last - 1
    return sum(map(mul, a[1 : last + 1], b[order - 1 : stop if stop >= 0 else None : -1]), 0 * a[0])
