"""Whether the states that a torus gives are those of the motion, signs included, by a way that shares nothing with it.

H1 and H2 of a state do not change with the signs of its γ_i, nor with its place on the torus. What the corners of a
torus, its periods and its signs make of a few times is compared with an addition or two to the start, of translations
made by doublings of small ones: no period, no corner and no choice of a sign goes into that.

What translations lose beside a corner is seen where cells meet: a state on the border is reached from either corner.
"""

from __future__ import annotations

from math import ceil, log2
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from integrable.moving_point.addition import moving_point, put, shift
from integrable.moving_point.bare_problem import BareProblem
from integrable.moving_point.problem import vectors
from integrable.moving_point.short_rows import curve_of, unit_axes
from integrable.moving_point.translations import REACH, Translations
from integrable.torus.states import Torus, point_at, point_beside, put_state, states_at_tau
from integrable.torus.tables import Room, expansion, near_centre, recentred
from integrable.torus.walks import Curve
from jacobian.numbers.abreast import abreast
from jacobian.numbers.roots import root

Real = Any
Row = Any

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup

# turns of a phase at the times that are looked at: once round in either direction, a quarter or so beyond
TURNS = (1.23, -1.38)
# no more turns than this of the faster phase
FAR = 2.0**48
# a difference that double-double numbers may make on the way; beyond it digits decide
ALIKE = 1e-6
# and one that a right torus may: the states themselves are held to less, here it is about signs and places
RIGHT = 1e-8
# borders that are looked at, and what both corners may differ by
BORDERS = 16
SEAM = 1e-13
# steps are halved so often that so few terms and passes of Newton make a double-double number
HALVINGS, TERMS, NEWTON_PASSES = 2, 32, 2


class Line(NamedTuple):
    """A motion as additions to its ``start``: about the flow's own centre or, where that is so ``far`` from all branch
    points that digits are lost, about the two ``centres`` of the cells. ``motion`` and ``rates`` are rows of
    :mod:`integrable.torus.survey`.
    """

    curve: Curve
    start: Row
    motion: Row
    rates: Row
    centres: tuple[float, float]
    far: bool


def witnesses(rates: list[float]) -> np.ndarray:
    """Two times of the flow for each period: by then every sign that it changes has been changed, in both directions.
    ``rates`` are turns of the phases in a unit of τ.
    """
    # a period that is not reached before the fractions of the other phase are gone changes no sign
    farthest = FAR / max(map(abs, rates))
    return np.array([min(max(turns / nu, -farthest), farthest) for nu in rates for turns in TURNS])


def confirmed(setup: Setup, tau: np.ndarray, found: np.ndarray, by_additions: np.ndarray) -> bool:
    """Whether the states that a torus has at the times ``tau``, shape (N, 6), are those that translations in many
    digits lead to: where those of :func:`departure` do not suffice. The others are not looked at again.
    """
    rows = [(t, x.tolist()) for t, x, y in zip(tau.tolist(), found, by_additions, strict=True) if not alike(x, y)]
    bare = setup.bare_problem
    # not the set-up's own, which are made from numbers of the wide field
    translations = Translations(setup.reals, bare.f, bare.axes, bare.half_step)
    for t, row in rows:
        with setup.reals:
            gamma, M = vectors(_in_digits(bare, translations, t), bare.momentum, bare.matrix)
        if not difference(row, list(map(float, (*gamma, *M)))) <= RIGHT:
            return False
    return True


def alike(first: np.ndarray, second: np.ndarray) -> bool:
    """Whether a state is another but for what double-double numbers may lose."""
    return difference(first.tolist(), second.tolist()) <= ALIKE


def departure(torus: Torus, line: Line, times: Row, room: Room, points: Row, out: Row) -> float:
    """What states of a torus at some times of the flow differ by from those that additions lead to: both into ``out``,
    one after the other, six floats each.
    """
    count = 6 * len(times)
    states_at_tau(torus, (line.rates[6], line.rates[7]), times, out[:count])
    reached(line, times, room, points, out[count:])
    return difference(out[:count], out[count:])


def seam(torus: Torus, out: Row) -> float:
    """What states :func:`on_borders`, which go into ``out``, differ by."""
    on_borders(torus, out)
    return difference(out[: len(out) // 2], out[len(out) // 2 :])


def on_borders(torus: Torus, out: Row) -> None:
    """γ and M, six floats each, on borders of cells, from one corner and then from the other: halfway from a corner to
    the next in the first direction, a quarter in the second, then the other way round.
    """
    (rows, columns), zero, count = torus.cells, 0 * torus.curve.axes[0], len(out) // 24
    for n in abreast(0, 2 * count):
        k, down = n % count, n // count
        i, j = k * rows // count, k * columns // count
        first, second = zero + (i + 0.5 - 0.25 * down) / rows, zero + (j + 0.25 + 0.25 * down) / columns
        one, other = point_beside(torus, (i, j), first, second, 0, 0), point_at(torus, first, second, 0, 0)
        put_state(one, torus.matrix, out, 6 * n)
        put_state(other, torus.matrix, out, 6 * (n + 2 * count))


def reached(line: Line, times: Row, room: Room, points: Row, out: Row) -> None:
    """γ and M at some times of the flow, six floats each; what their additions lose is not known. ``room`` is for an
    expansion, ``points`` for a point at each time.
    """
    curve, rates = line.curve, line.rates
    for i in range(len(times)):
        put(moving_point(line.start, 0), points, 10 * i)
    for k in range(2 if line.far else 1):
        centre, share = leg(line, k)
        about, numbers = expansion(line.motion, centre, room, NEWTON_PASSES), room.numbers
        scale, half_step = share * rates[14] / about.unit, 2 * REACH / float(root(-about.f0))
        farthest = half_step
        for time in times:
            farthest = max(farthest, abs(float(time * scale)))
        doublings = ceil(log2(farthest / half_step)) + HALVINGS
        for i in abreast(0, len(times)):
            # doubled about its centre, where the digits of what is near the identity are
            step = near_centre(about, times[i] * scale / 2.0**doublings)
            for _ in range(doublings):
                step = shift(curve_of(numbers), unit_axes(numbers), step, step)
            step = recentred(step, about.axes, centre, about.unit)
            put(shift(curve.f, curve.axes, moving_point(points, 10 * i), step), points, 10 * i)
    for i in range(len(times)):
        put_state(moving_point(points, 10 * i), (rates[0], rates[1], rates[2], rates[3]), out, 6 * i)


def leg(line: Line, k: int) -> tuple[Real, Real]:
    """(c, s) of the parts s·(1, c) that the direction (1, −x₀) of the flow is the sum of: itself, or about centres."""
    own = -line.motion[11]
    if not line.far:
        return own, 1 + 0 * own
    first, second = line.centres[0] + 0 * own, line.centres[1] + 0 * own
    if k == 0:
        return first, (second - own) / (second - first)
    return second, (own - first) / (second - first)


def _in_digits(bare: BareProblem, translations: Translations, tau: float) -> Row:
    """The moving point at τ, in bare reals."""
    step = translations.near(translations.reals.number(tau) * bare.time_scale)
    return shift(bare.f, bare.axes, bare.start, step)


def difference(rows: Row, states: Row) -> float:
    """The largest difference in γ and in M/|M|, not a number where one is none; six floats to a state."""
    gamma, M, size, rest = 0.0, 0.0, 0.0, 0.0
    for n in range(len(rows)):
        gap = abs(rows[n] - states[n])
        rest += 0 * gap
        if n % 6 < 3:
            gamma = max(gamma, gap)
        else:
            M, size = max(M, gap), max(size, abs(states[n]))
    return max(gamma, M / size) + rest
