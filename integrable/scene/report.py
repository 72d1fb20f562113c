"""Error against run time: the motion at several costs, beside SciPy's DOP853 on the same start and times.

The ball and the top move by the divisor flow, the deformations by their elliptic curves or, where none are known, by
extrapolation of their equations. Errors are against the same at ``truth_digits`` digits, which is itself held once
against another integrator at a short time: the Taylor series of :mod:`integrable.oracles.reference`, for a deformation
the extrapolation at 10 more digits. Errors of M are relative to |M|; drifts are the largest departures, over the
requested times, of |γ|², (γ, M)/|M| and the two integrals, relative, from their values at the exact start. Run times
are medians of ``time.perf_counter``; set-up begins with a new body each time. The floor is eps·conditioning: what
rounding the inputs to doubles does to the states by itself.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from fractions import Fraction
from time import perf_counter
from typing import Any

from integrable.extras import installed
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.phase.state import State
from integrable.scene.data import Scene
from integrable.scene.rows import INTEGRALS, Report, Row, TruthCheck
from integrable.scene.tables import DOP853
from jacobian.errors import PrecisionLoss

__all__ = ["measure", "pieces_of_work"]

DEFORMED_INTEGRALS = ("C1", "C2", "H", "K")
PART = 20
"""States of the truth that are computed between two steps of the progress bar."""
_PATIENCE = 10.0  # seconds of repeats after which a median of fewer runs is taken


def pieces_of_work(scene: Scene, digits: int) -> int:
    """How many times :func:`measure` calls ``tick``."""
    comparison = scene.report
    assert comparison is not None, "the scene has no [report]"
    costs = {*comparison.digits, digits}
    compiled = sum(cost <= FLOAT_DIGITS for cost in costs) if scene.rolls_or_spins else 0
    runs = comparison.repeat * (len(costs) + compiled + len(comparison.tolerances))
    return len(_parts(scene, FLOAT_DIGITS)) + runs + 2 + bool(comparison.steps)


def measure(scene: Scene, digits: int, tick: Callable[[str], None]) -> tuple[Report, Any]:
    """Do what ``scene.report`` asks for, and return the report with the trajectory at ``digits`` digits.

    ``tick(label)`` is called before each piece of work.
    """
    comparison = scene.report
    assert comparison is not None, "the scene has no [report]"
    costs = sorted({*comparison.digits, digits})
    truth_digits = max(comparison.truth_digits, digits + 10)
    truth = _Truth(scene, truth_digits, tick)
    rows: list[Row] = []
    kept = None
    for cost in costs:
        runs = _Runs("floats" if cost <= FLOAT_DIGITS else f"{cost} digits", comparison.repeat, tick)
        found, trajectory = _flow_rows(scene, cost, "python", truth, runs)
        rows += found
        kept = trajectory if cost == digits else kept
        if cost <= FLOAT_DIGITS and scene.rolls_or_spins:
            rows += _flow_rows(scene, cost, "compiled", truth, _Runs("compiled floats", comparison.repeat, tick))[0]
    for tolerance in map(float, comparison.tolerances):
        runs = _Runs(f"DOP853 at {tolerance:.0e}", comparison.repeat, tick)
        rows.append(_dop853_row(scene, tolerance, truth, runs))
    tick("truth against an integrator")
    check = _check_truth(scene, truth, comparison.check_time, truth_digits)
    growth: tuple[tuple[int, float], ...] = ()
    if comparison.steps:
        tick("residual growth")
        body, state = scene.start(FLOAT_DIGITS)
        growth = tuple((int(n), float(r)) for n, r in body.flow(state).residual_growth(list(comparison.steps)))
    times = scene.times.floats()
    span = min(times), max(times), len(times)
    tick("conditioning")
    floor = _floor(scene, times) if truth.method != "extrapolation" else None
    report = Report(scene.title, span, comparison.repeat, tuple(rows), check, growth, truth.names, truth.method, floor)
    return report, kept


def _floor(scene: Scene, times: list[float]) -> tuple[float, float]:
    from integrable.motion.conditioning import conditioning

    try:
        return conditioning(*scene.start(FLOAT_DIGITS), times).floor()
    except PrecisionLoss:
        # the changed inputs are doubles apart all the same
        return conditioning(*scene.start(2 * FLOAT_DIGITS), scene.times.at(2 * FLOAT_DIGITS)).floor()


def _parts(scene: Scene, digits: int) -> list[list[Any]]:
    """The scene's times as pieces of work: what has to integrate up to each time does it once."""
    times = scene.times.at(digits)
    size = PART if scene.rolls_or_spins else len(times)
    return [times[first : first + size] for first in range(0, len(times), size)]


class _Truth:
    """The trajectory that errors are measured against, and the integrals of the exact start."""

    def __init__(self, scene: Scene, digits: int, tick: Callable[[str], None]) -> None:
        body, state = scene.start(digits)
        self.context = body.field.context
        self.plain = scene.rolls_or_spins
        self.names = INTEGRALS if self.plain else DEFORMED_INTEGRALS
        self.flow, self.body, self.state = body.motion_through(state), body, state
        self.method = getattr(self.flow, "method", "divisor flow")
        self.gamma, self.M = [], []
        for times in _parts(scene, digits):
            tick(f"truth, {digits} digits")
            trajectory = self.flow.at(times)
            self.gamma += self.rows(trajectory.gamma)
            self.M += self.rows(trajectory.M)
        self.integrals = self.integrals_of(list(state.gamma), list(state.M))
        self.size_of_M = self.context.sqrt(self.context.fdot(state.M, state.M))

    def rows(self, array: Any) -> list[list[Any]]:
        """An (N, 3) array of floats or foreign mpf as rows in this context, digit for digit."""
        return [[self.context.mpf(x) for x in row] for row in array.tolist()]

    def integrals_of(self, gamma: list[Any], M: list[Any]) -> list[Any]:
        """C1, C2, H1, H2 from their definitions, or what the deformation says."""
        if not self.plain:
            return list(self.body.integrals(State((gamma[0], gamma[1], gamma[2]), (M[0], M[1], M[2]))))
        dot, d, inertia = self.context.fdot, self.body.d, self.body.inertia
        a = [1 / (moment + d) for moment in inertia]
        A_gamma, A_M = ([a[i] * v[i] for i in range(3)] for v in (gamma, M))
        below = sum(moment * x * y for moment, x, y in zip(inertia, gamma, A_gamma, strict=True))
        n = dot(gamma, A_M) / below
        return [dot(gamma, gamma), dot(gamma, M), dot(A_M, M) + d * n * dot(A_gamma, M), dot(M, M)]

    def judge(self, gamma: Any, M: Any) -> dict[str, Any]:
        """Errors of γ and M and drifts of the integrals over all times, as floats, named as in :class:`Row`."""
        gamma, M = self.rows(gamma), self.rows(M)
        # an integral that is zero has no relative drift
        scales = [1, self.size_of_M, *(abs(x) or 1 for x in self.integrals[2:])]
        drifts = [self.context.zero] * 4
        for x, m in zip(gamma, M, strict=True):
            now = self.integrals_of(x, m)
            drifts = [
                max(old, abs(value - start) / scale)
                for old, value, start, scale in zip(drifts, now, self.integrals, scales, strict=True)
            ]
        return {
            "error_gamma": float(_distance(gamma, self.gamma)),
            "error_M": float(_distance(M, self.M) / self.size_of_M),
            "drift": dict(zip(self.names, map(float, drifts), strict=True)),
        }


def _distance(rows: list[list[Any]], others: list[list[Any]]) -> Any:
    return max(abs(x - y) for row, other in zip(rows, others, strict=True) for x, y in zip(row, other, strict=True))


class _Runs:
    """The runs of one method at one cost, each a piece of work; the first begins with what prepares it."""

    def __init__(self, label: str, repeat: int, tick: Callable[[str], None]) -> None:
        self._label, self._left, self._tick = label, repeat, tick
        self._next()

    def _next(self) -> None:
        if self._left:
            self._tick(self._label)
            self._left -= 1

    def repeated(self, once: Callable[[], tuple[Sequence[float], Any]]) -> tuple[list[Sequence[float]], Any]:
        """``once`` so many times, or fewer where they take long: their durations, each run's in a row, and what the
        last returned.
        """
        durations: list[Sequence[float]] = []
        most = self._left + 1
        while len(durations) < most and sum(map(sum, durations)) < _PATIENCE:
            duration, found = once()
            durations.append(duration)
            self._next()
        self.over()
        return durations, found

    def over(self) -> None:
        """No more runs: what was planned counts as done."""
        while self._left:
            self._next()


def _flow_rows(scene: Scene, digits: int, kernel: str, truth: _Truth, runs: _Runs) -> tuple[list[Row], Any]:
    times = scene.times.at(digits)

    def once() -> tuple[Sequence[float], Any]:
        body, state = scene.start(digits)
        begun = perf_counter()
        flow = body.flow(state, kernel=kernel) if truth.plain else body.motion_through(state)
        ready = perf_counter()
        trajectory = flow.at(times)
        _ = trajectory.gamma, trajectory.M
        return (ready - begun, perf_counter() - ready), trajectory

    compiled = kernel == "compiled"
    setting = "compiled" if compiled else "floats" if digits <= FLOAT_DIGITS else f"{digits} digits"
    first = sum(once()[0]) if compiled else None  # compiles, or loads what was compiled by an earlier run
    durations, trajectory = runs.repeated(once)
    row = Row(
        method=truth.method,
        setting=setting,
        digits=digits,
        setup=statistics.median(setup for setup, _ in durations),
        evaluation=statistics.median(evaluation for _, evaluation in durations),
        total=statistics.median(map(sum, durations)),
        runs=len(durations),
        **truth.judge(trajectory.gamma, trajectory.M),
    )
    if first is None:
        return [row], trajectory
    return [Row("divisor flow", "first use", digits=digits, total=first, runs=1), row], trajectory


def _dop853_row(scene: Scene, tolerance: float, truth: _Truth, runs: _Runs) -> Row:
    from integrable.oracles.reference import dop853

    body, state = scene.start(FLOAT_DIGITS)
    times = scene.times.floats()

    def once() -> tuple[Sequence[float], Any]:
        begun = perf_counter()
        solution = dop853(body, state, times, rtol=tolerance, atol=tolerance)
        return (perf_counter() - begun,), solution

    method, setting = DOP853, f"tol {tolerance:.0e}".replace("e-0", "e-")
    if not installed("scipy"):
        runs.over()
        return Row(method, setting, tolerance=tolerance, note="not run: SciPy is not installed")
    try:
        dop853(body, state, [min(times, key=abs) or 1e-3], rtol=1e-3, atol=1e-3)  # imports SciPy, outside of the timing
        durations, solution = runs.repeated(once)
    except RuntimeError as error:
        runs.over()
        return Row(method, setting, tolerance=tolerance, note=str(error))
    return Row(
        method=method,
        setting=setting,
        tolerance=tolerance,
        total=statistics.median(map(sum, durations)),
        runs=len(durations),
        evaluations=solution.evaluations,
        **truth.judge(solution.gamma, solution.M),
    )


def _check_truth(scene: Scene, truth: _Truth, time: Fraction, digits: int) -> TruthCheck:
    exact = truth.context.mpf(time.numerator) / time.denominator
    trajectory = truth.flow.at([exact])
    begun = perf_counter()
    solution: Any
    if truth.plain:
        from integrable.oracles.reference import taylor

        solution = taylor(truth.body, truth.state, [exact], digits=digits)
    else:
        from integrable.deformations.integrated import IntegratedMotion

        solution = IntegratedMotion(*scene.start(digits + 10)).at([exact])
    seconds = perf_counter() - begun
    gamma = _distance(truth.rows(trajectory.gamma), truth.rows(solution.gamma))
    M = _distance(truth.rows(trajectory.M), truth.rows(solution.M)) / truth.size_of_M
    return TruthCheck(digits, float(time), float(gamma), float(M), seconds)
