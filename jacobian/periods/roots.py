"""The complex roots of a polynomial in working numbers, and related functions."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from typing import Any

from jacobian.errors import PrecisionLoss
from jacobian.periods.quadrature import Numbers


def simple_roots(numbers: Numbers, coefficients: Sequence[Any]) -> list[Any]:
    """All roots of a polynomial of degree ≥ 1 (ascending working numbers), in doubles first (Aberth 1973).

    Simple roots are accurate to the working precision; multiple ones inevitably lose digits.
    """
    if len(coefficients) == 2:
        return [-coefficients[0] / coefficients[1]]
    rough = _aberth([complex(c) for c in coefficients], _circle(coefficients), 1e-15)
    if numbers.machine:
        return rough
    return _aberth(coefficients, [numbers.convert(x) for x in rough], numbers.ten(2 - numbers.digits))


def check_separated(numbers: Numbers, roots: Sequence[Any]) -> list[Any]:
    """The distance of every root from the nearest other one; PrecisionLoss if one is zero to half the digits."""
    distances = [min(abs(x - y) for j, y in enumerate(roots) if j != i) for i, x in enumerate(roots)]
    if min(distances) <= numbers.ten(-numbers.digits // 2) * max(abs(x) for x in roots):
        raise PrecisionLoss(
            f"two of the roots {[complex(x) for x in roots]} coincide at this precision; use more digits"
        )
    return distances


def conjugated(numbers: Numbers, roots: Sequence[Any]) -> list[Any]:
    """The roots of a real polynomial: real ones, ascending, then exact pairs of conjugates.

    The conjugate of a root x is another root, at the distance 2|Im x|, or x itself; then Im x is a rounding error.
    """
    distances = check_separated(numbers, roots)
    line = [numbers.convert(x.real) for x, d in zip(roots, distances, strict=True) if 4 * abs(x.imag) < d]
    above = [x for x, d in zip(roots, distances, strict=True) if 4 * abs(x.imag) >= d and x.imag > 0]
    line.sort(key=lambda x: x.real)
    return line + above + [x.conjugate() for x in above]


def _circle(coefficients: Sequence[Any]) -> list[complex]:
    n = len(coefficients) - 1
    a = [complex(c) for c in coefficients]
    centre = -a[-2] / (n * a[-1])
    radius = max((abs(c / a[-1]) ** (1 / (n - i)) for i, c in enumerate(a[:-1]) if c), default=1.0)
    return [centre + radius * cmath.exp(1j * (0.4 + 2 * math.pi * k / n)) for k in range(n)]


def _aberth(a: Sequence[Any], x: list[Any], tolerance: Any) -> list[Any]:
    slope, sizes = [i * c for i, c in enumerate(a)][1:], [abs(c) for c in a]
    x, moving = list(x), set(range(len(x)))
    for _ in range(500):
        change = 0
        for i in sorted(moving):
            z = x[i]
            value, derivative = horner(a, z), horner(slope, z)
            # a value that is rounding allows one last step: at a multiple root further steps are as long as this one
            if abs(value) <= tolerance * 8 * horner(sizes, abs(z)):
                moving.discard(i)
            if not value:
                continue
            crowd = sum(1 / (z - other) for j, other in enumerate(x) if j != i and other != z)
            below = derivative - value * crowd
            step = value / below if below else abs(z) * tolerance
            x[i] = z - step
            change = max(change, abs(step) / (abs(z) or 1))
        if change <= tolerance * 8:
            break
    return x


def horner(a: Sequence[Any], z: Any) -> Any:
    """a(z)."""
    value = a[-1]
    for c in a[-2::-1]:
        value = value * z + c
    return value
