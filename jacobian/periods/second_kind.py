"""Differentials of the second kind that complete x^k dx/Y, k < g, to a basis of de Rham cohomology, and their periods.

With Y² = F(x) = Σ F_i x^i = f + h²/4 they are ρ_j = r_j dx/Y, r_j = Σ_{k=j}^{2g+1−j} (k+1−j)·F_{k+1+j}·x^k/4, j = 1 … g
(Baker 1897; Buchstaber, Enolskii & Leykin 1997). Their poles are at infinity, without residues. Legendre's relation for
the periods (A, B) of the first kind and (E, H) of the second is A·Hᵀ − B·Eᵀ = 2πi.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from jacobian.periods.branched_cover import BranchedCover
from jacobian.periods.matrix import Matrix, PeriodMatrix
from jacobian.periods.quadrature import Vector


@dataclass(frozen=True, eq=False)
class SecondKind:
    """The differentials ρ_1 … ρ_g and their periods, in the numbers of the PeriodMatrix.

    ``polynomials``: the r_j, ascending, j = 1 … g; ``A`` and ``B``, the E and H of Legendre's relation: g×g tuples
    of rows, A[j][i] = ∮ ρ_(j+1) along a_i of the PeriodMatrix. The η and η′ of Weierstrass and Baker are −A/2, −B/2.
    """

    polynomials: tuple[tuple[Any, ...], ...]
    A: tuple[tuple[Any, ...], ...]
    B: tuple[tuple[Any, ...], ...]


def polynomials(cover: BranchedCover) -> Matrix:
    """The polynomials r_1 … r_g, each with 2g + 1 coefficients, as working numbers."""
    g, F = cover.genus, cover.coefficients
    zero = cover.numbers.convert(0)
    padded = [*F, *[zero] * (2 * g + 3 - len(F))]
    return [
        [(k + 1 - j) * padded[k + 1 + j] / 4 if j <= k <= 2 * g + 1 - j else zero for k in range(2 * g + 1)]
        for j in range(1, g + 1)
    ]


def second_kind(P: PeriodMatrix) -> SecondKind:
    """The differentials ρ_1 … ρ_g of the second kind, and their periods along the cycles of P, in its arithmetic."""
    cover, g = P.cover, P.cover.genus
    with cover.numbers.working():
        rows = polynomials(cover)
        edges = [moments(cover, edge.i, edge.j) for edge in P.edges]
        values = [[sum(c * x for c, x in zip(row, edge, strict=True)) for edge in edges] for row in rows]
        whole = [
            [2 * sum(m * x for m, x in zip(cycle, value, strict=True) if m) for cycle in P.cycles] for value in values
        ]
        first, last = ([row[part] for row in whole] for part in (slice(g), slice(g, None)))
        return SecondKind(cover.rounded(rows), cover.rounded(first), cover.rounded(last))


def moments(cover: BranchedCover, i: int, j: int) -> Vector:
    """The integrals of x^k dx/Y, k = 0 … 2g, from branch point i to j, on the sheet of :meth:`BranchedCover.edge`."""
    return cover.edge(i, j, 2 * cover.genus + 1).integrals
