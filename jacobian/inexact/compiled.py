"""Registers the bare-real kernel and the retraction with numba: after this import compiled code can call them.

Numbers are floats. The functions take the compiler's options, :data:`JIT`, from the function that calls them.
"""

from __future__ import annotations

from math import sqrt

from numba.extending import overload, register_jitable

from jacobian.inexact import genus2_real, retraction
from jacobian.numbers.roots import negligible, root

# no division may raise: a zero divisor gives inf or nan, which callers test for once, at the end
JIT = {"nogil": True, "error_model": "numpy", "fastmath": {"contract"}}


@overload(root)
def _root(x):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    return lambda x: sqrt(x)


@overload(negligible)
def _negligible(small, large):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    return lambda small, large: large + small == large


for _function in (
    genus2_real.slope,
    genus2_real.newton_step,
    genus2_real.tangent_polynomial,
    genus2_real.second_polynomial,
    genus2_real.chord,
    genus2_real.add,
    retraction.remainder,
    retraction.retracted,
):
    register_jitable(_function)
