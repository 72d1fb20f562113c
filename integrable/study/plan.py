"""The tasks of a measurement. A task is one scene, one method and one setting, with limits.

A study has for every scene its truth, its floor, the divisor flow, Bäcklund steps and every comparator
(:func:`tasks_of`). The run of a scene has the tasks of :mod:`integrable.study.motions`. :mod:`integrable.study.measure`
measures both.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from fractions import Fraction
from functools import cached_property
from hashlib import sha256
from typing import Any

from integrable.oracles.methods import METHODS
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from integrable.scene.doubles import in_doubles
from integrable.scene.output import portable
from integrable.study.store import code_stamp, commit
from integrable.study.truth import DIGITS, INTEGRATED, moved_by

__all__ = [
    "BACKLUND", "FLOW", "HORIZONS", "INTEGRATED", "LIMITS", "NOT_MEASURED", "STRONG", "Limits", "Task",
    "first_answer_tasks", "in_order", "tasks_of",
]  # fmt: skip

FLOW = "divisor flow"
STRONG = ("heyoka", "Taylor, compiled", "Gauss-Legendre 16", "Gauss-Legendre 16, adaptive", "SciPy DOP853, compiled")
"""Methods of which at least one must have run before the outcome of a comparison can be "none"."""
BACKLUND = "Bäcklund steps"
NOT_MEASURED = "not measured"
"""The status of a row for which the study's time did not suffice."""


@dataclass(frozen=True)
class Limits:
    """The limits of a task: seconds for a run of a method, a whole task and a truth, and the repeats of a timing."""

    run: float
    task: float
    truth: float
    repeat: int
    check: float
    """Seconds for the Taylor series that checks the truth."""
    check_time: Fraction | None = None
    """The single time of that check; None: as far as ``check`` seconds allow."""
    patience: float = 3.0
    """No run is repeated beyond this many seconds."""
    floor_times: float = 20
    """The approximate number of the scene's times over which the largest conditioning is taken."""


HORIZONS = {"quick": (1, 10, 100, 1000), "full": (1, 10, 100, 1000, 10_000, 100_000, 1_000_000)}
"""The single times, in time scales of the motion, at which the flow is compared with the fastest method that is
accurate enough.
"""
LIMITS = {"quick": Limits(1.5, 60, 60, 3, 1.0), "full": Limits(3, 90, 240, 5, 8.0, patience=1.5)}


@dataclass(frozen=True)
class Task:
    """One unit of work: ``kind`` selects the function of :mod:`integrable.study.measure` that does it."""

    scene: Scene
    source: str
    """What the scene was loaded from: a name or a path."""
    kind: str
    method: str
    setting: str
    value: float | None = None
    limits: Limits = LIMITS["full"]
    truth: str | None = None
    """The key of the task with the truth, which must be finished first."""
    cheaper: str | None = None
    """The key of the same method's task at the previous setting: if that was stopped, this one is not tried."""
    kernel: str = "auto"
    """The kernel of the flow of a body."""
    label: str = ""
    """The text of the progress bar; ``pieces`` is the number of pieces of work."""
    pieces: int = 1

    @cached_property
    def key(self) -> str:
        """The name of the task's file, unique in the study on every file system."""
        words = [_plain(word) for word in (self.scene.name, self.kind, self.method, self.setting)]
        # without a hash, names that differ only in replaced characters would coincide
        name = self.scene.name if words[0] != self.scene.name else ""
        return portable("--".join([*words, *([sha256(name.encode(errors="replace")).hexdigest()[:8]] if name else [])]))

    @cached_property
    def stamp(self) -> str:
        """A hash of everything the result depends on: scene, setting, limits, the code, the version of each library,
        and for a timed task the machine and the commit.
        """
        from integrable.scene.output import machine, versions

        parts = [self.scene.describe(), self.kind, self.method, self.setting, self.value, asdict(self.limits)]
        parts += [machine(), commit()] if self.timed else []
        text = json.dumps([*parts, code_stamp(), versions()], sort_keys=True)
        return sha256(text.encode()).hexdigest()[:16]

    @property
    def timed(self) -> bool:
        """Whether the task measures run times. Then it runs alone, and its row is valid for this machine only."""
        return self.kind not in ("truth", "floor")

    @property
    def limit(self) -> float:
        """Seconds after which the task is stopped. A task that computes a truth and runs other methods has the time of
        both.
        """
        truth = self.limits.truth if self.kind in ("truth", "floor", "horizon") else 0.0
        return truth + (self.limits.task if self.kind not in ("truth", "floor") else 0.0)


def _plain(word: str) -> str:
    return "".join(c if c.isascii() and (c.isalnum() or c in "-.") else "_" for c in word.lower())


def tasks_of(scene: Scene, source: str, mode: str) -> list[Task]:
    """The tasks of a study ("quick" or "full") for a scene in doubles. Each task follows those it depends on."""
    scene = in_doubles(scene)

    def task(kind: str, method: str, setting: str, value: float | None = None, truth: str = "", **more: Any) -> Task:
        return Task(scene, source, kind, method, setting, value, LIMITS[mode], truth or None, **more)

    if scene.steps is not None:
        tasks = [task("orbit", BACKLUND, scene.finite_field or "floats")]
        return tasks if scene.finite_field else [*tasks, task("floor", "conditioning", "floor")]
    truth = task("truth", "truth", "twice the digits")
    tasks = [truth, task("floor", "conditioning", "floor")]
    system, _ = scene.start(FLOAT_DIGITS)
    name = INTEGRATED if moved_by(system) == INTEGRATED else FLOW
    tasks.append(task("flow", name, "floats", FLOAT_DIGITS, truth.key))
    if scene.rolls_or_spins:
        tasks.append(task("flow", name, "compiled", FLOAT_DIGITS, truth.key, kernel="compiled"))
    tasks.append(task("flow", name, "30 digits", 30, truth.key))
    if scene.rolls_or_spins or (scene.classical and system.discretized):
        counts = (30, 100) if mode == "quick" else (100, 1000, 3000)
        tasks += [task("backlund", BACKLUND, f"{n} steps", n, truth.key) for n in counts]
    tasks += _comparators(scene, task, mode, truth.key)
    if name == FLOW:
        tasks += [task("horizon", name, f"T = {T}", T) for T in HORIZONS[mode]]
        tasks.append(task("horizon", name, "all its times", None, truth.key))
    return tasks


MIDDLE = 500.0
"""The time, in time scales, that stands for "all times of a scene" where rows are ordered by time."""
_ORDER = ("truth", "floor", "flow", "horizon", "orbit", "first answer", "comparator")


def in_order(tasks: Sequence[Task]) -> list[Task]:
    """The tasks of a study in the order in which they are measured.

    Tasks that need not run alone come first. Then come the flow in floats, its comparisons with other methods, orbits
    and first answers, which a study should have even if time is short. The other methods at each of their settings
    follow, those of :data:`STRONG` first. Bäcklund steps and the flow in more digits come last.
    """

    def place(task: Task) -> tuple[int, bool, float]:
        late = task.kind not in _ORDER or (task.kind == "flow" and (task.value or 0) > FLOAT_DIGITS)
        far = (task.value or MIDDLE) if task.kind == "horizon" else 0.0
        return len(_ORDER) if late else _ORDER.index(task.kind), task.method not in (*STRONG, FLOW), far

    return sorted(tasks, key=place)


def first_answer_tasks(scenes: Sequence[Scene], sources: Sequence[str]) -> list[Task]:
    """The tasks that measure first answers of the flow and of each method of :data:`STRONG`.

    They use the first body, the first system of any genus and the first deformation, as compiled code serves all
    systems of a kind.
    """
    tasks: dict[tuple[str, str], Task] = {}
    for scene, source in zip(scenes, sources, strict=True):
        if scene.steps is not None:
            continue
        system, _ = scene.start(FLOAT_DIGITS)
        sort = "body" if scene.rolls_or_spins else "classical" if scene.classical else "deformation"
        for name in (FLOW, *(name for name in STRONG if METHODS[name].takes(system))):
            tasks.setdefault((sort, name), Task(scene, source, "first answer", name, "first answer"))
    return list(tasks.values())


def _comparators(scene: Scene, task: Any, mode: str, truth: str) -> list[Task]:
    """The tasks of each method, cheapest setting first. If a setting runs out of time, costlier settings are skipped.

    Settings with as many digits as the truth are left out, because their rows would measure the truth's error.
    """
    tasks = []
    system, state = scene.start(FLOAT_DIGITS)
    for method in METHODS.values():
        if not method.takes(system):
            continue
        cheaper, chosen = None, list(zip(method.settings, method.ladder(system, state), strict=True))
        if method.parameter == "digits":
            chosen = [pair for pair in chosen if pair[0] < DIGITS[0]]
        for setting, value in chosen[1::3] if mode == "quick" else chosen:
            said = f"{value:.3g}" if method.parameter == "step" else f"{setting:g}"
            name = f"{method.parameter} {said}"
            tasks.append(task("comparator", method.name, name, value, truth, cheaper=cheaper))
            cheaper = tasks[-1].key
    return tasks
