"""Period matrices reduced by Sp(2g, ℤ), so that theta series converge fast (Siegel 1964; Deconinck and others 2004, who
reduce Im τ by LLL).
"""

from __future__ import annotations

from typing import Any, NamedTuple

from jacobian.errors import ArgumentError, PrecisionLoss, shown
from jacobian.periods.ball_cover import BallCover
from jacobian.periods.matrix import PeriodMatrix

MOST_STEPS = 1000
# Im τ is rounded to integers of this many bits for LLL
GRAM_BITS = 40


class SiegelReduced(NamedTuple):
    """A reduced period matrix.

    ``tau``: (aτ + b)(cτ + d)⁻¹ as a flint acb_mat, for ``acb_mat.theta``; ``matrix``: (a b; c d) in Sp(2g, ℤ), an
    fmpz_mat of 2g×2g.
    """

    tau: Any
    matrix: Any


def siegel_reduced(found: PeriodMatrix) -> SiegelReduced:
    """The reduced τ of a period matrix in balls: Im τ reduced by LLL, |Re τ_ij| ≤ ½, |τ_11| ≥ 0.999, up to the radii.

    The matrix in Sp(2g, ℤ) is exact, so each ball of ``tau`` contains the exact entry of (aτ + b)(cτ + d)⁻¹.
    ArgumentError for a period matrix in floats, whose errors are not known.
    """
    from flint import acb_mat, fmpz_mat

    if not isinstance(found, PeriodMatrix) or not isinstance(found.cover, BallCover):
        raise ArgumentError(f"found = {shown(found)}: a period matrix in balls is needed, such as period_balls(C)")
    g = found.cover.genus
    matrix = fmpz_mat([[int(i == j) for j in range(2 * g)] for i in range(2 * g)])
    with found.cover.numbers.working():
        tau = acb_mat(found.tau)
        for _ in range(MOST_STEPS):
            matrix = _lll(_moved(matrix, tau)) * matrix
            matrix = _shift(_moved(matrix, tau)) * matrix
            moved = _moved(matrix, tau)
            if not abs(moved[0, 0]) < 0.999:
                return SiegelReduced(moved, matrix)
            matrix = _inversion(g) * matrix
    raise PrecisionLoss(f"τ is not reduced in {MOST_STEPS} steps; use more digits")


def _moved(matrix: Any, tau: Any) -> Any:
    """The image (aτ + b)(cτ + d)⁻¹ of τ under the matrix (a b; c d)."""
    from flint import acb_mat

    g = tau.nrows()
    a, b, c, d = (acb_mat([[matrix[i + p, j + q] for j in range(g)] for i in range(g)]) for p in (0, g) for q in (0, g))
    return (a * tau + b) * (c * tau + d).inv()


def _lll(tau: Any) -> Any:
    """The matrix of τ ↦ TτTᵀ for the T that reduces Im τ by LLL."""
    from flint import fmpz_mat

    g = tau.nrows()
    scale = 2.0**GRAM_BITS / max(float(tau[i, i].imag) for i in range(g))
    half = [[round(scale * float(tau[i, j].imag) / 2) for j in range(g)] for i in range(g)]
    gram = fmpz_mat([[half[i][j] + half[j][i] for j in range(g)] for i in range(g)])
    _, T = gram.lll(transform=True, rep="gram")
    inverse = T.inv().transpose()
    zero = [0] * g
    upper = [[*row, *zero] for row in T.tolist()]
    return fmpz_mat(upper + [[*zero, *(int(x.p) for x in row)] for row in inverse.tolist()])


def _shift(tau: Any) -> Any:
    """The matrix of τ ↦ τ + S with |Re τ_ij + S_ij| ≤ ½, S integral and symmetric."""
    from flint import fmpz_mat

    g = tau.nrows()
    rows = [[int(i == j) for j in range(2 * g)] for i in range(2 * g)]
    for i in range(g):
        for j in range(i + 1):
            rows[i][g + j] = rows[j][g + i] = -round(float(tau[i, j].real))
    return fmpz_mat(rows)


def _inversion(g: int) -> Any:
    """The matrix that exchanges a_1 and b_1 up to sign: it maps τ_11 to −1/τ_11."""
    from flint import fmpz_mat

    rows = [[int(i == j) for j in range(2 * g)] for i in range(2 * g)]
    rows[0][0] = rows[g][g] = 0
    rows[0][g], rows[g][0] = -1, 1
    return fmpz_mat(rows)
