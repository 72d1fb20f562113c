"""Progress messages of long computations: the logger ``jacobian.progress``."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator
from threading import Lock
from time import perf_counter
from typing import TypeVar

Thing = TypeVar("Thing")

LOG = logging.getLogger(__name__)
# in seconds: the time before the first message, the least time that counts as long, the time between two messages
FIRST, LONG, SAID_AGAIN = 0.5, 5.0, 5.0


class Progress:
    """Reports the completed part of ``work`` and the remaining time every few seconds, at level INFO. One message is a
    warning, which Python shows by default: the first at which the remaining or the elapsed time is long. ``part``: the
    numbers of earlier parts and of all parts of the computation.
    """

    def __init__(self, name: str, work: float, part: tuple[int, int] = (0, 1)) -> None:
        self.name, self.work, self.part = name, work, part
        self._done, self._begun, self._lock = 0.0, perf_counter(), Lock()
        self._next, self._warned = self._begun + FIRST, False

    def add(self, work: float) -> None:
        """Adds to the completed work, and logs a message where one is due."""
        with self._lock:
            self._done += work
            now, (before, parts) = perf_counter(), self.part
            done = self._done / self.work
            # the quotient may underflow
            if now < self._next or not done:
                return
            left = (now - self._begun) / done * (parts - before - done)
            long = left >= LONG or now - self._begun >= LONG
            level = logging.WARNING if long and not self._warned else logging.INFO
            self._next, self._warned = now + SAID_AGAIN, self._warned or long
            # the message is logged while the lock is held, so that messages of two threads keep their order
            LOG.log(level, "%s: %.0f %% done, about %.0f s left", self.name, 100 * (before + done) / parts, left)


def counted(things: Iterable[Thing], name: str, count: float) -> Iterator[Thing]:
    """Yields the things, ``count`` of them, and reports the progress."""
    progress = Progress(name, count)
    for thing in things:
        yield thing
        progress.add(1)
