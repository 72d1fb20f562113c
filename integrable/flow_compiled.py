"""The loops of the flow compiled by numba, from the same source as the readable ones (:mod:`integrable.flow_kernel`).

Importing this module imports numba; compiled code is kept on disk beside the source, so that only the first use pays
for it.
"""

from __future__ import annotations

from numba import njit
from numba.extending import overload, register_jitable

from integrable import flow_kernel
from jacobian.genus2_compiled import JIT


@overload(flow_kernel.estimate)
def _estimate(series, f0, eps):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    return lambda series, f0, eps: (-series[1] * f0 * eps * eps / 12, f0 * eps * eps / 4)


for _inner in (
    flow_kernel.pair,
    flow_kernel.settle,
    flow_kernel.carried,
    flow_kernel.settled,
    flow_kernel.shift,
    flow_kernel.rate_at,
    flow_kernel.clock_rate,
    flow_kernel.centre,
    flow_kernel.conjugate_points,
    flow_kernel.near_identity,
    flow_kernel.integrate_series,
    flow_kernel.moving_point,
    flow_kernel.reach,
    flow_kernel.rates,
    flow_kernel.offset_point,
    flow_kernel.state_at_time,
):
    register_jitable(fastmath=JIT["fastmath"], error_model=JIT["error_model"])(_inner)

wind = njit(**JIT)(flow_kernel.wind)
states_at_times = njit(**JIT)(flow_kernel.states_at_times)
states_at_offsets = njit(**JIT)(flow_kernel.states_at_offsets)
march = njit(**JIT)(flow_kernel.march)
