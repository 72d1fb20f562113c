"""Period matrices as other programs write them, and changes between bases of the cycles.

All programs have g rows of 2g integrals, (∮ along a_1 … a_g, b_1 … b_g), with a_i·b_j = δ_ij. Their differentials
differ:

* here x^k dx/(y + h/2);
* Magma, ``BigPeriodMatrix(AnalyticJacobian(f))``: x^k dx/y on y² = f; for a curve with h, on y² = 4f + h²;
* Sage, ``RiemannSurface(y^2 + h*y - f).period_matrix()``, and the LMFDB: x^k dx divided by 2y + h.

Each program chooses its own cycles: its matrix is (A, B)·M with M in Sp(2g, ℤ).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from jacobian.errors import ArgumentError, one_of, shown
from jacobian.periods.matrix import PeriodMatrix, nearest

PROGRAMS = ("magma", "sage")


def in_convention(P: PeriodMatrix, program: str) -> tuple[tuple[Any, ...], ...]:
    """The period matrix (A, B) for the differentials of "magma" or "sage": g rows of 2g numbers or balls."""
    size = _size(P, program)
    with P.cover.numbers.working():
        return tuple(tuple(x * size for x in row) for row in P.big)


def change_of_cycles(P: PeriodMatrix, other: Sequence[Sequence[Any]], program: str | None = None) -> list[list[int]]:
    """The matrix M in Sp(2g, ℤ) with other = (A, B)·M, (A, B) being the periods P.

    ``other``: a period matrix of the same curve, g rows of 2g numbers, correct to at least 4 digits; else
    ArgumentError. ``program``: "magma" or "sage", whose differentials ``other`` has; None for those of this package.
    """
    g, size = P.cover.genus, _size(P, program)
    rows = [list(row) for row in other]
    if [len(row) for row in rows] != [2 * g] * g:
        raise ArgumentError(f"other = {shown(other)}: {g} rows of {2 * g} numbers are needed")
    columns = []
    with P.cover.numbers.working():
        for column in zip(*rows, strict=True):
            found = whole_coordinates(P, [P.cover.numbers.convert(x) / size for x in column])
            if found is None:
                raise ArgumentError(f"other: {shown(column)} is no period of {P.cover.curve!r}")
            columns.append(found)
    if _crossings(columns, g) != _crossings([[int(i == j) for j in range(2 * g)] for i in range(2 * g)], g):
        raise ArgumentError(f"other: its cycles do not cross as a symplectic basis does: {shown(columns)}")
    return [list(row) for row in zip(*columns, strict=True)]


def whole_coordinates(P: PeriodMatrix, z: Sequence[Any]) -> list[int] | None:
    """The integers n with z = (A, B)·n, or None if a coordinate of z differs from every integer by 10⁻³ or more."""
    found = P.coordinates(z)
    whole = [nearest(c) for c in found]
    return whole if all(abs(complex(c - n)) < 1e-3 for c, n in zip(found, whole, strict=True)) else None


def _size(P: PeriodMatrix, program: str | None) -> Any:
    """The quotient of the program's differentials by those of this package."""
    if program is None:
        return 1
    one_of(program, "program", PROGRAMS, '"magma" or "sage" is needed')
    return 1 if program == "magma" and not P.cover.curve.h else P.cover.numbers.real(1) / 2


def _crossings(columns: list[list[int]], g: int) -> list[list[int]]:
    return [[sum(v[k] * w[g + k] - v[g + k] * w[k] for k in range(g)) for w in columns] for v in columns]
