"""Theta functions of genus 2 on a real torus, as real Fourier series, compiled.

With the period matrix τ and the characteristic η = (ε, δ), θ[η](z) = Σ e^(πi nτn + 2πi n(z + ½δ)), n in Z² + ½ε. On
the torus z = φ + τq, with real φ and half-integral q, θ[η](z) is the series at φ with ε + 2q in place of ε, times a
factor that cancels in quotients. That series is real up to a constant factor. Its terms of n and −n are combined.
"""

from __future__ import annotations

from functools import cache
from math import floor, log2, pi
from typing import NamedTuple

import gmpy2
import numpy as np

from integrable.moving_point.addition import Row
from jacobian.element import Real
from jacobian.inexact.long_field import LongField
from jacobian.numbers.abreast import abreast
from jacobian.numbers.double_double import double_double_row
from jacobian.numbers.long_reals import BareReals
from jacobian.numbers.sums import joined, plus_product

# for double-doubles: the bits in which 2π and 1/n! are computed, and the bits to which the series of cosine and sine,
# with these coefficients, are truncated
BITS, SUMMED, SUMMED_IN_FLOATS = 200, 112, 56
# e^(−π·DEPTH) is the truncation error of a series relative to its largest term
DEPTH = 22.0


class ThetaSums(NamedTuple):
    """The coefficients of several theta series. A *class* is the index of a series; its characteristic is (ε, δ).

    ``table`` has ``sizes`` = (classes, rows, columns) entries of four numbers, one after the other. Rows are a = ε₁, ε₁
    + 2, …, columns b = ε₂, ε₂ + 2, …. An entry holds w₊ + w₋ and w₊ − w₋ for the coefficients w± of n = (a, ±b)/2,
    first of θ, then of its derivative along a direction. Entries after the first ``lengths`` columns of a row are
    negligible. ``chars`` are ε₁, ε₂, δ₁, δ₂ of each class. ``inverse``: see :func:`circle`.
    """

    table: Row
    sizes: tuple[int, int, int]
    lengths: Row
    chars: Row
    inverse: Row


def theta(sums: ThetaSums, k: int, first: tuple[Real, Real], second: tuple[Real, Real]) -> tuple[Real, Real]:
    """θ of class k and its derivative, from (cosine, sine) of πφ₁ and of πφ₂."""
    (c1, s1), rows, zero = first, sums.sizes[1], 0 * first[0]
    # (a, b) is (cos, sin) of πnφ₁ for the rows n = ε₁, ε₁ + 2, …
    ca, sa = c1 * c1 - s1 * s1, 2 * c1 * s1
    a, b = 1 + zero, zero
    if sums.chars[4 * k] > 0:
        a, b = c1, s1
    value, rate, odd = zero, zero, is_odd(sums.chars, k)
    for i in range(rows):
        p, q, dp, dq = row_sums(sums, k, i, second)
        x, y, u, v = a, -b, b, a
        if odd:
            x, y, u, v = u, v, x, y
        value = plus_product(plus_product(value, x, p), y, q)
        rate = plus_product(plus_product(rate, u, dp), v, dq)
        a, b = a * ca - b * sa, a * sa + b * ca
    return joined(value, zero), joined(rate, zero)


def row_sums(sums: ThetaSums, k: int, i: int, second: tuple[Real, Real]) -> tuple[Real, Real, Real, Real]:
    """The coefficients of cos πaφ₁ and of sin πaφ₁, a = ε₁ + 2i, in θ of class k, then those in its derivative. They
    are summed from row i of the table; ``second`` is (cosine, sine) of πφ₂.
    """
    (c2, s2), table = second, sums.table
    _, rows, columns = sums.sizes
    zero = 0 * c2
    cs, ss = c2 * c2 - s2 * s2, 2 * c2 * s2
    c, s = 1 + zero, zero
    if sums.chars[4 * k + 1] > 0:
        c, s = c2, s2
    p, q, dp, dq = zero, zero, zero, zero
    place = 4 * (k * rows + i) * columns
    for _ in range(sums.lengths[k * rows + i]):
        p, q = plus_product(p, table[place], c), plus_product(q, table[place + 1], s)
        dp, dq = plus_product(dp, table[place + 2], c), plus_product(dq, table[place + 3], s)
        c, s = c * cs - s * ss, c * ss + s * cs
        place += 4
    return joined(p, zero), joined(q, zero), joined(dp, zero), joined(dq, zero)


def is_odd(chars: Row, k: int) -> bool:
    """Whether θ of class k is odd in φ."""
    return (chars[4 * k] * chars[4 * k + 2] + chars[4 * k + 1] * chars[4 * k + 3]) % 2 > 0


class Lattice(NamedTuple):
    """The data of theta series. ``bases`` are e^(−πY₁₁/4), e^(−πY₂₂/4), e^(−πY₁₂/2) and its inverse, Y = Im τ;
    ``along`` is π times the direction of the derivative; ``turns`` are the integers 2Re τ₁₁, 2Re τ₁₂, 2Re τ₂₂.

    ``least`` are the least ε₁² and ε₂² of all classes. All terms are divided by e^(−π(least₁Y₁₁ + least₂Y₂₂)/4), so
    that e^(−πY₁₁/4) may be 0. Terms below the fraction ``last`` of the largest are negligible.
    """

    bases: Row
    along: Row
    turns: tuple[int, int, int]
    least: tuple[int, int]
    last: float


def exponential(x: Real, inverse: Row) -> Real:
    """e^x, from its series at x/2^n below ½; ``inverse`` is the result of :func:`circle_numbers`."""
    halvings = 0
    while abs(float(x)) >= 0.5:
        x, halvings = x / 2, halvings + 1
    total = 0 * x
    for n in range(len(inverse) - 1, 0, -1):
        total = inverse[n] + x * total
    for _ in range(halvings):
        total = total * total
    return total


def theta_weights(
    shape: Row, turns: tuple[int, int, int], least: tuple[int, int], last: float, sums: ThetaSums, tops: Row
) -> bool:
    """Fills the table and the lengths of ``sums``, and ``tops`` with the largest term of each class, by which its
    coefficients are divided.

    ``shape`` holds Y₁₁, Y₁₂, Y₂₂, Y = Im τ, with 0 for an infinite Y₁₁, and the direction of the derivative. The other
    arguments are those of :class:`Lattice`. Returns whether the series are real up to a constant factor.
    """
    half, inverse = sums.inverse[0] / 2, sums.inverse
    first, second = exponential(-(half * shape[0] / 4), inverse), exponential(-(half * shape[2] / 4), inverse)
    if shape[0] == 0:
        first = 0 * first
    mixed, other = exponential(-(half * shape[1] / 2), inverse), exponential(half * shape[1] / 2, inverse)
    lattice = Lattice((first, second, mixed, other), (half * shape[3], half * shape[4]), turns, least, last)
    classes, rows, _ = sums.sizes
    zero, real = 0 * lattice.bases[0], True
    for n in range(len(sums.table)):
        sums.table[n] = zero
    for k in range(classes):
        e1, e2 = sums.chars[4 * k], sums.chars[4 * k + 1]
        # Y = Im τ is a reduced form, so the largest e^(−πnYn), n = (a, m)/2, has the least |a| and |m|
        top, phase = term(lattice, e1, e2), sixteenths(lattice.turns, e1, e2)
        other = term(lattice, e1, -e2)
        if other > top:
            top, phase = other, sixteenths(lattice.turns, e1, -e2)
        tops[k] = top
        for i in range(rows):
            sums.lengths[k * rows + i] = 0
            for side in range(2):
                # the terms of n and −n are combined
                if e1 + 2 * i > 0 or side == 0:
                    real = put_row(lattice, sums, (k, i), side, top, phase) and real
    return real


def put_row(lattice: Lattice, sums: ThetaSums, place: tuple[int, int], side: int, top: Real, phase: int) -> bool:
    """Adds the terms of the theta series of class k with n = (a, ±b)/2, for the a of row i and all b, to this row of
    the tables; (k, i) = ``place``. The sign is + on ``side`` 0 and − on ``side`` 1.

    ``top`` and ``phase`` are the size and the phase of the largest term. Returns whether all terms are real multiples
    of it.
    """
    (k, i), sign, real = place, 1 - 2 * side, True
    _, rows, columns = sums.sizes
    a, e2 = sums.chars[4 * k] + 2 * i, sums.chars[4 * k + 1]
    mixed = lattice.bases[2] if sign > 0 else lattice.bases[3]
    # |m| grows by 2 from column to column: ``step`` is the ratio of the next term to the present one,
    # ``more`` the ratio of the next step to the present one
    w, step = term(lattice, a, sign * e2) / top, raised(lattice.bases[1], 4 * e2 + 4) * raised(mixed, 2 * a)
    more = raised(lattice.bases[1], 8)
    for j in range(columns):
        m = sign * (e2 + 2 * j)
        turned = sixteenths(lattice.turns, a, m) - phase
        real = real and turned % 8 == 0
        if m != 0 or side == 0:
            if w > lattice.last:
                sums.lengths[k * rows + i] = max(sums.lengths[k * rows + i], j + 1)
            weight = w * weight_sign(sums.chars, k, turned, a, m)
            rate = (a * lattice.along[0] + m * lattice.along[1]) * weight
            if not is_odd(sums.chars, k):
                rate = -rate
            at, table = 4 * ((k * rows + i) * columns + j), sums.table
            table[at], table[at + 1] = table[at] + weight, table[at + 1] + sign * weight
            table[at + 2], table[at + 3] = table[at + 2] + rate, table[at + 3] + sign * rate
        w, step = w * step, step * more
    return real


def weight_sign(chars: Row, k: int, turned: int, a: int, m: int) -> int:
    """The sign of the term of n = (a, m)/2 of class k, times 2 if it is added up with the term of −n."""
    d = (a * chars[4 * k + 2] + m * chars[4 * k + 3]) % 4
    sign = 1 if (turned % 16 != 0) == (d == 1 or d == 2) else -1
    return 2 * sign if a != 0 or m != 0 else sign


def sixteenths(turns: tuple[int, int, int], a: int, m: int) -> int:
    """The phase of e^(πi n·Re τ·n), n = (a, m)/2, in sixteenths of a turn, with the ``turns`` of a :class:`Lattice`."""
    return a * a * turns[0] + 2 * a * m * turns[1] + m * m * turns[2]


def term(lattice: Lattice, a: int, m: int) -> Real:
    """The size e^(−πnYn) of the term of n = (a, m)/2, divided as in :class:`Lattice`."""
    bases, (first, second) = lattice.bases, lattice.least
    mixed = raised(bases[2], a * m) if m > 0 else raised(bases[3], -a * m)
    return raised(bases[0], a * a - first) * raised(bases[1], m * m - second) * mixed


def raised(x: Real, n: int) -> Real:
    found = 1 + 0 * x
    while n > 0:
        if n % 2 == 1:
            found = found * x
        x, n = x * x, n // 2
    return found


def circle(turns: Real, inverse: Row) -> tuple[Real, Real]:
    """The pair (cos, sin) of an angle given in turns; ``inverse`` is the result of :func:`circle_numbers`."""
    whole = turns - float(floor(float(turns) + 0.5))
    quarters = floor(4 * float(whole) + 0.5)
    y = (whole - quarters / 4) * inverse[0]
    square = y * y
    c, s, last = 0 * y, 0 * y, len(inverse) // 2
    for n in range(1, last + 1):
        c = inverse[2 * (last - n) + 1] - square * c
        s = inverse[2 * (last - n) + 2] - square * s
    s *= y
    if quarters % 2 != 0:
        c, s = -s, c
    if quarters % 4 > 1:
        c, s = -c, -s
    return c, s


def circle_points(angles: Row, inverse: Row, cosines: Row, sines: Row) -> None:
    """Writes the ``cosines`` and ``sines`` of ``angles``, floats in radians, by :func:`circle`."""
    for i in abreast(0, len(angles)):
        cosines[i], sines[i] = circle(angles[i] / inverse[0], inverse)


@cache
def long_numbers(bits: int) -> LongField:
    return LongField(bits)


def half_turn() -> Real:
    """π at the precision of the field currently entered."""
    return gmpy2.const_pi()


def circle_numbers(reals: BareReals, summed: int) -> list[Real]:
    """2π, then 1/n! for n = 0, 1, …: the ``inverse`` of :func:`circle`, for a cosine and a sine to ``summed`` bits."""
    with reals:
        found, term, bits = [2 * half_turn(), reals.number(1)], reals.number(1), 0.0
        while bits < summed or len(found) % 2 == 0:
            n = len(found) - 1
            term = term / n
            found.append(term)
            # angles are at most an eighth of a turn
            bits += log2(n / (pi / 4))
        return found


@cache
def inverse_factorials() -> Row:
    """2π and the 1/n! of :func:`circle_numbers`, in double-doubles."""
    return double_double_row(circle_numbers(BareReals(BITS), SUMMED))


@cache
def float_circle() -> Row:
    """:func:`circle_numbers` in floats."""
    return np.array([*map(float, circle_numbers(BareReals(BITS), SUMMED_IN_FLOATS))])
