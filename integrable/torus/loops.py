"""The loops that random access on a torus runs on: interpreted, or compiled."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.torus import survey as torus_survey
from integrable.torus import walks
from integrable.torus.clock_loops import panel_values, states_at_times, times_at_tau
from integrable.torus.states import states_at_phases, states_at_tau
from integrable.torus.tables import directions
from jacobian.errors import PrecisionLoss
from jacobian.numbers.double_double import EPS, pack

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup


# steps from a float to a double-double number
NEWTON_PASSES = 1


# terms of a power series that bring 32 digits within reach
SERIES = 85


class NotClosed(PrecisionLoss):
    """Walks of whole periods do not lead back: the loops lose too many digits on this motion."""


class ReadableLoops:
    """The loops of :mod:`integrable.torus.walks` interpreted, on lists of numbers of the set-up's wide precision."""

    terms = 18
    # what rounding leaves of 1/g where its Fourier series has ended
    noise = 1e-15

    def __init__(self, setup: Setup) -> None:
        self._reals = setup.reals
        self._passes = setup.passes
        self._series = setup.terms
        self.short = float(setup.wide.eps) ** 0.5 / 16

    def row(self, values: Any) -> Any:
        """Numbers of any kind as working ones."""
        return list(self._reals.row(values))

    def room(self, count: int) -> Any:
        """Room for so many."""
        return [self._reals.number(0)] * count

    def wide(self, values: Any, field: Any) -> tuple[Any, ...]:
        """Working numbers as those of a wide field."""
        return self._reals.elements(field, values)

    def floats(self, values: Any) -> np.ndarray:
        """Working numbers rounded to floats, shape (N,)."""
        return np.array([float(x) for x in values])

    def long_doubles(self, values: Any) -> np.ndarray:
        """Working numbers as long doubles, where the machine has them, shape (N,)."""
        high = self.floats(values)
        with self._reals:
            low = [float(x - y) for x, y in zip(values, self.row(high.tolist()), strict=True)]
        return high.astype(np.longdouble) + low

    def differences(self, first: Any, second: Any) -> np.ndarray:
        """Differences of working numbers, as floats."""
        with self._reals:
            return np.array([float(x - y) for x, y in zip(first, second, strict=True)])

    def survey(self, motion: Any, short: float, points: Any, out: Any) -> Any:
        """:func:`integrable.torus.survey.survey`."""
        with self._reals:
            return torus_survey.survey(motion, short, points, out)

    def directions(self, motion: Any, chart: Any, parts: Any, nodes: Any, tables: Any, halves: Any) -> None:
        """:func:`integrable.torus.tables.directions`."""
        series, roots, room = map(self.room, (self._series, self._series, 9 + len(nodes)))
        with self._reals:
            directions(motion, chart, parts, nodes, self._passes, series, roots, room, tables, halves)

    panel_values = staticmethod(panel_values)

    def corners(self, *args: Any) -> None:
        """:func:`integrable.torus.walks.corners`."""
        with self._reals:
            walks.corners(*args)

    def offsets(self, *args: Any) -> None:
        """:func:`integrable.torus.walks.offsets`."""
        with self._reals:
            walks.offsets(*args)

    def sampled(self, *args: Any) -> None:
        """:func:`integrable.torus.walks.sampled`."""
        with self._reals:
            walks.sampled(*args)

    def states_at_phases(self, rows: Any, sizes: Any, phases: Any, out: Any) -> None:
        """:func:`integrable.torus.states.states_at_phases`."""
        with self._reals:
            states_at_phases((*rows, sizes), phases.tolist(), out)

    def states_at_tau(self, rows: Any, sizes: Any, frequencies: Any, tau: Any, out: Any) -> None:
        """:func:`integrable.torus.states.states_at_tau`."""
        with self._reals:
            states_at_tau((*rows, sizes), frequencies, tau.tolist(), out)

    def states_at_times(
        self,
        rows: Any,
        sizes: Any,
        pace: Any,
        clock: Any,
        modes: Any,
        loud: Any,
        times: Any,
        tau: Any,
        delays: Any,
        out: Any,
        room: Any,
    ) -> None:
        """:func:`integrable.torus.clock_loops.states_at_times`."""
        with self._reals:
            states_at_times(
                (*rows, sizes), pace, _listed(clock), modes.tolist(), loud, times.tolist(), tau, delays, out,
                room.tolist(),
            )  # fmt: skip

    def times_at_tau(self, frequencies: Any, clock: Any, mean: Any, tau: Any, times: Any, room: Any) -> None:
        """:func:`integrable.torus.clock_loops.times_at_tau`."""
        with self._reals:
            times_at_tau(frequencies, _listed(clock), mean[0], tau.tolist(), times, room.tolist())


class CompiledLoops:
    """The same compiled, on arrays of double-double numbers."""

    terms = 18
    noise = 1e-15
    short = EPS**0.5 / 16

    def __init__(self) -> None:
        from integrable.torus import compiled as torus_compiled

        self._loops = torus_compiled
        self.corners: Any = torus_compiled.corners
        self.offsets: Any = torus_compiled.offsets
        self.sampled: Any = torus_compiled.sampled
        self.states_at_phases: Any = torus_compiled.states_at_phases
        self.states_at_tau: Any = torus_compiled.states_at_tau
        self.states_at_times: Any = torus_compiled.states_at_times
        self.times_at_tau: Any = torus_compiled.times_at_tau
        self.panel_values: Any = torus_compiled.panel_values

    def row(self, values: Any) -> Any:
        return pack(np.array(list(values), dtype=object))

    def room(self, count: int) -> Any:
        return np.zeros((count, 2))

    def wide(self, values: Any, field: Any) -> tuple[Any, ...]:
        if not np.isfinite(values).all():
            raise NotClosed("periods beyond the range of floats; use more digits")
        return tuple(field.coerce(high) + field.coerce(low) for high, low in values.tolist())

    def floats(self, values: Any) -> np.ndarray:
        return np.ascontiguousarray(values[:, 0])

    def long_doubles(self, values: Any) -> np.ndarray:
        long: np.ndarray = values[:, 0].astype(np.longdouble) + values[:, 1]
        return long

    def differences(self, first: Any, second: Any) -> np.ndarray:
        # exact where they are close
        return (first[:, 0] - second[:, 0]) + (first[:, 1] - second[:, 1])

    def survey(self, motion: Any, short: float, points: Any, out: Any) -> Any:
        return self._loops.survey(motion, short, np.array(points), out)

    def directions(self, motion: Any, chart: Any, parts: Any, nodes: Any, tables: Any, halves: Any) -> None:
        rooms = map(self.room, (SERIES, SERIES, 9 + len(nodes)))
        self._loops.directions(motion, chart, parts, np.array(nodes), NEWTON_PASSES, *rooms, tables, halves)


def _listed(clock: Any) -> Any:
    """The clock's arrays as lists, which interpreted loops read faster."""
    return tuple(
        tuple(x.tolist() if isinstance(x, np.ndarray) else x for x in part) if isinstance(part, tuple) else part
        for part in clock
    )
