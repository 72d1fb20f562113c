"""The running of a study: rows go to worker processes, each under its time limit, and their results to the store.

A worker that hangs, crashes or is killed costs its row alone: the row is kept as a failure that says so.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from typing import Any

from filelock import FileLock

from integrable.study.plan import Task
from integrable.study.store import Store
from jacobian.numbers.compiler import NoCacheWarning

__all__ = ["run_tasks"]

_POLL = 0.2
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def run_tasks(
    rows: Sequence[Task], store: Store, jobs: int, progress: Callable[[Task], None] = lambda _row: None
) -> dict[str, dict[str, Any]]:
    """Every row, kept ones read and the others measured by ``jobs`` processes: contents of their files by key.

    Rows that another process holds are waited for, and taken over when it dies. ``progress`` is called with each row
    that is finished.
    """
    pending = {row.key: row for row in rows}
    finished: dict[str, dict[str, Any]] = {}
    looked: set[str] = set()
    workers = [_Worker() for _ in range(jobs)]
    try:
        while pending or any(worker.row for worker in workers):
            moved = False
            for row in [row for row in pending.values() if _ready(row, finished)]:
                if row.key not in looked:
                    looked.add(row.key)
                    kept = store.read(row.key, row.stamp)
                    if kept is not None:
                        finished[pending.pop(row.key).key] = kept
                        progress(row)
                        moved = True
                        continue
                free = next((worker for worker in workers if worker.row is None), None)
                if free is None:
                    continue
                if free.take(row, store, finished):
                    del pending[row.key]
                else:  # another process is at it, or has just finished it: look again
                    looked.discard(row.key)
            wait([w.connection for w in workers if w.row and w.connection], _POLL)
            for worker in workers:
                content = worker.finished()
                if content is not None:
                    assert worker.row is not None, "a worker that has finished had a row"
                    row = worker.row
                    content.setdefault("seconds", worker.elapsed)
                    finished[row.key] = store.write(row.key, row.stamp, content)
                    worker.let_go(store)
                    progress(row)
                    moved = True
            if not moved and not any(worker.row for worker in workers):
                time.sleep(_POLL)
    finally:
        for worker in workers:
            worker.stop()
            worker.let_go(store)
    return finished


def _ready(row: Task, finished: dict[str, Any]) -> bool:
    return all(key is None or key in finished for key in (row.truth, row.cheaper))


class _Worker:
    """A process that measures one row at a time; it is started when it gets its first row, and again after a death."""

    def __init__(self) -> None:
        self.row: Task | None = None
        self.connection: Connection | None = None
        self._process: Any = None
        self._lock: FileLock | None = None
        self._begun = 0.0

    @property
    def elapsed(self) -> float:
        """Seconds since the row was begun."""
        return time.monotonic() - self._begun

    def take(self, row: Task, store: Store, finished: dict[str, Any]) -> bool:
        """Begin a row, unless another process is at it or has just finished it."""
        lock = store.claim(row.key)
        if lock is None:
            return False
        if store.read(row.key, row.stamp) is not None:
            store.release(lock)
            return False
        self.row, self._lock, self._begun = row, lock, time.monotonic()
        if self._process is None:
            self._start()
        truth = finished[row.truth].get("result") if row.truth else None
        stopped = finished[row.cheaper].get("stopped", False) if row.cheaper else False
        assert self.connection is not None, "a started worker has a connection"
        self.connection.send((row, truth, stopped))
        return True

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self._process = context.Process(target=_work, args=(theirs,), daemon=False)
        self._process.start()
        theirs.close()

    def finished(self) -> dict[str, Any] | None:
        """The content of the row's file, once there is one: a result, or what became of the worker."""
        if self.row is None or self.connection is None:
            return None
        if self.connection.poll():
            try:
                content: dict[str, Any] = self.connection.recv()
            except (EOFError, OSError):
                self._process.join()
                code = self._process.exitcode
                self.stop()
                return _failure(self.row, f"the process died with exit code {code}", stopped=True)
            return content
        if self.elapsed > self.row.limit:
            self.stop()
            return _failure(self.row, f"stopped after {self.row.limit:g} s", stopped=True)
        return None

    def let_go(self, store: Store) -> None:
        """End the claim on the row."""
        store.release(self._lock)
        self.row, self._lock = None, None

    def stop(self) -> None:
        """End the process."""
        if self._process is not None:
            _end(self._process)
            assert self.connection is not None, "a started worker has a connection"
            self.connection.close()
            self._process, self.connection = None, None


def _end(process: Any) -> None:
    """Kill a worker and the processes that it has started: they would go on computing beside the next rows."""
    if hasattr(os, "killpg"):  # Windows has no groups to kill
        with suppress(ProcessLookupError, PermissionError):
            # its group, once it has made one
            if os.getpgid(process.pid) == process.pid:
                os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.join()


def _failure(row: Task, error: str, *, stopped: bool = False) -> dict[str, Any]:
    return {**_head(row), "status": "failed", "error": error, "stopped": stopped, "result": None}


def _head(row: Task) -> dict[str, Any]:
    from integrable.scene.output import machine, versions

    return {
        "row": {
            "scene": row.scene.name,
            "kind": row.kind,
            "method": row.method,
            "setting": row.setting,
            "value": row.value,
        },
        "versions": versions(),
        "machine": machine(),
    }


def _work(connection: Connection) -> None:
    """The loop of a worker process: it ends with the connection, that is, with the process that started it."""
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)
    warnings.simplefilter("ignore", NoCacheWarning)  # the parent has said so
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # an interrupt ends the parent, which ends its workers
    for name in _THREADS:
        os.environ.setdefault(name, "1")
    from integrable.study.measure import TooLong, Unjudged, measured

    while True:
        try:
            row, truth, stopped = connection.recv()
        except (EOFError, OSError):
            return
        begun = time.perf_counter()
        if stopped:
            content = _failure(row, "not run: a cheaper setting takes too long", stopped=True)
        else:
            try:
                result = measured(row, truth)
                content = {**_head(row), "status": "done", "error": "", "stopped": False, "result": result}
            except TooLong as error:
                content = _failure(row, str(error), stopped=True)
            except Unjudged as error:
                content = _failure(row, str(error))
            except Exception as error:  # whatever a method does is a finding about it
                content = _failure(row, f"{type(error).__name__}: {' '.join(str(error).split())}")
        content["seconds"] = time.perf_counter() - begun
        try:
            connection.send(content)
        except (BrokenPipeError, OSError):
            return
