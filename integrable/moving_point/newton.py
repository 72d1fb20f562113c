"""Newton's method on arrays, confined to a bracket."""

from __future__ import annotations

import numpy as np


def step_inside(
    x: np.ndarray, value: np.ndarray, slope: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(improved x, low, high) for the zeros of increasing functions that have this ``value`` and ``slope`` at x. A
    Newton step that leaves the bracket [low, high] is replaced by bisection. All arguments are arrays of one shape.
    """
    low, high = np.where(value > 0, low, x), np.where(value > 0, x, high)
    better = x - value / slope
    return np.where((better < low) | (better > high), (low + high) / 2, better), low, high
