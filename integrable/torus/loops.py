"""The loops for random access on a torus, interpreted or compiled."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import ceil, log2, pi
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.moving_point.addition import Row
from integrable.moving_point.problem import CONTACT, ROW, START, TIME_SCALE
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.torus import clock_modes, walks, witness
from integrable.torus import survey as torus_survey
from integrable.torus.clock_loops import panel_values, states_at_times, times_at_tau
from integrable.torus.lattice import Beginning, Units
from integrable.torus.series import half_spectrum
from integrable.torus.states import states_at_phases, states_at_tau
from integrable.torus.tables import TableRoom, directions
from integrable.torus.walks import Curve
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.numbers.double_double import EPS, double_double_row
from jacobian.numbers.fourier import circle_of

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup
    from integrable.torus.lattice import Chart, Source


# one Newton step leads from a float to double-double precision
NEWTON_PASSES = 1
# the number of terms of a power series for 32 digits
SERIES = 95
# the polynomials of a direction have TERMS terms for 25 digits and TERMS_A_DIGIT more for each further digit; each
# further term costs BITS_A_TERM bits when values at nodes are turned into coefficients
TERMS = 19
TERMS_A_DIGIT = 1.6
BITS_A_TERM = 1.3


BEYOND = "periods beyond the range of floats; use more digits"
# constants of translations: π, three κ, which are 1, and the direction (1, 0)
_CONSTANTS = np.array([(pi, 1.2246467991473532e-16), (1, 0), (1, 0), (1, 0), (1, 0), (0, 0)])


# the interpreted loops, with the indices of their arguments that are arrays of floats, which they take as lists
PLAIN: dict[str, tuple[Callable[..., object], tuple[int, ...]]] = {
    "about_centre": (torus_survey.about_centre, ()),
    "clock_series": (clock_modes.clock_series, ()),
    "corners": (walks.corners, ()),
    "departure": (witness.departure, (2,)),
    "gridded": (walks.gridded, ()),
    "offsets": (walks.offsets, ()),
    "panel_values": (panel_values, ()),
    "rates": (torus_survey.surveyed_rates, ()),
    "reached": (witness.reached, (1,)),
    "states_at_phases": (states_at_phases, (1,)),
    "states_at_tau": (states_at_tau, (2,)),
    "states_at_times": (states_at_times, (2,)),
    "survey": (torus_survey.survey, (2,)),
    "times_at_tau": (times_at_tau, (1, 3)),
}


class NotClosed(PrecisionLoss):
    """Walks over whole periods do not return to their start: the loops lose too many digits on this motion."""


class ReadableLoops:
    """The loops of :mod:`integrable.torus.walks` interpreted, on lists of numbers of the set-up's wide precision;
    results are accurate to ``digits``.
    """

    def __init__(self, setup: Setup, digits: int = FLOAT_DIGITS) -> None:
        self._digits = digits
        more = max(0, int(TERMS_A_DIGIT * (digits - 25)) + 1)
        self.terms, bits = TERMS + more, setup.reals.bits + int(BITS_A_TERM * more)
        self.reals = type(setup.reals)(bits)
        # a pass of Newton's method doubles the correct bits, of which a float gives at least 46
        self._passes, self._series = max(1, ceil(log2(bits / 46))), setup.terms
        # the arithmetic-geometric mean converges quadratically: ovals of this length need no further step
        self.short = float(setup.wide.eps) ** 0.5 / 16
        # the size of rounding errors in 1/g, at which its Fourier series ends
        self.noise = 10.0**-digits

    def packed(self, value: Any) -> Any:
        """A NamedTuple for the loops, with lists for arrays, which interpreted loops read faster."""
        if hasattr(value, "_fields"):
            return type(value)(*map(self.packed, value))
        return value.tolist() if isinstance(value, np.ndarray) else value

    def row(self, values: Iterable[Real]) -> Row:
        """A row of working numbers from numbers of any kind."""
        return list(self.reals.row(values))

    def spectrum(self, samples: np.ndarray, noise: tuple[float, float]) -> tuple[Row, tuple[int, int]]:
        """:func:`integrable.torus.series.half_spectrum` of long doubles as a row of working numbers, and its
        :func:`integrable.torus.clock_modes.sizes_needed`.
        """
        half, (rows, columns) = half_spectrum(samples), samples.shape
        values = half.ravel().view(half.real.dtype).tolist()
        with self.reals:
            found = [self.reals.number(float(x)) + self.reals.number(float(x - float(x))) for x in values]
            room = [0.0] * (rows // 2 + columns // 2 + 2)
            return found, clock_modes.sizes_needed(found, (rows, columns), noise, room)

    def room(self, count: int) -> Row:
        """Memory for ``count`` numbers."""
        return [self.reals.number(0)] * count

    def wide(self, values: Row, field: MultiprecisionField) -> tuple[Real, ...]:
        """Working numbers converted to a wide field."""
        return self.reals.elements(field, values)

    def floats(self, values: Row) -> np.ndarray:
        """Working numbers rounded to floats, shape (N,)."""
        return np.array([float(x) for x in values])

    def samples(self, values: Row, sizes: tuple[int, int]) -> np.ndarray:
        """Working numbers on a grid unchanged, or as the long doubles of this machine if those suffice."""
        if self._digits > FLOAT_DIGITS:
            return np.array(values, dtype=object).reshape(sizes)
        high = self.floats(values)
        with self.reals:
            low = [float(x - y) for x, y in zip(values, self.row(high.tolist()), strict=True)]
        return (high.astype(np.longdouble) + low).reshape(sizes)

    def __getattr__(self, name: str) -> Any:
        """The loop of this name in the precision of these numbers."""
        if name not in PLAIN:
            raise AttributeError(f"torus loops have no {name}; they have {', '.join(PLAIN)}")
        loop, read = PLAIN[name]

        def inside(*args: Row) -> object:
            with self.reals:
                return loop(*(x.tolist() if i in read else x for i, x in enumerate(args)))

        return inside

    def directions(
        self, motion: Row, chart: Chart, parts: Row, nodes: Sequence[float], tables: Row, halves: Row
    ) -> None:
        """Calls :func:`integrable.torus.tables.directions`."""
        room = TableRoom(*map(self.room, (self._series, self._series, 9, 10 * (len(nodes) + 2))))
        with self.reals:
            directions(motion, chart, parts, nodes, self._passes, room, tables, halves)

    def begun(self, setup: Source) -> None:
        """None: the set-up already has all digits."""

    def joined(self, *rows: Row) -> Row:
        """Rows of numbers, concatenated."""
        return [x for row in rows for x in row]


class CompiledLoops:
    """The compiled loops, on arrays of double-double numbers."""

    terms = TERMS
    noise = 1e-15
    short = EPS**0.5 / 16

    def __init__(self) -> None:
        from integrable.torus import compiled
        from jacobian.native.library import Packed

        self._kinds, self._packed, self._entries = compiled.KINDS, Packed, compiled.LIBRARY

    def __getattr__(self, name: str) -> Any:
        """The compiled loop of this name."""
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self._entries, name)

    def packed(self, value: Any) -> Any:
        return self._packed(value, self._kinds[type(value)])

    def row(self, values: Iterable[Real]) -> Row:
        return double_double_row(values)

    def begun(self, setup: Source) -> Beginning | None:
        if setup.floats_given is None:
            return None
        given, tilted = setup.floats_given
        wide = np.zeros((10 + ROW + 12, 2))
        wide[:10, 0] = given
        problem, motion = wide[10 : 10 + ROW], wide[10 + ROW :]
        if not self._entries.begun(wide[:10], tilted, _CONSTANTS, problem, motion):
            return None
        unit_axes = np.concatenate([problem[6:9], _CONSTANTS[1:]])
        return Beginning(
            Units(), motion, Curve(problem[:6], problem[6:14], unit_axes), problem[START:TIME_SCALE], problem[:CONTACT]
        )

    def joined(self, *rows: Row) -> Row:
        return np.concatenate(rows)

    def spectrum(self, samples: np.ndarray, noise: tuple[float, float]) -> tuple[Row, tuple[int, int]]:
        if samples.dtype == np.longdouble:
            high = samples.astype(np.float64)
            samples = np.stack([high, (samples - high).astype(np.float64)], axis=-1)
        rows, columns, _ = samples.shape
        rooms, room = np.empty((3, (rows + 2) * columns, 2)), np.empty(rows // 2 + columns // 2 + 2)
        size, circle = rows * columns, circle_of(max(rows, columns))
        wanted = self._entries.spectrum(samples.reshape(size, 2), (rows, columns), noise, circle, (*rooms,), room)
        return rooms[2], wanted

    def room(self, count: int) -> Row:
        return np.zeros((count, 2))

    def wide(self, values: Row, field: MultiprecisionField) -> tuple[Real, ...]:
        if not np.isfinite(values).all():
            raise NotClosed(BEYOND)
        return tuple(field.coerce(high) + field.coerce(low) for high, low in values.tolist())

    def floats(self, values: Row) -> np.ndarray:
        return np.ascontiguousarray(values[:, 0])

    def samples(self, values: Row, sizes: tuple[int, int]) -> np.ndarray:
        found: np.ndarray = values.reshape(*sizes, 2)
        return found

    def directions(
        self, motion: Row, chart: Chart, parts: Row, nodes: Sequence[float], tables: Row, halves: Row
    ) -> None:
        room = TableRoom(*map(self.room, (SERIES, SERIES, 9, 10 * (len(nodes) + 2))))
        self._entries.directions(motion, chart, parts, np.array(nodes), NEWTON_PASSES, room, tables, halves)


Loops = ReadableLoops | CompiledLoops
