"""The reference: every public name from its docstring, and every command with its options."""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path
from typing import Any

CLASSICAL = Path(__file__).parents[2] / "integrable" / "classical"
# page: what it is about, and modules whose public names it lists
PAGES: dict[str, tuple[str, str, list[str]]] = {
    "jacobian": (
        "`jacobian`",
        "Curves, divisors, their group, and the fields below them.",
        ["jacobian", "jacobian.curve.zeta"],
    ),
    "batch": ("`jacobian.batch`", "Arrays of divisors.", ["jacobian.batch"]),
    "relatives": (
        "The relatives and periods",
        "Other groups on a curve, and the way from divisors to complex numbers and back.",
        [
            "jacobian.relatives.formal_sum",
            "jacobian.relatives.glued",
            "jacobian.relatives.ray_class",
            "jacobian.relatives.conic",
            "jacobian.relatives.signed",
            "jacobian.relatives.kummer",
            "jacobian.relatives.pseudo_group",
            "jacobian.relatives.heights",
            "jacobian.relatives.generators",
            "jacobian.models.standard",
            "jacobian.models.isomorphism",
            "jacobian.models.invariants",
            "jacobian.models.richelot",
            "jacobian.periods.matrix",
            "jacobian.periods.abel",
            "jacobian.periods.proven",
            "jacobian.periods.abel_balls",
            "jacobian.periods.siegel",
            "jacobian.periods.second_kind",
            "jacobian.periods.kleinian",
            "jacobian.periods.real",
            "jacobian.periods.conventions",
            "jacobian.periods.endomorphisms",
            "jacobian.arithmetic.endomorphism_algebras",
            "jacobian.page.lines",
            "jacobian.page.record",
        ],
    ),
    "integrable": (
        "`integrable`",
        "Bodies, their motions, and scenes. Units: moments of inertia and d = m r² in one unit, M in that unit over a unit of time; "
        "times, ω (radians over that time) and energies follow. Lengths are radii of the ball unless `radius` is given.",
        ["integrable"],
    ),
    "motion": (
        "Motions and steps",
        "What `flow(state)` and the maps return.",
        [
            "integrable.motion.flow",
            "integrable.portrait.portrait",
            "integrable.portrait.spectrum",
            "integrable.laboratory.motion",
            "integrable.phase.enclosure",
            "integrable.motion.enclosure",
            "integrable.deformations.deformed_flow",
            "integrable.deformations.separated_flow",
            "integrable.deformations.pole_flow",
            "integrable.deformations.integrated",
            "integrable.deformations.enclosed",
            "integrable.phase.state",
            "integrable.phase.body",
            "integrable.phase.separation",
            "integrable.phase.recursion",
            "integrable.steps.step",
            "integrable.steps.translation",
        ],
    ),
    "genus": (
        "Motions of any genus",
        "Systems on y² = f(x) of any genus, one file each, and their common base ([how](../mumford.md)).",
        [
            *(f"integrable.classical.{path.stem}" for path in sorted(CLASSICAL.glob("[a-z]*.py"))),
            "integrable.mumford.system",
            "integrable.mumford.flow",
            "integrable.mumford.fields",
            "integrable.mumford.maps",
        ],
    ),
    "many": (
        "Ensembles, sweeps and files",
        "Many motions at once, on many machines, and what results are written to ([how](../many.md)).",
        [
            "integrable.ensembles.ensemble",
            "integrable.ensembles.trajectories",
            "integrable.ensembles.laboratory",
            "integrable.sweeps.sweep",
            "integrable.files.writing",
        ],
    ),
    "oracles": (
        "Independent integrators",
        "They share no code with the flow.",
        ["integrable.reference", "integrable.oracles.methods"],
    ),
    "problems": (
        "Problems with known solutions",
        "Initial value problems to test an integrator on, and races on them.",
        [
            "integrable.problems.catalogue",
            "integrable.problems.statement",
            "integrable.problems.certified",
            "integrable.races.race",
        ],
    ),
    "scenes": (
        "Scenes, runs and pages",
        "Runs described as data, and their results.",
        [
            "integrable.scene.data",
            "integrable.scene.orbit",
            "integrable.study.command",
            "integrable.view.page",
            "integrable.view.shown",
        ],
    ),
}


def write(source: Path) -> None:
    """Write the pages into ``source``/reference."""
    folder = source / "reference"
    folder.mkdir()
    seen: set[int] = set()
    for name, (title, text, modules) in PAGES.items():
        parts = [f"# {title}\n\n{text}\n"]
        for module in modules:
            parts.append(_module(module, seen, heading=len(modules) > 1))
        (folder / f"{name}.md").write_text("\n".join(parts), encoding="utf-8")
    (folder / "commands.md").write_text(_commands(), encoding="utf-8")
    names = "\n".join(PAGES)
    (folder / "index.md").write_text(
        "# Reference\n\nEvery public name with its docstring, every command with its options, every key of a scene file.\n\n"
        f"```{{toctree}}\n:maxdepth: 1\n\ncommands\n/scenes\n{names}\n```\n",
        encoding="utf-8",
    )


def public(module: Any) -> list[str]:
    """The public names of a module that are its own, or that a package gives."""
    names = getattr(module, "__all__", None)
    if names is None:
        own = {n: v for n, v in vars(module).items() if not n.startswith("_") and callable(v)}
        names = [n for n, v in own.items() if getattr(v, "__module__", "") == module.__name__]
    return list(names)


def _module(name: str, seen: set[int], heading: bool) -> str:
    module = import_module(name)
    parts = [f"## `{name}`\n"] if heading else []
    summary = (module.__doc__ or "").strip().partition("\n\n")[0]
    lines = []
    for entry in public(module):
        thing = getattr(module, entry)
        if id(thing) in seen:
            continue
        seen.add(id(thing))
        home = getattr(thing, "__module__", None) or name
        if isinstance(thing, type):
            lines.append(f".. autoclass:: {home}.{thing.__qualname__}\n   :members:\n   :inherited-members:\n")
        elif callable(thing) and hasattr(thing, "__qualname__"):
            lines.append(f".. autofunction:: {home}.{thing.__qualname__}\n")
        else:
            lines.append(f".. autodata:: {name}.{entry}\n   :no-value:\n")
    if heading and summary:
        parts.append("```{eval-rst}\n.. automodule:: " + name + "\n   :no-index:\n```\n")
    if lines:
        parts.append("```{eval-rst}\n" + "\n".join(lines) + "```\n")
    return "\n".join(parts)


def _commands() -> str:
    from integrable.__main__ import _parser

    parser = _parser()
    parts = [
        "# Commands\n\nAs `integrable --help` and `integrable COMMAND --help` print them. `python -m integrable` is the same. With the extra "
        "`completion` (`pip install 'jacobian-integrable[completion]'`) and `eval \"$(register-python-argcomplete integrable)\"` in its start-up "
        "file, bash or zsh completes commands, options and scenes.\n"
    ]
    parts.append(f"```text\n{_help(parser)}```\n")
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, one in action.choices.items():
                parts.append(f"## integrable {name}\n\n```text\n{_help(one)}```\n")
    parts.append(
        "## python -m jacobian compile\n\nCompiles every library of loops, keeps it on disk, and says how long each took, so that no later "
        "run waits for it. `python -m benchmarks` (from a clone) lists the benchmarks.\n"
    )
    return "\n".join(parts)


def _help(parser: argparse.ArgumentParser) -> str:
    import os

    os.environ["COLUMNS"], before = "96", os.environ.get("COLUMNS")
    try:
        return parser.format_help()
    finally:
        if before is None:
            del os.environ["COLUMNS"]
        else:
            os.environ["COLUMNS"] = before
