"""The working rows of short runs (:mod:`integrable.moving_point.short`), flat arrays, and named tuples of them."""

from __future__ import annotations

from typing import Any, NamedTuple

from integrable.moving_point.translations import Expansion, expansion_of

Real = Any
Row = Any

# moments, d, γ and M
GIVEN = 10
NODES = 28
# panels may be halved so often; their nodes take translations by half of each over 2^l so far down
LEVELS, FINEST = 6, 7
# orders of the expansion of translations, how many of them are wide, and by what each falls at least: 15 by 107 bits
ORDERS, WIDE_ORDERS, ORDER_GAIN = 16, 9, 140.5

# positions in ``numbers``, the data of a motion in floats: f, the axes, then
CLOCK, MOMENTUM, MATRIX, REACH = 14, 15, 16, 20
LIFT, CLOSE, INVARIANTS, SHAPE, PHYSICAL, FASTEST, RADIAN = 21, 22, 23, 25, 32, 33, 34
NUMBERS = 35
# in ``wide``: f, the axes, the start, then the units of τ and of physical time, and r_i = I_i/(I_i + d)
TAU_UNIT, TIME_UNIT, CONTACT = 24, 25, 26
WIDE = 29
# in ``point``: ten numbers of a moving point, 1/g there; γ and w of the start; how far off H2 is at the point
RATE, BEGIN, OFF = 10, 11, 17
# and of centres that are ahead how far their shadows are off them, and by what part an addition was
SHADOW, MOVED = 11, 12
POINT = OFF + 1
# rows of wide points: a centre, and those on the way down to panels about it
POINTS = LEVELS + 1
# number of centres made at once, each with its shadow: the number of lanes of a processor. Rows of ``ahead``: these,
# then the shadows, and the two starts
AHEAD = 4
AHEAD_POINTS = 2 * AHEAD + 2
# rows of wide translations: by h, from there down by h/2^l, and by 1 … AHEAD panels
HALF, PANEL = FINEST + LEVELS, FINEST + LEVELS + 1
# the positive nodes of a panel, by one addition each, first those of (a, b), 2^−a and 2^−|b| more, or less where b < 0,
# then those from the a-th of them on, so much more or less. None uses another of its lot, and each fits in the lanes of
# a processor. They are near Chebyshev's between which ±1 lie (Lebesgue constant 3.5); the first of the second lot is 1
SUMS = (
    (0, -7), (0, -5), (0, -3), (1, -7), (1, -3), (2, 5), (3, 5), (4, 7),
    (2, 3), (0, -4), (2, -4), (2, -3), (6, 1), (7, 1),
)  # fmt: skip
LOT = 8


class Rule(NamedTuple):
    """Nodes on [−1, 1], those of :data:`SUMS` below 0 and then, backwards, above it, and data derived from them."""

    nodes: Row
    coefficients: Row
    """From values to Chebyshev coefficients, column by column: what each node gives to all of them."""
    weights: Row
    """Those of barycentric interpolation."""
    sums: Row
    """:data:`SUMS`, one after the other."""


class ShortRoom(NamedTuple):
    """Working memory."""

    wide: Row
    """f, the axes, the start and the units of time in wide numbers."""
    numbers: Row
    points: Row
    steps: Row
    wide_nodes: Row
    """Translations to the nodes of panels of all levels, in wide numbers."""
    nodes: Row
    """The same in floats."""
    series: Expansion
    """Coefficients of translations (:func:`integrable.moving_point.translations.expand_orders`)."""
    ahead: Row
    """The next centres and those of a motion that begins beside this one, in wide numbers
    (:func:`integrable.moving_point.short_steps.go_ahead`).
    """
    made: Row
    """How many translations by panels there are, for how many levels there are nodes, at which level the finest
    translation is, what all panels have cost, in those of floats that are not halved, and how often half a panel has
    been doubled (:func:`integrable.moving_point.short.first_half`).
    """
    point: Row
    seen: Row
    """The same of the centres that are ahead."""
    values: Row
    rates: Row
    slowness: Row
    """Chebyshev coefficients of 1/g on the panel."""
    elapsed: Row
    """Those of its antiderivative, 0 at the left end."""
    last: Row
    """γ and w at the right end of the panel before."""
    sums: Row
    """The time at the left end of the panel, high and low, and what the clock drifts by."""


class Request(NamedTuple):
    """The request: ``order`` sorts ``high`` + ``low``, which are scaled times."""

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


# numbers in a room: integers, wide ones and floats
MADE = 5
NODE_STEPS = 10 * NODES * (LEVELS + 1)
WIDES = WIDE + 10 * (POINTS + PANEL + AHEAD) + NODE_STEPS + 7 * ORDERS + 10 * AHEAD_POINTS
FLOATS = NUMBERS + NODE_STEPS + POINT + 2 * AHEAD * POINT + 9 * NODES + 1 + 9


def new_room(wide: Row, floats: Row, made: Row) -> ShortRoom:
    """Working memory in ``wide`` and ``floats``, of arbitrary content; ``made`` is :data:`MADE` zeros."""
    points, steps = WIDE, WIDE + 10 * POINTS
    nodes = steps + 10 * (PANEL + AHEAD)
    series = nodes + NODE_STEPS
    ahead = series + 7 * ORDERS
    point = NUMBERS + NODE_STEPS
    seen = point + POINT
    values = seen + 2 * AHEAD * POINT
    last = values + 9 * NODES + 1
    return ShortRoom(
        wide[:points], floats[:NUMBERS], wide[points:steps], wide[steps:nodes], wide[nodes:series],
        floats[NUMBERS:point], expansion_of(wide[series:ahead]), wide[ahead:], made,
        floats[point:seen], floats[seen:values], floats[values : values + 6 * NODES],
        floats[values + 6 * NODES : values + 7 * NODES], floats[values + 7 * NODES : values + 8 * NODES],
        floats[values + 8 * NODES : last], floats[last : last + 6], floats[last + 6 :],
    )  # fmt: skip


def curve_of(row: Row) -> Any:
    """f as a tuple."""
    return row[0], row[1], row[2], row[3], row[4], row[5]


def axes_of(row: Row) -> Any:
    """The axes as a tuple."""
    return row[6], row[7], row[8], row[9], row[10], row[11], row[12], row[13]


def unit_axes(row: Row) -> Any:
    """The axes of translations."""
    one = 1 + 0 * row[6]
    return row[6], row[7], row[8], one, one, one, one, 0 * one
