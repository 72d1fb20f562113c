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
def march(f: Reals, axes: Reals, point: Reals, step: Reals, count: int, out: Reals) -> None:
    """:func:`integrable.flow_kernel.march`, into ``out`` of shape (10, 2)."""
    _store(numbers(out), flow_kernel.march(numbers(f), numbers(axes), numbers(point), numbers(step), count))


@njit(**JIT)
def _store(row: Any, point: Any) -> None:
    """The ten numbers of a moving point into a row."""
    for c in range(10):
        row[c] = point[c]
