"""Repeated runs of one thing, and the medians of what they take."""

from __future__ import annotations

import statistics
from collections.abc import Callable
from typing import Any

__all__ = ["Tick", "Timed", "silent", "timed"]

Tick = Callable[[str], None]
"""Called before a piece of work with its name, for a progress bar."""
Timed = tuple[tuple[float, ...], Any]
"""Seconds of the set-up, if there is one, and of the evaluation; and what was found."""


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
