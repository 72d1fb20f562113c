"""Sums of many divisors of genus 2 over the floats: the stable composition of :mod:`jacobian.genus2_real`, row by row.

For deg f = 5; the columns are those of :mod:`jacobian.batch.sums`. Importing this module imports numba.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numba import njit
from numba.extending import register_jitable

from jacobian import genus2_real
from jacobian.batch.sums import BLOCK, GIVEN_NOISE, NOISE, OPPOSITE, Columns, Sums, row
from jacobian.errors import ArgumentError
from jacobian.fields import RR
from jacobian.genus2_compiled import JIT

if TYPE_CHECKING:
    from jacobian.curve import HyperellipticCurve

# a sum with a slope below this part of the chord's size has a point that is far out or at infinity
FLATTEST = 2.0**-12


def scaled(half: Any, units: Any, columns: Any, i: Any) -> Any:
    """Divisor i on y² = f + h²/4 in the units of the kernel; ``half`` is h/2, ``units`` their inverses."""
    u0, u1 = columns[0, i], columns[1, i]
    v0, v1 = columns[2, i] + (half[0] - half[2] * u0), columns[3, i] + (half[1] - half[2] * u1)
    return u0 * units[0], u1 * units[1], v0 * units[2], v1 * units[3]


def on_curve(f: Any, divisor: Any, noise: Any) -> Any:
    """Whether f − V² vanishes modulo U, to ``noise`` times the size of the terms."""
    u0, u1, v0, v1 = divisor
    r0, r1, r2, r3, r4 = f[0] - v0 * v0, f[1] - 2 * v0 * v1, f[2] - v1 * v1, f[3], f[4]
    a0, a1 = abs(f[0]) + v0 * v0, abs(f[1]) + 2 * abs(v0 * v1)
    a2, a3, a4 = abs(f[2]) + v1 * v1, abs(f[3]), abs(f[4])
    s0, s1, top = abs(u0), abs(u1), f[5]
    size = abs(top)
    r4, r3, a4, a3 = r4 - u1 * top, r3 - u0 * top, a4 + s1 * size, a3 + s0 * size
    r3, r2, a3, a2 = r3 - u1 * r4, r2 - u0 * r4, a3 + s1 * a4, a2 + s0 * a4
    r2, r1, a2, a1 = r2 - u1 * r3, r1 - u0 * r3, a2 + s1 * a3, a1 + s0 * a3
    r1, r0, a1, a0 = r1 - u1 * r2, r0 - u0 * r2, a1 + s1 * a2, a0 + s0 * a2
    return (abs(r0) <= noise * a0) & (abs(r1) <= noise * a1)


def apart(first: Any, second: Any) -> Any:
    """Whether the first divisor is not the opposite of the second, nor so near to it that their sum has few digits."""
    u0, u1, v0, v1 = first
    s0, s1, t0, t1 = second
    distance = abs(u0 - s0) + abs(u1 - s1) + abs(v0 + t0) + abs(v1 + t1)
    return distance > OPPOSITE * (1 + abs(u0) + abs(u1) + abs(v0) + abs(v1))


for _function in (scaled, on_curve, apart, row):
    register_jitable(forceinline=True)(_function)


@njit(**JIT)
def _add_columns(
    f: Any,
    half: Any,
    units: Any,
    inverses: Any,
    first: Columns,
    second: Columns,
    out: Columns,
    doubtful: np.ndarray,
    begin: int,
    end: int,
) -> None:
    """In blocks: what is the same for all rows goes through loops that LLVM makes vector instructions of."""
    # the summands, the sum and its slope: rows of one array, which do not overlap
    block = np.empty((13, BLOCK))
    each = second.shape[1] > 1
    if not each:
        for i in range(BLOCK):
            block[4, i], block[5, i], block[6, i], block[7, i] = scaled(half, inverses, second, 0)
    for start in range(begin, end, BLOCK):
        count = min(BLOCK, end - start)
        for i in range(count):
            block[0, i], block[1, i], block[2, i], block[3, i] = scaled(half, inverses, first, start + i)
        if each:
            for i in range(count):
                block[4, i], block[5, i], block[6, i], block[7, i] = scaled(half, inverses, second, start + i)
        for i in range(count):
            total, transfer = genus2_real.add(f, row(block, 0, i), row(block, 4, i))
            block[8, i], block[9, i], block[10, i], block[11, i] = total
            block[12, i] = transfer[1]
        for i in range(count):
            useful = on_curve(f, row(block, 8, i), NOISE) & (abs(block[12, i]) > FLATTEST)
            doubtful[start + i] = not (useful & apart(row(block, 0, i), row(block, 4, i)))
        for i in range(count):
            u0, u1 = block[8, i] * units[0], block[9, i] * units[1]
            out[0, start + i], out[1, start + i] = u0, u1
            out[2, start + i] = block[10, i] * units[2] - (half[0] - half[2] * u0)
            out[3, start + i] = block[11, i] * units[3] - (half[1] - half[2] * u1)


@njit(**JIT)
def _first_off_curve(f: Any, half: Any, inverses: Any, divisors: Columns) -> int:
    for i in range(divisors.shape[1]):
        if not on_curve(f, scaled(half, inverses, divisors, i), GIVEN_NOISE):
            return i
    return -1


class RealSums(Sums):
    """Addition on y² + h(x)y = f(x) with deg f = 5 over RR; ArgumentError for any other curve."""

    lengths = (6, 3)
    add_columns = staticmethod(_add_columns)
    find_off_curve = staticmethod(_first_off_curve)

    def __init__(self, curve: HyperellipticCurve) -> None:
        if not is_served(curve):
            raise ArgumentError(f"curve = {curve!r}: compiled sums of floats need y² + hy = f(x), deg f = 5, over RR")
        super().__init__(curve)


def is_served(curve: HyperellipticCurve) -> bool:
    """Whether :class:`RealSums` takes a curve."""
    return curve.field == RR and curve.genus == 2 and curve.model == "ramified" and len(curve.f) == 6
