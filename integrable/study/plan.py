"""The tasks of a measurement: each one scene × method × setting, and what it may take.

A study has for every scene its truth, its floor, the divisor flow, Bäcklund steps and every comparator
(:func:`tasks_of`); the run of a scene has what its own ``[report]`` asks for (:func:`tasks_of_run`). Both are measured
by :mod:`integrable.study.measure`.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from fractions import Fraction
from functools import cached_property
from hashlib import sha256
from math import inf
from typing import Any

from integrable.extras import APP, installed
from integrable.oracles.methods import METHODS
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from integrable.scene.doubles import in_doubles
from integrable.scene.output import portable
from integrable.scene.tables import DOP853
from integrable.study.store import code_stamp
from integrable.study.truth import DIGITS, INTEGRATED, moved_by, parts

__all__ = [
    "BACKLUND",
    "FLOW",
    "HORIZONS",
    "INTEGRATED",
    "LIMITS",
    "Limits",
    "Task",
    "compile_tasks",
    "tasks_of",
    "tasks_of_run",
]

FLOW = "divisor flow"
BACKLUND = "Bäcklund steps"


@dataclass(frozen=True)
class Limits:
    """How much a task may take: seconds for one run of a method, for a whole task, for a truth; repeats of a timing."""

    run: float
    task: float
    truth: float
    repeat: int
    check: float
    """Seconds for the Taylor series that the truth is held against."""
    check_time: Fraction | None = None
    """The one time at which it is; None: as far as these seconds allow."""
    patience: float = 3.0
    """Seconds of repeats after which a median of fewer runs is taken."""
    floor_times: float = 20
    """About how many of the scene's times the conditioning is the largest of."""


HORIZONS = {"quick": (1, 1000), "full": (1, 10, 100, 1000, 10_000, 100_000, 1_000_000)}
"""The single times, in time scales of the motion, at which the flow is held against the fastest that is good enough."""
LIMITS = {"quick": Limits(1.5, 60, 60, 3, 1.0), "full": Limits(3, 90, 240, 5, 8.0, patience=1.5)}


@dataclass(frozen=True)
class Task:
    """One unit of work: ``kind`` says which function of :mod:`integrable.study.measure` does it."""

    scene: Scene
    source: str
    """What the scene was loaded from: a name or a path."""
    kind: str
    method: str
    setting: str
    value: float | None = None
    limits: Limits = LIMITS["full"]
    truth: str | None = None
    """The key of the task with the truth, which has to be finished before."""
    cheaper: str | None = None
    """The key of that of the same method at the setting before: where that was stopped, this one is not tried."""
    kernel: str = "auto"
    """Of the flow of a body."""
    label: str = ""
    """What the progress bar of a run says, and in how many pieces."""
    pieces: int = 1

    @cached_property
    def key(self) -> str:
        """The name of the file of its row: no other task of the study has it, on any system."""
        words = [_plain(word) for word in (self.scene.name, self.kind, self.method, self.setting)]
        # names that differ in other letters alone would be one
        name = self.scene.name if words[0] != self.scene.name else ""
        return portable("--".join([*words, *([sha256(name.encode(errors="replace")).hexdigest()[:8]] if name else [])]))

    @cached_property
    def stamp(self) -> str:
        """A hash of all that the result depends on: scene, setting, limits, the code, the version of each library."""
        from integrable.scene.output import versions

        parts = [self.scene.describe(), self.kind, self.method, self.setting, self.value, asdict(self.limits)]
        text = json.dumps([*parts, code_stamp(), versions()], sort_keys=True)
        return sha256(text.encode()).hexdigest()[:16]

    @property
    def limit(self) -> float:
        """Seconds after which the task is given up."""
        return self.limits.truth if self.kind in ("truth", "floor", "horizon") else self.limits.task


def _plain(word: str) -> str:
    return "".join(c if c.isascii() and (c.isalnum() or c in "-.") else "_" for c in word.lower())


def tasks_of(scene: Scene, source: str, mode: str) -> list[Task]:
    """What a study, "quick" or "full", measures of a scene, in doubles; each task after what it needs."""
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
    tasks.append(task("first use", name, "first use"))
    if scene.rolls_or_spins or (scene.classical and system.discretized):
        counts = (30, 100) if mode == "quick" else (100, 1000, 3000)
        tasks += [task("backlund", BACKLUND, f"{n} steps", n, truth.key) for n in counts]
    # of three moments, not of two
    if scene.rolls_or_spins and not scene.tilted and all(system.body.differences):
        tasks.append(task("additions", BACKLUND, "near D and near −D"))
    tasks += _comparators(scene, task, mode, truth.key)
    if name == FLOW:
        tasks += [task("horizon", name, f"T = {T}", T) for T in HORIZONS[mode]]
    if all(map(installed, APP)):
        tasks.append(task("left out", name, "what the scene leaves out"))
    return tasks


def tasks_of_run(scene: Scene, digits: int) -> list[Task]:
    """What the scene's own ``[report]`` asks for, with the flow at ``digits`` digits: the truth first."""
    asked = scene.report
    assert asked is not None, "the scene has no [report]"
    limits = Limits(inf, inf, inf, asked.repeat, 0.0, asked.check_time, patience=10.0, floor_times=inf)

    def task(kind: str, method: str, setting: str, value: float, label: str, pieces: int = 1, **more: Any) -> Task:
        return Task(scene, scene.name, kind, method, setting, value, limits, label=label, pieces=pieces, **more)

    truth_digits, moved = max(asked.truth_digits, digits + 10), moved_by(scene.start(FLOAT_DIGITS)[0])
    pieces = len(parts(scene, FLOAT_DIGITS)) + 1
    tasks = [task("truth", moved, "truth", truth_digits, f"truth, {truth_digits} digits", pieces)]
    for cost in sorted({*asked.digits, digits}):
        setting = "floats" if cost <= FLOAT_DIGITS else f"{cost} digits"
        tasks.append(task("flow", moved, setting, cost, setting, asked.repeat, kernel="python"))
        if cost <= FLOAT_DIGITS and scene.rolls_or_spins:
            more: dict[str, Any] = {"pieces": asked.repeat, "kernel": "compiled"}
            tasks.append(task("flow", moved, "compiled", cost, "compiled floats", **more))
    for tolerance in map(float, asked.tolerances):
        shown = f"{tolerance:.0e}"
        name = f"tol {shown}".replace("e-0", "e-")
        tasks.append(task("tolerance", DOP853, name, tolerance, f"DOP853 at {shown}", asked.repeat))
    if asked.steps:
        tasks.append(task("growth", moved, "residual growth", len(asked.steps), "residual growth"))
    if moved != INTEGRATED:
        tasks.append(task("floor", "conditioning", "floor", FLOAT_DIGITS, "conditioning"))
    return tasks


def compile_tasks(scenes: Sequence[Scene], sources: Sequence[str]) -> list[Task]:
    """One task for each compiled method, on the first scene of a body that it takes: other systems run uncompiled, and
    code is compiled once for all scenes.
    """
    tasks: dict[str, Task] = {}
    for scene, source in zip(scenes, sources, strict=True):
        if scene.steps is not None or not scene.rolls_or_spins:
            continue
        system, _ = scene.start(FLOAT_DIGITS)
        names = [name for name, method in METHODS.items() if method.compiled and method.takes(system)]
        for name in (FLOW, *names):
            tasks.setdefault(name, Task(scene, source, "compile", name, "compile"))
    return list(tasks.values())


def _comparators(scene: Scene, task: Any, mode: str, truth: str) -> list[Task]:
    """A chain for each method, cheapest setting first: what has run out of time is not tried at a greater cost.

    Settings of as many digits as the truth has are left out: errors would be those of the truth.
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
            name = (
                f"{method.parameter} {value:.3g}" if method.parameter == "step" else f"{method.parameter} {setting:g}"
            )
            tasks.append(task("comparator", method.name, name, value, truth, cheaper=cheaper))
            cheaper = tasks[-1].key
    return tasks
