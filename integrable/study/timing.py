"""Repeated runs of one thing, and the medians of what they take."""

from __future__ import annotations

import signal
import statistics
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import isfinite
from threading import current_thread, main_thread
from typing import Any

__all__ = ["Tick", "Timed", "TooLong", "at_most", "silent", "timed"]

Tick = Callable[[str], None]
"""Called before a piece of work with its name, for a progress bar."""
Timed = tuple[tuple[float, ...], Any]
"""Seconds of the set-up, if there is one, and of the evaluation; and what was found."""


class TooLong(RuntimeError):
    """A run that would take longer than the study allows: a greater cost of the method need not be tried."""


@contextmanager
def at_most(seconds: float, late: BaseException | None = None, busy: bool = False) -> Iterator[None]:
    """Raises TooLong, or ``late``, out of what takes longer: seconds of the clock, if ``busy`` those of this process.
    Only in a main thread, and not on Windows, which has no such alarm: a row there ends with its worker.
    """
    if not isfinite(seconds) or not hasattr(signal, "setitimer") or current_thread() is not main_thread():
        yield
        return

    def ring(*_: Any) -> None:
        raise late or TooLong(f"not run: a trial took more than {seconds:g} s")

    number, clock = (signal.SIGPROF, signal.ITIMER_PROF) if busy else (signal.SIGALRM, signal.ITIMER_REAL)
    before = signal.signal(number, ring)
    signal.setitimer(clock, seconds)
    try:
        yield
    finally:
        signal.setitimer(clock, 0.0)
        signal.signal(number, before)


def silent(*_: Any) -> None:
    """A tick that nobody looks at."""


def timed(
    once: Callable[[], Timed], repeat: int, patience: float, tick: Callable[[], None] = silent
) -> tuple[dict[str, Any], Any]:
    """``once`` at most ``repeat`` times, none begun after ``patience`` seconds, with a ``tick`` between two of them.

    Medians of "setup", "evaluation" and their sum "total", in seconds, the number of "runs"; and what the last found.
    """
    durations: list[tuple[float, ...]] = []
    while len(durations) < repeat and sum(map(sum, durations)) < patience:
        if durations:
            tick()
        duration, found = once()
        durations.append(duration)
    parts = ("setup", "evaluation") if len(durations[0]) == 2 else ()
    result: dict[str, Any] = dict(zip(parts, map(statistics.median, zip(*durations, strict=True)), strict=False))
    return {**result, "total": statistics.median(map(sum, durations)), "runs": len(durations)}, found
