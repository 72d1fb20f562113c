"""The textbook composition of two divisors of genus 2."""

from __future__ import annotations

from typing import Any


def classical(f: Any, first: Any, second: Any) -> tuple[Any, Any, Any, Any]:
    """(u0, u1, v0, v1) of the sum of (U, V) and (U', V') on y² = f, deg f = 5. Cramer's rule gives L ≡ (V' − V)/U
    modulo U'. With P = V + UL, U'' comes from the leading coefficients of P² − f, and V'' = −P modulo U''.
    ZeroDivisionError if U and U' have a common zero.
    """
    u0, u1, v0, v1 = first
    s0, s1, t0, t1 = second
    a0, a1 = u0 - s0, u1 - s1
    b0, b1 = -s0 * a1, a0 - s1 * a1
    r0, r1 = t0 - v0, t1 - v1
    determinant = a0 * b1 - a1 * b0
    l0, l1 = (r0 * b1 - r1 * b0) / determinant, (a0 * r1 - a1 * r0) / determinant
    p0, p1, p2 = v0 + u0 * l0, v1 + u1 * l0 + u0 * l1, l0 + u1 * l1
    sum1, sum0 = u1 + s1, u0 + s0 + u1 * s1
    c1 = (2 * l1 * p2 - f[5]) / (l1 * l1) - sum1
    c0 = (p2 * p2 + 2 * l1 * p1 - f[4]) / (l1 * l1) - c1 * sum1 - sum0
    high = p2 - c1 * l1
    return c0, c1, c0 * high - p0, c0 * l1 + c1 * high - p1
