"""A motion by a chosen method, whichever its flow would use: the only place that knows how to force one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from integrable.mumford.flow import MumfordFlow, Path
from integrable.series import near
from jacobian.errors import PrecisionLoss


class Forced:
    """``at(times)`` of a flow by a ``way`` of its own: "torus" or "additions", as ``Path.way`` says, or "tables".
    PrecisionLoss where the motion has no such way.
    """

    def __init__(self, flow: MumfordFlow, way: str) -> None:
        self._flow, self._way = flow, way

    def at(self, times: Any) -> Path:
        flow, given = self._flow, np.atleast_1d(np.asarray(times, dtype=np.float64))
        if self._way == "torus":
            if flow._torus is None:
                raise PrecisionLoss("this motion has no torus")
            return flow._path(flow._torus, given)
        if self._way == "tables":
            if flow._tabled is None:
                raise PrecisionLoss("this motion has no tables")
            return Path(given, *flow._tabled.at(given))
        assert self._way == "additions"
        rows = [flow._row(place) for place in flow._places(given.tolist())]
        q, p = (np.array([[float(x) for x in row[i]] for row in rows]) for i in (0, 1))
        return Path(given, q, p)


def forced(flow: MumfordFlow, way: str) -> Forced:
    """The flow, restricted to one method."""
    return Forced(flow, way)


def has_torus(flow: MumfordFlow) -> bool:
    """Whether far times of a motion in floats are read off a torus."""
    return flow._torus is not None


def made_torus(flow: MumfordFlow) -> Any:
    """A torus of the motion that has not been checked."""
    return flow._made_torus()


def confirmed(flow: MumfordFlow, torus: Any) -> bool:
    """Whether the flow accepts this torus."""
    return flow._confirmed(torus)


def walks(monkeypatch: pytest.MonkeyPatch, way: str) -> None:
    """States near the start by the "compiled" walk of each kind of system, made if need be, or by its "tape"."""

    def walk(system: Any, steps: Any) -> Any:
        kind = system._kind if way == "compiled" else None
        return None if kind is None else kind.walk(steps.orders, compiles=True)

    monkeypatch.setattr(near, "compiled_walk", walk)
