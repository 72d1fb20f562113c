"""A vector field as a list of the operations that its formula performs on the variables, recorded once.

A formula written with operators is called on :class:`Recorded` numbers. Its sums, products, quotients and square roots
become a :class:`Tape`, from which Taylor series are computed (:mod:`integrable.series.recurrences`). Equal operations
are recorded once, and operations on constants are evaluated while recording. (Griewank & Walther 2008, *Evaluating
Derivatives*, chapters 2 and 13.)
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from operator import add, mul, sub, truediv
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from typing import Self

VARIABLE, CONSTANT, SUM, DIFFERENCE, MULTIPLE, PRODUCT, QUOTIENT, ROOT, GROWTH = range(9)


class Tape(NamedTuple):
    """The nodes of a formula: node n is the operation ``kinds[n]`` on the nodes ``left[n]`` and ``right[n]``.

    Variables come first, then constants, then operations; independent operations are grouped by kind. A MULTIPLE is a
    product whose left factor is a constant or a constant of motion. A ROOT has its radicand as its left and right node,
    and a GROWTH, e^x − 1, its argument x. No series is available for a GROWTH. ``constants`` has the values of the
    constant nodes, and 0 for all other nodes. ``results`` are the nodes of the values that the formula returned.
    """

    kinds: list[int]
    left: list[int]
    right: list[int]
    constants: list[Any]
    results: list[int]

    @property
    def nodes(self) -> list[tuple[int, int, int]]:
        """The triples (kind, left, right) of all nodes, in order."""
        return list(zip(self.kinds, self.left, self.right, strict=True))


def recorded(formula: Callable[[Sequence[Any]], Sequence[object]], variables: int) -> Tape:
    """The tape of a formula of ``variables`` variables; its constants may be any numbers with Python's operators."""
    recorder = _Recorder()
    given = [recorder.node(VARIABLE, -1 - i, -1) for i in range(variables)]
    results = [recorder.lifted(x).index for x in formula(given)]
    nodes = recorder.nodes
    levels = levels_of(nodes)
    order = sorted(range(len(nodes)), key=lambda n: (levels[n], nodes[n][0]))
    place = {n: k for k, n in enumerate(order)}
    kinds = [nodes[n][0] for n in order]
    left, right = ([place.get(nodes[n][side], nodes[n][side]) for n in order] for side in (1, 2))
    return Tape(kinds, left, right, [recorder.constants[n] for n in order], [place[n] for n in results])


def with_multiples(rates: Tape) -> Tape:
    """The tape of rates in which products with variables of rate 0, and with functions of these, are MULTIPLEs."""
    fixed = {i for i, n in enumerate(rates.results) if rates.kinds[n] == CONSTANT and rates.constants[n] == 0}
    kinds, left, right, _, _ = rates = Tape(*map(list, rates))
    for n, (kind, p, q) in enumerate(rates.nodes):
        if kind == CONSTANT or {p, q} <= fixed:
            fixed.add(n)
        elif kind == PRODUCT and (p in fixed or q in fixed):
            kinds[n], left[n], right[n] = MULTIPLE, *((p, q) if p in fixed else (q, p))
    return rates


def levels_of(nodes: Iterable[tuple[int, int, int]]) -> list[int]:
    """The level of each node (kind, left, right): 0 for variables and constants, else one above its operands."""
    found: list[int] = []
    for kind, p, q in nodes:
        found.append(0 if kind in (VARIABLE, CONSTANT) else 1 + max(found[p], found[q]))
    return found


class _Recorder:
    def __init__(self) -> None:
        self.nodes: list[tuple[int, int, int]] = []
        self.constants: list[object] = []
        self._known: dict[object, int] = {}

    def node(self, kind: int, left: int, right: int, constant: object = 0) -> Recorded:
        key = (kind, left, right, _known_by(constant))
        index = self._known.setdefault(key, len(self.nodes))
        if index == len(self.nodes):
            self.nodes.append((kind, left, right))
            self.constants.append(constant)
        return Recorded(self, index)

    def lifted(self, x: object) -> Recorded:
        return x if isinstance(x, Recorded) else self.node(CONSTANT, -1, -1, x)


def _known_by(constant: object) -> object:
    """The key of a constant: constants with one key share a node. Each ball has its own key, since equal balls may
    stand for different numbers.
    """
    try:
        hash(constant)
    except ValueError:
        return id(constant)
    return constant


OPERATIONS: dict[int, Callable[[Any, Any], Any]] = {
    SUM: add, DIFFERENCE: sub, MULTIPLE: mul, PRODUCT: mul, QUOTIENT: truediv,
}  # fmt: skip


class Operand:
    """A number whose operators all call :meth:`operation`, which a subclass defines."""

    __slots__ = ()

    def operation(self, kind: int, x: object, y: object) -> Self:
        """The result of the operation ``kind`` on x and y, one of which is ``self``."""
        raise NotImplementedError

    def __add__(self, other: object) -> Self:
        return self.operation(SUM, self, other)

    def __radd__(self, other: object) -> Self:
        return self.operation(SUM, other, self)

    def __sub__(self, other: object) -> Self:
        return self.operation(DIFFERENCE, self, other)

    def __rsub__(self, other: object) -> Self:
        return self.operation(DIFFERENCE, other, self)

    def __mul__(self, other: object) -> Self:
        return self.operation(PRODUCT, self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Self:
        return self.operation(QUOTIENT, self, other)

    def __rtruediv__(self, other: object) -> Self:
        return self.operation(QUOTIENT, other, self)

    def __neg__(self) -> Self:
        return self.operation(PRODUCT, -1, self)


class Recorded(Operand):
    """A number that records the operations performed on it."""

    __hash__ = None  # type: ignore[assignment]

    def __init__(self, recorder: _Recorder, index: int) -> None:
        self._recorder, self.index = recorder, index

    def operation(self, kind: int, left: object, right: object) -> Recorded:
        recorder = self._recorder
        x, y = recorder.lifted(left), recorder.lifted(right)
        p, q = x.constant, y.constant
        # a division by an int stays a division, since the reciprocal would be rounded to a float
        folded = kind != QUOTIENT or not isinstance(q, int)
        if p is not None and q is not None and folded:
            return recorder.lifted(OPERATIONS[kind](p, q))
        if kind == QUOTIENT and q is not None and folded:
            return self.operation(PRODUCT, truediv(1, q), x)
        if kind == PRODUCT:
            if q is not None:
                x, y, p, q = y, x, q, p
            if p is not None:
                return y if p == 1 else x if p == 0 else recorder.node(MULTIPLE, x.index, y.index)
        if q == 0 and kind in (SUM, DIFFERENCE):
            return x
        if kind == DIFFERENCE and x.index == y.index:
            return recorder.lifted(0)
        if p == 0 and kind in (SUM, QUOTIENT):
            return y if kind == SUM else x
        if kind in (SUM, PRODUCT) and x.index > y.index:
            x, y = y, x
        return recorder.node(kind, x.index, y.index)

    @property
    def constant(self) -> object:
        """The value of this number if it is a constant, else None."""
        recorder = self._recorder
        return recorder.constants[self.index] if recorder.nodes[self.index][0] == CONSTANT else None

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Recorded):
            return self.index == other.index
        return self.constant is not None and bool(self.constant == other)

    def __pow__(self, exponent: float) -> Recorded:
        if exponent == 2:
            return self * self
        assert exponent == 0.5
        return self.function(ROOT)

    def function(self, kind: int) -> Recorded:
        """The node of a function of this number: ROOT, GROWTH, or a kind that the field of the formulas adds."""
        return self._recorder.node(kind, self.index, self.index)
