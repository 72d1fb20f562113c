"""Refused rows of a run: which rows ``strict=False`` keeps, and the reasons for refusing the others."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from jacobian.element import Real
from jacobian.errors import Infeasible, PrecisionLoss

REFUSALS = (PrecisionLoss, Infeasible)
"""The errors that refuse a row. Errors of use are raised for either value of ``strict``."""

Compute = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


class Rows(NamedTuple):
    """γ and M side by side, shape (N, 6), τ, shape (N,), and the ``status`` and ``reasons`` of a Trajectory."""

    rows: np.ndarray
    tau: np.ndarray
    status: np.ndarray | None = None
    reasons: tuple[str, ...] = ("",)


def kept_rows(compute: Compute, values: np.ndarray, nan: Real) -> Rows:
    """The rows and τ of ``compute(values)``; rows that it refuses are ``nan``.

    A time that is too far is refused in any call. So bisection over single rows finds the first refused distance in
    each direction, and the rows before it are computed together.
    """
    status, reasons = np.zeros(len(values), dtype=np.intp), [""]
    left = np.arange(len(values))
    rows, tau = np.full((len(values), 6), nan, values.dtype), np.full(len(values), nan, values.dtype)
    while True:
        try:
            rows[left], tau[left] = compute(values[left])
            break
        except REFUSALS:
            for beyond, why in list(_too_far(compute, values, left)) or _too_many(compute, values, left):
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


def _too_far(compute: Compute, values: np.ndarray, left: np.ndarray) -> Iterable[tuple[np.ndarray, str]]:
    """(rows, reason) in each direction of time: the first refused time and all beyond it."""
    for sign in (1, -1):
        chosen = left[np.array([(t < 0) == (sign < 0) for t in values[left]], dtype=bool)]
        order = chosen[np.argsort(np.abs(values[chosen]), kind="stable")]
        low, high, why = 0, len(order), ""
        probe = high - 1
        while low < high:
            said = _refusal(compute, values[order[probe : probe + 1]])
            if said:
                high, why = probe, said
            else:
                low = probe + 1
            probe = (low + high) // 2
        if why:
            yield order[high:], why


def _too_many(compute: Compute, values: np.ndarray, left: np.ndarray) -> Iterable[tuple[np.ndarray, str]]:
    """(rows, reason) if each row is accepted alone: the first, by distance, that is refused together with those before
    it, and all beyond.
    """
    order = left[np.argsort(np.abs(values[left]), kind="stable")]
    low, high, why = 0, len(order), ""
    while high - low > 1:
        middle = (low + high) // 2
        said = _refusal(compute, values[order[:middle]])
        if said:
            high, why = middle, said
        else:
            low = middle
    yield order[low:], why or _refusal(compute, values[order])


def _refusal(compute: Compute, values: np.ndarray) -> str:
    """The reason why the rows are refused, or "" if they are accepted."""
    try:
        compute(values)
    except REFUSALS as error:
        return str(error)
    return ""


def common_reasons(parts: Iterable[Sequence[str]]) -> tuple[list[np.ndarray], tuple[str, ...]]:
    """A merged list of the reasons of all parts, and for each part the new numbers of its reasons."""
    reasons: dict[str, int] = {"": 0}
    numbers = [np.array([reasons.setdefault(reason, len(reasons)) for reason in part]) for part in parts]
    return numbers, tuple(reasons)
