"""The angles of points in their ovals at many given phases, in floats, by :mod:`integrable.portrait.oval_loops`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from integrable.portrait.oval_loops import LIBRARY, SERIES, PhaseRoom, PhaseSums, angles_at_phases
from integrable.torus.theta_series import float_circle, inverse_factorials
from jacobian.errors import PrecisionLoss
from jacobian.native.code import LANES
from jacobian.numbers.compiler import interpreted

Array = np.ndarray


class OvalAngles:
    """The sums of :mod:`integrable.portrait.oval_loops` in floats, as functions of g angles φ.

    ``series`` are the S_k, of the shapes (n, sums): the coefficients of sin φ_k, sin 2φ_k, … in the g sums that grow by
    2π with their angles, then in any further sums.
    """

    def __init__(self, series: Sequence[Array]) -> None:
        self._series = series

    def at(self, phases: Array) -> tuple[Array, Array]:
        """The angles φ, (N, g), at phases in turns, (N, g), and the series of the further sums there, (N, m)."""
        genus, (count, width) = len(self._series), (len(phases), self._series[0].shape[1])
        turns, room = np.rint(phases), room_for(genus, width)
        sums = phase_sums([np.stack((row, 0 * row), axis=2) for row in self._series])
        given, found = (phases - turns).T.ravel(), np.empty(width * count)
        if interpreted():
            sums, out = PhaseSums._make(row.tolist() for row in sums), found.tolist()
            converged, found = angles_at_phases(sums, given.tolist(), room, out), np.array(out)
        else:
            converged = LIBRARY.angles_at_phases(sums, given, room, found)
        if not (converged and np.isfinite(found).all()):
            raise PrecisionLoss("the angles of the points at these phases were not found in floats")
        rows = found.reshape(width, count).T
        return rows[:, :genus] + 2 * np.pi * turns, rows[:, genus:]

    def delays(self, phases: Array, oval: int, frequencies: Array) -> Array:
        """The times, shape (N,), that the motion takes from ``phases`` until the point in one ``oval`` is at the angle
        φ = 2π·phases[:, oval], a multiple of π.

        Combinations of the sums that are constant in time determine the angles of the other points. The sum of this
        oval then gives the time.
        """
        others = [k for k in range(len(self._series)) if k != oval]
        if not others:
            return np.zeros(len(phases))
        share = frequencies[others] / frequencies[oval]
        rest = [np.hstack((row[:, others] - row[:, [oval]] * share, row[:, [oval]])) for row in self._series]
        late: Array = OvalAngles([rest[k] for k in others]).at(phases[:, others])[1][:, 0]
        return late / (2 * np.pi * frequencies[oval])

    def phases_at(self, angles: Array) -> Array:
        """The phases in turns, (N, g), at angles φ, (N, g)."""
        total = angles.copy()
        for phi, series in zip(angles.T[:, :, None], self._series, strict=True):
            # Clenshaw's recurrence for a sine series
            last, now = 0.0 * total, 0.0 * total
            for row in series[::-1]:
                last, now = now, row + 2 * np.cos(phi) * now - last
            total += np.sin(phi) * now
        return total / (2 * np.pi)


def phase_sums(series: Sequence[Array]) -> PhaseSums:
    """The PhaseSums with these series of double-doubles, of the shapes (n, sums, 2). Places and frequencies are 0."""
    kept, bounds, begin = list[Array](), list[int](), 0
    for rows in series:
        sizes = np.abs(rows[:, :, 0]).max(axis=1, initial=0)
        ends = [int(np.flatnonzero(sizes > least).max(initial=-1)) + 1 for least in SERIES]
        bounds += [begin, *(begin + end for end in ends)]
        kept.append(rows[: ends[-1]])
        begin = bounds[-1]
    waves, n = np.concatenate(kept), np.concatenate([np.arange(1, len(rows) + 1) for rows in kept])
    rough = np.stack((waves[:, :, 0], waves[:, :, 0] * n[:, None]), axis=2).ravel()
    places = np.zeros((waves.shape[1], 2))
    circles = inverse_factorials(), float_circle()
    return PhaseSums(waves.reshape(-1, 2), rough, np.array(bounds), places, places.copy(), *circles)


def room_for(genus: int, width: int) -> PhaseRoom:
    """The memory for eight times, or for one float if loops are interpreted."""
    wide, floats = (width, 2 * genus, width), (width, genus, width, genus * width, genus, genus * genus, genus)
    if interpreted():
        return PhaseRoom._make([0.0] * n for n in (*wide, *floats, 1))
    rows = [*(np.zeros((n, 2 * LANES)) for n in wide), *(np.zeros((n, LANES)) for n in floats)]
    return PhaseRoom._make([*rows, np.zeros(LANES)])
