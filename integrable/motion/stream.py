"""Long runs to a file: equally spaced states in bounded memory."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy

from integrable.motion.trajectory import Motion
from jacobian import RR
from jacobian.errors import ArgumentError, shown, whole

# states computed at a time
CHUNK = 200_000


def _is_a_name(path: Any) -> bool:
    """Whether the file system can hold such a name: no lone surrogates, no NUL."""
    try:
        return b"\0" not in os.fsencode(path)
    except UnicodeEncodeError:
        return False


def stream(flow: Motion, path: str | os.PathLike[str], start: Any, end: Any, count: int) -> None:
    """What :meth:`integrable.motion.flow.Flow.stream` does."""
    if flow.system.field != RR:
        raise ArgumentError(f"field = {flow.system.field.name}: a stream is of floats; use RR")
    count = whole(count, "count", "give an int, 2 or more", 2)
    first, last = (RR.coerce(x, name) for name, x in (("start", start), ("end", end)))
    if not isinstance(path, (str, os.PathLike)):
        raise ArgumentError(f"path = {shown(path)}: give the path of a .npy file")
    target = Path(path)
    if not _is_a_name(path) or target.is_dir():
        raise ArgumentError(f"path = {shown(path)}: give the path of a .npy file")
    if not target.parent.is_dir():
        raise ArgumentError(
            f"path = {str(path)!r}: give a file in a folder that exists; {str(target.parent)!r} does not"
        )
    handle, name = tempfile.mkstemp(dir=target.parent or ".", prefix=target.name, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            header = {"descr": npy.dtype_to_descr(np.dtype(np.float64)), "fortran_order": False, "shape": (count, 7)}
            npy.write_array_header_1_0(file, header)
            for begin in range(0, count, CHUNK):
                places = np.arange(begin, min(begin + CHUNK, count))
                times = first + places * ((last - first) / (count - 1))
                if places[-1] == count - 1:
                    times[-1] = last
                run = flow.at(times)
                file.write(np.column_stack([times, run.gamma, run.M]).tobytes())
        Path(name).replace(target)
    except BaseException:
        Path(name).unlink()
        raise
