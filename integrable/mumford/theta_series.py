"""Theta functions of genus 2 on a real torus, as real Fourier series, compiled.

With the characteristic η = (ε, δ), θ[η](z) = Σ e^(πi nτn + 2πi n(z + ½δ)), n in Z² + ½ε. On the torus z = φ + τq with
half-integral q it is the series at φ with ε + 2q for ε, times a factor that cancels in quotients. That series is real
up to a constant factor. Its terms of n and −n are combined.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, pi
from typing import NamedTuple

import numpy as np

from integrable.mumford.elliptic_torus import circle, half_turn, inverse_factorials
from jacobian.element import Complex, Real
from jacobian.errors import PrecisionLoss
from jacobian.native.kinds import INT, INTS, WIDES, TupleKind, record
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL
from jacobian.numbers.abreast import abreast
from jacobian.numbers.double_double import double_double_row
from jacobian.periods.real_basis import Whole

Row = np.ndarray

# largest number of harmonics of a series; beyond it, branch points nearly meet
MOST_HARMONICS = 40
# LEAST = e^(−π·DEPTH) is the truncation error of a series relative to its largest term
DEPTH = 22.0
LEAST = exp(-pi * DEPTH)


class ThetaSums(NamedTuple):
    """The weights of the theta series of all classes (characteristics).

    ``table`` has ``sizes`` = (classes, rows, columns) entries of four numbers, one after the other. Rows are a = e₁, e₁
    + 2, …, columns b = e₂, e₂ + 2, …. An entry holds w₊ + w₋ and w₊ − w₋ for the weights w± of n = (a, ±b)/2, first of
    θ, then of its derivative along a direction. Entries after ``lengths`` columns of a row are negligible. ``chars``
    are e₁, e₂, δ₁, δ₂ of each class. ``inverse`` is that of :func:`integrable.mumford.elliptic_torus.circle`.
    """

    table: Row
    sizes: tuple[int, int, int]
    lengths: Row
    chars: Row
    inverse: Row


def theta_lifts(sums: ThetaSums, phases: Row, out: Row) -> None:
    """Writes θ_∞, that of the last class, for each pair of phases in turns, then σ = θ/θ_∞ and ν = −2∂σ for every other
    class.
    """
    classes = sums.sizes[0]
    width = 2 * classes - 1
    for i in abreast(0, len(phases) // 2):
        c1, s1 = circle(phases[2 * i] / 2, sums.inverse)
        c2, s2 = circle(phases[2 * i + 1] / 2, sums.inverse)
        last, slope = theta(sums, classes - 1, (c1, s1), (c2, s2))
        over = 1 / last
        lean = slope * over
        out[width * i] = last
        for k in range(classes - 1):
            value, rate = theta(sums, k, (c1, s1), (c2, s2))
            sigma = value * over
            out[width * i + 2 * k + 1] = sigma
            out[width * i + 2 * k + 2] = 2 * (sigma * lean - rate * over)


def theta(sums: ThetaSums, k: int, first: tuple[Real, Real], second: tuple[Real, Real]) -> tuple[Real, Real]:
    """θ of class k and its derivative, from (cosine, sine) of πφ₁ and of πφ₂."""
    (c1, s1), (c2, s2), table = first, second, sums.table
    _, rows, columns = sums.sizes
    zero = 0 * c1
    # harmonics advance by twice the angles, and begin at 0 or at one angle
    ca, sa, cs, ss = c1 * c1 - s1 * s1, 2 * c1 * s1, c2 * c2 - s2 * s2, 2 * c2 * s2
    a, b, start, other = 1 + zero, zero, 1 + zero, zero
    if sums.chars[4 * k] > 0:
        a, b = c1, s1
    if sums.chars[4 * k + 1] > 0:
        start, other = c2, s2
    value, rate, odd = zero, zero, is_odd(sums.chars, k)
    for i in range(rows):
        p, q, dp, dq, c, s = zero, zero, zero, zero, start, other
        place = 4 * (k * rows + i) * columns
        for _ in range(sums.lengths[k * rows + i]):
            p, q = p + table[place] * c, q + table[place + 1] * s
            dp, dq = dp + table[place + 2] * c, dq + table[place + 3] * s
            c, s = c * cs - s * ss, c * ss + s * cs
            place += 4
        if odd:
            value, rate = value + (b * p + a * q), rate + (a * dp - b * dq)
        else:
            value, rate = value + (a * p - b * q), rate + (b * dp + a * dq)
        a, b = a * ca - b * sa, a * sa + b * ca
    return value, rate


def is_odd(chars: Row, k: int) -> bool:
    """Whether θ of class k is odd in φ."""
    odd: bool = (chars[4 * k] * chars[4 * k + 2] + chars[4 * k + 1] * chars[4 * k + 3]) % 2 > 0
    return odd


class Lattice(NamedTuple):
    """The data of a theta series: e^(−πY₁₁/4), e^(−πY₂₂/4), e^(−πY₁₂/2) and its inverse, Y = Im τ; π times a direction
    in z; and the integers 2Re τ₁₁, 2Re τ₁₂, 2Re τ₂₂.
    """

    bases: Row
    along: Row
    turns: tuple[int, int, int]


def theta_weights(lattice: Lattice, sums: ThetaSums, tops: Row) -> bool:
    """Fills the table and the lengths of ``sums``; ``tops`` are the largest terms, by which weights are divided.

    Returns whether the series are real up to a constant factor.
    """
    classes, rows, columns = sums.sizes
    zero, real = 0 * lattice.bases[0], True
    for n in range(len(sums.table)):
        sums.table[n] = zero
    for k in range(classes):
        e1, e2, top, phase = sums.chars[4 * k], sums.chars[4 * k + 1], zero, 0
        for i in range(rows):
            for j in range(2 * columns):
                a, m = e1 + 2 * i, signed(e2, j)
                size = term(lattice.bases, a, m)
                if size > top:
                    top, phase = size, sixteenths(lattice.turns, a, m)
        tops[k] = top
        for i in range(rows):
            sums.lengths[k * rows + i] = 0
            for j in range(2 * columns):
                a, m = e1 + 2 * i, signed(e2, j)
                # the terms of n and −n are combined
                if (m == 0 and j % 2 == 1) or (a == 0 and m < 0):
                    continue
                w, turned = term(lattice.bases, a, m) / top, sixteenths(lattice.turns, a, m) - phase
                real = real and turned % 8 == 0
                if w > LEAST:
                    sums.lengths[k * rows + i] = j // 2 + 1
                add_weight(sums, lattice.along, (k, i, j), w * weight_sign(sums.chars, k, turned, a, m))
    return real


def add_weight(sums: ThetaSums, along: Row, place: tuple[int, int, int], w: Real) -> None:
    """Adds the weight of row i and signed column j of class k, (k, i, j) = ``place``, to its entry."""
    k, i, j = place
    _, rows, columns = sums.sizes
    a, m = sums.chars[4 * k] + 2 * i, signed(sums.chars[4 * k + 1], j)
    rate = (a * along[0] + m * along[1]) * w
    if not is_odd(sums.chars, k):
        rate = -rate
    sign, start = 1 - 2 * (j % 2), 4 * ((k * rows + i) * columns + j // 2)
    table = sums.table
    table[start], table[start + 1] = table[start] + w, table[start + 1] + sign * w
    table[start + 2], table[start + 3] = table[start + 2] + rate, table[start + 3] + sign * rate


def signed(e2: int, j: int) -> int:
    """The j-th of the column numbers e₂, −e₂, e₂ + 2, −e₂ − 2, …."""
    m = e2 + 2 * (j // 2)
    return m if j % 2 == 0 else -m


def weight_sign(chars: Row, k: int, turned: int, a: int, m: int) -> int:
    """The sign of a term of class k, times 2 if the term stands for n and −n."""
    d = (a * chars[4 * k + 2] + m * chars[4 * k + 3]) % 4
    sign = 1 if (turned % 16 != 0) == (d == 1 or d == 2) else -1
    return 2 * sign if a != 0 or m != 0 else sign


def sixteenths(turns: tuple[int, int, int], a: int, m: int) -> int:
    """The phase of a term from Re τ, in sixteenths of a turn."""
    return a * a * turns[0] + 2 * a * m * turns[1] + m * m * turns[2]


def term(bases: Row, a: int, m: int) -> Real:
    """The size e^(−πnYn) of the term of n = (a, m)/2."""
    mixed = raised(bases[2], a * m) if m > 0 else raised(bases[3], -a * m)
    return raised(bases[0], a * a) * raised(bases[1], m * m) * mixed


def raised(x: Real, n: int) -> Real:
    """x^n for n ≥ 0."""
    found = 1 + 0 * x
    while n > 0:
        if n % 2 == 1:
            found = found * x
        x, n = x * x, n // 2
    return found


_SUMS = record(ThetaSums, WIDES, TupleKind((INT, INT, INT)), INTS, INTS, WIDES)
_LATTICE = record(Lattice, WIDES, WIDES, TupleKind((INT, INT, INT)))
LIBRARY = Library(
    "theta",
    {"theta_lifts": (theta_lifts, (_SUMS, WIDES, WIDES)), "theta_weights": (theta_weights, (_LATTICE, _SUMS, WIDES))},
    SPECIAL,
)


def theta_sums(
    tau: Sequence[Sequence[Complex]], chars: Sequence[Whole], along: Sequence[Complex]
) -> tuple[ThetaSums, np.ndarray]:
    """The weights of the characteristics ``chars``, and the largest term of each class, by which they are divided.

    Derivatives are ``along`` a direction in z.
    """
    import gmpy2

    (y11, y12), (_, y22) = ([x.imag for x in row] for row in tau)
    area = float(y11 * y22 - y12**2)
    widest = [2 * (DEPTH * float(y) / area) ** 0.5 for y in (y22, y11)]
    if max(widest) > 2 * MOST_HARMONICS:
        raise PrecisionLoss("theta functions of this motion have too many terms: branch points nearly meet")
    sizes = len(chars), int(widest[0]) // 2 + 2, int(widest[1]) // 2 + 2
    turn = half_turn()
    bases = double_double_row([gmpy2.exp(-turn * y / 4) for y in (y11, y22, 2 * y12, -2 * y12)])
    turns = [round(2 * float(x.real)) for x in (tau[0][0], tau[0][1], tau[1][1])]
    lattice = Lattice(bases, double_double_row([turn * x for x in along]), (turns[0], turns[1], turns[2]))
    count = sizes[0] * sizes[1]
    sums = ThetaSums(
        np.empty((4 * count * sizes[2], 2)),
        sizes,
        np.empty(count, dtype=np.int64),
        np.ravel(chars),
        inverse_factorials(),
    )
    tops = np.empty((sizes[0], 2))
    if not LIBRARY.theta_weights(lattice, sums, tops):
        raise PrecisionLoss("theta functions of this motion are not real")
    return sums, tops
