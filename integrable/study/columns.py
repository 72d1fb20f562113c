"""Heads and cells of a study's tables, for the page and the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from math import isinf
from typing import Any

from integrable.scene.tables import duration, figure, plain_power
from integrable.study.findings import Behind, SceneFindings, Standing, Study
from integrable.study.timing import SCATTER

__all__ = [
    "BEHIND", "ORBITS", "SCENES", "behind_cells", "factor", "horizon_cells", "horizon_name", "named", "once_cells",
    "orbit_cells", "ratio_cell", "scene_cells", "shortened", "taken", "words",
]  # fmt: skip

SCATTERS = " ±"
"""The mark of a run time that scatters by more than a tenth even when measured again."""
SHORT = 110
"""The number of characters of an error message that a table shows; the row's file has all of it."""

BEHIND = (
    "scene", "method", "rows", "most accurate of them", "run time", "error γ", "flow's error in that time", "floor",
    "flow as accurate after", "by how much",
)  # fmt: skip


def behind_cells(study: Study, behind: Behind, count: int) -> tuple[str, ...]:
    row, found = behind.row["result"], study.of(behind.scene)
    floor, name = found.floor, behind.scene if found.moved_by_divisors else f"{behind.scene}, integrated: no divisors"
    least = figure(behind.flow_error) if behind.flow_error is not None else _none_yet(behind)
    named = (name, behind.row["row"]["method"], str(count), behind.row["row"]["setting"])
    return (
        *named,
        taken(row),
        figure(row["error_gamma"]),
        least,
        figure(floor["floor_gamma"] if floor else None),
        "never" if behind.overtaken is None else duration(behind.overtaken),
        _how_far(behind),
    )


def _none_yet(behind: Behind) -> str:
    return "no flow" if behind.first is None else f"none: the flow takes {duration(behind.first['total'])}"


def _how_far(behind: Behind) -> str:
    """The text that says by which factors of error and of run time a comparator's row beats the flow."""
    row = behind.row["result"]
    if behind.cheaper and behind.first is not None:
        error, time = (row[key] / (behind.first[key] or row[key] or 1) for key in ("error_gamma", "total"))
        return f"faster: {error:.2g} × the flow's error in {time:.2g} × its time"
    if behind.overtaken is None:
        return "more accurate than any row of the flow"
    return f"more accurate: the flow needs {behind.overtaken / row['total']:.2g} × the time"


def horizon_name(T: float | None) -> str:
    """The head of the column that compares methods at the time T, or at all times of a scene if T is None."""
    return "all its times" if T is None else f"T = {plain_power(T)}"


def horizon_cells(found: SceneFindings, columns: Sequence[float | None]) -> tuple[str, ...]:
    standings = {standing.T: standing for standing in found.standings}
    cells = ("refused" if T in found.refused else ratio_cell(standings.get(T)) for T in columns)
    return (found.scene.name, *cells, *once_cells(found.standings))


def once_cells(standings: Sequence[Standing]) -> tuple[str, ...]:
    """Four ranges of seconds: once for each system, by the flow and by its competitors; once per machine, by both."""
    sides = ([s.flow for s in standings], [s.peer for s in standings if s.peer is not None])
    return tuple(_span([row[part] for row in side]) for part in ("system", "machine") for side in sides)


def _span(seconds: Sequence[float]) -> str:
    if not seconds:
        return "–"
    least, most = duration(min(seconds)), duration(max(seconds))
    return least if least == most else f"{least} … {most}"


def taken(row: dict[str, Any]) -> str:
    """The run time of a row as text, with a mark if repeated runs scatter."""
    return duration(row["total"]) + (SCATTERS if row.get("mad", 0.0) > SCATTER else "")


def ratio_cell(standing: Standing | None) -> str:
    """The text of a ratio of run times, or of a lower bound of it.

    "none" means that no method was accurate enough, "stopped" that the methods of :data:`integrable.study.plan.STRONG`
    could not run, and "–" that ``standing`` is None.
    """
    if standing is None:
        return "–"
    ratio = standing.least if standing.least is not None else standing.ratio
    if isinf(ratio):
        return standing.outcome
    scatters = max(side.get("mad", 0.0) for side in (standing.flow, standing.peer or {})) > SCATTER
    bound = ">" if standing.outcome == "slower" else ""
    return bound + factor(ratio) + (SCATTERS if scatters else "")


def factor(value: float) -> str:
    """A ratio of run times as text, without an exponent where it is large."""
    return f"{value:.2g}" if value < 100 else f"{value:.0f}"


def _way(found: SceneFindings) -> str:
    """The setting of the flow's fastest row in floats, with a note if the flow integrates the equations of motion."""
    setting: str = next((c["row"]["setting"] for c in found.flow if c["result"] is found.best), "failed")
    return setting if found.moved_by_divisors or not found.flow else f"{setting}, integrated: no divisors"


SCENES = (
    "scene", "flow", "error γ", "floor γ", "error M", "floor M", "over floor", "run time", "truth", "checked to t",
    "differs",
)  # fmt: skip


def scene_cells(found: SceneFindings) -> tuple[str, ...]:
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
        taken(best) if best else "–",
        *checked,
    )


ORBITS = ("orbit", "map", "steps", "setting", "error γ", "floor γ", "error M", "floor M", "drift", "per step", "end")


def orbit_cells(found: SceneFindings) -> list[tuple[str, ...]]:
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


def words(content: dict[str, Any]) -> tuple[str, str]:
    return content["row"]["method"], content["row"]["setting"]


def named(content: dict[str, Any]) -> str:
    return ", ".join(words(content))


def shortened(text: str) -> str:
    return text if len(text) <= SHORT else text[: SHORT - 1] + "…"
