"""numba's ``njit`` as this package uses it: compiled code is cached on disk if any folder is writable.

numba's cache is the folder that NUMBA_CACHE_DIR names, ``__pycache__`` next to the source, or the user's cache folder.
If none is writable (a read-only installation and no home), every process compiles anew, with one warning. Importing
this module does not import numba.
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
    """The warning that compiled code cannot be cached on disk."""


def njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """The decorator ``numba.njit`` with its cache on disk, or without a cache if no folder is writable."""
    import numba

    def decorate(function: Callable[..., Any]) -> Any:
        if (kept := _kept(function, options)) is not None:
            return kept
        say_once()
        return numba.njit(**options)(function)

    return decorate


def _kept(function: Callable[..., Any], options: dict[str, Any]) -> Any:
    """The function compiled by numba with a cache on disk; None if no folder is writable."""
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
    """Warns if no folder for compiled code is writable; raises ArgumentError instead if one is ``needed``."""
    if _kept(look_for_a_place, {}) is None:
        if needed:
            raise ArgumentError(f"{NO_PLACE}; {REMEDY}")
        say_once()


def interpreted() -> bool:
    """Whether numba's compilation is switched off (NUMBA_DISABLE_JIT=1). The loops then run in Python."""
    if "numba" in sys.modules:
        return bool(sys.modules["numba"].config.DISABLE_JIT)
    return os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
