"""Derivatives of states as quotients of differences of whole motions, which are computed with more digits.

These derivatives are used over MP(digits), and in floats for motions without a torus.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil, inf, log10
from typing import NamedTuple

import numpy as np

from jacobian import MP
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.progress import Progress

FlowMap = Callable[[np.ndarray, MultiprecisionField], np.ndarray]
"""A function from inputs, as numbers of a field, to N rows of m numbers."""

# extra digits of the motions, and the largest number of attempts. An attempt assumes the size of the derivatives that
# the previous one found
GUARD, ATTEMPTS = 8, 6
# {offset in steps: weight of the value there} in difference quotients of second order. An input that must not decrease
# has one-sided quotients
CENTRAL, ONE_SIDED = {1: 1, -1: -1}, {0: -3, 1: 4, 2: -1}


class Inputs(NamedTuple):
    """The ``numbers`` that a motion depends on: first those of its state, then its constants.

    ``sizes`` are changes of the numbers that change the motion noticeably, 0 for a number that has no derivatives.
    Numbers at the indices ``least`` have their least possible value and are only increased.
    """

    numbers: Sequence[Real]
    sizes: Sequence[Real]
    least: Sequence[int] = ()


def differences(motion: FlowMap, inputs: Inputs, digits: int, size: float) -> np.ndarray:
    """The derivatives of the rows of ``motion`` with respect to its inputs: shape (N, m, inputs), mpf, to ``digits``.

    They are quotients of differences with a step small enough for that many digits. ``size`` estimates the largest
    derivative, in units of ``inputs.sizes``. PrecisionLoss where the derivatives are much larger than expected.
    """
    sizes = [float(size) for size in inputs.sizes if size]
    if not (0 < min(sizes) <= max(sizes) < inf and size < inf):
        raise PrecisionLoss("sensitivity: the inputs or the derivatives are beyond the range of floats")
    spread = ceil(log10(max(sizes)) - log10(min(sizes)))
    for _ in range(ATTEMPTS):
        large = max(0, ceil(log10(size)))
        step = digits // 2 + 1 + large
        K = MP(digits + step + large + spread + GUARD)
        found = _quotients(motion, inputs, K, K.coerce(10) ** -step)
        rows = np.array(sizes[: found.shape[1]])[:, None]
        largest = float(abs(found * np.array(sizes) / rows).max(initial=0))
        if largest <= 10 * size:
            return found
        size = largest
    raise PrecisionLoss(f"sensitivity: derivatives of {size:.0e} and more next to a separatrix; ask for earlier times")


def _quotients(motion: FlowMap, inputs: Inputs, K: MultiprecisionField, step: Real) -> np.ndarray:
    numbers = np.array([*map(K.coerce, inputs.numbers)], dtype=object)
    progress = Progress(f"sensitivity, by differences of motions in {K.dps} digits", 2 * len(numbers))

    def rows(k: int, change: Real) -> np.ndarray:
        moved = numbers.copy()
        moved[k] += change
        found = motion(moved, K)
        progress.add(1)
        return found

    columns = []
    for k, size in enumerate(inputs.sizes):
        if not size:
            continue
        unit = step * K.coerce(size)
        weights = ONE_SIDED if k in inputs.least else CENTRAL
        columns.append(sum(w * rows(k, n * unit) for n, w in weights.items()) / (2 * unit))
    return np.stack(columns, axis=2)
