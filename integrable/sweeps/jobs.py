"""The work of a sweep's worker: it computes the states of one chunk's members. Everything here can be pickled."""

from __future__ import annotations

import dataclasses
from fractions import Fraction
from typing import Any

import numpy as np

from integrable.ensembles.bodies import COLUMNS, computed_singly
from integrable.ensembles.computing import Outcome
from integrable.ensembles.members import Starts
from integrable.motion.trajectory import Motion
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from integrable.sweeps.grid import PARTS

__all__ = ["Scenes", "done"]


class Scenes(Starts[Motion, Any]):
    """Members of a sweep over a scene with a deformation. Each of ``rows`` has the numbers that replace those of the
    scene for one member (:meth:`integrable.sweeps.grid.Grid.rows`).
    """

    _columns, _arrays = COLUMNS, ("rows",)

    def __init__(self, scene: Scene, rows: np.ndarray) -> None:
        self.scene, self.rows = scene, rows

    def _one(self, member: int) -> Motion:
        parts = {name: self.rows[member, place] for name, place in PARTS.items()}
        exact: dict[str, Any] = {name: _exact(x.tolist()) for name, x in parts.items() if not np.isnan(x).any()}
        own = dataclasses.replace(self.scene, **exact)
        system, state = own.start(FLOAT_DIGITS)
        motion: Motion = system.motion_through(state)
        return motion

    def _computed(self, times: np.ndarray, out: np.ndarray, most: int | None = None) -> Outcome:
        return computed_singly(self._one, times, out)


def _exact(numbers: Any) -> Any:
    return tuple(map(Fraction, numbers)) if isinstance(numbers, list) else Fraction(numbers)


def done(many: Starts[Any, Any], times: np.ndarray) -> tuple[np.ndarray, Outcome]:
    """The states of k members at N times, shape (k, N, C) with C numbers a state, and their outcome.

    They are computed on one thread, since other workers compute other chunks at the same time.
    """
    out = np.empty((len(many), len(times), many._columns))
    return out, many._computed(times[None], out, most=1)
