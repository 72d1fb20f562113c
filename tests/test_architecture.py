"""Rooms, arrows and homes: imports have no cycles, rooms have at most twenty files, every public name has one
home.

All imports count, including those inside functions and under TYPE_CHECKING. The exceptions are the packages themselves,
whose public names are imported on first use, and the facades listed in pyproject.toml.
"""

from __future__ import annotations

import ast
import gc
import importlib
import re
import tomllib
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest

from tests.fuzz.zoo import IMPORTED

ROOT = Path(__file__).parents[1]
PACKAGES = ("jacobian", "integrable")
PAGES = sorted((ROOT / "docs" / "rooms").rglob("*.md"))
MOST_FILES = 20
MOST_LINES, MOST_PARAMETERS = 40, 8
# compiled loops and the functions that they call, in which an argument costs only a register
LONG = {
    "integrable.moving_point.short.panel",
    "integrable.moving_point.short_compiled.entry",
    "integrable.moving_point.short_reading.short_state",
    "jacobian.inexact.stacked._second_polynomial",
}
# files of a package outside the rooms, which are below the rooms, above them, or collect their public names
OUTSIDE = {
    "jacobian": {
        "__init__",
        "__main__",
        "compilation",
        "element",
        "errors",
        "group",
        "immutable",
        "interrupts",
        "linear",
        "notebook",
        "owner",
        "poly",
        "progress",
        "terminal",
    },
    "integrable": {"__init__", "__main__", "doctor", "extras", "reference"},
}
MOVING = [
    "phase",
    "moving_point",
    "torus",
    "motion",
    "mumford",
    "series",
    "classical",
    "systems",
    "deformations",
    "portrait",
]
CALLED_BY_NUMBA = {"unify"}
# the compiler calls the method that is named after a node's class
CALLED_BY_NODE = {f"{prefix}_{name.lower()}" for prefix in ("do", "of") for name in vars(ast)}
WALKS = {"Array", "Row"}
MOST_ANY = 300
# imports that lint-imports permits; pyproject.toml gives the reasons
CONTRACTS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
FACADES = {tuple(edge.split(" -> ")) for contract in CONTRACTS for edge in contract.get("ignore_imports", [])}


@cache
def modules() -> dict[str, Path]:
    """All modules of both packages by their dotted names."""
    found = {}
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


@cache
def trees() -> dict[str, ast.Module]:
    """The trees of all modules. The garbage collector would go through their nodes five times meanwhile."""
    gc.disable()
    try:
        return {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in modules().items()}
    finally:
        gc.enable()
        gc.freeze()


def tree(name: str) -> ast.Module:
    return trees()[name]


@cache
def nodes(name: str) -> list[ast.AST]:
    """All nodes of a module's tree, listed once for all tests."""
    return list(ast.walk(tree(name)))


def imported(name: str) -> set[str]:
    """The modules of both packages that a module imports, anywhere in it."""
    package = name.split(".") if modules()[name].name == "__init__.py" else name.split(".")[:-1]
    found = set()
    for node in nodes(name):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            for alias in node.names:
                whole = f"{base}.{alias.name}"
                found.add(whole if whole in modules() else base)
    return {other for other in found & set(modules()) if other not in PACKAGES and (name, other) not in FACADES}


def circles(edges: dict[str, set[str]]) -> list[set[str]]:
    """The strongly connected components of more than one module (Kosaraju 1978)."""

    def reached(start: str, along: dict[str, set[str]], seen: set[str]) -> list[str]:
        order, stack = [], [(start, iter(sorted(along[start])))]
        seen.add(start)
        while stack:
            rest = stack[-1][1]
            for other in rest:
                if other not in seen:
                    seen.add(other)
                    stack.append((other, iter(sorted(along[other]))))
                    break
            else:
                order.append(stack.pop()[0])
        return order

    seen: set[str] = set()
    order = [name for start in edges if start not in seen for name in reached(start, edges, seen)]
    back: dict[str, set[str]] = {name: set() for name in edges}
    for name, others in edges.items():
        for other in others:
            back[other].add(name)
    seen = set()
    parts = [reached(start, back, seen) for start in reversed(order) if start not in seen]
    return [set(part) for part in parts if len(part) > 1]


def test_a_circle_would_be_found():
    edges = {"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": {"e"}, "e": set()}
    assert circles(edges) == [{"a", "b", "c"}]
    assert circles({**edges, "c": {"d"}}) == []


def test_no_imports_lead_in_a_circle():
    assert circles({name: imported(name) for name in modules() if name not in PACKAGES}) == []


@pytest.mark.parametrize("package", PACKAGES)
def test_rooms(package):
    """Every file lies in a room of at most twenty files whose ``__init__`` describes its contents; the tests have the
    same rooms.
    """
    assert {path.stem for path in (ROOT / package).glob("*.py")} == OUTSIDE[package]
    rooms = {path.parent for path in (ROOT / package).rglob("*.py")} - {ROOT / package}
    for room in rooms:
        assert room.parent == ROOT / package
        assert len(list(room.glob("*.py"))) <= MOST_FILES, room.name
        assert ast.get_docstring(tree(f"{package}.{room.name}")), room.name
    tested = {path.parent for path in (ROOT / "tests" / package).rglob("*.py")} - {ROOT / "tests" / package}
    assert {path.name for path in tested} <= {path.name for path in rooms}


@pytest.mark.parametrize("package", PACKAGES)
def test_every_public_name_has_one_home(package):
    """One module defines it, under whatever other names, and the facade leads to that module."""
    facade = importlib.import_module(package)
    leads = {
        alias.name: node.module
        for node in ast.walk(tree(package))
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    for name in facade.__all__:
        homes = [module for module in modules() if module.split(".")[0] == package and name in defined(module)]
        assert homes == [leads[name]], name
        assert getattr(facade, name) is getattr(importlib.import_module(leads[name]), name)
    home = getattr(facade, "_HOME", None)
    assert home is None or home == {name: leads[name] for name in facade.__all__}


@pytest.mark.parametrize("name", IMPORTED)
def test_what_is_public_in_a_room_has_one_home(name):
    """No other module of either package defines the name: RayClassGroup, principal_divisor, recursion_operator, …"""
    assert [module for module in modules() if name in defined(module)] == [IMPORTED[name]]


def test_a_class_or_function_of_motions_has_a_name_of_its_own():
    """No two modules of the rooms for motions define a class, function or alias of the same name, except those listed:
    arrays and rows of numbers in compiled loops.
    """
    found = defaultdict(list)
    for module in in_motions():
        for node in tree(module).body:
            if isinstance(node, ast.ClassDef | ast.FunctionDef) and not node.name.startswith("_"):
                found[node.name].append(module)
            elif isinstance(node, ast.Assign | ast.AnnAssign) and "TypeVar" not in ast.unparse(node):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                names = [target.id for target in targets if isinstance(target, ast.Name)]
                for name in names:
                    # constants of a module are in capitals
                    if name[0].isupper() and not name.isupper():
                        found[name].append(module)
    assert {name for name, homes in found.items() if len(homes) > 1} == WALKS


def in_motions() -> list[str]:
    """The modules of the rooms for motions."""
    return [name for name in modules() if name.split(".")[:2] in [["integrable", room] for room in MOVING]]


def test_few_types_of_motions_are_any():
    """In annotations and aliases; those that remain are numbers that formulas share with jets, symbols and columns, and
    flows and systems of several rooms.
    """
    found = sum(isinstance(node, ast.Name) and node.id == "Any" for name in in_motions() for node in nodes(name))
    assert 0 < found < MOST_ANY


def test_no_field_is_told_from_another_by_its_attributes():
    """``hasattr`` only asks whether a number is of mpmath, a value an array or a record, and whether a system has other
    fields; no value is passed as a type that it is not.
    """
    asked, ignored = set(), set()
    for name in in_motions():
        ignored |= set(re.findall(r"type: ignore\[([\w-]+)\]", modules()[name].read_text(encoding="utf-8")))
        for node in nodes(name):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "hasattr":
                asked.add(ast.literal_eval(node.args[1]))
    assert asked == {"_mpf_", "_fields", "tolist", "over"}
    assert ignored == {"assignment", "call-arg", "override"}


@cache
def defined(name: str) -> set[str]:
    """What a module defines at its top: classes, functions and names of values."""
    found = set()
    for node in tree(name).body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            found.add(node.name)
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            found |= {target.id for target in targets if isinstance(target, ast.Name)}
    return found


def words_of(name: str) -> set[str]:
    """The words of a module's code and strings, without its docstrings and the names that it defines."""
    documented = {
        id(node.body[0].value)
        for node in nodes(name)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and isinstance(node.body[0], ast.Expr)
    }
    found = set()
    for node in nodes(name):
        match node:
            case ast.Name(id=word) | ast.Attribute(attr=word) | ast.alias(name=word) | ast.keyword(arg=str(word)):
                found.add(word)
            case ast.Constant(value=str(text)) if id(node) not in documented:
                found |= set(re.findall(r"\w+", text))
    return found


def test_nothing_is_there_for_tests_alone():
    """A function, class or method that no code uses must be meant for users, so a page must mention it."""
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    used = {word for page in pages for word in re.findall(r"\w+", page.read_text(encoding="utf-8"))}
    used = used.union(CALLED_BY_NUMBA, CALLED_BY_NODE, *map(words_of, modules()))
    plain = {"property", "cached_property", "staticmethod", "classmethod"}
    for module in modules():
        for node in nodes(module):
            if isinstance(node, ast.ClassDef | ast.FunctionDef) and node.name not in used:
                # decorated functions are registered somewhere
                registered = {ast.unparse(decorator) for decorator in node.decorator_list} - plain
                assert registered or node.name.startswith("__"), f"{module}.{node.name}"


def test_what_a_study_leaves_out_of_its_stamp_is_there():
    from integrable.study.store import _SHOWN_ONLY

    for name in _SHOWN_ONLY:
        assert any((ROOT / package / name).exists() for package in PACKAGES), name


def test_functions_fit_on_a_screen_and_take_few_arguments():
    """At most 40 lines and 8 parameters, except a few compiled functions, which are all longer."""
    found = set()
    for module in modules():
        for node in nodes(module):
            if isinstance(node, ast.FunctionDef):
                lines = (node.end_lineno or 0) - node.lineno + 1
                arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
                if lines > MOST_LINES or len(arguments) > MOST_PARAMETERS:
                    found.add(f"{module}.{node.name}")
    assert found == LONG


def test_every_room_has_a_page():
    """In docs/rooms: its purpose, its vocabulary, its input and output, where to start reading, and lines that run."""
    pages = {path.relative_to(ROOT / "docs" / "rooms").with_suffix("").as_posix() for path in PAGES}
    folders = {path.parent for name in PACKAGES for path in (ROOT / name).rglob("*") if path.is_file()}
    rooms = {path.relative_to(ROOT).as_posix() for path in folders if "__pycache__" not in path.parts} - set(PACKAGES)
    assert pages == rooms
    listed = (ROOT / "docs" / "rooms.md").read_text(encoding="utf-8")
    for path in PAGES:
        assert f"(rooms/{path.parent.name}/{path.name})" in listed
        text = path.read_text(encoding="utf-8")
        for part in ("**Words.**", "**In and out.**", "**Read first.**", "\n>>> "):
            assert part in text, (path, part)
