"""Compiled objects on disk. An object is valid as long as the sources that it was built from are unchanged."""

from __future__ import annotations

import ast
import json
import os
import sys
from collections.abc import Iterable
from functools import cache
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from jacobian.errors import ArgumentError
from jacobian.numbers.compiler import NO_PLACE, REMEDY, say_once

HERE = Path(__file__).parent


def place() -> Path | None:
    """The folder for compiled objects; None if no candidate is writable.

    It is NUMBA_CACHE_DIR if that is set. Otherwise the candidates are ``__pycache__`` in this folder, then the user's
    cache.
    """
    named = os.environ.get("NUMBA_CACHE_DIR")
    base = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    for folder in [Path(named)] if named else [HERE / "__pycache__", Path(base) / "jacobian"]:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    return None


def look_for_a_place(*, needed: bool = False) -> None:
    """Warns if no folder for compiled code is writable; raises ArgumentError instead if one is ``needed``."""
    if place() is None:
        if needed:
            raise ArgumentError(f"{NO_PLACE}; {REMEDY}")
        say_once()


class Object(NamedTuple):
    """Compiled code in the form in which it is stored.

    The fields: the ``struct`` letters of each entry's result, in brackets for tuples; the source modules; the module
    constants that were compiled in, by full name; the machine code.
    """

    results: dict[str, str]
    modules: list[str]
    numbers: dict[str, str]
    code: bytes


def find(folder: Path, name: str, made_for: str) -> Object | None:
    """The stored object of that name if it was built for this machine from unchanged sources, else None."""
    try:
        head, _, code = _file(folder, name).read_bytes().partition(b"\n")
        known = json.loads(head)
    except (OSError, ValueError):
        return None
    good = (
        known["made for"] == made_for
        and known["size"] == len(code)
        and known["sources"] == stamps(known["sources"])
        and known["numbers"] == {name: number_of(*name.rsplit(".", 1)) for name in known["numbers"]}
    )
    return Object(known["results"], list(known["sources"]), known["numbers"], code) if good else None


def keep(folder: Path, name: str, made_for: str, made: Object) -> None:
    """Stores an object with its machine and the hashes of its sources and the compiler's, if the folder is writable."""
    sources = stamps(sorted({*made.modules, *compiler()}))
    known = {
        "made for": made_for, "size": len(made.code), "sources": sources, "numbers": made.numbers,
        "results": made.results,
    }  # fmt: skip
    path = _file(folder, name)
    beside = path.with_suffix(f".{os.getpid()}")
    try:
        beside.write_bytes(json.dumps(known).encode() + b"\n" + made.code)
        os.replace(beside, path)
    except OSError:
        beside.unlink(missing_ok=True)


def _file(folder: Path, name: str) -> Path:
    # several installations may share a folder, so file names contain a hash of this one's path
    mark = sha256(f"{HERE} {sys.implementation.cache_tag}".encode()).hexdigest()[:8]
    return folder / f"{name}-{mark}.native"


@cache
def compiler() -> frozenset[str]:
    """The names of the modules of the compiler: those in this folder, and those of this package that they import."""
    found: set[str] = set()
    left = {f"{__package__}.{path.stem}" for path in HERE.glob("*.py") if path.stem != "__init__"}
    while left:
        module = left.pop()
        found.add(module)
        left |= _imported(module) - found
    return frozenset(found)


def _imported(module: str) -> set[str]:
    """The modules of this package that a module imports, or imports names from."""
    package, found = __package__.partition(".")[0], set()
    for node in ast.walk(ast.parse(_source(module))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.partition(".")[0] == package:
            names = {f"{node.module}.{x.name}" for x in node.names}
            found |= {name for name in names if _source(name)} or {node.module}
    return found


def _source(module: str) -> bytes:
    path = HERE.parent.parent.joinpath(*module.split(".")).with_suffix(".py")
    return path.read_bytes() if path.is_file() else b""


def number_of(module: str, name: str) -> str:
    """The ``repr`` of a constant of a loaded module; "None" if there is none."""
    return repr(getattr(sys.modules.get(module), name, None))


def stamps(modules: Iterable[str]) -> dict[str, str]:
    """The hash of each module's source, by module name."""
    found = {}
    for module in modules:
        there = sys.modules.get(module)
        origin = getattr(there, "__file__", None) if there else getattr(find_spec(module), "origin", None)
        try:
            found[module] = sha256(Path(str(origin)).read_bytes()).hexdigest()
        except OSError:
            found[module] = ""
    return found
