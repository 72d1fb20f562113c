"""The report of an orbit: error, drift of the integrals and cost per step of a scene's ``[steps]``.

Over real numbers errors refer to the same orbit at ``truth_digits`` digits. Over a finite field every step is exact:
the error is 0, the integrals are constant, and only the cost is measured. Where each step adds the same divisor D', a
single addition of [count]D' to the start must reach the end of the orbit; the report includes that check.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from functools import partial
from time import perf_counter
from typing import Any

from integrable.oracles.method import Spent
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.phase.state import State
from integrable.scene.data import Scene, Steps
from integrable.scene.orbit import Orbit, orbit
from integrable.scene.tables import aligned, duration, figure
from integrable.steps.translation import Translation
from integrable.study.timing import Tick, Timed, interleaved
from integrable.study.truth import Judge
from jacobian.immutable import replaced

PATIENCE = 60.0
"""No orbit is timed again after this many seconds."""

__all__ = ["OrbitReport", "OrbitRow", "measure_orbit", "pieces_of_orbit"]


@dataclass(frozen=True)
class OrbitRow:
    """An orbit at one number of digits. Errors and drifts are maxima over the orbit.

    ``growth`` has the error of γ by step number.
    """

    setting: str
    digits: int | None
    error_gamma: float
    error_M: float
    drift: dict[str, float] = field(hash=False)
    seconds_per_step: float
    runs: int
    growth: tuple[tuple[int, float], ...] = ()


Measured = tuple[Orbit, list[OrbitRow], int | None, float | None]
"""An orbit, the rows of its report, the digits of its truth and the jump of :class:`OrbitReport`."""


@dataclass(frozen=True)
class OrbitReport:
    """The error, drift and cost per step of an orbit.

    If each step adds the same divisor D', one addition of [count]D' to the start leads to the end of the orbit, up to
    the difference ``jump``. For other maps ``jump`` is None.
    """

    title: str
    map: str
    count: int
    repeat: int
    rows: tuple[OrbitRow, ...]
    truth_digits: int | None
    jump: float | None

    def table(self) -> str:
        """The report as plain text, at most 100 columns wide."""
        names = list(self.rows[0].drift)
        head = ("setting", "error γ", "error M", *(f"Δ{name}" for name in names), "per step")
        cells = [
            (
                row.setting,
                figure(row.error_gamma),
                figure(row.error_M),
                *(figure(row.drift[name], 1) for name in names),
                duration(row.seconds_per_step),
            )
            for row in self.rows
        ]
        lines = [self.title, f"{self.count} steps of {self.map}", f"costs are medians of {self.repeat} runs", ""]
        lines += [*aligned([head, *cells]), ""]
        if self.truth_digits is None:
            lines.append("Every step is exact; Δ: states of the orbit at which the integral is another.")
        else:
            lines += [
                "error γ: largest over components and steps, against the same orbit at "
                f"{self.truth_digits} digits; error M: the",
                "same, relative to |M|; Δ: largest drift from the exact start, of the last two relative.",
            ]
        if self.truth_digits is None and self.jump:
            lines.append("THE END OF THE ORBIT IS NOT that of one addition of the multiple.")
        elif self.jump is not None:
            how = "exactly" if self.jump == 0 else f"to {self.jump:.0e}"
            lines.append(f"The end of the orbit is that of one addition of {self.count}·D', {how}.")
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """The report as plain data for JSON."""
        return asdict(self)


def pieces_of_orbit(scene: Scene, digits: int) -> int:
    """The number of times :func:`measure_orbit` calls ``tick``."""
    assert scene.steps is not None
    costs = 1 if scene.finite_field else len({*scene.steps.digits, digits})
    return scene.steps.repeat * costs + (not scene.finite_field)


def measure_orbit(scene: Scene, digits: int, tick: Tick) -> Orbit:
    """The orbit of ``scene.steps`` at ``digits`` digits, with its report. ``tick(label)`` is called before each piece
    of work.
    """
    steps = scene.steps
    assert steps is not None, "the scene has no [steps]"
    kept, rows, truth_digits, jump = (_exact if scene.finite_field else _real)(scene, steps, digits, tick)
    report = OrbitReport(scene.title, _words(steps), steps.count, steps.repeat, tuple(rows), truth_digits, jump)
    return replaced(kept, report=report)


def _real(scene: Scene, steps: Steps, digits: int, tick: Tick) -> Measured:
    """The orbit at ``digits`` digits, and a row for each number of digits, against the orbit at more digits."""
    truth_digits = max(steps.truth_digits, digits + 10)
    tick(f"truth, {truth_digits} digits")
    system, state = scene.start(truth_digits)
    step = scene.step(system, truth_digits)
    truth = orbit(step, state, steps.count)
    judge = Judge(system, state, truth.gamma, truth.M)
    rows, kept = [], truth
    for cost in sorted({*steps.digits, digits}):
        setting = "floats" if cost <= FLOAT_DIGITS else f"{cost} digits"
        found, costs = _timed(scene, steps, cost, partial(tick, setting))
        judged = judge.judge(found.gamma, found.M)
        growth = enumerate(map(float, judge.distances(found.gamma, judge.gamma)))
        rows.append(OrbitRow(setting, cost, **judged, **costs, growth=tuple(growth)))
        kept = found if cost == digits else kept
    return kept, rows, truth_digits, _jump(step, state, truth)


def _exact(scene: Scene, steps: Steps, _: int, tick: Tick) -> Measured:
    """The orbit over the scene's finite field. The drift of an integral is the number of states where it changed."""
    found, costs = _timed(scene, steps, FLOAT_DIGITS, partial(tick, f"exact orbit over {scene.finite_field}"))
    system, state = scene.start(FLOAT_DIGITS)
    before = system.integrals(state)
    after = [system.integrals(x) for x in found.states]
    drift = {
        name: float(sum(row[i] != value for row in after))
        for i, (name, value) in enumerate(zip(before._fields, before, strict=True))
    }
    row = OrbitRow("exact", None, 0.0, 0.0, drift, **costs)
    return found, [row], None, _jump(scene.step(system, FLOAT_DIGITS), state, found)


def _timed(scene: Scene, steps: Steps, digits: int, tick: Callable[[], None]) -> tuple[Orbit, dict[str, Any]]:
    """An orbit and its cost; each run uses a new system and map."""

    def once() -> Timed:
        system, state = scene.start(digits)
        step = scene.step(system, digits)
        begun = perf_counter()
        found = orbit(step, state, steps.count)
        return Spent(0.0, 0.0, 0.0, perf_counter() - begun), found

    tick()
    timing = interleaved({"": once}, steps.repeat, PATIENCE, tick, again=1)[""]
    return timing.found, {"seconds_per_step": timing.total / steps.count, "runs": timing.runs}


def _jump(step: Any, state: State, found: Orbit) -> float | None:
    """The largest difference of γ and M/|M| between two states: the end of the orbit, whose steps add D' each, and the
    image of its start under one addition of [count]D'. Over an exact field the result is 1 if the states differ, else
    0. None if the step is no translation.
    """
    if not isinstance(step, Translation):
        return None
    once = (step * (len(found.states) - 1))(state)
    end = found.states[-1]
    K = step.system.field
    if K.exact:
        return float(once.vectors != end.vectors)
    _, M = state.vectors
    scales = 1, K.sqrt(K.dot(M, M))
    return max(
        float(abs(x - y) / scale)
        for scale, v, w in zip(scales, once.vectors, end.vectors, strict=True)
        for x, y in zip(v, w, strict=True)
    )


def _words(steps: Steps) -> str:
    given = (", ".join(f"{key} = {_shown(value)}" for key, value in one.arguments) for one in steps.maps)
    return ", then ".join(f"{one.kind}({words})" for one, words in zip(steps.maps, given, strict=True))


def _shown(value: Any) -> str:
    return f"({', '.join(map(_shown, value))})" if isinstance(value, tuple) else "∞" if value is None else str(value)
