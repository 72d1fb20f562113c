"""Newton's method for many numbers at once, inside a bracket."""

from __future__ import annotations

from typing import Any

import numpy as np


def step_inside(x: Any, value: Any, slope: Any, low: Any, high: Any) -> tuple[Any, Any, Any]:
    """(a better x, low, high) for the zeros of increasing functions with a ``value`` and a ``slope`` at x: by Newton's
    step, or by bisection of ``low`` and ``high`` if it leaves the bracket. Arrays of one shape.
    """
    low, high = np.where(value > 0, low, x), np.where(value > 0, x, high)
    better = x - value / slope
    return np.where((better < low) | (better > high), (low + high) / 2, better), low, high
