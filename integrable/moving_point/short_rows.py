"""The working memory of short runs (:mod:`integrable.moving_point.short`): flat arrays, and named tuples of them."""

from __future__ import annotations

from typing import NamedTuple

from integrable.moving_point.addition import Row
from integrable.moving_point.problem import ROW
from integrable.moving_point.translations import Expansion, expansion_of
from integrable.phase.body import Vector

# the number of given values: the moments, d, γ and M
GIVEN = 10
NODES = 28
# a panel is halved at most LEVELS times; nodes need translations by half a panel divided by 2^l for l up to FINEST
LEVELS, FINEST = 6, 7
# translations are expanded to ORDERS orders, the first WIDE_ORDERS in wide numbers; each order is smaller than the one
# before by at least the factor ORDER_GAIN, and 15 such factors make 107 bits
ORDERS, WIDE_ORDERS, ORDER_GAIN = 16, 9, 140.5

# the row ``wide`` has WIDE numbers: a problem's row, then the unit of physical time at TIME_UNIT
TIME_UNIT = ROW
WIDE = TIME_UNIT + 1
# positions in ``point`` after the ten numbers of a moving point: 1/g (RATE), γ and w of the start (from BEGIN on), and
# the deviation of H2 (OFF)
RATE, BEGIN, OFF = 10, 11, 17
# positions in the rows of ``seen``, which describe precomputed centres of panels: the distance from the centre on the
# shadow (:mod:`integrable.moving_point.short`) is at SHADOW, the relative correction after the addition at MOVED
SHADOW, MOVED = 11, 12
POINT = OFF + 1
# number of rows of wide points: one for the centre of a panel, and one for each level of halving
POINTS = LEVELS + 1
# points of the motion and of its shadow at the centres of AHEAD panels are computed together, so as to fill SIMD lanes.
# The rows of ``ahead`` are these points of the motion, those of the shadow, and the two points from which they start
AHEAD = 4
AHEAD_POINTS = 2 * AHEAD + 2
# rows of wide translations: row HALF has the translation by h, half the length of a panel. Row HALF − l has that by
# h/2^l, and the rows from PANEL on those by 1 … AHEAD panels
HALF, PANEL = FINEST + LEVELS, FINEST + LEVELS + 1
# SUMS gives the positive nodes of a panel, one addition for each. Among the first LOT nodes (a, b) means 2^−a + 2^−b,
# or 2^−a − 2^−|b| where b < 0; for the later nodes the a-th node takes the place of 2^−a. So the first LOT nodes, and
# then the later ones, are computed together in SIMD lanes. The nodes are close to Chebyshev's on an interval a little
# wider than [−1, 1] (Lebesgue constant 3.5). The node of index LOT is 1
SUMS = (
    (0, -7), (0, -5), (0, -3), (1, -7), (1, -3), (2, 5), (3, 5), (4, 7),
    (2, 3), (0, -4), (2, -4), (2, -3), (6, 1), (7, 1),
)  # fmt: skip
LOT = 8


class Rule(NamedTuple):
    """Nodes on [−1, 1] or a little beyond, and data derived from them. The nodes are the negatives of those in
    :data:`SUMS`, then those in :data:`SUMS` in reverse order.
    """

    nodes: Row
    coefficients: Row
    """The matrix from values to Chebyshev coefficients, column by column. A column has the contributions of one node to
    all coefficients.
    """
    weights: Row
    """The weights of barycentric interpolation."""
    sums: Row
    """:data:`SUMS`, flattened."""


class FloatMotion(NamedTuple):
    """One motion in floats, in the units of its :class:`~integrable.moving_point.problem.Problem` unless stated."""

    f: Row
    axes: Row
    a: Vector[float]
    """1/(I_i + d) of the given body. This field and the next three are in the user's units."""
    contact: Vector[float]
    """I_i/(I_i + d)."""
    d: float
    energies: tuple[float, float]
    """H1 and H2."""
    momentum: float
    """|M| of the upright motion."""
    matrix: Row
    """The inverse of Chaplygin's transformation; of an upright state the identity."""
    tau_unit: float
    """One unit of the user's τ, in the units of the motion."""
    time_unit: float
    """One unit of physical time, in the units of the motion."""
    close: float
    """I + d of the largest moment I, divided by the difference of I and the least moment."""
    lift: float
    """A quarter of the factor by which an error of the upright motion may grow in γ or M/|M|; at least 1."""
    half_step: float
    """Half of a basic step (:attr:`integrable.moving_point.setup.Setup.step_length`)."""
    radian: float
    """A lower bound of the time in which the body turns by a radian."""
    fastest: float
    """A bound of 1/g, by :func:`integrable.moving_point.short_start.fastest`."""


class ShortRoom(NamedTuple):
    """A motion and the working memory of its short run."""

    motion: FloatMotion
    wide: Row
    """A :func:`~integrable.moving_point.problem.problem_row` in wide numbers, and the unit of physical time."""
    points: Row
    steps: Row
    wide_nodes: Row
    """Translations to the nodes of panels of all levels, in wide numbers."""
    nodes: Row
    """The numbers of ``wide_nodes`` in floats."""
    series: Expansion
    """Coefficients of translations (:func:`integrable.moving_point.translations.expand_orders`)."""
    ahead: Row
    """The next centres of the motion and of its shadow, in wide numbers
    (:func:`integrable.moving_point.short_steps.go_ahead`).
    """
    made: Row
    """Five counts: translations by panels computed so far; levels whose nodes are computed; level of the finest
    translation; cost so far, in panels with nodes in floats; doublings of half a panel
    (:func:`integrable.moving_point.short.first_half`).
    """
    point: Row
    seen: Row
    """The numbers of ``point`` for each of the precomputed centres."""
    values: Row
    rates: Row
    slowness: Row
    """Chebyshev coefficients of 1/g on the panel."""
    elapsed: Row
    """Chebyshev coefficients of the antiderivative of 1/g that is 0 at the left end."""
    last: Row
    """γ and w at the right end of the previous panel."""
    sums: Row
    """The time at the left end of the panel, high and low part, and the accumulated error of the clock."""


class Request(NamedTuple):
    """The times and options of a short run. ``high`` + ``low`` are the scaled times, and ``order`` sorts them."""

    physical: bool
    """Whether times are physical."""
    clock: bool
    """Whether ``other`` is requested."""
    most: int
    """The largest number of panels in each direction."""
    drift: float
    """The allowed error of the clock at the end, apart from ``pace``."""
    pace: float
    """The further allowed error of the clock, as a fraction of the elapsed time."""
    times: Row
    order: Row
    high: Row
    low: Row
    out: Row
    """γ and M."""
    other: Row
    """τ if the times are physical, otherwise physical time; in the units of the motion."""


# lengths of the working memory: MADE integers, WIDES wide numbers and FLOATS floats
MADE = 5
NODE_STEPS = 10 * NODES * (LEVELS + 1)
WIDES = WIDE + 10 * (POINTS + PANEL + AHEAD) + NODE_STEPS + 7 * ORDERS + 10 * AHEAD_POINTS
FLOATS = POINT + NODE_STEPS + 2 * AHEAD * POINT + 9 * NODES + 1 + 9


def new_room(motion: FloatMotion, wide: Row, floats: Row, made: Row) -> ShortRoom:
    """Working memory inside the arrays ``wide`` and ``floats``, to whose beginnings
    :func:`integrable.moving_point.short_start.set_up` has written. ``made`` holds :data:`MADE` zeros.
    """
    points, steps = WIDE, WIDE + 10 * POINTS
    nodes = steps + 10 * (PANEL + AHEAD)
    series = nodes + NODE_STEPS
    ahead = series + 7 * ORDERS
    seen = POINT + NODE_STEPS
    values = seen + 2 * AHEAD * POINT
    last = values + 9 * NODES + 1
    return ShortRoom(
        motion, wide[:points], wide[points:steps], wide[steps:nodes], wide[nodes:series],
        floats[POINT:seen], expansion_of(wide[series:ahead]), wide[ahead:], made,
        floats[:POINT], floats[seen:values], floats[values : values + 6 * NODES],
        floats[values + 6 * NODES : values + 7 * NODES], floats[values + 7 * NODES : values + 8 * NODES],
        floats[values + 8 * NODES : last], floats[last : last + 6], floats[last + 6 :],
    )  # fmt: skip


def axes_of(row: Row) -> Row:
    """The numbers ``axes`` of :mod:`integrable.moving_point.addition` as a tuple."""
    return row[6], row[7], row[8], row[9], row[10], row[11], row[12], row[13]


def unit_axes(row: Row) -> Row:
    """``axes`` for translations: κ_i = 1, and no tilt."""
    one = 1 + 0 * row[6]
    return row[6], row[7], row[8], one, one, one, one, 0 * one
