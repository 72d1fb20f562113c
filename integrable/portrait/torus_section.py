"""Poincaré sections of motions in separated coordinates: the crossings of a branch point by one point of the pair.

On the torus of such a motion φ_k = 2πn is a section, and φ_k grows with t. If t_n is the time at which θ_k alone would
have turned n times, the other phases at t_n are rotated by f_j/f_k from one crossing to the next. The crossing itself
is a bounded time away from t_n.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from jacobian.errors import PrecisionLoss, one_of, whole
from jacobian.immutable import Record

if TYPE_CHECKING:
    from integrable.portrait.separated import SeparatedTorus

ENDS = ("lower", "upper")
MOST_CROSSINGS = 10**6
# Newton's steps to a crossing, the last of which is shorter than this angle
MOST_STEPS, LAST = 60, 1e-9


class TorusSection(Record):
    """The crossings of one end of an oval by the point in it. Get one from ``flow.section(count)``.

    ``path`` are the states at the crossings, and ``times`` (N,) their times. ``theta`` (N, g − 1) are the phases of the
    other points, in turns modulo 1, in which the map from one crossing to the next is the rotation by ``rotation`` (g −
    1,).
    """

    def __init__(self, path: Any, theta: Any, rotation: Any) -> None:
        self.path, self.theta, self.rotation = path, theta, rotation

    @property
    def times(self) -> Any:
        """The times of the crossings, shape (N,)."""
        return self.path.times

    def __len__(self) -> int:
        return len(self.theta)

    def __repr__(self) -> str:
        return f"<TorusSection of {len(self)} crossings>"


def crossings(torus: SeparatedTorus, count: int, oval: int, end: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The times of the next ``count`` crossings, the phases of the other points, and their rotation, in floats."""
    count = whole(count, "count", f"the number of crossings is an int from 1 to {MOST_CROSSINGS}", 1, MOST_CROSSINGS)
    genus = len(torus.ovals)
    oval = whole(oval, "oval", f"the number of an oval is an int from 0 to {genus - 1}", 0, genus - 1)
    part = one_of(end, "end", ENDS, 'choose "lower" or "upper"') == "upper"
    nu, place = torus.frequencies[:genus], torus.phases
    around = float(torus.start[oval]) / (2 * math.pi) - part / 2
    ahead = nu[oval] > 0
    first = math.floor(around) + 1 if ahead else math.ceil(around) - 1
    turns = [first + n if ahead else first - n for n in range(count)]
    begin = [(n + torus.one * part / 2 - place[oval]) / nu[oval] for n in turns]
    fractions = [[x - math.floor(x) for x in (p + f * t for p, f in zip(place, nu, strict=True))] for t in begin]
    phases = np.array(fractions, dtype=float)
    phases[:, oval] = part / 2
    late = _delays(torus, phases, oval)
    times = np.array([float(t + torus.one * x) for t, x in zip(begin, late.tolist(), strict=True)])
    others = [k for k in range(genus) if k != oval]
    return times, phases[:, others], np.array([float(nu[k] / nu[oval]) * (1 if ahead else -1) for k in others])


def _delays(torus: SeparatedTorus, phases: np.ndarray, oval: int) -> np.ndarray:
    """The times from these phases until the point is at the end to which its own phase belongs."""
    sums, wanted = torus.in_floats, 2 * np.pi * phases[:, oval]
    nu = np.array([float(f) for f in torus.frequencies[: len(torus.ovals)]])
    rates = 2 * np.pi * nu @ sums.means
    late = np.zeros(len(phases))
    for _ in range(MOST_STEPS):
        angles = sums.at(phases + late[:, None] * nu)
        gaps = angles[:, oval] - wanted
        speeds = np.linalg.solve(sums.slopes(angles), np.broadcast_to(rates, phases.shape)[:, :, None])[:, oval, 0]
        late = late - gaps / speeds
        if np.abs(gaps).max(initial=0) < LAST:
            return late
    raise PrecisionLoss("section: the crossings of this motion were not found in floats")
