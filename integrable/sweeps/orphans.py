"""What keeps worker processes from outliving the process that has started them.

One that is ended by a signal tells its workers nothing: those of a pool would wait for work for ever, and others finish
what they are at first.
"""

from __future__ import annotations

import os
import signal
from multiprocessing import parent_process
from multiprocessing.connection import wait
from threading import Thread

__all__ = ["end_with_parent"]


def end_with_parent() -> None:
    """In a process of :mod:`multiprocessing`: from now on it ends as soon as its parent has, with its group if it
    leads one.
    """
    parent = parent_process()
    if parent is not None:
        Thread(target=_watch, args=(parent.sentinel,), name="waits for the end of the parent", daemon=True).start()


def _watch(sentinel: int) -> None:
    wait([sentinel])
    if hasattr(os, "killpg") and os.getpgrp() == os.getpid():
        os.killpg(os.getpid(), signal.SIGKILL)
    os._exit(1)
