"""The pages of error against run time: one screen, a page a scene, tables that can be sorted; from the report's JSON."""

from __future__ import annotations

import html
import re
from pathlib import Path
from typing import Any

from integrable.scene.file import load_scene
from integrable.scene.tables import duration, figure
from integrable.study.columns import horizon_name, once_cells, ratio_cell
from integrable.study.findings import SceneFindings, Standing, Study, study_from
from integrable.study.page import in_one_minute, introduction, scene_section, sections

FIGURES = Path(__file__).parents[1] / "figures" / "report"
INTRO = """\
# Error against run time

{minute}

Each cell is **the run time of the fastest sufficiently accurate competitor divided by that of the divisor flow**. Sufficiently accurate means that its error
is at most the flow's, or at most the effect of rounding the inputs to doubles. Above 1 (<span class="ahead">blue</span>) the flow is faster, below
(<span class="behind">orange</span>) the competitor. *None* means that no method that was run reached that accuracy, *stopped* that the
methods could not run, and *refused* that the flow raised an error that names the reason.

The state is requested at one time T, in time scales of the motion (the body turns by about a radian in one), or at *all its times*, those that the
scene lists. Run times count the set-up of a start and the evaluation, for both methods; the last columns have the costs once a system and once a machine. A click on a heading
sorts the table, and the tooltip of a cell names the method.
"""
CLAIMS = "Each claim is measured; [details](details.md) and the pages of the scenes have the figures."
# the class of a cell from each ratio on
LOOKS = ((100.0, "far-ahead"), (1.0, "ahead"), (0.01, "behind"), (0.0, "far-behind"))


def write(source: Path, data: dict[str, Any]) -> dict[str, SceneFindings]:
    """Write the pages of a report.json into ``source``/measured; what was found of each scene."""
    folder = source / "measured"
    folder.mkdir()
    study = study_from(data, [load_scene(name) for name in data["scenes"]])
    study.figures.update({path.stem: f"../figures/report/{path.name}" for path in FIGURES.glob("*.svg")})
    parts = sections(study)
    claims = "\n".join(line for line in parts["claims"].splitlines() if line.startswith("|")) + "\n"
    lost, _, rows = parts["rows"].removeprefix("## ").partition("\n")
    details = [part for name, part in parts.items() if name not in ("claims", "rows", "horizons")]
    _write(folder / "rows.md", f"# {lost}\n{rows}")
    _write(folder / "details.md", "# Details\n\n" + "\n".join(details))
    for found in study.findings:
        name = found.scene.name
        title, _, body = scene_section(study, found).removeprefix(f"## {name}: ").partition("\n")
        _write(folder / f"{name}.md", f"# {title}\n\n[The scene in the gallery](../gallery/{name}.md)\n{body}")
    names = "\n".join(found.scene.name for found in study.findings)
    others = ", ".join(f"[{f.scene.name}]({f.scene.name}.md)" for f in study.findings if not f.standings)
    if others:
        others = f"Omitted, without a timed competitor: {others}.\n\n"
    _write(
        folder / "index.md",
        f"{INTRO.format(minute=in_one_minute(study))}\n```{{raw}} html\n{_chart(study)}```\n\n{others}"
        f"[All rows where the flow is not ahead](rows.md), in a table that can be sorted. [Details](details.md): long runs, floors, first use, orders, "
        f"rows without a figure.\n\n## Claims\n\n{CLAIMS}\n\n{claims}\n"
        f"## How it was measured\n\n{introduction(study)}\n```{{toctree}}\n:hidden:\n\nrows\ndetails\n{names}\n```\n",
    )
    return {found.scene.name: found for found in study.findings}


def _write(path: Path, text: str) -> None:
    """A page: its tables inside an element that site/sort.js looks for, its links those of the site."""
    text = re.sub(r"((?:^\|.*\n)+)", r"::::{div} sortable\n\1::::\n", text + "\n", flags=re.M)
    path.write_text(re.sub(r"\(docs/(\w+\.md)\)", r"([\1](../\1))", text), encoding="utf-8")


def _chart(study: Study) -> str:
    columns = study.horizons
    once = ("flow, once a system", "competitor, once a system", "flow, once a machine", "competitor, once a machine")
    heads = "".join(f"<th>{head}</th>" for head in ("scene", *map(horizon_name, columns), *once))
    lines = [_line(found, columns) for found in study.motions if found.standings]
    table = f"<table><thead><tr>{heads}</tr></thead><tbody>\n{''.join(lines)}</tbody></table>"
    return f'<div class="sortable chart">{table}</div>\n'


def _line(found: SceneFindings, columns: list[float | None]) -> str:
    name, standings = found.scene.name, {standing.T: standing for standing in found.standings}
    cells = "".join("<td>refused</td>" if T in found.refused else _cell(standings.get(T)) for T in columns)
    cells += "".join(f"<td>{cell}</td>" for cell in once_cells(found.standings))
    return f'<tr><td><a href="{name}.html" title="{html.escape(found.scene.title)}">{name}</a></td>{cells}</tr>\n'


def _cell(standing: Standing | None) -> str:
    if standing is None:
        return "<td>–</td>"
    flow, peer, outcome = standing.flow, standing.peer, standing.outcome
    said = f"the flow: {duration(flow['total'])}, error {figure(flow['error_gamma'])}"
    if peer is not None:
        said = f"{peer['method']}, {peer['setting']}: {duration(peer['total'])}, error {figure(peer['error_gamma'])}; {said}"
        said += f"; once a system {duration(peer['system'])}, the flow {duration(flow['system'])}"
    ratio = standing.least if standing.least is not None else standing.ratio
    look = "unmatched" if outcome == "none" else next(name for least, name in LOOKS if ratio >= least)
    colour = "" if outcome == "stopped" else f' class="{look}"'
    return f'<td{colour} title="{html.escape(said)}">{ratio_cell(standing)}</td>'
