"""Motions by a chosen method instead of the flow's own choice, and starts that are put on the constraints of a system;
only this module knows how.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from integrable.motion.short import ShortRuns
from integrable.mumford.flow import MumfordFlow, Path
from integrable.phase.ways import Cost
from jacobian.errors import PrecisionLoss


class Forced:
    """A flow whose ``at(times)`` uses the given ``way``: "torus" or "additions", as in ``Path.way``, or "tables".
    Raises PrecisionLoss where the motion cannot be computed in this way.
    """

    def __init__(self, flow: MumfordFlow, way: str) -> None:
        self._flow, self._way = flow, way

    def at(self, times: Any) -> Path:
        flow, given = self._flow, np.atleast_1d(np.asarray(times, dtype=np.float64))
        if self._way == "torus":
            if flow._torus is None:
                raise PrecisionLoss("this motion has no torus")
            states = flow._read(flow._torus, given)
        else:
            assert self._way == "additions"
            states = flow._by_additions(given).states
        return Path(given, states.reshape(len(given), -1), self._way)


def forced(flow: MumfordFlow, way: str) -> Forced:
    """The flow, restricted to one method."""
    return Forced(flow, way)


def short_runs(system: Any, state: Any, kernel: str = "auto") -> ShortRuns:
    """The short runs of a body's motion, of as many panels as are accurate, whatever its torus costs."""
    runs = ShortRuns(system, state, kernel)
    runs._cost = Cost(1e9, 0)
    return runs


def has_torus(flow: MumfordFlow) -> bool:
    """Whether a torus is used for far times of a motion in floats."""
    return flow._torus is not None


def made_torus(flow: MumfordFlow) -> Any:
    """A torus of the motion, without the usual check."""
    return flow._made_torus()


def confirmed(flow: MumfordFlow, torus: Any) -> bool:
    """Whether the flow accepts this torus."""
    return flow._confirmed(torus)


def torus_of(flow: Any) -> Any:
    """The torus that a flow of a ball or a top uses for far times, or None."""
    return flow._torus


def precise_of(flow: Any) -> Any:
    """The many-digit motion beside a flow of a ball or a top in floats."""
    return flow._precise


def constrained(system: Any, state: Any, K: Any = None) -> Any:
    """A state with numbers of K, or of the system's field, put on the constraints to all of its digits."""
    return system._constrained(K or system.field, state)


def inside(system: Any, state: Any, K: Any = None) -> Any:
    """A state in the numbers of K, or of the system's field."""
    return system._inside(K or system.field, state)
