"""The running of a study: tasks go to worker processes, each under its time limit, and their results to the store.

A worker that hangs, crashes or is killed costs its task alone, which is kept as a failure that says so.
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
from integrable.study.timing import TooLong
from integrable.sweeps.orphans import end_with_parent
from jacobian.numbers.compiler import NoCacheWarning

__all__ = ["run_tasks"]

_POLL = 0.2
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def run_tasks(
    tasks: Sequence[Task], store: Store, jobs: int, progress: Callable[[Task], None] = lambda _task: None
) -> dict[str, dict[str, Any]]:
    """Every task, kept ones read and the others measured by ``jobs`` processes: contents of their files by key.

    Tasks that another process holds are waited for, and taken over when it dies. ``progress`` is called with each that
    is finished.
    """
    pending = {task.key: task for task in tasks}
    finished: dict[str, dict[str, Any]] = {}
    looked: set[str] = set()
    workers = [_Worker() for _ in range(jobs)]
    try:
        while pending or any(worker.task for worker in workers):
            done = _hand_out(pending, looked, workers, store, finished)
            wait([w.connection for w in workers if w.task and w.connection], _POLL)
            done += _collect(workers, store, finished)
            for task in done:
                progress(task)
            if not done and not any(worker.task for worker in workers):
                time.sleep(_POLL)
    finally:
        for worker in workers:
            worker.stop()
            worker.let_go(store)
    return finished


def _hand_out(
    pending: dict[str, Task], looked: set[str], workers: Sequence[_Worker], store: Store, finished: dict[str, Any]
) -> list[Task]:
    """Take from ``pending`` what is ready: what the store has, which is returned, and what a free worker begins."""
    kept = []
    for task in [task for task in pending.values() if _ready(task, finished)]:
        if task.key not in looked:
            looked.add(task.key)
            content = store.read(task.key, task.stamp)
            if content is not None:
                finished[task.key] = content
                kept.append(pending.pop(task.key))
                continue
        free = next((worker for worker in workers if worker.task is None), None)
        if free is None:
            continue
        if free.take(task, store, finished):
            del pending[task.key]
        else:  # another process is at it, or has just finished it: look again
            looked.discard(task.key)
    return kept


def _collect(workers: Sequence[_Worker], store: Store, finished: dict[str, Any]) -> list[Task]:
    """Keep what the workers have finished, and return those tasks."""
    done = []
    for worker in workers:
        content, task = worker.finished(), worker.task
        if content is not None and task is not None:
            content.setdefault("seconds", worker.elapsed)
            finished[task.key] = store.write(task.key, task.stamp, content)
            worker.let_go(store)
            done.append(task)
    return done


def _ready(task: Task, finished: dict[str, Any]) -> bool:
    return all(key is None or key in finished for key in (task.truth, task.cheaper))


class _Worker:
    """A process that measures one task at a time; it is started when it gets its first, and again after a death."""

    def __init__(self) -> None:
        self.task: Task | None = None
        self.connection: Connection | None = None
        self._process: Any = None
        self._lock: FileLock | None = None
        self._begun = 0.0

    @property
    def elapsed(self) -> float:
        """Seconds since the task was begun."""
        return time.monotonic() - self._begun

    def take(self, task: Task, store: Store, finished: dict[str, Any]) -> bool:
        """Begin a task, unless another process is at it or has just finished it."""
        lock = store.claim(task.key)
        if lock is None:
            return False
        if store.read(task.key, task.stamp) is not None:
            store.release(lock)
            return False
        self.task, self._lock, self._begun = task, lock, time.monotonic()
        if self._process is None:
            self._start()
        truth = finished[task.truth].get("result") if task.truth else None
        stopped = finished[task.cheaper].get("stopped", False) if task.cheaper else False
        assert self.connection is not None, "a started worker has a connection"
        self.connection.send((task, truth, stopped))
        return True

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self._process = context.Process(target=_work, args=(theirs,), daemon=False)
        self._process.start()
        theirs.close()

    def finished(self) -> dict[str, Any] | None:
        """The content of the task's file, once there is one: a result, or what became of the worker."""
        if self.task is None or self.connection is None:
            return None
        if self.connection.poll():
            try:
                content: dict[str, Any] = self.connection.recv()
            except (EOFError, OSError):
                self._process.join()
                code = self._process.exitcode
                self.stop()
                return _failure(self.task, f"the process died with exit code {code}", stopped=True)
            return content
        if self.elapsed > self.task.limit:
            self.stop()
            return _failure(self.task, f"stopped after {self.task.limit:g} s", stopped=True)
        return None

    def let_go(self, store: Store) -> None:
        """End the claim on the task."""
        store.release(self._lock)
        self.task, self._lock = None, None

    def stop(self) -> None:
        """End the process."""
        if self._process is not None:
            _end(self._process)
            assert self.connection is not None, "a started worker has a connection"
            self.connection.close()
            self._process, self.connection = None, None


def _end(process: Any) -> None:
    """Kill a worker and the processes that it has started: they would go on computing beside the next tasks."""
    if hasattr(os, "killpg"):  # Windows has no groups to kill
        with suppress(ProcessLookupError, PermissionError):
            # its group, once it has made one
            if os.getpgid(process.pid) == process.pid:
                os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.join()


def _failure(task: Task, error: str, *, stopped: bool = False) -> dict[str, Any]:
    return {**_head(task), "status": "failed", "error": error, "stopped": stopped, "result": None}


def _head(task: Task) -> dict[str, Any]:
    from integrable.scene.output import machine, versions

    return {
        "row": {
            "scene": task.scene.name,
            "kind": task.kind,
            "method": task.method,
            "setting": task.setting,
            "value": task.value,
        },
        "versions": versions(),
        "machine": machine(),
    }


def _work(connection: Connection) -> None:
    """The loop of a worker process: it ends with the process that started it."""
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)
    end_with_parent()
    warnings.simplefilter("ignore", NoCacheWarning)  # the parent has said so
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # an interrupt ends the parent, which ends its workers
    for name in _THREADS:
        os.environ.setdefault(name, "1")
    from integrable.study.measure import Unjudged, measured

    while True:
        try:
            task, truth, stopped = connection.recv()
        except (EOFError, OSError):
            return
        begun = time.perf_counter()
        if stopped:
            content = _failure(task, "not run: a cheaper setting takes too long", stopped=True)
        else:
            try:
                result = measured(task, truth)
                content = {**_head(task), "status": "done", "error": "", "stopped": False, "result": result}
            except TooLong as error:
                content = _failure(task, str(error), stopped=True)
            except Unjudged as error:
                content = _failure(task, str(error))
            except Exception as error:  # whatever a method does is a finding about it
                content = _failure(task, f"{type(error).__name__}: {' '.join(str(error).split())}")
        content["seconds"] = time.perf_counter() - begun
        try:
            connection.send(content)
        except (BrokenPipeError, OSError):
            return
