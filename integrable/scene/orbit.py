"""Orbits of a map: what ``[steps]`` of a scene asks for, with error, drift of the integrals and cost per step.

Over real numbers errors are against the same orbit at ``truth_digits`` digits. Over a finite field every step is exact:
the error is 0, the integrals do not move, and what is left to measure is the cost. Where the map is one translation,
its multiple [count]D' added once must lead to the end of the orbit; that check is part of the report.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np

from integrable.phase.precisions import FLOAT_DIGITS
from integrable.phase.state import State
from integrable.scene.data import MOST_STEPS, Scene
from integrable.scene.tables import aligned, duration, figure
from integrable.steps.guard_digits import MOST_CONDITION, in_wider_numbers
from integrable.steps.step import Step
from integrable.steps.translation import Translation
from jacobian import RR
from jacobian.errors import ArgumentError, shown, whole
from jacobian.immutable import read_only

__all__ = ["Orbit", "OrbitReport", "OrbitRow", "measure_orbit", "pieces_of_orbit"]


@dataclass(frozen=True)
class Orbit:
    """The states after 0, 1, …, N steps: ``steps`` of shape (N + 1,), ``gamma`` and ``M`` of shape (N + 1, 3).

    float64 arrays for floats, object arrays of mpf or of field elements elsewhere.
    """

    states: tuple[State, ...]
    field: Any
    report: OrbitReport | None = None

    @property
    def steps(self) -> np.ndarray:
        return read_only(np.arange(len(self.states)))

    @property
    def times(self) -> np.ndarray:
        """The numbers of the steps."""
        return self.steps

    @property
    def gamma(self) -> np.ndarray:
        return self._array([state.gamma for state in self.states])

    @property
    def M(self) -> np.ndarray:
        return self._array([state.M for state in self.states])

    def _array(self, rows: list[Any]) -> np.ndarray:
        return read_only(np.array(rows, dtype=np.float64 if self.field == RR else object))


@dataclass(frozen=True)
class OrbitRow:
    """An orbit at one cost. Errors and drifts are the largest over the orbit; ``growth`` has error γ by step number."""

    setting: str
    digits: int | None
    error_gamma: float
    error_M: float
    drift: dict[str, float] = field(hash=False)
    seconds_per_step: float
    runs: int
    growth: tuple[tuple[int, float], ...] = ()


@dataclass(frozen=True)
class OrbitReport:
    """Error, drift and cost per step of an orbit; ``jump`` is its end against [count]D' added once, None if unknown."""

    title: str
    map: str
    count: int
    repeat: int
    rows: tuple[OrbitRow, ...]
    truth_digits: int | None
    jump: float | None

    def table(self) -> str:
        """The report as plain text, at most 100 columns wide."""
        return _table(self)

    def as_dict(self) -> dict[str, Any]:
        """The report as plain data for JSON."""
        return asdict(self)


def pieces_of_orbit(scene: Scene, digits: int) -> int:
    """How many times :func:`measure_orbit` calls ``tick``."""
    assert scene.steps is not None
    costs = 1 if scene.finite_field else len({*scene.steps.digits, digits})
    return scene.steps.repeat * costs + (not scene.finite_field)


def measure_orbit(scene: Scene, digits: int, tick: Callable[[str], None]) -> Orbit:
    """The orbit of ``scene.steps`` at ``digits`` digits, with its report; ``tick(label)`` before each piece of work."""
    steps = scene.steps
    assert steps is not None, "the scene has no [steps]"
    if scene.finite_field:
        return _exact(scene, tick)
    truth_digits = max(steps.truth_digits, digits + 10)
    tick(f"truth, {truth_digits} digits")
    system, state = scene.start(truth_digits)
    step = scene.step(system, truth_digits)
    truth = orbit(step, state, steps.count)
    rows, kept = [], None
    for cost in sorted({*steps.digits, digits}):
        label = "floats" if cost <= FLOAT_DIGITS else f"{cost} digits"
        found, durations = _timed(scene, cost, partial(tick, label))
        rows.append(_judged(scene, cost, found, durations, truth))
        kept = found if cost == digits else kept
    assert kept is not None
    jump = _jump(step, state, truth)
    return replace(
        kept,
        report=OrbitReport(scene.title, _words(scene), steps.count, steps.repeat, tuple(rows), truth_digits, jump),
    )


def orbit(step: Step, state: State, count: int) -> Orbit:
    """The states after 0, 1, …, ``count`` steps.

    Where the map loses digits (:meth:`Step.condition`) the orbit runs in wider numbers and its states are rounded to
    the field of the map one by one, so that rounding is not fed back into the map.
    """
    if not isinstance(step, Step):
        raise ArgumentError(f"step = {shown(step)}: give a Step, such as system.translation(points)")
    count = whole(
        count, "count", f"give an int ≥ 0, a number of steps, {MOST_STEPS} at most: all states are kept", 0, MOST_STEPS
    )
    if step.condition(state) > MOST_CONDITION:
        return Orbit((state, *in_wider_numbers(step, state, count)), step.system.field)
    states = [state]
    for _ in range(count):
        states.append(step(states[-1]))
    return Orbit(tuple(states), step.system.field)


def _timed(scene: Scene, digits: int, begin: Callable[[], None]) -> tuple[Orbit, list[float]]:
    """An orbit and its run times, each with a new system and map; ``begin`` is called before each."""
    assert scene.steps is not None
    durations: list[float] = []
    for _ in range(scene.steps.repeat):
        begin()
        system, state = scene.start(digits)
        step = scene.step(system, digits)
        begun = perf_counter()
        found = orbit(step, state, scene.steps.count)
        durations.append(perf_counter() - begun)
    return found, durations


def _exact(scene: Scene, tick: Callable[[str], None]) -> Orbit:
    """The orbit over the scene's finite field: the drift of an integral counts the states at which it is another."""
    steps = scene.steps
    assert steps is not None
    found, durations = _timed(scene, FLOAT_DIGITS, lambda: tick(f"exact orbit over {scene.finite_field}"))
    system, state = scene.start(FLOAT_DIGITS)
    before = system.integrals(state)
    after = [system.integrals(x) for x in found.states]
    drift = {
        name: float(sum(row[i] != value for row in after))
        for i, (name, value) in enumerate(zip(before._fields, before, strict=True))
    }
    jump = _jump(scene.step(system, FLOAT_DIGITS), state, found)
    row = OrbitRow("exact", None, 0.0, 0.0, drift, statistics.median(durations) / steps.count, len(durations))
    report = OrbitReport(scene.title, _words(scene), steps.count, steps.repeat, (row,), None, jump)
    return replace(found, report=report)


def _judged(scene: Scene, digits: int, found: Orbit, durations: list[float], truth: Orbit) -> OrbitRow:
    assert scene.steps is not None
    system, state = scene.start(scene.steps.truth_digits)
    context = system.field.context

    def exact(vector: Any) -> list[Any]:
        return [context.mpf(x) for x in vector]

    size = context.sqrt(context.fdot(state.M, state.M))
    start = system.integrals(state)
    scales = (1, size, *(abs(x) or 1 for x in start[2:]))
    worst, growth, drift = [context.zero, context.zero], [], [context.zero] * 4
    for n, (ours, true) in enumerate(zip(found.states, truth.states, strict=True)):
        gamma, M = exact(ours.gamma), exact(ours.M)
        errors = [
            max(abs(x - y) for x, y in zip(v, exact(w), strict=True)) for v, w in ((gamma, true.gamma), (M, true.M))
        ]
        worst = [max(x, y) for x, y in zip(worst, errors, strict=True)]
        growth.append((n, float(errors[0])))
        now = system.integrals(State((gamma[0], gamma[1], gamma[2]), (M[0], M[1], M[2])))
        drift = [max(x, abs(y - z) / scale) for x, y, z, scale in zip(drift, now, start, scales, strict=True)]
    return OrbitRow(
        "floats" if digits <= FLOAT_DIGITS else f"{digits} digits",
        digits,
        float(worst[0]),
        float(worst[1] / size),
        dict(zip(start._fields, map(float, drift), strict=True)),
        statistics.median(durations) / scene.steps.count,
        len(durations),
        tuple(growth),
    )


def _jump(step: Any, state: State, found: Orbit) -> float | None:
    """The largest difference of γ and M/|M| between the end of an orbit and one addition of the multiple of D'."""
    if not isinstance(step, Translation):
        return None
    once = (step * (len(found.states) - 1))(state)
    end = found.states[-1]
    K = step.system.field
    if K.exact:
        return float((once.gamma, once.M) != (end.gamma, end.M))
    size = K.sqrt(K.dot(state.M, state.M))
    return max(
        float(abs(x - y) / scale)
        for scale, v, w in ((1, once.gamma, end.gamma), (size, once.M, end.M))
        for x, y in zip(v, w, strict=True)
    )


def _words(scene: Scene) -> str:
    """The map in words, as the scene gives it."""
    assert scene.steps is not None
    maps = []
    for one in scene.steps.maps:
        given = (f"{key} = {_shown(value)}" for key, value in one.arguments)
        maps.append(f"{one.kind}({', '.join(given)})")
    return ", then ".join(maps)


def _shown(value: Any) -> str:
    return f"({', '.join(map(_shown, value))})" if isinstance(value, tuple) else "∞" if value is None else str(value)


def _table(report: OrbitReport) -> str:
    names = list(report.rows[0].drift)
    head = ("setting", "error γ", "error M", *(f"Δ{name}" for name in names), "per step")
    cells = [
        (
            row.setting,
            figure(row.error_gamma),
            figure(row.error_M),
            *(figure(row.drift[name], 1) for name in names),
            duration(row.seconds_per_step),
        )
        for row in report.rows
    ]
    lines = [
        report.title,
        f"{report.count} steps of {report.map}",
        f"costs are medians of {report.repeat} runs",
        "",
        *aligned([head, *cells]),
        "",
    ]
    if report.truth_digits is None:
        lines.append("Every step is exact; Δ: states of the orbit at which the integral is another.")
    else:
        lines += [
            "error γ: largest over components and steps, against the same orbit at "
            f"{report.truth_digits} digits; error M: the",
            "same, relative to |M|; Δ: largest drift from the exact start, of the last two relative.",
        ]
    if report.jump is not None:
        how = "exactly" if report.jump == 0 else f"to {report.jump:.0e}"
        wrong = report.truth_digits is None and report.jump != 0
        lines.append(
            "THE END OF THE ORBIT IS NOT that of one addition of the multiple."
            if wrong
            else f"The end of the orbit is that of one addition of {report.count}·D', {how}."
        )
    return "\n".join(lines)
