"""The rows that short runs work in (:mod:`integrable.moving_point.short`), flat, and tuples of what is in them."""

from __future__ import annotations

from typing import Any, NamedTuple

Real = Any
Row = Any

# moments, d, γ and M
GIVEN = 10
NODES = 28
# panels may be halved so often; translations by half a panel over 2^l are tabled so far down, for every level one more
LEVELS, FINEST = 6, 9
# translations by 2^k panels that are tabled
DOUBLINGS = 20
# terms of power series
TERMS = 26

# places in ``numbers``, what is known of a motion in floats: f, the axes, then
CLOCK, MOMENTUM, MATRIX, REACH = 14, 15, 16, 20
GROWTH, MOST_GROWN, LIFT, CLOSE, INVARIANTS, SHAPE, PHYSICAL, FIRST_RATE = 21, 22, 23, 24, 25, 27, 34, 35
NUMBERS = 36
# in ``wide``: f, the axes, the start, then the units of τ and of physical time
TAU_UNIT, TIME_UNIT = 24, 25
WIDE = 26
# in ``point``: ten numbers of a moving point, 1/g there; γ and w of the start; how far off H2 is at the point
RATE, BEGIN, OFF = 10, 11, 17
# rows of wide points: those on the way down to a panel, then centres that are ancestors of others, then the start
FIRST, START = LEVELS + 1, LEVELS + DOUBLINGS + 2
POINTS = START + 1
# rows of wide translations: by h/2^l, then by 2^k panels
PANEL = FINEST + LEVELS + 1
# the positive nodes of a panel, near those of Chebyshev, each by one addition: (a, b) is 2^−a, or from the row after
# FINEST on a node before it, and 2^−|b| more, or less where b < 0
SUMS = (
    (0, -9), (0, -6), (10, -5), (11, -4), (0, -3), (14, -4), (10, -2), (13, -2), (1, 4), (1, -6), (1, -3), (2, 5),
    (17, -1), (4, -7),
)  # fmt: skip


class Rule(NamedTuple):
    """Nodes on [−1, 1], ascending, and the matrices that go with them."""

    nodes: Row
    coefficients: Row
    """From values to Chebyshev coefficients, column by column: what each node gives to all of them."""
    weights: Row
    """Those of barycentric interpolation."""
    ends: Row
    """From values to the interpolant at −1, then at 1."""
    sums: Row
    """:data:`SUMS`, one after the other."""


class Room(NamedTuple):
    """Rows to work in."""

    wide: Row
    """f, the axes, the start and the units of time in wide numbers."""
    numbers: Row
    points: Row
    steps: Row
    wide_nodes: Row
    """Translations to the nodes of panels of all levels, in wide numbers."""
    nodes: Row
    """The same in floats."""
    series: Row
    roots: Row
    made: Row
    """How many translations by 2^k panels there are, for how many levels there are nodes, steps of Newton from a float
    to a wide number, and what all panels have cost, in those of floats that are not halved.
    """
    point: Row
    values: Row
    rates: Row
    slowness: Row
    """Chebyshev coefficients of 1/g on the panel."""
    elapsed: Row
    """Those of its antiderivative, 0 at the left end."""
    ends: Row
    last: Row
    sums: Row
    """The time at the left end of the panel, high and low, and what the clock drifts by."""


class Request(NamedTuple):
    """What is asked for: ``order`` sorts ``high`` + ``low``, which are scaled times."""

    physical: bool
    """Whether times are physical."""
    clock: bool
    """Whether the other time is asked for too."""
    most: int
    """Panels in either direction."""
    drift: float
    """What the clock may be off by at the end."""
    pace: float
    """And by what part of the way besides."""
    times: Row
    order: Row
    high: Row
    low: Row
    out: Row
    """γ and M."""
    other: Row
    """τ where times are physical, physical time where they are not; in the units of the motion."""
    half: float
    """Half a panel where ``centres`` are given, else 0."""
    ahead: int
    centres: Row
    """Moving points at the centres of panels, wide, where they take more digits than that: so many in the direction of
    time, then those against it; or none.
    """


# numbers in a room, wide and floats
NODE_STEPS = 10 * NODES * (LEVELS + 1)
WIDES = WIDE + 10 * (POINTS + PANEL + 1 + DOUBLINGS) + NODE_STEPS + 2 * TERMS
FLOATS = NUMBERS + NODE_STEPS + OFF + 1 + 9 * NODES + 1 + 21


def new_room(wide: Row, floats: Row, made: Row) -> Room:
    """Rows in ``wide`` and ``floats``, that many zeros; ``made`` is (1, 0, steps of Newton from a float to a wide
    number, 0).
    """
    points, steps = WIDE, WIDE + 10 * POINTS
    nodes = steps + 10 * (PANEL + 1 + DOUBLINGS)
    series = nodes + NODE_STEPS
    point = NUMBERS + NODE_STEPS
    values = point + OFF + 1
    ends = values + 9 * NODES + 1
    return Room(
        wide[:points], floats[:NUMBERS], wide[points:steps], wide[steps:nodes], wide[nodes:series],
        floats[NUMBERS:point], wide[series : series + TERMS], wide[series + TERMS :], made, floats[point:values],
        floats[values : values + 6 * NODES], floats[values + 6 * NODES : values + 7 * NODES],
        floats[values + 7 * NODES : values + 8 * NODES], floats[values + 8 * NODES : ends], floats[ends : ends + 12],
        floats[ends + 12 : ends + 18], floats[ends + 18 :],
    )  # fmt: skip


def curve_of(row: Row) -> Any:
    """f as a tuple."""
    return row[0], row[1], row[2], row[3], row[4], row[5]


def axes_of(row: Row) -> Any:
    """The axes as a tuple."""
    return row[6], row[7], row[8], row[9], row[10], row[11], row[12], row[13]


def unit_axes(row: Row) -> Any:
    """Those of translations."""
    one = 1 + 0 * row[6]
    return row[6], row[7], row[8], one, one, one, one, 0 * one
