"""States at far times of motions of genus 3 and more in floats: the phases determine the point in each oval.

The phases are sums of integrals over the ovals (:mod:`integrable.portrait.separated`) up to the points, and grow
linearly in time. Newton's method finds the points in floats, and one more step, with the sums in double-doubles,
doubles the digits. A set-up takes some tens of milliseconds, a time some tens of microseconds per oval.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from integrable.mumford.columns import Column, Columns
from integrable.portrait.separated import SeparatedTorus
from integrable.torus import compiled
from integrable.torus.clock import FarTimes
from integrable.torus.theta_series import circle, inverse_factorials
from jacobian.element import Real
from jacobian.native.kinds import FLOATS, INTS, WIDES, record
from jacobian.native.library import Library, Packed
from jacobian.native.special import SPECIAL
from jacobian.numbers.abreast import abreast
from jacobian.numbers.double_double import double_double_row

# high modes below NEGLIGIBLE times the largest mode are omitted
NEGLIGIBLE = 1e-34
HalfAngles = list[tuple[Column, Column]]
Row = np.ndarray


class FormSums(NamedTuple):
    """The means and the sine series of forms on ovals: ``means`` for each oval and form. ``waves`` has a row of all
    forms for each mode, in descending order, from row ``begins``[k] to ``begins``[k + 1] for oval k. ``inverse`` is
    :func:`integrable.torus.theta_series.inverse_factorials`.
    """

    means: Row
    waves: Row
    begins: Row
    inverse: Row


def put_sums(forms: FormSums, angles: Row, rest: Row, sines: Row, cosines: Row, sums: Row) -> None:
    """Adds to ``sums``, for each form, its integrals up to the ``angles`` φ of the points, minus the parts that are
    linear in the phases. Also writes sin ½φ and cos ½φ. This source is compiled unchanged.

    The N angles of one oval are adjacent, as are the phases ``rest`` in turns and the N sums of one form.
    """
    genus, turn = len(forms.begins) - 1, forms.inverse[0]
    count, width = len(angles) // genus, len(forms.means) // genus
    for k in range(genus):
        for i in abreast(0, count):
            place = k * count + i
            c, s = circle(angles[place] / (2 * turn), forms.inverse)
            sines[place], cosines[place] = s, c
            twice, sine, linear = 2 * (c * c - s * s), 2 * s * c, angles[place] - turn * rest[place]
            for j in range(width):
                last, now = 0 * c, 0 * c
                # Clenshaw's recurrence
                for n in range(forms.begins[k], forms.begins[k + 1]):
                    last, now = now, forms.waves[n * width + j] + twice * now - last
                sums[j * count + i] += forms.means[k * width + j] * linear + sine * now


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
        waves = [*map(_waves, torus.waves)]
        rows = [double_double_row(row) for rows in (torus.means, *waves) for row in rows]
        begins, self._width = np.cumsum([0, *map(len, waves)]), len(torus.forms)
        means, series = (np.concatenate(x) for x in (rows[: self._genus], rows[self._genus :]))
        self._sums = Packed(FormSums(means, series, begins, inverse_factorials()), FORM_SUMS)
        self._begin = [*map(Column.of, torus.swings_at_start)]

    def at(self, times: np.ndarray) -> Any:
        """The values of the function ``read`` (:class:`PhaseTorus`) at N times."""
        phases = [Column(times) * nu for nu in self._frequencies]
        phases[: self._genus] = [x + place for x, place in zip(phases, self._places, strict=False)]
        whole = [np.rint(x.hi) for x in phases]
        rest = [x - Column(n) for x, n in zip(phases, whole, strict=True)]
        angles = self._floats.at(np.stack([x.hi for x in rest[: self._genus]], axis=1))
        halves, sums = self._summed(angles, rest)
        late = np.linalg.solve(self._floats.sums(angles)[1], sums.hi[: self._genus].T[:, :, None])[:, :, 0].T
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

    def _summed(self, angles: np.ndarray, rest: Sequence[Column]) -> tuple[HalfAngles, Column]:
        """(sin ½φ, cos ½φ) of each point, and the sums of :func:`put_sums`, shape (forms, N)."""
        count = len(angles)
        turns = np.concatenate([np.stack((x.hi, x.lo), axis=1) for x in rest[: self._genus]])
        halves, sums = np.empty((2, self._genus * count, 2)), np.zeros((self._width * count, 2))
        LIBRARY.put_sums(self._sums, np.ascontiguousarray(angles.T).reshape(-1), turns, *halves, sums)
        sines, cosines = (np.ascontiguousarray(part.T).reshape(2, self._genus, count) for part in halves)
        found = [
            (Column(*x), Column(*y)) for x, y in zip(*(p.transpose(1, 0, 2) for p in (sines, cosines)), strict=True)
        ]
        return found, Column(*np.ascontiguousarray(sums.T).reshape(2, self._width, count))

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
        """The first-order change of the sum of form j, without the terms of :meth:`_of_poles`, if the angles
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


def _waves(rows: Sequence[Sequence[Real]]) -> list[list[Real]]:
    """The Fourier modes of all forms on one oval in descending order, without the negligible high ones."""
    sizes = np.abs(np.array([[float(x) for x in row] for row in rows]))
    kept = np.flatnonzero((sizes > NEGLIGIBLE * sizes.max(initial=0)).any(axis=0))
    return [[row[n] for row in rows] for n in range(int(kept.max(initial=0)), -1, -1)]


def circles(angles: np.ndarray) -> tuple[Column, Column]:
    """sin and cos in double-doubles."""
    given, out = np.ascontiguousarray(angles, dtype=np.float64), np.empty((2, len(angles), 2))
    compiled.LIBRARY.circle_points(given, inverse_factorials(), out[0], out[1])
    cosines, sines = (Column(*np.ascontiguousarray(part.T)) for part in out)
    return sines, cosines


FORM_SUMS = record(FormSums, WIDES, WIDES, INTS, WIDES)
LIBRARY = Library("phases", {"put_sums": (put_sums, (FORM_SUMS, FLOATS, *(WIDES,) * 4))}, SPECIAL)
