"""Period matrices in balls: every entry with a proven bound of its error."""

from __future__ import annotations

from typing import Any

from jacobian.curve.curve import HyperellipticCurve, check_curve
from jacobian.errors import PrecisionLoss, shown, whole
from jacobian.periods.ball_cover import BallCover
from jacobian.periods.matrix import PeriodMatrix, period_matrix

MOST_DIGITS = 10_000
# the number of precisions that are tried, each twice the last, until the radii are small enough
TRIALS = 6


def period_balls(curve: HyperellipticCurve, digits: int = 30) -> PeriodMatrix:
    """The PeriodMatrix of a curve over QQ, RR, CC or MP(dps), of any genus, in balls (python-flint's acb).

    The coefficients are taken as exact. Radii are at most 10^−digits of the largest entry of (A, B); each ball contains
    the exact number, and the cycles cross as a symplectic basis does. ArgumentError for real coefficients with a double
    branch point, PrecisionLoss where the branch points are not separated.
    """
    digits = whole(digits, "digits", f"the digits of the periods are an int, 1 … {MOST_DIGITS}", 1, MOST_DIGITS)
    bits = int(3.33 * digits) + 24 + 4 * check_curve(curve).genus
    for _ in range(TRIALS):
        try:
            cover = BallCover(curve, bits)
            with cover.numbers.working():
                found = period_matrix(cover, (period_balls, (curve, digits)))
                if is_within(found.big, cover.numbers.ten(-digits) * largest(found)):
                    return found
        except PrecisionLoss as error:
            failure: Exception = error
        else:
            failure = PrecisionLoss("the radii are too large")
        bits *= 2
    raise PrecisionLoss(f"{curve!r}: no periods with {shown(digits)} digits from {bits // 2} bits ({failure})")


def largest(found: PeriodMatrix) -> Any:
    """The largest modulus of an entry of (A, B)."""
    return max((abs(x) for row in found.big for x in row), key=float)


def is_within(rows: Any, bound: Any) -> bool:
    """Whether the radii of all balls in ``rows`` are at most ``bound``."""
    return all(x.is_finite() and x.rad() <= bound for row in rows for x in row)
