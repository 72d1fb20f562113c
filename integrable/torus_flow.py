"""Random access to a motion: any τ and any t by the same two additions from the nearest corner of a cell of the torus.

The moving points at the corners are made once; a time of the flow is two phases, its whole turns are signs, and what is
left inside a cell is T(s₁, c₁s₁) + T(s₂, c₂s₂) with T a power series. Compiled, all this is done in double-double
numbers and rounded once, so that no error grows with the time; interpreted, with
more digits. Physical time t = ∫dτ/g is a mean rate and a Fourier series on the torus, inverted by Newton (Fedorov 2009
gives the same functions as theta functions).
"""

from __future__ import annotations

from functools import cached_property
from math import cos, fsum, pi
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable import torus_kernel
from integrable.dense_panels import NODES, Panels, States, panel_length
from integrable.flow_setup import conditioning
from integrable.torus_lattice import TorusLattice
from integrable.torus_series import TorusSeries, needed_sizes
from jacobian import poly
from jacobian.bare_reals import BareReals
from jacobian.double_double import pack
from jacobian.errors import ArgumentError, PrecisionLoss

if TYPE_CHECKING:
    from integrable.flow_setup import Setup

# more turns of a phase than this leave no digits of a float behind
MOST_TURNS = 2.0**50
MOST_SAMPLES = 1 << 18
# coefficients of 1/g below this part of its mean are left out of the series that Newton starts with
ROUGH = 1e-4
# the mean of the samples may be off by this part of it: 1e12 units of time then show their last digits
ALIAS = 1e-27
# steps from a float to a double-double number
NEWTON_PASSES = 2
# ascending times from this many on, and so many to a node, are read off panels
DENSE_FROM = 5000
DENSE = 3
# translations that are conditioned worse than this are made in two parts
LEAST_CONDITION = 0.02


class BeyondFloats(PrecisionLoss):
    """Numbers beyond the range of floats: series about a centre close to several branch points."""


class ReadableLoops:
    """The loops of :mod:`integrable.torus_kernel` interpreted, on lists of numbers of the set-up's wide precision."""

    terms = 18
    # what rounding leaves of 1/g where its Fourier series has ended
    noise = 1e-15

    def __init__(self, setup: Setup) -> None:
        # balls would widen from addition to addition
        self._reals = setup.reals if setup.reals.kind != "python-flint" else BareReals(setup.reals.bits, "mpmath")
        self._passes = setup.wide_passes

    def row(self, values: Any) -> Any:
        """Numbers of any kind as working ones."""
        return list(self._reals.row(values))

    def room(self, count: int) -> Any:
        """Room for so many."""
        return [self._reals.number(0)] * count

    def joined(self, parts: Any) -> Any:
        """Rows of working numbers one after the other."""
        return [x for part in parts for x in part]

    def floats(self, values: Any) -> np.ndarray:
        """Working numbers rounded to floats, shape (N,)."""
        return np.array([float(x) for x in values])

    def differences(self, first: Any, second: Any) -> np.ndarray:
        """Differences of working numbers, as floats."""
        with self._reals:
            return np.array([float(x - y) for x, y in zip(first, second, strict=True)])

    def mean(self, values: Any) -> Any:
        """(high, low) of the mean of 2^k working numbers."""
        with self._reals:
            mean = sum(values) / len(values)
            return float(mean), float(mean - float(mean))

    def direction(self, series: Any, roots: Any, f0: Any, reach: Any, axes: Any, nodes: Any, table: Any) -> None:
        """:func:`integrable.torus_kernel.direction`."""
        series, roots, axes, (f0, reach) = map(self.row, (series, roots, axes, (f0, reach)))
        with self._reals:
            torus_kernel.direction(series, roots, f0, axes, reach, nodes, self._passes, self.room(len(nodes)), table)

    def translation_by(self, f: Any, axes: Any, centres: Any, tables: Any, parts: Any, by: Any, out: Any) -> None:
        """:func:`integrable.torus_kernel.translation_by`."""
        with self._reals:
            torus_kernel.translation_by(f, axes, centres, tables, self.terms, parts, by[0], by[1], out)

    panel_values = staticmethod(torus_kernel.panel_values)

    def fill(self, *args: Any) -> None:
        """:func:`integrable.torus_kernel.fill`."""
        with self._reals:
            torus_kernel.fill(*args)

    def states_at_phases(self, rows: Any, sizes: Any, phases: Any, out: Any) -> None:
        """:func:`integrable.torus_kernel.states_at_phases`."""
        with self._reals:
            torus_kernel.states_at_phases((*rows, sizes), phases.tolist(), out)

    def states_at_tau(self, rows: Any, sizes: Any, frequencies: Any, tau: Any, out: Any) -> None:
        """:func:`integrable.torus_kernel.states_at_tau`."""
        with self._reals:
            torus_kernel.states_at_tau((*rows, sizes), frequencies, tau.tolist(), out)

    def states_at_times(
        self, rows: Any, sizes: Any, pace: Any, clock: Any, times: Any, tau: Any, delays: Any, out: Any, room: Any
    ) -> None:
        """:func:`integrable.torus_kernel.states_at_times`."""
        with self._reals:
            torus_kernel.states_at_times(
                (*rows, sizes), pace, _listed(clock), times.tolist(), tau, delays, out, room.tolist()
            )

    def times_at_tau(self, frequencies: Any, clock: Any, mean: Any, tau: Any, times: Any, room: Any) -> None:
        """:func:`integrable.torus_kernel.times_at_tau`."""
        with self._reals:
            torus_kernel.times_at_tau(frequencies, _listed(clock), mean[0], tau.tolist(), times, room.tolist())


class CompiledLoops:
    """The same compiled, on arrays of double-double numbers."""

    terms = 18
    noise = 1e-15

    def __init__(self) -> None:
        from integrable import torus_compiled

        self._loops = torus_compiled
        self.fill: Any = torus_compiled.fill
        self.states_at_phases: Any = torus_compiled.states_at_phases
        self.states_at_tau: Any = torus_compiled.states_at_tau
        self.states_at_times: Any = torus_compiled.states_at_times
        self.times_at_tau: Any = torus_compiled.times_at_tau
        self.panel_values: Any = torus_compiled.panel_values

    def row(self, values: Any) -> Any:
        return pack(np.array(list(values), dtype=object))

    def room(self, count: int) -> Any:
        return np.zeros((count, 2))

    def joined(self, parts: Any) -> Any:
        return np.concatenate(parts)

    def floats(self, values: Any) -> np.ndarray:
        return np.ascontiguousarray(values[:, 0])

    def differences(self, first: Any, second: Any) -> np.ndarray:
        # exact where they are close
        return (first[:, 0] - second[:, 0]) + (first[:, 1] - second[:, 1])

    def mean(self, values: Any) -> Any:
        parts = values.ravel().tolist()
        high = fsum(parts)
        return high / len(values), fsum([-high, *parts]) / len(values)

    def direction(self, series: Any, roots: Any, f0: Any, reach: Any, axes: Any, nodes: Any, table: Any) -> None:
        try:
            rows = [self.row(values) for values in (series, roots, (f0, reach), axes)]
        except ArgumentError as error:
            raise BeyondFloats(f"the translations of this motion are beyond the range of floats: {error}") from error
        self._loops.direction(
            *rows,
            np.array(nodes),
            NEWTON_PASSES,
            self.room(len(nodes)),
            table,
        )

    def translation_by(self, f: Any, axes: Any, centres: Any, tables: Any, parts: Any, by: Any, out: Any) -> None:
        self._loops.translation_by(f, axes, centres, tables, self.terms, parts, self.row(by), out)


def _listed(clock: Any) -> Any:
    """The clock's arrays as lists, which interpreted loops read faster."""
    return tuple(
        tuple(x.tolist() if isinstance(x, np.ndarray) else x for x in part) if isinstance(part, tuple) else part
        for part in clock
    )


class TorusFlow:
    """γ and M at any times of a motion, in the user's units, from a :class:`~integrable.flow_setup.Setup`.

    Raises PrecisionLoss where the torus is not compact, or needs too many cells or samples of 1/g.
    """

    def __init__(self, setup: Setup, loops: Any) -> None:
        self._setup = setup
        self._loops = loops
        self.lattice = lattice = TorusLattice(setup)
        row = loops.row
        self._f, self._axes = row(setup.wide_f), row(setup.wide_all_axes)
        self._unit_axes = row((*setup.wide_axes, 1, 1, 1, 1, 0))
        self._parts = row(
            part / reach for parts, reach in zip(lattice.parts, lattice.chart.reaches, strict=True) for part in parts
        )
        self._tables = self._translations()
        self.sizes = lattice.cells
        self.clock: TorusClock | None = None
        self._lengths: dict[str, float] = {}
        samples = self._fill()
        if samples is not None:
            self.clock = TorusClock(self, samples)

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,).

        Ascending times that are many to a panel of a Chebyshev series are read off such panels.
        """
        if not self.clock:
            return self.at_tau(times), times
        panels = self._panels(self._rows_at, times)
        if panels is None:
            rows, tau, _ = self.clock.at(times)
            return rows, tau
        rows = panels.at(times, self._loops.panel_values)
        return rows[:, :6], times / float(self.mean) + rows[:, 6]

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        return self.clock.times(tau) if self.clock else tau

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ, shape (N, 6)."""
        panels = self._panels(self._rows_at_tau, tau)
        return self._rows_at_tau(tau) if panels is None else panels.at(tau, self._loops.panel_values)

    def at_phases(self, phases: np.ndarray) -> np.ndarray:
        """γ and M at points of the torus, shape (N, 6): ``phases`` in turns from the start, shape (N, 2)."""
        out = np.empty(6 * len(phases))
        self._loops.states_at_phases(*self._torus, np.ascontiguousarray(phases, dtype=np.float64).ravel(), out)
        return out.reshape(-1, 6)

    def _panels(self, states: States, times: np.ndarray) -> Panels | None:
        """Panels for these times where they pay."""
        if len(times) < DENSE_FROM or not (np.diff(times) >= 0).all():
            return None
        start, end = float(times[0]), float(times[-1])
        if not start < end:
            return None
        length = self._panel_length(states, start, end)
        # so near that a rounded time is corrected for to first order
        near = np.spacing(max(abs(start), abs(end))) < 1e-9 * length
        if not near or len(times) < DENSE * NODES * (end - start) / length:
            return None
        try:
            return Panels(states, start, end, length)
        except PrecisionLoss:
            # passages too fast for panels; one by one they are as exact as ever
            return None

    def _panel_length(self, states: States, start: float, end: float) -> float:
        kind = states.__name__
        if kind not in self._lengths or end - start < self._lengths[kind]:
            self._lengths[kind] = panel_length(
                states, start, end, float(self._setup.step_length / self._setup.clock) / 8
            )
        return min(self._lengths[kind], end - start)

    def _rows_at(self, times: np.ndarray) -> np.ndarray:
        """γ, M and τ − t/mean, shape (N, 7)."""
        assert self.clock
        rows, _, delays = self.clock.at(times)
        return np.column_stack([rows, delays])

    def _rows_at_tau(self, tau: np.ndarray) -> np.ndarray:
        out = np.empty(6 * len(tau))
        self._check(tau, self.frequencies)
        self._loops.states_at_tau(*self._torus, self._frequency_row, tau, out)
        return out.reshape(-1, 6)

    @cached_property
    def frequencies(self) -> tuple[Any, Any]:
        """Turns of either phase in a unit of τ, wide."""
        nu1, nu2 = self.lattice.frequencies
        return nu1 * self._setup.clock, nu2 * self._setup.clock

    def _check(self, times: np.ndarray, rates: Any) -> None:
        turns = np.abs(times).max(initial=0) * max(abs(float(x)) for x in rates)
        if turns > MOST_TURNS:
            raise PrecisionLoss(
                f"time {np.abs(times).max()}: {turns:.1e} turns of a phase are more than the {MOST_TURNS:.1e} whose "
                "fractions double-double numbers hold; use more digits"
            )

    # --- set-up

    @cached_property
    def _frequency_row(self) -> Any:
        return self._loops.row(self.frequencies)

    @cached_property
    def _torus(self) -> tuple[Any, Any]:
        """The rows and sizes that the loops take."""
        setup, loops = self._setup, self._loops
        a, b, c, d = (1, 0, 0, 1) if setup.tilt is None else setup.tilt.inverse_matrix()
        matrix = loops.row((a, b * setup.wide_momentum, c, d * setup.wide_momentum))
        turns = tuple(float(x) for row in self.turns for x in row)
        rows = (self._f, self._axes, matrix, self._states, self._tables, self._parts, self.lattice.chart.centres, turns)
        return rows, (*self.sizes, self._loops.terms)

    def _translations(self) -> Any:
        """The tables of both directions, one after the other."""
        setup, loops, K = self._setup, self._loops, self._setup.wide
        # Chebyshev nodes in z = (s/reach)²: whatever floats they are
        nodes = [(1 + cos(pi * (k + 0.5) / loops.terms)) / 2 for k in range(loops.terms)]
        tables = []
        for centre, reach in zip(self.lattice.chart.centres, self.lattice.chart.reaches, strict=True):
            x0 = K.coerce(centre)
            f = poly.shift(K, setup.wide_f, x0)
            table = loops.room(4 * loops.terms)
            axes = [a - x0 for a in setup.wide_all_axes[:3]]
            series = [setup.wide_series(f, power) for power in (-1, 1)]
            loops.direction(*series, f[0], reach, axes, nodes, table)
            tables.append(table)
        return loops.joined(tables)

    def _steps(self, direction: int, count: int) -> Any:
        """Translations that make 1/count of a period, count at least the number of cells."""
        loops = self._loops
        # half a cell is within reach
        halves = 2 if count < 2 * self.sizes[direction] else 1
        by = [0.0, 0.0]
        by[direction] = 1 / (count * halves)
        found = loops.room(30)
        loops.translation_by(self._f, self._unit_axes, self.lattice.chart.centres, self._tables, self._parts, by, found)
        # the sum of both parts where it is not much worse conditioned than they are
        whole = conditioning(loops.floats(found[20:])) > LEAST_CONDITION
        step = found[20:] if whole else found[:20]
        return step if halves == 1 else loops.joined([step, step])

    def _fill(self) -> np.ndarray | None:
        """Make the corners of the cells; the samples of 1/g on a grid that resolves it, None where g = 1."""
        loops = self._loops
        if self._setup.wide_d == 0:
            self._walk(self.sizes, False)
            return None
        sizes = (max(16, 2 * self.sizes[0]), max(16, 2 * self.sizes[1]))
        while sizes[0] * sizes[1] <= MOST_SAMPLES:
            samples = self._walk(sizes, True)
            wanted = needed_sizes(samples, loops.noise, ALIAS)
            if wanted == samples.shape:
                return samples
            sizes = (sizes[0] * wanted[0] // samples.shape[0], sizes[1] * wanted[1] // samples.shape[1])
        raise PrecisionLoss(f"1/g needs a grid of {sizes[0]} × {sizes[1]} on the torus of this motion")

    def _walk(self, sizes: tuple[int, ...], rates: bool) -> Any:
        loops, cells = self._loops, self.sizes
        every = tuple(n // m for n, m in zip(sizes, cells, strict=True))
        size = sizes[0] * sizes[1] if rates else 0
        self._states, first, other, ends = map(loops.room, (10 * cells[0] * cells[1], size, size, 20))
        start = loops.row(self._setup.wide_start)
        steps = [self._steps(k, n) for k, n in enumerate(sizes)]
        loops.fill(self._f, self._axes, start, *steps, sizes, every, self._states, first, other, ends)
        begin, over = loops.floats(start), loops.floats(ends).reshape(2, 10)
        gaps = np.array([loops.differences(ends[10 * k : 10 * k + 10], start)[:4] for k in range(2)])
        self.closure = float(np.abs(gaps).max() / np.abs(begin[:4]).max())
        # σ_i and ν_i are not zero together
        self.turns = [[1 if x > 0 else -1 for x in row[4:7] * begin[4:7] + row[7:] * begin[7:]] for row in over]
        if not rates:
            return None
        mean = self._wide_sum(loops.mean(first))
        table = loops.floats(first).reshape(sizes)
        odd = [np.prod(row) < 0 for row in self.turns]
        self.doubled = (1, 1)
        if self._setup.tilt is not None and any(odd):
            # an odd number of turned γ_i is noticed by 1/g, whose period is then twice that of the divisor
            beside = loops.floats(other).reshape(sizes)
            mean = (mean + self._wide_sum(loops.mean(other))) / 2
            self.doubled = (2 if odd[0] else 1, 2 if odd[1] else 1)
            blocks = [
                [beside if (i * odd[0] + j * odd[1]) % 2 else table for j in range(self.doubled[1])]
                for i in range(self.doubled[0])
            ]
            table = np.block(blocks)
        self.mean = mean
        return table

    def _wide_sum(self, parts: tuple[float, float]) -> Any:
        high, low = map(self._setup.wide.coerce, parts)
        return high + low


class TorusClock:
    """t(τ) and τ(t) of a TorusFlow, in the user's units."""

    def __init__(self, flow: TorusFlow, samples: np.ndarray) -> None:
        self._flow = flow
        self.mean = flow.mean
        nu = flow.frequencies
        rates = tuple(x / n for x, n in zip(nu, flow.doubled, strict=True))
        series = TorusSeries(samples, (rates[0], rates[1]), float(self.mean), max(flow.closure, flow._loops.noise / 16))
        # the kernels count phases in periods of 1/g
        self._clock = (flow.doubled, series.packed(ROUGH), series.packed())
        count = max(part[5][1] for part in self._clock[1:])
        self._room = 2 * count
        row = flow._loops.row
        self._mean_row = row((self.mean,))
        self.pace = tuple(x / self.mean for x in nu)
        self._pace_row = row((*self.pace, *nu, 1 / self.mean))

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(γ and M, τ, τ − t·mean dτ/dt) at physical times, shapes (N, 6), (N,) and (N,)."""
        flow = self._flow
        flow._check(times, self.pace)
        out, tau, delays = np.empty(6 * len(times)), np.empty(len(times)), np.empty(len(times))
        flow._loops.states_at_times(
            *flow._torus, self._pace_row, self._clock, times, tau, delays, out, np.empty(self._room)
        )
        return out.reshape(-1, 6), tau, delays

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        flow = self._flow
        flow._check(tau, flow.frequencies)
        times = np.empty(len(tau))
        flow._loops.times_at_tau(flow._frequency_row, self._clock, self._mean_row, tau, times, np.empty(self._room))
        return times
