"""Compiled code for a kind of system, generated from its equations: stage slopes, Taylor expansions, a right-hand side.

The source is written to the folder of compiled code, where numba can cache it. The compiler then runs once per machine
and kind, for all bodies. Without such a folder every process compiles again.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from functools import cache
from hashlib import sha256
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType

from integrable.oracles.expressions import BINARY, Kind, Node, source
from jacobian.native.kept import place

__all__ = ["compiled", "expansion"]

# this line must be the same in gauss16.py and taylor_compiled.py; their text below it is copied
_MARK = "# --- copied into the module of each kind, with its slopes\n"
_HEAD = '''"""The equations of {name}, written by integrable.oracles.generated."""
import numpy as np
from numpy import exp, sqrt
from numba.extending import register_jitable
from integrable.oracles.gauss16 import (
    FAILED, MOST_ITERATIONS, STAGES, _add, _low_part, _predict, _sums, _tail, _weigh, _write,
)
from integrable.oracles.exact_floats import COMPILED, INLINED, two_sum, whole_steps
from integrable.oracles.taylor_compiled import _increment, _reach, convolved, exponential, quotient, root
from integrable.oracles.compiler import njit
'''
_SLOPES = """
@register_jitable(fastmath={{"contract"}}, **INLINED)
def slopes(c, y, out):
    for k in range(y.shape[1]):
{lines}
"""
_EXPAND = """
ROWS = {rows}
@register_jitable(fastmath={{"contract", "reassoc"}}, **INLINED)
def expand(c, order, s):
    for k in range(order):
{lines}
"""
_RATES = """
@njit(fastmath={{"contract"}}, **COMPILED)
def right_hand_side(t, y, c):
{lines}
    return np.array(({results},))
"""


@cache
def compiled(kind: Kind) -> ModuleType:
    """The module of a kind: ``fixed`` and ``adaptive`` (Gauss), ``taylor``, ``right_hand_side``, each compiled on its
    first call.
    """
    text = _text(kind)
    folder = place()
    if folder is None:
        module = ModuleType(f"equations_{kind.key}")
        exec(compile(text, f"<{module.__name__}>", "exec"), module.__dict__)
        return module
    # a change of these sources, which are compiled into every kind, must change the name of the file
    sources = "".join(map(_file, ("exact_floats", "gauss16", "taylor_compiled")))
    name = f"equations_{kind.key}_{sha256((text + sources).encode()).hexdigest()[:12]}"
    path = folder / f"{name}.source"  # not .py, so that nothing imports it as an ordinary module
    if not path.exists():
        beside = path.with_suffix(f".{os.getpid()}")
        beside.write_text(text, encoding="utf-8")
        os.replace(beside, path)
    loader = SourceFileLoader(name, str(path))
    spec = importlib.util.spec_from_loader(name, loader)
    assert spec is not None, "there is a file"
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module


def _text(kind: Kind) -> str:
    columns = source(kind.rates, "y[{}, k]", "c[{}]")
    columns += [f"out[{i}, k] = v{n}" for i, n in enumerate(kind.results)]
    flat = source(kind.rates, "y[{}]", "c[{}]")
    rows, recurrences = expansion(kind)
    return "\n".join([
        _HEAD.format(name=kind.name),
        _SLOPES.format(lines=_indented(columns, 8)),
        _file("gauss16").partition(_MARK)[2],
        _EXPAND.format(lines=_indented(recurrences, 8), rows=rows),
        _file("taylor_compiled").partition(_MARK)[2],
        _RATES.format(lines=_indented(flat, 4), results=", ".join(f"v{n}" for n in kind.results)),
    ])  # fmt: skip


def _file(name: str) -> str:
    return (Path(__file__).parent / f"{name}.py").read_text(encoding="utf-8")


def _indented(lines: list[str], by: int) -> str:
    return "\n".join(" " * by + line for line in lines)


def expansion(kind: Kind) -> tuple[int, list[str]]:
    """The number of rows of the table s of Taylor coefficients, and the lines of code that extend it by a column.

    The lines fill column k + 1 of the state, in the first rows, from the columns up to k. Every line of the equations
    that depends on the state has a row; every other line is a constant.
    """
    fixed: dict[int, str] = {}
    row: dict[int, int] = {}
    lines: list[str] = []
    rows = kind.size
    for k, node in enumerate(kind.rates):
        if node.op == "y":
            row[k] = node.args[0]
        elif node.op == "c":
            fixed[k] = f"c[{node.args[0]}]"
        elif node.op == "number":
            fixed[k] = repr(float(node.args[0]))
        else:
            row[k], rows = rows, rows + 1
            lines.append(f"s[{row[k]}, k] = {_recurrence(node, row[k], row, fixed)}")
    for i, n in enumerate(kind.results):
        lines.append(f"s[{i}, k + 1] = {_coefficient(n, row, fixed)} / (k + 1)")
    return rows, lines


def _recurrence(node: Node, own: int, row: dict[int, int], fixed: dict[int, str]) -> str:
    """The code that computes Taylor coefficient k of one line of the equations."""
    op, args = node
    terms = [_coefficient(n, row, fixed) for n in args]
    if op in ("exp", "sqrt"):
        return f"{'exponential' if op == 'exp' else 'root'}(s, {row[args[0]]}, {own}, k)"
    if op == "neg":
        return f"-{terms[0]}"
    if op == "div" and args[1] in row:
        return f"quotient(s, {terms[0]}, {row[args[1]]}, {own}, k)"
    if op == "mul" and all(n in row for n in args):
        return f"convolved(s, {row[args[0]]}, {row[args[1]]}, k)"
    if op in ("mul", "div"):  # by a constant
        terms = [fixed.get(n, term) for n, term in zip(args, terms, strict=True)]
    return f"{terms[0]} {BINARY[op]} {terms[1]}"


def _coefficient(n: int, row: dict[int, int], fixed: dict[int, str]) -> str:
    """The code for Taylor coefficient k of line n, which is 0 for a constant and k > 0."""
    return f"s[{row[n]}, k]" if n in row else f"({fixed[n]} if k == 0 else 0.0)"
