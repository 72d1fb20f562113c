"""States at far times of motions of genus 3 and more in floats: the phases determine the point in each oval.

The phases are sums of integrals over the ovals (:mod:`integrable.portrait.separated`) up to the points, and grow
linearly in time. Compiled loops find the points (:mod:`integrable.portrait.oval_loops`). A set-up takes some
milliseconds, a time some microseconds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from integrable.mumford.columns import Column
from integrable.portrait.oval_loops import LIBRARY, SERIES, SUMS, PhaseRoom, PhaseSums
from integrable.portrait.separated import SeparatedTorus
from integrable.torus import compiled
from integrable.torus.clock import FarTimes
from integrable.torus.theta_series import float_circle, half_turn, inverse_factorials
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.native.code import LANES
from jacobian.native.library import Packed
from jacobian.numbers.double_double import double_double_row

HalfAngles = list[tuple[Column, Column]]
Row = np.ndarray


class PhaseTorus(FarTimes):
    """A motion in double-doubles: :meth:`at` evaluates the function ``read`` at any times.

    ``torus`` has the periods in long numbers, and a PhaseTorus must be made inside a ``with`` block of their field.
    ``read(points, times)`` is called with rows of double-doubles, shape (rows, N, 2): sin ½φ and cos ½φ of each point,
    then cos and sin of each angle about an axis since the start. :func:`in_pairs` makes pairs of columns of them.
    """

    def __init__(self, torus: SeparatedTorus, read: Callable[[Row, Row], Any]) -> None:
        self._torus, self._read, self._genus, self._width = torus, read, len(torus.ovals), len(torus.forms)
        self.paces = [float(x) for x in torus.frequencies if x]
        turn, inverse = 2 * half_turn(), inverse_factorials()
        matrix = double_double_row(x for row in self._parts(turn) for x in row)
        series = [self._modes(rows, matrix) for rows in torus.samples]
        bounds, begin = list[int](), 0
        for rows in series:
            sizes = np.abs(rows[:, :, 0]).max(axis=1)
            bounds += [begin, *(begin + int(np.flatnonzero(sizes > least).max(initial=-1)) + 1 for least in SERIES)]
            begin = bounds[-1]
        kept = [rows[: bounds[5 * k + 4] - bounds[5 * k]] for k, rows in enumerate(series)]
        waves, n = np.concatenate(kept), np.concatenate([np.arange(1, len(rows) + 1) for rows in kept])
        rough = np.stack((waves[:, :, 0], waves[:, :, 0] * n[:, None]), axis=2)
        places, frequencies = np.zeros((self._width, 2)), double_double_row(torus.frequencies)
        self.sums = PhaseSums(
            waves.reshape(-1, 2), rough.reshape(-1), np.array(bounds), places, frequencies, inverse, float_circle()
        )
        self._packed = Packed(self.sums, SUMS)
        self._put_places(turn)

    def _parts(self, turn: Real) -> list[list[Real]]:
        """For each form its parts in the sums of :class:`integrable.portrait.oval_loops.PhaseSums`: first in the sums
        that grow by 2π with the angle of an oval, then in the angles about an axis, from which what is linear in the
        phases is subtracted.
        """
        zero, genus, means = turn * 0, self._genus, self._torus.means
        unit = [[zero + (i == j) for j in range(self._width)] for i in range(self._width)]
        found = [[turn * x for x in self._torus.phase_of(row)] for row in unit[:genus]]
        further = range(genus, self._width)
        return [
            *([*row, *(-sum(x * m[j] for x, m in zip(row, means, strict=True)) for j in further)] for row in found),
            *unit[genus:],
        ]

    def _modes(self, rows: Sequence[Sequence[Real]], matrix: Row) -> Row:
        """The series of one oval, shape (modes, sums, 2)."""
        nodes, samples = len(rows[0]), np.array([(h, float(x - h)) for row in rows for x in row for h in (float(x),)])
        room, found = np.empty((2, (nodes - 1) * self._width, 2))
        LIBRARY.put_modes(samples, nodes, matrix, inverse_factorials(), room, found)
        return found.reshape(nodes - 1, self._width, 2)

    def _put_places(self, turn: Real) -> None:
        """Writes the phases at the start, in turns."""
        room, torus = self._room(), self._torus
        halves = double_double_row(x for s, c in torus.halves for x in (c, s))
        angles = double_double_row(torus.start)
        room.halves[:], room.totals[: len(angles)] = np.repeat(halves, LANES, 1), np.repeat(angles, LANES, 1)
        room.angles[:] = angles[:, :1]
        LIBRARY.add_swings(self._packed, room)
        starts, totals = in_pairs(halves.reshape(-1, 2, 1, 2)[:, ::-1].reshape(-1, 1, 2)), room.totals[:, ::LANES]
        for j, total in enumerate(totals.tolist()):
            place = Column(*total) if j < self._genus else -(Column(*total) + self._of_poles(j, starts))
            found = place / Column.of(turn)
            self.sums.places[j] = np.ravel(found.hi)[0], np.ravel(found.lo)[0]

    def _room(self) -> PhaseRoom:
        genus, width = self._genus, self._width
        floats = width, genus, width, genus * width, genus, genus * genus, genus
        rows = [*(np.zeros((n, 2 * LANES)) for n in (width, 2 * genus, width)), *(np.zeros((n, LANES)) for n in floats)]
        return PhaseRoom._make([*rows, np.zeros(LANES)])

    def at(self, times: np.ndarray) -> Any:
        """The values of the function ``read`` (:class:`PhaseTorus`) at N times."""
        points = self.points(times)
        return self._read(points, times)

    def points(self, times: np.ndarray) -> Row:
        """The rows with which ``read`` (:class:`PhaseTorus`) is called."""
        genus, count = self._genus, len(times)
        found = np.empty((genus + self._width, count, 2))
        converged = LIBRARY.points_at_times(self._packed, times, self._room(), found.reshape(-1, 2))
        if not (converged and np.isfinite(found).all()):
            raise PrecisionLoss("the angles of the points at these times were not found in floats")
        if self._width == genus:
            return found
        turned = []
        for j in range(genus, self._width):
            angle = Column(*found[genus + j].T) + self._of_poles(j, in_pairs(found[: 2 * genus]))
            sine, cosine = circles(angle.hi)
            turned += [cosine - sine * Column(angle.lo), sine + cosine * Column(angle.lo)]
        return np.concatenate([found[: 2 * genus], [np.stack((x.hi, x.lo), axis=1) for x in turned]])

    def _of_poles(self, j: int, halves: HalfAngles) -> Column:
        """The terms of the sum of form j that come from poles of the form."""
        total = Column(0.0)
        for k, (s, c) in enumerate(halves):
            for pole in self._torus.poles[k][j]:
                ratio = Column.of(pole.ratio)
                x, y = c * c + ratio * s * s, (ratio - Column(1.0)) * s * c
                rough = np.arctan2(y.hi, x.hi)
                sine, cosine = circles(rough)
                beyond = (y * cosine - x * sine) / (x * x + y * y).sqrt()
                total = total + Column.of(pole.mean) * 2 * (Column(rough) + beyond)
        return total


def in_pairs(points: Row) -> HalfAngles:
    """The pairs of successive rows (N, 2), each row as a column of double-doubles."""
    rows = [Column(*np.ascontiguousarray(row.T)) for row in points]
    return list(zip(rows[::2], rows[1::2], strict=True))


def circles(angles: np.ndarray) -> tuple[Column, Column]:
    """sin and cos in double-doubles."""
    given, out = np.ascontiguousarray(angles, dtype=np.float64), np.empty((2, len(angles), 2))
    compiled.LIBRARY.circle_points(given, inverse_factorials(), out[0], out[1])
    cosines, sines = (Column(*np.ascontiguousarray(part.T)) for part in out)
    return sines, cosines
