"""Plain-text tables for the terminal, at most 100 columns wide."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .report import Report, Row

__all__ = ["DOP853", "aligned", "duration", "figure", "report_table"]

DOP853 = "SciPy DOP853"


def aligned(rows: Sequence[Sequence[str]], left: int = 1) -> list[str]:
    """Rows of cells as lines with aligned columns: the first ``left`` columns to the left, the others to the right."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = (
            cell.ljust(w) if k < left else cell.rjust(w) for k, (cell, w) in enumerate(zip(row, widths, strict=True))
        )
        lines.append("  ".join(cells).rstrip())
    return lines


def duration(seconds: float | None) -> str:
    """A time with three digits and a unit."""
    if seconds is None:
        return "–"
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}" if seconds < 999.5 * size else f"{seconds / size:.0f} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def figure(value: float | None, digits: int = 2) -> str:
    """A small number with so many digits."""
    return "–" if value is None else "0" if value == 0 else f"{value:.{digits - 1}e}"


def _at_most(difference: float, digits: int) -> str:
    """A difference between numbers of so many digits, which cannot be told from zero below their last digit."""
    last = 10.0**-digits
    return f"{difference:.0e}" if difference > last else f"less than {last:.0e}"


def _head(integrals: Sequence[str]) -> tuple[str, ...]:
    return ("method", "setting", "error γ", "error M", *(f"Δ{x}" for x in integrals), "set-up", "evaluate", "total")


def _cells(row: Row, integrals: Sequence[str]) -> tuple[str, ...]:
    drift = row.drift or {}
    drifts = (figure(drift.get(name), 1) for name in integrals)
    times = map(duration, (row.setup, row.evaluation, row.total))
    return (row.method, row.setting, figure(row.error_gamma), figure(row.error_M), *drifts, *times)


_ORACLES = {
    "divisor flow": "a Taylor-series integrator",
    "elliptic curves": "the equations of motion",
    "extrapolation": "the same at 10 more",
}


def _notes(report: Report) -> list[str]:
    """Why rows have no figures, each reason once."""
    settings: dict[tuple[str, str], list[str]] = {}
    for row in report.rows:
        if row.note:
            settings.setdefault((row.method, row.note), []).append(row.setting)
    return [f"{method}, {', '.join(those)}: {note}" for (method, note), those in settings.items()]


def _floor(report: Report) -> list[str]:
    if report.floor is None:
        return []
    gamma, M = map(figure, report.floor)
    return [f"Rounding the inputs to doubles alone, eps·conditioning: {gamma} in γ, {M} in M."]


def report_table(report: Report) -> str:
    """The whole report as text: rows of error against run time, the check of the truth, the growth of the residual."""
    first, last, count = report.times
    check = report.truth
    first_of, second_of = report.integrals[2:]
    verdict = "" if check.agrees else "  THEY DISAGREE: do not trust the errors above."
    lines = [
        report.title,
        f"{count} times from {first:g} to {last:g}; run times are medians of up to {report.repeat} runs",
        "",
        *aligned([_head(report.integrals), *(_cells(row, report.integrals) for row in report.rows)], left=2),
        *_notes(report),
        "",
        "error γ: largest over components and times; error M: the same, relative to |M|; Δ: largest drift of",
        f"|γ|², (γ,M)/|M|, {first_of} and {second_of} (relative) from the exact start.",
        *_floor(report),
        f"Errors are against the {report.against} at {check.digits} digits, held once against "
        f"{_ORACLES[report.against]}",
        f"at t = {check.time:g}: they differ by {_at_most(check.error_gamma, check.digits)} in γ and "
        f"{_at_most(check.error_M, check.digits)} in M.{verdict}",
    ]
    if report.residual_growth:
        counts = [f"{steps:,}".replace(",", " ") for steps, _ in report.residual_growth]
        growth = [("steps", *counts), ("residual", *(figure(value) for _, value in report.residual_growth))]
        lines += ["", "|V²−f mod U| / scale after a number of successive additions, in floats", *aligned(growth)]
    return "\n".join(lines)
