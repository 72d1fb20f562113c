"""The kernels of the flow made known to numba, from the readable source (:mod:`integrable.flow_kernel`), and their loop
over successive additions in floats.

Importing this module imports numba; compiled code is kept on disk beside the source, so that only the first use pays
for it.
"""

from __future__ import annotations

from numba.extending import overload, register_jitable

import jacobian.retraction_compiled  # noqa: F401  (makes the retraction known to numba)
from integrable import flow_kernel
from jacobian import double_double_compiled as double_double
from jacobian.compiler import njit
from jacobian.genus2_compiled import JIT


@overload(flow_kernel.estimate)
def _estimate(series, f0, eps):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    if isinstance(eps, double_double.DoubleDouble):
        return _estimate_in_floats
    return lambda series, f0, eps: (-series[1] * f0 * eps * eps / 12, f0 * eps * eps / 4)


def _estimate_in_floats(series, f0, eps):  # type: ignore[no-untyped-def]  # the same signature
    r = f0.hi * eps.hi * eps.hi / 4
    m = -series[1].hi * r / 3
    if abs(eps.hi) >= 1e-100:
        m, r = flow_kernel.centre(series.data[: flow_kernel.FLOAT_TERMS, 0], f0.hi, eps.hi, m, r, 6)
    return double_double.number(m, 0.0), double_double.number(r, 0.0)


for _inner in (
    flow_kernel.pair,
    flow_kernel.settle,
    flow_kernel.carried,
    flow_kernel.settled,
    flow_kernel.shift,
    flow_kernel.rate_at,
    flow_kernel.clock_rate,
    flow_kernel.abel_sums,
    flow_kernel.centre,
    flow_kernel.conjugate_points,
    flow_kernel.near_identity,
    flow_kernel.moving_point,
):
    register_jitable(_inner)

march = njit(**JIT)(flow_kernel.march)
