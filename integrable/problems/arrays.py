"""numpy arrays as the number type of a system's formulas, so that one call serves many states."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from jacobian.fields.inexact import InexactField

__all__ = ["Arrays", "columns", "stacked"]


class Arrays(InexactField[Any]):
    """numpy's arrays of float64 or complex128 as a field for formulas; constants become floats."""

    name, context = "arrays", np
    zero, one = 0.0, 1.0
    sqrt = staticmethod(np.sqrt)

    def coerce(self, value: Any, argument: str = "value") -> Any:
        """The float of a constant; an array is returned unchanged."""
        return value if isinstance(value, (np.ndarray, np.generic)) else float(value)


def columns(y: Any) -> list[Any]:
    """The components of states of shape (…, n): n arrays, or n floats for a single state of floats."""
    return list(np.moveaxis(np.asarray(y), -1, 0))


def stacked(parts: Iterable[Any]) -> np.ndarray:
    """The array of states, shape (…, n), with the given components: the inverse of :func:`columns`."""
    return np.stack(np.broadcast_arrays(*parts), axis=-1)
