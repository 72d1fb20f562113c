"""The report of a motion: rows of error against run time, the check of the truth, and their table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from integrable.scene.tables import aligned, duration, figure

__all__ = ["FIRST_USE", "INTEGRALS", "Report", "Row", "TruthCheck", "closing", "opening", "row_line"]

FIRST_USE = "first use"
INTEGRALS = ("C1", "C2", "H1", "H2")


@dataclass(frozen=True)
class Row:
    """The result of a task: one method at one setting.

    Times are in seconds. ``setup`` (once per start) and ``evaluation`` are None where a method has no such part.
    """

    method: str
    setting: str
    digits: int | None = None
    tolerance: float | None = None
    error_gamma: float | None = None
    error_M: float | None = None
    drift: dict[str, float] | None = None
    setup: float | None = None
    evaluation: float | None = None
    total: float | None = None
    runs: int = 0
    mad: float | None = None
    """The median absolute deviation of a run's total, divided by the median."""
    machine: float | None = None
    system: float | None = None
    """``machine`` and ``system`` are the costs once a machine and once a system; they are not part of ``total``."""
    evaluations: int | None = None
    """The number of evaluations of the right-hand side, for an ordinary integrator."""
    note: str = ""
    """The reason for missing figures."""


@dataclass(frozen=True)
class TruthCheck:
    """The comparison of the truth with another integrator at ``digits`` digits.

    It holds the largest differences of γ and M/|M| at ``time``.
    """

    digits: int
    time: float
    error_gamma: float
    error_M: float
    seconds: float

    @property
    def agrees(self) -> bool:
        """Whether truth and integrator agree to ``digits`` − 10 digits."""
        return max(self.error_gamma, self.error_M) < 10.0 ** -(self.digits - 10)


@dataclass(frozen=True)
class Report:
    """Error against run time for one scene.

    ``residual_growth`` holds pairs (number of successive additions, |V²−f mod U|/scale after them).
    """

    title: str
    times: tuple[float, float, int]
    """The first and the last time, and the number of times."""
    repeat: int
    rows: tuple[Row, ...]
    truth: TruthCheck
    residual_growth: tuple[tuple[int, float], ...]
    integrals: tuple[str, ...] = INTEGRALS
    against: str = "divisor flow"
    """The method that computed the truth."""
    floor: tuple[float, float] | None = None
    """The effect on γ and on M/|M| of rounding the inputs to doubles (:mod:`integrable.motion.conditioning`); None
    for a motion that an integrator computes.
    """
    letters: tuple[str, str] = ("γ", "M")
    """The names of the two halves of a state."""
    planned: tuple[tuple[str, str], ...] = ()
    """Methods and settings of the rows that are not yet measured."""

    def table(self) -> str:
        """The report as plain text, at most 100 columns wide."""
        return "\n".join([*opening(self), *(row_line(self, row) for row in self.rows), *closing(self)])

    @property
    def names(self) -> tuple[int, int]:
        """Widths of the columns of methods and settings."""
        rows = [(row.method, row.setting) for row in self.rows]
        pairs = zip(*[("method", "setting"), *rows, *self.planned], strict=True)
        first, second = (max(map(len, words)) for words in pairs)
        return first, second

    def as_dict(self) -> dict[str, Any]:
        """The report as plain data for JSON."""
        found = asdict(self)
        del found["planned"]
        return found | {"truth_agrees": self.truth.agrees}


def _at_most(difference: float, digits: int) -> str:
    """The text of a difference between numbers of ``digits`` digits: "less than …" if it is below their last digit."""
    last = 10.0**-digits
    return f"{difference:.0e}" if difference > last else f"less than {last:.0e}"


_ORACLES = {
    "divisor flow": "a Taylor-series integrator",
    "additions": "Gauss's collocation",
    "elliptic curves": "the equations of motion",
    "integrated": "the same at 10 more",
}


def _notes(report: Report) -> list[str]:
    """The reasons why rows have no figures, each only once."""
    settings: dict[tuple[str, str], list[str]] = {}
    for row in report.rows:
        if row.note:
            settings.setdefault((row.method, row.note), []).append(row.setting)
    return [f"{method}, {', '.join(those)}: {note}" for (method, note), those in settings.items()]


def _floor(report: Report) -> list[str]:
    if report.floor is None:
        return []
    gamma, M = map(figure, report.floor)
    first, second = report.letters
    return [f"Rounding the inputs to doubles alone, eps·conditioning: {gamma} in {first}, {M} in {second}."]


def _words(report: Report) -> list[str]:
    if report.letters == ("q", "p"):
        names = ", ".join(report.integrals)
        return [
            "error q: largest over components and times, relative to the largest q at the start or then;",
            f"error p: likewise, relative to |p|; Δ: largest relative drift of {names} from the exact start.",
        ]
    first_of, second_of = report.integrals[2:]
    return [
        "error γ: largest over components and times; error M: the same, relative to |M|; Δ: largest drift of",
        f"|γ|², (γ,M)/|M|, {first_of} and {second_of} (relative) from the exact start.",
    ]


def opening(report: Report) -> list[str]:
    """The lines before the rows: the title, the times and the head of the table."""
    first, last, count = report.times
    columns = (*(f"error {letter}" for letter in report.letters), *(f"Δ{name}" for name in report.integrals))
    return [
        report.title,
        f"{count} times from {first:g} to {last:g} in the scene's unit of time; run times are medians of up to "
        f"{report.repeat} runs",
        "",
        _line(("method", "setting", *columns, "set-up", "evaluate", "total"), report.names),
    ]


def row_line(report: Report, row: Row) -> str:
    """The line of text that shows ``row`` in the report's table."""
    drift = row.drift or {}
    drifts = (figure(drift.get(name), 1) for name in report.integrals)
    times = map(duration, (row.setup, row.evaluation, row.total))
    cells = (row.method, row.setting, figure(row.error_gamma), figure(row.error_M), *drifts, *times)
    return _line(cells, report.names)


def _line(cells: Sequence[str], names: tuple[int, int]) -> str:
    """A line of cells in columns of fixed width. Drifts have one digit, other figures two.

    The widths are fixed because lines are printed before all rows are known.
    """
    method, setting, *others = cells
    widths = [7, 7, *[5] * (len(others) - 5), 7, 8, 7]
    figures = (cell.rjust(width) for cell, width in zip(others, widths, strict=True))
    return "  ".join([method.ljust(names[0]), setting.ljust(names[1]), *figures]).rstrip()


def closing(report: Report) -> list[str]:
    """The lines after the rows: the meaning of the columns, the check of the truth, and the distance of the divisor
    from its curve after many additions.
    """
    check = report.truth
    gamma, M = report.letters
    verdict = "" if check.agrees else "  THEY DISAGREE: do not trust the errors above."
    lines = [*_notes(report), "", *_words(report)]
    if any(row.setting == FIRST_USE for row in report.rows):
        lines += [
            f"{FIRST_USE}: floats as the first call in this process had them, with what it imported, and compiled or",
            "loaded from the cache of compiled code.",
        ]
    lines += [
        *_floor(report),
        f"Errors are against the {report.against} at {check.digits} digits, held once against "
        f"{_ORACLES[report.against]}",
        f"at t = {check.time:g}: they differ by {_at_most(check.error_gamma, check.digits)} in {gamma} and "
        f"{_at_most(check.error_M, check.digits)} in {M}.{verdict}",
    ]
    if report.residual_growth:
        counts = [f"{steps:,}".replace(",", " ") for steps, _ in report.residual_growth]
        growth = [("steps", *counts), ("residual", *(figure(value) for _, value in report.residual_growth))]
        lines += ["", "|V²−f mod U| / scale after a number of successive additions, in floats", *aligned(growth)]
    return lines
