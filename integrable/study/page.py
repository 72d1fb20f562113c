"""A study as it is shown: the page, Markdown, and its answer on the terminal."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from integrable.scene.tables import aligned, duration, figure
from integrable.study.claims import claims
from integrable.study.columns import (
    BEHIND,
    LONG,
    ORBITS,
    SCENES,
    behind_cells,
    horizon_cells,
    horizon_name,
    long_cells,
    named,
    orbit_cells,
    scene_cells,
    shortened,
    words,
)
from integrable.study.findings import SceneFindings, Study
from integrable.study.plan import LIMITS

__all__ = ["answer", "introduction", "page", "scene_section", "sections"]

ORDER_TOLERANCE = 0.5
"""An observed order this near the order in theory agrees with it: step ladders reach few points of the asymptotics."""


def answer(study: Study) -> str:
    """The study on the terminal: rows where the flow is not ahead, then a line for each scene."""
    behind = [behind_cells(study, *entry) for entry in study.behind_by_method]
    lines = ["Rows where the divisor flow is not ahead:" if behind else "The divisor flow is ahead of every row."]
    if behind:
        lines += ["", *aligned([row[:-1] for row in (BEHIND, *behind)], left=2)]  # the page has room for the last
    lines += ["", *aligned([SCENES, *map(scene_cells, study.motions)], left=2)]
    if study.orbits:
        lines += ["", *aligned([ORBITS, *(cells for f in study.orbits for cells in orbit_cells(f))], left=2)]
    failures = [(f.scene.name, c) for f in study.findings for c in f.failures if c["row"]["kind"] != "comparator"]
    lines += [f"{name}: {named(c)}: {shortened(c['error'])}" for name, c in failures]
    return "\n".join(lines)


def page(study: Study) -> str:
    """The study as Markdown."""
    scenes = (scene_section(study, f) for f in study.findings)
    return "\n".join([f"# Error against run time\n\n{introduction(study)}", *sections(study).values(), *scenes])


def introduction(study: Study) -> str:
    """How it was measured, and on which machine, or machines where kept rows are another's."""
    return (
        f"Written by `{study.command}`. Every row is one scene × method × setting, measured in a process of its own; "
        "run times are medians and include set-up, not the compilation that the first use of a machine does once. "
        "Errors are the largest over components and times, of M relative to |M|, against the divisor flow at 40 digits "
        "or more, which is held against an integrator that shares no code with it. Of a system without a body q and p "
        "stand for γ and M, and errors of both are relative to the largest at the start or in their row.\n\n"
        "The inputs of a scene are doubles: its moments, d, γ, M and times are rounded to doubles before anything is "
        "computed, and every method starts from these. For doubles |γ| = 1 and, in scenes that are not tilted, "
        "(γ, M) = 0 hold to rounding; the truth and all that computes in more than doubles therefore start from γ/|γ| "
        "and from M without its part along γ, formed in their own precision. So does the flow in floats, whose set-up "
        "has 45 digits. What computes in doubles starts from the doubles as they are. The floor is eps·conditioning: "
        "what a change of every input in its last digit does to the state (`integrable.motion.conditioning`). "
        "An error below "
        f"the floor is that of a method whose inputs are taken as exact.\n\n{_machine(study)}"
    )


def sections(study: Study) -> dict[str, str]:
    """What is shown of all scenes, by name, each with its heading; without those that have nothing to show."""
    text = "Each is measured by the command above; the sections below have the figures."
    found = {
        "claims": _section("Claims", text, claims(study)),
        "horizons": _horizons(study),
        "rows": _not_ahead(study),
        "long": _long(study),
        "floor": _floor(study),
        "startup": _startup(study),
        "left out": _leaves_out(study),
        "orders": _orders(study),
        "orbits": _orbits(study),
        "additions": _additions(study),
        "failed": _failed(study),
    }
    return {name: section for name, section in found.items() if section}


def _machine(study: Study) -> str:
    versions = ", ".join(f"{name} {version}" for name, version in study.versions.items() if version)
    missing = f"\nNot part of this run: {', '.join(study.missing)}.\n" if study.missing else ""
    return (
        f"{study.machine['processor']}, {study.machine['cores']} cores, {study.machine['system']}; {versions}. "
        f"All rows together took {duration(study.seconds)}.\n{missing}"
    )


def _section(title: str, text: str, rows: Sequence[Sequence[str]]) -> str:
    """A heading, what the table shows, and the table; nothing where that is but its head."""
    return f"## {title}\n\n{text}\n\n{_markdown(rows)}" if len(rows) > 1 else ""


def _not_ahead(study: Study) -> str:
    title = "Rows where the divisor flow is not ahead"
    text = (
        "For each scene and method, how many of its rows no row of the flow beats in error in the same run time or "
        "less, and the most accurate of them; scenes with T ≥ 1000 first, then rows that are more accurate, then rows "
        "that are cheaper: done before the flow is. Overtaken after: the run time in which the flow is at least as "
        "accurate."
    )
    rows = [behind_cells(study, *entry) for entry in study.behind_by_method]
    return _section(title, text, [BEHIND, *rows]) or f"## {title}\n\n{text}\n\nNone.\n"


def _horizons(study: Study) -> str:
    text = (
        "How many times the run time of the flow in floats the fastest other method takes among those whose error is "
        "at most the flow's, or at most what rounding the inputs does: above 1 the flow is ahead; none: no setting of "
        "any method is so near. At one time T, in time scales of the motion, and at all times of the scene."
    )
    columns = study.horizons
    rows = [("scene", *map(horizon_name, columns)), *(horizon_cells(f, columns) for f in study.motions if f.standings)]
    return _section("The flow beside the fastest method that is near enough", text, rows)


def _long(study: Study) -> str:
    text = (
        "T is the last time, in the scene's unit or in time scales of its motion. Shown are the fastest row of the "
        "flow in floats, the fastest row of any comparator that has at most this error, the most accurate row that is "
        "done before, and the run time after which no row is left that the flow does not beat."
    )
    return _section("The scenes with T ≥ 1000", text, [LONG, *(long_cells(f) for f in study.motions if f.long)])


def _floor(study: Study) -> str:
    text = "The fastest row of the flow in floats. A ! marks a truth that its check does not confirm."
    if "floors" in study.figures:
        text += f"\n\n![Error over floor of every scene]({study.figures['floors']})"
    return _section("The flow's error and the floor", text, [SCENES, *map(scene_cells, study.motions)])


def _startup(study: Study) -> str:
    rows = [("scene", "fresh process", "of it the work", "set-up", "evaluation", "first use")]
    for f in study.findings:
        if f.first_use is not None and f.best is not None:
            first = f.first_use
            rows.append((
                f.scene.name,
                duration(first["total"]),
                duration(first["setup"]),
                duration(f.best["setup"]),
                duration(f.best["evaluation"]),
                f"{first['setup'] / f.best['total']:.0f} × a later one",
            ))  # fmt: skip
    compiled = [("method", "first call, nothing compiled", "first call, cache on disk", "later calls")]
    for f in study.findings:
        for content in f.compiled:
            r = content["result"]
            cells = (duration(r["total"]), duration(r["setup"]), duration(r["evaluation"]))
            compiled.append((content["row"]["method"], *cells))
    text = (
        "A fresh process: Python's own start, imports, set-up and all times, with compiled code in the cache on disk. "
        "Set-up and evaluation are those of a process that has run before."
    )
    parts = [_section("Set-up, first use and compilation", text, rows)]
    if len(compiled) > 1:
        parts.append(_markdown(compiled))
    return "\n".join(part for part in parts if part)


def _megabytes(size: int | None, without: int | None = 0) -> str:
    """A size of memory less another, None where the system does not tell."""
    return "–" if size is None or without is None else f"{(size - without) / 1e6:.0f} MB"


def _leaves_out(study: Study) -> str:
    rows = [("scene", "imported", "not imported", "way", "process", "saved", "memory", "saved")]
    for f in study.findings:
        if f.left_out is None:
            continue
        asked, everything = f.left_out["asked"], f.left_out["everything"]
        rest = [name for name in everything["heavy"] if name not in asked["heavy"]]
        rows.append((
            f.scene.name,
            ", ".join(asked["heavy"]),
            ", ".join(rest),
            asked["way"],
            duration(asked["total"]),
            duration(everything["total"] - asked["total"]),
            _megabytes(asked["memory"]),
            _megabytes(everything["memory"], asked["memory"]),
        ))  # fmt: skip
    text = (
        "γ and M at the scene's times in a fresh process, beside everything that could be computed of the same motion: "
        "every library imported, compiled kernels, angular velocity, attitude, contact, integrals, the clock in τ, "
        "100 000 successive steps, the picture. The way is what has computed the states (Trajectory.way)."
    )
    return _section("What a scene leaves out", text, rows)


def _orders(study: Study) -> str:
    rows = [("scene", "method", "observed order", "in theory", "verdict")]
    for f in study.findings:
        for name, slope, order in f.slopes():
            agrees = order is not None and abs(slope - order) <= ORDER_TOLERANCE
            rows.append((f.scene.name, name, f"{slope:.2f}", str(order), "agrees" if agrees else "differs"))
    text = "Slope of log error against log step, above the plateau of rounding and below 0.1."
    return _section("Orders of the fixed-step methods", text, rows)


def _orbits(study: Study) -> str:
    text = (
        "Over a finite field errors are 0 and only the cost counts; the last column holds the end of the orbit against "
        "one addition of the multiple."
    )
    return _section("Orbits of Bäcklund maps", text, [ORBITS, *(c for f in study.orbits for c in orbit_cells(f))])


def _additions(study: Study) -> str:
    found = [(f.scene.name, f.additions["rows"]) for f in study.findings if f.additions is not None]
    distances = [row["distance"] for row in found[0][1]] if found else []
    rows: list[tuple[str, ...]] = [("scene", "sum", *(f"δ = {distance:.0e}" for distance in distances))]
    for name, additions in found:
        for key, shown in (("doubling", "D + D′"), ("opposite", "D′ − D")):
            cells = (row[key] for row in additions)
            rows.append((name, shown, *(c.split(":")[0] if isinstance(c, str) else figure(c) for c in cells)))
    text = (
        "One addition in floats of D and D′ = D(τ + δ), both rounded to floats: the error of U, or what is raised. "
        "Near −D the sum is nearly zero, its points are δ² away from a double point, and rounding the inputs alone "
        "costs eps/δ and more; small steps are therefore built from offsets (docs/flow.md). "
        "`python -m benchmarks composition` compares with the textbook's composition."
    )
    return _section("D′ near D and near −D", text, rows)


def _failed(study: Study) -> str:
    rows = [("scene", "row", "what it says")]
    for f in study.findings:
        groups: dict[tuple[str, str], list[dict[str, Any]]] = {}
        for content in f.failures:
            alike = re.sub(r"[0-9.e+-]+", "", content["error"])
            groups.setdefault((content["row"]["method"], alike), []).append(content)
        for (method, _), group in groups.items():
            settings = ", ".join(content["row"]["setting"] for content in group)
            rows.append((f.scene.name, f"{method}: {settings}", shortened(group[0]["error"])))
    limits = LIMITS[study.mode]
    text = (
        f"A run may take {limits.run:g} s, a row {limits.task:g} s. "
        "Of rows that say the same but for numbers the first is shown."
    )
    return _section("Rows without a figure", text, rows)


def scene_section(study: Study, found: SceneFindings) -> str:
    """A scene: its figure and its rows."""
    scene = found.scene
    lines = [f"## {scene.name}: {scene.title}\n", " ".join(scene.description.split()) + "\n"]
    if scene.name in study.figures:
        lines.append(f"![Error against run time: {scene.title}]({study.figures[scene.name]})\n")
    contents = [*found.flow, *found.backlund, *found.comparators]
    if contents:
        names = list(contents[0]["result"]["drift"])
        heads = (f"error {letter}" for letter in scene.letters)
        rows = [("method", "setting", "run time", *heads, *(f"Δ{name}" for name in names), "runs")]
        for content in contents:
            r = content["result"]
            drifts = (figure(r["drift"][name], 1) for name in names)
            errors = (figure(r["error_gamma"]), figure(r["error_M"]))
            rows.append((*words(content), duration(r["total"]), *errors, *drifts, str(r["runs"])))
        lines.append(_markdown(rows))
    return "\n".join(lines)


def _markdown(rows: Sequence[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + "---|" * len(rows[0]), *lines[1:]]) + "\n"
