"""The switch that turns compilation off, and the warning that compiled code cannot be stored."""

from __future__ import annotations

import os
import warnings
from functools import cache

__all__ = ["NO_PLACE", "REMEDY", "NoCacheWarning", "interpreted", "say_once"]


class NoCacheWarning(UserWarning):
    """The warning that compiled code cannot be cached on disk."""


NO_PLACE = "no folder to keep compiled code in"
REMEDY = "set NUMBA_CACHE_DIR to a folder that can be written to"


@cache
def say_once() -> None:
    """Warns, the first time, that no folder for compiled code is writable."""
    text = f"{NO_PLACE}: every process compiles anew, which takes a minute; {REMEDY}"
    warnings.warn(text, NoCacheWarning, stacklevel=4)


def interpreted() -> bool:
    """Whether NUMBA_DISABLE_JIT=1 switches compilation off, as it does for numba. The loops then run in Python."""
    return os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
