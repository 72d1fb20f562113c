"""Threads for batches and long products. Each thread takes ranges of rows, in kernels that release Python's lock."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from jacobian.errors import whole

_count: int | None = None
_pools: dict[tuple[int, int], ThreadPoolExecutor] = {}


def threads() -> int:
    """The number of threads for large batches: the argument of :func:`set_threads`, or by default the number of
    processors that this process may use.
    """
    if _count is not None:
        return _count
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def set_threads(count: int | None) -> None:
    """Spreads large batches over ``count`` threads; None for the number of processors."""
    global _count
    if count is not None:
        count = whole(count, "count", "an int ≥ 1, or None for all processors", 1)
    _count = count


def in_ranges(total: int, size: int, work: Callable[[int, int], Any], most: int | None = None) -> list[Any]:
    """The results of work(begin, end) for consecutive ranges that cover ``total`` rows, in order.

    A range has at most ``size`` rows. The ranges run on all threads, or on at most ``most``. If several threads are
    used, smaller ranges are taken: all but the last have equal length, and each thread gets about the same number.
    """
    pieces = -(-total // size)
    count = min(threads() if most is None else most, pieces)
    if count > 1:
        pieces = -(-pieces // count) * count
        size = -(-total // pieces)
    ranges = [(begin, min(begin + size, total)) for begin in range(0, total, size)]
    if count < 2:
        return [work(begin, end) for begin, end in ranges]
    # a pool does not survive a fork
    key = os.getpid(), count
    if key not in _pools:
        _pools[key] = ThreadPoolExecutor(count, thread_name_prefix="jacobian-batch")
    return list(_pools[key].map(lambda ends: work(*ends), ranges))
