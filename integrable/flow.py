"""The exact flow: time is addition on the Jacobian.

D(τ + δ) = D(τ) + T(δ), with T(δ) independent of where the motion is (Tsiganov's Abel quadratures; formulas.md, section
3). The translations by about 2^k basic steps are made once, in extended precision, so that any τ is reached in about
as many additions as it has binary digits. Physical time t = ∫dτ/g comes from a Fourier series on the torus of the
motion (:mod:`integrable.torus`), or where that does not pay or degenerates from the steps (:mod:`integrable.clock`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from integrable import flow_kernel
from integrable.clock import Backend, Clock, compiled_backend
from integrable.flow_setup import Setup
from integrable.trajectory import Trajectory
from jacobian import RR
from jacobian.errors import ArgumentError, PrecisionLoss

if TYPE_CHECKING:
    from integrable.state import State
    from integrable.systems.system import System
    from integrable.torus import TorusClock

KERNELS = ("auto", "python", "compiled")
# an interpreted addition costs about 20 µs: from this many on, loading or making the compiled loops pays
COMPILE_FROM = 100_000
# from this many basic steps on, samples on the torus are cheaper than stepping there
TORUS_FROM = 256


class Flow:
    """The motion through one state. Get one from ``system.flow(state)``.

    ``kernel``: "python" is the readable loop, "compiled" the same source through numba (floats only), "auto" chooses by
    the amount of work. Set-up is done here, once; :meth:`at` and :meth:`at_tau` may be called any number of times.
    """

    def __init__(self, system: System, state: State, kernel: str = "auto") -> None:
        if kernel not in KERNELS:
            raise ArgumentError(f"kernel = {kernel!r}: choose one of {', '.join(map(repr, KERNELS))}")
        if kernel == "compiled" and system.field != RR:
            raise ArgumentError(
                f"kernel = 'compiled' with field = {system.field.name}: compiled loops exist for RR only"
            )
        self.system = system
        self.state = state
        self.kernel = kernel
        if state.tilted:
            # M ∥ γ is refused in the precision of the state
            system.upright(state)
        self.setup = Setup(system.body, state.gamma, state.M, state.tilted)
        self._clocks = {sign: Clock(self, sign) for sign in (1, -1)} if system.body.rolls else {}
        self._torus_clock: Any = None

    def at(self, times: Any) -> Trajectory:
        """The states at physical times t, in any order, of any sign and size: a Trajectory of shape (N,)."""
        given = self._checked(times, "times")
        if not self._clocks:
            return Trajectory(self, given, given, self._at_scaled(self._scaled(given)))
        scaled = self._scaled(given)
        torus = self._torus(scaled)
        if torus:
            tau = torus.tau(scaled)
            return Trajectory(self, given, self._unscaled(tau), self._at_scaled(tau))
        points, halves = self._rows(len(given)), self._rows(len(given), 0)
        for sign, chosen in _by_sign(scaled):
            clock = self._clocks[sign]
            high, low = (list(part) for part in zip(*(self.setup.split(abs(scaled[i])) for i in chosen), strict=True))
            clock.extend(max(high))
            points[chosen], offsets = clock.states(high, low)
            halves[chosen] = sign * offsets
        return Trajectory(self, given, self._unscaled(halves * self.setup.half_step), self._trusted(points))

    def at_tau(self, tau: Any) -> Trajectory:
        """The states at values of the flow's own time τ, dτ = g dt (τ = t for the Euler top)."""
        given = self._checked(tau, "tau")
        return Trajectory(self, None if self._clocks else given, given, self._at_scaled(self._scaled(given)))

    def physical_time(self, tau: Any) -> np.ndarray:
        """t(τ) = ∫_0^τ dτ/g for an array of τ."""
        given = self._checked(tau, "tau")
        if not self._clocks:
            return given
        scaled = self._scaled(given)
        torus = self._torus(scaled)
        if torus:
            return self._unscaled([torus.time(t) for t in scaled])
        times = self._rows(len(given), 0)
        for sign, chosen in _by_sign(scaled):
            steps, offsets = self._steps([scaled[i] for i in chosen])
            clock = self._clocks[sign]
            clock.extend_to_step(max(steps) + 1)
            times[chosen] = [sign * clock.time(step, x) for step, x in zip(steps, offsets, strict=True)]
        return self._unscaled(times)

    def residual_growth(self, counts: Any) -> list[tuple[int, Any]]:
        """(n, |f − V² mod U| over its scale) after n successive additions of one basic step, for n in ``counts``."""
        backend = self._backend(max(counts))
        setup = self.setup
        step = setup.table(1, 1)[1][0]
        f, axes, point, step = (backend.pack(x) for x in (setup.f, setup.axes, setup.start, step))
        rows, done = [], 0
        for count in sorted(counts):
            point = backend.loops.march(f, axes, point, step, count - done)
            done = count
            rows.append((count, residual(setup.f, point)))
        return rows

    # --- inside
    # -----------------------------------------------------------------------------------------------------------------

    def _torus(self, scaled: list[Any]) -> TorusClock | None:
        """The clock on the torus, once times are far enough for it to pay; None where the torus degenerates."""
        if max(map(abs, scaled), default=0) < TORUS_FROM * self.setup.step_length:
            return None
        if self._torus_clock is None:
            from integrable.torus import TorusClock

            try:
                self._torus_clock = TorusClock(self.setup)
            except PrecisionLoss:
                self._torus_clock = False
        return self._torus_clock or None

    def _at_scaled(self, scaled: list[Any]) -> np.ndarray:
        points = self._rows(len(scaled))
        for sign, chosen in _by_sign(scaled):
            steps, offsets = self._steps([scaled[i] for i in chosen])
            points[chosen] = self.states_at(sign, steps, offsets)
        return self._trusted(points)

    def states_at(self, sign: int, steps: list[int], offsets: list[Any]) -> np.ndarray:
        """The moving points ``offsets`` half steps beyond ``steps`` basic steps."""
        backend, out = self._backend(8 * len(steps)), self._rows(len(steps))
        setup = self.setup
        counts, table = setup.table(sign, max(steps))
        f, axes, start, series, roots = map(backend.pack, (setup.f, setup.axes, setup.start, setup.series, setup.roots))
        backend.loops.states_at_offsets(
            f,
            axes,
            start,
            backend.counts(counts),
            backend.pack(table),
            series,
            roots,
            setup.half_step,
            setup.passes,
            sign,
            backend.counts(steps),
            backend.pack(offsets),
            out,
        )
        return out

    def _steps(self, scaled: list[Any]) -> tuple[list[int], list[Any]]:
        """Whole steps and half-step offsets in [−1, 1] of |τ|, divided in the wide precision."""
        setup, steps, offsets = self.setup, [], []
        for tau in scaled:
            turns = abs(tau) / setup.step_length
            whole = int(setup.wide.context.nint(turns))
            steps.append(whole)
            offsets.append(setup.number(2 * (turns - whole)))
        return steps, offsets

    def _scaled(self, times: np.ndarray) -> list[Any]:
        """Times in the flow's units, in the wide precision."""
        coerce, clock = self.setup.wide.coerce, self.setup.clock
        return [coerce(t) * clock for t in times]

    def _unscaled(self, times: Any) -> np.ndarray:
        result = self._rows(len(times), 0)
        result[:] = [self.setup.unscaled(t) for t in times]
        return result

    def _checked(self, values: Any, argument: str) -> np.ndarray:
        """A one-dimensional array of finite numbers."""
        field = self.system.field
        if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__"):
            values = [values]
        items = [field.coerce(value, f"{argument}[{i}]") for i, value in enumerate(values)]
        return np.array(items, dtype=np.float64 if field == RR else object)

    def _rows(self, count: int, width: int = 10) -> np.ndarray:
        shape = (count, width) if width else (count,)
        return np.empty(shape, dtype=np.float64 if self.setup.work is RR else object)

    def _trusted(self, points: np.ndarray) -> np.ndarray:
        """The points, once their integrals have been compared with those of the start: PrecisionLoss where they differ.

        Near a separatrix and on bodies beyond this precision an addition can lose every digit; it then leaves the
        level set.
        """
        setup = self.setup
        drift = integrals_drift(setup, points)
        bound = max(1e-6, setup.work.eps**0.4) if setup.work is RR else setup.work.eps**0.4
        with np.errstate(invalid="ignore"):
            wrong = np.flatnonzero(~np.array(drift <= bound, dtype=bool))
        if len(wrong):
            row = int(wrong[0])
            raise PrecisionLoss(
                f"row {row}: H1 and H2 are off by {float(drift[row]):.1e} of their size: the motion there is beyond "
                f"{self.system.field.name}; use more digits"
            )
        return points

    def _backend(self, additions: int) -> Backend:
        if self.setup.work is RR and (
            self.kernel == "compiled" or (self.kernel == "auto" and additions >= COMPILE_FROM)
        ):
            return compiled_backend()
        return Backend(flow_kernel, lambda rows: rows, list, list)


def integrals_drift(setup: Setup, points: np.ndarray) -> np.ndarray:
    """The relative change of H1 and H2 (the larger) at every moving point, shape (N,)."""
    sigma, nu = points[:, 4:7], points[:, 7:10]
    square = np.sum(sigma * sigma, axis=1)
    w = nu - (np.sum(sigma * nu, axis=1) / square)[:, None] * sigma
    gamma = sigma / (square**0.5)[:, None]
    i, j = [1, 2, 0], [2, 0, 1]
    M = w[:, i] * gamma[:, j] - w[:, j] * gamma[:, i]
    alpha = np.array(setup.axes[:3])
    lean = np.sum(alpha * M * gamma, axis=1)
    h2 = np.sum(M * M, axis=1)
    h1 = np.sum(alpha * M * M, axis=1) + setup.number(setup.wide_d) * square * lean * lean
    return np.maximum(abs(h2 - 1), abs(h1 / setup.number(setup.ratio) - 1))


def residual(f: Any, point: Any) -> Any:
    """|f − V² mod U| over the size of f, for a moving point."""
    u0, u1, v0, v1 = point[:4]
    rest = [f[0] - v0 * v0, f[1] - 2 * v0 * v1, f[2] - v1 * v1, f[3], f[4], f[5]]
    for k in range(5, 1, -1):
        rest[k - 1] -= u1 * rest[k]
        rest[k - 2] -= u0 * rest[k]
    return max(abs(rest[0]), abs(rest[1])) / max(abs(c) for c in f)


def _by_sign(values: list[Any]) -> list[tuple[int, np.ndarray]]:
    negative = np.array([bool(t < 0) for t in values], dtype=bool)
    groups = ((1, np.flatnonzero(~negative)), (-1, np.flatnonzero(negative)))
    return [(sign, chosen) for sign, chosen in groups if len(chosen)]
