"""``integrable report``: plan the rows, run what is missing, and write the page with its figures."""

from __future__ import annotations

import os
from collections.abc import Sequence
from contextlib import contextmanager, nullcontext
from datetime import datetime
from math import inf
from numbers import Real
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

from integrable.extras import without
from integrable.scene.data import Scene
from integrable.scene.file import load_scene, scene_names
from integrable.scene.output import OutputFolder, as_json, portable
from integrable.scene.progress import going, often
from integrable.study.findings import Study, study_from
from integrable.study.page import answer, page
from integrable.study.plan import NOT_MEASURED, Task, first_answer_tasks, in_order, tasks_of
from integrable.study.runner import ONE_RUN, run_tasks
from integrable.study.store import Store
from integrable.study.timing import silent
from jacobian.errors import ArgumentError, shown
from jacobian.native.kept import look_for_a_place

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["report_data", "study_of"]

FIGURES = "figures/report"


def study_of(
    sources: Sequence[str] = (),
    *,
    out: str | Path,
    quick: bool = False,
    formats: tuple[str, ...] = ("svg",),
    jobs: int | None = None,
    progress: bool = False,
    minutes: float | None = None,
) -> Study:
    """Run or resume a study in the folder ``out``, write its page, figures and ``report.json``, and return it.

    ``sources`` are names of scenes or paths of scene files; if there are none, all scenes of the package. Rows in
    ``out`` are kept unless code, scene or a library has changed; timed rows must be of one machine, commit and day.
    With empty ``formats`` there are no figures, and matplotlib is not imported. ``jobs`` processes compute truths and
    floors (default: one per core); timed tasks run alone. No row begins after ``minutes``; the page lists the remaining
    ones as not measured.
    """
    if minutes is not None and not (isinstance(minutes, Real) and minutes > 0):
        raise ArgumentError(f"minutes: {shown(minutes)} given; a positive number is needed")
    if jobs is not None and not (isinstance(jobs, int) and jobs > 0):
        raise ArgumentError(f"jobs: {shown(jobs)} given; at least one process is needed")
    chosen = list(sources) or scene_names()
    scenes = _loaded(chosen)
    rows = planned(scenes, chosen, "quick" if quick else "full")
    uses = {"scipy": "SciPy's integrators"}
    uses |= {"matplotlib": "the figures"} if formats else {}
    uses |= {"tqdm": "the progress bar"} if progress else {}
    missing = without(uses)
    formats, progress = formats if "matplotlib" not in missing else (), progress and "tqdm" not in missing
    look_for_a_place()
    store = Store(out)
    with _bar(rows) if progress else nullcontext(silent) as tick:
        contents = run_tasks(rows, store, jobs or os.cpu_count() or 1, tick, 60 * minutes if minutes else inf)
    data = report_data([contents[row.key] for row in rows], chosen, quick, minutes)
    study = study_from(data, scenes)
    _write(study, data, Path(out), formats)
    return study


def _loaded(chosen: Sequence[str]) -> list[Scene]:
    """The loaded scenes. Raises ArgumentError if two have the same name."""
    scenes = [load_scene(source) for source in chosen]
    names = [portable(scene.name).lower() for scene in scenes]
    for name in names:
        if names.count(name) > 1:
            raise ArgumentError(f'scenes: "{name}" given {names.count(name)} times; each once is needed')
    return scenes


def planned(scenes: Sequence[Scene], sources: Sequence[str], mode: str) -> list[Task]:
    """All rows of a study in the order in which they are measured."""
    rows = [row for scene, source in zip(scenes, sources, strict=True) for row in tasks_of(scene, source, mode)]
    return in_order([*rows, *first_answer_tasks(scenes, sources)])


def report_data(
    contents: Sequence[dict[str, Any]], chosen: Sequence[str], quick: bool, minutes: float | None = None
) -> dict[str, Any]:
    """The content of report.json, as in integrable/schemas/report.json: all rows, without the states of the truths."""
    options = [*(["--quick"] if quick else []), *([f"--minutes {minutes:g}"] if minutes else [])]
    command = " ".join(["integrable report", *(() if set(chosen) == set(scene_names()) else chosen), *options])
    states = ("gamma", "M", "tau")
    rows = [
        {
            **{key: content[key] for key in ("row", "status", "error", "stopped", "seconds", "commit", "date", "load")},
            "machine": _named(content["machine"]),
            "result": content["result"]
            and {key: value for key, value in content["result"].items() if key not in states},
        }
        for content in contents
    ]
    contents = [content for content in contents if content["status"] != NOT_MEASURED] or contents
    loads = [content["load"] for content in contents if content["load"] is not None]
    return {
        "schema": 2,
        "command": command,
        "mode": "quick" if quick else "full",
        "scenes": list(chosen),
        "versions": contents[0]["versions"],
        "machine": _one_run(contents),
        "dates": [min(content["date"] for content in contents), max(content["date"] for content in contents)],
        "load": median(loads) if loads else None,
        "commits": sorted({content["commit"] or "" for content in contents}),
        "seconds": sum(content["seconds"] for content in contents),
        "rows": rows,
    }


def _one_run(contents: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The machine of the timed rows; RuntimeError unless they are of one machine, one commit and one day."""
    timed = [content for content in contents if content["row"]["kind"] not in ("truth", "floor")] or contents
    machines = [dict(one) for one in {tuple(content["machine"].items()) for content in timed}]
    commits = {content["commit"] for content in timed}
    for name, found in (("machines", machines), ("commits", commits)):
        if len(found) > 1:
            raise RuntimeError(f"rows of {len(found)} {name}: their run times are no ratios; measure them again")
    dates = sorted(datetime.fromisoformat(content["date"]) for content in timed)
    if dates[-1] - dates[0] > ONE_RUN:
        raise RuntimeError(f"rows of {dates[0]:%F} and of {dates[-1]:%F}: these are two runs; measure them again")
    return machines[0]


def _named(machine: dict[str, Any]) -> str:
    return f"{machine['processor']}, {machine['cores']} cores, {machine['system']}"


def _write(study: Study, data: dict[str, Any], out: Path, formats: tuple[str, ...]) -> None:
    if formats:
        from integrable.study.figures import as_bytes, drawings

        with OutputFolder(out / FIGURES) as folder:
            for name, drawing in drawings(study.findings).items():
                for suffix in formats:
                    file = f"{portable(name)}.{suffix}"
                    folder.write_bytes(file, as_bytes(drawing, suffix))
                    study.figures[name] = f"{FIGURES}/{file}"
    with OutputFolder(out) as folder:
        folder.write_text("report.md", page(study))
        folder.write_text("report.txt", answer(study) + "\n")
        folder.write_text("report.json", as_json(data))


@contextmanager
def _bar(rows: Sequence[Task]) -> Iterator[Callable[[Task], None]]:
    """Yields a function to call with each finished row; it moves a bar on stderr."""
    from tqdm import tqdm

    layout = "{l_bar}{bar:20}| {n_fmt}/{total_fmt} [{elapsed}<{remaining}]"
    with tqdm(total=len(rows), leave=False, mininterval=0.2, bar_format=layout) as bar, going(bar, often()):

        def tick(row: Task) -> None:
            bar.set_description(f"{row.scene.name}: {row.method}", refresh=False)
            bar.update(1)

        yield tick
