"""Median times of several functions that are run repeatedly, in turn."""

from __future__ import annotations

import signal
import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import isfinite
from threading import current_thread, main_thread
from time import perf_counter
from typing import Any, NamedTuple

from integrable.oracles.method import Spent

__all__ = ["SCATTER", "Tick", "Timed", "Timing", "TooLong", "at_most", "interleaved", "silent"]

Tick = Callable[[str], None]
"""A function that is called with the name of each piece of work before it starts, for a progress bar."""
Timed = tuple[Spent, Any]
"""The costs of a run, and its result."""
SCATTER = 0.1
"""Times that scatter by more than this fraction of their median are measured again; :data:`REMEASURED` limits how
often.
"""
COLD = 0.005
"""Where several functions run in turn, one that takes fewer seconds is run once untimed before each timed run."""
REMEASURED = 4
"""The largest number of runs, as a multiple of the requested number."""


class TooLong(RuntimeError):
    """Raised if a run would take longer than the study allows. Costlier settings of the method need not be tried."""


@contextmanager
def at_most(seconds: float, late: BaseException | None = None, busy: bool = False) -> Iterator[None]:
    """Raises TooLong, or ``late``, in a block that takes more than ``seconds``.

    The seconds are of the clock, or of this process's CPU time if ``busy``. The limit works only in a main thread.
    Windows has no interval timers; there a row that takes too long ends when its worker is killed.
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
    """A tick that does nothing."""


class Timing(NamedTuple):
    """The times of repeated runs of one function."""

    spent: Spent
    """The costs of the median run. The cost once a machine is the largest one, that of the first run."""
    total: float
    """The median run time: the seconds of set-up and evaluation."""
    mad: float
    """The median of |total of a run − median|, divided by the median."""
    runs: int
    found: Any
    """The result of the last run."""

    def as_dict(self) -> dict[str, Any]:
        """Plain data for a row: "machine", "system", "setup" (once a start), "evaluation", "total", "mad", "runs"."""
        machine, system, start, evaluation = self.spent
        parts = {"machine": machine, "system": system, "setup": start, "evaluation": evaluation}
        return {**parts, "total": self.total, "mad": self.mad, "runs": self.runs}


def interleaved(
    every: Mapping[str, Callable[[], Timed]],
    repeat: int,
    patience: float,
    tick: Callable[[], None] = silent,
    again: int = REMEASURED,
) -> dict[str, Timing]:
    """The times of functions that are run in rounds. Each runs once per round, so a slow second affects all alike.

    There are ``repeat`` rounds, and more until no time scatters by more than a tenth of its median: up to ``again``
    times as many. After ``patience`` seconds no further round starts. ``tick`` is called between the first ``repeat``
    rounds.
    """
    spent: dict[str, list[Spent]] = {name: [] for name in every}
    found: dict[str, Any] = {}
    begun, rounds = perf_counter(), 0
    while rounds < repeat or (rounds < again * repeat and max(map(_scatter, spent.values())) > SCATTER):
        if rounds and perf_counter() - begun > patience:
            break
        if 0 < rounds < repeat:
            tick()
        for name, once in every.items():
            if rounds and len(every) > 1 and spent[name][-1].counted < COLD:
                once()  # refill the processor's caches, which hold the previous function's data
            part, found[name] = once()
            spent[name].append(part)
        rounds += 1
    return {name: _timing(runs, found[name]) for name, runs in spent.items()}


def _scatter(runs: Sequence[Spent]) -> float:
    counted = [run.counted for run in runs]
    middle = statistics.median(counted)
    return statistics.median(abs(x - middle) for x in counted) / middle if middle else 0.0


def _timing(runs: Sequence[Spent], found: Any) -> Timing:
    middle = sorted(runs, key=lambda run: run.counted)[(len(runs) - 1) // 2]
    spent = middle._replace(machine=max(run.machine for run in runs))
    return Timing(spent, spent.counted, _scatter(runs), len(runs), found)
