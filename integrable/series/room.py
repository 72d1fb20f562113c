"""The layout of a tape's coefficients in the memory of a compiled walk, and the products computed in one vector.

The factors of these products are stored side by side. They belong to products that do not depend on each other, or to
the sums of earlier coefficients of products, quotients and roots.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from integrable.series.tape import CONSTANT, PRODUCT, QUOTIENT, ROOT, VARIABLE, Tape
from jacobian.native.machine import features

# number of floats in a vector register
WIDEST = 8 if "+avx512f" in features() else 4
# largest number of variables in one vector
ABREAST = 4
# indices of vectors in a room: the coefficient ratios that determine the step, the size of the coefficients of orders
# 2 and 3, the steps, and unit/(k + 1)
RATIOS, BENT, STEP, UNITS = 0, 4, 5, 8
# number of leading coefficients whose largest is taken as the size of a variable
FIRST = 4


class Orders(NamedTuple):
    """The orders of a series: its coefficients are double-doubles up to ``wide`` (−1: none), floats up to ``order``."""

    wide: int
    order: int


class Room:
    """The positions of a tape's coefficients in memory, in units of vectors of ``lanes`` floats."""

    def __init__(self, tape: Tape, count: int, orders: Orders, lanes: int) -> None:
        self.tape, self.count, self.orders, self.lanes = tape, count, orders, lanes
        wide, order = orders
        self.lows_of_units = UNITS + order
        begin = self.lows_of_units + wide + 1
        self.groups = [(nodes, square) for nodes, square in _abreast(tape, WIDEST // lanes)]
        squares = {n for nodes, square in self.groups for n in nodes if square}
        self.factors = _factors(tape)
        self.packs = _packs([n for n in self.factors if n not in squares], WIDEST // lanes)
        self.packs |= {nodes: len(nodes) for nodes, square in self.groups if square}
        packed = {n for nodes in self.packs for n in nodes}
        # nodes whose coefficients of all orders are read again and kept; other nodes keep order 0 at most
        self.kept = {n for n, kind in enumerate(tape.kinds) if kind in (VARIABLE, CONSTANT)}
        for n in self.factors.keys() - squares - packed:
            self.kept |= set(self.factors[n])
        # the variables are contiguous, because a step advances all of them at once
        self.begin = begin + -begin % ABREAST
        self.apart = count + -count % ABREAST
        begin = self.begin + (order + max(wide, 0) + 2) * self.apart
        rest = sorted(self.kept.union(*self.factors.values()) - set(range(count)))
        self._highs = {n: begin + i * (order + max(wide, 0) + 2) for i, n in enumerate(rest)}
        begin += len(rest) * (order + max(wide, 0) + 2)
        divided = [n for n, kind in enumerate(tape.kinds) if kind in (QUOTIENT, ROOT)]
        self.inverses = {n: begin + 2 * i for i, n in enumerate(divided)}
        self.size = begin + 2 * len(divided)
        self.copies: dict[int, list[tuple[int, int, int]]] = {}
        self.sides = {nodes: self._placed(nodes, width, nodes[0] in squares) for nodes, width in self.packs.items()}
        self.members = {n: nodes for nodes, _ in self.groups for n in nodes}
        self.pack_of = {n: nodes for nodes in self.packs for n in nodes}

    def high(self, n: int, k: int) -> int:
        """The position of coefficient k of node n, or of its high part."""
        return self._highs[n] + k if n >= self.count else self.begin + k * self.apart + n

    def low(self, n: int, k: int) -> int:
        """The position of the low part of coefficient k of node n."""
        return self.high(n, self.orders.order + 1 + k)

    def has(self, n: int, k: int) -> bool:
        """Whether coefficient k of node n is stored."""
        return n in self.kept or (k == 0 and n in self._highs)

    def _placed(self, nodes: tuple[int, ...], width: int, square: bool) -> tuple[tuple[tuple[int, ...], int], ...]:
        """For each side of a vector of products: the factors, and the position of their contiguous copies."""
        wide, order = self.orders
        found = []
        for side in range(1 if square else 2):
            factors = tuple(self.factors[n][side] for n in nodes)
            self.size += -self.size % width
            for slot, n in enumerate(factors):
                self.copies.setdefault(n, []).append((self.size, width, slot))
            found.append((factors, self.size))
            self.size += width * (order + 1 + max(wide, 0) + 1)
        return tuple(found)


def _factors(tape: Tape) -> dict[int, tuple[int, int]]:
    """For each product, quotient and root: the two nodes whose earlier coefficients its recurrence multiplies."""
    found = {}
    for n, (kind, p, q) in enumerate(zip(tape.kinds, tape.left, tape.right, strict=True)):
        if kind in (PRODUCT, ROOT) or (kind == QUOTIENT and tape.kinds[q] != CONSTANT):
            found[n] = (p if kind == PRODUCT else n), (n if kind == ROOT else q)
    return found


def _packs(nodes: Sequence[int], most: int) -> dict[tuple[int, ...], int]:
    """Nodes whose sums of earlier coefficients are independent and computed in one vector, and the vector's width."""
    if most < 2 or len(nodes) < 2:
        return {}
    width = min(most, 4)
    found = [tuple(nodes[i : i + width]) for i in range(0, len(nodes), width)]
    return {each: width if len(each) > 2 else 2 for each in found}


def _abreast(tape: Tape, most: int) -> list[tuple[tuple[int, ...], bool]]:
    """Groups of two or four products that do not depend on each other, and whether they are squares."""
    levels = list[int]()
    for kind, p, q in zip(tape.kinds, tape.left, tape.right, strict=True):
        levels.append(0 if kind in (VARIABLE, CONSTANT) else 1 + max(levels[p], levels[q]))
    found = []
    for level in sorted(set(levels)):
        for square in (True, False):
            nodes = [
                n for n, kind in enumerate(tape.kinds)
                if kind == PRODUCT and levels[n] == level and (tape.left[n] == tape.right[n]) == square
            ]  # fmt: skip
            while len(nodes) > 1 and most > 1:
                width = min(most, 4 if len(nodes) > 3 else 2)
                found.append((tuple(nodes[:width]), square))
                nodes = nodes[width:]
    return found


def chunks(count: int) -> list[tuple[int, int]]:
    """The variables in groups that fit one vector: the first index and the number of each group."""
    found = [(first, ABREAST) for first in range(0, count - ABREAST + 1, ABREAST)]
    for width in (2, 1):
        if count & width:
            found.append((count - count % (2 * width), width))
    return found
