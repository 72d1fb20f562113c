"""Run the benchmarks: ``python -m benchmarks [--smoke] [--list] [--json FILE] [NAME ...]``, from the repository's root.

A benchmark is a module ``benchmarks/bench_<name>.py`` with a docstring, whose first line is its title, and

    def run(smoke: bool) -> list[dict[str, object]]

that measures and returns rows, each a mapping of column name to value (strings, integers, floats; the same columns in
each row). With ``smoke`` it does the least work that passes through all of its code, in seconds. If a measured value
breaks a promise, ``run`` raises an exception; the command then fails after the other benchmarks have run.
"""

from __future__ import annotations

from jacobian.interrupts import leave, stand

if __name__ == "__main__":
    stand("benchmarks")

import importlib
import json
import pkgutil
import sys
import time
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from integrable.scene.tables import aligned
from jacobian.terminal import CommandParser, write_anything


def names() -> list[str]:
    """The names of all benchmarks, such as ``flow`` for ``bench_flow.py``."""
    modules = (module.name for module in pkgutil.iter_modules([str(Path(__file__).parent)]))
    return sorted(name.removeprefix("bench_") for name in modules if name.startswith("bench_"))


def _text(value: object) -> str:
    return f"{value:.3g}" if isinstance(value, float) else "–" if value is None else str(value)


def table(rows: list[dict[str, Any]]) -> str:
    """The rows as aligned text; a dash stands where a row has no value for a column."""
    if not rows:
        return "(no rows)"
    columns = list(dict.fromkeys(column for row in rows for column in row))
    return "\n".join(aligned([columns, *([_text(row.get(column)) for column in columns] for row in rows)]))


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the chosen benchmarks; returns 0 if all succeeded, 1 if one failed, 2 for a wrong argument."""
    write_anything()
    parser = CommandParser(prog="python -m benchmarks", description="Run the benchmarks and print their tables.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="which (default: all)")
    parser.add_argument("--smoke", action="store_true", help="the least work of each: only to see that it runs")
    parser.add_argument("--list", action="store_true", help="list the benchmarks")
    parser.add_argument("--json", metavar="FILE", help="also write all rows to this file")
    arguments = parser.parse_args(argv)
    known = names()
    for name in arguments.names:
        if name not in known:
            parser.error(f'"{name}": no such benchmark (known: {", ".join(known)})')
    failed, found = [], {}
    for name in arguments.names or known:
        module = importlib.import_module(f"benchmarks.bench_{name}")
        title = (module.__doc__ or name).strip().splitlines()[0]
        print(f"{name}: {title}", flush=True)
        if arguments.list:
            continue
        begun = time.perf_counter()
        try:
            found[name] = module.run(arguments.smoke)
        except Exception:
            traceback.print_exc()
            failed.append(name)
            continue
        print(table(found[name]))
        print(f"({time.perf_counter() - begun:.1f} s)\n", flush=True)
    if arguments.json:
        Path(arguments.json).write_text(json.dumps(found, ensure_ascii=False, indent=1) + "\n", encoding="utf-8")
    if failed:
        print(f"failed: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    leave(main())
