"""Canonical heights in genus 2 over QQ with proven error bounds, regulators, and relations between points.

The canonical height is ĥ(D) = lim 4⁻ⁿ h(2ⁿD), where h is the logarithmic height on the Kummer surface. It belongs to
the divisor 2Θ, and its pairing ⟨D, E⟩ = (ĥ(D+E) − ĥ(D) − ĥ(E))/2 is that of Birch and Swinnerton-Dyer's conjecture.

With the doubling forms δ it is ĥ(D) = h(D) + Σ 4^(−n−1) (log |δ(x)| − 4 log |x| − log g), n = 0, 1, …, where x is the
primitive vector of κ(2ⁿD), |x| = max |x_i|, and g is the greatest common divisor of the δ_i(x) (Flynn & Smart 1997). x
is computed in real balls for |x|, and modulo a power of 16·disc(f) for g. Since g divides 16·disc(f), no factorization
is needed (after Müller & Stoll 2016). :mod:`jacobian.relatives.doubling_bounds` bounds the terms that are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import combinations
from math import inf, lcm, log
from typing import Any

from jacobian.element import Real
from jacobian.errors import ArgumentError, CurveMismatch, FieldError, PrecisionLoss, entries, shown, whole
from jacobian.fields import QQ
from jacobian.law.divisor import Divisor
from jacobian.numbers.long_reals import BallReals
from jacobian.progress import Progress
from jacobian.relatives.doubling_bounds import bad_part, largest, real_bounds
from jacobian.relatives.kummer import KummerSurface, kummer_surface

MOST_DIGITS = 1000
# bits that one doubling may lose
BITS_A_DOUBLING = 12
TRIALS = 5


def canonical_height(D: Divisor, digits: int = 20) -> Real:
    """The canonical height ĥ(D) of a class over QQ in genus 2, a ball (flint's arb) of radius at most 10^−digits.

    The time grows like the cube of the digits; 1000 digits, the most, take some ten seconds. A long computation shows
    its progress (:mod:`jacobian.progress`). FieldError for other curves, PrecisionLoss where the radius is not reached.
    """
    digits = whole(digits, "digits", f"the digits of a height are an int, 1 … {MOST_DIGITS}", 1, MOST_DIGITS)
    return _height(_checked(D, "D"), digits)


@lru_cache(maxsize=1024)
def _height(D: Divisor, digits: int) -> Any:
    surface = kummer_surface(D.jacobian.curve)
    x = surface.point(D)
    low, high = real_bounds(surface)
    bound = bad_part(surface)
    rest = (low - log(bound)) / 3, high / 3
    terms = 3 + int((digits * log(10) + log(1 + rest[1] - rest[0])) / log(4))
    bits = int(3.33 * digits) + BITS_A_DOUBLING * terms + 64
    for _ in range(TRIALS):
        reals = BallReals(bits)
        with reals:
            # the truncation error, from below and from above
            first, last = (reals.number(end) / 4**terms for end in rest)
            total = _sum(surface, x, terms, bound, reals) + first.union(last)
            if total.is_finite() and total.rad() * 10**digits < 1:
                return total
        bits *= 2
    raise PrecisionLoss(f"the canonical height of {D} is not known to {shown(digits)} digits with {bits // 2} bits")


def _sum(surface: KummerSurface, x: Sequence[int], terms: int, bound: int, reals: BallReals) -> Any:
    """log |x| + Σ 4^(−n−1) (log |δ(x)| − 4 log |x| − log g), n < ``terms``; ``bound``: 16·disc(f).

    The bits of the balls and the power of ``bound`` decrease with n, because later terms need less precision.
    """
    import gmpy2
    from flint import arb

    real, residues, modulus = [arb(c) for c in x], [gmpy2.mpz(c) for c in x], gmpy2.mpz(bound) ** (terms + 2)
    total, weight, progress = largest(real).log(), arb(1), Progress("a canonical height", terms**3)
    for n in range(terms):
        weight /= 4
        with reals.at(reals.bits - (BITS_A_DOUBLING + 2) * n):
            size = largest(real)
            real = [c / size.mid() for c in real]
            doubled, residues = surface.double(real), [c % modulus for c in surface.double(residues)]
            common = gmpy2.gcd(*residues, modulus)
            if bound % common:
                raise PrecisionLoss(
                    f"{surface.curve!r}: δ(x) has the divisor {common}, which does not divide 16·disc(f)"
                )
            modulus //= bound
            residues = [c // common % modulus for c in residues]
            term = largest(doubled).log() - 4 * largest(real).log() - arb(int(common)).log()
        total += weight * term
        real = doubled
        progress.add((terms - n) ** 3 - (terms - n - 1) ** 3)
    return total


def height_pairing(D: Divisor, E: Divisor, digits: int = 20) -> Real:
    """The height pairing ⟨D, E⟩ = (ĥ(D+E) − ĥ(D) − ĥ(E))/2, a ball; ⟨D, D⟩ = ĥ(D).

    Exceptions are those of :func:`canonical_height`.
    """
    if _checked(D, "D") == _checked(E, "E"):
        return canonical_height(D, digits)
    return pairings([D, E], digits)[0, 1]


def _checked(D: Any, argument: str) -> Divisor:
    if not isinstance(D, Divisor):
        raise ArgumentError(f"{argument} = {shown(D)}: a divisor class of a curve of genus 2 over QQ has a height")
    if D.jacobian.field != QQ:
        raise FieldError(f"{argument} = {shown(D)}: canonical heights are those of curves of genus 2 over QQ")
    return D


def regulator(classes: Sequence[Divisor], digits: int = 20) -> Real:
    """The determinant of the pairings of some classes, a ball; 1 for none. Each pairing has ``digits`` digits."""
    matrix = pairings(_of_one_group(classes), digits)
    with BallReals(64 + 4 * digits):
        return matrix.det()


def relation(classes: Sequence[Divisor], digits: int = 20) -> list[int] | None:
    """A relation of the classes: integers m, not all 0, with Σ m_i D_i of finite order; None if there is provably none.

    A determinant of pairings that is a ball without 0 proves independence. Otherwise a linear system of pairings gives
    the m_i up to a factor, as balls, which are rounded to fractions; that Σ m_i D_i has finite order is then proven
    exactly. PrecisionLoss where neither succeeds with this many digits.
    """
    classes = _of_one_group(classes)
    matrix = pairings(classes, digits)
    for k in range(len(classes)):
        found = dependence(matrix, classes[: k + 1], digits)
        if found is not None:
            m, n = found
            return [*(-c for c in m), n, *[0] * (len(classes) - len(m) - 1)]
    return None


def dependence(matrix: Any, classes: Sequence[Divisor], digits: int) -> tuple[list[int], int] | None:
    """(m, n), n > 0, with n·D − Σ m_i·D_i of finite order, where D is the last class and the D_i are the others, which
    are independent. None if D is provably independent of them. ``matrix``: the pairings of the classes, and possibly
    further rows and columns.
    """
    from flint import arb_mat

    *basis, D = classes
    size = len(basis)
    with BallReals(64 + 4 * digits):
        rows = [[matrix[i, j] for j in range(size + 1)] for i in range(size + 1)]
        if not arb_mat(rows).det().contains(0):
            return None
        ratios = []
        if basis:
            ratios = arb_mat([row[:size] for row in rows[:size]]).solve(arb_mat([row[size:] for row in rows[:size]]))
            middles = (x.mid().fmpq() for x in ratios.entries())
            ratios = [Fraction(int(x.p), int(x.q)).limit_denominator(10 ** (digits // 3)) for x in middles]
    n = lcm(*(c.denominator for c in ratios))
    m = [int(n * c) for c in ratios]
    if (n * D - sum((c * G for c, G in zip(m, basis, strict=True)), D.jacobian.zero())).order() != inf:
        return m, n
    raise PrecisionLoss(f"the classes are neither independent nor dependent to {shown(digits)} digits; use more")


def _of_one_group(classes: Sequence[Divisor]) -> list[Divisor]:
    given = entries(classes, "classes", "a sequence of divisor classes")
    for D in given:
        if not isinstance(D, Divisor):
            raise ArgumentError(f"classes: {shown(D)} is no divisor class")
        if D.jacobian.curve != given[0].jacobian.curve:
            raise CurveMismatch(f"classes: {shown(D)} and {shown(given[0])} lie on different curves")
    return given


def pairings(classes: Sequence[Divisor], digits: int) -> Any:
    """The matrix of the pairings ⟨D_i, D_j⟩ of the classes (flint's arb_mat), from heights with ``digits`` digits."""
    from flint import arb_mat

    size = len(classes)
    rows: list[list[Any]] = [[0] * size for _ in range(size)]
    heights = [canonical_height(D, digits) for D in classes]
    for i, height in enumerate(heights):
        rows[i][i] = height
    for i, j in combinations(range(size), 2):
        both = canonical_height(classes[i] + classes[j], digits)
        with BallReals(64 + 4 * digits):
            rows[i][j] = rows[j][i] = (both - heights[i] - heights[j]) / 2
    return arb_mat(rows)
