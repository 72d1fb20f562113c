"""Additions to moving points made known to numba, from the readable source
(:mod:`integrable.moving_point.addition`), and the loop over successive ones in floats.

Importing this module imports numba; compiled code is kept on disk beside the source, so that only the first use pays
for it.
"""

from __future__ import annotations

from numba.extending import overload, register_jitable

from integrable.moving_point import addition, translations
from jacobian.inexact.compiled import JIT
from jacobian.numbers import double_double_compiled as double_double
from jacobian.numbers.compiler import njit


@overload(addition.estimate)
def _estimate(series, f0, eps):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    if isinstance(eps, double_double.DoubleDouble):
        return _estimate_in_floats
    return lambda series, f0, eps: (-series[1] * f0 * eps * eps / 12, f0 * eps * eps / 4)


def _estimate_in_floats(series, f0, eps):  # type: ignore[no-untyped-def]  # the same signature
    r = f0.hi * eps.hi * eps.hi / 4
    m = -series[1].hi * r / 3
    if abs(eps.hi) >= 1e-100:
        m, r = addition.centre(series.data[: addition.FLOAT_TERMS, 0], f0.hi, eps.hi, m, r, 6)
    return double_double.number(m, 0.0), double_double.number(r, 0.0)


for _inner in (
    addition.pair,
    addition.settle,
    addition.carried,
    addition.settled,
    addition.shift,
    addition.rate_at,
    addition.rate_after,
    addition.abel_sums,
    addition.centre,
    addition.conjugate_points,
    addition.near_identity,
    addition.moving_point,
    addition.put,
    addition.opposite,
    addition.conditioning,
    translations.power_series,
):
    register_jitable(_inner)

march = njit(**JIT)(addition.march)
