"""Compiled sums of many divisors of genus 2 over the floats and complex numbers.

This module chooses the units of x and y and calls the loops of :mod:`jacobian.batch.float_kernels` on all threads.
Without compilation the loops run in Python.

A divisor is a column here, as in :mod:`jacobian.batch.block_loops`: ``x[i, j]`` is the i-th coordinate (u₀, u₁, v₀, v₁)
of divisor j. A sum is reported instead of returned if its degree drops, or if its remainder f − V² mod U shows that
digits were lost; then :mod:`jacobian.inexact.composition` computes it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import log2
from typing import Any

import numpy as np

from jacobian import poly
from jacobian.batch import float_kernels
from jacobian.curve.curve import HyperellipticCurve
from jacobian.fields import RR
from jacobian.native.kinds import COMPLEX, FLOAT, INT, ArrayKind, TupleKind
from jacobian.native.library import Library
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.threads import in_ranges

Columns = np.ndarray

RANGE = 1 << 14
"""The number of columns in one task of a thread."""


@cache
def library(is_complex: bool, size: int) -> Library:
    """The compiled loops for real or complex numbers and an f of ``size`` coefficients."""
    number, units = COMPLEX if is_complex else FLOAT, TupleKind((FLOAT,) * 4)
    parts = len(number.leaves)
    f, half, columns = TupleKind((number,) * size), TupleKind((number,) * (size - 3)), ArrayKind(number, 2, parts)
    curve, marks, span = TupleKind((f, half, units, units)), ArrayKind(INT, stored="bool"), TupleKind((INT, INT))
    entries = {
        "add_columns": (
            float_kernels.add_columns,
            (curve, columns, columns, columns, marks, span, ArrayKind(number, 1, parts)),
        ),
        "first_off_curve": (float_kernels.first_off_curve, (f, half, units, columns)),
    }
    return Library(
        f"sums_of_{'complex' if is_complex else 'real'}_divisors_{size}", entries, inlined_but=(float_kernels.improved,)
    )


class FloatSums:
    """Addition on y² + h(x)y = f(x) of genus 2 over RR or CC, on columns (u₀, u₁, v₀, v₁) of shape (4, N).

    The curve is its own ``arithmetic_model``: if ramified, of degree 5. ``dtype`` is the dtype of the columns.
    """

    def __init__(self, curve: HyperellipticCurve) -> None:
        K = curve.field
        real_quintic = K is RR and curve.model == "ramified"
        half = tuple(c / 2 for c in curve.h)
        f = poly.add(K, curve.f, poly.mul(K, half, half)) if half else curve.f
        self.dtype = np.dtype(type(K.one))
        half = tuple([*half, *[K.zero] * 4][: 3 if real_quintic else 4])
        # units of x and y, powers of 2: in them f's largest coefficient and the geometric mean of its roots are about 1
        lowest, top = next(k for k, c in enumerate(f) if c), len(f) - 1
        x = _power_of_two(abs(f[lowest] / f[-1]) ** (1 / (top - lowest))) if lowest < top else 1.0
        y = _power_of_two(max(abs(c) * x**k for k, c in enumerate(f)) ** 0.5)
        self._f = tuple([*(c * x**k / y**2 for k, c in enumerate(f)), *[K.zero] * 7][: 6 if real_quintic else 7])
        units = (x * x, x, y, y / x)
        self._constants = self._f, half, units, tuple(1 / unit for unit in units)
        self._loops: Any = float_kernels if interpreted() else library(self.dtype.kind == "c", len(self._f))

    def add(self, first: Columns, second: Columns) -> tuple[Columns, np.ndarray]:
        """Adds column by column; returns (sums, doubtful). ``second`` is (4, N), or (4, 1) for one divisor added to
        all.

        Columns marked in ``doubtful`` must not be used. All divisors have weight 2.
        """
        out, doubtful = np.empty(first.shape, self.dtype), np.empty(first.shape[1], dtype=np.bool_)
        arrays = [self._view(x) for x in (first, second, out)]

        def work(begin: int, end: int) -> None:
            scratch = self._view(np.empty(float_kernels.SCRATCH, self.dtype))
            self._loops.add_columns(self._constants, *arrays, doubtful, (begin, end), scratch)

        in_ranges(first.shape[1], RANGE, _one_by_one(work, doubtful) if self._loops is float_kernels else work)
        return out, doubtful

    def first_off_curve(self, divisors: Columns) -> int:
        """The index of the first column whose remainder f − V² mod U exceeds 2^-32 of the size of its terms, or −1.

        All columns have weight 2.
        """
        f, half, _, inverses = self._constants
        return int(self._loops.first_off_curve(f, half, inverses, self._view(divisors)))

    def _view(self, numbers: Columns) -> Columns:
        """``numbers`` in the form that the loops take: a view if the array is contiguous, else a copy."""
        numbers = np.ascontiguousarray(numbers)
        if self.dtype.kind != "c" or self._loops is float_kernels:
            return numbers
        return numbers.view(np.float64).reshape(*numbers.shape, 2)


def _one_by_one(work: Callable[[int, int], None], doubtful: np.ndarray) -> Callable[[int, int], None]:
    """A function that runs ``work`` on one column at a time, for interpreted loops. A column in which a division by
    zero raises an error is marked in ``doubtful``.
    """

    def each(begin: int, end: int) -> None:
        with np.errstate(all="ignore"):
            for j in range(begin, end):
                try:
                    work(j, j + 1)
                except (ArithmeticError, ValueError):
                    doubtful[j] = True

    return each


def _power_of_two(x: float) -> float:
    """The power of 2 nearest to x; 1 for 0."""
    return float(2.0 ** round(log2(x or 1.0)))
