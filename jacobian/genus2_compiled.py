"""Registers the bare-real kernel with numba: after this import compiled code can call ``genus2_real``."""

from __future__ import annotations

from math import sqrt

from numba.extending import overload, register_jitable

from jacobian import genus2_real

# nothing here may divide by zero and go on: a zero divisor gives inf or nan, which callers test for once, at the end
JIT = {"cache": True, "nogil": True, "error_model": "numpy", "fastmath": {"contract"}}


@overload(genus2_real.root)
def _root(x):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    return lambda x: sqrt(x)


for _function in (
    genus2_real.slope,
    genus2_real.tangent_polynomial,
    genus2_real.second_polynomial,
    genus2_real.chord,
    genus2_real.add,
):
    register_jitable(fastmath=JIT["fastmath"], error_model=JIT["error_model"])(_function)
