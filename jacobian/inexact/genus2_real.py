"""One addition in genus 2 on bare reals, in Python that is compiled unchanged.

These are the formulas of :mod:`jacobian.inexact.composition` for two divisors of weight two on y² = f(x), deg f ≤ 5,
unrolled; a quartic f gives the generalized Jacobian with modulus ∞₊ + ∞₋. The summands are D = (U, V) and D' = (U',
V'), their sum is D'' = (U'', V''), W is (f − V²)/U, and q·y − p with p = q·V + L·U vanishes on both summands.
Coordinates must be in units in which the coefficients of f and of the summands are of moderate size. The result must be
of weight two: the real motions that use these functions stay in a compact set of such classes. Numbers are
``float`` or ``mpf``; :mod:`jacobian.native` compiles these functions, for floats and for double-double numbers.
"""

from __future__ import annotations

from typing import Any

from jacobian.numbers.roots import negligible, root

Real = Any  # float, or the mpf of one context
Four = tuple[Real, Real, Real, Real]
Six = tuple[Real, Real, Real, Real, Real, Real]


def add(f: Six, first: Four, second: Four) -> tuple[Four, tuple[Real, Real, Real, Real, Real, Real, Real, Real]]:
    """D + D' for D = (u0, u1, v0, v1), meaning U = x² + u1·x + u0 and V = v1·x + v0.

    Returns D'' and the coefficients (q, l1, l0, k0, m0, n1, n0, j0) of the transfer polynomials of
    :mod:`jacobian.relatives.signed`: L = l1·x + l0, L' = l1·x + k0, L'' = l1·x + m0, N = n1·x + n0, N' = n1·x + j0.
    """
    f4, f5 = f[4], f[5]
    u0, u1, v0, v1 = first
    s0, s1, t1 = second[0], second[1], second[3]
    q, l1, l0 = chord(f, first, second)
    # p is q·V + L·U, and U'' follows from the leading coefficients of p² − q²f
    p0, p1, p2 = q * v0 + u0 * l0, q * v1 + u1 * l0 + u0 * l1, l0 + u1 * l1
    lead = 1 / (l1 * l1)
    q2 = q * q
    sum1, sum0 = u1 + s1, u0 + s0 + u1 * s1
    b1 = (2 * l1 * p2 - q2 * f5) * lead - sum1
    b0 = (p2 * p2 + 2 * l1 * p1 - q2 * f4) * lead - b1 * sum1 - sum0
    c0, c1 = second_polynomial(f, b0, b1, (p0, p1, p2, l1), q, l0, first, second)
    n1 = q * f5
    n0 = l1 * (c1 - v1) + q * (f4 - u1 * f5) - b1 * n1
    j0 = l1 * (c1 - t1) + q * (f4 - s1 * f5) - b1 * n1
    return (b0, b1, c0, c1), (q, l1, l0, p2 - s1 * l1, p2 - b1 * l1, n1, n0, j0)


def chord(f: Six, first: Four, second: Four) -> tuple[Real, Real, Real]:
    """(q, l1, l0) with L·U ≡ q(V' − V) and L·(V + V') ≡ q·W modulo U', L = l1·x + l0.

    The largest of q, l1 and l0 has size 1, and W = (f − V²)/U. Each congruence L·A ≡ q·R is solved by itself, L = q·R/A
    mod U', with the resultant of A and U' as the denominator. The two solutions are averaged with the squared
    resultants as weights. Where both resultants are small (opposite points) the system of both congruences is solved by
    reflections.
    """
    f2, f3, f4, f5 = f[2], f[3], f[4], f[5]
    u0, u1, v0, v1 = first
    s0, s1, t0, t1 = second
    # W = (f − V²)/U and its remainder modulo U'
    w2 = f4 - u1 * f5
    w1 = f3 - u1 * w2 - u0 * f5
    w0 = f2 - v1 * v1 - u1 * w1 - u0 * w2
    high = w2 - s1 * f5
    weight = 1 / max(1, abs(t0), abs(t1))
    a0, a1, a2, a3 = u0 - s0, u1 - s1, (v0 + t0) * weight, (v1 + t1) * weight
    r0, r1 = t0 - v0, t1 - v1
    r2, r3 = (w0 - s0 * high) * weight, (w1 - s0 * f5 - s1 * high) * weight
    h0, h2 = a0 - s1 * a1, a2 - s1 * a3
    chordal = a0 * h0 + a1 * a1 * s0
    tangent = a2 * h2 + a3 * a3 * s0
    q = chordal * chordal + tangent * tangent
    size = a0 * a0 + a1 * a1 + a2 * a2 + a3 * a3
    if q > 1e-3 * size * size:
        l1 = chordal * (r1 * a0 - r0 * a1) + tangent * (r3 * a2 - r2 * a3)
        l0 = chordal * (r0 * h0 + r1 * a1 * s0) + tangent * (r2 * h2 + r3 * a3 * s0)
    else:
        l0, l1, q = slope((a0, a1, a2, a3), (-s0 * a1, h0, -s0 * a3, h2), (r0, r1, r2, r3))
    scale = 1 / max(abs(l0), abs(l1), abs(q))
    return q * scale, l1 * scale, l0 * scale


def slope(a: Four, b: Four, r: Four) -> tuple[Real, Real, Real]:
    """(l0, l1, q) with l0·a + l1·b = q·r in the least-squares sense, by two Householder reflections."""
    a0, a1, a2, a3 = a
    b0, b1, b2, b3 = b
    r0, r1, r2, r3 = r
    swap = a0 * a0 + a1 * a1 + a2 * a2 + a3 * a3 < b0 * b0 + b1 * b1 + b2 * b2 + b3 * b3
    if swap:
        a0, a1, a2, a3, b0, b1, b2, b3 = b0, b1, b2, b3, a0, a1, a2, a3
    norm = root(a0 * a0 + a1 * a1 + a2 * a2 + a3 * a3)
    if a0 < 0:
        norm = -norm
    h = a0 + norm
    k = 1 / (norm * h)
    dot_b = (h * b0 + a1 * b1 + a2 * b2 + a3 * b3) * k
    dot_r = (h * r0 + a1 * r1 + a2 * r2 + a3 * r3) * k
    b0 -= dot_b * h
    b1 -= dot_b * a1
    b2 -= dot_b * a2
    b3 -= dot_b * a3
    r0 -= dot_r * h
    r1 -= dot_r * a1
    r2 -= dot_r * a2
    r3 -= dot_r * a3
    size = b1 * b1 + b2 * b2 + b3 * b3
    overlap = b1 * r1 + b2 * r2 + b3 * r3
    # the unknowns are overlap/size and (r0 − b0·overlap/size)/(−norm). They are returned times q = size·norm, so that
    # nothing is divided by q, which is 0 for opposite points
    if negligible(root(size) / 16, norm):
        # for opposite points, up to rounding, the result is the null vector of the triangular system
        size, overlap = 0 * size, 1 + 0 * size
    second = overlap * norm
    first = b0 * overlap - r0 * size
    q = size * norm
    if swap:
        return second, first, q
    return first, second, q


def second_polynomial(
    f: Six, b0: Real, b1: Real, p: Four, q: Real, l0: Real, first: Four, second: Four
) -> tuple[Real, Real]:
    """V'' = c0 + c1·x from q·V'' ≡ −p and L·(V'' − V) ≡ −q·W modulo U'' = x² + b1·x + b0, with W = (f − V²)/U and
    L = (p − q·V)/U for each summand (U, V). The solutions are averaged as in :func:`chord`. If all are ill-conditioned,
    :func:`tangent_polynomial` computes V''.
    """
    f2, f3, f4, f5 = f[2], f[3], f[4], f[5]
    u0, u1, v0, v1 = first
    s0, s1, t0, t1 = second
    p0, p1, p2, l1 = p
    # the right-hand side −p of q·V'' ≡ −p, modulo U''
    high = p2 - b1 * l1
    r0, r1 = b0 * high - p0, b0 * l1 + b1 * high - p1
    # the right-hand side of L·V'' ≡ L·V − q·W modulo U'', with W = (f − V²)/U
    g3 = -q * f5
    w2 = f4 - u1 * f5
    w1 = f3 - u1 * w2 - u0 * f5
    w0 = f2 - v1 * v1 - u1 * w1 - u0 * w2
    high = l1 * v1 - q * w2 - b1 * g3
    r2, r3 = l0 * v0 - q * w0 - b0 * high, l0 * v1 + l1 * v0 - q * w1 - b0 * g3 - b1 * high
    # the right-hand side of L'·V'' ≡ L'·V' − q·W' for the other summand, with L' = (p − q·V')/U'
    weight = 1 / max(1, abs(t0), abs(t1))
    k0 = p2 - s1 * l1
    w2 = f4 - s1 * f5
    w1 = f3 - s1 * w2 - s0 * f5
    w0 = f2 - t1 * t1 - s1 * w1 - s0 * w2
    high = l1 * t1 - q * w2 - b1 * g3
    r4 = (k0 * t0 - q * w0 - b0 * high) * weight
    r5 = (k0 * t1 + l1 * t0 - q * w1 - b0 * g3 - b1 * high) * weight
    k0, k1 = k0 * weight, l1 * weight
    lower, lower2 = l0 - b1 * l1, k0 - b1 * k1
    one, other = l0 * lower + l1 * l1 * b0, k0 * lower2 + k1 * k1 * b0
    total = one * one + other * other + q * q
    if total > 0.01:
        scale = 1 / total
        c1 = (one * (r3 * l0 - r2 * l1) + other * (r5 * k0 - r4 * k1) + q * r1) * scale
        c0 = (one * (r2 * lower + r3 * l1 * b0) + other * (r4 * lower2 + r5 * k1 * b0) + q * r0) * scale
        return c0, c1
    return tangent_polynomial(f, b0, b1, q, (l0, l1, k0, k1), (r0, r1, r2, r3, r4, r5))


def tangent_polynomial(f: Six, b0: Real, b1: Real, q: Real, factors: Four, right: Six) -> tuple[Real, Real]:
    """V'' from the three congruences of :func:`second_polynomial`, solved together by Householder reflections.

    If the system leaves one combination of the two coefficients undetermined, the equation of the curve determines it.
    """
    x2, x3, x4, x5 = factors
    r0, r1, r2, r3, r4, r5 = right
    y2, y3, y4, y5 = -b0 * x3, x2 - b1 * x3, -b0 * x5, x4 - b1 * x5
    scale = 1 + r0 * r0 + r1 * r1 + r2 * r2 + r3 * r3 + r4 * r4 + r5 * r5
    # one Householder reflection clears the first column (q, 0, x2, …, x5) below its first entry
    norm = root(q * q + x2 * x2 + x3 * x3 + x4 * x4 + x5 * x5)
    h = q + norm
    k = 1 / (norm * h)
    dot_y = (x2 * y2 + x3 * y3 + x4 * y4 + x5 * y5) * k
    dot_r = (h * r0 + x2 * r2 + x3 * r3 + x4 * r4 + x5 * r5) * k
    y0 = -dot_y * h
    r0 -= dot_r * h
    y2, y3, y4, y5 = y2 - dot_y * x2, y3 - dot_y * x3, y4 - dot_y * x4, y5 - dot_y * x5
    r2, r3, r4, r5 = r2 - dot_r * x2, r3 - dot_r * x3, r4 - dot_r * x4, r5 - dot_r * x5
    size = q * q + y2 * y2 + y3 * y3 + y4 * y4 + y5 * y5
    # if size = 0, only the equation of the curve determines V''
    c1 = size if size == 0 else (q * r1 + y2 * r2 + y3 * r3 + y4 * r4 + y5 * r5) / size
    c0 = (y0 * c1 - r0) / norm
    # two Newton steps towards the curve, in the direction of (c0, c1) that the linear system determines least
    for _ in range(2):
        c0, c1 = newton_step(f, b0, b1, c0, c1, y0 / norm, size / scale)
    return c0, c1


def newton_step(f: Six, b0: Real, b1: Real, c0: Real, c1: Real, lean: Real, noise: Real) -> tuple[Real, Real]:
    """(c0, c1) + t·(lean, 1), nearer to V''² ≡ f modulo U'' by one Newton step.

    U'' = x² + b1·x + b0 and V'' = c1·x + c0. t is reduced where the equation has more rounding noise than the linear
    system that gave V''.
    """
    f0, f1, f2, f3, f4, f5 = f
    square = c0 * c0 + c1 * c1
    doubt = noise * (square * square + f0 * f0 + f1 * f1)
    e2 = f4 - b1 * f5
    e3 = f3 - b1 * e2 - b0 * f5
    e4 = f2 - c1 * c1 - b1 * e3 - b0 * e2
    d1 = f1 - 2 * c0 * c1 - b1 * e4 - b0 * e3
    d0 = f0 - c0 * c0 - b0 * e4
    # if t·(lean + x) is added to V'', d = f − V''² mod U'' becomes about d − t·J, J = 2·V''·(lean + x) mod U''
    top = 2 * c1
    j0, j1 = 2 * c0 * lean - b0 * top, 2 * (c1 * lean + c0) - b1 * top
    step = (j0 * d0 + j1 * d1) / (j0 * j0 + j1 * j1 + doubt)
    return c0 + step * lean, c1 + step
