"""Plain-text tables for the terminal, at most 100 columns wide."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["DOP853", "aligned", "duration", "figure", "plain_power"]

DOP853 = "SciPy DOP853"


def aligned(rows: Sequence[Sequence[str]], left: int = 1) -> list[str]:
    """Rows of cells as lines of text. The first ``left`` columns are aligned left, the others right."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = (
            cell.ljust(w) if k < left else cell.rjust(w) for k, (cell, w) in enumerate(zip(row, widths, strict=True))
        )
        lines.append("  ".join(cells).rstrip())
    return lines


def duration(seconds: float | None) -> str:
    """Seconds as text, with three digits and a unit."""
    if seconds is None:
        return "–"
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}" if seconds < 999.5 * size else f"{seconds / size:.0f} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def figure(value: float | None, digits: int = 2) -> str:
    """A number as text in exponential notation, with ``digits`` digits."""
    return "–" if value is None else "0" if value == 0 else f"{value:.{digits - 1}e}"


def plain_power(value: float) -> str:
    """A power of ten as text: 10¹² instead of 1e+12."""
    text = f"{value:g}"
    mantissa, found, exponent = text.partition("e")
    if not found:
        return text
    power = "10" + str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return power if mantissa == "1" else f"{mantissa}·{power}"
