"""The real period: the volume of J(ℝ) for the differentials x^k dx/(2y + h)."""

from __future__ import annotations

from typing import Any

from jacobian.errors import ArgumentError, PrecisionLoss, shown
from jacobian.periods.ball_cover import BallCover
from jacobian.periods.conventions import whole_coordinates
from jacobian.periods.matrix import PeriodMatrix


def real_period(P: PeriodMatrix) -> Any:
    """The real period Ω = ∫ |ω_0 ∧ … ∧ ω_(g−1)| over J(ℝ), ω_k = x^k dx/(2y + h), a ball.

    P must be in balls, of a curve over the reals; else ArgumentError. If the equation is minimal, Ω is the period of
    Birch and Swinnerton-Dyer's conjecture. The traces z + z̄ of the periods z of the ω_k form a lattice, whose volume
    is Ω. A basis of this lattice is known exactly, since conjugation acts on the cycles by an integral matrix.
    """
    from flint import arb_mat, fmpz_mat

    if not isinstance(P, PeriodMatrix) or not isinstance(P.cover, BallCover) or not P.cover.real:
        raise ArgumentError(f"P = {shown(P)}: a period matrix in balls is needed, of a curve over QQ, RR or MP(dps)")
    with P.cover.numbers.working():
        conjugates = [whole_coordinates(P, [x.conjugate() for x in column]) for column in zip(*P.big, strict=True)]
        if None in conjugates:
            raise PrecisionLoss("the conjugate cycles cannot be distinguished from others; use more digits")
        traces = [[c + (i == j) for i, c in enumerate(found or [])] for j, found in enumerate(conjugates)]
        basis = [row for row in fmpz_mat(traces).hnf().tolist() if any(row)]
        # the cycles of the basis are sums γ + γ̄, with real periods; P has twice the periods of x^k dx/(2y + h)
        half = [[sum(int(n) * x.real for n, x in zip(v, row, strict=True)) / 2 for row in P.big] for v in basis]
        return abs(arb_mat(half).det())
