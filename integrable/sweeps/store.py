"""Where a sweep is kept: a folder beside its file while it lasts, with every chunk that is done, then the file itself.

One process writes, the one that called; workers hand their parts over. A chunk is first written and then noted in the
journal, which is replaced as a whole: what the journal knows is there, however the process ends.
"""

from __future__ import annotations

import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from filelock import FileLock, Timeout

from integrable.ensembles.computing import WORDS
from integrable.extras import needed
from integrable.files.frame import Column
from integrable.files.quantities import columns, reasons_text, status_column
from integrable.files.whole import replacing, said, target_of
from integrable.files.writing import scaled
from integrable.sweeps.jobs import Part
from jacobian.errors import ArgumentError, shown

__all__ = ["SUFFIXES", "Layout", "Store"]

SUFFIXES = {".zarr": ("zarr",), ".h5": ("h5py",)}
"""The formats, and the libraries of the extra ``io`` that they need."""


@dataclass(frozen=True)
class Layout:
    """What a sweep is: how many members at which times in chunks of how many, what is known of the members, what is
    said of all, and the ``stamp`` of everything that the states depend on.
    """

    count: int
    times: np.ndarray
    chunk: int
    parameters: dict[str, Column]
    attributes: dict[str, Any]
    stamp: str

    @property
    def chunks(self) -> int:
        """How many."""
        return -(-self.count // self.chunk)

    def ends(self, chunk: int) -> tuple[int, int]:
        """The members of a chunk."""
        return chunk * self.chunk, min(self.count, (chunk + 1) * self.chunk)


class Store:
    """The folder and the file of a sweep. ``done`` are the chunks that are there, ``refused`` how many members have
    rows that were refused; ``complete``: the file was there already.
    """

    def __init__(self, out: Any, layout: Layout) -> None:
        known = " or ".join(SUFFIXES)
        self.path = target_of(out, f"the path of a file that ends with {known}", "out")
        if self.path.suffix not in SUFFIXES:
            raise ArgumentError(f"out = {shown(str(out))}: a name that ends with {known} is needed")
        for module in SUFFIXES[self.path.suffix]:
            needed(module, f"a {self.path.suffix} file", "io")
        self.layout, self.folder = layout, self.path.with_name(f"{self.path.name}.part")
        self.done: set[int] = set()
        self.reasons: list[str] = [""]
        self.refused = 0
        self._format = (_Zarr if self.path.suffix == ".zarr" else _Hdf5)(self.folder, layout)
        self.complete = self.path.exists()
        if self.complete:
            found = self._format.attributes(self.path)
            if found.get("stamp") != layout.stamp:
                raise ArgumentError(f"out = {shown(str(out))}: another file is there; give another name, or move it")
            self.refused = int(found["refused"])
            # of a sweep that was killed at its very end
            shutil.rmtree(self.folder, ignore_errors=True)

    def __enter__(self) -> Store:
        with said(self.path, "out"):
            self.folder.mkdir(exist_ok=True)
            self._lock = FileLock(self.folder / "lock")
            try:
                self._lock.acquire(blocking=False)
            except Timeout:
                raise ArgumentError(f"out = {str(self.path)!r}: another sweep is writing to it") from None
            if self._journal.exists():
                self._read()
            else:
                self._format.begin()
                self._note()
        return self

    def __exit__(self, *_: object) -> None:
        self._lock.release()

    def put(self, chunk: int, part: Part) -> None:
        """Keep a chunk."""
        numbers = {reason: n for n, reason in enumerate(self.reasons)}
        own = np.array([numbers.setdefault(reason, len(numbers)) for reason in part.reasons], dtype=np.int32)
        status = own[part.status]
        arrays = {
            "gamma": part.rows[:, :, :3], "M": part.rows[:, :, 3:6], "tau": part.rows[:, :, 6], "status": status,
            "way": (part.ways + 1).astype(np.int32),
        }  # fmt: skip
        with said(self.path, "out"):
            self._format.put(chunk, arrays)
            self.reasons = list(numbers)
            self.refused += int(np.count_nonzero(status.any(axis=1)))
            self.done.add(chunk)
            self._note()

    def finish(self) -> None:
        """Make the file of all chunks."""
        reasons = reasons_text(self.reasons)
        attributes = {**self.layout.attributes, "reasons": reasons, "refused": self.refused, "stamp": self.layout.stamp}
        with said(self.path, "out"):
            self._format.finish(self.path, attributes, described(self.layout, self.reasons))
            self._lock.release()
            shutil.rmtree(self.folder)

    @property
    def _journal(self) -> Path:
        return self.folder / "journal.json"

    def _note(self) -> None:
        content = {
            "stamp": self.layout.stamp, "done": sorted(self.done), "reasons": self.reasons, "refused": self.refused,
        }  # fmt: skip
        with replacing(self._journal) as temporary:
            temporary.write_text(json.dumps(content), encoding="utf-8")

    def _read(self) -> None:
        content = json.loads(self._journal.read_text(encoding="utf-8"))
        if content["stamp"] != self.layout.stamp:
            raise ArgumentError(
                f"out = {str(self.path)!r}: {str(self.folder)!r} has the chunks of another sweep, or of another "
                "version; give another name, or remove it"
            )
        self.done, self.reasons, self.refused = set(content["done"]), content["reasons"], content["refused"]


def described(layout: Layout, reasons: list[str]) -> dict[str, Column]:
    """Every array of the file, those of the states without their values."""
    dims, none = ("member", "time"), np.empty(0)
    return {
        "member": Column(("member",), np.arange(layout.count), "1", "number of the member"),
        "time": Column(("time",), layout.times, "s", "physical time t"),
        **layout.parameters,
        **columns(dims, {"gamma": none, "M": none}),
        "tau": Column(dims, none, "s", "time of the flow, dτ = g dt"),
        "status": status_column(dims, none, reasons),
        "way": Column(("member",), none, "1", "what has computed the member", (), ("refused", *WORDS)),
    }


def shapes(layout: Layout) -> dict[str, tuple[tuple[int, ...], type]]:
    """Shape and kind of what is written in chunks."""
    rows = (layout.count, len(layout.times))
    return {
        "gamma": ((*rows, 3), np.float64), "M": ((*rows, 3), np.float64), "tau": (rows, np.float64),
        "status": (rows, np.int32), "way": (rows[:1], np.int32),
    }  # fmt: skip


class _Zarr:
    """Chunks are those of the arrays of a zarr store, which is moved when it is complete."""

    def __init__(self, folder: Path, layout: Layout) -> None:
        self._states, self._layout = folder / "states.zarr", layout
        self._group: Any = None

    def begin(self) -> None:
        import zarr

        group = zarr.open_group(self._states, mode="w", zarr_format=3)
        made = described(self._layout, [""])
        for name, (shape, kind) in shapes(self._layout).items():
            group.create_array(
                name, shape=shape, chunks=(self._layout.chunk, *(max(1, n) for n in shape[1:])), dtype=kind,
                dimension_names=made[name].dims,
            )  # fmt: skip

    def put(self, chunk: int, arrays: dict[str, np.ndarray]) -> None:
        import zarr

        self._group = self._group or zarr.open_group(self._states, mode="a")
        begin, end = self._layout.ends(chunk)
        for name, values in arrays.items():
            self._group[name][begin:end] = values

    def finish(self, path: Path, attributes: dict[str, Any], made: dict[str, Column]) -> None:
        import zarr

        group = zarr.open_group(self._states, mode="a")
        written = shapes(self._layout)
        for name, column in made.items():
            if name not in written:
                array = group.create_array(
                    name, data=np.array(column.values), dimension_names=column.dims, overwrite=True
                )
            else:
                array = group[name]
            array.attrs.update(column.attributes())
        group.attrs.update(attributes)
        self._states.replace(path)

    def attributes(self, path: Path) -> dict[str, Any]:
        import zarr

        try:
            return dict(zarr.open_group(path, mode="r").attrs)
        except (OSError, ValueError, KeyError):
            return {}


class _Hdf5:
    """Chunks are files of their own until all are there: an HDF5 file that is cut short cannot be read any more."""

    def __init__(self, folder: Path, layout: Layout) -> None:
        self._folder, self._layout = folder, layout

    def _part(self, chunk: int) -> Path:
        return self._folder / f"{chunk:08d}.npz"

    def begin(self) -> None:
        """Nothing is there."""

    def put(self, chunk: int, arrays: dict[str, np.ndarray]) -> None:
        with replacing(self._part(chunk)) as temporary:
            np.savez(temporary, allow_pickle=False, **arrays)

    def finish(self, path: Path, attributes: dict[str, Any], made: dict[str, Column]) -> None:
        import h5py

        room = shutil.disk_usage(self._folder).free
        wanted = sum(item.stat().st_size for item in self._folder.iterdir())
        if room < wanted + (1 << 20):
            raise OSError(28, f"No space left on device ({wanted / 1e6:.0f} MB are needed to join all chunks)")
        with replacing(path) as temporary, h5py.File(temporary, "w") as file:
            file.attrs.update(attributes)
            for name, column in made.items():
                shape, kind = shapes(self._layout).get(name, (column.values.shape, column.values.dtype))
                array = file.create_dataset(name, shape=shape, dtype=kind)
                array.attrs.update({**column.attributes(), "dimensions": " ".join(column.dims)})
                if name not in shapes(self._layout):
                    array[()] = column.values
            for chunk in range(self._layout.chunks):
                begin, end = self._layout.ends(chunk)
                with np.load(self._part(chunk)) as arrays:
                    for name in arrays:
                        file[name][begin:end] = arrays[name]
            scaled(file, made)

    def attributes(self, path: Path) -> dict[str, Any]:
        import h5py

        try:
            with h5py.File(path) as file:
                return dict(file.attrs)
        except OSError:
            return {}
