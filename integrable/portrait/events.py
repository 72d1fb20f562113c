"""Events along a motion: zeros of a function of the state, refined by Newton's method on the motion itself."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from integrable.torus.panels import Panels, distinct, zeros
from jacobian import RR
from jacobian.element import Number
from jacobian.errors import ArgumentError, Infeasible, PrecisionLoss, one_of, shown
from jacobian.fields.multiprecision import Mpf

Condition = Callable[[np.ndarray, np.ndarray], np.ndarray]
# number of panels that are searched together
PANELS = 512
# the largest number of panels of one search, each of which takes some ten microseconds
MOST_PANELS = 10_000_000
# the tolerance of the series of the condition on panels, whose zeros only start Newton's method on the motion
TOLERANCE = 1e-12
# if neighbouring floats are farther apart than this fraction of a panel, the states at rounded times form no smooth
# series
COARSEST = 1e-7
# a zero is kept if it lies outside the interval by at most ROUNDING·eps times half the length of a panel
ROUNDING = 1e3
# the largest number of steps of Newton's method; slopes are floats, so each step gains about twelve digits
MOST_STEPS = 100
# a zero is rejected if Newton's method moves it farther than NEAR or leaves it uncertain by more than SHARP, both in
# units of half a panel
NEAR, SHARP = 0.25, 1e-6


def event_times(flow: Any, condition: Condition, start: Number, end: Number, direction: int = 0) -> np.ndarray:
    """The times between ``start`` and ``end`` at which ``condition`` changes sign, in order: see
    :meth:`integrable.portrait.state_flow.StateFlow.events`.
    """
    if not callable(condition):
        raise ArgumentError(
            f"condition = {shown(condition)}: give a function of {' and '.join(flow._vectors)}, arrays of shape (N, n)"
        )
    floats = flow._over(RR)
    first, last = (flow.system.field.coerce(t, name) for t, name in ((start, "start"), (end, "end")))
    if not first < last:
        raise ArgumentError(f"start = {shown(start)}, end = {shown(end)}: a time after start is needed")
    direction = one_of(direction, "direction", (-1, 0, 1), "1 for rising zeros, −1 for falling ones, 0 for both")
    length = floats._panel(float(first), float(last))

    def column(times: np.ndarray) -> np.ndarray:
        return _values(floats, condition, times)[:, None]

    stretches = _stretches(length, float(first), float(last))
    found = [zeros(Panels(column, left, right, length, TOLERANCE)) for left, right in stretches]
    # a zero at the end of a stretch is also found in the next one
    times, slopes, halves = distinct(*(np.concatenate(parts) for parts in zip(*found, strict=True)))
    kept = (direction * slopes >= 0) & (slopes != 0)
    return _polished(flow, condition, (times[kept], slopes[kept], halves[kept]), first, last)


def _stretches(length: float, first: float, last: float) -> Iterator[tuple[float, float]]:
    """Divides an interval of time into stretches (start, end) of PANELS panels."""
    coarse = float(np.spacing(max(abs(first), abs(last))))
    if coarse > COARSEST * length:
        raise PrecisionLoss(
            f"start = {first}, end = {last}: floats near these times are {coarse:.1e} apart, and the motion turns in "
            f"about {length:.1e}; zeros are searched for in floats, so nearer to 0 only"
        )
    if last - first > MOST_PANELS * length:
        raise Infeasible(
            f"start = {first}, end = {last}: more than {MOST_PANELS} parts of a turn are to be searched; search part "
            "by part"
        )
    while first < last:
        end = min(last, first + PANELS * length)
        yield first, end
        first = end


def _values(flow: Any, condition: Condition, times: np.ndarray) -> np.ndarray:
    values = np.asarray(condition(*flow._states(times)))
    if values.shape != (len(times),):
        raise ArgumentError(
            f"condition: values of shape {values.shape} for {len(times)} states; one number for each is needed"
        )
    return values


def _polished(
    flow: Any,
    condition: Condition,
    found: tuple[np.ndarray, np.ndarray, np.ndarray],
    first: float | Mpf,
    last: float | Mpf,
) -> np.ndarray:
    """Refines zeros of the condition to the precision of the flow, and keeps those between ``first`` and ``last``.

    ``found`` has the times of the zeros, the slopes of the condition there, and half the lengths of their panels.
    Newton's method uses these slopes in all of its steps.
    """
    field, (begin, slopes, halves) = flow.system.field, found
    times = np.array([field.coerce(float(t)) for t in begin], dtype=np.float64 if field is RR else object)
    rates = np.array(slopes, dtype=times.dtype)
    before = np.full(len(times), np.inf)
    for _ in range(MOST_STEPS):
        if not len(times):
            return times
        steps = _values(flow, condition, times) / rates
        sizes = np.abs(steps).astype(float)
        # a zero is accurate to rounding once a step is hardly shorter than the one before
        moving = (sizes < before / 2) & (sizes < NEAR * halves)
        if not moving.any():
            right = (sizes < SHARP * halves) & (np.abs((times - begin).astype(float)) < NEAR * halves)
            if field is not RR and not right.all():
                raise PrecisionLoss(
                    f"near t = {begin[~right][0]} floats do not tell whether the condition changes its sign; search "
                    "there in floats, or nearer to 0"
                )
            # rounding may move a zero at the start or the end out of the interval
            near = field.eps * ROUNDING * halves
            right &= np.array([first - x <= t <= last + x for t, x in zip(times, near, strict=True)], dtype=bool)
            return np.clip(times[right], first, last)
        times = np.where(moving, times - steps, times)
        before = np.where(moving, sizes, 0.0)
    raise PrecisionLoss(f"after {MOST_STEPS} steps of Newton a zero near t = {float(times[0])} has not settled")
