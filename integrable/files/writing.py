"""Writes a :class:`~integrable.files.frame.Frame` to a file, in the format of its suffix, by that format's usual
library.

HDF5 files are made in memory, because the HDF5 library aborts the process when the disk is full.
"""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from integrable.extras import needed
from integrable.files.frame import Column, Frame, dataframe, dataset
from integrable.files.whole import replacing, said, target_of
from jacobian.element import File
from jacobian.errors import ArgumentError, shown

__all__ = ["FORMATS", "save", "scaled"]


def save(frame: Callable[[], Frame], path: File) -> None:
    """Write a frame as .nc (netCDF 4), .h5 (HDF5), .zarr, .parquet, .csv or .mat. ``frame`` is called after all checks.

    The file (for .zarr the folder) appears when it is complete, and replaces an older one. Raises ArgumentError for
    another suffix, a library that is not installed, a full disk, and numbers of MP(digits) unless the file is .csv.
    """
    known = ", ".join(FORMATS)
    target = target_of(path, f"the path of a file that ends with one of {known}")
    chosen = FORMATS.get(target.suffix)
    if chosen is None:
        raise ArgumentError(f"path = {shown(str(path))}: a name that ends with one of {known} is needed")
    for module in chosen.modules:
        needed(module, f"a {target.suffix} file", "io")
    if target.is_dir() and not (chosen.folder and _is_a_store(target)):
        raise ArgumentError(f"path = {shown(str(path))}: a folder is there that is no {target.suffix} store")
    made = frame()
    if made.exact and target.suffix != ".csv":
        raise ArgumentError(
            f"path = {shown(str(path))}: numbers of {made.attributes['field']} are written to .csv only"
        )
    with said(target), replacing(target) as temporary:
        chosen.write(made, temporary)


def _is_a_store(folder: Path) -> bool:
    return any((folder / name).exists() for name in ("zarr.json", ".zgroup"))


def _netcdf(frame: Frame, path: Path) -> None:
    content = io.BytesIO()
    dataset(frame).to_netcdf(content, engine="h5netcdf")
    path.write_bytes(content.getvalue())


def _zarr(frame: Frame, path: Path) -> None:
    dataset(frame).to_zarr(path, mode="w", consolidated=False)


def _hdf5(frame: Frame, path: Path) -> None:
    import h5py

    content = io.BytesIO()
    with h5py.File(content, "w") as file:
        file.attrs.update(frame.attributes)
        for name, column in frame.columns.items():
            made = file.create_dataset(name, data=column.values)
            made.attrs.update(column.attributes())
            made.attrs["dimensions"] = " ".join(column.dims)
        scaled(file, frame.columns)
    path.write_bytes(content.getvalue())


def scaled(file: Any, columns: dict[str, Column]) -> None:
    """Attaches to each dimension of an HDF5 file its scale: the column with the dimension's name, or else 1, 2, 3, …"""
    for name, column in columns.items():
        for i, dim in enumerate(column.dims):
            if dim not in file:
                file.create_dataset(dim, data=np.arange(1, file[name].shape[i] + 1))
            if columns[dim].dims == (dim,) if dim in columns else True:
                if not file[dim].is_scale:
                    file[dim].make_scale(dim)
                if dim != name:
                    file[name].dims[i].attach_scale(file[dim])


def _parquet(frame: Frame, path: Path) -> None:
    dataframe(frame).to_parquet(path, engine="pyarrow")


def _csv(frame: Frame, path: Path) -> None:
    table = dataframe(frame)
    with path.open("w", encoding="utf-8", newline="") as file:
        for name, value in table.attrs.items():
            file.write(f"# {name}: {json.dumps(value, ensure_ascii=False)}\n")
        table.to_csv(file, lineterminator="\n")


def _mat(frame: Frame, path: Path) -> None:
    from scipy.io import savemat

    arrays = {name: column.values for name, column in frame.columns.items()}
    units = {name: column.units for name, column in frame.columns.items()}
    content = {**arrays, "units": units, "attributes": frame.attributes}
    savemat(path, content, oned_as="column", appendmat=False, long_field_names=True)


class _Format(NamedTuple):
    write: Callable[[Frame, Path], None]
    modules: tuple[str, ...]
    folder: bool = False


FORMATS = {
    ".nc": _Format(_netcdf, ("xarray", "h5netcdf")),
    ".h5": _Format(_hdf5, ("h5py",)),
    ".zarr": _Format(_zarr, ("xarray", "zarr"), folder=True),
    ".parquet": _Format(_parquet, ("pandas", "pyarrow")),
    ".csv": _Format(_csv, ("pandas",)),
    ".mat": _Format(_mat, ("scipy",)),
}
"""The function that writes files with each suffix, and the libraries of the extra ``io`` that it needs."""
