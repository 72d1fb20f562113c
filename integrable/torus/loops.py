"""The loops that random access on a torus runs on: interpreted, or compiled."""

from __future__ import annotations

from math import ceil, log2, pi
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.moving_point.bare_problem import ROW
from integrable.moving_point.short_rows import NUMBERS
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.torus import clock_modes, walks, witness
from integrable.torus import survey as torus_survey
from integrable.torus.clock_loops import Clock, panel_values, states_at_times, times_at_tau
from integrable.torus.lattice import Beginning, Units
from integrable.torus.series import half_spectrum
from integrable.torus.states import Torus, states_at_phases, states_at_tau
from integrable.torus.tables import Room, directions
from integrable.torus.walks import Curve
from jacobian.errors import PrecisionLoss
from jacobian.numbers.double_double import EPS, split
from jacobian.numbers.fourier import circle_of

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup


# steps from a float to a double-double number
NEWTON_PASSES = 1
# terms of a power series that bring 32 digits within reach
SERIES = 95
# terms of the polynomials of a direction for 25 digits, those that a digit beyond them takes, and the bits that a term
# costs where values become coefficients
TERMS = 19
TERMS_A_DIGIT = 1.6
BITS_A_TERM = 1.3


BEYOND = "periods beyond the range of floats; use more digits"
# π, then what are the κ and the rate of a translation's axes
_CONSTANTS = np.array([(pi, 1.2246467991473532e-16), (1, 0), (1, 0), (1, 0), (1, 0), (0, 0)])


class NotClosed(PrecisionLoss):
    """Walks of whole periods do not lead back: the loops lose too many digits on this motion."""


class ReadableLoops:
    """The loops of :mod:`integrable.torus.walks` interpreted, on lists of numbers of the set-up's wide precision; what
    they are for is good to ``digits``.
    """

    def __init__(self, setup: Setup, digits: int = FLOAT_DIGITS) -> None:
        self._digits = digits
        more = max(0, int(TERMS_A_DIGIT * (digits - 25)) + 1)
        self.terms, bits = TERMS + more, setup.reals.bits + int(BITS_A_TERM * more)
        self.reals = type(setup.reals)(bits)
        # from a float of 46 bits or more
        self._passes, self._series = max(1, ceil(log2(bits / 46))), setup.terms
        # ovals of this length end the arithmetic-geometric mean
        self.short = float(setup.wide.eps) ** 0.5 / 16
        # what rounding leaves of 1/g where its Fourier series has ended
        self.noise = 10.0**-digits

    def packed(self, value: Any) -> Any:
        """A NamedTuple as the loops take it: with lists for arrays, which interpreted loops read faster."""
        if hasattr(value, "_fields"):
            return type(value)(*map(self.packed, value))
        return value.tolist() if isinstance(value, np.ndarray) else value

    def row(self, values: Any) -> Any:
        """Numbers of any kind as working ones."""
        return list(self.reals.row(values))

    def spectrum(self, samples: Any, noise: tuple[float, float]) -> tuple[Any, tuple[int, int]]:
        """:func:`integrable.torus.series.half_spectrum` of long doubles as a row of working numbers, and what
        :func:`integrable.torus.clock_modes.sizes_needed` says of it.
        """
        half, (rows, columns) = half_spectrum(samples), samples.shape
        values = half.ravel().view(half.real.dtype).tolist()
        with self.reals:
            found = [self.reals.number(float(x)) + self.reals.number(float(x - float(x))) for x in values]
            room = [0.0] * (rows // 2 + columns // 2 + 2)
            return found, clock_modes.sizes_needed(found, (rows, columns), noise, room)

    def room(self, count: int) -> Any:
        """Room for so many."""
        return [self.reals.number(0)] * count

    def wide(self, values: Any, field: Any) -> tuple[Any, ...]:
        """Working numbers as those of a wide field."""
        return self.reals.elements(field, values)

    def floats(self, values: Any) -> np.ndarray:
        """Working numbers rounded to floats, shape (N,)."""
        return np.array([float(x) for x in values])

    def samples(self, values: Any, sizes: tuple[int, int]) -> np.ndarray:
        """Working numbers on a grid as they are, or as the long doubles of this machine where those suffice."""
        if self._digits > FLOAT_DIGITS:
            return np.array(values, dtype=object).reshape(sizes)
        high = self.floats(values)
        with self.reals:
            low = [float(x - y) for x, y in zip(values, self.row(high.tolist()), strict=True)]
        return (high.astype(np.longdouble) + low).reshape(sizes)

    def survey(self, motion: Any, short: float, points: Any, out: Any) -> Any:
        """:func:`integrable.torus.survey.survey`."""
        with self.reals:
            return torus_survey.survey(motion, short, points, out)

    def directions(self, motion: Any, chart: Any, parts: Any, nodes: Any, tables: Any, halves: Any) -> None:
        """:func:`integrable.torus.tables.directions`."""
        room = Room(*map(self.room, (self._series, self._series, 9, 10 * (len(nodes) + 2))))
        with self.reals:
            directions(motion, chart, parts, nodes, self._passes, room, tables, halves)

    panel_values = staticmethod(panel_values)

    def reached(self, line: Any, times: Any, *args: Any) -> None:
        """:func:`integrable.torus.witness.reached`."""
        with self.reals:
            witness.reached(line, times.tolist(), *args)

    def departure(self, torus: Any, line: Any, times: Any, *args: Any) -> float:
        """:func:`integrable.torus.witness.departure`."""
        with self.reals:
            return witness.departure(torus, line, times.tolist(), *args)

    def begun(self, setup: Any) -> None:
        """None: a set-up in as many digits is there."""

    def rates(self, *args: Any) -> None:
        """:func:`integrable.torus.survey.rates`."""
        with self.reals:
            torus_survey.rates(*args)

    def about_centre(self, motion: Any, out: Any) -> None:
        """:func:`integrable.torus.survey.about_centre` about the origin."""
        with self.reals:
            torus_survey.about_centre(motion, 0.0, 1.0, out)

    def joined(self, *rows: Any) -> Any:
        """Rows of numbers one after the other."""
        return [x for row in rows for x in row]

    def corners(self, *args: Any) -> float:
        """:func:`integrable.torus.walks.corners`."""
        with self.reals:
            return walks.corners(*args)

    def offsets(self, *args: Any) -> None:
        """:func:`integrable.torus.walks.offsets`."""
        with self.reals:
            walks.offsets(*args)

    def gridded(self, *args: Any) -> None:
        """:func:`integrable.torus.walks.gridded`."""
        with self.reals:
            walks.gridded(*args)

    def states_at_phases(self, torus: Torus, phases: Any, out: Any) -> None:
        """:func:`integrable.torus.states.states_at_phases`."""
        with self.reals:
            states_at_phases(torus, phases.tolist(), out)

    def states_at_tau(self, torus: Torus, frequencies: Any, tau: Any, out: Any) -> None:
        """:func:`integrable.torus.states.states_at_tau`."""
        with self.reals:
            states_at_tau(torus, frequencies, tau.tolist(), out)

    def states_at_times(self, torus: Torus, clock: Clock, times: Any, *rows: Any) -> None:
        """:func:`integrable.torus.clock_loops.states_at_times`."""
        with self.reals:
            states_at_times(torus, clock, times.tolist(), *rows)

    def times_at_tau(self, clock: Clock, tau: Any, times: Any, room: Any) -> None:
        """:func:`integrable.torus.clock_loops.times_at_tau`."""
        with self.reals:
            times_at_tau(clock, tau.tolist(), times, room.tolist())

    def clock_series(self, *args: Any) -> Any:
        """:func:`integrable.torus.clock_modes.clock_series`."""
        with self.reals:
            return clock_modes.clock_series(*args)


class CompiledLoops:
    """The same compiled, on arrays of double-double numbers."""

    terms = TERMS
    noise = 1e-15
    short = EPS**0.5 / 16

    def __init__(self) -> None:
        from integrable.torus import compiled
        from jacobian.native.library import Packed

        self._kinds, self._packed, entries = compiled.KINDS, Packed, compiled.LIBRARY
        self.survey_rows: Any = entries.survey
        self.direction_rows: Any = entries.directions
        self.corners: Any = entries.corners
        self.gridded: Any = entries.gridded
        self.states_at_phases: Any = entries.states_at_phases
        self.states_at_tau: Any = entries.states_at_tau
        self.points_at_phases: Any = entries.points_at_phases
        self.phases_at_times: Any = entries.phases_at_times
        self.states_at_times: Any = entries.states_at_times
        self.times_at_tau: Any = entries.times_at_tau
        self.spectrum_rows: Any = entries.spectrum
        self.clock_series: Any = entries.clock_series
        self.panel_values: Any = entries.panel_values
        self.reached: Any = entries.reached
        self.departure: Any = entries.departure
        self.seam: Any = entries.seam
        self.rates: Any = entries.rates
        self._begun: Any = entries.begun
        self._about_centre: Any = entries.about_centre

    def packed(self, value: Any) -> Any:
        return self._packed(value, self._kinds[type(value)])

    def row(self, values: Any) -> Any:
        return np.array([split(x) for x in values])

    def begun(self, setup: Any) -> Beginning | None:
        if setup.floats_given is None:
            return None
        given, tilted = setup.floats_given
        wide, numbers = np.zeros((10 + ROW + 12, 2)), np.empty(NUMBERS)
        wide[:10, 0] = given
        problem, motion = wide[10 : 10 + ROW], wide[10 + ROW :]
        if not self._begun(wide[:10], tilted, _CONSTANTS, problem, numbers, motion):
            return None
        unit_axes = np.concatenate([problem[6:9], _CONSTANTS[1:]])
        return Beginning(Units(), motion, Curve(problem[:6], problem[6:14], unit_axes), problem[14:24], problem)

    def about_centre(self, motion: Any, out: Any) -> None:
        self._about_centre(motion, 0.0, 1.0, out)

    def joined(self, *rows: Any) -> Any:
        return np.concatenate(rows)

    def spectrum(self, samples: Any, noise: tuple[float, float]) -> tuple[Any, tuple[int, int]]:
        if samples.dtype == np.longdouble:
            high = samples.astype(np.float64)
            samples = np.stack([high, (samples - high).astype(np.float64)], axis=-1)
        rows, columns, _ = samples.shape
        rooms, room = np.empty((3, (rows + 2) * columns, 2)), np.empty(rows // 2 + columns // 2 + 2)
        size, circle = rows * columns, circle_of(max(rows, columns))
        wanted = self.spectrum_rows(samples.reshape(size, 2), (rows, columns), noise, circle, (*rooms,), room)
        return rooms[2], wanted

    def room(self, count: int) -> Any:
        return np.zeros((count, 2))

    def wide(self, values: Any, field: Any) -> tuple[Any, ...]:
        if not np.isfinite(values).all():
            raise NotClosed(BEYOND)
        return tuple(field.coerce(high) + field.coerce(low) for high, low in values.tolist())

    def floats(self, values: Any) -> np.ndarray:
        return np.ascontiguousarray(values[:, 0])

    def samples(self, values: Any, sizes: tuple[int, int]) -> np.ndarray:
        found: np.ndarray = values.reshape(*sizes, 2)
        return found

    def survey(self, motion: Any, short: float, points: Any, out: Any) -> Any:
        return self.survey_rows(motion, short, np.array(points), out)

    def directions(self, motion: Any, chart: Any, parts: Any, nodes: Any, tables: Any, halves: Any) -> None:
        room = Room(*map(self.room, (SERIES, SERIES, 9, 10 * (len(nodes) + 2))))
        self.direction_rows(motion, chart, parts, np.array(nodes), NEWTON_PASSES, room, tables, halves)
