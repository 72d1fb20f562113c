"""Events along a motion: zeros of a function of the state, found on the flow itself."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from integrable.motion.trajectory import BodyMotion
from integrable.phase.body import Body
from integrable.phase.state import State
from integrable.torus.panels import Panels, distinct, zeros
from jacobian import RR
from jacobian.element import Number
from jacobian.errors import ArgumentError, Infeasible, PrecisionLoss, one_of, shown
from jacobian.fields.multiprecision import Mpf
from jacobian.immutable import replaced

if TYPE_CHECKING:
    from integrable.motion.trajectory import Trajectory

Condition = Callable[[np.ndarray, np.ndarray], np.ndarray]
# number of panels that are searched together
PANELS = 512
# the largest number of panels of one search, each of which takes some ten microseconds
MOST_PANELS = 10_000_000
# the tolerance of panels: their zeros only start Newton's method on the flow
TOLERANCE = 1e-12
# basic steps per panel, so few that its nodes resolve γ and M
PANEL_STEPS = 6
# if neighbouring floats are farther apart than this fraction of a panel, the states at rounded times form no smooth
# series
COARSEST = 1e-7
# a zero outside the interval by at most this many roundings of a half panel counts as at its end
ROUNDING = 1e3
# a step of Newton's method, with a slope in floats, gains twelve digits
MOST_STEPS = 100


def events(flow: BodyMotion, condition: Condition, start: Number, end: Number, direction: int = 0) -> Trajectory:
    """The states at which ``condition`` changes sign between two physical times: see :meth:`Flow.events`."""
    if not callable(condition):
        raise ArgumentError(f"condition = {shown(condition)}: give a function of γ and M, arrays of shape (N, 3)")
    first, last = (flow.system.field.coerce(t, name) for t, name in ((start, "start"), (end, "end")))
    if not first < last:
        raise ArgumentError(f"start = {shown(start)}, end = {shown(end)}: a time after start is needed")
    direction = one_of(direction, "direction", (-1, 0, 1), "1 for rising zeros, −1 for falling ones, 0 for both")
    floats = _in_floats(flow)
    found = []
    for left, right, length in _stretches(floats, float(first), float(last)):
        found.append(zeros(Panels(partial(_column, floats, condition), left, right, length, TOLERANCE)))
    # a zero at the end of a stretch is also found in the next one
    times, slopes, halves = distinct(*(np.concatenate(parts) for parts in zip(*found, strict=True)))
    kept = direction * slopes >= 0
    return flow.at(_polished(flow, condition, times[kept], slopes[kept], halves[kept], first, last))


def _in_floats(flow: BodyMotion) -> BodyMotion:
    """The given motion over RR, for the search."""
    if flow.system.field == RR:
        return flow
    body = flow.system.body
    system = replaced(flow.system, body=Body.make(tuple(map(float, body.inertia)), float(body.d), RR))
    gamma, M = (tuple(map(float, v)) for v in flow.state.vectors)
    return type(flow)(system, State((gamma[0], gamma[1], gamma[2]), (M[0], M[1], M[2]), tilted=flow.state.tilted))


def _stretches(flow: BodyMotion, first: float, last: float) -> Iterator[tuple[float, float, float]]:
    """Divides an interval of time into stretches (start, end, length of a panel); a panel is a fraction of a turn."""
    length = PANEL_STEPS * flow.setup.step_time
    coarse = float(np.spacing(max(abs(first), abs(last))))
    if coarse > COARSEST * length:
        raise PrecisionLoss(
            f"start = {first}, end = {last}: floats near these times are {coarse:.1e} apart, and the body turns in "
            f"about {length:.1e}; zeros are searched for in floats, so nearer to 0 only"
        )
    if last - first > MOST_PANELS * length:
        raise Infeasible(
            f"start = {first}, end = {last}: more than {MOST_PANELS} parts of a turn are to be searched; search part "
            "by part"
        )
    while first < last:
        end = min(last, first + PANELS * length)
        yield first, end, length
        first = end


def _column(flow: BodyMotion, condition: Condition, times: np.ndarray) -> np.ndarray:
    return _values(flow, condition, times)[:, None]


def _values(flow: BodyMotion, condition: Condition, times: np.ndarray) -> np.ndarray:
    run = flow.at(times)
    values = np.asarray(condition(run.gamma, run.M))
    if values.shape != (len(times),):
        raise ArgumentError(
            f"condition: values of shape {values.shape} for {len(times)} states; one number for each is needed"
        )
    return values


def _polished(
    flow: BodyMotion,
    condition: Condition,
    times: np.ndarray,
    slopes: np.ndarray,
    halves: np.ndarray,
    first: float | Mpf,
    last: float | Mpf,
) -> np.ndarray:
    """Refines zeros to the precision of the flow, by Newton's method with the slopes of the panels, and keeps those
    between ``first`` and ``last``.
    """
    field = flow.system.field
    found = np.array([field.coerce(float(t)) for t in times], dtype=np.float64 if field == RR else object)
    rates = np.array(slopes, dtype=found.dtype)
    before = np.full(len(found), np.inf)
    for _ in range(MOST_STEPS):
        if not len(found):
            return found
        steps = _values(flow, condition, found) / rates
        sizes = np.abs(steps).astype(float)
        # a zero is accurate to rounding once a step is hardly shorter than the one before
        moving = sizes < before / 2
        if not moving.any():
            # a zero at the start or the end may be found outside by rounding
            inside = np.array(
                [first - near <= t <= last + near for t, near in zip(found, field.eps * ROUNDING * halves, strict=True)]
            )
            return np.clip(found[inside], first, last)
        found = np.where(moving, found - steps, found)
        before = np.where(moving, sizes, 0.0)
    raise PrecisionLoss(f"after {MOST_STEPS} steps of Newton a zero near t = {float(found[0])} has not settled")
