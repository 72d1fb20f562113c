"""The file of a run over many primes: its results, and the place from which it resumes."""

from __future__ import annotations

import json
import os
from pathlib import Path
from time import monotonic
from typing import Any
from zipfile import BadZipFile

import numpy as np

from jacobian.arithmetic.residues import Place
from jacobian.curve.curve import HyperellipticCurve
from jacobian.element import File
from jacobian.errors import ArgumentError, names_a_file, shown

EVERY = 5.0
"""Seconds between two saved states."""


def path_of(path: File, argument: str = "path") -> Path:
    """``path`` as a Path; ArgumentError if it does not name a file."""
    if not names_a_file(path):
        raise ArgumentError(f"{argument} = {shown(path)}: give the name of a file")
    return Path(path)


class Saved:
    """The state of a run in an .npz file of NumPy. The file is replaced as a whole, so a run that is killed leaves the
    last saved state.
    """

    def __init__(self, path: File, C: HyperellipticCurve, bound: int, genus: int) -> None:
        self.path, self._genus, self._last = path_of(path, "file"), genus, monotonic()
        self._run = json.dumps({"f": [str(c) for c in C.f], "h": [str(c) for c in C.h], "bound": bound})

    def load(self) -> tuple[Any, Place]:
        """The results, (K, g), and the place to resume from; if there is no file, an empty array and the beginning."""
        if not self.path.exists():
            if not self.path.parent.is_dir():
                raise ArgumentError(f"file = {self.path}: there is no such folder")
            return np.zeros((0, self._genus), np.int64), Place()
        try:
            with np.load(self.path, allow_pickle=False) as kept:
                run, place, found = str(kept["run"]), json.loads(str(kept["place"])), kept["found"]
        except (OSError, ValueError, KeyError, BadZipFile) as error:
            raise ArgumentError(f"file = {self.path}: no state of a run is in it ({error})") from None
        if run != self._run:
            raise ArgumentError(f"file = {self.path}: it is that of another run, {run}; give another file")
        windows = tuple([int(c, 16) for c in window] for window in place["windows"])
        return found, Place(place["done"], place["block"], windows)

    def keep(self, found: list[Any], place: Place) -> None:
        """Writes the state if the last saved one is EVERY seconds old; the arrays in ``found`` are joined into one."""
        if monotonic() - self._last < EVERY:
            return
        found[:] = [np.concatenate(found)]
        windows = [[hex(c) for c in window] for window in place.windows]
        said = json.dumps({"done": place.done, "block": place.block, "windows": windows})
        beside = self.path.with_name(f"{self.path.name}.{os.getpid()}.part")
        try:
            with beside.open("wb") as file:
                np.savez(file, run=np.array(self._run), place=np.array(said), found=found[0])
            os.replace(beside, self.path)
        finally:
            beside.unlink(missing_ok=True)
        self._last = monotonic()
