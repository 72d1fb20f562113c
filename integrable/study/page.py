"""A study as a page of Markdown, and its summary on the terminal."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from typing import Any

from integrable.scene.tables import aligned, duration, figure, plain_power
from integrable.study.claims import claims
from integrable.study.columns import (
    BEHIND,
    ORBITS,
    SCATTERS,
    SCENES,
    behind_cells,
    factor,
    horizon_cells,
    horizon_name,
    named,
    orbit_cells,
    ratio_cell,
    scene_cells,
    shortened,
    taken,
    words,
)
from integrable.study.findings import SceneFindings, Study
from integrable.study.plan import LIMITS

__all__ = ["answer", "in_one_minute", "introduction", "page", "scene_section", "sections"]

BUSY = 1.5
"""A load above this is not due to this study alone."""
NO_OTHERS = "No row of another method was measured."
ORDER_TOLERANCE = 0.5
"""An observed order agrees with the order in theory if they differ by at most this. The tolerance is wide because few
of the steps are in the asymptotic range.
"""


def answer(study: Study) -> str:
    """The text of a study for the terminal: rows where the flow is not ahead, a line for each scene, and failures."""
    behind = [behind_cells(study, *entry) for entry in study.behind_by_method]
    none = "The divisor flow is ahead of every row." if any(f.comparators for f in study.motions) else NO_OTHERS
    lines = ["Rows where the divisor flow is not ahead:" if behind else none]
    if behind:
        lines += ["", *aligned([row[:-1] for row in (BEHIND, *behind)], left=2)]  # only the page has the last column
    lines += ["", *aligned([SCENES, *map(scene_cells, study.motions)], left=2)]
    if study.orbits:
        lines += ["", *aligned([ORBITS, *(cells for f in study.orbits for cells in orbit_cells(f))], left=2)]
    failures = [(f.scene.name, c) for f in study.findings for c in f.failures if c["row"]["kind"] != "comparator"]
    lines += [f"{name}: {named(c)}: {shortened(c['error'])}" for name, c in failures]
    return "\n".join(lines)


def page(study: Study) -> str:
    """The study as Markdown."""
    scenes = (scene_section(study, f) for f in study.findings)
    head = f"# Error against run time\n\n{in_one_minute(study)}\n\n## How it was measured\n\n{introduction(study)}"
    return "\n".join([head, *sections(study).values(), *scenes])


def in_one_minute(study: Study) -> str:
    """The summary: where the flow is faster and by how much, where other methods are faster, and where no other method
    is as accurate.
    """
    text = (
        "States are requested at one time T, in time scales of the motion (a body turns by about a radian in one), or "
        "at all times of the scene. The flow is compared with the fastest other method whose error is at most the "
        "flow's, or at most the effect of rounding the inputs to doubles. For both, a run time counts the set-up of "
        "one start and the evaluation, with code already compiled. The last column has the run time of the other "
        "method divided by the flow's: its least, median and largest value over the scenes where another method is as "
        "accurate. Above 1 the flow is faster."
    )
    return f"{text}\n\n{_markdown(_summary(study))}\n{_exceptions(study)}"


def _summary(study: Study) -> list[tuple[str, ...]]:
    """The head of the table, then a row for each time T: the number of scenes with each outcome, and the range of the
    other methods' run times divided by the flow's.
    """
    outcomes = ("flow faster", "another faster", "no other as accurate", "others could not run", "flow refused")
    rows: list[tuple[str, ...]] = [
        ("at", "scenes", *outcomes, "time of fastest other ÷ flow: least … median … most"),
    ]
    for T in study.horizons:
        found = [standing for f in study.motions for standing in f.standings if standing.T == T]
        ahead = [s for s in found if s.outcome == "slower" or (s.outcome == "met" and s.ratio >= 1)]
        met = sorted(s.ratio for s in found if s.outcome == "met")
        counts = (
            len(ahead),
            len(met) - sum(r >= 1 for r in met),
            *(sum(s.outcome == name for s in found) for name in ("none", "stopped")),
            refused := sum(T in f.refused for f in study.motions),
        )
        spread = " … ".join(map(factor, (met[0], met[len(met) // 2], met[-1]))) if met else "–"
        rows.append((horizon_name(T), str(len(found) + refused), *map(str, counts), spread))
    return rows


def _exceptions(study: Study) -> str:
    """A text that says where other methods are faster, where none is as accurate, and where the flow refused."""
    far = [s for f in study.motions for s in f.standings if s.outcome == "met" and s.ratio < 1]
    faster = sorted({T for T in (s.T for s in far) if T is not None})
    said = (
        f"**Others are faster** in {len(far)} of these cases, at T = {plain_power(faster[0])} … "
        f"{plain_power(faster[-1])}: "
        "for short times and single outputs an integrator that is already compiled is the better choice. "
        if faster
        else ""
    )
    alone = [
        f"{f.scene.name} ({', '.join(horizon_name(s.T) for s in f.standings if s.outcome == 'none')})"
        for f in study.motions
        if any(s.outcome == "none" for s in f.standings)
    ]
    nobody = f"**No other method is as accurate** on {'; '.join(alone)}. " if alone else ""
    gone = [f"{f.scene.name} ({', '.join(map(horizon_name, f.refused))})" for f in study.motions if f.refused]
    lost = f"**The flow refused** {'; '.join(gone)}, with the reason below. " if gone else ""
    return said + nobody + lost + "The tables below have each case, with times and errors of both."


def introduction(study: Study) -> str:
    """The text that says how the study was measured and on which machines."""
    return (
        f"Written by `{study.command}`. In the table of a scene every row is one method with one setting.\n\n"
        "**Run times.** One rule holds for all methods. Costs are counted *once a machine* (compilation that depends "
        "on no body and no start: numba's, ours, and heyoka's of equations whose constants are parameters), *once a "
        "system* (work for a body that serves all its starts), *once a start*, and for *evaluation*. A run time is "
        "the sum of the last two, and ratios are ratios of run times. The costs once a system and once a machine stand "
        "beside the ratios, in the table of first answers and in each row of report.json.\n\n"
        "Rows are timed one at a time, with nothing else of this study running, and times are medians. A row whose "
        "times scatter by more than a tenth (median absolute deviation over median) is measured again, and "
        f"marked{SCATTERS} if they still scatter. The two methods of a ratio run in turn in one process, and so do the "
        "flow and the method of each other row. All timed rows come from one machine, one commit and one run.\n\n"
        "**Errors** are differences from the truth, the divisor flow at 40 digits or more: the largest over components "
        "and times. Those of M are relative to |M|. The truth itself is compared with an integrator that shares no "
        "code with it. For a system without a body q and p take the place of γ and M, and errors of both are relative "
        "to the largest value at the start or at that time.\n\n"
        "**Inputs** are doubles: moments, d, γ, M and times of a scene are rounded to doubles before anything is "
        "computed, and every method starts from these. In doubles |γ| = 1 and, in scenes that are not tilted, "
        "(γ, M) = 0 hold only to rounding. The truth and all methods in more digits therefore start from γ/|γ| and "
        "from M without its part along γ, computed in their own precision. The flow in floats, whose set-up has 45 "
        "digits, does the same. Methods in doubles start from the doubles themselves.\n\n"
        "**The floor** is eps·conditioning, the effect on the state of a change of every input in its last digit "
        "(`integrable.motion.conditioning`). An error below the floor is possible because the inputs count as exact."
        f"\n\n{_machine(study)}"
    )


def sections(study: Study) -> dict[str, str]:
    """The sections about all scenes, by name, each with its heading; empty ones are left out."""
    text = "Each claim is measured by the command above; the sections below have the figures."
    found = {
        "claims": _section("Claims", text, claims(study)),
        "horizons": _horizons(study),
        "faster": _faster(study),
        "rows": _not_ahead(study),
        "floor": _floor(study),
        "first answers": _first_answers(study),
        "orders": _orders(study),
        "orbits": _orbits(study),
        "failed": _failed(study),
        "not measured": _not_measured(study),
    }
    return {name: section for name, section in found.items() if section}


def _machine(study: Study) -> str:
    versions = ", ".join(f"{name} {version}" for name, version in study.versions.items() if version)
    missing = f"\nNot part of this run: {', '.join(study.missing)}.\n" if study.missing else ""
    return (
        f"{study.machine['processor']}, {study.machine['cores']} cores, {study.machine['system']}; {versions}; "
        f"commit {', '.join(study.commits)}, {' … '.join(dict.fromkeys(study.dates))}. "
        f"{_load(study)}All rows together took {duration(study.seconds)}.\n{missing}"
    )


def _load(study: Study) -> str:
    if study.load is None:
        return ""
    busy = ": a busy machine, whose run times are long and scatter" if study.load > BUSY else ""
    return f"Load of the machine while it was measured (median of one-minute averages): {study.load:.1f}{busy}. "


def _section(title: str, text: str, rows: Sequence[Sequence[str]]) -> str:
    """A heading, an explanation and a table; "" if the table is empty."""
    return f"## {title}\n\n{text}\n\n{_markdown(rows)}" if len(rows) > 1 else ""


def _not_ahead(study: Study) -> str:
    title = "Rows where the divisor flow is not ahead"
    text = (
        "The flow is not ahead of a row if no run of the flow is as accurate in the row's run time or less. For each "
        "scene and method the table has the number of such rows and the most accurate of them. Scenes with T ≥ 1000 "
        'come first, then rows that are more accurate, then rows that are faster. "Flow\'s error in that time" is the '
        'least error that the flow reaches in the row\'s run time; "flow as accurate after" is the run time in which '
        "it is at least as accurate as the row."
    )
    rows = [behind_cells(study, *entry) for entry in study.behind_by_method]
    none = "None." if any(f.comparators for f in study.motions) else NO_OTHERS
    return _section(title, text, [BEHIND, *rows]) or f"## {title}\n\n{text}\n\n{none}\n"


def _horizons(study: Study) -> str:
    text = (
        "Each cell is the run time, set-up of the start included, of the fastest sufficiently accurate competitor "
        "divided by that of the flow in floats: above 1 the flow is faster. A competitor is sufficiently accurate if "
        'its error is at most the flow\'s, or at most the effect of rounding the inputs. ">x" means that no '
        'competitor finished in x times the flow\'s time, and "none" that no method that was run reached that '
        'accuracy. "stopped" means that the methods could not run, because of a pole or because they gave up, and '
        '"refused" that the flow raised an error that names the reason. A column is one time T, in time scales of the '
        "motion, or all times of the scene. The last four columns have costs of the flow and of "
        "these competitors that no ratio includes: those of a new system, and those of the first use on a machine. "
        "Systems of one kind share code of the flow; its import or compilation is counted for the first of them."
    )
    columns = study.horizons
    once = ("flow, once a system", "competitor, once a system", "flow, once a machine", "competitor, once a machine")
    rows = [
        ("scene", *map(horizon_name, columns), *once),
        *(horizon_cells(f, columns) for f in study.motions if f.standings),
    ]
    return _section("The flow and its fastest accurate competitor", text, rows)


def _faster(study: Study) -> str:
    once = ("once a machine", "once a system", "flow, once a machine", "flow, once a system")
    head = ("scene", "at", "fastest", "time", "error γ", "flow's time", "flow's error γ", "time ÷ flow's", *once)
    rows: list[tuple[str, ...]] = [head]
    for f in study.motions:
        for s in f.standings:
            if s.peer is not None and s.ratio < 1:
                peer, flow = s.peer, s.flow
                name = (f.scene.name, horizon_name(s.T), f"{peer['method']}, {peer['setting']}")
                cells = (taken(peer), figure(peer["error_gamma"]), taken(flow), figure(flow["error_gamma"]))
                spent = (duration(side[part]) for side in (peer, flow) for part in ("machine", "system"))
                rows.append((*name, *cells, ratio_cell(s), *spent))
    text = (
        "The table has every case in which another method is as accurate and faster. The last columns have the costs "
        "of both once a machine, as measured in this process, and once a system."
    )
    return _section("Where others are faster", text, rows)


def _floor(study: Study) -> str:
    text = (
        'The table has the fastest row of the flow in floats; "over floor" is its error divided by the floor. The last '
        "columns say what the truth is, up to which time it was checked by an independent integrator, and by how much "
        "the two differ. A ! marks a truth that this check does not confirm."
    )
    if "floors" in study.figures:
        text += f"\n\n![Error over floor of every scene]({study.figures['floors']})"
    return _section("The flow's error and the floor", text, [SCENES, *map(scene_cells, study.motions)])


def _first_answers(study: Study) -> str:
    rows = [("scene", "method", "cold machine", "new process, warm disk", "warm process")]
    for f in study.findings:
        for content in f.first_answers:
            times = (duration(content["result"][key]) for key in ("cold", "disk", "process"))
            rows.append((f.scene.name, content["row"]["method"], *times))
    text = (
        "The table has the time to one answer, one time scale after the start, with imports and the start of Python "
        "included. On the cold machine all caches are empty (heyoka's on disk too). The new process finds all compiled "
        "code on disk. The warm process has computed the answer before."
    )
    return _section("The first answer, cold and warm", text, rows)


def _orders(study: Study) -> str:
    rows = [("scene", "method", "observed order", "in theory", "verdict")]
    for f in study.findings:
        for name, slope, order in f.slopes():
            agrees = order is not None and abs(slope - order) <= ORDER_TOLERANCE
            rows.append((f.scene.name, name, f"{slope:.2f}", str(order), "agrees" if agrees else "differs"))
    text = (
        "The observed order is the slope of log error against log step, for errors above the plateau of rounding and "
        "below 0.1."
    )
    return _section("Orders of the fixed-step methods", text, rows)


def _orbits(study: Study) -> str:
    text = (
        "Over a finite field errors are 0, and only the run time is of interest. The last column compares the end of "
        "the orbit with one addition of the multiple."
    )
    return _section("Orbits of Bäcklund maps", text, [ORBITS, *(c for f in study.orbits for c in orbit_cells(f))])


def _failed(study: Study) -> str:
    rows = [("scene", "row", "message")]
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
        f"The limits were {limits.run:g} s for a run and {limits.task:g} s for a row with all its repetitions. "
        "Of several rows whose messages differ only in numbers, the first is shown."
    )
    return _section("Rows without a figure", text, rows)


def _not_measured(study: Study) -> str:
    rows = [("scene", "rows")]
    for f in study.findings:
        counts = Counter(content["row"]["method"] for content in f.missing)
        if counts:
            rows.append((f.scene.name, ", ".join(f"{name}: {count}" for name, count in counts.items())))
    return _section("Not measured", "The time of this run was not enough for these rows.", rows)


def scene_section(study: Study, found: SceneFindings) -> str:
    """The section of one scene: its figure and its rows."""
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
            rows.append((*words(content), taken(r), *errors, *drifts, str(r["runs"])))
        lines.append(_markdown(rows))
    return "\n".join(lines)


def _markdown(rows: Sequence[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + "---|" * len(rows[0]), *lines[1:]]) + "\n"
