"""The flow in floats over a few turns, by short runs: one compiled call each, without a torus.

A run includes its own set-up, so a new flow needs no other (:mod:`integrable.moving_point.short`). In compiled code it
takes some tens of microseconds plus a few per panel; interpreted, the same source is about a hundred times slower.
Doubtful cases are left to the other methods of the flow.

A walk by Taylor series (:mod:`integrable.motion.near`) is tried before. It is faster for up to about ten radians, and
takes a ball three times as long as a short run for a hundred radians.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from integrable.moving_point import short
from integrable.moving_point.short_rows import FLOATS, LOT, MADE, SUMS, WIDES, Request, Rule, new_room
from integrable.moving_point.short_start import set_up
from integrable.phase.ways import Cost
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.long_reals import BareReals

if TYPE_CHECKING:
    from collections.abc import Callable

    from integrable.phase.space import PhaseSpace
    from integrable.phase.state import State
    from jacobian.native.library import Packed

# PANEL_COST is the cost of a panel and START_COST that of the start of a run, in microseconds of compiled code (python
# -m benchmarks short); only the ratio matters
PANEL_COST, START_COST = 2.4, 50.0
# costs of a torus in microseconds (benchmarks short). FREE is for d = 0, where t = τ, and ROLLING for d ≠ 0. THIN
# is for I/(I + d) that differ by more than the factor THINNER, as 1/g then has far more Fourier modes. For many states
# within few turns, interpolation on the torus halves the cost of a state, but short runs still cost less
FREE, ROLLING, THIN = Cost(250, 0.75), Cost(560, 3.2), Cost(2900, 12)
THINNER = 20.0
# states from panels are less accurate than states from a torus, by a few rounding errors, so a single run must be WORTH
# times cheaper than the torus. For many runs the factor is WORTH_OF_MANY
WORTH, WORTH_OF_MANY = 2.0, 1.0
# largest number of panels: errors grow with the number of panels, as does the effect of rounded inputs
MOST_PANELS = 3000
MOST_TIMES = 20_000
# the largest numbers of panels and of times of a run where nothing is compiled
INTERPRETED_PANELS, INTERPRETED_TIMES = 64, 500
# the allowed error of a run's clock: DRIFT in the units of the motion, PACE relative to the time. For many motions at
# once the limits are wider, since rounding of the inputs changes the clocks by as much
DRIFT, PACE = 3e-14, 2.0**-53
DRIFT_OF_MANY, PACE_OF_MANY = 2e-13, 2.0**-51
# runs with at most this many times keep their working memory for the next run
KEPT_TIMES = 512
# bits of the wide numbers where nothing is compiled
BITS = 160

RowsAndTimes = tuple[np.ndarray, np.ndarray]


class ShortRuns:
    """The :class:`integrable.phase.ways.Way` to γ and M within a few turns of one state, in the user's units.

    ``kernel`` is that of :class:`integrable.motion.flow.Flow`. The result depends on times, body and state only, not on
    previous calls.
    """

    way = "short run"

    def __init__(self, system: PhaseSpace, state: State, kernel: str = "auto") -> None:
        body = system.body
        self._given = np.array([[*body.inertia, body.d, *state.row]], dtype=np.float64)
        self._tilted, self._rolls, self._kernel = state.tilted, body.rolls, kernel
        self._cost = torus_cost(min(body.inertia), max(body.inertia), body.d)
        # the number of panels of the last run, read by measurements only
        self.panels = 0

    def at(self, times: np.ndarray) -> RowsAndTimes | None:
        return self._run(times, self._rolls, False)

    def at_tau(self, tau: np.ndarray) -> np.ndarray | None:
        found = self._run(tau, False, False)
        return None if found is None else found[0]

    def times(self, tau: np.ndarray) -> np.ndarray | None:
        found = self._run(tau, False, True)
        return None if found is None else found[1]

    def _run(self, times: np.ndarray, physical: bool, clock: bool) -> RowsAndTimes | None:
        """(γ and M, other times). If ``physical``, ``times`` are physical and the other times are τ. Otherwise
        ``times`` are τ, and the other times are physical if ``clock``.
        """
        if len(times) > MOST_TIMES:
            return None
        status = short.FAR
        if self._kernel == "python" or interpreted():
            if len(times) < INTERPRETED_TIMES:
                status, rows, other = self._interpreted(times, physical, clock)
        elif (most := panels_within(self._cost, len(times))) > 0:
            asked = Asked(self._given, self._tilted, physical, clock, most, DRIFT, PACE)
            status, self.panels, rows, other = compiled_run(asked, times)
        return None if status else (rows, other if physical or clock else times)

    def _interpreted(self, times: np.ndarray, physical: bool, clock: bool) -> tuple[int, np.ndarray, np.ndarray]:
        reals, count = BareReals(BITS), len(times)
        request = Request(
            physical, clock, INTERPRETED_PANELS, DRIFT, PACE, times.tolist(), np.argsort(times, kind="stable").tolist(),
            [0.0] * count, [0.0] * count, [0.0] * (6 * count), [0.0] * count,
        )  # fmt: skip
        with reals:
            given, wide, floats = reals.row(self._given[0].tolist()), [reals.number(0)] * WIDES, [0.0] * FLOATS
            try:
                motion = set_up(given, self._tilted, wide, floats)
                room = new_room(motion, wide, floats, [0] * MADE)
                status = short.short_run(room, _listed(), request, given, self._tilted)
            except (ArithmeticError, ValueError, TypeError):
                # in these cases compiled code returns infinities or NaN instead of raising an exception
                status = short.LOST
        rows, other = np.array(request.out).reshape(-1, 6), np.array(request.other)
        if status == 0:
            other /= motion.tau_unit if physical else motion.time_unit
        return status, rows, other


class Asked(NamedTuple):
    """The input of compiled runs. ``given`` has moments, d, γ and M of each motion, shape (K, 10). All other fields but
    ``tilted`` are those of :class:`integrable.moving_point.short_rows.Request`.
    """

    given: np.ndarray
    tilted: bool
    physical: bool
    clock: bool
    most: int
    drift: float
    pace: float


def compiled_runs(
    asked: Asked, times: np.ndarray, rows: np.ndarray, other: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Runs many motions at ``times``, shape (K, N), or (1, N) for times common to all. γ and M are written to ``rows``,
    shape (K, N, 6), and τ (with ``clock``, physical times) to ``other``, shape (K, N).

    Returns (statuses, costs in panels), both of shape (K,). A status is 0 or the reason for failure. Python's global
    lock is released during the call.
    """
    prepared, (count, length) = _prepared(), other.shape
    work = prepared.room(count, length)
    order = times.argsort(axis=1, kind="stable")
    prepared.call(
        asked.given, asked.tilted, prepared.rule, asked[2:], times, order,
        rows.reshape(count, 6 * length), other, work,
    )  # fmt: skip
    return work[2][:count], work[2][count : 2 * count]


def compiled_run(asked: Asked, times: np.ndarray) -> tuple[int, int, np.ndarray, np.ndarray]:
    """Runs one motion at ``times`` and returns (status, cost in panels, γ and M, τ or, with ``clock``, physical times).

    The status is 0 or the reason for failure.
    """
    prepared, length = _prepared(), len(times)
    try:
        # passing an array takes as long as half an addition of divisors, so an earlier run's packed memory is reused
        work = prepared.kept.pop() if length <= KEPT_TIMES else prepared.room(1, length)
    except IndexError:
        work = prepared.room(1, KEPT_TIMES)
    given, rows, other = times[None], np.empty((1, 6 * length)), np.empty((1, length))
    what = (asked.given, asked.tilted, prepared.rule, asked[2:], given)
    prepared.call(*what, prepared.ascending, rows, other, work)
    status, panels = work[2][:2].tolist()
    if status == short.UNSORTED:
        prepared.call(*what, given.argsort(axis=1, kind="stable"), rows, other, work)
        status, panels = work[2][:2].tolist()
    if length <= KEPT_TIMES:
        prepared.kept.append(work)
    return status, panels, rows.reshape(length, 6), other[0]


def torus_cost(least: float, most: float, d: float) -> Cost:
    """The cost of a body's torus, estimated from its least and its largest moment."""
    if d == 0:
        return FREE
    return THIN if most * (least + d) > THINNER * least * (most + d) else ROLLING


def panels_within(torus: Cost, count: int, worth: float = WORTH) -> int:
    """The number of panels, at most MOST_PANELS, in a run that costs 1/``worth`` of a torus with ``count`` states."""
    return min(MOST_PANELS, int((torus.of(count) / worth - START_COST) / PANEL_COST))


@cache
def rule() -> Rule:
    """The interpolation rule of a panel: its nodes, their barycentric weights and the Chebyshev coefficients."""
    places: list[float] = []
    for j, (first, second) in enumerate(SUMS):
        begin = 0.5**first if j < LOT else places[first]
        places.append(begin + (0.5**second if second > 0 else -(0.5**-second)))
    nodes = np.array([-x for x in places] + places[::-1])
    count, wide = len(nodes), nodes.astype(np.longdouble)
    # the values of Lagrange's polynomials at Chebyshev's nodes give their Chebyshev coefficients
    k = np.arange(count)
    angles = np.arctan(np.longdouble(1)) * 2 * (2 * k + 1) / count
    matrix = np.cos(np.outer(k, angles)) * 2 / count
    matrix[0] /= 2
    weights = 1 / np.prod(wide[:, None] - wide + np.eye(count), axis=1)
    matrix = matrix @ lagrange(wide, weights, np.cos(angles))
    weights /= abs(weights).max()
    coefficients, weights = (part.ravel().astype(float) for part in (matrix.T, weights))
    return Rule(nodes, coefficients, weights, np.array(SUMS, dtype=np.intp).ravel())


def lagrange(nodes: np.ndarray, weights: np.ndarray, places: np.ndarray) -> np.ndarray:
    """The values at ``places`` of the Lagrange polynomials of ``nodes``, shape (places, nodes). ``places`` must not
    contain a node (Berrut & Trefethen 2004, 3.3).
    """
    apart = places[:, None] - nodes
    return np.prod(apart, axis=1)[:, None] * weights / apart


@cache
def _listed() -> Rule:
    """The rule as lists, which interpreted loops read faster."""
    return Rule(*(part.tolist() for part in rule()))


class Prepared(NamedTuple):
    """The constant arguments and the working memory that all calls of the compiled loops share."""

    call: Callable[..., None]
    rule: Packed
    ascending: Packed
    """The empty array in place of a sorting order, for times that ascend already."""
    room: Callable[[int, int], Packed]
    kept: list[Packed]
    """Memory of finished runs, each for one motion at KEPT_TIMES times. Two threads never use the same memory."""


@cache
def _prepared() -> Prepared:
    from integrable.moving_point.short_compiled import LIBRARY, ORDER, RULE, work_room
    from jacobian.native.library import Packed

    ascending = Packed(np.empty((0, 0), dtype=np.intp), ORDER)
    return Prepared(LIBRARY.entry, Packed(rule(), RULE), ascending, work_room, [])
