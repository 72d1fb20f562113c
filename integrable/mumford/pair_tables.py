"""Motions of genus 3 and more in floats at many times: compiled sums of tabled translations, in double-doubles.

D(τ) = D(a + r) + ΣT(w_k + c). Here D(a + r) is a power series in a small r, and w_k is an entry of table k, whose step
is 16 times that of the previous table. The offsets c keep translations away from 0, where they have points near
infinity. Among several neighbouring w the one with the smallest coefficients is chosen; it loses the fewest digits. The
units of x and y place the branch points around 0. Tables are computed in long numbers. There are several starts a; from
different ones the same time uses different rows of the tables.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from math import comb
from typing import Any

import numpy as np

from integrable.mumford import pair_sums
from integrable.mumford.columns import Column
from integrable.mumford.motion import OF_GENUS, Placed, Start
from integrable.mumford.pair_sums import Space, TabledCurve
from integrable.mumford.series import MotionSeries, radius_of
from integrable.mumford.translations import GroupTranslations
from jacobian import poly
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.native.kinds import FLOAT, FLOATS, INT, WIDE, WIDES, ArrayKind, record
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL
from jacobian.numbers.double_double import pack
from jacobian.relatives.extended import Extended, ExtendedGroup, Lift

# RATIO: steps of a table per step of the next. A row is placed at one of the first QUARTERS quarters of a step: at the
# first one with coefficients below SMALL, or else at the one with the smallest coefficients
RATIO, QUARTERS, SMALL = 16, 3, 4.0
# the step of the first table is 2^−FRACTION of the radius of the power series, or a little less
TERMS, FRACTION = 32, 3
# smallest and largest number of tables; number of starts
FEWEST, MOST, STARTS = 2, 11, 10
# bits in which tables are computed, beyond those for the genus; additional bits per table
BITS, OF_TABLE = 192, 24

_TABLE, _PLACES, _MATRIX = ArrayKind(WIDE, 2, 2), ArrayKind(INT, 2), ArrayKind(FLOAT, 2)
LIBRARY = Library(
    "pair_tables",
    {
        "carried": (
            pair_sums.tabled_pairs,
            (
                record(TabledCurve, WIDES, WIDES, FLOAT, WIDES),
                _TABLE,
                WIDES,
                _TABLE,
                _PLACES,
                record(Space, _TABLE, WIDES, WIDES, WIDES, WIDES, _MATRIX, FLOATS),
                _TABLE,
            ),
        )
    },
    SPECIAL,
)


class DiscUnits:
    """The motion that ``place`` starts, in ξ and η with x = A + Bξ, y = hη.

    In these units the roots of f lie in the unit disc around 0, and its leading coefficient is ±1.
    """

    def __init__(self, place: Callable[[Any], Start]) -> None:
        self._start = place
        with LongField(BITS) as K:
            f = [float(c) for c in place(K).f]
        if not np.isfinite(f).all():
            raise PrecisionLoss("f is beyond the range of floats")
        self.centre = -f[-2] / (len(f) - 1) / f[-1]
        self.size = float(np.abs(np.roots(f[::-1]) - self.centre).max())

    def affine(self, K: Any) -> tuple[Any, Any, Any]:
        """The numbers A, B, h of the transformation."""
        f, b = self._start(K).f, K.coerce(self.size)
        return K.coerce(self.centre), b, K.sqrt(abs(f[-1])) * K.sqrt(b ** (len(f) - 1))

    def start(self, K: Any) -> Start:
        """The start of the motion in ξ and η, in the numbers of K."""
        start, (a, b, h) = self._start(K), self.affine(K)
        g = len(start.v)

        def moved(p: Sequence[Any], size: Any) -> tuple[Any, ...]:
            return tuple(c * b**i / size for i, c in enumerate(poly.shift(K, tuple(p), a)))

        turned: list[Any] = []
        for k, c in enumerate(start.direction):
            # x^k dx/y = (B/h)Σ binom(k, j)A^(k−j)B^j ξ^j dξ/η
            known = sum((comb(k, j) * a ** (k - j) * b**j * turned[j] for j in range(k)), K.zero)
            turned.append((c * h / b - known) / b**k)
        kinds = [Lift((kind.e - a) / b) for kind in start.kinds if isinstance(kind, Lift)]
        data = tuple((kappa / b**g, sigma, nu * b**g / h) for kappa, sigma, nu in start.data)
        return Start(moved(start.f, h * h), moved(start.u, b**g), moved(start.v, h), turned, kinds, data)


class PairTables:
    """D of a :class:`Start` in floats at many times up to ``reach``, as columns.

    PrecisionLoss if tables are not possible: for data other than lifts on a model of odd degree, for odd genus or f < 0
    near infinity on a model of even degree, for a state at rest, and for a time too far.
    """

    def __init__(self, place: Callable[[Any], Start], time: float) -> None:
        with LongField(BITS) as K:
            start = place(K)
            odd = len(start.f) % 2 == 0
            if start.kinds and not (odd and all(isinstance(kind, Lift) for kind in start.kinds)):
                raise PrecisionLoss("lifts on a model of odd degree are needed")
            self.genus = len(start.v)
            if not odd and (self.genus % 2 or start.f[-1] < 0):
                raise PrecisionLoss("even genus and f > 0 near infinity are needed on a model of even degree")
            self._kappas = [Column.of(data[0]) for data in start.data]
            units = DiscUnits(place)
            placed = Placed(K, units.start)
            if placed.rests:
                raise PrecisionLoss("the state rests")
            radius = radius_of(motion_of(placed).rows(row_of(placed.start), TERMS))
        self._step = 2.0 ** (math.frexp(radius)[1] - 1 - FRACTION)
        count = max(FEWEST, math.ceil(math.log(max(time / self._step, 1.0), RATIO)))
        if count > MOST:
            raise PrecisionLoss(f"{count} tables would be needed")
        self.reach = self._step * RATIO**count
        with LongField(BITS + OF_GENUS * self.genus + OF_TABLE * count) as K:
            affine = pack(np.array(units.affine(K), dtype=object))
            self._fill(Placed(K, units.start), count, affine)

    def at(self, times: np.ndarray, begin: int) -> Extended:
        """The pairs with their data at the given times, as columns, computed from start number ``begin``."""
        which, near = self._split(times, begin)
        genus = self.genus
        out = np.empty((len(times), *self._rows.shape[1:]))
        LIBRARY.carried(self._problem, self._near[begin], near, self._rows, which, _space(genus), out)
        rows = np.ascontiguousarray(out.T)
        columns = [Column(high, low) for high, low in zip(rows[0], rows[1], strict=True)]
        pairs = zip(self._kappas, columns[2 * genus :: 2], columns[2 * genus + 1 :: 2], strict=True)
        return Extended((*columns[:genus], Column(1.0)), tuple(columns[genus : 2 * genus]), tuple(pairs))

    def _split(self, times: np.ndarray, begin: int) -> tuple[np.ndarray, np.ndarray]:
        """The table rows to add at each time, shape (N, tables), and the remaining times r as double-doubles."""
        which = np.empty((len(times), len(self._places)), dtype=np.int64)
        shift = self._shifts[begin]
        # the times of rows are multiples of a quarter of a step, so their subtraction is exact
        rest, total = times + shift, np.full(len(times), self._step / 4 - shift)
        for k in range(len(self._places) - 1, -1, -1):
            row, first, count = self._places[k]
            step = np.floor(rest / (self._step * RATIO**k)).astype(np.int64)
            which[:, k] = row + np.clip(step - first, 0, count - 1)
            taken = self._times[which[:, k]]
            rest, total = rest - taken, total + taken
        left = Column(times) - Column(total)
        return which, np.stack([left.hi, left.lo], axis=-1)

    def _fill(self, placed: Placed, count: int, affine: np.ndarray) -> None:
        """Computes the tables in long numbers."""
        K, group, translations = placed.field, placed.group, placed.translations()
        apart = [self._step * (131 + 53 * k) for k in range(count)]
        translations.unit = min(translations.unit, K.coerce(self._step / 4))
        unit = round(math.log2(self._step / 4 / float(translations.unit)))
        rows: list[list[Any]] = []
        times: list[float] = []
        places: list[tuple[int, int, int]] = []
        for k in range(count):
            last = k == count - 1
            begin, end = (-RATIO, RATIO + STARTS + 2) if last else (-RATIO // 2, RATIO)
            step = self._step * RATIO**k
            places.append((len(rows), begin, end - begin))
            D = translations.carried(translations.reference, K.coerce(apart[k] + begin * step))
            for i in range(begin, end):
                quarter, row, D = self._chosen(translations, D, unit + 4 * k)
                rows.append(row)
                times.append((i + quarter / 4) * step)
        # shifts chosen so that the table rows of a time differ between starts in every table
        turn = (RATIO ** (count - 1) - 1) // 3 + RATIO ** (count - 1)
        shifts = [self._step * turn * j for j in range(STARTS)]
        anchors = [self._step / 4 - sum(apart) - shift for shift in shifts]
        motion = motion_of(placed)
        series = [pack(np.array(motion.rows(row_of(placed.at(K.coerce(a))), TERMS)).T) for a in anchors]
        self._problem = TabledCurve(
            pack(np.array(group.f)),
            pack(np.array(ends_of(group), dtype=object)).reshape(-1, 2),
            -float(group.f[-1]) if group.odd and self.genus % 2 else 1.0,
            affine,
        )
        self._rows, self._times, self._places = pack(np.array(rows)), np.array(times), places
        self._near, self._shifts = series, shifts

    def _chosen(self, translations: GroupTranslations, D: Extended, k: int) -> tuple[int, list[Any], Extended]:
        """(quarter, row, D one step later): the best row of this step and the quarter of the step at which it is."""
        found: list[tuple[float, int, list[Any]]] = []
        for quarter in range(4):
            if quarter < QUARTERS and not (found and min(found)[0] < SMALL):
                row = self._row(translations.group, translations.from_reference(D))
                size = max(float(abs(c)) for c in row[: 2 * self.genus])
                found.append((size, quarter, row))
            D = translations.added(D, k, 1)
        _, quarter, row = min(found)
        return quarter, row, D

    def _row(self, group: ExtendedGroup, D: Extended) -> list[Any]:
        """A table row: U, V and lifts, with the sign that sums give to lifts."""
        sign = group.f[-1] if group.odd and self.genus % 2 else 1
        return row_of(D, sign)


def motion_of(placed: Placed) -> MotionSeries:
    """The power series of the motion from any of its pairs, with the lifts."""
    return MotionSeries(placed.field, placed.group.f, placed.direction, ends_of(placed.group))


def row_of(D: Extended, sign: Any = 1) -> list[Any]:
    """The row of D: U, V, then σ and ν of each lift multiplied by ``sign``."""
    return [*D.u[:-1], *D.v, *(x * sign for _, *pair in D.data for x in pair)]


def ends_of(group: ExtendedGroup) -> list[Any]:
    """The branch points that carry lifts."""
    return [kind.e for kind in group.kinds if isinstance(kind, Lift)]


def _space(genus: int) -> Space:
    u, v, other, quotient = (np.empty((2 * genus + 3, 2)) for _ in range(4))
    return Space(
        np.empty((genus, genus + 1, 2)),
        u,
        v,
        other,
        quotient,
        np.empty((genus, 2 * genus + 1)),
        np.empty(2 * genus + 1),
    )
