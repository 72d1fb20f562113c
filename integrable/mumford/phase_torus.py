"""Far times of motions of genus 3 and more in floats: each point of the pair is found in its oval at the phases.

The sums of :mod:`integrable.portrait.separated` are inverted in floats. One more step, with the sums in double-doubles,
doubles the digits. A set-up takes some tens of milliseconds, a time some tens of microseconds for each oval.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from integrable.moving_point.arithmetic import MOST_TURNS
from integrable.mumford.columns import Column
from integrable.mumford.elliptic_torus import half_turn, long_numbers
from integrable.portrait.separated import SeparatedTorus
from integrable.torus.witness import witnesses
from jacobian.numbers.double_double import split
from jacobian.relatives.extended import Extended

# parts of a half turn in the table of a circle; order of the power series between its points
PARTS, ORDER = 32, 17
# bits of the table; modes below this fraction of the largest are not needed
BITS, NEGLIGIBLE = 160, 1e-34


class PhaseTorus:
    """D of a motion in double-doubles, at any times.

    ``torus`` has the periods in long numbers of an entered field, ``pairs(halves)`` returns D from (sin ½φ, cos ½φ) of
    each point as columns.
    """

    def __init__(self, torus: SeparatedTorus, pairs: Callable[[Any], Extended]) -> None:
        self._pairs, self._floats = pairs, torus.in_floats
        genus = len(torus.ovals)
        self._frequencies = [Column.of(x) for x in torus.frequencies[:genus]]
        self._places = [Column.of(x) for x in torus.phases]
        self._paces = [float(x) for x in torus.frequencies[:genus]]
        self._means = [_columns(row[:genus]) for row in torus.means]
        self._waves = [_waves(rows[:genus]) for rows in torus.waves]

    @property
    def witnesses(self) -> np.ndarray:
        """Times more than one period away, for each phase and in both directions."""
        return witnesses(self._paces)

    def reaches(self, times: np.ndarray) -> bool:
        """Whether double-doubles resolve the fraction of a turn at all of these times."""
        return float(np.abs(times).max(initial=0)) * max(map(abs, self._paces)) <= MOST_TURNS

    def at(self, times: np.ndarray) -> Extended:
        """The pairs with their data at N times, as columns of N numbers."""
        phases = [Column(times) * nu + place for nu, place in zip(self._frequencies, self._places, strict=True)]
        whole = [np.rint(x.hi) for x in phases]
        rest = [x - Column(n) for x, n in zip(phases, whole, strict=True)]
        angles = self._floats.at(np.stack([x.hi for x in rest], axis=1))
        halves = [circles(phi / 2) for phi in angles.T]
        gaps = self._gaps(angles, halves, rest)
        late = np.linalg.solve(self._floats.slopes(angles), gaps[:, :, None])[:, :, 0].T / 2
        turned = []
        for (s, c), x, n in zip(halves, late, whole, strict=True):
            sign, near = Column(1 - 2 * (n % 2)), Column(1.0) - Column(x) * Column(x) / 2
            turned.append((sign * (s * near - c * Column(x)), sign * (c * near + s * Column(x))))
        return self._pairs(turned)

    def _gaps(self, angles: np.ndarray, halves: Sequence[tuple[Column, Column]], rest: Sequence[Column]) -> np.ndarray:
        """By how much the sums at these angles exceed those at the phases, (N, g)."""
        total, round_ = Column(0.0), 2 * circle_table()[2]
        for phi, (s, c), x, mean, waves in zip(angles.T, halves, rest, self._means, self._waves, strict=True):
            twice, sine = 2 * (c * c - s * s), 2 * s * c
            last, now = Column(0.0), Column(0.0)
            # Clenshaw's recurrence, for all forms at once
            for row in waves:
                last, now = now, row + twice * now - last
            total = total + mean * (Column(phi) - round_ * x) + sine * now
        return np.asarray(total.hi).T


def _columns(values: Sequence[Any]) -> Column:
    """Long numbers as one column, (n, 1)."""
    high, low = np.array([split(x) for x in values]).T
    return Column(high[:, None], low[:, None])


def _waves(rows: Sequence[Sequence[Any]]) -> list[Column]:
    """The modes of all forms on one oval, the highest first, those omitted that are negligible."""
    sizes = np.abs(np.array([[float(x) for x in row] for row in rows]))
    kept = np.flatnonzero((sizes > NEGLIGIBLE * sizes.max(initial=0)).any(axis=0))
    return [_columns([row[n] for row in rows]) for n in range(int(kept.max(initial=0)), -1, -1)]


@cache
def circle_table() -> tuple[Column, Column, Column]:
    """cos and sin of multiples of π/PARTS, and π."""
    import gmpy2

    with long_numbers(BITS):
        turns = [half_turn() * k / PARTS for k in range(2 * PARTS)]
        cosines, sines = (np.array([split(f(x)) for x in turns]).T for f in (gmpy2.cos, gmpy2.sin))
        return Column(*cosines), Column(*sines), Column.of(half_turn())


def circles(angles: np.ndarray) -> tuple[Column, Column]:
    """(sin, cos) of angles in floats, in double-doubles."""
    cosines, sines, half = circle_table()
    part = np.rint(angles * (PARTS / np.pi))
    rest = Column(angles) - half * Column(part / PARTS)
    square, c, s = rest * rest, Column(1.0), Column(1.0)
    for n in range(ORDER, 1, -2):
        c, s = 1 - square * c / ((n - 1) * (n - 2)), 1 - square * s / (n * (n - 1))
    s = s * rest
    place = part.astype(int) % (2 * PARTS)
    a, b = (Column(x.hi[place], x.lo[place]) for x in (cosines, sines))
    return b * c + a * s, a * c - b * s
