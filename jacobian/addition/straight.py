"""Straight-line code from explicit formulas: a formula is written once, with + − · and 1/x, and traced.

A formula (:mod:`jacobian.addition.genus2`, :mod:`jacobian.addition.genus3`) is a Python function of numbers. Called
with :class:`Term` objects it records its operations on a :class:`Tape`, each once; unused results are dropped later. A
coefficient of the curve that is 0 or 1 is passed as that int, so products by it are never written; in characteristic 2
signs and doubles vanish. :mod:`jacobian.addition.emit` and :mod:`jacobian.addition.emit_words` write code from a tape.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from functools import cache
from inspect import signature
from types import SimpleNamespace
from typing import Any, NamedTuple

from jacobian.errors import ArgumentError, written

COMMUTE = ("add", "mul")


class Tape:
    """The recorded operations of a formula, in order. ``binary`` means characteristic 2; with ``karatsuba``, products
    are saved at the cost of more sums.
    """

    def __init__(self, binary: bool = False, karatsuba: bool = False) -> None:
        self.binary, self.karatsuba = binary, karatsuba
        self.operations: list[tuple[Any, ...]] = []
        """(name, operands), the operands as indices; an input is ("input", its name), and 1 is ("one",)."""
        self._places: dict[tuple[Any, ...], int] = {}

    def inputs(self, *names: str) -> tuple[Term, ...]:
        """Records one input for each name; returns their terms."""
        return tuple(self.term("input", name) for name in names)

    def term(self, operation: str, *operands: Any) -> Term:
        """The term of an operation, recorded if it is new."""
        key = (operation, *(sorted(operands) if operation in COMMUTE else operands))
        if key not in self._places:
            self._places[key] = len(self.operations)
            self.operations.append((operation, *operands))
        return Term(self, self._places[key])

    def operands(self, index: int) -> tuple[int, ...]:
        operation = self.operations[index]
        return () if operation[0] in ("input", "one") else operation[1:]

    def live(self, outputs: Iterable[int]) -> list[int]:
        """The operations that the outputs need, in order."""
        found, waiting = set(), list(outputs)
        while waiting:
            index = waiting.pop()
            if index not in found:
                found.add(index)
                waiting += self.operands(index)
        return sorted(found)

    def uses(self, live: Iterable[int], outputs: Iterable[int]) -> Counter[int]:
        """How often each operation is an operand or an output."""
        found = Counter(list(outputs))
        for index in live:
            found.update(self.operands(index))
        return found


class Term:
    """A number on a tape."""

    __slots__ = ("index", "tape")

    def __init__(self, tape: Tape, index: int) -> None:
        self.tape, self.index = tape, index

    def __add__(self, other: Any) -> Any:
        if isinstance(other, int):
            if self._known(other) == 0:
                return self
            one = self.tape.term("one")
            return self + one if other == 1 else self - one
        if other._negated() is not None:
            return self - other._negated()
        if self._negated() is not None:
            return other - self._negated()
        if self.tape.binary:
            for x, y in ((self, other), (other, self)):
                if x.index == y.index:
                    return 0
                name, *operands = self.tape.operations[x.index]
                if name == "add" and y.index in operands:
                    return Term(self.tape, sum(operands) - y.index)
        return self.tape.term("add", self.index, other.index)

    def __sub__(self, other: Any) -> Any:
        if self.tape.binary:
            return self + other
        if isinstance(other, int):
            return self + -other
        if other._negated() is not None:
            return self + other._negated()
        if self._negated() is not None:
            return -(self._negated() + other)
        return 0 if other.index == self.index else self.tape.term("sub", self.index, other.index)

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, int):
            return 0 if self._known(other) == 0 else self if other == 1 else -self
        for x, y in ((self, other), (other, self)):
            if x._negated() is not None:
                return -(x._negated() * y)
        return self.tape.term("mul", self.index, other.index)

    def __neg__(self) -> Any:
        if self.tape.binary:
            return self
        operation = self.tape.operations[self.index]
        if operation[0] == "neg":
            return self._negated()
        if operation[0] == "sub":
            return self.tape.term("sub", *operation[:0:-1])
        return self.tape.term("neg", self.index)

    def __rsub__(self, other: int) -> Any:
        return -self + other

    def __rtruediv__(self, other: int) -> Any:
        return self.tape.term("inv", self.index)

    __radd__, __rmul__ = __add__, __mul__

    def _known(self, number: int) -> int:
        if number not in (-1, 0, 1):
            raise ArgumentError(f"number = {written(number)}: formulas have 0, 1 and -1 as known numbers")
        return number

    def _negated(self) -> Any:
        """The term x if this term is −x, else None."""
        operation = self.tape.operations[self.index]
        return Term(self.tape, operation[1]) if operation[0] == "neg" else None


def cross(x1: Any, x0: Any, y1: Any, y0: Any) -> Any:
    """x₁y₀ + x₀y₁ beside x₁y₁ and x₀y₀; a :class:`Tape` with ``karatsuba`` saves a product (Karatsuba, Ofman 1962)."""
    if _saves_products(x1, x0, y1, y0):
        return (x1 + x0) * (y1 + y0) - x1 * y1 - x0 * y0
    return x1 * y0 + x0 * y1


def square_of_twice(x: Any) -> Any:
    """(2x)², where the caller also needs x². On a tape with ``karatsuba`` it is four times x², without a product."""
    if not _saves_products(x):
        return (x + x) * (x + x)
    twice = x * x + x * x
    return twice + twice


def _saves_products(*numbers: Any) -> bool:
    """Whether one of the numbers is a term on a tape with ``karatsuba``."""
    return any(isinstance(x, Term) and x.tape.karatsuba for x in numbers)


class Formulas(NamedTuple):
    """The explicit formulas of one model: the genus, the coefficients of the curve that they use, and their steps.

    ``chord`` returns a quotient for the coefficients C and two classes, ``tangent`` for C and one class. A quotient is
    the resultant r and the coefficients of r·s, where y = V + U·s is the curve through both classes (for ``tangent``,
    the curve tangent at the class). ``opposite`` maps C and a class to the negative of the class.

    ``steps`` are pairs: the name of a result, and its function of C, ``first``, ``second``, ``quotient``, ``inverse``
    (of the result "product"), or results of earlier steps. The results "u" and "v" make up the sum (*u, *v).
    """

    genus: int
    coefficients: tuple[str, ...]
    chord: Callable[..., Any]
    tangent: Callable[..., Any]
    opposite: Callable[..., Any]
    steps: tuple[tuple[str, Callable[..., Any]], ...]

    def equation(self, known: dict[str, int], tape: Tape, prefix: str = "") -> Any:
        """The coefficients of the curve: an int where ``known`` has one, else an input of the tape."""
        names = self.coefficients
        return SimpleNamespace(**{x: known[x] if x in known else tape.inputs(f"{prefix}{x}")[0] for x in names})

    def total(self, C: Any, first: Any, second: Any) -> tuple[Any, ...]:
        """The sum of two classes, or the double if both are the same object."""
        quotient = self.tangent(C, first) if first is second else self.chord(C, first, second)
        return self.closed(C, quotient, None, first, second)

    def closed(self, C: Any, quotient: Any, inverse: Any, first: Any, second: Any) -> tuple[Any, ...]:
        """The sum of two classes from their ``quotient``; ``inverse`` is 1/x for the result x of "product", or None."""
        found = {"C": C, "quotient": quotient, "inverse": inverse, "first": first, "second": second}
        for name, step in self.steps:
            if name != "product" or inverse is None:
                found[name] = step(*(found[each] for each in parameters(step)))
            if name == "product" and inverse is None:
                found["inverse"] = 1 / found[name]
        return (*found["u"], *found["v"])


@cache
def parameters(step: Callable[..., Any]) -> tuple[str, ...]:
    return tuple(name for name in signature(step).parameters if name != "self")
