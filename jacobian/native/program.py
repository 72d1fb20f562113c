"""Functions compiled together: one LLVM module, and the argument and result kinds of each entry."""

from __future__ import annotations

import ast
import builtins
import inspect
import sys
from collections.abc import Callable, Iterable
from functools import cache
from itertools import accumulate
from pathlib import Path
from typing import Any, NamedTuple

from jacobian.native import direct
from jacobian.native.code import wide_functions
from jacobian.native.kinds import NONE, WIDE, ArrayKind, CompileError, TupleKind, Value, single
from jacobian.native.operators import DECLARED
from jacobian.native.statements import Statements


class Instance(NamedTuple):
    """A function compiled for one choice of argument kinds."""

    name: str
    result: Any


class Program:
    """An LLVM module. ``special`` maps functions to writers of the instructions that replace them; if a writer returns
    None, the function is compiled as it stands. Sums in ``fast`` functions may be reordered. Functions whose loops are
    all unrolled are inlined, except ``inlined_but``; if that is None, LLVM decides.

    Float operations may be contracted, but not in functions that take double-doubles.
    """

    def __init__(
        self,
        special: dict[Any, Callable[..., Value | None]],
        fast: tuple[Any, ...] = (),
        inlined_but: tuple[Any, ...] | None = None,
    ) -> None:
        self.special, self._fast, self._inlined_but = special, fast, inlined_but
        self._instances: dict[Any, Instance | None] = {}
        self._texts: list[str] = []
        self._declared = ""
        self.modules: set[str] = set()
        """The names of the modules that have been read."""
        self.numbers: dict[str, str] = {}
        """The module constants that were compiled in: the ``repr`` of each by its full name."""

    def instance(self, function: Any, kinds: tuple[Any, ...]) -> Instance:
        """The function compiled for these argument kinds; the first request compiles it."""
        key = function, kinds
        if key not in self._instances:
            self._instances[key] = None
            name = f"{function.__name__}.{len(self._instances)}"
            flag = "" if any(map(_has_wide, kinds)) else "contract"
            body = Statements(self, function, "fast" if function in self._fast else flag)
            self._texts.append(body.compiled(name, self.tree(function), kinds, self._attributes(function)))
            self._instances[key] = Instance(name, body.result)
        found = self._instances[key]
        if found is None:
            raise CompileError(f"{function.__name__} calls itself")
        return found

    def inlines(self, function: Any) -> bool:
        """Whether all loops of a function are unrolled; it is then inlined unless it is in ``inlined_but``."""
        return self._inlined_but is not None and not _has_loop(self.tree(function))

    def _attributes(self, function: Any) -> str:
        """LLVM's attribute that says whether to inline a function; empty if LLVM decides."""
        if not self.inlines(function):
            return ""
        return "noinline " if function in (self._inlined_but or ()) else "alwaysinline "

    def entry(self, name: str, function: Any, kinds: tuple[Any, ...]) -> Any:
        """Adds an entry that C can call and returns the kind of its result.

        The entry's only argument is an array of 64-bit words: the words of all arguments, then space for the result.
        A long takes two words.
        """
        if kinds and isinstance(kinds[-1], direct.Objects):
            return self._of_objects(name, function, kinds[:-1], kinds[-1])
        instance = self.instance(function, kinds)
        body, result = Statements(self, function, ""), instance.result
        values, begin = _arguments(body, kinds)
        parts = body.result_of(instance, values)
        for place, leaf, part in zip(_places(result.leaves, begin), result.leaves, parts, strict=False):
            if leaf == "i1":
                leaf, part = "i64", body.write(f"zext i1 {part} to i64")
            there = body.write(f"getelementptr i64, ptr %words, i64 {place}")
            body.lines.append(f"  store {leaf} {part}, ptr {there}, align 8")
        lines = [f"define void @{name}(ptr %words) nounwind {{", *body.lines, "  ret void", "}"]
        self._texts.append("\n".join(lines))
        return result

    def _of_objects(self, name: str, function: Any, kinds: tuple[Any, ...], objects: direct.Objects) -> Any:
        """Adds an entry that Python calls with the last arguments, ``objects``, as they are.

        The first arguments, of the given ``kinds``, are packed into the bytes object ``self`` of the call.
        """
        instance, body = self.instance(function, (*kinds, *objects.inside)), Statements(self, function, "")
        body.lines.append("  %words = call ptr @PyBytes_AsString(ptr %self)")
        self._texts.append(direct.method(body, name, instance, _arguments(body, kinds)[0], objects))
        self._declared = direct.DECLARED
        return NONE

    def text(self) -> str:
        return "\n".join([DECLARED, self._declared, wide_functions(), *self._texts])

    def looked_up(self, module: Any, name: str) -> Any:
        """The object that a name in a module, or a builtin name, refers to."""
        found = getattr(module, name, getattr(builtins, name, self))
        if found is self:
            raise CompileError(f"{name} is not known, or not on every way")
        if isinstance(found, int | float):
            # the number becomes part of the compiled code, so its value is recorded, under the module that uses it
            self.numbers[f"{module.__name__}.{name}"] = repr(found)
        elif hasattr(found, "_fields"):
            self.modules.add(found.__module__)
        return found

    def of_class(self, named: type, name: str) -> Any:
        """A method or a constant of a class."""
        if not hasattr(named, name):
            raise CompileError(f"{named.__name__} has no {name}")
        self.modules.add(named.__module__)
        return getattr(named, name)

    def tree(self, function: Any) -> ast.FunctionDef:
        """The parsed source of a function."""
        if not inspect.isfunction(function):
            raise CompileError(f"{function!r} is not compiled")
        self.modules |= {function.__module__, *getattr(function, "sources", ())}
        if hasattr(function, "text"):
            # the text of this function was generated from the sources recorded above
            return _written(function.text)
        return _functions(function.__module__)[function.__qualname__]


def _places(leaves: Iterable[str], begin: int) -> list[int]:
    """The index of each scalar in an array of words, then the index after the last; a long takes two words."""
    return list(accumulate((2 if leaf == "i128" else 1 for leaf in leaves), initial=begin))


def _arguments(body: Statements, kinds: tuple[Any, ...]) -> tuple[list[str], int]:
    """The scalars of arguments in the array of words, as LLVM operands with their types, and the index after them."""
    leaves, values = [leaf for kind in kinds for leaf in kind.leaves], []
    *places, end = _places(leaves, 0)
    for k, leaf in zip(places, leaves, strict=True):
        there = body.write(f"getelementptr i64, ptr %words, i64 {k}")
        word = body.write(f"load {'i64' if leaf == 'i1' else leaf}, ptr {there}, align 8")
        values.append(f"{leaf} {body.write(f'icmp ne i64 {word}, 0') if leaf == 'i1' else word}")
    return values, end


@cache
def _written(text: str) -> ast.FunctionDef:
    (function,) = ast.parse(text).body
    assert isinstance(function, ast.FunctionDef)
    return function


@cache
def _functions(module: str) -> dict[str, ast.FunctionDef]:
    """The functions of a module and the methods of its classes, by qualified name."""
    body = ast.parse(Path(str(sys.modules[module].__file__)).read_text(encoding="utf-8")).body
    parts = [("", body), *((f"{node.name}.", node.body) for node in body if isinstance(node, ast.ClassDef))]
    return {f"{of}{node.name}": node for of, nodes in parts for node in nodes if isinstance(node, ast.FunctionDef)}


def _has_loop(tree: ast.FunctionDef) -> bool:
    """Whether a function has a loop that is not unrolled. Loops over a tuple, or with a number of rounds that is a
    literal in the source, are unrolled.
    """
    return any(
        isinstance(node, ast.While)
        or (
            isinstance(node, ast.For)
            and isinstance(node.iter, ast.Call)
            and not all(isinstance(x, ast.Constant) for x in node.iter.args)
        )
        for node in ast.walk(tree)
    )


def _has_wide(kind: Any) -> bool:
    if isinstance(kind, TupleKind):
        return any(map(_has_wide, kind.items))
    return single(kind) is WIDE or (isinstance(kind, ArrayKind) and single(kind.item) is WIDE)
