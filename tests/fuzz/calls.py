"""Fuzz of wrong arguments: every public callable with values from a zoo in place of one or two of its arguments.

A call must return a value, or raise an error of :mod:`jacobian.errors` at once; the message of an ArgumentError is one
line that names what is wrong. Python's own TypeError is right for operators that no operand knows; missing and unknown
arguments do not occur here. Methods whose arguments are raw elements by contract, for speed, are left out:
:data:`zoo.RAW`.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from functools import cache
from random import Random
from typing import Any

from jacobian.errors import ArgumentError, JacobianError
from tests.fuzz.case import Case, Complaint
from tests.fuzz.fixtures import LINES, lines_for, made
from tests.fuzz.run import Suite
from tests.fuzz.zoo import CALLED, FACTORIES, FIXED, GOOD, HOSTILE, IMPORTED, OBJECTS, OPERATORS, RAW, ZOO

# bytes that a call may allocate beyond those of the process
MEMORY = 2 << 30


@cache
def names() -> dict[str, Any]:
    """The objects, made once; the program that reproduces a failure makes its own."""
    found = made()
    exec(HOSTILE + "\n".join(f"from {module} import {name}" for name, module in IMPORTED.items()), found)
    return found


@cache
def targets() -> list[tuple[str, str, tuple[str, ...], frozenset[str]]]:
    """(text of a callable, its object, its arguments, those of them that are keyword-only)."""
    found = []
    for name in OBJECTS:
        kind = type(names()[name])
        for method in sorted(
            m for m in dir(kind) if not m.startswith("_") and m not in RAW and callable(getattr(kind, m))
        ):
            found.append((f"{name}.{method}", name))
    found += [(name, name) for name in (*CALLED, *FACTORIES)]
    return [made for text, owner in found if (made := _described(text, owner))[2]]


def _described(text: str, owner: str) -> tuple[str, str, tuple[str, ...], frozenset[str]]:
    try:
        given = inspect.signature(eval(text, dict(names()))).parameters.values()
    except ValueError:
        given = ()  # type: ignore[assignment]
    named = [p for p in given if p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL, p.POSITIONAL_ONLY)]
    return text, owner, tuple(p.name for p in named), frozenset(p.name for p in named if p.kind == p.KEYWORD_ONLY)


def good(text: str, owner: str, argument: str) -> str:
    for key in (f"{text}.{argument}", f"{owner}.{argument}", f"{text.split('.')[-1]}.{argument}", argument):
        if key in GOOD:
            return GOOD[key]
    return "None"


def bad_argument(rng: Random) -> Case:
    text, owner, arguments, _ = rng.choice(targets())
    free = [x for x in arguments if (text.split(".")[-1], x) != ("coerce", "argument")]
    wrong = set(rng.sample(free, min(len(free), rng.choice((1, 1, 1, 2)))))
    if text == "run":
        # a valid scene would run for minutes
        wrong |= {"scene"}
    parts = [f"{x}={rng.choice(_zoo(text, x)) if x in wrong else good(text, owner, x)}" for x in arguments]
    # errors of the caller's own function are the caller's
    callables = {f"{x}={y}" for x in ("condition", "F", "y0") for y in ("int", "step", "J", "H", "L")}
    own = (TypeError,) if callables & set(parts) else ()
    return case(
        f"{text}({', '.join(parts)})", lambda error: _names(error, wrong | set(arguments)), (JacobianError, *own)
    )


def _zoo(text: str, argument: str) -> tuple[str, ...]:
    """The zoo without values that are valid but take long: a scene, a search over many thousand turns."""
    right = {("run", "scene"): "'chaplygin'", ("events", "end"): "'1e5'"}.get((text.split(".")[-1], argument))
    return tuple(x for x in ZOO if x != right)


def operator(rng: Random) -> Case:
    text = rng.choice(OPERATORS)
    text = text.format(*(f"({rng.choice(ZOO)})" for _ in range(text.count("{}"))))
    # between an array and a step numpy evaluates ``@`` and raises its own ValueError
    own = (ValueError,) if "@" in text else ()
    return case(text, lambda error: None, (JacobianError, TypeError, IndexError, *own))


def fixed_attribute(rng: Random) -> Case:
    """Values are immutable: setting an attribute of one is refused."""
    name = rng.choice(list(FIXED))
    text = f"setattr({name}, {rng.choice(FIXED[name])!r}, {rng.choice(ZOO)})"

    def judge(_: Any) -> Complaint:
        return Complaint("an attribute of a value was set", "an AttributeError", "False")

    return Case(lines_for(text) + HOSTILE, text, judge, (AttributeError, TypeError, JacobianError), memory=MEMORY)


def copied(rng: Random) -> Case:
    """Public values can be pickled and copied, and the copy is equal; a lambda of the fixtures cannot."""
    name = rng.choice([x for x in LINES if x not in ("T", "S", "Z", "multiplied", "added")])
    way = rng.choice(("pickle.loads(pickle.dumps({}))", "copy.copy({})", "copy.deepcopy({})"))
    text = f"same({way.format(name)}, {name})"
    setup = lines_for(text) + (
        "import copy, pickle\n"
        "def same(x, y):\n    equal = x == y\n    return bool(equal.all() if hasattr(equal, 'all') else equal)\n"
    )
    judge = lambda found: None if found["got"] else Complaint("the copy differs", "True", "got")  # noqa: E731
    return Case(setup, text, judge, (), limit=2)


def case(text: str, message: Callable[[Exception], str | None], refusals: Any = (JacobianError,)) -> Case:
    """A call on the existing objects; the program of the case makes those that the call needs."""
    hostile = HOSTILE if "No" in text else ""
    # enclosures take one or two seconds for each unit of time; invalid requests are refused at once
    limit = 20.0 if ".enclosure(" in text else 1.0
    imports = "".join(f"from {IMPORTED[name]} import {name}\n" for name in IMPORTED if name in text)
    setup = lines_for(text) + imports + hostile
    return Case(setup, text, lambda found: None, refusals, limit, names(), message, MEMORY, 1.0)


def _names(error: Exception, arguments: set[str]) -> str | None:
    """What is wrong with the message of an ArgumentError; None if nothing is."""
    said = str(error)
    if not isinstance(error, ArgumentError):
        return None if said else "no message"
    if "\n" in said.strip():
        return "a message of more than one line"
    # an argument, or a property of the object itself: "d = 0.7: …"
    named = re.search(r"\w( = |=|:)", said) or any(x in said for x in arguments)
    return None if named else f"the message names nothing: {said[:80]}"


KINDS = {"bad argument": bad_argument, "operator": operator, "fixed attribute": fixed_attribute, "copied": copied}
WARM = """
from tests.fuzz.calls import names, targets
targets()
made = names()
3 * made["A"] - made["A"], (-(10**30)) * made["A"], 3 * made["N"]
made["flow"].sensitivity(1.5), made["spin"].sensitivity(1.5)
"""
SUITE = Suite("calls", KINDS, {"bad argument": 16, "operator": 4}, {"": WARM})
