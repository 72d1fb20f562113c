"""``python -m tests.fuzz SUITE|all --seconds 60 --seed 1``: see docs/fuzz.md."""

from __future__ import annotations

from jacobian.interrupts import leave, stand

if __name__ == "__main__":
    stand("fuzz")

import argparse
import json
import sys
import time
import warnings
from collections.abc import Sequence
from dataclasses import replace
from importlib import import_module
from typing import Any

from integrable.phase.body import UnphysicalMoments
from integrable.sweeps.orphans import processes
from jacobian.terminal import CommandParser
from tests.fuzz.case import FAILURES, run
from tests.fuzz.run import Plan, Suite, Tally, follow

SUITES = ("flow", "systems", "engine", "inexact", "calls", "command", "outside")


def suite_of(name: str) -> Suite:
    """The suite of that name; each is imported on request."""
    suite: Suite = import_module(f"tests.fuzz.{name}").SUITE
    return suite


def parser() -> CommandParser:
    made = CommandParser(
        prog="python -m tests.fuzz",
        description="Random cases against independent oracles; exit code 1 and a reproducer where one fails.",
    )
    made.add_argument("suite", choices=[*SUITES, "all"], metavar="SUITE", help=", ".join(SUITES) + " or all")
    made.add_argument("--seed", default="1", help="any word or number (default 1); the same seed gives the same cases")
    made.add_argument("--seconds", type=float, help="how long, all suites together; 60 unless --cases is given")
    made.add_argument("--cases", type=int, help="how many cases of each suite")
    made.add_argument("--case", type=int, help="this one case alone, of the one --kind given")
    made.add_argument("--kind", action="append", default=[], help="only cases of this kind; may be repeated")
    made.add_argument("--kinds", action="store_true", help="list the kinds and exit")
    made.add_argument("--jobs", type=int, default=1, help="processes (default 1)")
    made.add_argument("--json", metavar="FILE", help="write the counts and every failure to a file")
    made.add_argument("--every", action="store_true", help="print every failure, not the first alone")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    began = time.time()
    # as in the tests, a warning from inside counts as a fault
    warnings.simplefilter("error")
    warnings.simplefilter("ignore", UnphysicalMoments)
    if hasattr(sys.stdout, "reconfigure"):
        # a reproducer may hold characters that the terminal cannot show
        sys.stdout.reconfigure(errors="backslashreplace")
    command = parser()
    given = command.parse_args(arguments)
    names = list(SUITES) if given.suite == "all" else [given.suite]
    suites = {name: suite_of(name) for name in names}
    known = {kind for suite in suites.values() for kind in suite.kinds}
    if given.kinds:
        print("\n".join(f"{name}: {', '.join(suite.kinds)}" for name, suite in suites.items()))
        return 0
    if unknown := set(given.kind) - known:
        command.error(f"argument --kind: {sorted(unknown)} not among {sorted(known)}")
    if given.case is not None:
        if len(names) != 1 or len(given.kind) != 1:
            command.error("argument --case: name one suite and one --kind, as the header of a reproducer does")
        return _one(suites[names[0]], given)
    seconds = 60.0 if given.seconds is None and given.cases is None else given.seconds
    found, failed = {}, False
    for i, name in enumerate(names):
        until = None if seconds is None else began + seconds * (i + 1) / len(names)
        tally = _tally(Plan(suites[name], given.seed, tuple(given.kind), given.cases, until), given)
        found[name], failed = tally.data(), failed or tally.failed
        print(f"{name}, seed {given.seed}: {tally.line()}", flush=True)
    if given.json:
        with open(given.json, "w", encoding="utf-8", errors="backslashreplace") as file:
            json.dump({"seed": given.seed, "suites": found}, file, indent=1, ensure_ascii=False)
    return int(failed)


def _one(suite: Suite, given: argparse.Namespace) -> int:
    kind = given.kind[0]
    suite.warmed(given.kind)
    case = suite.case(given.seed, kind, given.case)
    outcome = run(case)
    print(f"# {suite.name}, {kind}: {outcome.word} {outcome.why} ({outcome.seconds:.2f} s)")
    print(outcome.program or f"{case.setup.strip()}\ngot = {case.call}")
    return int(outcome.word in FAILURES)


def _tally(plan: Plan, given: argparse.Namespace) -> Tally:
    shown: list[str] = []

    def report(failure: str) -> None:
        if given.every or not shown:
            print(failure, flush=True)
        shown.append(failure)

    if given.jobs == 1:
        return follow(plan, report)
    total, began = Tally(), time.perf_counter()
    tasks = [
        (plan.suite.name, replace(plan, suite=Suite("", {}), start=k, stride=given.jobs)) for k in range(given.jobs)
    ]
    with processes(given.jobs) as pool:
        # imported by name, since processes of multiprocessing do not know the __main__ of a package
        for tally in pool.map(import_module("tests.fuzz.__main__")._share, tasks):
            total.add(tally)
    total.seconds = time.perf_counter() - began
    for failure in total.failures:
        report(failure)
    return total


def _share(task: tuple[str, Any]) -> Tally:
    warnings.simplefilter("error")
    warnings.simplefilter("ignore", UnphysicalMoments)
    name, plan = task
    return follow(replace(plan, suite=suite_of(name)))


if __name__ == "__main__":
    leave(main())
