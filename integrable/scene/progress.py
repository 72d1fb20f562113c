"""The progress bar of the commands, on stderr: it moves with the work, and its clock runs during each piece."""

from __future__ import annotations

import logging
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["bar_of_pieces", "going", "often"]

TERMINAL, FILE = 0.5, 10.0
"""Seconds between two redraws, on a terminal and in a file."""


@contextmanager
def bar_of_pieces(name: str, total: int) -> Iterator[Callable[[str], None]]:
    """A bar for ``total`` pieces of work. Yields a function to call with each piece's name before the piece starts."""
    from tqdm import tqdm

    begun = False
    layout = "{l_bar}{bar}| {n_fmt}/{total_fmt} [{elapsed}]"
    with tqdm(total=total, leave=False, bar_format=layout) as bar, going(bar, TERMINAL), compilation_said(bar):

        def tick(label: str) -> None:
            nonlocal begun
            bar.update(begun)
            bar.set_description(f"{name}: {label}")
            begun = True

        yield tick
        bar.update(1)
        # tqdm would leave out a redraw so soon after another one
        bar.refresh()


@contextmanager
def compilation_said(bar: Any) -> Iterator[None]:
    """Prints a message above the bar when loops are compiled, which happens only on first use."""
    log, handler = logging.getLogger("jacobian.native.library"), logging.Handler(logging.INFO)
    handler.emit = lambda record: bar.write(record.getMessage(), file=sys.stderr)  # type: ignore[method-assign]
    level = log.level
    log.addHandler(handler)
    log.setLevel(logging.INFO)
    try:
        yield
    finally:
        log.removeHandler(handler)
        log.setLevel(level)


@contextmanager
def going(bar: Any, seconds: float) -> Iterator[None]:
    """Redraws a bar repeatedly while the block runs, so that the bar's clock advances during a long piece of work."""
    over = threading.Event()

    def draw() -> None:
        while not over.wait(seconds):
            bar.refresh()

    thread = threading.Thread(target=draw, name="progress bar", daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def often() -> float:
    """Seconds between two redraws of a bar on stderr."""
    return TERMINAL if sys.stderr.isatty() else FILE
