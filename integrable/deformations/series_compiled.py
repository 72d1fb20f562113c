"""The loops of :mod:`integrable.deformations.series` compiled by numba for double-double numbers."""

from __future__ import annotations

from numba.extending import register_jitable

from integrable.deformations import series
from jacobian.inexact import compiled
from jacobian.numbers.compiler import njit
from jacobian.numbers.double_double_compiled import JIT, numbers

# square roots of double-double numbers are registered there
assert compiled

_coefficients = register_jitable(series.coefficients)
_values_at = register_jitable(series.values_at)


@njit(**JIT)
def coefficients(kinds, left, right, rates, order, series):  # type: ignore[no-untyped-def]
    """:func:`integrable.deformations.series.coefficients`."""
    _coefficients(kinds, left, right, rates, order, numbers(series))


@njit(**JIT)
def values_at(x, order, series, out):  # type: ignore[no-untyped-def]
    """:func:`integrable.deformations.series.values_at`."""
    _values_at(numbers(x), order, numbers(series), numbers(out))
