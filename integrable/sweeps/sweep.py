"""Motions over a grid of a scene's numbers, or of an ensemble, on any ``concurrent.futures.Executor``."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from integrable.ensembles.bodies import STATES
from integrable.ensembles.computing import OF_BODIES
from integrable.ensembles.ensemble import Ensemble
from integrable.ensembles.members import Contents, Starts, time_rows
from integrable.ensembles.paths import PathEnsemble
from integrable.extras import needed, without
from integrable.files.frame import Column, version
from integrable.files.quantities import about
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from integrable.scene.file import load_scene
from integrable.sweeps.grid import C, Grid
from integrable.sweeps.jobs import Scenes, done
from integrable.sweeps.orphans import processes
from integrable.sweeps.store import Layout, Store
from jacobian.element import File, Numbers, Value
from jacobian.errors import ArgumentError, JacobianError, flag, one_of, shown, whole
from jacobian.numbers.threads import threads

__all__ = ["SweepStopped", "Swept", "sweep"]

CHUNK, CHUNK_STATES = 1024, 1 << 18
# AHEAD is the number of chunks in progress per worker; an executor whose number of workers is not known counts as
# UNKNOWN workers
AHEAD, UNKNOWN = 3, 32
KINDS = ("processes", "threads")


class SweepStopped(JacobianError):
    """Raised when an executor has died. Written chunks are kept, and the same call resumes the sweep."""


@dataclass(frozen=True)
class Swept:
    """The result of :func:`sweep`: the path of the file, the numbers of members and of members with refused rows."""

    path: Path
    members: int
    refused: int

    def _repr_html_(self) -> str:
        from jacobian.notebook import named

        facts = [("file", self.path), ("motions", self.members), ("with rows that were refused", self.refused)]
        return named("sweep", facts)

    def to_xarray(self) -> Any:
        """The content of the file as an ``xarray.Dataset``, which reads only requested parts of the file."""
        needed("xarray", "to_xarray()", "io")
        import xarray

        if self.path.suffix == ".zarr":
            return xarray.open_zarr(self.path, consolidated=False)
        return xarray.open_dataset(self.path, engine="h5netcdf", phony_dims="sort")


def sweep(
    what: Scene | Ensemble | PathEnsemble | str | os.PathLike[str],
    *,
    vary: Mapping[str, str | Iterable[Value]] | None = None,
    times: Numbers | None = None,
    out: File,
    executor: Executor | str = "processes",
    chunk: int | None = None,
    progress: bool = False,
) -> Swept:
    """Computes many motions and writes their states to one file ``out`` (.zarr or .h5), which appears when complete.

    The motions are those of a scene at its times, for all combinations of the numbers in ``vary``, or those of an
    ensemble at ``times``. ``vary`` maps each name ("d", "M.scale", "inertia.2", … in docs/many.md) to a list of numbers
    or to "first:last:count". ``executor`` is "processes" or "threads", whose number is that of
    :func:`jacobian.numbers.threads.threads`, or any ``concurrent.futures.Executor``.

    Each finished chunk of ``chunk`` members is kept in a folder next to ``out``, so the same call resumes a sweep that
    was killed. The states of a refused member are NaN, and the file contains the reason. ``progress`` draws a bar on
    stderr. Raises ArgumentError for wrong arguments, a full disk or another file at ``out``, and SweepStopped if the
    executor dies.
    """
    source = _source(what, vary, times)
    if not isinstance(executor, Executor):
        executor = one_of(executor, "executor", KINDS, "give 'processes', 'threads', or a concurrent.futures.Executor")
    layout = source.layout(chunk)
    bar = flag(progress, "progress") and not without({"tqdm": "the progress bar"})
    store = Store(out, layout)
    if not store.complete:
        with store, _pool(executor, layout.chunks - len(store.done)) as (pool, workers):
            with _bar(source.name, store) if bar else nullcontext(lambda _count: None) as tick:
                _fill(source, store, pool, workers, tick)
            store.finish()
    return Swept(store.path, source.count, store.refused)


@dataclass(frozen=True)
class _Source:
    """The motions of a sweep, at ``times``. ``count`` is the number of members; ``members(begin, end)`` are the motions
    of the members from ``begin`` to ``end`` − 1.
    """

    name: str
    times: np.ndarray
    count: int
    members: Callable[[int, int], Starts[Any, Any]]
    contents: Contents

    def layout(self, chunk: int | None) -> Layout:
        """The layout of the file, with ``chunk`` members in each chunk; None: a number that suits members and times."""
        if chunk is None:
            chunk = max(1, min(CHUNK, CHUNK_STATES // max(1, len(self.times)), -(-self.count // 4)))
        # a chunk has at most all members, so that all larger values of ``chunk`` give the same layout
        chunk = min(whole(chunk, "chunk", "an int ≥ 1 is needed", 1), max(1, self.count))
        contents = self.contents
        arrays = {"times": self.times, **{name: column.values for name, column in contents.parameters.items()}}
        known = {name: [array.shape, _digest(array.tobytes())] for name, array in arrays.items()}
        stamp = _digest(json.dumps([version(), chunk, contents.identity, known]).encode())
        return Layout(self.count, self.times, chunk, contents, stamp)


def _digest(content: bytes) -> str:
    return sha256(content).hexdigest()[:32]


def _source(what: Any, vary: Any, times: Any) -> _Source:
    if isinstance(what, (Ensemble, PathEnsemble)):
        if vary is not None:
            raise ArgumentError(f"vary = {shown(vary)}: an ensemble has its members; leave vary out")
        return _of_ensemble(what, times)
    if not isinstance(what, (Scene, str, os.PathLike)):
        raise ArgumentError(f"what = {shown(what)}: give a scene, its name or file, or an ensemble")
    if times is not None:
        raise ArgumentError(f"times = {shown(times)}: a scene has its times; leave times out")
    return _of_scene(what if isinstance(what, Scene) else load_scene(what), vary)  # type: ignore[arg-type]


def _of_ensemble(many: Ensemble | PathEnsemble, times: Any) -> _Source:
    if times is None:
        raise ArgumentError("times = None: an ensemble is swept at times of shape (N,)")
    found = time_rows(times, len(many))
    if len(found) > 1 or np.ndim(times) > 1:
        raise ArgumentError(f"times have shape {np.shape(times)}: a sweep has the same for all members, (N,)")
    name = type(many.system).__name__
    return _Source(name, found[0], len(many), lambda begin, end: many[begin:end], many._contents)


def _of_scene(scene: Scene, vary: Any) -> _Source:
    grid = Grid(scene, {} if vary is None else vary)
    system, _ = scene.start(FLOAT_DIGITS)

    def members(begin: int, end: int) -> Starts[Any, Any]:
        rows = grid.rows(begin, end)
        if scene.rolls_or_spins:
            return Ensemble(system, np.nan_to_num(rows[:, :C]), scene.tilted)
        return Scenes(scene, rows)

    said, left_out = scene.describe(), ("title", "reference", "description", "report", "pictures")
    parameters = {
        name.replace(".", "_"): Column(("member",), values, "1", f"{name} of the scene, varied")
        for name, values in grid.values(0, len(grid)).items()
    }
    text, shape = json.dumps(said, ensure_ascii=False), list(grid.shape) or [1]
    attributes = about(system, scene=text, tilted=int(scene.tilted), grid=shape)
    identity = {key: said[key] for key in said if key not in left_out}
    contents = Contents(STATES, parameters, attributes, identity, OF_BODIES)
    return _Source(scene.name, np.array(scene.times.floats()), len(grid), members, contents)


def _fill(source: _Source, store: Store, pool: Executor, workers: int, tick: Any) -> None:
    left = (i for i in range(store.layout.chunks) if i not in store.done)
    under_way: dict[Future[Any], int] = {}
    try:
        while True:
            while len(under_way) < AHEAD * workers and (chunk := next(left, None)) is not None:
                under_way[pool.submit(done, source.members(*store.layout.ends(chunk)), source.times)] = chunk
            if not under_way:
                return
            for future in wait(under_way, return_when=FIRST_COMPLETED).done:
                chunk = under_way[future]
                store.put(chunk, *future.result())
                del under_way[future]
                begin, end = store.layout.ends(chunk)
                tick(end - begin)
    except ArgumentError:
        raise
    except Exception as error:
        _keep_finished(store, under_way)
        why = f"{type(error).__name__}: {' '.join(str(error).split())}"
        # if the processes end at once, the message names the usual cause, which the user can remedy
        ended = isinstance(error, BrokenProcessPool) and not store.done
        hint = "; a script starts processes under if __name__ == '__main__'" if ended else ""
        kept = f"{len(store.done)} of {store.layout.chunks} chunks are kept in {str(store.folder)!r}"
        what = f"{kept}, the same call goes on from there" if store.done else "no chunk was done, and nothing is kept"
        raise SweepStopped(f"executor: it has stopped ({why}{hint}); {what}") from error
    finally:
        for future in under_way:
            future.cancel()


def _keep_finished(store: Store, under_way: dict[Future[Any], int]) -> None:
    """Stores the chunks that were computed before the executor died."""
    for future, chunk in under_way.items():
        if future.done() and not future.cancelled() and future.exception() is None:
            store.put(chunk, *future.result())


@contextmanager
def _pool(executor: Executor | str, chunks: int) -> Iterator[tuple[Executor, int]]:
    """An executor and its number of workers; an executor given by the caller is left running."""
    if isinstance(executor, Executor):
        yield executor, int(getattr(executor, "_max_workers", None) or UNKNOWN)
        return
    workers = max(1, min(chunks, threads()))
    if executor == "processes" and workers > 1:
        with processes(workers) as several:
            yield several, workers
        return
    pool = ThreadPoolExecutor(workers)
    try:
        yield pool, workers
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


@contextmanager
def _bar(name: str, store: Store) -> Iterator[Any]:
    """Yields a function to call with the number of finished members. It moves a bar that shows the remaining time."""
    from tqdm import tqdm

    had = sum(end - begin for begin, end in map(store.layout.ends, store.done))
    with tqdm(total=store.layout.count, initial=had, desc=name, unit=" motions", leave=False) as bar:
        yield bar.update
