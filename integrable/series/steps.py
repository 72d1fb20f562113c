"""What a walk is asked for, and what it gives: the steps it takes, how far it goes, the rows it has reached."""

from __future__ import annotations

from fractions import Fraction
from math import log2
from typing import NamedTuple

import numpy as np

from integrable.series.room import Orders
from integrable.series.tape import PRODUCT, QUOTIENT, ROOT, Tape

# what a step takes beside its products, in these, and both for Neumann's point
FIXED, STANDARD = 3, 13
# a term of double-doubles, in those of floats
WIDE_TERM = 20


class Steps(NamedTuple):
    """Which terms a walk has, and what it leaves out beside each q and p: ``left_out`` by the last terms, ``rounded``
    the first one in floats; the second walk leaves out so many times as much; rows that agree to ``agreed`` are right.
    Times more than ``farthest`` first steps off are not walked to.
    """

    orders: Orders
    left_out: float
    rounded: float
    coarser: float
    rougher: float
    agreed: float
    farthest: float = 1e300


# right to the last bits of floats: an eighth of what they are rounded to is what rows may differ by, as terms in floats
# may be off by nearly as much in the finer walk
WIDE, WIDEST = Orders(8, 30), Orders(18, 44)
FINE, FINEST = Steps(WIDE, 1e-25, 1e-7, 1e1, 1e1, 2.0**-56), Steps(WIDEST, 1e-29, 1e-11, 1e3, 1e3, 2.0**-56)
# where few steps do, errors have no time to grow: three quarters of the time (python -m benchmarks near)
ROUGH = Steps(Orders(6, 26), 1e-21, 1e-5, 1e1, 1e1, 2.0**-56, 128.0)
PLAIN, MIDDLE = Orders(-1, 20), Orders(3, 24)
# beside a tolerance: what steps leave out, in floats, and where the first terms are double-doubles; the first term in
# floats there; how much more the second walk leaves out, and how many times what the two differ by an error may be
SHARE, SHARE_OF_MIDDLE, ROUNDED_IN_MIDDLE, COARSER, SPARE = 1e-4, 1e-6, 3e-3, 3.0, 4.0


def steps_for(tolerance: float | None) -> tuple[Steps, ...]:
    """What is tried, one after the other: the last are right to the last bits."""
    if tolerance is None:
        return ROUGH, FINE
    agreed = tolerance / SPARE
    plain = Steps(PLAIN, tolerance * SHARE, 1.0, COARSER, 1.0, agreed)
    # in a walk of some thousand steps floats lose four digits more
    return plain, Steps(MIDDLE, tolerance * SHARE_OF_MIDDLE, ROUNDED_IN_MIDDLE, COARSER, COARSER, agreed), FINE


class Reached(NamedTuple):
    """How many of the times were reached, −1 where they are not in order, q and p there, which rows are not right
    (None: all are), the largest difference of the two walks beside q or p, and steps.
    """

    reached: int
    states: np.ndarray
    wrong: np.ndarray | None
    gap: float
    steps: int


def terms(orders: Orders) -> float:
    """What a sum of products takes for all orders, in terms of floats."""
    wide, order = orders
    return WIDE_TERM * (wide + 1.0) ** 2 + order**2


def weight(tape: Tape, orders: Orders) -> float:
    """About how long a step takes, beside a fine one of Neumann's point on S²."""
    products = sum(kind in (PRODUCT, QUOTIENT, ROOT) for kind in tape.kinds)
    return (FIXED + products) / STANDARD * terms(orders) / terms(WIDE)


def bounds_of(steps: Steps, most: float) -> tuple[float, ...]:
    """The numbers of :class:`integrable.series.walk.Bounds`."""
    wide, order = steps.orders
    # where all terms are floats none of them is a limit
    orders = 1 / (order - 1), 1 / order, 1 / max(1, wide + 1), 1 / max(1, wide + 2)
    rounded = log2(steps.rounded) if wide >= 0 else 1e3
    return (
        log2(steps.left_out),
        rounded,
        log2(steps.coarser),
        log2(steps.rougher),
        *orders,
        steps.agreed,
        most,
        steps.farthest,
    )


def inverses(order: int) -> np.ndarray:
    """1/(k + 1) below an order, (hi, lo) each, in a row."""
    exact = [Fraction(1, k + 1) for k in range(order)]
    return np.array([[float(x), float(x - Fraction(float(x)))] for x in exact]).reshape(-1)
