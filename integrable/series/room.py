"""The layout of a tape's coefficients in the memory of a compiled walk, and the products that share a vector.

The recurrences of products, quotients and roots have a sum Σ p_j q_{k−j} over earlier coefficients of two series. The
sums of several nodes that do not depend on each other are computed in one vector, and their factors are stored side by
side.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from integrable.series.tape import CONSTANT, MULTIPLE, PRODUCT, QUOTIENT, ROOT, Tape, levels_of
from jacobian.native.machine import features

# number of floats in a vector register
WIDEST = 8 if "+avx512f" in features() else 4
# a motion has WALKS walks, which are compared, and at most ABREAST of its variables share a vector
WALKS, ABREAST = 2, 4
# indices of vectors in a :class:`Room`. The four from RATIOS on have the ratios |coefficient|/(size of the variable)
# that determine the step. The vector BENT has the size of the coefficients of orders 2 and 3, and STEP has the steps.
# Those from UNITS on have (unit of time)/(k + 1), k = 0, 1, …
RATIOS, BENT, STEP, UNITS = 0, 4, 5, 8
# number of leading coefficients whose largest is taken as the size of a variable
FIRST = 4


class Orders(NamedTuple):
    """The orders of a series: its coefficients are double-doubles up to ``wide`` (−1: none), floats up to ``order``."""

    wide: int
    order: int


class Side(NamedTuple):
    """The left or the right factors of ``width`` products that are computed together, as the entries of one vector.

    The coefficients of order 0 of all factors are the vector number ``place`` in memory; those of each next order are
    ``apart`` vectors further. ``shared``: the factors are variables, whose coefficients are stored anyway.
    """

    factors: tuple[int, ...]
    width: int
    place: int
    apart: int = 1
    shared: bool = False


class Room:
    """The memory of a compiled walk: the positions of a tape's coefficients, in vectors of ``lanes`` floats."""

    def __init__(self, tape: Tape, count: int, orders: Orders, lanes: int) -> None:
        self.tape, self.count, self.orders, self.lanes = tape, count, orders, lanes
        wide, order = orders
        self.lows_of_units = UNITS + order
        begin = self.lows_of_units + wide + 1
        self.factors = _factors(tape)
        packs, groups = _packed(tape, list(self.factors), min(4, WIDEST // WALKS))
        # sums are grouped in the same way for all ``lanes``, so that results do not depend on ``lanes``
        self.at_once = {n for nodes in packs if nodes in groups for n in nodes}
        most = max(1, WIDEST // lanes)
        self.members = {n: part for nodes in groups for part in _parts(nodes, most) for n in part}
        parts = [part for nodes in packs for part in _parts(nodes, most)]
        self.packs = {nodes: 1 << (len(nodes) - 1).bit_length() for nodes in parts}
        # the variables are contiguous, because a step advances all of them at once
        self.abreast = ABREAST * WALKS // lanes
        self.begin = begin + -begin % self.abreast
        self.apart = count + -count % self.abreast
        # the loop over orders writes low parts up to one order beyond ``wide``
        begin = self.begin + (order + max(wide, 0) + 3) * self.apart
        # of constants, and of factors that are not variables, only the coefficient of order 0 is stored, as (hi, lo)
        kept = {n for n, kind in enumerate(tape.kinds) if kind == CONSTANT}.union(*self.factors.values())
        kept |= {p for kind, p, _ in tape.nodes if kind == MULTIPLE}
        self._highs = {n: begin + 2 * i for i, n in enumerate(sorted(kept - set(range(count))))}
        begin += 2 * len(self._highs)
        divided = [n for n, kind in enumerate(tape.kinds) if kind in (QUOTIENT, ROOT)]
        self.inverses = {n: begin + 2 * i for i, n in enumerate(divided)}
        self.size = begin + 2 * len(divided)
        self._sides: dict[tuple[int, ...], Side] = {}
        self.sides: dict[tuple[int, ...], list[Side]] = {}
        for nodes, width in self.packs.items():
            left, right = zip(*[self.factors[n] for n in nodes], strict=True)
            # the left and right factors of squares are the same
            square = nodes[0] in self.members and is_square(tape, nodes[0])
            self.sides[nodes] = [self._placed(each, width) for each in ([left] if square else [left, right])]
        self.placed = tuple(self._sides.values())
        self.pack_of = {n: nodes for nodes in self.packs for n in nodes}

    def high(self, n: int, k: int) -> int:
        """The position of coefficient k of node n, or of its high part."""
        assert self.has(n, k)
        return self.begin + k * self.apart + n if n < self.count else self._highs[n]

    def low(self, n: int, k: int) -> int:
        """The position of the low part of coefficient k of node n."""
        return self.high(n, self.orders.order + 1 + k) if n < self.count else self._highs[n] + 1

    def has(self, n: int, k: int) -> bool:
        """Whether coefficient k of node n has a position of its own (:meth:`high`)."""
        return n < self.count or (k == 0 and n in self._highs)

    def chunks(self, count: int) -> list[tuple[int, int]]:
        """The first ``count`` variables in groups that fit one vector: for each group, its first index and its size."""
        found, first, width = [], 0, self.abreast
        while first < count:
            while first + width > count:
                width //= 2
            found.append((first, width))
            first += width
        return found

    def _placed(self, factors: tuple[int, ...], width: int) -> Side:
        """The :class:`Side` with these factors; its memory is reserved at the first call."""
        if factors not in self._sides:
            first, (wide, order) = factors[0], self.orders
            if first % width == 0 and factors == tuple(range(first, min(first + width, self.count))):
                own = Side(factors, width, (self.begin + first) // width, self.apart // width, True)
            else:
                self.size += -self.size % width
                own = Side(factors, width, self.size // width)
                self.size += width * (order + 1 + max(wide, 0) + 1)
            self._sides[factors] = own
        return self._sides[factors]


def _factors(tape: Tape) -> dict[int, tuple[int, int]]:
    """For each product, quotient and root: the two nodes whose earlier coefficients its recurrence multiplies."""
    found = {}
    for n, (kind, p, q) in enumerate(tape.nodes):
        if kind in (PRODUCT, ROOT) or (kind == QUOTIENT and tape.kinds[q] != CONSTANT):
            found[n] = (p if kind == PRODUCT else n), (n if kind == ROOT else q)
    return found


def _parts(nodes: Sequence[int], most: int) -> list[tuple[int, ...]]:
    return [tuple(nodes[i : i + most]) for i in range(0, len(nodes), most)]


def is_square(tape: Tape, n: int) -> bool:
    return tape.kinds[n] == PRODUCT and tape.left[n] == tape.right[n]


def _abreast(tape: Tape, most: int) -> list[tuple[int, ...]]:
    """Groups of two or more products that do not depend on each other; all are squares, or none is."""
    levels, alike = levels_of(tape.nodes), dict[tuple[int, bool], list[int]]()
    for n, kind in enumerate(tape.kinds):
        if kind == PRODUCT:
            alike.setdefault((levels[n], is_square(tape, n)), []).append(n)
    return [part for key in sorted(alike) for part in _parts(alike[key], most) if len(part) > 1]


def _packed(tape: Tape, products: list[int], most: int) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
    """(packs, groups); the groups are those of :func:`_abreast`. A pack lists at most ``most`` nodes whose sums over
    earlier coefficients share a vector.

    A pack begins with a group, if any is left. Other nodes fill the rest of the pack, unless it begins with squares.
    """
    groups, packs = _abreast(tape, most), []
    rest = [n for n in products if not any(n in nodes for nodes in groups)]
    for nodes in groups:
        free = 0 if is_square(tape, nodes[0]) else most - len(nodes)
        packs.append((*nodes, *rest[:free]))
        rest = rest[free:]
    return [*packs, *_parts(rest, most)], groups
