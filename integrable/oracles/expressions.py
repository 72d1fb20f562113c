"""Equations of motion as expressions, from which every integrator generates its own code.

A system's formulas are run once on :class:`Symbol`s, which record the operations. Its constants are symbols too, so all
bodies share one :class:`Kind`, and code compiled for a kind serves every body and every start. Expressions of
constants alone, such as 1/(I + d), are coefficients; they are computed once per system.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from hashlib import sha256
from typing import Any, NamedTuple

__all__ = ["Kind", "Node", "Numbers", "Symbol", "recorded", "source"]

BINARY = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
FUNCTIONS = ("exp", "sqrt")


class Node(NamedTuple):
    """One line of a straight-line program.

    ``op`` is "y" for a component of the state or "c" for a constant, each with its index, or "number" with a
    Fraction. "add", "sub", "mul" and "div" act on two earlier lines; "neg", "exp" and "sqrt" act on one.
    """

    op: str
    args: tuple[Any, ...]

    @property
    def lines(self) -> tuple[int, ...]:
        """The numbers of the lines on which the operation acts; () for an input or a number."""
        return () if self.op in ("y", "c", "number") else self.args


@dataclass(frozen=True)
class Kind:
    """Equations of motion with symbols for all constants. Equal kinds have the same equations."""

    name: str
    """The kind of the systems: "ball", "top", or the name of their class."""
    size: int
    """The number of components of the state."""
    coefficients: tuple[Node, ...]
    """The program that computes the coefficients; its inputs "c" are the constants."""
    used: tuple[int, ...]
    """The lines of ``coefficients`` whose values the equations use."""
    rates: tuple[Node, ...]
    """The program for the equations; its inputs are the state, "y", and the coefficients used, "c"."""
    results: tuple[int, ...]
    """The lines of ``rates`` that are ẏ."""

    @cached_property
    def key(self) -> str:
        """A short hash of the equations."""
        return sha256(repr((self.size, self.rates, self.results)).encode()).hexdigest()[:12]

    def coefficients_of(
        self, constants: Sequence[Any], number: Callable[[Any], Any] = float, context: Any = None
    ) -> list[Any]:
        """The coefficients of the equations for a system's ``constants``, converted by ``number``; ``context`` is that
        of :meth:`right_hand_side`.
        """
        values: list[Any] = []
        for op, args in self.coefficients:
            if op == "c":
                values.append(number(constants[args[0]]))
            elif op == "number":
                whole = number(args[0].numerator)
                values.append(whole if args[0].denominator == 1 else whole / number(args[0].denominator))
            elif op == "neg":
                values.append(-values[args[0]])
            elif op in FUNCTIONS:
                values.append(getattr(context or math, op)(values[args[0]]))
            else:
                values.append(_DO[op](*(values[i] for i in args)))
        return [values[i] for i in self.used]

    def right_hand_side(self, coefficients: Sequence[Any], context: Any = None) -> Callable[[Sequence[Any]], list[Any]]:
        """The function y ↦ ẏ in the numbers of the coefficients, arrays of floats or symbols: plain Python without
        loops.

        ``context`` provides ``exp`` and ``sqrt`` for these numbers: an mpmath context, or None for floats.
        """
        scope: dict[str, Any] = {name: getattr(context or math, name) for name in FUNCTIONS}
        exec(self._python, scope)
        return scope["make"](*coefficients)

    @cached_property
    def _python(self) -> Any:
        lines = [f"    {line}" for line in source(self.rates, "y{}", "c{}")]
        names = [f"c{i}" for i in range(len(self.used))]
        state = ", ".join(f"y{i}" for i in range(self.size))
        text = [
            f"def make({', '.join(names)}):",
            "  def rates(y):",
            f"    {state} = y",
            *lines,
            f"    return [{', '.join(f'v{i}' for i in self.results)}]",
            "  return rates",
        ]
        return compile("\n".join(text), f"<equations of {self.name}>", "exec")


def source(nodes: Sequence[Node], y: str, c: str) -> list[str]:
    """A program as lines of Python that assign variables v0, v1, …; ``y`` and ``c`` are formats of its inputs."""
    lines = []
    for k, (op, args) in enumerate(nodes):
        if op in BINARY:
            right = f"v{args[0]} {BINARY[op]} v{args[1]}"
        elif op in FUNCTIONS:
            right = f"{op}(v{args[0]})"
        elif op == "neg":
            right = f"-v{args[0]}"
        elif op == "number":
            right = str(args[0]) if args[0].denominator == 1 else repr(float(args[0]))
        else:
            right = (y if op == "y" else c).format(args[0])
        lines.append(f"v{k} = {right}")
    return lines


_DO: dict[str, Callable[[Any, Any], Any]] = {
    "add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": operator.truediv
}  # fmt: skip


class _Book:
    """The lines of a recorded formula, each once, and their values at one state, which its comparisons use."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.values: list[Any] = []
        self._known: dict[Node, int] = {}

    def line(self, op: str, *args: Any, value: Any) -> Symbol:
        node = Node(op, args)
        if node not in self._known:
            self._known[node] = len(self.nodes)
            self.nodes.append(node)
            self.values.append(value)
        return Symbol(self, self._known[node])


def _operators(op: str) -> tuple[Callable[[Symbol, Any], Symbol], Callable[[Symbol, Any], Symbol]]:
    """The methods x, y ↦ x op y and x, y ↦ y op x of :class:`Symbol`."""
    return lambda x, y: x._done(op, x, y), lambda x, y: x._done(op, y, x)


def _comparison(holds: Callable[[Any, Any], Any]) -> Callable[[Symbol, Any], bool]:
    """A comparison of :class:`Symbol`, by the values of both."""
    return lambda x, y: bool(holds(x.value, y.value if isinstance(y, Symbol) else y))


class Symbol:
    """A number in a recorded formula. Its operators record themselves; comparisons use its value."""

    __slots__ = ("book", "index")

    def __init__(self, book: _Book, index: int) -> None:
        self.book, self.index = book, index

    @property
    def value(self) -> Any:
        """The value of the symbol at the state of the recording."""
        return self.book.values[self.index]

    def _number(self) -> Fraction | None:
        node = self.book.nodes[self.index]
        return node.args[0] if node.op == "number" else None

    def _other(self, other: Any) -> Symbol:
        if isinstance(other, Symbol):
            return other
        exact = Fraction(other)
        return self.book.line("number", exact, value=exact)

    def _done(self, op: str, left: Any, right: Any) -> Symbol:
        left, right = self._other(left), self._other(right)
        a, b = left._number(), right._number()
        if a is not None and b is not None:
            return self._other(_DO[op](a, b))
        if b == 0 and op in ("add", "sub"):
            return left
        if a == 0 and op in ("add", "sub"):
            return right if op == "add" else -right
        if op in ("mul", "div") and (a == 0 or (b == 1)):
            return left
        if op == "mul" and (b == 0 or a == 1):
            return right
        if op == "mul" and -1 in (a, b):
            return -(left if b == -1 else right)
        if op in ("add", "mul") and left.index > right.index:
            left, right = right, left
        x, y = (float(v) if isinstance(v, Fraction) else v for v in (left.value, right.value))
        try:
            value = _DO[op](x, y)
        except ZeroDivisionError:
            value = float("nan")  # undefined at this state, but perhaps not at others
        return self.book.line(op, left.index, right.index, value=value)

    __add__, __radd__ = _operators("add")
    __sub__, __rsub__ = _operators("sub")
    __mul__, __rmul__ = _operators("mul")
    __truediv__, __rtruediv__ = _operators("div")

    def __neg__(self) -> Symbol:
        exact = self._number()
        if exact is not None:
            return self._other(-exact)
        node = self.book.nodes[self.index]
        if node.op == "neg":
            return Symbol(self.book, node.args[0])
        return self.book.line("neg", self.index, value=-self.value)

    def __pow__(self, power: Any) -> Symbol:
        exponent = Fraction(power.value if isinstance(power, Symbol) else power)
        if exponent == Fraction(1, 2):
            return self.book.line("sqrt", self.index, value=self.value**0.5)
        if exponent.denominator != 1 or exponent < 1:
            raise TypeError(f"power {power}: only square roots and positive whole powers are recorded")
        if exponent == 1:
            return self
        half = self ** (exponent // 2)
        return half * half if exponent % 2 == 0 else half * half * self

    __eq__ = _comparison(operator.eq)
    __lt__ = _comparison(operator.lt)
    __gt__ = _comparison(operator.gt)

    def __hash__(self) -> int:
        return hash((id(self.book), self.index))


class Numbers:
    """The field in which a formula is recorded. Constants become inputs "c" of the program, except ints and zeros."""

    name, exact, characteristic, order, eps = "symbols", False, 0, None, 2.0**-52
    add, sub, mul, div = map(staticmethod, _DO.values())
    neg = staticmethod(operator.neg)

    def __init__(self) -> None:
        self.book = _Book()
        self.constants: list[Any] = []
        self.context = self
        self.zero, self.one = (self.book.line("number", Fraction(x), value=Fraction(x)) for x in (0, 1))

    def coerce(self, x: Any, _argument: str = "") -> Any:
        """The symbol of a constant: the same object always has the same symbol. A symbol is returned unchanged."""
        if isinstance(x, Symbol):
            return x
        if isinstance(x, int) or x == 0:
            return self.zero + x if isinstance(x, int) else self.zero
        # constants are compared by identity: equal constants of one system may differ in another of the same kind
        found = next((i for i, known in enumerate(self.constants) if known is x), None)
        return self.constant(x) if found is None else self.book.line("c", found, value=x)

    def constant(self, x: Any) -> Symbol:
        """The symbol of a new constant."""
        self.constants.append(x)
        return self.book.line("c", len(self.constants) - 1, value=x)

    def state(self, values: Sequence[Any]) -> list[Symbol]:
        """The symbols of a state's components."""
        return [self.book.line("y", i, value=value) for i, value in enumerate(values)]

    def inv(self, x: Any) -> Any:
        """1/x."""
        return self.one / x

    def is_zero(self, x: Any, scale: Any = None) -> bool:
        """Whether the value is 0."""
        return bool(x == 0)

    def dot(self, xs: Iterable[Any], ys: Iterable[Any]) -> Any:
        """Σ x_i y_i."""
        return sum((x * y for x, y in zip(xs, ys, strict=True)), self.zero)

    def exp(self, x: Symbol) -> Symbol:
        """e^x."""
        return x.book.line("exp", x.index, value=math.exp(x.value))

    def sqrt(self, x: Symbol) -> Symbol:
        """√x."""
        return x**0.5


def recorded(
    name: str, formula: Callable[[Numbers, list[Symbol]], Iterable[Any]], start: Sequence[Any]
) -> tuple[Kind, tuple[Any, ...]]:
    """The kind of the equations ẏ = ``formula``(numbers, y), and the constants that the formula used."""
    numbers = Numbers()
    results = [numbers.coerce(x).index for x in formula(numbers, numbers.state(start))]
    nodes = numbers.book.nodes
    needed = set(results)
    for k in reversed(range(len(nodes))):
        if k in needed:
            needed.update(nodes[k].lines)
    moving: set[int] = set()  # the lines that depend on the state
    for k, node in enumerate(nodes):
        if node.op == "y" or not moving.isdisjoint(node.lines):
            moving.add(k)
    # a coefficient is a line that does not depend on the state, and is a result or an argument of a line that does;
    # numbers that are exact in every floating-point format are written into the code instead
    outer = set(results).union(*(nodes[k].lines for k in needed & moving))
    used = sorted(k for k in outer - moving if not (nodes[k].op == "number" and _short(nodes[k].args[0])))
    first = sorted(needed - moving)
    place = {k: i for i, k in enumerate(first)}
    coefficients = tuple(_moved(nodes[k], place) for k in first)
    rates: list[Node] = []
    there: dict[int, int] = {}
    for k in sorted(needed & moving | outer):
        there[k] = len(rates)
        rates.append(Node("c", (used.index(k),)) if k in used else _moved(nodes[k], there))
    uses, found = tuple(place[k] for k in used), tuple(there[k] for k in results)
    kind = Kind(name, len(start), coefficients, uses, tuple(rates), found)
    return kind, tuple(numbers.constants)


def _short(number: Fraction) -> bool:
    """Whether a number is exact in every floating-point format."""
    return number.denominator & (number.denominator - 1) == 0 and max(abs(number.numerator), number.denominator) < 2**20


def _moved(node: Node, place: dict[int, int]) -> Node:
    return Node(node.op, tuple(place[i] for i in node.lines)) if node.lines else node
