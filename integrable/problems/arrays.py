"""numpy arrays as the number type of a system's formulas, so that one call serves many states."""

from __future__ import annotations

import operator
from collections.abc import Iterable
from typing import Any

import numpy as np

__all__ = ["Arrays", "columns", "stacked"]


class Arrays:
    """numpy's arrays of float64 or complex128 as a field for formulas; constants become floats."""

    exact, zero, one = False, 0.0, 1.0
    context = np
    add, sub, mul = map(staticmethod, (operator.add, operator.sub, operator.mul))
    neg, sqrt = staticmethod(operator.neg), staticmethod(np.sqrt)

    @staticmethod
    def coerce(x: Any) -> Any:
        """The float of a constant; an array is returned unchanged."""
        return x if isinstance(x, (np.ndarray, np.generic)) else float(x)

    @staticmethod
    def dot(xs: Iterable[Any], ys: Iterable[Any]) -> Any:
        """Σ x_i y_i."""
        return sum((x * y for x, y in zip(xs, ys, strict=True)), 0.0)


def columns(y: Any) -> list[Any]:
    """The components of states of shape (…, n): n arrays, or n floats for a single state of floats."""
    return list(np.moveaxis(np.asarray(y), -1, 0))


def stacked(parts: Iterable[Any]) -> np.ndarray:
    """The array of states, shape (…, n), with the given components: the inverse of :func:`columns`."""
    return np.stack(np.broadcast_arrays(*parts), axis=-1)
