"""Shared code of benchmarks with a picture: ``python -m benchmarks.bench_<name> [--smoke] [--figure STEM]``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from benchmarks.__main__ import table
from jacobian.terminal import CommandParser

Rows = list[dict[str, Any]]


def save(figure: Any, stem: Path) -> None:
    """Saves the figure as stem.png and stem.svg."""
    stem.parent.mkdir(parents=True, exist_ok=True)
    for suffix in (".png", ".svg"):
        figure.savefig(stem.with_suffix(suffix), dpi=150)


def command(description: str | None, run: Callable[[bool], Rows], draw: Callable[[Rows, Path], None]) -> None:
    """Runs one benchmark, prints its table, and draws its figure if ``--figure`` is given."""
    parser = CommandParser(description=description)
    parser.add_argument("--figure", type=Path, help="draw to FIGURE.png and FIGURE.svg")
    parser.add_argument("--smoke", action="store_true")
    arguments = parser.parse_args()
    measured = run(arguments.smoke)
    print(table(measured))
    if arguments.figure:
        draw(measured, arguments.figure)
