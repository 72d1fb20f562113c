"""Writes Python code from formulas: addition and doubling of triples, on ints modulo p or in any field.

:func:`text_of` returns the code as text, and :func:`maker` the function that it defines. On ints a sum of products is
reduced once, where it becomes a factor or a result. In CPython an addition costs as much as a product of machine words,
so saving products by more sums gains nothing there. In other fields the code has exactly the operations of the
formulas.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from jacobian.addition import cantor
from jacobian.addition.straight import Formulas, Tape

NAME, PRODUCT, SUM = 2, 1, 0
"""The precedence of the operation in a piece of text."""
SIGNS = {"add": "+", "sub": "-"}

Written = tuple[str, int]


class OnInts:
    """How generated code computes with ints modulo p."""

    needs = ("p",)
    zero, one = "0", "1"
    karatsuba = False

    def __init__(self) -> None:
        self.degrees: dict[int, int] = {}
        """The degree of each result in the inputs; a result of degree 1 is about as long as p."""

    def operation(self, index: int, name: str, operands: tuple[int, ...], text: Callable[[int, int], str]) -> Written:
        """The text of an operation, from the texts of its operands."""
        x, y = operands[0], operands[-1]
        degrees = [self.degrees.get(each, 1) for each in (x, y)]
        self.degrees[index] = sum(degrees) if name == "mul" else max(degrees)
        if name == "neg":
            return f"-{text(x, PRODUCT)}", SUM
        if name == "mul":
            return f"{text(x, PRODUCT)} * {text(y, NAME)}", PRODUCT
        return f"{text(x, SUM)} {SIGNS[name]} {text(y, SUM if name == 'add' else PRODUCT)}", SUM

    def factor(self, index: int, found: Written, result: bool) -> Written:
        """The text ``found`` for use as a factor, or as a result if ``result``. "% p" is appended to all texts but
        those of factors of degree 1, which contain no unreduced product.
        """
        if self.degrees.get(index, 1) == 1 and not result:
            return found
        self.degrees[index] = 1
        text, binds = found
        return f"{text if binds else f'({text})'} % p", PRODUCT

    def inverse(self, x: str) -> str:
        return f"pow({x}, -1, p)"

    def reading(self, g: int, x: str, names: tuple[str, str], otherwise: str) -> list[str]:
        """The lines that read a class, and run ``otherwise`` unless v has g coefficients, which implies deg u = g."""
        a, b = (_listed(name, g) for name in names)
        return [f"if len(v{x}) != {g}:", f"    {otherwise}", f"({a}, _), ({b}) = u{x}, v{x}"]


class OnElements:
    """How generated code computes with elements of a field."""

    needs = ("add", "sub", "mul", "neg", "inv", "zero", "one")
    zero, one = "zero", "one"
    karatsuba = True

    def operation(self, index: int, name: str, operands: tuple[int, ...], text: Callable[[int, int], str]) -> Written:
        """The text of an operation, from the texts of its operands."""
        return f"{name}({', '.join(text(x, SUM) for x in operands)})", NAME

    def factor(self, index: int, found: Written, result: bool) -> Written:
        """``found``, since elements of a field need no reduction."""
        return found

    def inverse(self, x: str) -> str:
        return f"inv({x})"

    def reading(self, g: int, x: str, names: tuple[str, str], otherwise: str) -> list[str]:
        """The lines of code that read a class, and run ``otherwise`` unless u has degree g."""
        a, b = (_listed(name, g) for name in names)
        full = f"v{x} if len(v{x}) == {g} else (*v{x}, {', '.join(['zero'] * g)})[:{g}]"
        return [f"if len(u{x}) != {g + 1}:", f"    {otherwise}", f"({a}, _), ({b}) = u{x}, {full}"]


def _listed(letter: str, count: int) -> str:
    return ", ".join(f"{letter}{k}" for k in range(count))


def lines_of(tape: Tape, results: dict[int, str], style: OnInts | OnElements, otherwise: str) -> list[str]:
    """The lines that compute ``results``, {operation: name}, and run ``otherwise`` where an inverse does not exist."""
    live = tape.live(results)
    uses, inverted = tape.uses(live, results), {tape.operands(i)[0] for i in live if tape.operations[i][0] == "inv"}
    factors = inverted.union(*(tape.operands(i) for i in live if tape.operations[i][0] == "mul"))
    written: dict[int, Written] = {}
    lines = []

    def text(i: int, least: int) -> str:
        found, binds = written[i]
        return found if binds >= least else f"({found})"

    for i in live:
        name, *operands = tape.operations[i]
        if name in ("input", "one"):
            written[i] = operands[0] if operands else style.one, NAME
            continue
        if name == "inv":
            x = text(operands[0], NAME)
            lines += [f"if {x} == {style.zero}:", f"    {otherwise}"]
            found: Written = style.inverse(x), NAME
        else:
            found = style.operation(i, name, tuple(operands), text)
        if i in factors or i in results:
            found = style.factor(i, found, i in results or i in inverted)
        if uses[i] > 1 or i in results or i in inverted or name == "inv":
            target = results.get(i, f"t{i}")
            lines.append(f"{target} = {found[0]}")
            found = target, NAME
        written[i] = found
    return lines


def _function(
    formulas: Formulas, known: dict[str, int], style: OnInts | OnElements, name: str, given: str
) -> list[str]:
    """The lines of code that add two triples if ``given`` is "ab", or double one if it is "a"."""
    g, names = formulas.genus, (("a", "b"), ("c", "d"))[: len(given)]
    tape = Tape(known["characteristic"] == 2, style.karatsuba)
    C = formulas.equation(known, tape)
    classes = [tape.inputs(*(f"{x}{k}" for x in pair for k in reversed(range(g)))) for pair in names]
    results = [f"{x}{k}" for x in "uv" for k in reversed(range(g))]
    found = dict(zip((x.index for x in formulas.total(C, classes[0], classes[-1])), results, strict=True))
    otherwise = f"return cantor.{name}(curve, {', '.join(given)})"
    lines = []
    for x, pair in zip(given, names, strict=True):
        lines += [f"u{x}, v{x}, _ = {x}", *style.reading(g, x, pair, otherwise)]
    short = f"trimmed(({_listed('v', g - 1)},), {style.zero})"
    lines += lines_of(tape, found, style, otherwise)
    lines.append(
        f"return ({_listed('u', g)}, {style.one}), ({_listed('v', g)}) if v{g - 1} != {style.zero} else {short}, weight"
    )
    return [f"def {name}(self, {', '.join(given)}):", *(f"    {line}" for line in lines)]


@cache
def text_of(formulas: Formulas, known: tuple[tuple[str, int], ...], style: Any) -> str:
    """The text of a function ``made``, which returns two functions (sum_of, double) of one curve. Both are methods:
    their first parameter is ``self``.

    ``known`` has the coefficients that are 0 or 1, and the characteristic if it is 2. The parameters of ``made`` are
    the curve, the weight of the results, those in ``style.needs``, and the other coefficients.
    """
    table = {"characteristic": 0, **dict(known)}
    unknown = [name for name in formulas.coefficients if name not in table]
    both = [
        line
        for name, given in (("sum_of", "ab"), ("double", "a"))
        for line in _function(formulas, table, style(), name, given)
    ]
    head = f"def made(curve, weight, {', '.join((*style.needs, *unknown))}):"
    return "\n".join([head, *(f"    {line}" for line in both), "    return sum_of, double", ""])


@cache
def maker(formulas: Formulas, known: tuple[tuple[str, int], ...], style: Any) -> Callable[..., Any]:
    """The function ``made`` that the text of :func:`text_of` defines."""
    defined: dict[str, Any] = {"cantor": cantor, "trimmed": trimmed}
    exec(compile(text_of(formulas, known, style), "<explicit formulas>", "exec"), defined)
    return defined["made"]


def trimmed(v: tuple[Any, ...], zero: Any) -> tuple[Any, ...]:
    """v, ascending, without its highest coefficients that are zero."""
    while v and v[-1] == zero:
        v = v[:-1]
    return v
