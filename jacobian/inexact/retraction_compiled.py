"""Registers :mod:`jacobian.inexact.retraction` with numba, for floats and double-double numbers."""

from __future__ import annotations

from numba.extending import register_jitable

from jacobian.inexact import retraction

for _function in (retraction.remainder, retraction.retracted):
    register_jitable(_function)
