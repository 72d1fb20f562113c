"""The kernels of the flow made known to numba, from the readable source (:mod:`integrable.moving_point.kernel`), and
their loop over successive additions in floats.

Importing this module imports numba; compiled code is kept on disk beside the source, so that only the first use pays
for it.
"""

from __future__ import annotations

from numba.extending import overload, register_jitable

from integrable.moving_point import kernel
from jacobian.inexact.compiled import JIT
from jacobian.numbers import double_double_compiled as double_double
from jacobian.numbers.compiler import njit


@overload(kernel.estimate)
def _estimate(series, f0, eps):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    if isinstance(eps, double_double.DoubleDouble):
        return _estimate_in_floats
    return lambda series, f0, eps: (-series[1] * f0 * eps * eps / 12, f0 * eps * eps / 4)


def _estimate_in_floats(series, f0, eps):  # type: ignore[no-untyped-def]  # the same signature
    r = f0.hi * eps.hi * eps.hi / 4
    m = -series[1].hi * r / 3
    if abs(eps.hi) >= 1e-100:
        m, r = kernel.centre(series.data[: kernel.FLOAT_TERMS, 0], f0.hi, eps.hi, m, r, 6)
    return double_double.number(m, 0.0), double_double.number(r, 0.0)


for _inner in (
    kernel.pair,
    kernel.settle,
    kernel.carried,
    kernel.settled,
    kernel.shift,
    kernel.rate_at,
    kernel.clock_rate,
    kernel.abel_sums,
    kernel.centre,
    kernel.conjugate_points,
    kernel.near_identity,
    kernel.moving_point,
):
    register_jitable(_inner)

march = njit(**JIT)(kernel.march)
