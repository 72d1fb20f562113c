"""One addition in genus 2 on complex numbers and on curves with deg f = 6, in Python that is compiled unchanged.

These are the formulas of :mod:`jacobian.inexact.composition` for two divisors of weight two on y² = f(x), deg f ≤ 6,
unrolled as in :mod:`jacobian.inexact.genus2_real`, which explains the symbols. Three things differ. Squares that
measure a size are |z|². Least squares use the adjoint: a Householder vector is turned by the phase of its first entry,
and inner products conjugate their first factor. The polynomial f has a seventh coefficient, and the transfer
polynomials of the lift, which only real motions need, are left out.

Numbers are ``complex`` or ``float``, which is its own conjugate. Coordinates must be in units that make the
coefficients of f of moderate size. The result must be of weight two. This is so if the leading coefficient of
p² − q²f, which is returned too, is not small.
"""

from __future__ import annotations

from math import sqrt
from typing import Any

Number = Any  # complex, or float
Four = tuple[Number, Number, Number, Number]
Six = tuple[Number, Number, Number, Number, Number, Number]
Seven = tuple[Number, Number, Number, Number, Number, Number, Number]


def square(z: Number) -> Any:
    """|z|², a real number."""
    return z.real * z.real + z.imag * z.imag


def phase(z: Number) -> Number:
    """z/|z|, and 1 for 0."""
    size = sqrt(square(z))
    return z * (1 / size) if size > 0 else 1 + z


def add(f: Seven, first: Four, second: Four) -> tuple[Four, Number]:
    """(D + D', the leading coefficient of p² − q²f) for D = (u0, u1, v0, v1), U = x² + u1·x + u0 and V = v1·x + v0.

    q·y − p with p = q·V + L·U, L linear, vanishes on D and D'; the largest of q and the coefficients of L has size 1.
    Where the leading coefficient is small, D + D' has a point with large |x| or at infinity.
    """
    u0, u1, v0, v1 = first
    s0, s1 = second[0], second[1]
    q, l1, l0 = chord(f, first, second)
    # p is q·V + L·U, and U'' follows from the leading coefficients of p² − q²f
    p0, p1, p2 = q * v0 + u0 * l0, q * v1 + u1 * l0 + u0 * l1, l0 + u1 * l1
    q2 = q * q
    top = l1 * l1 - q2 * f[6]
    inverse = top.conjugate() * (1 / square(top))
    sum1, sum0 = u1 + s1, u0 + s0 + u1 * s1
    b1 = (2 * l1 * p2 - q2 * f[5]) * inverse - sum1
    b0 = (p2 * p2 + 2 * l1 * p1 - q2 * f[4]) * inverse - b1 * sum1 - sum0
    c0, c1 = second_polynomial(f, b0, b1, (p0, p1, p2, l1), q, l0, first, second)
    return (b0, b1, c0, c1), top


def cofactor(f: Seven, divisor: Four) -> tuple[Number, Number, Number, Number]:
    """The coefficients (w0, w1, w2, w3) of W = (f − V²)/U; its leading coefficient w4 is f6."""
    u0, u1, _, v1 = divisor
    w3 = f[5] - u1 * f[6]
    w2 = f[4] - u1 * w3 - u0 * f[6]
    w1 = f[3] - u1 * w2 - u0 * w3
    return f[2] - v1 * v1 - u1 * w1 - u0 * w2, w1, w2, w3


def remainder(
    a0: Number, a1: Number, a2: Number, a3: Number, a4: Number, u0: Number, u1: Number
) -> tuple[Number, Number]:
    """The two coefficients of a0 + a1·x + … + a4·x⁴ modulo x² + u1·x + u0."""
    high = a3 - u1 * a4
    low = a2 - u1 * high - u0 * a4
    return a0 - u0 * low, a1 - u1 * low - u0 * high


def chord(f: Seven, first: Four, second: Four) -> tuple[Number, Number, Number]:
    """(q, l1, l0) with L·U ≡ q(V' − V) and L·(V + V') ≡ q·W modulo U', L = l1·x + l0.

    The largest of q, l1 and l0 has size 1, and W = (f − V²)/U. Each congruence L·A ≡ q·R is solved by itself, L = q·R/A
    mod U', with the resultant of A and U' as the denominator. The two solutions are averaged with the squared
    resultants as weights. Where both resultants are small (opposite points) the system of both congruences is solved by
    reflections.
    """
    u0, u1, v0, v1 = first
    s0, s1, t0, t1 = second
    w0, w1, w2, w3 = cofactor(f, first)
    weight = 1 / sqrt(max(1, square(t0), square(t1)))
    a0, a1, a2, a3 = u0 - s0, u1 - s1, (v0 + t0) * weight, (v1 + t1) * weight
    r0, r1 = t0 - v0, t1 - v1
    r2, r3 = remainder(w0, w1, w2, w3, f[6], s0, s1)
    r2, r3 = r2 * weight, r3 * weight
    h0, h2 = a0 - s1 * a1, a2 - s1 * a3
    chordal = a0 * h0 + a1 * a1 * s0
    tangent = a2 * h2 + a3 * a3 * s0
    q = square(chordal) + square(tangent) + 0 * chordal
    size = square(a0) + square(a1) + square(a2) + square(a3)
    if q.real > 1e-3 * size * size:
        chordal, tangent = chordal.conjugate(), tangent.conjugate()
        l1 = chordal * (r1 * a0 - r0 * a1) + tangent * (r3 * a2 - r2 * a3)
        l0 = chordal * (r0 * h0 + r1 * a1 * s0) + tangent * (r2 * h2 + r3 * a3 * s0)
    else:
        l0, l1, q = slope((a0, a1, a2, a3), (-s0 * a1, h0, -s0 * a3, h2), (r0, r1, r2, r3))
    scale = 1 / sqrt(max(square(l0), square(l1), square(q)))
    return q * scale, l1 * scale, l0 * scale


def slope(a: Four, b: Four, r: Four) -> tuple[Number, Number, Number]:
    """(l0, l1, q) with l0·a + l1·b = q·r in the least-squares sense, by two Householder reflections."""
    swap = square(a[0]) + square(a[1]) + square(a[2]) + square(a[3]) < (
        square(b[0]) + square(b[1]) + square(b[2]) + square(b[3])
    )
    if swap:
        a, b = b, a
    a0, a1, a2, a3 = a
    b0, b1, b2, b3 = b
    r0, r1, r2, r3 = r
    size = sqrt(square(a0) + square(a1) + square(a2) + square(a3))
    norm = phase(a0) * size
    h = a0 + norm
    k = 1 / (size * (size + sqrt(square(a0))))
    e0, e1, e2, e3 = h.conjugate() * k, a1.conjugate() * k, a2.conjugate() * k, a3.conjugate() * k
    dot_b = e0 * b0 + e1 * b1 + e2 * b2 + e3 * b3
    dot_r = e0 * r0 + e1 * r1 + e2 * r2 + e3 * r3
    b0, b1, b2, b3 = b0 - dot_b * h, b1 - dot_b * a1, b2 - dot_b * a2, b3 - dot_b * a3
    r0, r1, r2, r3 = r0 - dot_r * h, r1 - dot_r * a1, r2 - dot_r * a2, r3 - dot_r * a3
    rest = square(b1) + square(b2) + square(b3)
    overlap = b1.conjugate() * r1 + b2.conjugate() * r2 + b3.conjugate() * r3
    # the triangular system has the solutions overlap/rest and (b0·overlap/rest − r0)/norm. They are returned times
    # q = rest·norm, so that nothing is divided by q, which is 0 for opposite points
    if size + sqrt(rest) / 16 == size:
        # for opposite points, up to rounding, the result is a null vector of the system
        rest, overlap = 0 * rest, 1 + 0 * overlap
    second, first, q = overlap * norm, b0 * overlap - r0 * rest, rest * norm
    if swap:
        return second, first, q
    return first, second, q


def second_polynomial(
    f: Seven, b0: Number, b1: Number, p: Four, q: Number, l0: Number, first: Four, second: Four
) -> tuple[Number, Number]:
    """V'' = c0 + c1·x from q·V'' ≡ −p and L·(V'' − V) ≡ −q·W modulo U'' = x² + b1·x + b0.

    The second congruence holds for each summand (U, V), with W = (f − V²)/U and L = (p − q·V)/U.

    The solutions of the three congruences are averaged as in :func:`chord`. If all three are ill-conditioned,
    :func:`tangent_polynomial` computes V''.
    """
    v0, v1 = first[2], first[3]
    s1, t0, t1 = second[1], second[2], second[3]
    p0, p1, p2, l1 = p
    # the right-hand side −p of q·V'' ≡ −p, modulo U''
    high = p2 - b1 * l1
    r0, r1 = b0 * high - p0, b0 * l1 + b1 * high - p1
    # the right-hand side of L·V'' ≡ L·V − q·W modulo U'', with W = (f − V²)/U
    w0, w1, w2, w3 = cofactor(f, first)
    top = -q * f[6]
    r2, r3 = remainder(l0 * v0 - q * w0, l0 * v1 + l1 * v0 - q * w1, l1 * v1 - q * w2, -q * w3, top, b0, b1)
    # the right-hand side of L'·V'' ≡ L'·V' − q·W' for the other summand, with L' = (p − q·V')/U'
    weight = 1 / sqrt(max(1, square(t0), square(t1)))
    k0 = p2 - s1 * l1
    w0, w1, w2, w3 = cofactor(f, second)
    r4, r5 = remainder(k0 * t0 - q * w0, k0 * t1 + l1 * t0 - q * w1, l1 * t1 - q * w2, -q * w3, top, b0, b1)
    r4, r5, k0, k1 = r4 * weight, r5 * weight, k0 * weight, l1 * weight
    lower, lower2 = l0 - b1 * l1, k0 - b1 * k1
    one, other = l0 * lower + l1 * l1 * b0, k0 * lower2 + k1 * k1 * b0
    total = square(one) + square(other) + square(q)
    if total > 0.01:
        scale = 1 / total
        one, other, own = one.conjugate() * scale, other.conjugate() * scale, q.conjugate() * scale
        c1 = one * (r3 * l0 - r2 * l1) + other * (r5 * k0 - r4 * k1) + own * r1
        c0 = one * (r2 * lower + r3 * l1 * b0) + other * (r4 * lower2 + r5 * k1 * b0) + own * r0
        return c0, c1
    return tangent_polynomial(f, b0, b1, q, (l0, l1, k0, k1), (r0, r1, r2, r3, r4, r5))


def tangent_polynomial(f: Seven, b0: Number, b1: Number, q: Number, factors: Four, right: Six) -> tuple[Number, Number]:
    """V'' from the three congruences of :func:`second_polynomial`, solved together by Householder reflections.

    If the system leaves one combination of the two coefficients undetermined, the equation of the curve determines it.
    """
    x2, x3, x4, x5 = factors
    r0, r1, r2, r3, r4, r5 = right
    y2, y3, y4, y5 = -b0 * x3, x2 - b1 * x3, -b0 * x5, x4 - b1 * x5
    scale = 1 + square(r0) + square(r1) + square(r2) + square(r3) + square(r4) + square(r5)
    # one Householder reflection clears the first column (q, 0, x2, …, x5) below its first entry
    norm = sqrt(square(q) + square(x2) + square(x3) + square(x4) + square(x5))
    turn = phase(q)
    h = q + turn * norm
    k = 1 / (norm * (norm + sqrt(square(q))))
    e2, e3, e4, e5 = x2.conjugate() * k, x3.conjugate() * k, x4.conjugate() * k, x5.conjugate() * k
    dot_y = e2 * y2 + e3 * y3 + e4 * y4 + e5 * y5
    dot_r = h.conjugate() * k * r0 + e2 * r2 + e3 * r3 + e4 * r4 + e5 * r5
    y2, y3, y4, y5 = y2 - dot_y * x2, y3 - dot_y * x3, y4 - dot_y * x4, y5 - dot_y * x5
    r2, r3, r4, r5 = r2 - dot_r * x2, r3 - dot_r * x3, r4 - dot_r * x4, r5 - dot_r * x5
    size = square(q) + square(y2) + square(y3) + square(y4) + square(y5)
    overlap = q.conjugate() * r1
    overlap += y2.conjugate() * r2 + y3.conjugate() * r3 + y4.conjugate() * r4 + y5.conjugate() * r5
    # c0 follows from c1: c0 = lean·c1 + rest
    inverse = turn.conjugate() * (1 / norm)
    lean, rest = -dot_y * h * inverse, -(r0 - dot_r * h) * inverse
    # if size = 0, only the equation of the curve determines V''
    c1 = overlap * (1 / size) if size > 0 else 0 * overlap
    c0 = lean * c1 + rest
    # two Newton steps towards the curve, in the direction of (c0, c1) that the linear system determines least
    for _ in range(2):
        c0, c1 = newton_step(f, b0, b1, c0, c1, lean, size / scale)
    return c0, c1


def newton_step(
    f: Seven, b0: Number, b1: Number, c0: Number, c1: Number, lean: Number, noise: Any
) -> tuple[Number, Number]:
    """(c0, c1) + t·(lean, 1): a Newton step for V''² ≡ f modulo U'', V'' = c0 + c1·x, U'' = x² + b1·x + b0.

    t is reduced where the equation has more rounding noise than the linear system that gave V''.
    """
    sizes = square(c0) + square(c1)
    doubt = noise * (sizes * sizes + square(f[0]) + square(f[1]))
    d0, d1 = remainder(f[0] - c0 * c0, f[1] - 2 * c0 * c1, f[2] - c1 * c1, f[3], f[4], b0, b1)
    # x⁵ and x⁶ modulo U'', by x² ≡ −b1·x − b0
    m0, m1 = remainder(0 * b0, 0 * b0, 0 * b0, f[5], f[6], b0, b1)
    m0, m1 = -b0 * m1, m0 - b1 * m1
    m0, m1 = -b0 * m1, m0 - b1 * m1
    d0, d1 = d0 + m0, d1 + m1
    # with d = f − V''² mod U'' a step by t leaves d − t·J, J = 2·V''·(lean + x) mod U''
    top = 2 * c1
    j0, j1 = 2 * c0 * lean - b0 * top, 2 * (c1 * lean + c0) - b1 * top
    step = (j0.conjugate() * d0 + j1.conjugate() * d1) * (1 / (square(j0) + square(j1) + doubt))
    return c0 + step * lean, c1 + step


def retracted(f: Seven, divisor: Four) -> Four:
    """The divisor after one Newton step of least length towards f ≡ V² mod U.

    :func:`jacobian.inexact.retraction.retracted` is the same step for real numbers.
    """
    u0, u1, v0, v1 = divisor
    w0, w1, w2, w3 = cofactor(f, divisor)
    r0, r1 = f[0] - v0 * v0 - u0 * w0, f[1] - 2 * v0 * v1 - u1 * w0 - u0 * w1
    # the differential 2V·δV + W·δU mod U for δV = 1, x and δU = 1, x: 2V, 2xV, W, xW
    a0, a1 = 2 * v0, 2 * v1
    b0, b1 = -u0 * a1, a0 - u1 * a1
    c0, c1 = remainder(w0, w1, w2, w3, f[6], u0, u1)
    d0, d1 = -u0 * c1, c0 - u1 * c1
    m00 = square(a0) + square(b0) + square(c0) + square(d0)
    m11 = square(a1) + square(b1) + square(c1) + square(d1)
    m01 = a0 * a1.conjugate() + b0 * b1.conjugate() + c0 * c1.conjugate() + d0 * d1.conjugate()
    scale = 1 / (m00 * m11 - square(m01))
    s0, s1 = (m11 * r0 - m01 * r1) * scale, (m00 * r1 - m01.conjugate() * r0) * scale
    return (
        u0 + c0.conjugate() * s0 + c1.conjugate() * s1,
        u1 + d0.conjugate() * s0 + d1.conjugate() * s1,
        v0 + a0.conjugate() * s0 + a1.conjugate() * s1,
        v1 + b0.conjugate() * s0 + b1.conjugate() * s1,
    )
