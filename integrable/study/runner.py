"""Runs a study: worker processes do the tasks, each within its time limit, and results go to the store.

If a worker hangs, crashes or is killed, only its task is lost; it is stored as a failure with the reason.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from datetime import UTC, datetime, timedelta
from math import inf
from multiprocessing.connection import Connection, wait
from typing import Any

from filelock import FileLock

from integrable.study.plan import NOT_MEASURED, Task
from integrable.study.store import Store, commit
from integrable.study.timing import TooLong, at_most
from integrable.sweeps.orphans import end_with_parent
from jacobian.interrupts import shielded
from jacobian.numbers.compiler import NoCacheWarning

__all__ = ["ONE_RUN", "run_tasks"]

ONE_RUN = timedelta(days=1)
"""Timed rows that are further apart than this belong to different runs."""
_POLL = 0.2
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def run_tasks(
    tasks: Sequence[Task],
    store: Store,
    jobs: int,
    progress: Callable[[Task], None] = lambda _task: None,
    seconds: float = inf,
) -> dict[str, dict[str, Any]]:
    """Measures all tasks that are not stored; returns the contents of the files of all tasks, by key.

    ``jobs`` processes compute truths and floors; timed tasks run alone. Tasks that another process holds are awaited,
    and taken over if that process dies. ``progress`` is called with each finished task. No task begins after
    ``seconds``; the remaining ones are neither measured nor stored.
    """
    until = time.monotonic() + seconds
    pending = {task.key: task for task in tasks}
    finished: dict[str, dict[str, Any]] = {}
    looked: set[str] = set()
    workers = [_Worker() for _ in range(jobs)]
    try:
        while pending or any(worker.task for worker in workers):
            late = time.monotonic() > until
            done = _hand_out(pending, looked, workers if not late else (), store, finished)
            if late and not done and not any(worker.task for worker in workers):
                break
            wait([w.connection for w in workers if w.task and w.connection], _POLL)
            done += _collect(workers, store, finished)
            for task in done:
                progress(task)
            if not done and not any(worker.task for worker in workers):
                time.sleep(_POLL)
    finally:
        for worker in workers:
            worker.stop()
            worker.let_go()
    for task in pending.values():
        finished[task.key] = _kept(task, store) or _failure(task, "the time was up") | {
            "status": NOT_MEASURED,
            "seconds": 0.0,
        }
    return finished


def _kept(task: Task, store: Store) -> dict[str, Any] | None:
    """The stored row of a task, or None. A timed row a day old does not count, since it belongs to another run."""
    content = store.read(task.key, task.stamp)
    if content is None or not task.timed:
        return content
    age = datetime.now(UTC) - datetime.fromisoformat(content["date"])
    return content if age < ONE_RUN else None


def _hand_out(
    pending: dict[str, Task], looked: set[str], workers: Sequence[_Worker], store: Store, finished: dict[str, Any]
) -> list[Task]:
    """Gives tasks of ``pending`` to free workers, if the results that the tasks depend on are there. Stored results are
    read instead; the tasks to which they belong are returned. ``looked`` holds the keys already looked up in the store.
    """
    kept = []
    for task in [task for task in pending.values() if _ready(task, finished)]:
        if task.key not in looked:
            looked.add(task.key)
            content = _kept(task, store)
            if content is not None:
                finished[task.key] = content
                kept.append(pending.pop(task.key))
                continue
        busy = [worker.task for worker in workers if worker.task]
        free = next((worker for worker in workers if worker.task is None), None)
        # a timed task runs alone on the machine
        if free is None or (busy and task.timed) or any(other.timed for other in busy):
            continue
        if free.take(task, store, finished):
            del pending[task.key]
        else:  # another process works on it or has just finished it, so look again
            looked.discard(task.key)
    return kept


def _collect(workers: Sequence[_Worker], store: Store, finished: dict[str, Any]) -> list[Task]:
    done = []
    for worker in workers:
        content, task = worker.finished(), worker.task
        if content is not None and task is not None:
            content.setdefault("seconds", worker.elapsed)
            content["commit"] = commit()  # the commit at this process's start: a worker may begin hours later
            finished[task.key] = store.write(task.key, task.stamp, content)
            worker.let_go()
            done.append(task)
    return done


def _ready(task: Task, finished: dict[str, Any]) -> bool:
    return all(key is None or key in finished for key in (task.truth, task.cheaper))


class _Worker:
    """A process that measures one task at a time. It starts with its first task, and is restarted if it dies."""

    def __init__(self) -> None:
        self.task: Task | None = None
        self.connection: Connection | None = None
        self._process: Any = None
        self._locks: list[FileLock] = []
        self._begun = 0.0

    @property
    def elapsed(self) -> float:
        return time.monotonic() - self._begun

    def take(self, task: Task, store: Store, finished: dict[str, Any]) -> bool:
        """Start a task, unless another process works on it or has just finished it."""
        # two studies in one folder must not time tasks at the same moment
        locks = [store.claim(name) for name in (task.key, *(["timing"] if task.timed else []))]
        held = [lock for lock in locks if lock is not None]
        if len(held) < len(locks) or _kept(task, store) is not None:
            for lock in held:
                lock.release()
            return False
        self.task, self._locks, self._begun = task, held, time.monotonic()
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
        with shielded():
            self._process.start()
        theirs.close()

    def finished(self) -> dict[str, Any] | None:
        """The content of the task's file, once there is one: a result, or the reason of the worker's failure."""
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

    def let_go(self) -> None:
        for lock in self._locks:
            lock.release()
        self.task, self._locks = None, []

    def stop(self) -> None:
        if self._process is not None:
            _end(self._process)
            assert self.connection is not None, "a started worker has a connection"
            self.connection.close()
            self._process, self.connection = None, None


def _end(process: Any) -> None:
    """Kill a worker and the processes that it has started, which would disturb the next tasks."""
    if hasattr(os, "killpg"):  # Windows has no process groups
        with suppress(ProcessLookupError, PermissionError):
            # a worker that leads no group belongs to the group of this process
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
        "commit": commit(),
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def _work(connection: Connection) -> None:
    """The loop of a worker process, which ends with the process that started it."""
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)
    end_with_parent()
    warnings.simplefilter("ignore", NoCacheWarning)  # the parent has printed this warning
    warnings.simplefilter("ignore", RuntimeWarning)  # a comparator's values may overflow; its row says so
    # where there is no setpgid, as on Windows, Ctrl-C would end the process
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in _THREADS:
        os.environ.setdefault(name, "1")
    used: set[tuple[str, str]] = set()
    while True:
        try:
            task, truth, stopped = connection.recv()
        except (EOFError, OSError):
            return
        begun = time.perf_counter()
        content = _failure(task, "not run: a cheaper setting takes too long", stopped=True)
        if not stopped:
            _use_first(task, used)
            content = _content(task, truth)
        content["seconds"] = time.perf_counter() - begun
        try:
            connection.send(content)
        except (BrokenPipeError, OSError):
            return


def _use_first(task: Task, used: set[tuple[str, str]]) -> None:
    """Measures the first use of the flow for a kind of system, before other tasks import and compile its code."""
    from integrable.study.rivals import FIRST, first_use

    kind = task.scene.system, task.kernel
    if task.scene.steps is None and kind not in used:
        used.add(kind)
        # where the flow refuses the motion, or takes long, its own row says so
        with suppress(Exception), at_most(FIRST):
            first_use(task)


def _content(task: Task, truth: dict[str, Any] | None) -> dict[str, Any]:
    """The content of a task's file: its result, or the reason why there is none."""
    from integrable.study.measure import Unjudged, measured

    try:
        result = measured(task, truth)
        return {**_head(task), "status": "done", "error": "", "stopped": False, "result": result}
    except TooLong as error:
        return _failure(task, str(error), stopped=True)
    except Unjudged as error:
        return _failure(task, str(error))
    except Exception as error:  # any failure of a method is a finding about it
        return _failure(task, f"{type(error).__name__}: {' '.join(str(error).split())}")
