"""States at far times of motions of genus 3 and more in floats: the phases determine the point in each oval.

The phases are sums of integrals over the ovals (:mod:`integrable.portrait.separated`) up to the points, and grow
linearly in time. Newton's method finds the points in floats, and one more step, with the sums in double-doubles,
doubles the digits. A set-up takes some tens of milliseconds, a time some tens of microseconds per oval.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from integrable.mumford.columns import Column, Columns
from integrable.portrait.separated import SeparatedTorus
from integrable.torus.clock import FarTimes
from integrable.torus.compiled import LIBRARY
from integrable.torus.theta_series import inverse_factorials
from jacobian.element import Real
from jacobian.numbers.double_double import double_double_row

# high modes below NEGLIGIBLE times the largest mode are omitted
NEGLIGIBLE = 1e-34
HalfAngles = list[tuple[Column, Column]]


class PhaseTorus(FarTimes):
    """A motion in double-doubles: :meth:`at` evaluates the function ``read`` at any times.

    ``torus`` has the periods in long numbers, and a PhaseTorus must be made inside a ``with`` block of their field.
    ``read(halves, turned)`` is called with (sin ½φ, cos ½φ) of each point and (cos, sin) of each angle about an axis
    since the start, as columns.
    """

    def __init__(self, torus: SeparatedTorus, read: Callable[[HalfAngles, HalfAngles], Any]) -> None:
        self._torus, self._read, self._floats = torus, read, torus.in_floats
        self._genus, self._round = len(torus.ovals), Column(*inverse_factorials()[0])
        self._frequencies, self._places = [*map(Column.of, torus.frequencies)], [*map(Column.of, torus.phases)]
        self.paces = [float(x) for x in torus.frequencies if x]
        self._means, self._waves = [*map(_columns, torus.means)], [*map(_waves, torus.waves)]
        self._begin = [*map(Column.of, torus.swings_at_start)]

    def at(self, times: np.ndarray) -> Any:
        """The values of the function ``read`` (:class:`PhaseTorus`) at N times."""
        phases = [Column(times) * nu for nu in self._frequencies]
        phases[: self._genus] = [x + place for x, place in zip(phases, self._places, strict=False)]
        whole = [np.rint(x.hi) for x in phases]
        rest = [x - Column(n) for x, n in zip(phases, whole, strict=True)]
        angles = self._floats.at(np.stack([x.hi for x in rest[: self._genus]], axis=1))
        halves = [circles(phi / 2) for phi in angles.T]
        sums = self._sums(angles, halves, rest)
        late = np.linalg.solve(self._floats.slopes(angles), sums.hi[: self._genus].T[:, :, None])[:, :, 0].T
        moved = []
        for (s, c), x in zip(halves, late / 2, strict=True):
            near = Column(1.0) - Column(x) * Column(x) / 2
            moved.append((s * near - c * Column(x), c * near + s * Column(x)))
        turned = []
        for j in range(self._genus, len(phases)):
            angle = self._round * rest[j] + Column(sums.hi[j], sums.lo[j]) - self._begin[j - self._genus]
            angle = angle + self._of_poles(j, moved) - Column(self._moved(j, angles, late))
            sine, cosine = circles(angle.hi)
            turned.append((cosine - sine * Column(angle.lo), sine + cosine * Column(angle.lo)))
        signs = [Column(1 - 2 * (n % 2)) for n in whole]
        return self._read([(sign * s, sign * c) for sign, (s, c) in zip(signs, moved, strict=False)], turned)

    def _sums(self, angles: np.ndarray, halves: HalfAngles, rest: Sequence[Column]) -> Column:
        """For each form, the sum over the points of its integrals up to the ``angles``, minus the part that is linear
        in the phases: shape (forms, N).
        """
        total = Column(0.0)
        for phi, (s, c), x, mean, waves in zip(angles.T, halves, rest, self._means, self._waves, strict=False):
            twice, sine = 2 * (c * c - s * s), 2 * s * c
            last, now = Column(0.0), Column(0.0)
            # Clenshaw's recurrence, for all forms at once
            for row in waves:
                last, now = now, row + twice * now - last
            total = total + mean * (Column(phi) - self._round * x) + sine * now
        return total

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

    def _moved(self, j: int, angles: np.ndarray, late: np.ndarray) -> np.ndarray:
        """The first-order change of :meth:`_sums` for form j, without the terms of :meth:`_of_poles`, if the angles
        change by ``late``.
        """
        K, found = Columns(), np.zeros(len(angles))
        form = self._torus.forms[j]
        for k, (phi, move) in enumerate(zip(angles.T, late, strict=True)):
            oval = self._torus.ovals[k].over(K)
            x = oval.middle - oval.radius * Column(np.cos(phi))
            slope = form.coefficient(K, x) * oval.weight(K, x)
            for pole in self._torus.poles[k][j]:
                # the term in _of_poles has the derivative residue/(x − place) − mean
                slope = slope - Column.of(pole.residue) / (x - Column.of(pole.place)) + Column.of(pole.mean)
            found += move * slope.hi
        return found


def _columns(values: Sequence[Real]) -> Column:
    """Long numbers as one column, shape (n, 1)."""
    high, low = double_double_row(values).T
    return Column(high[:, None], low[:, None])


def _waves(rows: Sequence[Sequence[Real]]) -> list[Column]:
    """The Fourier modes of all forms on one oval in descending order, without the negligible high ones."""
    sizes = np.abs(np.array([[float(x) for x in row] for row in rows]))
    kept = np.flatnonzero((sizes > NEGLIGIBLE * sizes.max(initial=0)).any(axis=0))
    return [_columns([row[n] for row in rows]) for n in range(int(kept.max(initial=0)), -1, -1)]


def circles(angles: np.ndarray) -> tuple[Column, Column]:
    """sin and cos in double-doubles."""
    given, out = np.ascontiguousarray(angles, dtype=np.float64), np.empty((2, len(angles), 2))
    LIBRARY.circle_points(given, inverse_factorials(), out[0], out[1])
    cosines, sines = (Column(*np.ascontiguousarray(part.T)) for part in out)
    return sines, cosines
