"""The loops for random access on a torus, interpreted or compiled, and the theta series that they use."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import exp, inf, log, pi
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.moving_point.addition import Row
from integrable.moving_point.problem import CONTACT, ROW, START, TIME_SCALE
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.torus import clock_modes, theta_series
from integrable.torus.compiled import KINDS, LIBRARY, LOOPS
from integrable.torus.lattice import Beginning, Units, beginning
from integrable.torus.theta_series import ThetaSums
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.native.library import Packed
from jacobian.numbers.double_double import EPS, double_double_row
from jacobian.numbers.fourier import circle_of
from jacobian.numbers.long_reals import BareReals
from jacobian.periods.real_basis import Whole

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup


# largest number of harmonics of a theta series; beyond it, branch points nearly meet
MOST_HARMONICS = 40
BEYOND = "periods beyond the range of floats; use more digits"
# π and 1
_CONSTANTS = np.array([(pi, 1.2246467991473532e-16), (1, 0)])


# for each interpreted loop, which of its arguments are passed as lists: the arrays of floats that it only reads
READ = {"phases_at": (1,), "phases_at_times": (1,), "placed": (5,), "times_at_tau": (1,)}


class ReadableNumbers:
    """Rows of bare reals, for interpreted loops."""

    def __init__(self, reals: BareReals) -> None:
        self.reals = reals

    def packed(self, value: Any) -> Any:
        """The NamedTuple ``value`` with lists in place of arrays, because interpreted loops read lists faster."""
        if hasattr(value, "_fields"):
            return type(value)(*map(self.packed, value))
        return value.tolist() if isinstance(value, np.ndarray) else value

    def row(self, values: Iterable[Real]) -> Row:
        """A row of ``values``, numbers of any kind, converted to the precision of the loops."""
        return list(self.reals.row(values))

    def exact(self, values: np.ndarray) -> Row:
        """A row of floats."""
        row: Row = values.tolist()
        return row

    def integers(self, values: Iterable[int]) -> Row:
        """The integers as loops take them: a list if interpreted, an array if compiled."""
        return list(values)

    def room(self, count: int) -> Row:
        """Memory for ``count`` numbers."""
        return [self.reals.number(0)] * count

    def wide(self, values: Row, field: MultiprecisionField) -> tuple[Real, ...]:
        """The numbers of a row, in the precision of the loops, as elements of a wide ``field``."""
        return self.reals.elements(field, values)

    def floats(self, values: Row) -> np.ndarray:
        """The numbers of a row, in the precision of the loops, rounded to floats, shape (N,)."""
        return np.array([float(x) for x in values])

    def samples(self, values: Row, sizes: tuple[int, int]) -> np.ndarray:
        """The numbers of a row as an array, whose rows and columns are ``sizes``."""
        return np.array(values, dtype=object).reshape(sizes)


class ReadableLoops(ReadableNumbers):
    """The loops of :mod:`integrable.torus.states` interpreted, on lists of numbers of the set-up's wide precision;
    results are accurate to ``digits``.
    """

    def __init__(self, setup: Setup, digits: int = FLOAT_DIGITS) -> None:
        super().__init__(setup.reals)
        bits = self.reals.bits
        # iterations for periods converge quadratically and end when an oval or a difference of means is below ``short``
        self.short = float(setup.wide.eps) ** 0.5 / 16
        # the size of rounding errors in 1/g, at which its Fourier series ends
        self.noise = 10.0**-digits
        self.depth, self.nudge = bits * log(2) / pi, 2.0 ** -(2 * bits // 5)
        # ovals that are points are opened to this length, relative to the largest difference of the branch points α_i
        self.closest = 2.0 ** (16 - bits)
        self.circle = theta_series.circle_numbers(self.reals, bits)

    def spectrum(self, samples: np.ndarray, noise: tuple[float, float]) -> tuple[Row, tuple[int, int]]:
        """The spectrum that :func:`integrable.torus.clock_modes.spectrum_of_samples` writes, and its result."""
        (rows, columns), size = samples.shape, max(samples.shape)
        rooms, room = [self.room((rows + 2) * columns) for _ in range(3)], [0.0] * (rows // 2 + columns // 2 + 2)
        with self.reals:
            turns = [self.reals.number(-k) / size for k in range(size // 2)]
            circle = [part for x in turns for part in theta_series.circle(x, self.circle)]
            grid, values = (rows, columns), samples.ravel().tolist()
            wanted = clock_modes.spectrum_of_samples(values, grid, noise, circle, (rooms[0], rooms[1], rooms[2]), room)
        return rooms[2], wanted

    def __getattr__(self, name: str) -> Any:
        """The interpreted loop ``name``, which computes in the precision of the set-up."""
        if name not in LOOPS:
            raise AttributeError(f"torus loops have no {name}; they have {', '.join(LOOPS)}")
        (loop, _), read = LOOPS[name], READ.get(name, ())

        def inside(*args: Row) -> object:
            with self.reals:
                return loop(*(x.tolist() if i in read else x for i, x in enumerate(args)))

        return inside

    def begun(self, setup: Setup) -> Beginning:
        return beginning(setup, self)


class CompiledNumbers:
    """Rows of double-doubles, for compiled loops; the methods are those of :class:`ReadableNumbers`."""

    def packed(self, value: Any) -> Any:
        return Packed(value, KINDS[type(value)])

    def row(self, values: Iterable[Real]) -> Row:
        return double_double_row(values).reshape(-1, 2)

    def exact(self, values: np.ndarray) -> Row:
        row = np.zeros((len(values), 2))
        row[:, 0] = values
        return row

    def integers(self, values: Iterable[int]) -> Row:
        return np.fromiter(values, dtype=np.int64)

    def room(self, count: int) -> Row:
        return np.zeros((count, 2))

    def wide(self, values: Row, field: MultiprecisionField) -> tuple[Real, ...]:
        if not np.isfinite(values).all():
            raise PrecisionLoss(BEYOND)
        return tuple(field.coerce(high) + field.coerce(low) for high, low in values.tolist())

    def floats(self, values: Row) -> np.ndarray:
        return np.ascontiguousarray(values[:, 0])

    def samples(self, values: Row, sizes: tuple[int, int]) -> np.ndarray:
        return values.reshape(*sizes, 2)


class CompiledLoops(CompiledNumbers):
    """The compiled loops, on arrays of double-double numbers."""

    noise = 1e-15
    short = EPS**0.5 / 16
    depth, nudge, closest = theta_series.DEPTH, 2.0**-44, 2.0**-130

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(LIBRARY, name)

    @property
    def circle(self) -> Row:
        return theta_series.inverse_factorials()

    def begun(self, setup: Setup) -> Beginning:
        """The rows of numbers from which the torus of a motion is made. They are computed in more digits than
        double-doubles have unless branch points are well separated.
        """
        if setup.floats_given is not None:
            given, tilted = setup.floats_given
            wide = np.zeros((10 + ROW + 12, 2))
            wide[:10, 0] = given
            problem, motion = wide[10 : 10 + ROW], wide[10 + ROW :]
            if LIBRARY.begun(wide[:10], tilted, _CONSTANTS, problem, motion):
                return Beginning(Units(), motion, problem[12:14], problem[START:TIME_SCALE], problem[:CONTACT])
        return beginning(setup, self)

    def spectrum(self, samples: np.ndarray, noise: tuple[float, float]) -> tuple[Row, tuple[int, int]]:
        rows, columns, _ = samples.shape
        rooms, room = np.empty((3, (rows + 2) * columns, 2)), np.empty(rows // 2 + columns // 2 + 2)
        size, circle = rows * columns, circle_of(max(rows, columns))
        wanted = LIBRARY.spectrum(samples.reshape(size, 2), (rows, columns), noise, circle, (*rooms,), room)
        return rooms[2], wanted


Loops = ReadableLoops | CompiledLoops


# --- theta series


PeriodBasis = tuple[tuple[int, int], tuple[int, int]]
"""Two periods as integer rows, in the periods around the two ovals."""


def in_basis(classes: Sequence[Whole], basis: PeriodBasis) -> list[Whole]:
    """The characteristics in a ``basis`` of periods; ``classes`` are those of
    :data:`integrable.torus.theta_setup.CLASSES`.
    """
    # the basis is p·a₁ + q·(a₂ − a₁), r·a₁ + s·(a₂ − a₁) with the periods a₁ and a₂ of the ovals
    p, q, r, s = basis[0][0] + basis[0][1], basis[0][1], basis[1][0] + basis[1][1], basis[1][1]
    found = []
    for e1, e2, d1, d2 in classes:
        # the signs of δ do not matter modulo 2
        found.append(((p * e1 + q * e2) % 2, (r * e1 + s * e2) % 2, (s * d1 + r * d2) % 2, (q * d1 + p * d2) % 2))
    return found


def theta_sums(
    loops: Loops, shape: Row, real: Sequence[int], chars: Sequence[Whole], further: float = 0.0
) -> tuple[ThetaSums, Row]:
    """The coefficients of the theta series with the characteristics ``chars``, and the largest term of each series, by
    which its coefficients are divided.

    ``shape`` is that of :func:`theta_weights`; ``real`` are 2Re τ₁₁, 2Re τ₁₂, 2Re τ₂₂; ``further`` is added to
    ``loops.depth``.
    """
    depth = loops.depth + further
    widest = [2 * (depth / y) ** 0.5 for y in shortest(loops.floats(shape[:3]).tolist())]
    if max(widest) > 2 * MOST_HARMONICS * max(1, loops.depth / theta_series.DEPTH) ** 0.5:
        raise PrecisionLoss("theta functions of this motion have too many terms: branch points nearly meet")
    sizes = len(chars), int(widest[0]) // 2 + 2, int(widest[1]) // 2 + 2
    least = min(char[0] for char in chars), min(char[1] for char in chars)
    count = sizes[0] * sizes[1]
    sums = ThetaSums(
        loops.room(4 * count * sizes[2]),
        sizes,
        loops.integers([0] * count),
        loops.integers(x for char in chars for x in char),
        loops.circle,
    )
    tops, turns = loops.room(sizes[0]), (int(real[0]), int(real[1]), int(real[2]))
    if not loops.theta_weights(shape, turns, least, exp(-pi * depth), sums, tops):
        raise PrecisionLoss("theta functions of this motion are not real")
    return sums, tops


def shortest(imaginary: Sequence[float]) -> tuple[float, float]:
    """The least nYn of n = (1, x) and of n = (x, 1) for real x; ``imaginary`` are Y₁₁, Y₁₂ and Y₂₂."""
    y11, y12, y22 = imaginary
    return (y11 - y12**2 / y22, y22 - y12**2 / y11) if y11 else (inf, y22)
