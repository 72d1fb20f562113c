"""The reader of scene files in TOML, which refuses unknown keys and values. ``docs/scenes.md`` lists every key."""

from __future__ import annotations

import importlib.resources
import os
import tomllib
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any
from unicodedata import category

from integrable.phase.body import say_unphysical
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.scene.data import MOST_STEPS, SYSTEMS, Comparison, Map, Scene, Steps, Times, finite_field
from integrable.scene.toml import Table, suggestion
from jacobian import QQ
from jacobian.errors import ArgumentError, shown

__all__ = ["load_scene", "scene_names"]

_WORDS = ("title", "reference", "description")
_PICTURES = ("work_precision", "sphere", "residual_growth")
_OF_THE_REPORT = ("work_precision", "residual_growth")
_ORBIT_PICTURES = ("sphere", "orbit_error")
_CLASSICAL_PICTURES = ("work_precision", "coordinates")
_SMALLEST_TOLERANCE = Fraction("2.3e-14")  # SciPy increases smaller tolerances to 100 eps, with a warning


def scene_names() -> list[str]:
    """Names of the scenes that ship with the package."""
    folder = importlib.resources.files("integrable") / "scenes"
    return sorted(item.name.removesuffix(".toml") for item in folder.iterdir() if item.name.endswith(".toml"))


def load_scene(name_or_path: str | Path) -> Scene:
    """The scene with that name among :func:`scene_names`, or the scene in that TOML file.

    Raises ArgumentError; its message of one line names the file, table, key and value, and what is accepted.
    """
    if not isinstance(name_or_path, (str, os.PathLike)):
        raise ArgumentError(
            f"name_or_path = {shown(name_or_path)}: give the name of a scene or the path of a .toml file"
        )
    source = str(name_or_path)
    if isinstance(name_or_path, str) and source in scene_names():
        text = (importlib.resources.files("integrable") / "scenes" / f"{source}.toml").read_text(encoding="utf-8-sig")
        return _read(source, f"scene {source}.toml", text)
    path = Path(name_or_path)
    try:
        if path.suffix != ".toml" and not path.exists():
            raise ArgumentError(
                f'scene: "{source}" given, no such scene; {suggestion(source, scene_names())}; or give a .toml file'
            )
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "not UTF-8 text"
        raise ArgumentError(f'scene: "{source}" cannot be read: {why}; the path of a .toml file is needed') from None
    scene = _read(_readable(path.stem), f"scene {_readable(path.name)}", text)
    if scene.system in ("chaplygin_ball", "euler_top") and not scene.finite_field:
        say_unphysical(scene.inertia, QQ)
    return scene


def _readable(name: str) -> str:
    """A file name as one line of printable text: control characters and bytes that are not UTF-8 become "_"."""
    return "".join("_" if category(c) in ("Cc", "Cs", "Zl", "Zp") else c for c in name)


def _read(name: str, place: str, text: str) -> Scene:
    try:
        content = tomllib.loads(text, parse_float=Decimal)
    except tomllib.TOMLDecodeError as error:
        raise ArgumentError(f"{place}: not a TOML file: {error}") from None
    except RecursionError:
        raise ArgumentError(f"{place}: not a scene: brackets in brackets, too deep to be read") from None
    except (ValueError, ArithmeticError):
        # Python's int or Decimal raises this error, and tomllib passes it on
        raise ArgumentError(f"{place}: not a scene: a number is too long to be read") from None
    tables = ("body", "start", "run", "steps", "report", "output")
    top = Table(f"{place}:", content, (*_WORDS, "system", "field", *tables))
    system = top.choice("system", SYSTEMS)
    body = _section(top, "body", SYSTEMS[system].keys)
    classical, plain = SYSTEMS[system].room == "classical", system in ("chaplygin_ball", "euler_top")
    if classical and "steps" in top:
        top.fail("[steps]", f'given; system = "{system}" has scenes of motions, with [run]')
    halves, length = (("q", "p"), None) if classical else (("gamma", "M"), 3)
    start = _section(top, "start", (*halves, "tilted") if plain else halves)
    words: dict[str, Any] = {key: top.text(key, "").strip() for key in _WORDS} | {"title": top.text("title", name)}
    orbit, pictures = "steps" in top, _CLASSICAL_PICTURES if classical else _PICTURES
    return Scene(
        name=name,
        system=system,
        **words,
        **_read_body(body, system),
        gamma=start.numbers(halves[0], length),
        M=start.numbers(halves[1], length),
        tilted=start.flag("tilted") if plain else False,
        **(_read_orbit(top, plain) if orbit else _read_motion(top, plain, pictures)),
        place=place,
    )


def _read_motion(top: Table, plain: bool, pictures: tuple[str, ...]) -> dict[str, Any]:
    """The contents of ``[run]``, ``[report]`` and ``[output]`` of a motion.

    ``pictures`` are the pictures that may be asked for. The name of the second one, such as "sphere", is also a key of
    ``[output]``, with the times of the curve that this picture shows.
    """
    if "field" in top:
        top.fail("field", "given, but a motion runs over real numbers; a finite field needs [steps] instead of [run]")
    runs = _section(top, "run", ("times", "digits"))
    report = None
    if "report" in top:
        keys = _COMPARISON if plain else tuple(key for key in _COMPARISON if key != "steps")
        report = _read_comparison(_section(top, "report", keys))
    drawn, curve = _read_output(_section(top, "output", ("pictures", pictures[1])), report, pictures)
    times, digits = _read_times(runs, "times"), runs.integer("digits", 1, FLOAT_DIGITS)
    return {"times": times, "digits": digits, "report": report, "pictures": drawn, "sphere": curve}


def _read_orbit(top: Table, plain: bool) -> dict[str, Any]:
    """The contents of ``[steps]`` and ``[output]`` of an orbit."""
    for key in ("run", "report"):
        if key in top:
            top.fail(f"[{key}]", "given beside [steps]; a scene has either [run], a motion, or [steps], an orbit")
    field = top.text("field", "")
    exact = "field" in top
    if exact:
        try:
            finite_field(field)
        except ArgumentError as error:
            top.fail("field", str(error).removeprefix("field: "))
    table = _section(top, "steps", _STEPS[:3] if exact else _STEPS)
    digits, truth_digits = ((), 0) if exact else _read_costs(table, least=1)
    count = table.integer("count", 1)
    if count > MOST_STEPS:
        table.fail("count", f"{count} given; {MOST_STEPS} steps are the most, all states are kept")
    maps = tuple(
        _read_map(one, _MAPS if plain else _CURVE_MAPS) for one in table.tables("maps", ("kind", *_EVERY_ARGUMENT))
    )
    output = _section(top, "output", ("pictures",))
    pictures = output.choices("pictures", _ORBIT_PICTURES)
    if exact and pictures:
        output.fail("pictures", f'"{pictures[0]}" given; points over a finite field have no place in a picture')
    return {
        "steps": Steps(maps, count, digits, truth_digits, table.integer("repeat", 1, 3)),
        "digits": digits[0] if digits else FLOAT_DIGITS,
        "finite_field": field,
        "pictures": pictures,
    }


_STEPS = ("maps", "count", "repeat", "digits", "truth_digits")
_MAPS = {
    "translation": ("points", "conjugate", "sheets", "signs", "multiple"),
    "torsion": ("signs",),
    "keyless": ("signs",),
    "multiplication": ("factor",),
    "conic": ("x0", "y0", "sign"),
    "shift": ("weights",),
}
_CURVE_MAPS: dict[str, tuple[str, ...]] = {"translation": ("points", "sheets", "multiple")}
_EVERY_ARGUMENT = tuple(dict.fromkeys(key for keys in _MAPS.values() for key in keys))


def _read_map(table: Table, kinds: dict[str, tuple[str, ...]]) -> Map:
    """One map of ``[steps]``. ``kinds`` lists the maps of the scene's system, with their arguments."""
    kind = table.choice("kind", kinds)
    for key in table.content:
        if key not in ("kind", *kinds[kind]):
            table.fail(key, f'given; kind = "{kind}" takes {", ".join(kinds[kind])}')
    if kind == "translation" and ("points" in table) == ("conjugate" in table):
        table.fail("points", "either points, one or two numbers, or conjugate, two numbers [re, im], are needed")
    read: dict[str, Any] = {}
    for key in kinds[kind]:
        if key in table or key in ("factor", "y0", "weights"):
            read[key] = _read_argument(table, key)
    if kind == "conic":
        read.setdefault("x0", None)
    return Map(kind, tuple(read.items()))


def _read_argument(table: Table, key: str) -> Any:
    if key in ("sheets", "signs"):
        return table.signs(key)
    if key in ("multiple", "factor", "sign"):
        return table.integer(key, None)
    if key in ("x0", "y0"):
        return table.number(key)
    return table.numbers(key, None if key == "points" else 2)


def _section(top: Table, key: str, known: tuple[str, ...]) -> Table:
    """A top-level table. Messages show it as ``[key]``, as in the file."""
    needed = key in ("body", "start", "run", "steps")
    if needed and key not in top:
        wanted = f"a table with {', '.join(known)}" if known else "an empty table"
        top.fail(f"[{key}]", f"missing; {wanted} is needed")
    return Table(f"{top.place} [{key}]", top.content.get(key, {}), known)


def _read_body(body: Table, system: str) -> dict[str, Any]:
    """The contents of ``[body]``. A ball has d, or mass and radius; a tilde may have d."""
    keys, sizes = SYSTEMS[system].keys, ("d", "mass", "radius")
    if SYSTEMS[system].room == "classical":
        constants = tuple((key, body.number_or_numbers(key)) for key in keys)
        return {"inertia": (), **dict.fromkeys(sizes), "constants": constants}
    inertia, present = body.numbers("inertia", 3), [key for key in sizes if key in body]
    given = {key: body.number(key) if key in present else None for key in sizes}
    if system == "chaplygin_ball" and present not in (["d"], ["mass", "radius"]):
        body.fail("d", f"{' and '.join(present) or 'nothing'} given; either d, or mass and radius, are needed")
    return {
        "inertia": inertia,
        **given,
        "potential": body.numbers("potential", 5) if "potential" in body else None,
        "c": body.number("c") if system == "gyroscopic" else None,
    }


MOST_TIMES = 10_000_000
BYTES_OF_A_TIME = 150
"""The bytes of a time as a Python float, and of t, τ, γ and M at that time as doubles."""


def _read_times(table: Table, key: str) -> Times:
    if isinstance(table.content.get(key), list):
        given = table.numbers(key)
        if not given or min(given) < 0:
            table.fail(key, f"{float(min(given)) if given else 'no time'} given; times ≥ 0 are needed, at least one")
        return Times(given=given)
    spaced = table.table(key, ("from", "until", "count", "spacing"))
    spacing = spaced.choice("spacing", ("linear", "log"), "linear")
    first = spaced.number("from", Fraction(0)) if spacing == "linear" else spaced.number("from")
    until = spaced.number("until")
    if first < 0 or (spacing == "log" and first == 0):
        spaced.fail("from", f"{float(first)} given; a time {'≥ 0' if spacing == 'linear' else '> 0'} is needed")
    if until <= first:
        spaced.fail("until", f"{float(until)} given; a time after {float(first)} is needed")
    if spacing == "log" and until / first > 10**300:  # the ratio must be a float
        spaced.fail("until", f"{float(until)} given; at most 1e300 times {float(first)} is needed")
    count = spaced.integer("count", 2)
    if count > MOST_TIMES:
        memory = count * BYTES_OF_A_TIME / 1e9
        spaced.fail(
            "count",
            f"{count} given; {MOST_TIMES} is the most, these would take {memory:.3g} GB: Flow.stream writes "
            "longer runs to a file",
        )
    return Times((), first, until, count, spacing)


_COMPARISON = ("digits", "tolerances", "truth_digits", "check_time", "repeat", "steps")


def _read_comparison(table: Table) -> Comparison:
    digits, truth_digits = _read_costs(table)
    tolerances = table.numbers("tolerances", default=())
    for tolerance in tolerances:
        if not _SMALLEST_TOLERANCE <= tolerance < 1:
            table.fail("tolerances", f"{float(tolerance)} given; SciPy takes tolerances from 2.3e-14 to below 1")
    check_time = table.number("check_time", Fraction(1))
    if not 0 < check_time <= 100:
        table.fail("check_time", f"{float(check_time)} given; a time above 0, not above 100, is needed")
    repeat, steps = table.integer("repeat", 1, 3), table.integers("steps", ())
    return Comparison(digits, tolerances, truth_digits, check_time, repeat, steps)


def _read_costs(table: Table, least: int = 0) -> tuple[tuple[int, ...], int]:
    """The digits of each measured run, for at least ``least`` runs, and the digits of their truth."""
    digits = table.integers("digits", (FLOAT_DIGITS,))
    if len(set(digits)) < len(digits) or sum(n <= FLOAT_DIGITS for n in digits) > 1 or len(digits) < least:
        table.fail("digits", f"{list(digits)} given; different costs are needed, at most one of them up to 15 (floats)")
    truth_digits = table.integer("truth_digits", 1, max((40, *(n + 15 for n in digits))))
    if digits and truth_digits < max(digits) + 10:
        table.fail(
            "truth_digits", f"{truth_digits} given; at least {max(digits) + 10}, 10 more than the costs, are needed"
        )
    return digits, truth_digits


def _read_output(
    table: Table, report: Comparison | None, known: tuple[str, ...]
) -> tuple[tuple[str, ...], Times | None]:
    pictures = table.choices("pictures", known)
    for picture in pictures:
        if picture in _OF_THE_REPORT and report is None:
            table.fail("pictures", f'"{picture}" given, which shows the report; a [report] table is needed')
    if "residual_growth" in pictures and report is not None and not report.steps:
        table.fail("pictures", '"residual_growth" given; steps in [report] are needed')
    return pictures, _read_times(table, known[1]) if known[1] in table else None
