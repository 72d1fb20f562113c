"""numba's ``njit`` as this package uses it: compiled code is cached on disk if any folder is writable.

numba keeps it in the folder that NUMBA_CACHE_DIR names, in ``__pycache__`` beside the source, or in the user's cache
folder. Where it can write to none of them (a read-only installation and no home) every process compiles anew, and says
so once. Importing this module does not import numba.
"""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable
from functools import cache
from typing import Any

from jacobian.errors import ArgumentError

__all__ = ["NoCacheWarning", "interpreted", "look_for_a_place", "njit"]


class NoCacheWarning(UserWarning):
    """Compiled code cannot be kept on disk."""


def njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """A decorator: ``numba.njit`` with its cache on disk, or without one if numba finds no folder for it."""
    import numba

    def decorate(function: Callable[..., Any]) -> Any:
        if (kept := _kept(function, options)) is not None:
            return kept
        say_once()
        return numba.njit(**options)(function)

    return decorate


def _kept(function: Callable[..., Any], options: dict[str, Any]) -> Any:
    """The function compiled by numba with a cache, None if there is no folder for one."""
    import numba

    try:
        return numba.njit(cache=True, **options)(function)
    except RuntimeError as error:
        if "cannot cache" not in str(error):
            raise
        return None


NO_PLACE = "no folder to keep compiled code in"
REMEDY = "set NUMBA_CACHE_DIR to a folder that can be written to"


@cache
def say_once() -> None:
    text = f"{NO_PLACE}: every process compiles anew, which takes a minute; {REMEDY}"
    warnings.warn(text, NoCacheWarning, stacklevel=4)


def look_for_a_place(*, needed: bool = False) -> None:
    """Warn now if there is no folder for compiled code; ArgumentError if one is needed."""
    if _kept(look_for_a_place, {}) is None:
        if needed:
            raise ArgumentError(f"{NO_PLACE}; {REMEDY}")
        say_once()


def interpreted() -> bool:
    """Whether numba is told not to compile (NUMBA_DISABLE_JIT=1): the readable loops are used then."""
    if "numba" in sys.modules:
        return bool(sys.modules["numba"].config.DISABLE_JIT)
    return os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
