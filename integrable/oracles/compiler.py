"""numba's ``njit`` for the integrators of this folder, which share no compiler with the flow that they check.

Compiled code is cached on disk: in the folder that NUMBA_CACHE_DIR names, ``__pycache__`` next to the source, or the
user's cache folder. If none is writable (a read-only installation and no home), every process compiles anew, with one
warning. numba is in every installation, because galois depends on it. Importing this module does not import numba.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jacobian.numbers.compiler import say_once


def njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """The decorator ``numba.njit`` with its cache on disk, or without a cache if no folder is writable."""
    import numba

    def decorate(function: Callable[..., Any]) -> Any:
        try:
            return numba.njit(cache=True, **options)(function)
        except RuntimeError as error:
            if "cannot cache" not in str(error):
                raise
        say_once()
        return numba.njit(**options)(function)

    return decorate
