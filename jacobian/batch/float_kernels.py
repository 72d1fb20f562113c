"""Loops over divisors of weight 2 in floats and complex numbers, to be compiled.

The composition is that of :mod:`jacobian.inexact.genus2_real` for deg f = 5 over the floats, and that of
:mod:`jacobian.inexact.genus2_complex` elsewhere.

The columns are those of :mod:`jacobian.batch.sums`. Where deg f = 5 over the floats, ``f`` has six coefficients and
``half`` = h/2 three; elsewhere ``f`` has seven and ``half`` four. These lengths are constants for the compiler, which
drops the branch that is not taken. Sizes are |re| + |im|, which needs no square root.
"""

from __future__ import annotations

from math import sqrt
from typing import Any

from jacobian.inexact import genus2_complex, genus2_real, retraction

# the largest allowed remainder f − V² mod U of a sum, relative to the size of its terms, as for single sums (REMAINDER
# of jacobian.inexact.composition). 1 or 2 rows in 100 in general position exceed it, and are added again
FINE = 2.0**-46
# the largest remainder from which a Newton step leads back to the curve; rows beyond it (1 in 10⁵) are added singly
NOISE = 2.0**-40
# the largest allowed remainder of given divisors
GIVEN_NOISE = 2.0**-32
# summands that are opposite to within this fraction of their size are not added here: their sum keeps few digits
OPPOSITE = 2.0**-30
# the roots of p² − q²f, p = q·V + L·U, are the abscissae of summands and sum; the largest coefficient of q and
# L = l1·x + l0 is about 1. If the leading coefficient of p² − q²f is small, the sum has a point far out or at infinity.
# This coefficient must exceed FLATTEST in genus2_complex. In genus2_real it is l1², and |l1| must exceed FLATTEST_CHORD
FLATTEST_CHORD = 2.0**-12
FLATTEST = 2.0**-20
# f at the smallest abscissa of the summands, and the leading term of f at the largest abscissa, must both be at least
# this fraction of f at the largest abscissa; then 21 of 53 bits remain
EVEN = 2.0**-32
TINY = 1e-300

BLOCK = 256
"""The number of columns in one pass of the loops."""
SCRATCH = 13 * BLOCK


def extent(z: Any) -> Any:
    """|re z| + |im z|."""
    return abs(z.real) + abs(z.imag)


def shift(half: Any, u0: Any, u1: Any) -> Any:
    """The remainder of h/2 modulo x² + u1·x + u0."""
    if len(half) == 3:
        return half[0] - half[2] * u0, half[1] - half[2] * u1
    high = half[2] - u1 * half[3]
    return half[0] - u0 * high, half[1] - u1 * high - u0 * half[3]


def scaled(half: Any, units: Any, columns: Any, i: Any) -> Any:
    """Divisor i on y² = f + h²/4, with u₀, u₁, v₀, v₁ multiplied by the four factors ``units``. ``half`` is h/2."""
    u0, u1 = columns[0, i], columns[1, i]
    t0, t1 = shift(half, u0, u1)
    return u0 * units[0], u1 * units[1], (columns[2, i] + t0) * units[2], (columns[3, i] + t1) * units[3]


def misfit(f: Any, divisor: Any) -> Any:
    """The larger of the two coefficients of f − V² modulo U, each relative to the size of its terms."""
    u0, u1, v0, v1 = divisor
    s0, s1, t0, t1 = extent(u0), extent(u1), extent(v0), extent(v1)
    r0, r1, r2, r3, r4, r5 = f[0] - v0 * v0, f[1] - 2 * v0 * v1, f[2] - v1 * v1, f[3], f[4], f[5]
    a0, a1, a2 = extent(f[0]) + t0 * t0, extent(f[1]) + 2 * t0 * t1, extent(f[2]) + t1 * t1
    a3, a4, a5 = extent(f[3]), extent(f[4]), extent(f[5])
    if len(f) == 7:
        size = extent(f[6])
        r5, r4, a5, a4 = r5 - u1 * f[6], r4 - u0 * f[6], a5 + s1 * size, a4 + s0 * size
    r4, r3, a4, a3 = r4 - u1 * r5, r3 - u0 * r5, a4 + s1 * a5, a3 + s0 * a5
    r3, r2, a3, a2 = r3 - u1 * r4, r2 - u0 * r4, a3 + s1 * a4, a2 + s0 * a4
    r2, r1, a2, a1 = r2 - u1 * r3, r1 - u0 * r3, a2 + s1 * a3, a1 + s0 * a3
    r1, r0, a1, a0 = r1 - u1 * r2, r0 - u0 * r2, a1 + s1 * a2, a0 + s0 * a2
    return max(extent(r0) / (a0 + TINY), extent(r1) / (a1 + TINY))


def apart(first: Any, second: Any) -> Any:
    """Whether the second divisor is far enough from the opposite of the first for their sum to have enough digits."""
    u0, u1, v0, v1 = first
    s0, s1, t0, t1 = second
    distance = extent(u0 - s0) + extent(u1 - s1) + extent(v0 + t0) + extent(v1 + t1)
    return distance > OPPOSITE * (1 + extent(u0) + extent(u1) + extent(v0) + extent(v1))


def even(f: Any, first: Any, second: Any) -> Any:
    """Whether f varies so little in size that the summands lose no digits.

    The sizes of f's terms are added up at the smallest and at the largest point of both divisors. The value at the
    smallest point, and the leading term at the largest, must not be far smaller than the value at the largest point.
    """
    a0, a1, b0, b1 = extent(first[0]), extent(first[1]), extent(second[0]), extent(second[1])
    a1, b1 = max(a1, sqrt(a0)), max(b1, sqrt(b0))
    large, small = max(a1, b1), min(a0 / max(a1, TINY), b0 / max(b1, TINY))
    high = low = extent(f[len(f) - 1])
    # a complex quintic is stored with the seventh coefficient 0, so the term of x⁵ counts too
    top = high * large + extent(f[5]) if len(f) == 7 else high
    for k in range(len(f) - 2, -1, -1):
        size = extent(f[k])
        high, low = high * large + size, low * small + size
    square = large * large
    return (low >= EVEN * high) & (top * square * square * large >= EVEN * high)


def added(f: Any, first: Any, second: Any) -> Any:
    """The sum of two divisors, and a number that vanishes if the degree of the sum drops."""
    if len(f) == 6:
        total, transfer = genus2_real.add(f, first, second)
        return total, transfer[1]
    return genus2_complex.add(f, first, second)


def steep(f: Any, size: Any) -> Any:
    """Whether a sum has degree 2; ``size`` is the second value of :func:`added`."""
    if len(f) == 6:
        return extent(size) > FLATTEST_CHORD
    return extent(size) > FLATTEST


def decided(f: Any, S: Any, i: Any) -> Any:
    """Whether the summands of column i have enough digits for their sum."""
    first, second = row(S, 0, i), row(S, 4, i)
    return steep(f, S[12 * BLOCK + i]) & apart(first, second) & even(f, first, second)


def improved(f: Any, S: Any, i: Any) -> Any:
    """Improves the sum of column i; returns whether it lies on the curve up to rounding.

    The summands are added in both orders, which round differently. The sum with the smaller remainder is kept and moved
    by a Newton step.
    """
    total, other = row(S, 8, i), added(f, row(S, 4, i), row(S, 0, i))[0]
    if not misfit(f, total) <= misfit(f, other):
        total = other
    near = misfit(f, total) <= NOISE
    total = retraction.retracted(f, total) if len(f) == 6 else genus2_complex.retracted(f, total)
    keep(S, 8, i, total)
    return near & (misfit(f, total) <= FINE)


def row(S: Any, first: Any, i: Any) -> Any:
    """The divisor in rows ``first`` to ``first`` + 3 of the scratch array, column i."""
    at = first * BLOCK + i
    return S[at], S[at + BLOCK], S[at + 2 * BLOCK], S[at + 3 * BLOCK]


def keep(S: Any, first: Any, i: Any, divisor: Any) -> None:
    """Stores a divisor in rows ``first`` to ``first`` + 3 of the scratch array, column i."""
    at = first * BLOCK + i
    S[at], S[at + BLOCK], S[at + 2 * BLOCK], S[at + 3 * BLOCK] = divisor


def add_columns(curve: Any, first: Any, second: Any, out: Any, doubtful: Any, span: Any, S: Any) -> None:
    """Adds the columns of a span (begin, end), in blocks, so that LLVM vectorises the steps that are the same for all
    columns.

    ``curve`` is f, h/2, the units of u₀, u₁, v₀, v₁ and their inverses. The scratch array S, of SCRATCH numbers, has
    rows of BLOCK numbers: for the summands, the sum, and the quantity that vanishes if the degree of the sum drops.
    """
    (f, half, units, inverses), (begin, end) = curve, span
    each = second.shape[1] > 1
    if not each:
        for i in range(BLOCK):
            keep(S, 4, i, scaled(half, inverses, second, 0))
    for start in range(begin, end, BLOCK):
        count = min(BLOCK, end - start)
        for i in range(count):
            keep(S, 0, i, scaled(half, inverses, first, start + i))
        if each:
            for i in range(count):
                keep(S, 4, i, scaled(half, inverses, second, start + i))
        for i in range(count):
            total, S[12 * BLOCK + i] = added(f, row(S, 0, i), row(S, 4, i))
            keep(S, 8, i, total)
        for i in range(count):
            doubtful[start + i] = not ((misfit(f, row(S, 8, i)) <= FINE) & decided(f, S, i))
        for i in range(count):
            if doubtful[start + i]:
                doubtful[start + i] = not (decided(f, S, i) and improved(f, S, i))
        for i in range(count):
            u0, u1, v0, v1 = row(S, 8, i)
            u0, u1 = u0 * units[0], u1 * units[1]
            t0, t1 = shift(half, u0, u1)
            out[0, start + i], out[1, start + i] = u0, u1
            out[2, start + i], out[3, start + i] = v0 * units[2] - t0, v1 * units[3] - t1


def first_off_curve(f: Any, half: Any, inverses: Any, divisors: Any) -> Any:
    """The index of the first divisor whose :func:`misfit` with the curve exceeds GIVEN_NOISE, or −1."""
    for i in range(divisors.shape[1]):
        if not misfit(f, scaled(half, inverses, divisors, i)) <= GIVEN_NOISE:
            return i
    return -1
