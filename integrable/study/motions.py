"""The report of one motion: the tasks of the scene's ``[report]``, measured in this process. The first task computes
the run's own result.

The ball and the top move by the divisor flow, systems of any genus by additions. The deformations move by their
elliptic curves or, where none are known, by Taylor series of their equations. SciPy's DOP853 is the comparison. Rows
start from the scene's numbers rounded to doubles, as in a study (:mod:`integrable.scene.doubles`), and their errors
refer to that motion. If both the run and a row have more than 15 digits, the row starts from the scene's own numbers,
and its errors refer to the motion from these numbers.

The truth is the same motion at ``truth_digits`` digits. It is compared once with another integrator at a short time:
the Taylor series of :mod:`integrable.oracles.reference`, Gauss collocation for a system of any genus, the integrated
equations at 10 more digits for a deformation. The run's own result is computed before the truth. If some row has at
least ten more digits, the result's error is measured against that row.

Errors of M are relative to |M|. Drifts are the largest relative departures, over the requested times, of |γ|², (γ,
M)/|M| and the two integrals from their values at the exact start. Run times are medians of ``time.perf_counter``;
set-up includes a new body each time. The floor is eps·conditioning, the effect of rounding the inputs to doubles.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from math import inf
from typing import Any

from integrable.extras import installed
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from integrable.scene.doubles import in_doubles
from integrable.scene.tables import DOP853
from integrable.study.measure import flow_run, measured
from integrable.study.plan import Limits, Task
from integrable.study.report import FIRST_USE, Report, Row, TruthCheck, closing, opening, row_line
from integrable.study.timing import Tick, silent
from integrable.study.truth import INTEGRATED, Judge, Truth, moved_by, parts

__all__ = ["measure", "pieces_of_work"]

MORE = 10
"""A run is a reference for another if it has at least this many more digits."""
PATIENCE = 0.1
"""No run is repeated beyond this many seconds: a single long run is timed well."""


def pieces_of_work(scene: Scene, digits: int) -> int:
    """The number of calls of ``tick`` by :func:`measure`."""
    run = _Run(scene, digits)
    return sum(task.pieces for task in (*run.flows, *run.truths.values(), *run.rivals, *run.others))


def measure(
    scene: Scene, digits: int, tick: Tick, line: Tick = silent, own: Callable[[Any], None] = silent
) -> tuple[Report, Any]:
    """Measure ``scene.report``, and return the report with the trajectory at ``digits`` digits.

    ``tick(label)`` is called before each piece of work, ``line`` with each line of the table as soon as it is known,
    and ``own`` with the trajectory, before anything else is computed.
    """
    run = _Run(scene, digits, tick)
    trajectory = run.flow(run.flows[0])
    own(trajectory)
    rows: list[Row] = []
    for task in (*run.flows, *run.rivals):
        found = run.rows(task)
        head = [] if rows else opening(run.report(found))
        rows += found
        for text in (*head, *(row_line(run.report(rows), row) for row in found)):
            line(text)
    report = run.finished(rows)
    for text in closing(report):
        line(text)
    return report, trajectory


class _Run:
    """The tasks of a run, each executed once, and their results."""

    def __init__(self, scene: Scene, digits: int, tick: Tick = silent) -> None:
        assert scene.report is not None, "the scene has no [report]"
        self.scene, self.asked, self.digits, self.tick = scene, scene.report, digits, tick
        self.limits = Limits(
            inf, inf, inf, self.asked.repeat, 0.0, self.asked.check_time, patience=PATIENCE, floor_times=inf
        )
        self.rounded = in_doubles(scene)
        self.moved = moved_by(scene.start(FLOAT_DIGITS)[0])
        self._found: dict[str, Any] = {}
        self._truths: dict[bool, Any] = {}

    # --- the tasks

    def _task(self, kind: str, method: str, setting: str, value: float, label: str, pieces: int = 1) -> Task:
        # the scene's numbers are rounded to doubles if row or run is in floats
        given = self.scene if kind in ("flow", "truth") and min(value, self.digits) > FLOAT_DIGITS else self.rounded
        return Task(given, given.name, kind, method, setting, value, self.limits, label=label, pieces=pieces)

    @cached_property
    def flows(self) -> list[Task]:
        """The tasks that compute the motion at each number of digits; the first computes the run's own result."""
        asked = self.asked
        names = {cost: "floats" if cost <= FLOAT_DIGITS else f"{cost} digits" for cost in (self.digits, *asked.digits)}
        tasks = [self._task("flow", self.moved, name, cost, name, asked.repeat) for cost, name in names.items()]
        return [tasks[0], *sorted(tasks[1:], key=lambda task: task.value or 0)]

    @cached_property
    def rivals(self) -> list[Task]:
        """The tasks of SciPy's integrator."""
        tasks = []
        for tolerance in map(float, self.asked.tolerances):
            setting, label = f"tol {tolerance:.0e}".replace("e-0", "e-"), f"DOP853 at {tolerance:.0e}"
            tasks.append(self._task("tolerance", DOP853, setting, tolerance, label, self.asked.repeat))
        return tasks

    @cached_property
    def truths(self) -> dict[bool, Task]:
        """The tasks that compute the truth: from the scene's numbers (True) and from these numbers rounded to doubles
        (False).

        A task is left out if no row starts from the same numbers.
        """
        digits = max(self.asked.truth_digits, self.digits + MORE)
        used = {task.scene is self.scene for task in (*self.flows, *self.rivals)}
        pieces, label = len(parts(self.scene, FLOAT_DIGITS)) + 1, f"truth, {digits} digits"
        made = self._task("truth", self.moved, "truth", digits, label, pieces)
        return {exact: replace(made, scene=self.scene if exact else self.rounded) for exact in used}

    @cached_property
    def others(self) -> list[Task]:
        """The tasks that have no row in the table."""
        tasks = []
        if steps := self.asked.steps:
            tasks.append(self._task("growth", self.moved, "residual growth", len(steps), "residual growth"))
        if self.moved != INTEGRATED:
            tasks.append(self._task("floor", "conditioning", "floor", FLOAT_DIGITS, "conditioning"))
        return tasks

    # --- execution of the tasks

    def _measured(self, task: Task, truth: dict[str, Any] | None = None) -> dict[str, Any]:
        with _pieces(task, self.tick) as step:
            return measured(task, truth, step)

    def truth(self, given: Scene) -> dict[str, Any]:
        """The truth of a scene, computed at the first call."""
        exact = given is self.scene
        if exact not in self._truths:
            self._truths[exact] = self._measured(self.truths[exact])
        return self._truths[exact]

    def flow(self, task: Task) -> Any:
        """The trajectory of a task, computed at the first call."""
        if task.key not in self._found:
            with _pieces(task, self.tick) as step:
                self._found[task.key] = flow_run(task, step)
        return self._found[task.key][1]

    def rows(self, task: Task) -> list[Row]:
        """The row of a task; a ball or top in floats has a second row, with the time of the first use."""
        if task.method == DOP853:
            return [self._rival(task)]
        found = self.flow(task)
        result = dict(self._found[task.key][0])
        first, _ = result.pop("first"), result.pop("way")
        result |= self._judge(task).judge(found.gamma, found.M)
        digits = int(task.value or 0)
        row = Row(task.method, task.setting, digits=digits, **result)
        if not (task.scene.rolls_or_spins and first is not None):
            return [row]
        return [row, Row(task.method, FIRST_USE, digits=digits, total=first, runs=1)]

    def _judge(self, task: Task) -> Judge:
        """The reference for a row's errors: the truth. For the run's own result it is the first of ``flows`` that has
        at least MORE digits more, if there is one.
        """
        finer = [one for one in self.flows if (one.value or 0) >= self.digits + MORE and one.scene is task.scene]
        if task is not self.flows[0] or not finer:
            return Truth(task.scene, self.truth(task.scene))
        digits, found = int(finer[0].value or 0), self.flow(finer[0])
        return Judge(*task.scene.start(digits + 10), found.gamma, found.M)

    def _rival(self, task: Task) -> Row:
        """The row of SciPy's integrator. If the integrator failed, the row has the reason and no figures."""
        row = Row(task.method, task.setting, tolerance=task.value)
        if not installed("scipy"):
            with _pieces(task, self.tick):
                return replace(row, note="not run: SciPy is not installed")
        held = self.truth(task.scene)
        try:
            return replace(row, **self._measured(task, held))
        except (RuntimeError, ArithmeticError) as error:
            return replace(row, note=str(error))

    def report(self, rows: Sequence[Row]) -> Report:
        """The report with the rows found so far, before the truth is checked."""
        times = self.scene.times.floats()
        return Report(
            title=self.scene.title,
            times=(min(times), max(times), len(times)),
            repeat=self.limits.repeat,
            rows=tuple(rows),
            truth=TruthCheck(0, 0.0, 0.0, 0.0, 0.0),
            residual_growth=(),
            integrals=tuple(rows[0].drift or ()),
            against=self.moved,
            letters=self.scene.letters,
            planned=tuple((task.method, task.setting) for task in (*self.flows, *self.rivals)),
        )

    def finished(self, rows: Sequence[Row]) -> Report:
        """The finished report, with the check of the truth, the floor, and the distance of the divisor from its curve
        after many additions (``residual_growth``).
        """
        check = self.truth(self.flows[0].scene)["check"]
        found: dict[str, Any] = {}
        for task in self.others:
            found |= self._measured(task)
        return replace(
            self.report(rows),
            truth=TruthCheck(**{name: value for name, value in check.items() if name != "by"}),
            residual_growth=found.get("growth", ()),
            floor=(found["floor_gamma"], found["floor_M"]) if "floor_gamma" in found else None,
            planned=(),
        )


@contextmanager
def _pieces(task: Task, tick: Tick) -> Iterator[Tick]:
    """Yields a function to be called once for each piece of a task. At the end it is called for the pieces left."""
    left = task.pieces

    def step(label: str) -> None:
        nonlocal left
        left -= 1
        tick(label)

    step(task.label)
    try:
        yield step
    finally:
        while left > 0:
            step(task.label)
