"""Requests to a walk and its results: the orders and bounds of its steps, and the rows it has reached."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import NamedTuple

import numpy as np

from integrable.series.room import Orders
from integrable.series.tape import PRODUCT, QUOTIENT, ROOT, Tape
from integrable.series.walk import MOST_LOST, Bounds
from jacobian.numbers.double_double import double_double_row

# a step with p products takes (FIXED + p)/STANDARD times as long as a step of the geodesic on an ellipsoid in R³, which
# has STANDARD − FIXED products
FIXED, STANDARD = 3, 13
# a step of this geodesic takes PER_ORDER·n + PER_SQUARE·n² microseconds for series of order n, and PER_WIDE_ORDER more
# for each order in double-doubles
PER_ORDER, PER_SQUARE, PER_WIDE_ORDER = 5e-3, 0.25e-3, 28e-3


class Steps(NamedTuple):
    """The orders of a walk's series, and ``tiers``: bounds on the terms of the series, which are tried in turn.

    Each tier leads to shorter steps, and so to more of them, than the tier before it.
    """

    orders: Orders
    tiers: tuple[Bounds, ...]


# FINE and FINEST give states right to the last bits of floats. The finer and the coarser walk of a motion may differ by
# an eighth of the rounding unit only, because errors of terms in floats are nearly as large in one as in the other.
# FINE has five more orders in double-doubles than ROUGH: at T = 1000 the errors of Neumann's point on S³ are a thousand
# times smaller, for a tenth more time (python -m benchmarks near)
WIDE, WIDER, WIDEST = Orders(9, 34), Orders(14, 40), Orders(18, 44)
FINE = Steps(WIDER, (Bounds(1e-24, 1e-7, 1e1, 1e1, 2.0**-56),))
FINEST = Steps(WIDEST, (Bounds(1e-31, 1e-12, 3e1, 3e1, 2.0**-56),))
# BRIEF takes 2/3, ROUGH 3/4 of the time of FINE; they are used up to times of 64 and 600 times the first step. The
# bound on the last terms is 3 times as large in the second walk. If it was 10 times as large, the two walks of the
# scene ``hat`` disagreed within 36 steps of BRIEF. In 900 motions the states on which both walks agreed were right to a
# tenth of the rounding unit (tests/integrable/series/test_walks.py has some of them)
BRIEF = Bounds(1e-20, 1e-5, 3.0, 1e1, 2.0**-56, 64.0)
ROUGH = Bounds(1e-22, 1e-6, 3.0, 1e1, 2.0**-56, 600.0)
IN_TURN = Steps(WIDE, (BRIEF, ROUGH))
# The M of a deformation is unbounded, and the difference of the walks grows a thousandfold at each of its peaks. BRIEF
# steps fail in two of five motions up to 32 times the first step. If a walk fails, the motion is computed on two curves
# where it has them. With a clock this takes twice as long. BEFORE_CURVES are the steps of motions with two curves,
# BEFORE_CLOCK of those with a clock too, INTEGRATED of all others. They had the least mean cost over 3,200 random
# motions, failed walks and what follows them included
_FIRST, _EVEN = BRIEF._replace(farthest=32.0), Bounds(1e-25, 1e-7, 1e1, 1e1, 2.0**-56)
_FINER = _EVEN._replace(left_out=1e-29, rounded=1e-8)
BEFORE_CURVES = (Steps(WIDE, (_FIRST, _EVEN._replace(farthest=100.0))),)
BEFORE_CLOCK = (Steps(WIDE, (_FIRST, _FINER._replace(farthest=200.0))),)
INTEGRATED = Steps(WIDE, (_FIRST, _EVEN._replace(farthest=200.0), _FINER)), FINEST
PLAIN, MIDDLE = Orders(-1, 24), Orders(4, 28)
# The last terms of series are at most SHARE of the tolerance for PLAIN steps, in floats, and SHARE_OF_MIDDLE of it for
# MIDDLE steps, whose first terms are double-doubles; the first float term of the latter is at most ROUNDED_IN_MIDDLE.
# These bounds are COARSER times as large in the second walk. The error is estimated as SPARE times the difference of
# the walks. Of 3,600 walks along eccentric orbits in a galaxy, 6 had an error of more than twice the estimate, and 22
# if COARSER was 3
SHARE, SHARE_OF_MIDDLE, ROUNDED_IN_MIDDLE, COARSER, SPARE = 3e-5, 1e-6, 3e-3, 10.0, 3.5
# At a tolerance of 1e-12 PLAIN steps are tried up to times of FARTHEST_IN_FLOATS times the first step. Neumann's point
# has a larger error than this tolerance after 600 steps, the Toda lattice an error of 1e-13 after 480 (python -m
# benchmarks near). Rounding errors grow as the 3/2 power of the number of steps
FARTHEST_IN_FLOATS = 500.0


@cache
def steps_for(tolerance: float | None) -> tuple[Steps, ...]:
    """The steps to try, in this order; the last ones are accurate to the last bits of floats."""
    if tolerance is None:
        return IN_TURN, FINE
    agreed = tolerance / SPARE
    farthest = FARTHEST_IN_FLOATS * (tolerance / 1e-12) ** (2 / 3)
    plain = Bounds(tolerance * SHARE, 1.0, COARSER, 1.0, agreed, farthest)
    # a walk of some thousand steps in floats loses four more digits than one whose first terms are double-doubles
    middle = Bounds(tolerance * SHARE_OF_MIDDLE, ROUNDED_IN_MIDDLE, COARSER, COARSER, agreed)
    return Steps(PLAIN, (plain,)), Steps(MIDDLE, (middle,)), FINE


class Reached(NamedTuple):
    """The number of times reached (−1 if they are not in order), the states there, and which of these are ``wrong``.

    ``wrong`` is None if no state is. ``lost`` is the number of comparisons of both walks that failed or predict that
    the last one will fail. ``gap`` is the largest difference of the walks relative to q or p, ``steps`` the number of
    steps, ``tier`` the index of the bounds.
    """

    reached: int
    states: np.ndarray
    wrong: np.ndarray | None
    lost: int
    gap: float
    steps: int
    tier: int

    @property
    def right(self) -> np.ndarray:
        """The indices of the states that were reached and are not wrong."""
        return np.arange(self.reached) if self.wrong is None else np.flatnonzero(~self.wrong)


Counts = int | np.ndarray
"""A number for one walk, or for each of several."""


def exhausted(reached: Counts, count: Counts, lost: Counts, tier: Counts, steps: Steps) -> bool | np.ndarray:
    """Whether a walk was given up before it had reached ``count`` times, as it would have taken too long."""
    return (tier < len(steps.tiers)) & (reached < count) & (lost <= MOST_LOST)


class ReachedByMany(NamedTuple):
    """The results of K walks. ``results`` has for each walk the numbers that :func:`integrable.series.walk.walked`
    returns. ``states`` has a state for every time; ``wrong`` marks the wrong states.
    """

    results: np.ndarray
    states: np.ndarray
    wrong: np.ndarray


def step_cost(tape: Tape, orders: Orders) -> float:
    """The approximate time of a step in microseconds (``python -m benchmarks near``)."""
    wide, order = orders
    products = sum(kind in (PRODUCT, QUOTIENT, ROOT) for kind in tape.kinds)
    standard = PER_SQUARE * order**2 + PER_ORDER * order + PER_WIDE_ORDER * (wide + 1)
    return (FIXED + products) / STANDARD * standard


def inverses(order: int) -> np.ndarray:
    """The reciprocals 1/(k + 1), k < ``order``, as one flat array of pairs (hi, lo)."""
    return double_double_row(Fraction(1, k + 1) for k in range(order)).reshape(-1)
