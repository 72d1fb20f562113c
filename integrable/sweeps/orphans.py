"""Worker processes that end with the process that started them.

A process killed by a signal does not notify its workers. Workers of a pool would wait for work for ever, and other
worker processes would first finish their task.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context, parent_process
from multiprocessing.connection import wait
from threading import Thread
from typing import Any

from jacobian.interrupts import shielded

__all__ = ["end_with_parent", "processes"]

# where an interrupt ends a process at once, the resource tracker of multiprocessing, a process with the filters of that
# one, would write warnings about semaphores to stderr
UNTRACKED = "ignore:resource_tracker:UserWarning"


class _Processes(ProcessPoolExecutor):
    """A pool that starts processes when there is work. An interrupt of this process does not reach its workers."""

    def submit(self, *arguments: Any, **options: Any) -> Future[Any]:
        with shielded():
            return super().submit(*arguments, **options)


@contextmanager
def processes(count: int) -> Iterator[ProcessPoolExecutor]:
    """A pool of ``count`` processes. They are killed if an exception, such as an interrupt, leaves the block."""
    if UNTRACKED not in sys.warnoptions:
        sys.warnoptions.append(UNTRACKED)
    # processes are spawned, because a fork would copy the locks of this process's threads
    pool = _Processes(count, mp_context=get_context("spawn"), initializer=end_with_parent)
    try:
        yield pool
    except BaseException:
        for worker in list((getattr(pool, "_processes", None) or {}).values()):
            worker.kill()
        raise
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def end_with_parent() -> None:
    """Makes this process end as soon as its parent does, together with its process group if it leads one.

    It has an effect only in processes started by :mod:`multiprocessing`.
    """
    parent = parent_process()
    if parent is not None:
        Thread(target=_watch, args=(parent.sentinel,), name="waits for the end of the parent", daemon=True).start()


def _watch(sentinel: int) -> None:
    wait([sentinel])
    if hasattr(os, "killpg") and os.getpgrp() == os.getpid():
        os.killpg(os.getpid(), signal.SIGKILL)
    os._exit(1)
