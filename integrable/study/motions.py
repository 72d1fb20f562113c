"""The report of one motion: the tasks of the scene's own ``[report]``, measured in process.

The ball and the top move by the divisor flow, systems of any genus by additions, the deformations by their elliptic
curves or, where none are known, by Taylor series of their equations; beside them SciPy's DOP853 on the same start and
times. Errors are against the same motion at ``truth_digits`` digits, which is itself held once against another
integrator at a short time: the Taylor series of :mod:`integrable.oracles.reference`, for a system of any genus Gauss's
collocation, for a deformation the same at 10 more digits. Errors of M are relative to |M|; drifts are the largest
departures, over the requested times, of |γ|², (γ, M)/|M| and the two integrals, relative, from their values at the
exact start. Run times are medians of ``time.perf_counter``; set-up begins with a new body each time. The floor is
eps·conditioning: what rounding the inputs to doubles does to the states by itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from integrable.extras import installed
from integrable.scene.data import Scene
from integrable.study.measure import flow_measured, measured
from integrable.study.plan import Task, tasks_of_run
from integrable.study.report import Report, Row, TruthCheck
from integrable.study.timing import Tick

__all__ = ["measure", "pieces_of_work"]


def pieces_of_work(scene: Scene, digits: int) -> int:
    """How many times :func:`measure` calls ``tick``."""
    return sum(task.pieces for task in tasks_of_run(scene, digits))


def measure(scene: Scene, digits: int, tick: Tick) -> tuple[Report, Any]:
    """Do what ``scene.report`` asks for, and return the report with the trajectory at ``digits`` digits.

    ``tick(label)`` is called before each piece of work.
    """
    truth, *tasks = tasks_of_run(scene, digits)
    rows: list[Row] = []
    found: dict[str, Any] = {}
    with _pieces(truth, tick) as step:
        held = measured(truth, None, step)
    for task in tasks:
        with _pieces(task, tick) as step:
            if task.kind == "flow":
                result, trajectory = flow_measured(task, held, step)
                rows += _flow_rows(task, result)
                found |= {"trajectory": trajectory} if task.value == digits and task.kernel == "python" else {}
            elif task.kind == "tolerance":
                rows.append(_tolerance_row(task, held, step))
            else:
                found |= measured(task, held, step)
    times = scene.times.floats()
    report = Report(
        title=scene.title,
        times=(min(times), max(times), len(times)),
        repeat=truth.limits.repeat,
        rows=tuple(rows),
        truth=TruthCheck(**{name: value for name, value in held["check"].items() if name != "by"}),
        residual_growth=found.get("growth", ()),
        integrals=tuple(rows[0].drift or ()),
        against=truth.method,
        floor=(found["floor_gamma"], found["floor_M"]) if "floor_gamma" in found else None,
        letters=scene.letters,
    )
    return report, found["trajectory"]


@contextmanager
def _pieces(task: Task, tick: Tick) -> Iterator[Tick]:
    """``tick`` for the pieces of a task; those that it then did not need count as done."""
    left = task.pieces

    def step(label: str) -> None:
        nonlocal left
        left -= 1
        tick(label)

    step(task.label)
    yield step
    while left:
        step(task.label)


def _flow_rows(task: Task, result: dict[str, Any]) -> list[Row]:
    first = result.pop("first")
    del result["way"]
    digits = int(task.value or 0)
    row = Row(task.method, task.setting, digits=digits, **result)
    if task.kernel != "compiled":
        return [row]
    return [Row(task.method, "first use", digits=digits, total=first, runs=1), row]


def _tolerance_row(task: Task, held: dict[str, Any], tick: Tick) -> Row:
    row = Row(task.method, task.setting, tolerance=task.value)
    if not installed("scipy"):
        return replace(row, note="not run: SciPy is not installed")
    try:
        return replace(row, **measured(task, held, tick))
    except (RuntimeError, ArithmeticError) as error:
        return replace(row, note=str(error))
