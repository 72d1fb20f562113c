"""The exact flow: time is addition on the Jacobian.

D(τ + δ) = D(τ) + T(δ), with T(δ) independent of where the motion is (Tsiganov's Abel quadratures; formulas.md, section
3). The translations by 2^k basic steps are made once, in extended precision, so that any τ is reached in as many
additions as it has binary digits. Physical time is t = ∫dτ/g along the same additions: Gauss–Legendre nodes around
every basic step, whose values are a Legendre series for 1/g.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from integrable import flow_kernel
from integrable.flow_setup import NODE_COUNTS, Quadrature, Setup
from integrable.trajectory import Trajectory
from jacobian import RR
from jacobian.errors import ArgumentError, PrecisionLoss

if TYPE_CHECKING:
    from integrable.state import State
    from integrable.systems.system import System

KERNELS = ("auto", "python", "compiled")
# an interpreted addition costs about 20 µs: from this many on, loading or making the compiled loops pays
COMPILE_FROM = 100_000
FIRST_STEPS = 64
MOST_STEPS = 50_000_000


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
        self.setup = Setup(system.body, state.gamma, state.M)
        self._clocks = {sign: Clock(self, sign) for sign in (1, -1)} if system.body.rolls else {}

    def at(self, times: Any) -> Trajectory:
        """The states at physical times t, in any order, of any sign and size: a Trajectory of shape (N,)."""
        given = self._checked(times, "times")
        if not self._clocks:
            return Trajectory(self, given, given, self._at_tau(given))
        points, tau = self._rows(len(given)), self._rows(len(given), 0)
        for sign, chosen in _by_sign(given):
            clock = self._clocks[sign]
            high, low = self._scaled(given[chosen], sign)
            clock.extend(max(high))
            found, offsets = clock.states(high, low)
            points[chosen] = found
            half = self.setup.half_step
            tau[chosen] = [sign * self.setup.unscaled(x * half) for x in offsets]
        return Trajectory(self, given, tau, self._finite(points))

    def at_tau(self, tau: Any) -> Trajectory:
        """The states at values of the flow's own time τ, dτ = g dt (τ = t for the Euler top)."""
        given = self._checked(tau, "tau")
        return Trajectory(self, None if self._clocks else given, given, self._at_tau(given))

    def physical_time(self, tau: np.ndarray) -> np.ndarray:
        """t(τ) = ∫_0^τ dτ/g for an array of τ."""
        given = self._checked(tau, "tau")
        if not self._clocks:
            return given
        times = self._rows(len(given), 0)
        for sign, chosen in _by_sign(given):
            steps, offsets = self._steps(given[chosen], sign)
            clock = self._clocks[sign]
            clock.extend_to_step(max(steps) + 1)
            times[chosen] = [
                sign * self.setup.unscaled(clock.time(step, offset))
                for step, offset in zip(steps, offsets, strict=True)
            ]
        return times

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

    def _at_tau(self, given: np.ndarray) -> np.ndarray:
        points = self._rows(len(given))
        for sign, chosen in _by_sign(given):
            steps, offsets = self._steps(given[chosen], sign)
            points[chosen] = self.states_at(sign, steps, offsets)
        return self._finite(points)

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

    def _steps(self, tau: np.ndarray, sign: int) -> tuple[list[int], list[Any]]:
        """Whole steps and half-step offsets in [−1, 1] of |τ|, divided in the wide precision."""
        setup, steps, offsets = self.setup, [], []
        for t in tau:
            turns = abs(setup.wide.coerce(t)) * setup.clock / setup.step_length
            whole = int(setup.wide.context.nint(turns))
            steps.append(whole)
            offsets.append(setup.number(2 * (turns - whole)))
        return steps, offsets

    def _scaled(self, times: np.ndarray, sign: int) -> tuple[list[Any], list[Any]]:
        pairs = [self.setup.scaled(abs(t)) for t in times]
        return [high for high, _ in pairs], [low for _, low in pairs]

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

    def _finite(self, points: np.ndarray) -> np.ndarray:
        if self.setup.work is RR and not np.isfinite(points).all():
            row = int(np.argmin(np.isfinite(points).all(axis=1)))
            raise PrecisionLoss(
                f"row {row}: the addition met a special position that {self.system.field.name} cannot resolve"
            )
        return points

    def _backend(self, additions: int) -> Backend:
        if self.setup.work is RR and (
            self.kernel == "compiled" or (self.kernel == "auto" and additions >= COMPILE_FROM)
        ):
            return compiled_backend()
        return Backend(flow_kernel, lambda rows: rows, list, list)


class Backend:
    """One set of loops and the containers that they take."""

    def __init__(self, loops: Any, pack: Any, counts: Any, scratch: Any) -> None:
        self.loops = loops
        self.pack = pack
        self.counts = counts
        self.scratch = scratch


def compiled_backend() -> Backend:
    """The loops compiled by numba, on float64 arrays."""
    from integrable import flow_compiled

    def pack(rows: Any) -> np.ndarray:
        return np.ascontiguousarray(rows, dtype=np.float64)

    return Backend(flow_compiled, pack, lambda steps: np.array(steps, dtype=np.int64), pack)


class Clock:
    """Physical time at the basic steps of a flow, in one direction, grown as far as it is asked for."""

    def __init__(self, flow: Flow, sign: int) -> None:
        self._flow = flow
        self._sign = sign
        setup = flow.setup
        zero = 0 * setup.start[0]
        self.high = np.array([zero])
        self.low = np.array([zero])
        self._carry: list[Any] | None = None
        self._stack: list[list[Any]] = []
        self._ends: list[int] = []
        self._rule: Quadrature | None = None

    def extend(self, until: Any) -> None:
        """Make the steps reach beyond the (scaled) time ``until``."""
        self.extend_to_step(FIRST_STEPS if self._flow.setup.work is RR else 4)
        while self.high[-1] <= until:
            # the mean rate is known by now to a few per cent
            known = len(self.high) - 1
            missing = float((until - self.high[-1]) / self.high[-1]) * known
            self.extend_to_step(known + int(1.02 * missing) + 2)

    def extend_to_step(self, last: int) -> None:
        """Make the steps reach ``last``."""
        count = last + 1 - len(self.high)
        if count <= 0:
            return
        if last > MOST_STEPS:
            raise ArgumentError(
                f"times: {last} basic steps are more than the {MOST_STEPS} that a clock in memory is made for"
            )
        rule, setup = self.rule, self._flow.setup
        backend = self._flow._backend(count * (1 + len(rule.nodes)))
        counts, table = setup.table(self._sign, last)
        self._start(rule, counts)
        high, low = np.empty(count, dtype=self.high.dtype), np.empty(count, dtype=self.low.dtype)
        stack, ends, carry = backend.scratch(self._stack), backend.counts(self._ends), backend.scratch(self._carry)
        f, axes, left, right = map(backend.pack, (setup.f, setup.axes, rule.left, rule.right))
        backend.loops.wind(
            f,
            axes,
            backend.counts(counts),
            backend.pack(table),
            backend.pack(rule.nodes),
            left,
            right,
            len(self.high),
            stack,
            ends,
            carry,
            high,
            low,
        )
        self._stack, self._ends, self._carry = [list(row) for row in stack], [int(n) for n in ends], list(carry)
        self.high, self.low = np.concatenate([self.high, high]), np.concatenate([self.low, low])

    def _start(self, rule: Quadrature, counts: list[int]) -> None:
        setup = self._flow.setup
        if self._carry is None:
            values = [0 * setup.start[0]] * len(rule.nodes)
            flow_kernel.rates(setup.f, setup.axes, setup.start, rule.nodes, values)
            half = sum(w * x for w, x in zip(rule.right, values, strict=True))
            self._carry = [0 * half, 0 * half, half]
        # a level is added before the steps reach its count: its place is still zero
        for count in counts[len(self._stack) :]:
            self._stack.append(list(setup.start))
            self._ends.append(count)

    @property
    def rule(self) -> Quadrature:
        """The quadrature whose Legendre series has converged on steps spread over the motion."""
        if self._rule is None:
            setup = self._flow.setup
            levels = setup.table(self._sign, 512)
            samples = [flow_kernel.reach(setup.f, setup.axes, setup.start, *levels, j) for j in range(0, 512, 61)]
            # an easy body needs about 0.8 nodes a digit
            least, most = 0.7 * setup.digits, 6 * setup.digits
            for count in (n for n in NODE_COUNTS if least <= n <= most):
                rule = setup.quadrature(count, self._sign)
                if max(_tail(setup, rule, point) for point in samples) < 4 * setup.work.eps:
                    break
            else:
                raise PrecisionLoss(
                    f"1/g is not resolved by {most} nodes a step: the moments or d differ too much for this clock"
                )
            self._rule = rule
        return self._rule

    def states(self, high: list[Any], low: list[Any]) -> tuple[np.ndarray, np.ndarray]:
        """(moving points, flow time in half steps) at (scaled) times inside the reach of the clock."""
        flow, setup, rule = self._flow, self._flow.setup, self.rule
        steps = [int(s) for s in np.searchsorted(self.high, np.array(high), side="right") - 1]
        rests = [(t - self.high[s]) + (r - self.low[s]) for t, r, s in zip(high, low, steps, strict=True)]
        nexts = [(t - self.high[s + 1]) + (r - self.low[s + 1]) for t, r, s in zip(high, low, steps, strict=True)]
        backend = flow._backend(len(steps) * (16 + len(rule.nodes)))
        points, offsets = flow._rows(len(steps)), flow._rows(len(steps), 0)
        counts, table = setup.table(self._sign, max(steps) + 1)
        f, axes, start, nodes, legendre, series, roots = map(
            backend.pack, (setup.f, setup.axes, setup.start, rule.nodes, rule.legendre, setup.series, setup.roots)
        )
        backend.loops.states_at_times(
            f,
            axes,
            start,
            backend.counts(counts),
            backend.pack(table),
            nodes,
            legendre,
            series,
            roots,
            setup.half_step,
            setup.passes,
            self._sign,
            backend.counts(steps),
            backend.pack(_plain(rests)),
            backend.pack(_plain(nexts)),
            points,
            offsets,
        )
        return points, offsets

    def time(self, step: int, offset: Any) -> Any:
        """The (scaled) time ``offset`` half steps beyond a basic step."""
        setup, rule = self._flow.setup, self.rule
        point = flow_kernel.reach(setup.f, setup.axes, setup.start, *setup.table(self._sign, step), step)
        angle, _ = flow_kernel.integrate_series(_series(setup, rule, point), offset)
        return self.high[step] + (self.low[step] + setup.half_step * angle)


def residual(f: Any, point: Any) -> Any:
    """|f − V² mod U| over the size of f, for a moving point."""
    u0, u1, v0, v1 = point[:4]
    rest = [f[0] - v0 * v0, f[1] - 2 * v0 * v1, f[2] - v1 * v1, f[3], f[4], f[5]]
    for k in range(5, 1, -1):
        rest[k - 1] -= u1 * rest[k]
        rest[k - 2] -= u0 * rest[k]
    return max(abs(rest[0]), abs(rest[1])) / max(abs(c) for c in f)


def _series(setup: Setup, rule: Quadrature, point: Any) -> list[Any]:
    """Legendre coefficients of 1/g over the step around a moving point."""
    values = [0 * setup.start[0]] * len(rule.nodes)
    flow_kernel.rates(setup.f, setup.axes, point, rule.nodes, values)
    return [sum(c * x for c, x in zip(row, values, strict=True)) for row in rule.legendre]


def _tail(setup: Setup, rule: Quadrature, point: Any) -> Any:
    """The size of the last Legendre coefficients of 1/g beside the first, an estimate of the truncation error."""
    coefficients = _series(setup, rule, point)
    return max(abs(c) for c in coefficients[-2:]) / abs(coefficients[0])


def _by_sign(values: np.ndarray) -> list[tuple[int, np.ndarray]]:
    negative = np.array([bool(t < 0) for t in values], dtype=bool)
    groups = ((1, np.flatnonzero(~negative)), (-1, np.flatnonzero(negative)))
    return [(sign, chosen) for sign, chosen in groups if len(chosen)]


def _plain(values: list[Any]) -> list[Any]:
    """float for np.float64, which is slow in interpreted loops; mpf unchanged."""
    return [float(x) if isinstance(x, np.floating) else x for x in values]
