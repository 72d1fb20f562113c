"""Arrays with names, dimensions and units: the content of files, xarray Datasets and pandas tables."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import metadata
from typing import Any

import numpy as np

from integrable.extras import needed

__all__ = ["Column", "Frame", "dataframe", "dataset", "version"]


@dataclass(frozen=True)
class Column:
    """One array: its dimensions, its unit and its description. ``parts`` names the entries along the last dimension,
    where that is no dimension of the frame: "gamma" has the parts 1, 2, 3.
    """

    dims: tuple[str, ...]
    values: np.ndarray
    units: str
    long_name: str
    parts: tuple[str, ...] = ()
    flags: tuple[str, ...] = ()
    """What the numbers 0, 1, … mean, where they are no quantities."""

    def attributes(self) -> dict[str, Any]:
        """Attributes by the conventions of netCDF."""
        said: dict[str, Any] = {"units": self.units, "long_name": self.long_name}
        if self.flags:
            said["flag_meanings"] = "; ".join(self.flags)
        if self.parts:
            said["components"] = " ".join(self.parts)
        return said


@dataclass(frozen=True)
class Frame:
    """``dims`` are the rows' dimensions, ("time",) or ("member", "time"). ``coordinates`` and ``variables`` lie along
    them; ``attributes`` describe the whole, in numbers, strings and lists of numbers.
    """

    dims: tuple[str, ...]
    coordinates: dict[str, Column]
    variables: dict[str, Column]
    attributes: dict[str, Any]

    @property
    def columns(self) -> dict[str, Column]:
        """All coordinates and variables."""
        return {**self.coordinates, **self.variables}

    @property
    def exact(self) -> bool:
        """Whether numbers have more digits than floats, as those of MP do."""
        return any(column.values.dtype == object for column in self.columns.values())


def version() -> str:
    """The version of this package."""
    try:
        return metadata.version("jacobian-integrable")
    except metadata.PackageNotFoundError:
        return "(not installed)"


def dataset(frame: Frame) -> Any:
    """An ``xarray.Dataset``: names, dimensions and units; numbers of MP(digits) as objects."""
    needed("xarray", "to_xarray()", "io")
    import xarray

    def variable(column: Column) -> Any:
        return xarray.Variable(column.dims, column.values, column.attributes())

    return xarray.Dataset(
        {name: variable(column) for name, column in frame.variables.items()},
        {name: variable(column) for name, column in frame.coordinates.items()},
        frame.attributes,
    )


def dataframe(frame: Frame) -> Any:
    """A ``pandas.DataFrame``, a row for each state, indexed by the dimensions of the frame; vectors are columns of
    their own, ``gamma_1``. ``attrs`` has the attributes, and the ``units`` of the columns.
    """
    needed("pandas", "to_dataframe()", "io")
    import pandas

    shape = next(c.values.shape for c in frame.variables.values() if c.dims[: len(frame.dims)] == frame.dims)
    shape = shape[: len(frame.dims)]
    found, units = {}, {}
    for name, column in frame.columns.items():
        # arrays along some of the dimensions are repeated along the others
        had = [dim in column.dims for dim in frame.dims]
        tail = column.values.shape[sum(had) :]
        rows = column.values.reshape(*(n if there else 1 for n, there in zip(shape, had, strict=True)), *tail)
        flat = np.broadcast_to(rows, (*shape, *tail)).reshape(int(np.prod(shape)), int(np.prod(tail)))
        for i, part in enumerate(column.parts or ("",)):
            label = f"{name}_{part}" if part else name
            found[label], units[label] = flat[:, i], column.units
    table = pandas.DataFrame(found).set_index(list(frame.coordinates))
    table.attrs = {**frame.attributes, "units": units}
    return table
