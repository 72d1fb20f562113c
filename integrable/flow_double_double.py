"""The loops of the flow on double-double numbers (about 32 digits), compiled from the same source as those on floats.

Arguments are as for the loop of :mod:`integrable.flow_kernel` of the same name, with reals as float arrays (…, 2), the
form of :func:`jacobian.double_double.pack`: a point is (10, 2), a single real (2,); step counts are int64 arrays.
Importing this module imports numba; compiled code is kept on disk beside the source.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

import integrable.flow_compiled  # noqa: F401  (makes the functions of flow_kernel known to numba)
from integrable import flow_kernel
from jacobian.double_double_compiled import JIT, number, numbers

Reals = np.ndarray


@njit(**JIT)
def sums(f: Reals, axes: Reals, points: Reals, steps: Reals, out: Reals) -> None:
    """``out[i, j]`` = ``points[i]`` + ``steps[j]``: every moving point after every translation."""
    curve, lines, froms, bys, tos = numbers(f), numbers(axes), numbers(points), numbers(steps), numbers(out)
    for i in range(len(froms)):
        for j in range(len(bys)):
            _store(tos[i][j], flow_kernel.shift(curve, lines, froms[i], bys[j]))


@njit(**JIT)
def multiples(f: Reals, axes: Reals, start: Reals, step: Reals, out: Reals) -> None:
    """``out[k]`` = ``start`` + k·``step`` for k = 0, 1, …, one addition after the other."""
    curve, lines, by, tos = numbers(f), numbers(axes), numbers(step), numbers(out)
    point = flow_kernel.moving_point(numbers(start))
    for k in range(len(tos)):
        if k > 0:
            point = flow_kernel.shift(curve, lines, point, by)
        _store(tos[k], point)


@njit(**JIT)
def rates_at(axes: Reals, points: Reals, out: Reals) -> None:
    """1/g at every moving point, into ``out`` of shape (N, 2)."""
    lines, froms, tos = numbers(axes), numbers(points), numbers(out)
    for i in range(len(froms)):
        tos[i] = flow_kernel.rate_at(lines, froms[i])


@njit(**JIT)
def near_identity(series: Reals, roots: Reals, f0: Reals, axes: Reals, eps: Reals, passes: int, out: Reals) -> None:
    """T(eps) for every eps ≠ 0 of an array (N, 2), into ``out`` of shape (N, 10, 2)."""
    powers, powers2, lines, offsets, tos = numbers(series), numbers(roots), numbers(axes), numbers(eps), numbers(out)
    scale = number(f0[0], f0[1])
    for i in range(len(offsets)):
        _store(tos[i], flow_kernel.near_identity(powers, powers2, scale, lines, offsets[i], passes))


@njit(**JIT)
def reach(f: Reals, axes: Reals, start: Reals, counts: Any, table: Reals, steps: Any, out: Reals) -> None:
    """:func:`integrable.flow_kernel.reach` for every number of steps, into ``out`` of shape (N, 10, 2)."""
    curve, lines, origin, rows, tos = numbers(f), numbers(axes), numbers(start), numbers(table), numbers(out)
    for i in range(len(steps)):
        _store(tos[i], flow_kernel.reach(curve, lines, origin, counts, rows, steps[i]))


@njit(**JIT)
def states_at_offsets(
    f: Reals,
    axes: Reals,
    start: Reals,
    counts: Any,
    table: Reals,
    series: Reals,
    roots: Reals,
    half_step: Reals,
    passes: int,
    sign: int,
    steps: Any,
    offsets: Reals,
    points: Reals,
) -> None:
    """:func:`integrable.flow_kernel.states_at_offsets`."""
    flow_kernel.states_at_offsets(
        numbers(f),
        numbers(axes),
        numbers(start),
        counts,
        numbers(table),
        numbers(series),
        numbers(roots),
        number(half_step[0], half_step[1]),
        passes,
        sign,
        steps,
        numbers(offsets),
        numbers(points),
    )


@njit(**JIT)
def states_at_times(
    f: Reals,
    axes: Reals,
    start: Reals,
    counts: Any,
    table: Reals,
    nodes: Reals,
    legendre: Reals,
    series: Reals,
    roots: Reals,
    half_step: Reals,
    passes: int,
    sign: int,
    steps: Any,
    rests: Reals,
    rests_next: Reals,
    points: Reals,
    offsets: Reals,
) -> None:
    """:func:`integrable.flow_kernel.states_at_times`."""
    flow_kernel.states_at_times(
        numbers(f),
        numbers(axes),
        numbers(start),
        counts,
        numbers(table),
        numbers(nodes),
        numbers(legendre),
        numbers(series),
        numbers(roots),
        number(half_step[0], half_step[1]),
        passes,
        sign,
        steps,
        numbers(rests),
        numbers(rests_next),
        numbers(points),
        numbers(offsets),
    )


@njit(**JIT)
def wind(
    f: Reals,
    axes: Reals,
    counts: Any,
    table: Reals,
    nodes: Reals,
    left: Reals,
    right: Reals,
    first: int,
    stack: Reals,
    ends: Any,
    carry: Reals,
    high: Reals,
    low: Reals,
) -> None:
    """:func:`integrable.flow_kernel.wind`."""
    flow_kernel.wind(
        numbers(f),
        numbers(axes),
        counts,
        numbers(table),
        numbers(nodes),
        numbers(left),
        numbers(right),
        first,
        numbers(stack),
        ends,
        numbers(carry),
        numbers(high),
        numbers(low),
    )


@njit(**JIT)
def march(f: Reals, axes: Reals, point: Reals, step: Reals, count: int, out: Reals) -> None:
    """:func:`integrable.flow_kernel.march`, into ``out`` of shape (10, 2)."""
    _store(numbers(out), flow_kernel.march(numbers(f), numbers(axes), numbers(point), numbers(step), count))


@njit(**JIT)
def _store(row: Any, point: Any) -> None:
    """The ten numbers of a moving point into a row."""
    for c in range(10):
        row[c] = point[c]
