"""Poincaré sections of motions in separated coordinates: the crossings of a branch point by one point of the pair.

On the torus of such a motion φ_k = 2πn is a section. Let t_n be the time at which the phase θ_k, which is linear in
time, completes n turns. From t_n to t_{n+1} the other phases θ_j advance by f_j/f_k. The crossing itself is a bounded
time away from t_n. Time is τ where the sums of forms grow with τ.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from integrable.portrait.oval_angles import OvalAngles
from jacobian.element import Real
from jacobian.errors import one_of, whole
from jacobian.immutable import Record

if TYPE_CHECKING:
    from integrable.portrait.separated import SeparatedTorus

ENDS = ("lower", "upper")
MOST_CROSSINGS = 10**6
# a start within this fraction of a turn from a crossing counts as on it
ON = 1e-12


class TorusSection(Record):
    """The crossings of one end of an oval by the point in it. Get one from ``flow.section(count)``.

    ``path`` are the states at the crossings, and ``times`` (N,) their times. ``theta`` (N, g − 1) are the phases of the
    other points, in turns modulo 1, in which the map from one crossing to the next is the rotation by ``rotation`` (g −
    1,).
    """

    def __init__(self, path: Any, theta: np.ndarray, rotation: np.ndarray) -> None:
        self.path, self.theta, self.rotation = path, theta, rotation

    @property
    def times(self) -> np.ndarray:
        """The times of the crossings, shape (N,)."""
        found: np.ndarray = self.path.times
        return found

    def __len__(self) -> int:
        return len(self.theta)

    def __repr__(self) -> str:
        return f"<TorusSection of {len(self)} crossings>"


class Turning(NamedTuple):
    """The data of crossings. The ``frequencies`` of the points and their ``phases`` at the start are long numbers, in
    turns. ``start`` are the angles of the points at the start, and ``sums`` the sums of forms over the points, which
    grow at the ``rates``; these three are in floats.
    """

    frequencies: Sequence[Real]
    phases: Sequence[Real]
    start: np.ndarray
    sums: OvalAngles
    rates: np.ndarray

    def crossings(self, count: int, oval: int, end: float) -> tuple[list[Real], np.ndarray, np.ndarray]:
        """The next ``count`` crossings: the times at which the point of an oval has made n + ``end`` turns (``end`` 0
        or ½), the phases (N, g − 1) of the other points there, and their change per crossing.
        """
        count = whole(
            count, "count", f"the number of crossings is an int from 1 to {MOST_CROSSINGS}", 1, MOST_CROSSINGS
        )
        nu, place = self.frequencies, self.phases
        around = float(self.start[oval]) / (2 * math.pi) - end
        ahead = nu[oval] > 0
        first = math.floor(around + ON) + 1 if ahead else math.ceil(around - ON) - 1
        turns = [first + n if ahead else first - n for n in range(count)]
        begin = [(n + end - place[oval]) / nu[oval] for n in turns]
        fractions = [[x - math.floor(x) for x in (p + f * t for p, f in zip(place, nu, strict=True))] for t in begin]
        phases = np.array(fractions, dtype=float)
        phases[:, oval] = end
        late = self.sums.delays(phases, oval, self.rates)
        others = [k for k in range(len(nu)) if k != oval]
        rotation = np.array([float(nu[k] / nu[oval]) * (1 if ahead else -1) for k in others])
        return [t + x for t, x in zip(begin, late.tolist(), strict=True)], phases[:, others], rotation


def crossings(torus: SeparatedTorus, count: int, oval: int, end: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The times of the next ``count`` crossings, the phases of the other points, and their rotation, in floats."""
    genus = len(torus.ovals)
    oval = whole(oval, "oval", f"the number of an oval is an int from 0 to {genus - 1}", 0, genus - 1)
    turns = 0.5 if one_of(end, "end", ENDS, 'choose "lower" or "upper"') == "upper" else 0.0
    start, rates = (np.array(x, dtype=float) for x in (torus.start, torus.separation.rates))
    motion = Turning(torus.frequencies[:genus], torus.phases, start, torus.in_floats, rates)
    times, theta, rotation = motion.crossings(count, oval, turns)
    return np.array(times, dtype=float), theta, rotation
