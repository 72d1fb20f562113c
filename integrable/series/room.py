"""The layout of a tape's coefficients in the memory of a compiled walk, and the products that share a vector.

The products in a vector do not depend on each other, and their factors are stored side by side. Products here are those
of the tape, and the sums over earlier coefficients in the recurrences of products, quotients and roots.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from integrable.series.tape import CONSTANT, PRODUCT, QUOTIENT, ROOT, Tape, levels_of
from jacobian.native.machine import features

# number of floats in a vector register
WIDEST = 8 if "+avx512f" in features() else 4
# largest number of variables in one vector
ABREAST = 4
# indices of vectors in a :class:`Room`: from RATIOS on, the coefficient ratios that determine the step; at BENT, the
# size of the coefficients of orders 2 and 3; from STEP on, the steps; from UNITS on, unit/(k + 1), where unit is the
# unit of time
RATIOS, BENT, STEP, UNITS = 0, 4, 5, 8
# number of leading coefficients whose largest is taken as the size of a variable
FIRST = 4


class Orders(NamedTuple):
    """The orders of a series: its coefficients are double-doubles up to ``wide`` (−1: none), floats up to ``order``."""

    wide: int
    order: int


class Side(NamedTuple):
    """The left or the right factors of a vector of products, and the position of their coefficients in memory, in units
    of the vector's width.
    """

    factors: tuple[int, ...]
    place: int


class Room:
    """The memory of a compiled walk: the positions of a tape's coefficients, in vectors of ``lanes`` floats."""

    def __init__(self, tape: Tape, count: int, orders: Orders, lanes: int) -> None:
        self.tape, self.count, self.orders, self.lanes = tape, count, orders, lanes
        wide, order = orders
        self.lows_of_units = UNITS + order
        begin = self.lows_of_units + wide + 1
        self.groups = [(nodes, square) for nodes, square in _abreast(tape, WIDEST // lanes)]
        squares = {nodes: len(nodes) for nodes, square in self.groups if square}
        self.factors = _factors(tape)
        within = {n for nodes in squares for n in nodes}
        self.packs = _packs([n for n in self.factors if n not in within], WIDEST // lanes) | squares
        # the variables are contiguous, because a step advances all of them at once
        self.begin = begin + -begin % ABREAST
        self.apart = count + -count % ABREAST
        begin = self.begin + (order + max(wide, 0) + 2) * self.apart
        # only the coefficients of order 0 are kept, as hi and lo, of constants and of factors that are no variables
        kept = {n for n, kind in enumerate(tape.kinds) if kind == CONSTANT}.union(*self.factors.values())
        self._highs = {n: begin + 2 * i for i, n in enumerate(sorted(kept - set(range(count))))}
        begin += 2 * len(self._highs)
        divided = [n for n, kind in enumerate(tape.kinds) if kind in (QUOTIENT, ROOT)]
        self.inverses = {n: begin + 2 * i for i, n in enumerate(divided)}
        self.size = begin + 2 * len(divided)
        self.sides = {nodes: self._placed(nodes, width, nodes in squares) for nodes, width in self.packs.items()}
        self.members = {n: nodes for nodes, _ in self.groups for n in nodes}
        self.pack_of = {n: nodes for nodes in self.packs for n in nodes}

    def high(self, n: int, k: int) -> int:
        """The position of coefficient k of node n, or of its high part."""
        assert self.has(n, k)
        return self.begin + k * self.apart + n if n < self.count else self._highs[n]

    def low(self, n: int, k: int) -> int:
        """The position of the low part of coefficient k of node n."""
        return self.high(n, self.orders.order + 1 + k) if n < self.count else self._highs[n] + 1

    def has(self, n: int, k: int) -> bool:
        """Whether coefficient k of node n is stored by itself."""
        return n < self.count or (k == 0 and n in self._highs)

    def _placed(self, nodes: tuple[int, ...], width: int, square: bool) -> tuple[Side, ...]:
        """The sides of a vector of products; a square has one."""
        wide, order = self.orders
        found = []
        for side in range(1 if square else 2):
            self.size += -self.size % width
            found.append(Side(tuple(self.factors[n][side] for n in nodes), self.size // width))
            self.size += width * (order + 1 + max(wide, 0) + 1)
        return tuple(found)


def _factors(tape: Tape) -> dict[int, tuple[int, int]]:
    """For each product, quotient and root: the two nodes whose earlier coefficients its recurrence multiplies."""
    found = {}
    for n, (kind, p, q) in enumerate(tape.nodes):
        if kind in (PRODUCT, ROOT) or (kind == QUOTIENT and tape.kinds[q] != CONSTANT):
            found[n] = (p if kind == PRODUCT else n), (n if kind == ROOT else q)
    return found


def _packs(nodes: Sequence[int], most: int) -> dict[tuple[int, ...], int]:
    """Nodes whose sums of earlier coefficients are independent and computed in one vector, and the vector's width."""
    width = min(most, 4)
    found = [tuple(nodes[i : i + width]) for i in range(0, len(nodes), width)]
    return {each: 1 << (len(each) - 1).bit_length() for each in found}


def _abreast(tape: Tape, most: int) -> list[tuple[tuple[int, ...], bool]]:
    """Groups of two or four products that do not depend on each other, and whether they are squares."""
    levels, found = levels_of(tape.nodes), []
    for level in sorted(set(levels)):
        for square in (True, False):
            nodes = [
                n for n, (kind, p, q) in enumerate(tape.nodes)
                if kind == PRODUCT and levels[n] == level and (p == q) == square
            ]  # fmt: skip
            while len(nodes) > 1 and most > 1:
                width = min(most, 4 if len(nodes) > 3 else 2)
                found.append((tuple(nodes[:width]), square))
                nodes = nodes[width:]
    return found


def chunks(count: int) -> list[tuple[int, int]]:
    """The variables in groups that fit one vector: for each group, its first index and its size."""
    found = [(first, ABREAST) for first in range(0, count - ABREAST + 1, ABREAST)]
    for width in (2, 1):
        if count & width:
            found.append((count - count % (2 * width), width))
    return found
