"""Multiples of rows, each by a scalar of its own: a ladder on a few thousand rows at once, on one thread.

The argument ``run`` is a :class:`jacobian.batch.stored_rows.StoredRows`, whose ``add_here``, ``double_here`` and
``negate_here`` are the group law on the calling thread.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np


def multiply_by_each(run: Any, x: Any, scalars: Sequence[int]) -> Any:
    """The rows m_i·x_i, by digits that are never 0, so that no row adds the identity.

    An odd m < 2^n is Σ ±2^i over i < n; three signs together make an odd digit from −7 to 7 (Joye and Tunstall 2009).
    For an even m, m + 1 is used, and x is subtracted at the end.
    """
    negative = np.array([m < 0 for m in scalars])
    if negative.any():
        turned = np.flatnonzero(negative)
        x = run.replaced(x, turned, run.negate_here(run.take(x, turned)))
    windows = signed_windows([abs(m) | 1 for m in scalars])
    double, odd = run.double_here(x), [x]
    for _ in range(3):
        odd.append(run.add_here(odd[-1], double))
    # entry w is (2w − 7)·x
    table = [run.negate_here(part) for part in odd[::-1]] + odd
    stacked = [np.stack(parts) for parts in zip(*table, strict=True)]
    result = run.selected(stacked, windows[-1])
    for window in windows[-2::-1]:
        for _ in range(3):
            result = run.double_here(result)
        result = run.add_here(result, run.selected(stacked, window))
    even = np.flatnonzero([m % 2 == 0 for m in scalars])
    if len(even):
        opposite = run.negate_here(run.take(x, even))
        result = run.replaced(result, even, run.add_here(run.take(result, even), opposite))
    return result


def signed_windows(scalars: Sequence[int]) -> Any:
    """The digits w of odd scalars m > 0, (number of digits, N), with m = Σ (2w_j − 7)·8^j."""
    digits = -(-max(m.bit_length() for m in scalars) // 3)
    size = -(-3 * digits // 8)
    top = 1 << (3 * digits - 1)
    packed = b"".join(((m >> 1) + top).to_bytes(size, "little") for m in scalars)
    bits = np.unpackbits(np.frombuffer(packed, np.uint8).reshape(len(scalars), size), axis=1, bitorder="little")
    return np.ascontiguousarray((bits[:, : 3 * digits].reshape(len(scalars), digits, 3) @ np.array([1, 2, 4])).T)
