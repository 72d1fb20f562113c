"""Incomplete elliptic integrals on arrays of floats or long doubles.

The third kind by duplication (Carlson 1995, *Numerical computation of real or complex elliptic integrals*), the first
and the amplitude by descending Landen transformations (Abramowitz & Stegun 16.4, 17.6). Errors are some units in the
last place.
"""

from __future__ import annotations

from math import ceil, log
from typing import Any

import numpy as np

Array = Any
# terms of arctan(√e)/√e below this e
SMALL, TERMS = 1e-3, 8


def first_kind_swing(x: Array, k: Any, missing: Any) -> Array:
    """F(x | m) − (2K/π)x for k = √(1 − m) > 0, |x| ≤ π/2, to the last digits of itself: it is of the size of m.

    ``missing`` = 1 − k. By descending Landen transformations (Abramowitz & Stegun 17.6), of which only what they change
    is summed.
    """
    one = x.dtype.type(1)
    a, b, difference, total, weight = one, k * one, missing * one, 0 * x, one
    while True:
        s, c = np.sin(x), np.cos(x)
        change = -np.arctan2(difference * s * c, a * c * c + b * s * s)
        weight /= 2
        total = total + weight * change
        x = 2 * x + change
        root = np.sqrt(a) + np.sqrt(b)
        a, b, difference = (a + b) / 2, np.sqrt(a * b), (difference / root) ** 2 / 2
        if abs(difference) <= np.finfo(x.dtype).eps ** 2 * a:
            return total / a


def carlson_j(x: Array, y: Array, z: Array, p: Array, product: Array) -> Array:
    """R_J(x, y, z, p) = (3/2)∫dt/((t+p)√((t+x)(t+y)(t+z))), p > 0; ``product`` = (p − x)(p − y)(p − z) ≥ 0."""
    mean = start = (x + y + z + 2 * p) / 5
    farthest = np.maximum(np.maximum(abs(start - x), abs(start - y)), np.maximum(abs(start - z), abs(start - p)))
    bound, scale = (np.finfo(start.dtype).eps / 4) ** (-1 / 8) * farthest, 1.0
    dx, dy, dz, total = start - x, start - y, start - z, 0 * start
    while (bound * scale > mean).any():
        root_x, root_y, root_z, root_p = np.sqrt(x), np.sqrt(y), np.sqrt(z), np.sqrt(p)
        step = root_x * root_y + root_x * root_z + root_y * root_z
        d = (root_p + root_x) * (root_p + root_y) * (root_p + root_z)
        total += scale / d * _arctan_over(scale**3 * product / d / d)
        x, y, z, p = (x + step) / 4, (y + step) / 4, (z + step) / 4, (p + step) / 4
        mean, scale = (mean + step) / 4, scale / 4
    dx, dy, dz = dx * scale / mean, dy * scale / mean, dz * scale / mean
    dp, e = (-dx - dy - dz) / 2, dx * dy * dz
    e2 = dx * dy + dx * dz + dy * dz - 3 * dp * dp
    e3, e4, e5 = e + (2 * e2 + 4 * dp * dp) * dp, (2 * e + (e2 + 3 * dp * dp) * dp) * dp, e * dp * dp
    series = 1 - 3 * e2 / 14 + e3 / 6 + 9 * e2 * e2 / 88 - 3 * e4 / 22 - 9 * e2 * e3 / 52 + 3 * e5 / 26
    series += 3 * e3 * e3 / 40 - e2 * e2 * e2 / 16 + 3 * e2 * e4 / 20
    series += 45 * e2 * e2 * e3 / 272 - 9 * (e3 * e4 + e2 * e5) / 68
    return scale * series / (mean * np.sqrt(mean)) + 6 * total


def _arctan_over(e: Array) -> Array:
    """arctan(√e)/√e for e ≥ 0."""
    most, series = float(np.max(e, initial=0)), 0 * e
    if np.min(e, initial=SMALL) < SMALL:
        # as many terms as the largest of these takes
        least = max(min(most, SMALL), 1e-300)
        for n in range(min(TERMS, ceil(log(np.finfo(e.dtype).eps / 4) / log(least))), -1, -1):
            series = e.dtype.type(1) / (2 * n + 1) - e * series
    if most < SMALL:
        return series
    far = np.sqrt(np.maximum(e, SMALL))
    return np.where(e < SMALL, series, np.arctan(far) / far)


def amplitude(v: Array, k: Any) -> Array:
    """x with ∫_0^x dy/√(cos²y + k²sin²y) = v, |x| ≤ π/2, for 0 < k ≤ 1."""
    one = v.dtype.type(1)
    a, b, levels = one, k * one, []
    while True:
        levels.append((a - b) / (a + b))
        a, b = (a + b) / 2, np.sqrt(a * b)
        if abs(a - b) <= np.finfo(v.dtype).eps * a:
            break
    x = v * a * 2 ** len(levels)
    for ratio in levels[::-1]:
        # sin(2x' − x) = (c/a) sin x with c/a of the next level
        x = (x + np.arcsin(np.clip(ratio * np.sin(x), -1, 1))) / 2
    return x


class FirstKind:
    """F(x | m), |x| ≤ π/2, and its inverse for one k = √(1 − m) > 0: the mean (2K/π)x and a swing about it.

    ``missing`` = 1 − k and ``quarter`` = K, numbers of the same kind as the x.
    """

    def __init__(self, k: Any, missing: Any, quarter: Any) -> None:
        self.k, self.missing, self.quarter = k, missing, quarter
        self._right_angle = np.arccos(0 * quarter)

    def swing(self, x: Array) -> Array:
        """F(x | m) − (2K/π)x."""
        return first_kind_swing(x, self.k, self.missing) if self.missing else 0 * x

    def at(self, x: Array) -> Array:
        """F(x | m)."""
        return self.quarter / self._right_angle * x + self.swing(x)

    def inverse(self, v: Array) -> Array:
        """x with F(x | m) = v."""
        k = self.k
        x = amplitude(v, k) if k <= 1 else self._right_angle - amplitude(k * (self.quarter - v), 1 / k)
        # a step of Newton, for what the transformations have rounded
        return x - (self.at(x) - v) * np.sqrt(np.cos(x) ** 2 + (k * np.sin(x)) ** 2)
