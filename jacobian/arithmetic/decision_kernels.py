"""L-polynomials from their coefficients modulo p, for one prime after another, by the group law: loops to be compiled.

If a_1 is known, and a_2 and a_3 modulo p, the order of J(GF(p)) is c + p·t + p(p + 1)·s with a known c and small s and
t; in genus 2, s = 0. For the quadratic twist, a_1 and a_3 change signs. An abscissa x_0 gives a class D without a
square root: D is ∞₊ − ∞₋ on y² = G(t), G(t) = t^(2g+2)·F(x_0 + 1/t)/F(x_0). This curve is isomorphic to the given curve
if F(x_0) is a square modulo p, else to its twist. Baby steps and giant steps along p·D give all pairs (s, t) for which
the order annihilates D. Classes of other x_0 eliminate wrong pairs. The right pair is never eliminated, so a single
remaining pair is the right one.

The group law is that of :mod:`jacobian.arithmetic.desk`.
"""

from __future__ import annotations

from math import ceil, floor, sqrt
from typing import Any

from jacobian.addition.cantor_words import negate_class
from jacobian.arithmetic.desk import class_at, copy, multiply, plus, same, set_class
from jacobian.numbers.words import OneWord

MOST = 64
"""The largest number of candidates that are kept."""
POINTS = 12
"""The largest number of abscissas x_0 that are tried for a prime."""


def decide(equations: Any, residues: Any, desk: Any, out: Any, begin: int, end: int) -> None:
    """Completes the rows (p, a_1, … a_g, the number of remaining candidates) of ``out`` from begin to end.

    ``out`` already contains p; ``residues`` are a_1 and the other a_i modulo p, ``equations`` the coefficients of F
    modulo p. With one remaining candidate the a_i are known. With none, ``residues`` are wrong.
    """
    g = residues.shape[1]
    for k in range(begin, end):
        p = out[k, 0]
        K = OneWord(p, 1)
        for i in range(len(desk.F)):
            desk.F[i] = equations[k, i]
        a1, a3 = residues[k, 0], residues[k, 2] if g == 3 else 0
        a2, rows = ranges_of(g, p, (a1, residues[k, 1], a3), desk.ranges)
        count, x, tried = -1, 0, 0
        while count != 0 and count != 1 and tried < POINTS and x < p:
            sign = class_at(K, (a1, a2, a3), x, desk)
            x += 1
            if sign != 0:
                tried += 1
                count = search(K, sign, rows, desk) if count < 0 else sift(K, sign, count, desk)
        out[k, g + 1] = count
        out[k, 1], out[k, 2] = a1, a2
        if count == 1:
            s, t = desk.found[0, 0], desk.found[0, 1]
            out[k, 2] = a2 + (t if g == 2 else s) * p
            if g == 3:
                out[k, 3] = a3 + t * p


# --- the range of Weil's bounds


def ranges_of(g: int, p: int, a: Any, ranges: Any) -> Any:
    """Returns the least possible a_2 with the given residue, and the number of values of s. Writes the least and the
    largest t for each s into ``ranges``. Candidates are a_2 + t·p in genus 2, where s = 0, and (a_2 + s·p, a_3 + t·p)
    in genus 3.

    The bounds hold because the roots of R = z^g + r_1 z^(g−1) + … (:mod:`jacobian.finite.weil`) are real and at most
    2√p in size.
    """
    a1, a2, a3 = a
    q, r1, root = float(p), float(a1), sqrt(float(p))
    if g == 2:
        low, high = 2.0 * abs(r1) * root - 2.0 * q, r1 * r1 / 4.0 + 2.0 * q
    else:
        low = -q if abs(r1) <= 2.0 * root else 4.0 * abs(r1) * root - 9.0 * q
        high = r1 * r1 / 3.0 + 3.0 * q
    least = ceil(low - 0.001)
    a2 = least + (a2 - least) % p
    rows = (floor(high + 0.001) - a2) // p + 1
    if g == 2:
        ranges[0, 0], ranges[0, 1] = 0, rows - 1
        return a2, 1
    rows = max(rows, 0)
    for s in range(rows):
        r2, end = float(a2 + s * p) - 3.0 * q, 2.0 * root
        turn = sqrt(max(0.0, r1 * r1 - 3.0 * r2))
        z1, z2 = (-r1 - turn) / 3.0, (-r1 + turn) / 3.0
        bottom = max(-cubic_part(z1, r1, r2), -cubic_part(end, r1, r2))
        top = min(-cubic_part(z2, r1, r2), -cubic_part(-end, r1, r2))
        shift, margin = 2.0 * q * r1 - float(a3), 1.0 + 1e-9 * q * root
        ranges[s, 0], ranges[s, 1] = ceil((bottom - margin + shift) / q), floor((top + margin + shift) / q)
    return a2, rows


def cubic_part(z: float, r1: float, r2: float) -> float:
    """z³ + r_1 z² + r_2 z."""
    return ((z + r1) * z + r2) * z


# --- baby steps and giant steps


def search(K: Any, sign: int, rows: int, desk: Any) -> int:
    """Finds all candidates (s, t), s < ``rows``, for which the group's order annihilates D; returns their number.

    ``sign``: 1 if D is a class of the curve, −1 if of the twist. The returned number −1 stands for more than MOST.
    """
    g, classes = desk.curve[0], desk.classes
    place, giant = classes[6], classes[7]
    baby, size = baby_steps(K, rows, desk)
    negate_class(K, desk.curve, desk.scratch, place, giant)
    count = 0
    for s in range(rows):
        if s > 0:
            plus(K, desk, classes[2], classes[1], classes[2])
        length = desk.ranges[s, 1] - desk.ranges[s, 0] + 1
        begin = desk.ranges[s, 0] if g == 2 else s + (desk.ranges[s, 0] if sign > 0 else -desk.ranges[s, 1])
        if length > 0:
            multiply(K, desk, begin, classes[0], place)
            plus(K, desk, place, classes[2], place)
        j = 0
        while j < length:
            i = found_step(desk, place, size)
            if i >= 0 and j + i < length:
                if count == MOST:
                    return -1
                e = begin + j + i
                desk.found[count, 0] = s
                desk.found[count, 1] = e if g == 2 else sign * (e - s)
                count += 1
            j += baby
            plus(K, desk, place, giant, place)
    return count


def baby_steps(K: Any, rows: int, desk: Any) -> Any:
    """Writes the baby steps 0, −pD, −2pD, … and their hash table; returns their number and the size of the table.

    The step after the last is the giant step; it is written to ``desk.classes[6]``. The number of steps is about the
    square root of the number of candidates. If the order of pD is smaller than this number, the steps are all multiples
    of pD, and the giant step is 0.
    """
    classes, table, total, baby, size = desk.classes, desk.table, 0, 1, 4
    for s in range(rows):
        total += max(0, desk.ranges[s, 1] - desk.ranges[s, 0] + 1)
    while baby * baby < total and baby < len(desk.steps):
        baby += 1
    while size < 2 * baby:
        size *= 2
    for i in range(size):
        table[i] = -1
    zero, place = (desk.curve[0] + 1) // 2, classes[6]
    negate_class(K, desk.curve, desk.scratch, classes[0], classes[3])
    set_class(K, desk.curve[0], zero, place)
    for i in range(baby):
        if i > 0 and place[0] == 1 and place[2] == zero:
            return i, size
        copy(place, desk.steps[i])
        at = place_of(place, size)
        while table[at] >= 0:
            at = (at + 1) % size
        table[at] = i
        plus(K, desk, place, classes[3], place)
    return baby, size


def place_of(a: Any, size: int) -> int:
    """The index at which the search for the class ``a`` begins, in a hash table of ``size`` entries."""
    h = a[2]
    for i in range(3, len(a)):
        h = (h * 1000003 + a[i]) % 2147483647
    return h % size


def found_step(desk: Any, place: Any, size: int) -> int:
    """The index of the baby step that equals the class ``place``; −1 if there is none."""
    at = place_of(place, size)
    while desk.table[at] >= 0:
        i = desk.table[at]
        if same(desk.steps[i], place):
            return i
        at = (at + 1) % size
    return -1


def sift(K: Any, sign: int, count: int, desk: Any) -> int:
    """Moves those candidates (s, t) whose group order annihilates the class D of the desk to the front of
    ``desk.found``, and returns their number.
    """
    g, classes, found, left = desk.curve[0], desk.classes, desk.found, 0
    place, other = classes[6], classes[7]
    for n in range(count):
        s, t = found[n, 0], found[n, 1]
        multiply(K, desk, t if g == 2 else s + sign * t, classes[0], place)
        plus(K, desk, place, classes[2], place)
        multiply(K, desk, s, classes[1], other)
        plus(K, desk, place, other, place)
        if place[0] == 1 and place[2] == (g + 1) // 2:
            found[left, 0], found[left, 1] = s, t
            left += 1
    return left
