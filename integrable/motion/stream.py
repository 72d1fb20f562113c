"""Writes long runs of equally spaced states to a file, in bounded memory."""

from __future__ import annotations

import os
from shutil import disk_usage

import numpy as np
from numpy.lib import format as npy

from integrable.files.whole import whole_file
from integrable.motion.trajectory import Motion
from jacobian import RR
from jacobian.element import Number
from jacobian.errors import ArgumentError, shown, whole

# number of states that are computed together
CHUNK = 200_000
BYTES_OF_A_STATE = 56


def stream(flow: Motion, path: str | os.PathLike[str], start: Number, end: Number, count: int) -> None:
    """Writes equally spaced states of a motion to a file; see :meth:`integrable.motion.flow.Flow.stream`."""
    if flow.system.field is not RR:
        raise ArgumentError(f"field = {flow.system.field.name}: a stream is of floats; use RR")
    count = whole(count, "count", "give an int, 2 or more", 2)
    first, last = (RR.coerce(x, name) for name, x in (("start", start), ("end", end)))
    with whole_file(path, "the path of a .npy file") as temporary, temporary.open("wb") as file:
        room = disk_usage(temporary.parent).free
        if count * BYTES_OF_A_STATE > room:
            most = f"the disk has room for {room // BYTES_OF_A_STATE} of {BYTES_OF_A_STATE} bytes"
            raise ArgumentError(f"count = {shown(count)}: so many states do not fit, {most}")
        header = {"descr": npy.dtype_to_descr(np.dtype(np.float64)), "fortran_order": False, "shape": (count, 7)}
        npy.write_array_header_1_0(file, header)
        for begin in range(0, count, CHUNK):
            places = np.arange(begin, min(begin + CHUNK, count))
            times = first + places * ((last - first) / (count - 1))
            if places[-1] == count - 1:
                times[-1] = last
            run = flow.at(times)
            file.write(np.column_stack([times, run.gamma, run.M]).tobytes())
