"""Centres of panels, computed with as many digits as needed, for short runs near a separatrix
(:mod:`integrable.moving_point.short`).

Near a separatrix the size of a translation grows as fast as errors do, so the addition of a long one loses the digits
of both. Each centre is therefore reached from the last by one panel: the errors grow once, and a translation by one
panel loses no digits.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from integrable.moving_point.addition import shift
from integrable.moving_point.setup import Setup


class Centres:
    """The moving points ±(2n + 1)·``half`` from the start of a motion, in bare reals, computed on request."""

    def __init__(self, setup: Setup, half: float, sign: int) -> None:
        self.setup, translations = setup, setup.translations
        self._step = translations.near(2 * sign * half)
        self._points = [self._after(setup.bare.start, translations.near(sign * half))]

    def last(self, count: int) -> tuple[Any, ...]:
        """The centre of panel ``count`` − 1."""
        while len(self._points) < count:
            self._points.append(self._after(self._points[-1], self._step))
        return self._points[count - 1]

    def packed(self, count: int) -> np.ndarray:
        """The first ``count`` centres as double-doubles, shape (10·count, 2)."""
        self.last(count)
        with self.setup.reals:
            pairs = [(float(x), float(x - float(x))) for point in self._points[:count] for x in point]
        return np.array(pairs)

    def _after(self, point: tuple[Any, ...], step: tuple[Any, ...]) -> tuple[Any, ...]:
        bare, reals = self.setup.bare, self.setup.reals
        with reals:
            return reals.plain_row(shift(bare.f, bare.axes, point, step))
