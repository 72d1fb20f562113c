"""Refused rows of a run: which rows ``strict=False`` keeps, and the reasons for refusing the others."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from jacobian.element import Real
from jacobian.errors import Infeasible, PrecisionLoss

REFUSALS = (PrecisionLoss, Infeasible)
"""The errors for which a row is refused. Errors in the arguments are raised for either value of ``strict``."""

Compute = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


class Rows(NamedTuple):
    """States as rows of numbers, such as γ and M side by side, shape (N, 6); τ, shape (N,); and the ``status`` and
    ``reasons`` of a Trajectory.
    """

    rows: np.ndarray
    tau: np.ndarray
    status: np.ndarray | None = None
    reasons: tuple[str, ...] = ("",)


def kept_rows(compute: Compute, values: np.ndarray, nan: Real, width: int = 6) -> Rows:
    """The result of ``compute(values)``: rows of ``width`` numbers, and τ. Rows that it refuses are ``nan``.

    If a time is refused because it is too far, all farther times in its direction are refused too. So in each direction
    bisection finds the first refused time, and the times before it are computed together.
    """
    status, reasons = np.zeros(len(values), dtype=np.intp), [""]
    left = np.arange(len(values))
    rows, tau = np.full((len(values), width), nan, values.dtype), np.full(len(values), nan, values.dtype)
    while True:
        try:
            rows[left], tau[left] = compute(values[left])
            break
        except REFUSALS as error:
            order = left[np.argsort(np.abs(values[left]), kind="stable")]
            back = np.array([t < 0 for t in values[order]], dtype=bool)
            found = [_refused(compute, values, order[chosen]) for chosen in (~back, back)]
            if not any(why for _, why in found):
                found = [_refused(compute, values, order, str(error))]
            for beyond, why in found:
                status[beyond] = _place(reasons, why)
            left = left[status[left] == 0]
            if not len(left):
                break
    return Rows(rows, tau, status, tuple(reasons))


def refused_rows(found: Rows, refused: dict[int, str], nan: Real) -> Rows:
    """A copy of the rows in which the rows in ``refused`` are NaN and have their reasons."""
    if not refused:
        return found
    rows, tau, reasons = found.rows.copy(), found.tau.copy(), list(found.reasons)
    status = np.zeros(len(rows), dtype=np.intp) if found.status is None else found.status.copy()
    for i, why in refused.items():
        rows[i], tau[i], status[i] = nan, nan, _place(reasons, why)
    return Rows(rows, tau, status, tuple(reasons))


def _place(reasons: list[str], why: str) -> int:
    if why not in reasons:
        reasons.append(why)
    return reasons.index(why)


def _refused(compute: Compute, values: np.ndarray, order: np.ndarray, why: str = "") -> tuple[np.ndarray, str]:
    """The rows of ``order`` from the first refused one on, found by bisection, and the reason.

    By default each row is tried alone. ``why`` is given if all rows were refused together, for this reason, although
    each alone is accepted. Then each row is tried together with all rows before it.
    """
    together = bool(why)
    low, high = 0, len(order) - together
    probe = high // 2 if together else high - 1
    while low < high:
        try:
            compute(values[order[0 if together else probe : probe + 1]])
            low = probe + 1
        except REFUSALS as error:
            high, why = probe, str(error)
        probe = (low + high) // 2
    return order[high:], why


def common_reasons(parts: Iterable[Sequence[str]]) -> tuple[list[np.ndarray], tuple[str, ...]]:
    """A merged list of the reasons of all parts, and for each part the indices of its reasons in that list."""
    reasons: dict[str, int] = {"": 0}
    numbers = [np.array([reasons.setdefault(reason, len(reasons)) for reason in part]) for part in parts]
    return numbers, tuple(reasons)
