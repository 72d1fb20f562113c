"""The discrete Fourier transform of real samples on a grid whose sides are powers of 2, in loops to be compiled."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from jacobian.numbers.abreast import abreast
from jacobian.numbers.double_double import double_double_row

Row = Any

# bits to which :func:`circle_of` computes its numbers before rounding
BITS = 160


def half_spectrum(samples: Row, grid: tuple[int, int], circle: Row, room: Row, other: Row, out: Row) -> None:
    """Writes the coefficients of e^{2πi(kx + my)} into ``out``, for k = 0, …, rows/2 and all m.

    Row k follows row k − 1, with m in the order of a discrete transform; real and imaginary parts alternate.
    ``grid`` is (rows, columns); ``samples`` are the values at x = i/rows, y = j/columns, row by row. ``circle`` is
    :func:`circle_of` of the longer side or of a multiple of it. ``room`` and ``other`` are scratch for
    (rows + 2)·columns numbers each.
    """
    rows, columns = grid
    for n in range(rows * columns):
        room[n] = samples[n]
    # two neighbouring columns are transformed as real and imaginary parts; their transforms are separated afterwards
    if transformed(room, rows, columns // 2, circle, other):
        across(other, grid, circle, room, out)
    else:
        across(room, grid, circle, other, out)


def across(values: Row, grid: tuple[int, int], circle: Row, other: Row, out: Row) -> None:
    """The second half of :func:`half_spectrum`: writes the coefficients to ``out``. ``values`` holds the transforms
    along the columns, where one complex transform stands for two real columns.
    """
    rows, columns = grid
    height, half, scale = rows // 2 + 1, columns // 2, 0.5 / (rows * columns)
    for j in range(half):
        for k in abreast(0, height):
            n, m = 2 * (k * half + j), 2 * ((rows - k) % rows * half + j)
            a, b, c, d = values[n], values[n + 1], values[m], values[m + 1]
            place = 4 * j * height + 2 * k
            other[place], other[place + 1] = (a + c) * scale, (b - d) * scale
            place += 2 * height
            other[place], other[place + 1] = (b + d) * scale, (c - a) * scale
    if transformed(other, columns, height, circle, values):
        put_rows(values, grid, out)
    else:
        put_rows(other, grid, out)


def put_rows(values: Row, grid: tuple[int, int], out: Row) -> None:
    """Transposes the complex numbers ``values``, stored by columns, into ``out``, stored by rows."""
    height, columns = grid[0] // 2 + 1, grid[1]
    for k in range(height):
        for j in range(columns):
            n, m = 2 * (k * columns + j), 2 * (j * height + k)
            out[n], out[n + 1] = values[m], values[m + 1]


def transformed(values: Row, rows: int, width: int, circle: Row, other: Row) -> bool:
    """Computes Σ_j x_j·e^{−2πijk/rows} for the rows x_j of ``values``; returns whether the result is in ``other``.

    Otherwise it is in ``values``. Each of the ``rows`` rows has ``width`` complex numbers, whose real and imaginary
    parts alternate. The order is Stockham's (Swarztrauber 1982).
    """
    size, stride, turned = rows, width, False
    while size > 1:
        if turned:
            pass_over(other, values, size, stride, circle)
        else:
            pass_over(values, other, size, stride, circle)
        size, stride, turned = size // 2, 2 * stride, not turned
    return turned


def pass_over(values: Row, out: Row, size: int, stride: int, circle: Row) -> None:
    """Writes one level of :func:`transformed` from ``values`` to ``out``."""
    half, step = size // 2, len(circle) // size
    for p in range(half):
        begin, far, place = 2 * p * stride, 2 * (p + half) * stride, 4 * p * stride
        x, y = circle[2 * p * step], circle[2 * p * step + 1]
        for t in abreast(0, stride):
            n = 2 * t
            a, b, c, d = values[begin + n], values[begin + n + 1], values[far + n], values[far + n + 1]
            out[place + n], out[place + n + 1] = a + c, b + d
            n += place + 2 * stride
            a, b = a - c, b - d
            # most factors of a small grid are 1 or −i, which need no multiplication
            if p == 0:
                out[n], out[n + 1] = a, b
            elif 2 * p == half:
                out[n], out[n + 1] = b, -a
            else:
                out[n], out[n + 1] = a * x - b * y, a * y + b * x


@cache
def circle_of(size: int) -> np.ndarray:
    """e^{−2πik/size} for k < size/2 as double-double numbers, real and imaginary parts alternating, shape (size, 2)."""
    from mpmath import MPContext

    context = MPContext()
    context.prec = BITS
    points = [context.expjpi(-context.mpf(2 * k) / size) for k in range(size // 2)]
    circle = double_double_row(x for point in points for x in (point.real, point.imag))
    circle.flags.writeable = False
    return circle
