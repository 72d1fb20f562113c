"""The storage of a sweep. While it runs, a folder next to its file holds every finished chunk; at the end the file is
made from them.

Only the calling process writes; workers return states. A chunk is first written, then entered in the journal,
which is replaced as a whole. So every chunk in the journal is complete, however the process ends.
"""

from __future__ import annotations

import io
import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from filelock import FileLock, Timeout

from integrable.ensembles.computing import Outcome, statuses
from integrable.ensembles.members import AT, Contents
from integrable.extras import needed
from integrable.files.frame import Column
from integrable.files.quantities import reasons_text, status_column
from integrable.files.whole import Patient, discarded, replacing, said, target_of
from integrable.files.writing import scaled
from jacobian.element import File
from jacobian.errors import ArgumentError, shown

__all__ = ["SUFFIXES", "Layout", "Store"]

SUFFIXES = {".zarr": "zarr", ".h5": "h5py"}
"""The formats, and the library of the extra ``io`` that each needs."""
JOURNAL, STATES = "journal", "states.zarr"
OWN = {"lock", STATES}
"""The files that a sweep makes in its folder before the journal."""
DAMAGED = (OSError, EOFError, KeyError, ValueError, TypeError, BadZipFile, RuntimeError)
"""The errors that libraries raise for a truncated file or one with other contents."""


@dataclass(frozen=True)
class Layout:
    """The layout of a sweep's file: number of members, times, chunk size, and the content of the file.

    ``stamp`` is a hash of everything that the states depend on.
    """

    count: int
    times: np.ndarray
    chunk: int
    contents: Contents
    stamp: str

    @property
    def chunks(self) -> int:
        """The number of chunks of the sweep."""
        return -(-self.count // self.chunk)

    def ends(self, chunk: int) -> tuple[int, int]:
        """The numbers (begin, end) of a chunk's first member and of the first member after the chunk."""
        return chunk * self.chunk, min(self.count, (chunk + 1) * self.chunk)


class Store:
    """The folder and the file of a sweep.

    ``done`` holds the finished chunks, ``refused`` counts members with refused rows, and ``complete`` says whether the
    file existed already.
    """

    def __init__(self, out: File, layout: Layout) -> None:
        known = " or ".join(SUFFIXES)
        self.path = target_of(out, f"the path of a file that ends with {known}", "out")
        if self.path.suffix not in SUFFIXES:
            raise ArgumentError(f"out = {shown(str(out))}: a name that ends with {known} is needed")
        needed(SUFFIXES[self.path.suffix], f"a {self.path.suffix} file", "io")
        self.layout, self.folder = layout, self.path.with_name(f"{self.path.name}.part")
        self.done: set[int] = set()
        self.reasons: list[str] = [""]
        self.refused, self._own = 0, False
        self._format = (_Zarr if self.path.suffix == ".zarr" else _Hdf5)(self.folder, layout)
        self.complete = self.path.exists()
        if self.complete:
            found = self._format.attributes(self.path)
            if found.get("stamp") != layout.stamp:
                raise ArgumentError(f"out = {shown(str(out))}: another file is there; give another name, or move it")
            self.refused = int(found["refused"])
            # the folder was left by a sweep killed after it had written its file
            shutil.rmtree(self.folder, ignore_errors=True)

    def __enter__(self) -> Store:
        with said(self.path, "out"):
            self.folder.mkdir(exist_ok=True)
            self._lock = FileLock(self.folder / "lock")
            try:
                self._lock.acquire(blocking=False)
            except Timeout:
                raise ArgumentError(f"out = {str(self.path)!r}: another sweep is writing to it") from None
            try:
                if self._journal.exists():
                    self._read()
                else:
                    self._begin()
            except BaseException:
                self.__exit__()
                raise
        return self

    def __exit__(self, *_: object) -> None:
        """Releases the folder, and removes it if it holds nothing from which a sweep could resume."""
        self._lock.release()
        if self._own and not self.done:
            discarded(self.folder)

    def put(self, chunk: int, rows: np.ndarray, found: Outcome) -> None:
        """Writes the states of a chunk, of shape (members, times, numbers), then enters the chunk in the journal."""
        numbers = {reason: n for n, reason in enumerate(self.reasons)}
        own = np.array([numbers.setdefault(reason, len(numbers)) for reason in found.reasons], dtype=np.int32)
        status = own[statuses(found.status, found.partial, rows.shape[1])]
        arrays = {name: rows[..., place] for name, (place, _) in self.layout.contents.states.items()}
        arrays |= {"status": status, "way": (found.ways + 1).astype(np.int32)}
        with said(self.path, "out"):
            self._format.put(chunk, arrays)
            self.reasons = list(numbers)
            self.refused += refused(status)
            self.done.add(chunk)
            self._note()

    def finish(self) -> None:
        """Makes the sweep's file from all chunks."""
        own = {"reasons": reasons_text(self.reasons), "refused": self.refused, "stamp": self.layout.stamp}
        attributes = {**self.layout.contents.attributes, **own}
        with said(self.path, "out"):
            self._format.finish(self.path, attributes, described(self.layout, self.reasons))
        self._lock.release()
        shutil.rmtree(self.folder, ignore_errors=True)

    @property
    def _journal(self) -> Path:
        return self.folder / f"{JOURNAL}.json"

    def _note(self) -> None:
        content = {
            "stamp": self.layout.stamp, "done": sorted(self.done), "reasons": self.reasons, "refused": self.refused,
        }  # fmt: skip
        with replacing(self._journal) as temporary:
            temporary.write_text(json.dumps(content), encoding="utf-8")

    def _begin(self) -> None:
        """Starts in a folder without a journal: a new folder, or that of a sweep killed before its first chunk."""
        for item in self.folder.iterdir():
            if item.name not in OWN and not item.name.startswith(f".{JOURNAL}."):
                raise self._refusal(f"has no journal, but {item.name!r}")
        self._own = True
        self._format.begin()
        self._note()

    def _read(self) -> None:
        """Resumes from the folder; missing and damaged chunks will be computed again."""
        try:
            content = json.loads(self._journal.read_text(encoding="utf-8"))
            stamp, noted, reasons = content["stamp"], set(content["done"]), [str(x) for x in content["reasons"]]
        except (OSError, ValueError, KeyError, TypeError):
            raise self._refusal("has a journal that is damaged") from None
        if stamp != self.layout.stamp:
            raise self._refusal("has the chunks of another sweep, or of another version")
        self._own, self.reasons = True, reasons
        for chunk in noted & set(range(self.layout.chunks)):
            status = self._format.status(chunk)
            if status is not None and 0 <= status.min() <= status.max() < len(reasons):
                self.done.add(chunk)
                self.refused += refused(status)

    def _refusal(self, why: str) -> ArgumentError:
        return ArgumentError(f"out = {str(self.path)!r}: {str(self.folder)!r} {why}; give another name, or remove it")


def refused(status: np.ndarray) -> int:
    """The number of members with refused rows."""
    return int(np.count_nonzero(status.any(axis=1)))


def described(layout: Layout, reasons: list[str]) -> dict[str, Column]:
    """The columns of the file by name. The columns of the states have no values yet."""
    none = np.empty(0)
    return {
        "member": Column(("member",), np.arange(layout.count), "1", "number of the member"),
        "time": Column(("time",), layout.times, "s", "physical time t"),
        **layout.contents.parameters,
        **{name: column for name, (_, column) in layout.contents.states.items()},
        "status": status_column(AT, none, reasons),
        "way": Column(("member",), none, "1", "what has computed the member", (), ("refused", *layout.contents.words)),
    }


def shapes(layout: Layout, count: int) -> dict[str, tuple[tuple[int, ...], type]]:
    """Shapes and types of the arrays that are written in chunks, for ``count`` members."""
    rows, columns = (count, len(layout.times)), [(name, x) for name, (_, x) in layout.contents.states.items()]
    states = {name: ((*rows, len(x.parts)) if x.parts else rows, np.float64) for name, x in columns}
    return {**states, "status": (rows, np.int32), "way": (rows[:1], np.int32)}


class _Zarr:
    """Storage as zarr: each chunk of members is a chunk of the arrays. The complete store is moved into place."""

    def __init__(self, folder: Path, layout: Layout) -> None:
        self._states, self._layout = folder / STATES, layout
        self._group: Any = None

    def begin(self) -> None:
        import zarr

        group = zarr.open_group(self._states, mode="w", zarr_format=3)
        made = described(self._layout, [""])
        for name, (shape, kind) in shapes(self._layout, self._layout.count).items():
            group.create_array(
                name, shape=shape, chunks=(self._layout.chunk, *(max(1, n) for n in shape[1:])), dtype=kind,
                dimension_names=made[name].dims,
            )  # fmt: skip

    def put(self, chunk: int, arrays: dict[str, np.ndarray]) -> None:
        import zarr

        begin, end = self._layout.ends(chunk)
        # chunks of zeros are written too, since a missing chunk counts as not finished
        with zarr.config.set({"array.write_empty_chunks": True}):
            self._group = self._group or zarr.open_group(self._states, mode="a")
            for name, values in arrays.items():
                self._group[name][begin:end] = values

    def status(self, chunk: int) -> np.ndarray | None:
        """The status of each row of a chunk, None where one of its arrays cannot be read."""
        import zarr

        begin, end = self._layout.ends(chunk)
        try:
            group = zarr.open_group(self._states, mode="r")
            for name, (shape, _) in shapes(self._layout, self._layout.count).items():
                place = "/".join(map(str, [name, "c", chunk, *[0] * (len(shape) - 1)]))
                if not (self._states / place).is_file():
                    return None
                found = np.asarray(group[name][begin:end])
                if name == "status":
                    status = found
        except DAMAGED:
            return None
        return status

    def finish(self, path: Path, attributes: dict[str, Any], made: dict[str, Column]) -> None:
        import zarr

        group = zarr.open_group(self._states, mode="a")
        written = shapes(self._layout, self._layout.count)
        for name, column in made.items():
            if name not in written:
                group.create_array(name, data=np.array(column.values), dimension_names=column.dims, overwrite=True)
            group[name].attrs.update(column.attributes())
        group.attrs.update(attributes)
        self._states.replace(path)

    def attributes(self, path: Path) -> dict[str, Any]:
        import zarr

        try:
            return dict(zarr.open_group(path, mode="r").attrs)
        except (OSError, ValueError, KeyError):
            return {}


class _Hdf5:
    """Storage as HDF5: chunks are separate files until all are finished, as a truncated HDF5 file cannot be read."""

    def __init__(self, folder: Path, layout: Layout) -> None:
        self._folder, self._layout = folder, layout

    def _part(self, chunk: int) -> Path:
        return self._folder / f"{chunk:08d}.npz"

    def begin(self) -> None:
        """Does nothing: chunks need no common file."""

    def put(self, chunk: int, arrays: dict[str, np.ndarray]) -> None:
        content = io.BytesIO()
        np.savez(content, allow_pickle=False, **arrays)
        with replacing(self._part(chunk)) as temporary:
            temporary.write_bytes(content.getvalue())

    def status(self, chunk: int) -> np.ndarray | None:
        """The status of each row of a chunk, None where one of its arrays cannot be read."""
        begin, end = self._layout.ends(chunk)
        try:
            with np.load(io.BytesIO(self._part(chunk).read_bytes())) as arrays:
                found = {name: arrays[name] for name in arrays}
        except DAMAGED:
            return None
        wanted = shapes(self._layout, end - begin)
        same = {name: (x.shape, x.dtype) for name, x in found.items()} == wanted
        return found["status"] if same else None

    def finish(self, path: Path, attributes: dict[str, Any], made: dict[str, Column]) -> None:
        import h5py

        # the temporary file is in the folder, so if the process is killed, the file is later removed with the folder
        with replacing(path, self._folder) as temporary:
            with Patient(temporary) as target:
                try:
                    with h5py.File(target, "w") as file:
                        file.attrs.update(attributes)
                        self._join(file, made, target)
                        scaled(file, made)
                except Exception:
                    # after a failed write the error of the HDF5 library is a consequence; the cause is raised below
                    if target.error is None:
                        raise
            if target.error is not None:
                raise target.error

    def _join(self, file: Any, made: dict[str, Column], target: Patient) -> None:
        written = shapes(self._layout, self._layout.count)
        for name, column in made.items():
            shape, kind = written.get(name, (column.values.shape, column.values.dtype))
            array = file.create_dataset(name, shape=shape, dtype=kind)
            array.attrs.update({**column.attributes(), "dimensions": " ".join(column.dims)})
            if name not in written:
                array[()] = column.values
        for chunk in range(self._layout.chunks):
            begin, end = self._layout.ends(chunk)
            with np.load(self._part(chunk)) as arrays:
                for name in arrays:
                    file[name][begin:end] = arrays[name]
            if target.error is not None:
                return

    def attributes(self, path: Path) -> dict[str, Any]:
        import h5py

        try:
            with h5py.File(path) as file:
                return dict(file.attrs)
        except OSError:
            return {}
