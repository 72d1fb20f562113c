"""A race measures error against run time, for several methods at several settings each, on a set of problems.

The settings of a method form a ladder; each of them is a rung. Each setting is first tried over 1 % and 4 % of the
time span. If these trials predict a run beyond the limit, this setting and the tighter ones of the method are left out.
Then the methods that take less than 0.2 s run in turn at one rung, so a slow second of the machine affects them alike.
The time of a run is that of its set-up and its evaluation (:class:`integrable.oracles.method.Spent`). Results include
the uncertainty of the truth.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from integrable.oracles.methods import METHODS
from integrable.problems import Problem, Truth, problem
from integrable.problems.statement import UNIT_ROUNDING
from integrable.races.entrants import RIVALS, TOLERANCES, Entrant, Solve, entrants
from integrable.races.page import page
from integrable.races.records import Course, Run
from integrable.scene.output import OutputFolder, machine, versions
from integrable.scene.tables import duration
from integrable.study.timing import Tick, TooLong, at_most, interleaved, silent
from jacobian.errors import ArgumentError, one_of, shown

__all__ = ["Race", "pieces_of_race", "race"]

MOST_TIMES = 21
"""The largest number of a problem's times that a race requests, including the last."""
CONDITIONED = 5
"""The approximate number of requested times at which the effect of rounding the inputs is computed."""
LIMIT = 4.0
"""Seconds that a run may take by default."""
TRIAL, LONGER = 0.01, 4
"""The first trial covers the fraction TRIAL of the time span, the second LONGER times as much. The two predict the time
of a whole run.
"""
REPEAT, PATIENCE = 3, 0.4
"""The number of runs at each setting, and the seconds per method of a rung after which no more runs are begun."""


@dataclass(frozen=True)
class Race:
    """The courses of a race, and the machine and date of their runs."""

    courses: tuple[Course, ...]
    date: str
    machine: dict[str, Any]
    versions: dict[str, str | None]

    def table(self) -> str:
        """The tables of all courses as text."""
        return "\n\n\n".join(course.table() for course in self.courses)

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        found = asdict(self)
        for course, own in zip(found["courses"], self.courses, strict=True):
            course["runs"] = [run._asdict() for run in own.runs]
        return {"schema": 1, **found}

    def write(self, out: str | Path) -> list[Path]:
        """Writes ``race.json``, ``race.txt`` and ``race.html`` to the folder ``out``, and returns their paths."""
        with OutputFolder(out) as folder:
            text = json.dumps(self.as_dict(), ensure_ascii=False, allow_nan=False, indent=1)
            contents = {"race.json": text + "\n", "race.txt": self.table() + "\n", "race.html": self._page()}
            return [folder.write_text(name, content) for name, content in contents.items()]

    def _page(self) -> str:
        used = ", ".join(f"{name} {version}" for name, version in self.versions.items() if version)
        machine = f"{self.machine.get('processor') or self.machine['system']}, {self.machine['cores']} cores"
        return page(self.courses, f"{self.date}; {machine}; {used}.")


def race(
    problems: Iterable[str | Path | Problem],
    own: Mapping[str, Solve] | None = None,
    *,
    rivals: Sequence[str] = RIVALS,
    limit: float = LIMIT,
    tick: Tick = silent,
) -> Race:
    """The results of a race between the functions ``own`` and the methods ``rivals`` on the problems.

    ``own`` maps names to functions solve(problem, times, tolerance). ``times`` is an ascending array of times ≥ 0; the
    functions return the states there, of shape (len(times), n). A run may take ``limit`` seconds. ``tick(label)`` is
    called before each piece of work. Raises ArgumentError for an unknown problem or rival.
    """
    for name in rivals:
        one_of(name, "rivals", tuple(METHODS), f"give some of {', '.join(METHODS)}")
    if not limit > 0:
        raise ArgumentError(f"limit = {shown(limit)}: give a number of seconds above 0")
    given = [one if isinstance(one, Problem) else problem(one) for one in problems]
    courses = tuple(_course(one, dict(own or {}), rivals, limit, tick) for one in given)
    date = datetime.now(UTC).isoformat(timespec="seconds")
    return Race(courses, date, machine(), versions())


def pieces_of_race(problems: Sequence[Any], rivals: Sequence[str]) -> int:
    """The number of calls of ``tick`` by :func:`race`: per problem, one for the truth and one for each rung."""
    return len(problems) * (1 + _rungs(rivals))


def _rungs(rivals: Sequence[str]) -> int:
    return max(len(TOLERANCES), *(len(METHODS[name].settings) for name in rivals), 0)


def _course(one: Problem, own: dict[str, Solve], rivals: Sequence[str], limit: float, tick: Tick) -> Course:
    times = _chosen(one.times)
    tick(f"{one.name}: truth")
    truth = one.truth(times)
    few = times[:: -max(1, (len(times) - 1) // CONDITIONED)]
    floor = float(one.condition(few).max()) * UNIT_ROUNDING
    found: dict[str, list[Run]] = {}
    left = entrants(one, own, rivals)
    order = [entrant.name for entrant in left]
    rungs = _rungs(rivals)
    for rung in range(rungs):
        tick(f"{one.name}: rung {rung + 1} of {rungs}")
        left = [entrant for entrant in left if rung < len(entrant.settings)]
        going = []
        for entrant, run in _rung(one, times, truth, left, rung, limit):
            found.setdefault(entrant.name, []).append(run)
            going += [] if run.note else [entrant]
        left = going
    return Course(
        **{key: getattr(one, key) for key in ("name", "title", "description", "reference", "letters")},
        times=tuple(times.tolist()),
        radius=float(one.relative(truth.radius, truth).max()),
        floor=floor,
        runs=tuple(run for name in order for run in found.get(name, [])),
    )


def _chosen(times: Sequence[float]) -> np.ndarray:
    """At most MOST_TIMES of the positive times, ascending, including the last."""
    later = np.unique([t for t in times if t > 0])
    return later[np.unique(np.linspace(0, len(later) - 1, min(MOST_TIMES, len(later))).round().astype(int))]


def _rung(
    one: Problem, times: np.ndarray, truth: Truth, left: list[Entrant], rung: int, limit: float
) -> list[tuple[Entrant, Run]]:
    """The runs of the methods ``left`` at their settings[rung]: first each alone, then the fast ones in turn."""
    found = {entrant.name: _tried(one, times, truth, entrant, rung, limit) for entrant in left}
    fast = [entrant for entrant in left if (found[entrant.name].seconds or PATIENCE) < PATIENCE / 2]
    every = {entrant.name: partial(entrant.run, one, times, entrant.settings[rung]) for entrant in fast}
    for name, timing in interleaved(every, REPEAT, PATIENCE * len(every), again=1).items():
        found[name] = found[name]._replace(seconds=timing.total, runs=timing.runs)
    return [(entrant, found[entrant.name]) for entrant in left]


def _tried(one: Problem, times: np.ndarray, truth: Truth, entrant: Entrant, rung: int, limit: float) -> Run:
    """A run of a method, or the reason why there is none. Imports and compilation take place in a trial before it,
    which is not counted.
    """
    setting = entrant.settings[rung]
    run = Run(entrant.name, setting, entrant.word)
    try:
        with at_most(10 * limit):
            once, short, longer = (entrant.run(one, part * TRIAL * times[-1:], setting)[0] for part in (1, 1, LONGER))
        rate = max(0.0, longer.counted - short.counted) / ((LONGER - 1) * TRIAL)
        if (whole := short.counted + rate) > limit:
            return run._replace(note=f"not run: it would take about {duration(whole)}")
        with at_most(2 * limit):
            spent, y = entrant.run(one, times, setting)
    except TooLong as why:
        return run._replace(note=str(why))
    except Exception as why:  # an error of a user's function must not stop the other methods
        return run._replace(note=f"{type(why).__name__}: {' '.join(str(why).split())}")
    error = float(one.error(y, truth).max())
    if not np.isfinite(error):
        return run._replace(note="a state is not finite, but no error was raised")
    first = max(0.0, once.first - short.counted) + max(spent.machine, spent.system)
    return run._replace(error=error, seconds=spent.counted, first=first, runs=1)
