"""Which rows a study has: for every scene its truth, its floor, the divisor flow, Bäcklund steps, every comparator."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from hashlib import sha256
from typing import Any

from integrable.extras import APP, installed
from integrable.oracles.methods import METHODS
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import Scene
from integrable.scene.output import portable
from integrable.study.doubles import in_doubles
from integrable.study.store import code_stamp
from integrable.study.truth import DIGITS, is_divisor_flow

__all__ = ["BACKLUND", "FLOW", "INTEGRATED", "LIMITS", "Limits", "Row", "compile_rows", "rows_of"]

FLOW = "divisor flow"
INTEGRATED = "extrapolation"
"""What the package moves by where no divisor flow is known."""
BACKLUND = "Bäcklund steps"


@dataclass(frozen=True)
class Limits:
    """How much a study may take: seconds for one run of a method, for a whole row, for a truth; repeats of a timing."""

    run: float
    row: float
    truth: float
    repeat: int
    check: float
    """Seconds for the Taylor series that the truth is held against."""


LIMITS = {"quick": Limits(1.5, 60, 60, 3, 1.0), "full": Limits(6, 90, 240, 5, 8.0)}


@dataclass(frozen=True)
class Row:
    """One unit of work: ``kind`` says which function of :mod:`integrable.study.measure` does it."""

    scene: Scene
    source: str
    """What the scene was loaded from: a name or a path."""
    kind: str
    method: str
    setting: str
    value: float | None = None
    mode: str = "full"
    truth: str | None = None
    """The key of the row with the truth, which has to be finished before."""
    cheaper: str | None = None
    """The key of the row of the same method at the setting before: where that was stopped, this one is not tried."""

    @cached_property
    def key(self) -> str:
        """The name of the row's file: no other row of the study has it, on any system."""
        words = [_plain(word) for word in (self.scene.name, self.kind, self.method, self.setting)]
        # names that differ in other letters alone would be one
        name = self.scene.name if words[0] != self.scene.name else ""
        return portable("--".join([*words, *([sha256(name.encode(errors="replace")).hexdigest()[:8]] if name else [])]))

    @cached_property
    def stamp(self) -> str:
        """A hash of all that the result depends on: scene, setting, limits, the code, the version of each library."""
        from integrable.scene.output import versions

        limits = asdict(LIMITS[self.mode])
        parts = [self.scene.describe(), self.kind, self.method, self.setting, self.value, limits, code_stamp()]
        text = json.dumps([*parts, versions()], sort_keys=True)
        return sha256(text.encode()).hexdigest()[:16]

    @property
    def limit(self) -> float:
        """Seconds after which the row is given up."""
        limits = LIMITS[self.mode]
        return limits.truth if self.kind in ("truth", "floor") else limits.row


def _plain(word: str) -> str:
    return "".join(c if c.isascii() and (c.isalnum() or c in "-.") else "_" for c in word.lower())


def rows_of(scene: Scene, source: str, mode: str) -> list[Row]:
    """The rows of a scene in doubles (:mod:`.doubles`), each after what it needs."""
    scene = in_doubles(scene)

    def row(kind: str, method: str, setting: str, value: float | None = None, *needed: str) -> Row:
        return Row(scene, source, kind, method, setting, value, mode, *needed)

    if scene.steps is not None:
        rows = [row("orbit", BACKLUND, scene.finite_field or "floats")]
        return rows if scene.finite_field else [*rows, row("floor", "conditioning", "floor")]
    truth = row("truth", "truth", "twice the digits")
    rows = [truth, row("floor", "conditioning", "floor")]
    name = FLOW if is_divisor_flow(scene.start(FLOAT_DIGITS)[0]) else INTEGRATED
    costs = ["floats", "compiled", "30 digits"] if scene.rolls_or_spins else ["floats", "30 digits"]
    rows += [row("flow", name, cost, None, truth.key) for cost in costs]
    rows.append(row("first use", name, "first use"))
    if scene.rolls_or_spins:
        counts = (30, 100) if mode == "quick" else (100, 1000, 3000)
        rows += [row("backlund", BACKLUND, f"{n} steps", n, truth.key) for n in counts]
        if not scene.tilted and all(scene.body(FLOAT_DIGITS).body.differences):  # of three moments, not of two
            rows.append(row("additions", BACKLUND, "near D and near −D"))
    rows += _comparators(scene, row, mode, truth.key)
    if all(map(installed, APP)):
        rows.append(row("left out", name, "what the scene leaves out"))
    return rows


def compile_rows(scenes: Sequence[Scene], sources: Sequence[str]) -> list[Row]:
    """One row for each compiled method, on the first scene that it takes: code is compiled once for all scenes."""
    rows: dict[str, Row] = {}
    for scene, source in zip(scenes, sources, strict=True):
        if scene.steps is not None:
            continue
        system, _ = scene.start(FLOAT_DIGITS)
        names = [name for name, method in METHODS.items() if method.compiled and method.takes(system)]
        for name in [FLOW, *names] if scene.rolls_or_spins else names:
            rows.setdefault(name, Row(scene, source, "compile", name, "compile"))
    return list(rows.values())


def _comparators(scene: Scene, row: Any, mode: str, truth: str) -> list[Row]:
    """A chain for each method, cheapest setting first: what has run out of time is not tried at a greater cost.

    Settings of as many digits as the truth has are left out: errors would be those of the truth.
    """
    rows = []
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
            rows.append(row("comparator", method.name, name, value, truth, cheaper))
            cheaper = rows[-1].key
    return rows
