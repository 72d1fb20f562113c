"""Endomorphisms of a Jacobian over the complex numbers, found from its period matrix.

An endomorphism is an integer 2g × 2g matrix R with A·Π = Π·R for some g × g matrix A, where Π = (Π_1, Π_2) are the
periods. With τ = Π_1⁻¹Π_2 and R = (a, b; c, d) this is equivalent to b + τd − aτ − τcτ = 0, which is linear in R. So
integer solutions are found as small vectors of a lattice (Lenstra, Lenstra & Lovász 1982; van Wamelen 1999). An
endomorphism is defined over QQ if A is rational, because the x^k dx/Y are a basis of the differentials over QQ.
Integral combinations of the R with integral A are found as small vectors of another lattice.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any, NamedTuple

from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import FieldError, Infeasible, PrecisionLoss, shown, whole
from jacobian.fields import QQ
from jacobian.periods.matrix import PeriodMatrix, nearest
from jacobian.periods.proven import period_balls

Integers = tuple[tuple[int, ...], ...]

LEAST_DIGITS = 40
"""The fewest digits accepted. Small vectors that are no relations have entries of about 10^(digits/2)."""
MOST_GENUS = 4
"""The largest genus: LLL takes some 5 s in genus 4 and cannot be interrupted; its time grows like g^8 or more."""
SMALL = 4
"""A relation has entries below 10^(digits/SMALL)."""


class Endomorphisms(NamedTuple):
    """The endomorphisms of a Jacobian found from its ``periods``.

    ``matrices``: a ℤ-basis R_i of the ring over the complex numbers, each by its action on the cycles of ``periods``.
    ``rational``: integer vectors c for which the Σ c_i R_i are a QQ-basis of the endomorphisms over QQ. ``digits``:
    the number of digits to which b + τd − aτ − τcτ = 0 holds for every R_i = (a, b; c, d), relative to the largest
    entries that R_i may have.
    """

    periods: PeriodMatrix
    matrices: tuple[Integers, ...]
    rational: tuple[tuple[int, ...], ...]
    digits: int

    def over_the_rationals(self) -> list[Integers]:
        """A QQ-basis of the endomorphisms over QQ, each as a matrix of its action on the cycles."""
        size = range(len(self.matrices[0]))
        return [
            tuple(tuple(sum(m * R[i][j] for m, R in zip(c, self.matrices, strict=True)) for j in size) for i in size)
            for c in self.rational
        ]


def endomorphisms(C: HyperellipticCurve, digits: int = 100) -> Endomorphisms:
    """The endomorphisms of the Jacobian of a curve over QQ, found from periods in balls with this many digits.

    They are numerical evidence: integer matrices R with A·Π = Π·R for the periods Π and some A. Entries of R have at
    most ``digits``/4 digits. Relative to the largest such number the equation holds to some four fifths of
    ``digits``. PrecisionLoss if a small relation does not hold; FieldError over other fields; Infeasible if g > 4.
    """
    if C.field != QQ:
        raise FieldError(f"field = {C.field.name}: endomorphisms are looked for on curves over QQ")
    if C.genus > MOST_GENUS:
        raise Infeasible(f"genus {C.genus}: endomorphisms are looked for up to genus {MOST_GENUS}")
    digits = whole(digits, "digits", f"the digits are an int, {LEAST_DIGITS} … 2000", LEAST_DIGITS, 2000)
    P, g = period_balls(C, digits), C.genus
    kept = digits - digits // 10
    with P.cover.numbers.working():
        rows = _equations(P.tau, g)
        found = [_blocks(v, g) for v in _relations(rows, kept)]
        tangents = [_tangent(P, R) for R in found]
        if not all(_holds(P, A, R, kept) for A, R in zip(tangents, found, strict=True)):
            raise PrecisionLoss(
                f"digits = {shown(digits)}: a small relation was found that does not hold; use more digits"
            )
        whole_ones = [[P.cover.numbers.convert(-int(i == j)) for j in range(g * g)] for i in range(g * g)]
        rational = [v[: len(found)] for v in _relations([*(A.entries() for A in tangents), *whole_ones], kept)]
    return Endomorphisms(P, tuple(found), tuple(map(tuple, rational)), kept)


def _equations(tau: Any, g: int) -> list[list[Any]]:
    """The images b + τd − aτ − τcτ of the matrices R = (a, b; c, d) with a single entry 1, in the order a, b, c, d."""
    from flint import acb_mat

    t = acb_mat(tau)
    units = [acb_mat([[int((k, m) == at) for m in range(g)] for k in range(g)]) for at in product(range(g), repeat=2)]
    images = [[-E * t for E in units], units, [-t * E * t for E in units], [t * E for E in units]]
    return [image.entries() for block in images for image in block]


def _relations(rows: Sequence[Sequence[Any]], digits: int) -> list[list[int]]:
    """A basis of the small integer vectors v with Σ v_i·rows_i = 0 to ``digits`` digits."""
    from flint import arb, fmpz_mat

    scale, size = arb(10) ** digits, len(rows)

    def scaled(x: Any) -> list[int]:
        return [nearest(scale * part) for part in (x.real, x.imag)]

    identity = [[int(i == j) for j in range(size)] for i in range(size)]
    matrix = fmpz_mat([[*one, *(n for x in row for n in scaled(x))] for one, row in zip(identity, rows, strict=True)])
    bound = 10 ** (digits // SMALL)
    reduced = [[int(x) for x in row] for row in matrix.lll().tolist()]
    return [row[:size] for row in reduced if max(map(abs, row)) < bound]


def _blocks(v: Sequence[int], g: int) -> Integers:
    """The matrix (a, b; c, d) with the entries v of a, b, c, d in turn."""
    a, b, c, d = ([v[n * g * g + i * g : n * g * g + (i + 1) * g] for i in range(g)] for n in range(4))
    return tuple((*x, *y) for x, y in [*zip(a, b, strict=True), *zip(c, d, strict=True)])


def _tangent(P: PeriodMatrix, R: Integers) -> Any:
    """The matrix A of R on the tangent space: Π·(the first g columns of R)·Π_1⁻¹, an acb_mat."""
    from flint import acb_mat, fmpz_mat

    first = fmpz_mat([list(row[: P.cover.genus]) for row in R])
    return acb_mat(P.big) * acb_mat(first) * acb_mat(P.A).inv()


def _holds(P: PeriodMatrix, A: Any, R: Integers, digits: int) -> bool:
    """Whether A·Π = Π·R to nine tenths of this many digits, relative to the largest entries that R may have."""
    from flint import acb_mat, fmpz_mat

    big = acb_mat(P.big)
    off = A * big - big * acb_mat(fmpz_mat([list(row) for row in R]))
    size = P.cover.numbers.ten(-(digits - digits // 10) + digits // SMALL)
    return all(abs(x) < size for x in off.entries())
