"""The base of results that convert themselves to xarray and pandas and write themselves to files."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from jacobian.element import File
from jacobian.immutable import Record

if TYPE_CHECKING:
    from integrable.files.frame import Frame

__all__ = ["Exported"]

USUAL = ("gamma", "M", "omega")


class Exported(Record):
    """Base of results that are arrays with names and units.

    ``quantities`` are names of :data:`integrable.files.quantities.QUANTITIES`: "gamma", "M", "omega", "quaternion",
    "contact"; "q" and "p" for a system of any genus. The names for the laboratory are in
    :data:`integrable.laboratory.in_files.QUANTITIES`. The default is "gamma", "M" and "omega" for a body. The libraries
    needed are in the extra ``io``; ArgumentError names a missing library.
    """

    @property
    def _usual(self) -> tuple[str, ...]:
        """The quantities written by default."""
        return USUAL

    def _asked(self, quantities: Iterable[str] | None) -> Frame:
        return self._frame(self._usual if quantities is None else quantities)

    def _frame(self, quantities: Iterable[str]) -> Frame:
        """The arrays and attributes to write, as a :class:`Frame`."""
        raise NotImplementedError

    def to_xarray(self, quantities: Iterable[str] | None = None) -> Any:
        """An ``xarray.Dataset`` with dimensions, units and a description of the motion as attributes."""
        from integrable.files.frame import dataset

        return dataset(self._asked(quantities))

    def to_dataframe(self, quantities: Iterable[str] | None = None) -> Any:
        """A ``pandas.DataFrame`` with a row for each state and columns ``gamma_1`` …; ``attrs`` has the units."""
        from integrable.files.frame import dataframe

        return dataframe(self._asked(quantities))

    def save(self, path: File, quantities: Iterable[str] | None = None) -> None:
        """Write a .nc, .h5, .zarr, .parquet, .csv or .mat file, completely or not at all.

        Numbers of MP(digits) can only be written to .csv. See :func:`integrable.files.writing.save`.
        """
        from integrable.files.writing import save

        save(lambda: self._asked(quantities), path)
