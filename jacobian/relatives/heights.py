"""Canonical heights in genus 2 over QQ with proven error bounds, regulators, and relations between points.

ĥ(D) = lim 4⁻ⁿ h(2ⁿD), h the logarithmic height on the Kummer surface: the height of the divisor 2Θ, whose pairing
⟨D, E⟩ = (ĥ(D+E) − ĥ(D) − ĥ(E))/2 is that of Birch and Swinnerton-Dyer's conjecture. By the doubling forms δ it is
h(D) + Σ 4^(−n−1) (log |δ(x)| − 4 log |x| − log g) over x, the primitive vectors of the 2ⁿD, g being the common divisor
of δ(x) (Flynn & Smart 1997). The x are kept as real balls, and modulo a power of 16·disc(f), of which g is a divisor:
no prime has to be known (after Müller & Stoll 2016). The rest of the sum is bounded by
:mod:`jacobian.relatives.doubling_bounds`.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import gcd, inf, log
from typing import Any

from jacobian.errors import ArgumentError, CurveMismatch, FieldError, PrecisionLoss, entries, shown, whole
from jacobian.fields import QQ
from jacobian.law.divisor import Divisor
from jacobian.numbers.long_reals import BallReals
from jacobian.relatives.doubling_bounds import bad_part, real_bounds
from jacobian.relatives.kummer import KummerSurface, kummer_surface

MOST_DIGITS = 1000
# bits that a doubling may cost
BITS_A_DOUBLING = 12
TRIALS = 5


def canonical_height(D: Divisor, digits: int = 20) -> Any:
    """ĥ(D) for a class over QQ in genus 2: a ball (flint's arb) of radius at most 10^−digits.

    FieldError for other curves, PrecisionLoss where the radius is not reached.
    """
    digits = whole(digits, "digits", f"the digits of a height are an int, 1 … {MOST_DIGITS}", 1, MOST_DIGITS)
    surface = kummer_surface(_checked(D, "D").jacobian.curve)
    x = surface.point(D)
    low, high = real_bounds(surface)
    bound = bad_part(surface)
    rest = (low - log(bound)) / 3, high / 3
    terms = 3 + int((digits * log(10) + log(1 + rest[1] - rest[0])) / log(4))
    bits = int(3.33 * digits) + BITS_A_DOUBLING * terms + 64
    for _ in range(TRIALS):
        with BallReals(bits) as reals:
            # what is left out, from below and from above
            first, last = (reals.number(end) / 4**terms for end in rest)
            total = _sum(surface, x, terms, bound) + first.union(last)
            if total.is_finite() and total.rad() * 10**digits < 1:
                return total
        bits *= 2
    raise PrecisionLoss(f"the canonical height of {D} is not known to {digits} digits with {bits // 2} bits")


def _sum(surface: KummerSurface, x: Sequence[int], terms: int, bound: int) -> Any:
    """log |x| + Σ 4^(−n−1) (log |δ(x)| − 4 log |x| − log g) over the first terms."""
    from flint import arb

    real, residues, modulus = [arb(c) for c in x], list(x), bound ** (terms + 2)
    size = _largest(real)
    total, weight = size.log(), arb(1)
    for _ in range(terms):
        weight /= 4
        real = [c / size.mid() for c in real]
        doubled, residues = surface.double(real), [c % modulus for c in surface.double(residues)]
        common = gcd(*residues, modulus)
        if bound % common:
            raise PrecisionLoss(f"{surface.curve!r}: δ(x) has the divisor {common}, which is none of 16·disc(f)")
        modulus //= common
        residues = [c // common % modulus for c in residues]
        before, size = _largest(real), _largest(doubled)
        total += weight * (size.log() - 4 * before.log() - arb(common).log())
        real = doubled
    return total


def _largest(values: Sequence[Any]) -> Any:
    found = abs(values[0])
    for x in values[1:]:
        found = found.max(abs(x))
    return found


def height_pairing(D: Divisor, E: Divisor, digits: int = 20) -> Any:
    """⟨D, E⟩ = (ĥ(D+E) − ĥ(D) − ĥ(E))/2 as a ball; ⟨D, D⟩ = ĥ(D). Errors as :func:`canonical_height`."""
    if _checked(D, "D") == _checked(E, "E"):
        return canonical_height(D, digits)
    both, first, second = (canonical_height(G, digits) for G in (D + E, D, E))
    return _polarized(both, first, second, digits)


def _polarized(both: Any, first: Any, second: Any, digits: int) -> Any:
    """⟨D, E⟩ from the heights of D + E, D and E."""
    with BallReals(64 + 4 * digits):
        return (both - first - second) / 2


def _checked(D: Any, argument: str) -> Divisor:
    if not isinstance(D, Divisor):
        raise ArgumentError(f"{argument} = {shown(D)}: a divisor class of a curve of genus 2 over QQ has a height")
    if D.jacobian.field != QQ:
        raise FieldError(f"{argument} = {D}: canonical heights are those of curves of genus 2 over QQ")
    return D


def regulator(classes: Sequence[Divisor], digits: int = 20) -> Any:
    """The determinant of the pairings of some classes, a ball; 1 for none. Each pairing has ``digits`` digits."""
    matrix = _pairings(_of_one_group(classes), digits)
    with BallReals(64 + 4 * digits):
        return matrix.det()


def relation(classes: Sequence[Divisor], digits: int = 20) -> list[int] | None:
    """None if the classes are proven to be independent, else integers m, not all 0, with Σ m_i D_i of finite order.

    Independent: the determinant of their pairings is a ball without 0. Dependent: a short vector of the lattice of
    pairings (Lenstra, Lenstra & Lovász 1982), whose sum is of finite order exactly. PrecisionLoss where neither is
    shown with so many digits.
    """
    classes = _of_one_group(classes)
    if not classes:
        return None
    matrix = _pairings(classes, digits)
    with BallReals(64 + 4 * digits):
        if not matrix.det().contains(0):
            return None
    for row in _short_vectors(matrix, digits):
        total = sum((m * D for m, D in zip(row, classes, strict=True)), classes[0].jacobian.zero())
        if any(row) and total.order() != inf:
            return row
    raise PrecisionLoss(f"the classes are neither independent nor dependent to {digits} digits; use more")


def _of_one_group(classes: Sequence[Divisor]) -> list[Divisor]:
    given = entries(classes, "classes", "a sequence of divisor classes")
    for D in given:
        if not isinstance(D, Divisor):
            raise ArgumentError(f"classes: {shown(D)} is no divisor class")
        if D.jacobian.curve != given[0].jacobian.curve:
            raise CurveMismatch(f"classes: {D} and {given[0]} lie on different curves")
    return given


def _pairings(classes: Sequence[Divisor], digits: int) -> Any:
    from flint import arb_mat

    size = len(classes)
    rows = [[0] * size for _ in range(size)]
    heights = [canonical_height(D, digits) for D in classes]
    for i, height in enumerate(heights):
        rows[i][i] = height
    for i, j in combinations(range(size), 2):
        both = canonical_height(classes[i] + classes[j], digits)
        rows[i][j] = rows[j][i] = _polarized(both, heights[i], heights[j], digits)
    return arb_mat(rows)


def _short_vectors(matrix: Any, digits: int) -> list[list[int]]:
    """Integer vectors, the shorter ones for the pairing first."""
    from flint import fmpz_mat

    size = matrix.nrows()
    scale = 10 ** (digits // 2)
    # rows (m, scale·matrix·m): of a relation the second half vanishes
    rows = [
        [*(int(i == j) for j in range(size)), *(int((scale * matrix[i, j].mid().fmpq()).floor()) for j in range(size))]
        for i in range(size)
    ]
    reduced = fmpz_mat(rows).lll()
    return [[int(reduced[i, j]) for j in range(size)] for i in range(size)]
