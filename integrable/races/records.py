"""The runs of a race, grouped into courses, one per problem, and the table of a course."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from integrable.scene.tables import aligned, duration, figure

__all__ = ["Course", "Run"]


class Run(NamedTuple):
    """The result of a method at one setting.

    ``error`` is that of :meth:`Problem.error`, ``seconds`` the median time of set-up and evaluation. ``first`` is the
    time spent only once, such as for compilation, and ``note`` the reason for missing figures.
    """

    method: str
    setting: float
    word: str
    error: float | None = None
    seconds: float | None = None
    first: float | None = None
    runs: int = 0
    note: str = ""

    @property
    def at(self) -> str:
        """The setting with its name, as text."""
        return f"{self.word} {self.setting:.0e}" if self.word == "tolerance" else f"{self.word} {self.setting:.3g}"


@dataclass(frozen=True)
class Course:
    """One problem and its runs. ``radius`` is the relative uncertainty of the truth, ``floor`` the error from rounding
    constants and start to doubles.
    """

    name: str
    title: str
    description: str
    reference: str
    letters: tuple[str, str]
    times: tuple[float, ...]
    radius: float
    floor: float
    runs: tuple[Run, ...]

    def table(self) -> str:
        """The table of the course's runs as text."""
        head = ("method", "setting", "error", "run time", "once before")
        cells = [
            (run.method, run.at, figure(run.error), duration(run.seconds), duration(run.first) if run.first else "–")
            for run in self.runs
        ]
        notes = [f"{run.method}, {run.at}: {run.note}" for run in self.runs if run.note]
        lines = [
            f"{self.title} ({self.name}), {len(self.times)} times to {max(self.times, key=abs):g}",
            "",
            *aligned([head, *cells], left=2),
            *notes,
            "",
            f"The truth is known to {figure(self.radius)}; rounding the inputs to doubles alone: {figure(self.floor)}.",
        ]
        return "\n".join(lines)
