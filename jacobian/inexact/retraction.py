"""Projection onto the curve: (U, V) near a divisor of y² = f(x), moved as little as possible so that U divides f − V².

Rounding moves the sums of :mod:`jacobian.inexact.genus2_real` off the curve, and this error need not stay small. Over
many additions of one divisor it grows, for some divisors exponentially (``python -m benchmarks stability``). An
occasional Newton step prevents that. Numbers are bare reals, as in :mod:`jacobian.inexact.genus2_real`.
"""

from __future__ import annotations

from typing import Any

from jacobian.inexact.genus2_real import Four, Six

__all__ = ["remainder", "retracted"]


def remainder(f: Six, point: Four) -> tuple[Any, Any, Any, Any, Any, Any]:
    """(r0, r1, w0, w1, w2, w3) with f − V² = W·U + r1·x + r0, for the point (u0, u1, v0, v1) and monic U."""
    u0, u1, v0, v1 = point
    w3 = f[5]
    w2 = f[4] - u1 * w3
    w1 = f[3] - u1 * w2 - u0 * w3
    w0 = f[2] - v1 * v1 - u1 * w1 - u0 * w2
    return f[0] - v0 * v0 - u0 * w0, f[1] - 2 * v0 * v1 - u1 * w0 - u0 * w1, w0, w1, w2, w3


def retracted(f: Six, point: Four) -> Four:
    """The point after one Newton step of least length towards f ≡ V² mod U, which squares a small residual.

    The step is regular wherever the curve is smooth: the differential 2V·δV + W·δU mod U is singular only where U, V
    and W have a common root.
    """
    u0, u1, v0, v1 = point
    r0, r1, w0, w1, w2, w3 = remainder(f, point)
    # the differential 2V·δV + W·δU mod U for δV = 1, x and δU = 1, x: 2V, 2xV, W, xW
    a0, a1 = 2 * v0, 2 * v1
    b0, b1 = -u0 * a1, a0 - u1 * a1
    w2 -= u1 * w3
    c0, c1 = w0 - u0 * w2, w1 - u0 * w3 - u1 * w2
    d0, d1 = -u0 * c1, c0 - u1 * c1
    m00 = a0 * a0 + b0 * b0 + c0 * c0 + d0 * d0
    m01 = a0 * a1 + b0 * b1 + c0 * c1 + d0 * d1
    m11 = a1 * a1 + b1 * b1 + c1 * c1 + d1 * d1
    scale = 1 / (m00 * m11 - m01 * m01)
    s0, s1 = (m11 * r0 - m01 * r1) * scale, (m00 * r1 - m01 * r0) * scale
    return u0 + c0 * s0 + c1 * s1, u1 + d0 * s0 + d1 * s1, v0 + a0 * s0 + a1 * s1, v1 + b0 * s0 + b1 * s1
