"""Random access to a motion: any τ and any t by the same two additions from the nearest corner of a cell of the torus.

The moving points at the corners are made once; a time of the flow is two phases, its whole turns are signs, and what is
left inside a cell is T(s₁, c₁s₁) + T(s₂, c₂s₂) with T a power series. Compiled, all this is done in double-double
numbers and rounded once, so that no error grows with the time; interpreted, with
more digits. Physical time t = ∫dτ/g is a mean rate and a Fourier series on the torus, inverted by Newton (Fedorov 2009
gives the same functions as theta functions).
"""

from __future__ import annotations

from functools import cached_property
from math import cos, pi
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.torus.lattice import TorusLattice, Units, motion_row
from integrable.torus.loops import CompiledLoops, NotClosed
from integrable.torus.panels import NODES, Panels, States, panel_length
from integrable.torus.series import TorusSeries, long_double, needed_sizes, spectrum
from integrable.torus.survey import about_centre
from integrable.torus.witness import confirmed
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup

# more turns of a phase than this leave no digits of a float behind
MOST_TURNS = 2.0**50
MOST_SAMPLES = 1 << 18
# coefficients of 1/g below this part of its mean are left out of the series that Newton starts with
ROUGH = 1e-4
# modes by which τ swings this much, in units in which the body turns by some part of a radian, are summed in
# double-double numbers: so many at most
LOUD = 0.05
MOST_LOUD = 8
# a direction of the torus is resolved to this part of its frequency, but not beyond what the long doubles of this
# machine hold
SLOW = 1e-13
EXTENDED = 32 * float(np.finfo(np.longdouble).eps)
# slow modes swing τ by less than this, in the same units, or are kept however small they are in 1/g
LEAST_SWING = 1e-17
# a walk over the corners of the torus is trusted where periods lead back to this, one from both sides to that
ROUND = 1e-17
CLOSED = 1e-13
# a moving point's divisor, σ and ν
PARTS = (slice(4), slice(4, 7), slice(7, 10))
# corners are walked over in steps of fewer cells than this
MOST_AT_ONCE = 7
# ascending times from this many on, and so many to a node, are read off panels
DENSE_FROM = 5000
DENSE = 3


class TorusFlow:
    """γ and M at any times of a motion, in the user's units, from a :class:`~integrable.moving_point.setup.Setup`.

    Raises PrecisionLoss where the torus is not compact, or needs too many cells or samples of 1/g (more than ``most``),
    NotClosed where the loops lose too many digits or a sign (:mod:`integrable.torus.witness`).
    """

    way = "torus"

    def __init__(self, setup: Setup, loops: Any, most: int = MOST_SAMPLES) -> None:
        self._setup = setup
        self._loops = loops
        self._most = most
        row = loops.row
        # the motion in an abscissa of its own
        self.units = units = Units.of(setup)
        motion = motion_row(setup, units)
        self._motion = row(motion)
        self.lattice = TorusLattice(setup, loops, self._motion)
        curve = [setup.wide.zero] * 9
        about_centre(motion, setup.wide.zero, setup.wide.one, curve)
        axes, (*kappas, alpha, beta) = curve[6:], setup.problem.axes[3:]
        kappas = [kappa / (units.length * units.length) for kappa in kappas]
        self._f, self._start = row(curve[:6]), row(units.of_point(setup.problem.start))
        self._axes, self._unit_axes = row((*axes, *kappas, alpha, beta * units.time)), row((*axes, 1, 1, 1, 1, 0))
        self._tables, self._halves = self._translations()
        self.sizes, self.turns = self.lattice.cells, self.lattice.turns
        self.clock: TorusClock | None = None
        self._lengths: dict[str, float] = {}
        if self.sizes[0] * self.sizes[1] > most:
            raise PrecisionLoss(f"the torus of this motion needs {self.sizes[0]} × {self.sizes[1]} cells")
        self._corners()
        if not confirmed(setup, self.frequencies, self._rows_at_tau):
            raise NotClosed("the torus of this motion does not lead where its translations do; use more digits")
        if setup.problem.d != 0:
            self.clock = TorusClock(self, self._rates())

    @property
    def compiled(self) -> bool:
        """Whether a state costs microseconds; interpreted, a thousand times as much."""
        return isinstance(self._loops, CompiledLoops)

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
                states, start, end, float(self._setup.step_length / self._setup.time_scale) / 8
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
        nu1, nu2 = self._loops.wide(self.lattice.frequencies, self._setup.wide)
        scale = self._setup.time_scale * self.units.time
        return nu1 * scale, nu2 * scale

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
        momentum = setup.problem.momentum * self.units.lift
        matrix = loops.row((a, b * momentum, c, d * momentum))
        turns = tuple(self.turns.ravel().tolist())
        parts, centres = self.lattice.parts, self.lattice.chart.centres
        rows = (self._f, self._axes, matrix, self._states, self._tables, parts, centres, turns)
        return rows, (*self.sizes, self._loops.terms)

    def _translations(self) -> tuple[Any, Any]:
        """The tables of both directions, one after the other, and the translations by half a cell."""
        loops = self._loops
        # Chebyshev nodes in z = (s/reach)²: whatever floats they are
        nodes = [(1 + cos(pi * (k + 0.5) / loops.terms)) / 2 for k in range(loops.terms)]
        tables, halves = loops.room(8 * loops.terms), loops.room(40)
        chart = self.lattice.chart
        given = (chart.centres, chart.reaches, chart.cells)
        loops.directions(self._motion, given, self.lattice.parts, nodes, tables, halves)
        return tables, halves

    def _corners(self) -> None:
        """Walk over the corners of the cells; NotClosed where the walks do not lead back."""
        columns = self.sizes[1]
        self._walk(columns, MOST_AT_ONCE)
        if not self.closure <= ROUND:
            # near the separatrix a walk towards the unstable rotation forgets its errors, one away from it multiplies
            # them: both ways to where the motion comes nearest to it
            rows = self._loops.floats(self._states).reshape(*self.sizes, 10)
            with np.errstate(divide="ignore"):
                nearness = np.log(np.abs(rows[0, :, 0]))
            width = columns // 8
            around = [np.roll(nearness, n) for n in range(-width, width + 1)]
            self._walk(max(1, int(np.argmin(np.maximum.reduce(around)))), 1)
        if not self.closure <= CLOSED:
            raise NotClosed(f"a period of this motion leads back to {self.closure:.1e} only; use more digits")

    def _walk(self, forward: int, most: int) -> None:
        loops, cells = self._loops, self.sizes
        ends, known = loops.room(10 * (cells[0] + 1)), loops.room(10 * (cells[0] + 1))
        self._states = loops.room(10 * cells[0] * cells[1])
        loops.corners(
            self._f, self._axes, self._unit_axes, self._start, cells, forward, most, self._halves, loops.room(40),
            self._states, ends, known, self.turns.ravel(),
        )  # fmt: skip
        gaps = np.abs(loops.differences(ends, known)).reshape(-1, 10)
        sizes = np.abs(loops.floats(self._start))
        # the pairs with the divisor: no divisor has their signs, nor what turns where two moments are equal
        self.closure = max(float(gaps[:, part].max() / sizes[part].max()) for part in PARTS)

    def _rates(self) -> np.ndarray:
        """The spectrum of 1/g, on a grid of its periods that resolves it."""
        sizes = (max(16, self.sizes[0]), max(16, self.sizes[1]))
        # in slow directions to more digits: they will be divided by its frequency
        slow = [SLOW * abs(float(nu / self._setup.time_scale)) for nu in self.frequencies]
        noise = tuple(min(self._loops.noise, max(EXTENDED, x)) for x in slow)
        while sizes[0] * sizes[1] <= self._most:
            grid = spectrum(self._sampled(sizes))
            wanted = needed_sizes(grid, (noise[0], noise[1]))
            if wanted == grid.shape:
                return grid
            sizes = (sizes[0] * wanted[0] // grid.shape[0], sizes[1] * wanted[1] // grid.shape[1])
        raise PrecisionLoss(f"1/g needs a grid of {sizes[0]} × {sizes[1]} on the torus of this motion")

    @property
    def _small_steps(self) -> tuple[Any, ...]:
        """What translations inside a cell are made from."""
        return self.lattice.chart.centres, self._tables, self._loops.terms, self.lattice.parts

    def _sampled(self, sizes: tuple[int, int]) -> np.ndarray:
        """1/g on a grid of its periods that has ``sizes`` points to those of the divisor."""
        loops, cells = self._loops, self.sizes
        finer = sizes[0] // cells[0], sizes[1] // cells[1]
        steps, counts = loops.room(20 * finer[0] * finer[1]), np.zeros(finer[0] * finer[1], dtype=np.int64)
        loops.offsets(self._f, self._unit_axes, *self._small_steps, cells, finer, steps, counts)
        odd = tuple(bool(np.prod(row) < 0) for row in self.turns)
        first, other = loops.room(sizes[0] * sizes[1]), loops.room(sizes[0] * sizes[1])
        loops.sampled(self._f, self._axes, self._states, cells, finer, odd, steps, counts, first, other)
        table: np.ndarray = loops.long_doubles(first).reshape(sizes)
        self.doubled = (1, 1)
        if self._setup.tilt is None:
            return table
        beside = loops.long_doubles(other).reshape(sizes)
        # an odd number of turned γ_i is noticed by 1/g, whose period is then twice that of the divisor
        self.doubled = (2 if odd[0] else 1, 2 if odd[1] else 1)
        blocks = [
            [beside if (i * odd[0] + j * odd[1]) % 2 else table for j in range(self.doubled[1])]
            for i in range(self.doubled[0])
        ]
        return np.block(blocks)

    @cached_property
    def mean(self) -> Any:
        """The mean of 1/g over the torus, wide: a determinant of elliptic integrals, whatever the samples are.

        That of a tilted body has no part from its lean: around an oval with one axis an odd number of γ_i are turned.
        """
        setup, K = self._setup, self._setup.wide
        d, (u0, u1), sigma = setup.problem.d, setup.problem.start[:2], setup.problem.start[4:7]
        slowness = self._loops.wide(self.lattice.slowness, K)[0] / self.units.lift**2
        # g² is a multiple of (1 − du₁)(1 − du₂)
        scale = K.sqrt((1 + d * (u1 + d * u0)) / K.dot(sigma, sigma))
        return setup.problem.axes[6] * scale * slowness


class TorusClock:
    """t(τ) and τ(t) of a TorusFlow, in the user's units."""

    def __init__(self, flow: TorusFlow, rates: np.ndarray) -> None:
        self._flow = flow
        self.mean = flow.mean
        nu = flow.frequencies
        first, second = (x / n for x, n in zip(nu, flow.doubled, strict=True))
        noise, least = max(flow.closure, flow._loops.noise / 64), LEAST_SWING / float(flow._setup.time_scale)
        series = TorusSeries(rates, (first, second), long_double(self.mean), noise, least)
        # the kernels count phases in periods of 1/g
        row, wide = flow._loops.row, flow._setup.wide
        self._modes, coefficients = series.loudest(LOUD / float(flow._setup.time_scale), MOST_LOUD)
        origin = -sum(coefficients[::2])
        numbers = [wide.coerce(float(x)) + wide.coerce(float(x - float(x))) for x in (origin, *coefficients)]
        self._loud = row((numbers[0], 2 * wide.context.pi, *numbers[1:]))
        packed = series.packed()
        quiet = series.packed(without=self._modes) if len(self._modes) else packed
        self._clock = (flow.doubled, series.packed(ROUGH), packed, quiet)
        count = max(part[5][1] for part in self._clock[1:])
        self._room = 2 * count
        self._mean_row = row((self.mean,))
        self.pace = tuple(x / self.mean for x in nu)
        self._pace_row = row((*self.pace, *nu, 1 / self.mean))

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(γ and M, τ, τ − t·mean dτ/dt) at physical times, shapes (N, 6), (N,) and (N,)."""
        flow = self._flow
        flow._check(times, self.pace)
        out, tau, delays = np.empty(6 * len(times)), np.empty(len(times)), np.empty(len(times))
        flow._loops.states_at_times(
            *flow._torus, self._pace_row, self._clock, self._modes, self._loud, times, tau, delays, out,
            np.empty(self._room),
        )  # fmt: skip
        return out.reshape(-1, 6), tau, delays

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        flow = self._flow
        flow._check(tau, flow.frequencies)
        times = np.empty(len(tau))
        flow._loops.times_at_tau(flow._frequency_row, self._clock, self._mean_row, tau, times, np.empty(self._room))
        return times
