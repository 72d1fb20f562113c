"""Arrays with names, dimensions and units: the content of files, xarray Datasets and pandas tables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from integrable.extras import needed, version_of

__all__ = ["Column", "Frame", "dataframe", "dataset", "version"]


@dataclass(frozen=True)
class Column:
    """One array with its dimensions, unit and description.

    If the array has one more dimension than the frame, ``parts`` names the entries along it: 1, 2, 3 for "gamma".
    """

    dims: tuple[str, ...]
    values: np.ndarray
    units: str
    long_name: str
    parts: tuple[str, ...] = ()
    flags: tuple[str, ...] = ()
    """The meanings of the numbers 0, 1, … of a column of codes."""

    def attributes(self) -> dict[str, Any]:
        """The array's attributes, by the conventions of netCDF."""
        said: dict[str, Any] = {"units": self.units, "long_name": self.long_name}
        if self.flags:
            said["flag_meanings"] = "; ".join(self.flags)
        if self.parts:
            said["components"] = " ".join(self.parts)
        return said


@dataclass(frozen=True)
class Frame:
    """A set of arrays along common dimensions, the content of one file.

    ``dims`` are the dimensions of ``coordinates`` and ``variables``, such as ("time",) or ("member", "time").
    ``attributes`` describe the motion by numbers, strings and lists of numbers.
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
        """Whether the numbers have more digits than floats, as those of MP(digits) do."""
        return any(column.values.dtype == object for column in self.columns.values())


def version() -> str:
    """The version of this package."""
    return version_of("jacobian-integrable") or "(not installed)"


def dataset(frame: Frame) -> Any:
    """A frame as an ``xarray.Dataset`` with names, dimensions and units. Numbers of MP(digits) become objects."""
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
    """A frame as a ``pandas.DataFrame`` with one row per state, indexed by the coordinates of the frame.

    Each component of a vector is a column, such as ``gamma_1``. ``attrs`` has the attributes and the columns'
    ``units``.
    """
    needed("pandas", "to_dataframe()", "io")
    import pandas

    shape = next(c.values.shape for c in frame.variables.values() if c.dims[: len(frame.dims)] == frame.dims)
    shape = shape[: len(frame.dims)]
    found, units = {}, {}
    for name, column in frame.columns.items():
        # an array that lacks some of the dimensions is repeated along them
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
