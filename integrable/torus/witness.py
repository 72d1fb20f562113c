"""Checks that the states of a torus are those of the motion, signs included, by independent computations.

H1 and H2 of a state depend neither on the signs of its γ_i nor on its place on the torus. So a few times computed from
the corners, periods and signs of a torus are compared with the start plus one or two translations. These come from
doublings of small translations, which use no period, no corner and no choice of a sign.

The digits lost in translations show where cells meet, since a state on the border is reached from either corner.
"""

from __future__ import annotations

from math import ceil, log2
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from integrable.moving_point.addition import Real, Row, moving_point, put, shift
from integrable.moving_point.problem import Problem, vectors
from integrable.moving_point.short_rows import curve_of, unit_axes
from integrable.moving_point.translations import REACH, Translations
from integrable.phase.coordinates import directions_of
from integrable.torus.states import Torus, point_at, point_beside, put_state, states_at_tau, torus_in_tuples
from integrable.torus.tables import TableRoom, expansion_about, near_centre, recentred
from integrable.torus.walks import Curve, in_tuples
from jacobian.numbers.abreast import abreast
from jacobian.numbers.roots import root

if TYPE_CHECKING:
    from integrable.torus.lattice import Source

# turns of a phase at the checked times: more than one in either direction, after which all signs that the period
# changes have changed
TURNS = (1.23, -1.38)
# beyond this number of turns the faster phase loses its fraction
FAR = 2.0**48
# double-doubles alone do not explain a larger difference; numbers with more digits then decide
ALIKE = 1e-6
# the difference allowed for a correct torus: this check is for wrong signs and positions only
RIGHT = 1e-8
# BORDERS borders are checked; the difference allowed between both corners is SEAM in double-doubles. For close moments,
# whose κ is small, SEAM is multiplied by 10κ or at least by LEAST: where a γ_i passes 0, an error of V is magnified by
# 1/κ in M_i (test_a_torus_of_close_moments_is_right_where_a_coordinate_plane_is_passed)
BORDERS = 16
SEAM, LEAST = 1e-13, 1e-2
# HALVINGS halvings of a step, TERMS terms and NEWTON_PASSES Newton passes together give a double-double number
HALVINGS, TERMS, NEWTON_PASSES = 2, 32, 2


class Line(NamedTuple):
    """The data to compute a motion by additions to its ``start``. Translations are taken about the flow's own centre.
    ``far`` says that this centre is too far from all branch points and loses digits; the two ``centres`` of the cells
    then replace it. ``motion`` and ``rates`` are rows of :mod:`integrable.torus.survey`.
    """

    curve: Curve
    start: Row
    motion: Row
    rates: Row
    centres: tuple[float, float]
    far: bool


def witnesses(rates: list[float]) -> np.ndarray:
    """Two times of the flow for each period, one in each direction, after which every sign that the period changes has
    changed.

    ``rates`` are turns of the phases per unit of τ.
    """
    # if the faster phase loses its fraction before a turn of the slower one, the signs of the latter do not matter
    farthest = FAR / max(map(abs, rates))
    return np.array([min(max(turns / nu, -farthest), farthest) for nu in rates for turns in TURNS])


def confirmed(setup: Source, tau: np.ndarray, found: np.ndarray, by_additions: np.ndarray) -> bool:
    """Whether the states of a torus at the times ``tau``, shape (N, 6), agree with translations in many digits.

    Only times at which the states differ from ``by_additions``, those of :func:`departure`, are checked here.
    """
    rows = [
        (t, x.tolist()) for t, x, y in zip(tau.tolist(), found, by_additions, strict=True) if not states_agree(x, y)
    ]
    bare = setup.bare
    # the translations are made here, since a source need not have its own
    translations = Translations(setup.reals, bare.f, bare.axes, bare.half_step)
    for t, row in rows:
        with setup.reals:
            gamma, M = vectors(_in_digits(bare, translations, t), bare.momentum, bare.matrix)
        if not difference(row, list(map(float, (*gamma, *M)))) <= RIGHT:
            return False
    return True


def states_agree(first: np.ndarray, second: np.ndarray) -> bool:
    """Whether two states agree to the accuracy allowed in double-double numbers."""
    return difference(first.tolist(), second.tolist()) <= ALIKE


def departure(torus: Torus, line: Line, times: Row, room: TableRoom, points: Row, out: Row) -> float:
    """The largest difference between states of a torus at some τ and the same states from additions. All states go
    into ``out``, six floats each, first those of the torus.
    """
    count = 6 * len(times)
    states_at_tau(torus, (line.rates[6], line.rates[7]), times, out[:count])
    reached(line, times, room, points, out[count:])
    return difference(out[:count], out[count:])


def seam(torus: Torus, out: Row) -> float:
    """The largest of the differences that :func:`on_borders` writes to ``out``."""
    on_borders(torus, out)
    largest = 0.0
    for gap in out:
        # a comparison with NaN is false, so that NaN counts as large
        largest = gap if not gap <= largest else largest
    return largest


def on_borders(torus: Torus, out: Row) -> None:
    """The differences in γ̃ and M̃/|M̃| between both corners on borders of cells, before they are rounded to floats:
    halfway from a corner to the next in the first direction, a quarter in the second, then the other way round.
    """
    (rows, columns), zero, count = torus.cells, 0 * torus.curve.axes[0], len(out) // 2
    near = torus_in_tuples(torus)
    for n in abreast(0, 2 * count):
        k, down = n % count, n // count
        i, j = k * rows // count, k * columns // count
        first, second = zero + (i + 0.5 - 0.25 * down) / rows, zero + (j + 0.25 + 0.25 * down) / columns
        gamma, M = directions_of(point_beside(near, (i, j), first, second, 0, 0))
        other, N = directions_of(point_at(near, first, second, 0, 0))
        gap = 0.0
        for c in range(3):
            gap += abs(float(gamma[c] - other[c])) + abs(float(M[c] - N[c]))
        out[n] = gap


def reached(line: Line, times: Row, room: TableRoom, points: Row, out: Row) -> None:
    """γ and M at some times of the flow by additions, six floats each, without a check of the loss.

    ``room`` is memory for an expansion, ``points`` for a point at each time.
    """
    curve, rates = in_tuples(line.curve), line.rates
    for i in range(len(times)):
        put(moving_point(line.start, 0), points, 10 * i)
    for k in range(2 if line.far else 1):
        centre, share = leg(line, k)
        about, numbers = expansion_about(line.motion, centre, room, NEWTON_PASSES), room.numbers
        scale, half_step = share / about.unit, 2 * REACH / float(root(-about.f0))
        farthest = half_step
        for time in times:
            farthest = max(farthest, abs(float(time * scale)))
        doublings = ceil(log2(farthest / half_step)) + HALVINGS
        for i in abreast(0, len(times)):
            # points near the identity keep their digits in coordinates about the translation's centre
            step = near_centre(about, times[i] * scale / 2.0**doublings)
            for _ in range(doublings):
                step = shift(curve_of(numbers), unit_axes(numbers), step, step)
            step = recentred(step, about.axes, centre, about.unit)
            put(shift(curve.f, curve.axes, moving_point(points, 10 * i), step), points, 10 * i)
    for i in range(len(times)):
        put_state(moving_point(points, 10 * i), (rates[0], rates[1], rates[2], rates[3]), out, 6 * i)


def leg(line: Line, k: int) -> tuple[Real, Real]:
    """(c, s) of the part s·(1, c) of the flow's direction: all of it, or its k-th part about the centres if ``far``."""
    first, second = line.rates[14], line.rates[15]
    if not line.far:
        return second / first, first
    low, high = line.centres[0] + 0 * first, line.centres[1] + 0 * first
    above = (second - low * first) / (high - low)
    return (low, first - above) if k == 0 else (high, above)


def _in_digits(bare: Problem, translations: Translations, tau: float) -> Row:
    """The moving point at τ, in bare reals."""
    step = translations.near(translations.reals.number(tau) * bare.time_scale)
    return shift(bare.f, bare.axes, bare.start, step)


def difference(rows: Row, states: Row) -> float:
    """The largest difference in γ and in M/|M| between rows of six floats per state; NaN if one is NaN."""
    gamma, M, size, rest = 0.0, 0.0, 0.0, 0.0
    for n in range(len(rows)):
        gap = abs(rows[n] - states[n])
        rest += 0 * gap
        if n % 6 < 3:
            gamma = max(gamma, gap)
        else:
            M, size = max(M, gap), max(size, abs(states[n]))
    return max(gamma, M / size) + rest
