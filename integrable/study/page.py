"""The page of a study, Markdown, and its answer on the terminal: claims with verdicts, rows behind, every scene."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from integrable.scene.tables import aligned, duration, figure
from integrable.study.findings import SCENE_FLOOR_FACTOR, Behind, SceneFindings
from integrable.study.plan import LIMITS

__all__ = ["Study", "answer", "page"]

ORDER_TOLERANCE = 0.5
"""An observed order this near the order in theory agrees with it: step ladders reach few points of the asymptotics."""
SHORT = 110
"""Characters of an error message that a table shows; the row's file has it whole."""


@dataclass(frozen=True)
class Study:
    """All that the page shows."""

    findings: list[SceneFindings]
    mode: str
    command: str
    versions: dict[str, str | None]
    machine: dict[str, Any]
    figures: dict[str, str]
    """Paths of the figures of the scenes, and of ``floors``, relative to the page."""
    seconds: float
    """The sum of the times of all rows."""
    missing: tuple[str, ...] = ()
    """Scenes that ship and are not part of this study."""

    @property
    def behind(self) -> list[Behind]:
        """Rows of comparators that the flow does not beat: scenes with T ≥ 1000 first, then what is more accurate than
        the flow in the same time, then what is done before the flow is; each by the run time, longest first.
        """
        found = [(f, b) for f in self.findings for b in f.behind()]
        order = sorted(
            found, key=lambda one: (not one[0].long, one[1].flow_error is None, -one[1].row["result"]["total"])
        )
        return [b for _, b in order]

    @property
    def behind_by_method(self) -> list[tuple[Behind, int]]:
        """For each scene and method the most accurate of :attr:`behind` and how many there are, in the same order."""
        groups: dict[tuple[str, str], list[Behind]] = {}
        for behind in self.behind:
            groups.setdefault((behind.scene, behind.row["row"]["method"]), []).append(behind)
        return [(min(group, key=lambda b: b.row["result"]["error_gamma"]), len(group)) for group in groups.values()]

    def of(self, name: str) -> SceneFindings:
        """The findings of one scene."""
        return next(f for f in self.findings if f.scene.name == name)


def answer(study: Study) -> str:
    """The study on the terminal: rows where the flow is not ahead, then a line for each scene."""
    behind = [_behind_cells(study, *entry) for entry in study.behind_by_method]
    lines = ["Rows where the divisor flow is not ahead:" if behind else "The divisor flow is ahead of every row."]
    if behind:
        lines += ["", *aligned([row[:-1] for row in (_BEHIND, *behind)], left=2)]  # the page has room for the last
    lines += ["", *aligned([_SCENES, *(_scene_cells(f) for f in study.findings if f.scene.steps is None)], left=2)]
    orbits = [f for f in study.findings if f.orbit is not None]
    if orbits:
        lines += ["", *aligned([_ORBITS, *(cells for f in orbits for cells in _orbit_cells(f))], left=2)]
    failures = [(f.scene.name, c) for f in study.findings for c in f.failures if c["row"]["kind"] != "comparator"]
    lines += [f"{name}: {_named(c)}: {_cut(c['error'])}" for name, c in failures]
    return "\n".join(lines)


def page(study: Study) -> str:
    """The study as Markdown."""
    parts = [
        "# Error against run time\n\n"
        f"Written by `{study.command}`. Every row is one scene × method × setting, measured in a process of its own; "
        "run times are medians and include set-up, not the compilation that the first use of a machine does once. "
        "Errors are the largest over components and times, of M relative to |M|, against the divisor flow at 40 digits "
        "or more, which is held against an integrator that shares no code with it.\n\n"
        "The inputs of a scene are doubles: its moments, d, γ, M and times are rounded to doubles before anything is "
        "computed, and every method starts from these. For doubles |γ| = 1 and, in scenes that are not tilted, "
        "(γ, M) = 0 hold to rounding; the truth and all that computes in more than doubles therefore start from γ/|γ| "
        "and from M without its part along γ, formed in their own precision. So does the flow in floats, whose set-up "
        "has 45 digits. What computes in doubles starts from the doubles as they are. The floor is eps·conditioning: "
        "what a change of every input in its last digit does to the state (`integrable.motion.conditioning`). "
        "An error below "
        "the floor is that of a method whose inputs are taken as exact.\n",
        _machine(study),
        _claims(study),
        _not_ahead(study),
        _long_section(study),
        _floor_section(study),
        _startup(study),
        _leaves_out(study),
        _orders(study),
        _orbit_section(study),
        _additions(study),
        _failed(study),
        *(_scene_section(study, f) for f in study.findings),
    ]
    return "\n".join(part for part in parts if part)


def _machine(study: Study) -> str:
    versions = ", ".join(f"{name} {version}" for name, version in study.versions.items() if version)
    missing = f"\nNot part of this run: {', '.join(study.missing)}.\n" if study.missing else ""
    return (
        f"{study.machine['processor']}, {study.machine['cores']} cores, {study.machine['system']}; {versions}. "
        f"All rows together took {duration(study.seconds)}.\n{missing}"
    )


def _claims(study: Study) -> str:
    motions = [f for f in study.findings if f.scene.steps is None]
    rows = [("claim", "measurement", "verdict")]
    known = [(f.scene.name, f.over_floor, f.cause) for f in study.findings if f.over_floor is not None]
    over = [one for one in known if one[1] > SCENE_FLOOR_FACTOR]
    unknown = [f.scene.name for f in study.findings if f.over_floor is None and not f.scene.finite_field]
    rows.append((
        "The flow, or the orbit, in floats is within 10 times the floor on every scene.",
        f"{len(known) - len(over)} of {len(known) + len(unknown)} scenes"
        + "".join(f"; {name}: {_times(factor)}, {cause}" for name, factor, cause in over)
        + "".join(f"; {name}: see the failures" for name in unknown),
        _verdict(not over and not unknown),
    ))  # fmt: skip
    far = {f.scene.name for f in motions if f.long}
    behind = [b for b in study.behind if b.scene in far]
    compared = sum(len(f.comparators) for f in motions if f.long)
    rows.append((
        "The flow is ahead of every comparator in error at equal run time on scenes with T ≥ 1000.",
        f"{compared - len(behind)} of {compared} rows on {len(far)} scenes; of the others "
        f"{sum(b.cheaper for b in behind)} are done before the flow is, "
        f"{sum(not b.cheaper for b in behind)} are more accurate",
        _verdict(not behind),
    ))  # fmt: skip
    truths = [f for f in motions if f.truth is not None]
    doubtful = [f.scene.name for f in truths if f.doubtful]
    rows.append((
        "The truth agrees with an independent integrator.",
        f"{len(truths) - len(doubtful)} of {len(motions)} scenes" + "".join(f"; not {name}" for name in doubtful),
        _verdict(not doubtful and len(truths) == len(motions)),
    ))  # fmt: skip
    silent = [f.scene.name for f in study.findings if f.silently_wrong]
    stopped = [f.scene.name for f in study.findings for c in f.failures if c["stopped"] and c["row"]["kind"] == "flow"]
    refused = [f.scene.name for f in study.findings for c in f.failures if c["row"]["kind"] in ("flow", "orbit")]
    rows.append((
        "No scene crashes, hangs or returns a wrong value without saying so.",
        f"{len(refused)} rows of the flow raised a named error, {len(stopped)} were stopped, {len(silent)} are wrong "
        "by more than 10⁻⁶ and 1000 floors" + "".join(f"; {name}" for name in silent),
        _verdict(not silent and not stopped),
    ))  # fmt: skip
    exact = [f for f in study.findings if f.orbit is not None and f.scene.finite_field]
    if exact:
        wrong = [f for f in exact if f.orbit and (any(f.orbit["rows"][0]["drift"].values()) or f.orbit["jump"])]
        rows.append((
            "Orbits over finite fields are exact.",
            f"{len(exact) - len(wrong)} of {len(exact)} orbits keep every integral and end where one addition does",
            _verdict(not wrong),
        ))  # fmt: skip
    return "## Claims\n\nEach is measured by the command above; the sections below have the figures.\n\n" + _markdown(
        rows
    )


def _times(factor: float) -> str:
    return f"{factor:.0f} times" if factor < 1e4 else f"{factor:.0e} times"


def _verdict(holds: bool) -> str:
    return "holds" if holds else "does not hold"


_BEHIND = (
    "scene",
    "method",
    "rows",
    "best of them",
    "run time",
    "error γ",
    "flow in that time",
    "floor",
    "overtaken after",
    "how far off",
)


def _behind_cells(study: Study, behind: Behind, count: int) -> tuple[str, ...]:
    row, found = behind.row["result"], study.of(behind.scene)
    floor, name = found.floor, behind.scene if found.moved_by_divisors else f"{behind.scene}, integrated: no divisors"
    least = f"{figure(behind.flow_error)}" if behind.flow_error is not None else _none_yet(behind)
    named = (name, behind.row["row"]["method"], str(count), behind.row["row"]["setting"])
    return (
        *named,
        duration(row["total"]),
        figure(row["error_gamma"]),
        least,
        figure(floor["floor_gamma"] if floor else None),
        "never" if behind.overtaken is None else duration(behind.overtaken),
        _how_far(behind),
    )


def _none_yet(behind: Behind) -> str:
    return "no flow" if behind.first is None else f"none, takes {duration(behind.first['total'])}"


def _how_far(behind: Behind) -> str:
    """What a row that the flow does not beat has before it, in errors and in run times."""
    row = behind.row["result"]
    if behind.cheaper and behind.first is not None:
        error, time = (row[key] / (behind.first[key] or row[key] or 1) for key in ("error_gamma", "total"))
        return f"cheaper: {error:.2g} × the flow's error in {time:.2g} of its time"
    if behind.overtaken is None:
        return "more accurate than any row of the flow"
    return f"more accurate: the flow needs {behind.overtaken / row['total']:.2g} × its time"


def _not_ahead(study: Study) -> str:
    head = (
        "## Rows where the divisor flow is not ahead\n\nFor each scene and method, how many of its rows no row of the "
        "flow beats in error in the same run time or less, and the most accurate of them; scenes with T ≥ 1000 first, "
        "then rows that are more accurate, then rows that are cheaper: done before the flow is. Overtaken after: the "
        "run time in which the flow is at least as accurate.\n\n"
    )
    behind = [_behind_cells(study, *entry) for entry in study.behind_by_method]
    return head + (_markdown([_BEHIND, *behind]) if behind else "None.\n")


_LONG = (
    "scene",
    "flow",
    "run time",
    "error γ",
    "fastest as accurate",
    "run time",
    "× the flow's",
    "most accurate before the flow",
    "error γ",
    "all overtaken after",
)


def _long_cells(found: SceneFindings) -> tuple[str, ...]:
    best = found.best
    if best is None:
        return (found.scene.name, "failed", *["–"] * 8)
    reached, before, behind = found.as_accurate, found.before, found.behind()
    never = any(b.overtaken is None for b in behind)
    last = max((b.overtaken or 0.0 for b in behind), default=best["total"])
    return (
        found.scene.name,
        _way(found),
        duration(best["total"]),
        figure(best["error_gamma"]),
        "none" if reached is None else ", ".join(_words(reached)),
        "–" if reached is None else duration(reached["result"]["total"]),
        "–" if reached is None else f"{reached['result']['total'] / best['total']:.2g}",
        "none" if before is None else ", ".join(_words(before)),
        "–" if before is None else figure(before["result"]["error_gamma"]),
        "never" if never else duration(last),
    )


def _way(found: SceneFindings) -> str:
    """The setting of the flow's fastest row in floats, and whether it adds no divisors."""
    setting: str = next((c["row"]["setting"] for c in found.flow if c["result"] is found.best), "failed")
    return setting if found.moved_by_divisors or not found.flow else f"{setting}, integrated: no divisors"


def _long_section(study: Study) -> str:
    far = [f for f in study.findings if f.scene.steps is None and f.long]
    if not far:
        return ""
    return (
        "## The scenes with T ≥ 1000\n\n"
        "T is the last time, in the scene's unit or in time scales of its motion. Shown are the fastest row of the "
        "flow in floats, the fastest row of any comparator that has at most this error, the most accurate row that is "
        "done before, and the run time after which no row is left that the flow does not beat.\n\n"
        + _markdown([_LONG, *map(_long_cells, far)])
    )


_SCENES = (
    "scene",
    "flow",
    "error γ",
    "floor γ",
    "error M",
    "floor M",
    "over floor",
    "run time",
    "truth",
    "check to t",
    "differs",
)


def _scene_cells(found: SceneFindings) -> tuple[str, ...]:
    best, floor, truth = found.best or {}, found.floor or {}, found.truth
    over = "–" if found.over_floor is None else f"{found.over_floor:.2g}"
    checked: tuple[str, ...] = ("failed", "–", "–")
    if truth is not None and truth["check"] is None:
        checked = (f"Taylor, {truth['digits']} digits", "–", "!")
    elif truth is not None:
        check = truth["check"]
        differs = figure(max(check["error_gamma"], check["error_M"]), 1) + (" !" if found.doubtful else "")
        checked = (f"{truth['digits']} digits", f"{check['time']:.3g}", differs)
    return (
        found.scene.name,
        _way(found),
        figure(best.get("error_gamma")),
        figure(floor.get("floor_gamma"), 1),
        figure(best.get("error_M")),
        figure(floor.get("floor_M"), 1),
        over,
        duration(best.get("total")),
        *checked,
    )


def _floor_section(study: Study) -> str:
    motions = [f for f in study.findings if f.scene.steps is None]
    if not motions:
        return ""
    picture = f"![Error over floor of every scene]({study.figures['floors']})\n\n" if "floors" in study.figures else ""
    return (
        "## The flow's error and the floor\n\n"
        "The fastest row of the flow in floats. A ! marks a truth that its check does not confirm.\n\n"
        + picture
        + _markdown([_SCENES, *map(_scene_cells, motions)])
    )


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
    parts = []
    if len(rows) > 1:
        parts.append(
            "## Set-up, first use and compilation\n\nA fresh process: Python's own start, imports, set-up and all "
            "times, with compiled code in the cache on disk. Set-up and evaluation are those of a process that has run "
            "before.\n\n" + _markdown(rows)
        )
    if len(compiled) > 1:
        parts.append(_markdown(compiled))
    return "\n".join(parts)


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
    if len(rows) == 1:
        return ""
    return (
        "## What a scene leaves out\n\nγ and M at the scene's times in a fresh process, beside everything that could "
        "be computed of the same motion: every library imported, compiled kernels, angular velocity, attitude, "
        "contact, integrals, the clock in τ, 100 000 successive steps, the picture. The way is what has "
        "computed the states (Trajectory.way).\n\n" + _markdown(rows)
    )


def _orders(study: Study) -> str:
    rows = [("scene", "method", "observed order", "in theory", "verdict")]
    for f in study.findings:
        for name, slope, order in f.slopes():
            agrees = order is not None and abs(slope - order) <= ORDER_TOLERANCE
            rows.append((f.scene.name, name, f"{slope:.2f}", str(order), "agrees" if agrees else "differs"))
    if len(rows) == 1:
        return ""
    return (
        "## Orders of the fixed-step methods\n\nSlope of log error against log step, above the plateau of rounding and "
        "below 0.1.\n\n" + _markdown(rows)
    )


_ORBITS = ("orbit", "map", "steps", "setting", "error γ", "floor γ", "error M", "floor M", "drift", "per step", "end")


def _orbit_cells(found: SceneFindings) -> list[tuple[str, ...]]:
    assert found.orbit is not None
    floor, jump = found.floor or {}, found.orbit["jump"]
    rows: list[tuple[str, ...]] = []
    for row in found.orbit["rows"]:
        real = row["digits"] is not None
        rows.append((
            found.scene.name,
            found.orbit["map"] if len(found.orbit["map"]) < 40 else found.orbit["map"][:37] + "…",
            str(found.orbit["count"]),
            row["setting"] if real else found.scene.finite_field,
            figure(row["error_gamma"]),
            figure(floor.get("floor_gamma"), 1) if row is found.judged else "–",
            figure(row["error_M"]),
            figure(floor.get("floor_M"), 1) if row is found.judged else "–",
            figure(max(row["drift"].values()), 1),
            duration(row["seconds_per_step"]),
            "–" if jump is None else "exact" if jump == 0 else figure(jump, 1),
        ))  # fmt: skip
    return rows


def _orbit_section(study: Study) -> str:
    found = [cells for f in study.findings if f.orbit is not None for cells in _orbit_cells(f)]
    if not found:
        return ""
    return (
        "## Orbits of Bäcklund maps\n\nOver a finite field errors are 0 and only the cost counts; the last column "
        "holds the end of the orbit against one addition of the multiple.\n\n" + _markdown([_ORBITS, *found])
    )


def _additions(study: Study) -> str:
    found = [(f.scene.name, f.additions["rows"]) for f in study.findings if f.additions is not None]
    if not found:
        return ""
    head = ("scene", "sum", *(f"δ = {row['distance']:.0e}" for row in found[0][1]))
    rows: list[tuple[str, ...]] = [head]
    for name, additions in found:
        for key, shown in (("doubling", "D + D′"), ("opposite", "D′ − D")):
            cells = (row[key] for row in additions)
            rows.append((name, shown, *(c.split(":")[0] if isinstance(c, str) else figure(c) for c in cells)))
    return (
        "## D′ near D and near −D\n\nOne addition in floats of D and D′ = D(τ + δ), both rounded to floats: the error "
        "of U, or what is raised. Near −D the sum is nearly zero, its points are δ² away from a double point, "
        "and rounding the inputs alone costs eps/δ and more; small steps are therefore built from offsets "
        "(docs/flow.md). `python -m benchmarks composition` compares with the textbook's composition.\n\n"
        + _markdown(rows)
    )


def _failed(study: Study) -> str:
    rows = [("scene", "row", "what it says")]
    for f in study.findings:
        groups: dict[tuple[str, str], list[dict[str, Any]]] = {}
        for content in f.failures:
            alike = re.sub(r"[0-9.e+-]+", "", content["error"])
            groups.setdefault((content["row"]["method"], alike), []).append(content)
        for (method, _), group in groups.items():
            settings = ", ".join(content["row"]["setting"] for content in group)
            rows.append((f.scene.name, f"{method}: {settings}", _cut(group[0]["error"])))
    if len(rows) == 1:
        return ""
    limits = LIMITS[study.mode]
    return (
        f"## Rows without a figure\n\nA run may take {limits.run:g} s, a row {limits.task:g} s. Of rows that say the "
        "same but for numbers the first is shown.\n\n" + _markdown(rows)
    )


def _scene_section(study: Study, found: SceneFindings) -> str:
    scene = found.scene
    lines = [f"## {scene.name}: {scene.title}\n", " ".join(scene.description.split()) + "\n"]
    if scene.name in study.figures:
        lines.append(f"![Error against run time: {scene.title}]({study.figures[scene.name]})\n")
    contents = [*found.flow, *found.backlund, *found.comparators]
    if contents:
        names = list(contents[0]["result"]["drift"])
        rows = [("method", "setting", "run time", "error γ", "error M", *(f"Δ{name}" for name in names), "runs")]
        for content in contents:
            r = content["result"]
            drifts = (figure(r["drift"][name], 1) for name in names)
            errors = (figure(r["error_gamma"]), figure(r["error_M"]))
            rows.append((*_words(content), duration(r["total"]), *errors, *drifts, str(r["runs"])))
        lines.append(_markdown(rows))
    return "\n".join(lines)


def _words(content: dict[str, Any]) -> tuple[str, str]:
    return content["row"]["method"], content["row"]["setting"]


def _named(content: dict[str, Any]) -> str:
    return ", ".join(_words(content))


def _cut(text: str) -> str:
    return text if len(text) <= SHORT else text[: SHORT - 1] + "…"


def _markdown(rows: Sequence[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + "---|" * len(rows[0]), *lines[1:]]) + "\n"
