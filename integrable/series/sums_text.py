"""Sums of products of Taylor coefficients as LLVM text: the coefficients in memory and in registers.

The sums of several nodes form one vector, and their factors are stored side by side. Low orders are straight-line
code, which has all terms of a sum. A loop over the other orders computes AT_ONCE orders in a round: an inner loop first
sums the terms of all these orders whose two factors belong to earlier rounds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from integrable.series.room import Room, Side
from integrable.series.tape import CONSTANT, DIFFERENCE, SUM, VARIABLE
from integrable.series.text import Text, Wide, joined_lanes
from jacobian.numbers.double_double_steps import fast_two_sum

# number of orders in a round of the loop: a factor is loaded once for all of them
AT_ONCE = 4
# if at least this many orders are in double-doubles, sums of two coefficients are renormalized at once, which takes a
# tenth of the time of a step. Such steps are used only where steps with fewer orders in double-doubles lose too many
# digits (a body of Veselova's with a moment of 5e-10)
CAREFUL = 10
# the orders in double-doubles are computed by a loop if straight-line code would have more than LONGEST operations,
# about 15 KB, half of an instruction cache; shorter code is faster than a loop (python -m benchmarks near)
LONGEST = 200
Term = tuple[int, int, int]
"""(factor, j, k − j), for the term factor·p_j q_{k−j}."""
Factor = tuple[str, Side, int]
"""(pointer, side, order): coefficients of this order, whose position is counted from the pointer."""


class Loop(NamedTuple):
    """A loop over the orders ``begin`` … ``end`` − 1, ``at_once`` orders in each round."""

    begin: int
    end: int
    at_once: int


class Sums:
    """The LLVM text that loads a walk's coefficients and sums products of them."""

    def __init__(self, room: Room) -> None:
        self.room, self.tape = room, room.tape
        self.wide, self.order = room.orders
        self.text = Text(room.lanes)
        operations = sum(kind not in (VARIABLE, CONSTANT) for kind in self.tape.kinds)
        first = self.wide + 1 if operations * (self.wide + 1) <= LONGEST else 2
        low = max(self.wide + 1, 2 * AT_ONCE)
        in_floats = Loop(low + (self.order - low) % AT_ONCE, self.order, AT_ONCE)
        self.loops = Loop(first, self.wide + 1, 1), in_floats
        self._loop = self.loops[0]
        # the registers of coefficients by (node, order, part), and of vectors of coefficients by (place, order, part)
        self._recent: dict[tuple[int, int, int], str] = {}
        self._built: dict[tuple[int, int, int], str] = {}
        # the sums over 0 < j < k of the current order k, by the nodes of a vector
        self._sums: dict[tuple[int, ...], Wide] = {}
        # in a loop: for each vector and order of the round, the sum of the terms whose factors are from earlier rounds
        self._before: dict[tuple[int, ...], list[Wide]] = {}
        # in a loop: pointers that advance with the order, by their stride (the number of vectors from order to order)
        self._moving: dict[int, str] = {}

    def _begin_round(self, loop: Loop, done: str) -> None:
        """Begins a round of a loop, ``done`` orders after the first round."""
        self._loop = loop
        strides = {1, self.room.apart, *(side.width * side.apart for side in self.room.placed)}
        self._moving = {n: self._further("%s", done, n * self.room.lanes) for n in sorted(strides)}
        # the registers recorded so far hold values of the previous round
        self._recent, self._built = {}, {}
        earlier = self._earlier_orders if loop.end <= self.wide + 1 else self._earlier_rounds
        self._before = {nodes: earlier(nodes, done) for nodes in self.room.packs}

    def _further(self, base: str, count: str, stride: int) -> str:
        """The pointer ``base`` moved by ``count``·``stride`` floats."""
        there = self.text.write(f"mul i64 {count}, {stride}")
        return self.text.write(f"getelementptr double, ptr {base}, i64 {there}")

    def _base(self, k: int, stride: int) -> str:
        """The pointer from which the positions of coefficients of order k are counted."""
        return self._moving[stride] if self._moving and k >= self._loop.begin else "%s"

    def _hi(self, n: int, k: int) -> str:
        return self._recent.get((n, k, 0)) or self.text.load(self.room.high(n, k), self._base(k, self.room.apart))

    def _lo(self, n: int, k: int) -> str:
        return self._recent.get((n, k, 1)) or self.text.load(self.room.low(n, k), self._base(k, self.room.apart))

    def _value(self, n: int, k: int) -> Wide:
        """Coefficient k of node n: (hi, lo) up to the order ``wide``, (float, "") beyond it."""
        if k and self.tape.kinds[n] == CONSTANT:
            return self.text.real(0.0), self.text.real(0.0) if k <= self.wide else ""
        return self._hi(n, k), self._lo(n, k) if k <= self.wide else ""

    def _put(self, n: int, k: int, x: Wide) -> None:
        # after cancellation the two parts of a sum overlap, and products with this sum would have only float accuracy
        cancels = self.wide >= CAREFUL and self.tape.kinds[n] in (SUM, DIFFERENCE)
        if x[1] and (k == 0 or cancels):
            x = fast_two_sum(self.text, *x)
        for part, y in enumerate(x):
            if y:
                self._recent[n, k, part] = y
                if k == 0 and self.room.has(n, k):
                    self.text.store(y, self.room.low(n, k) if part else self.room.high(n, k))

    def _put_variables(self, k: int) -> None:
        for first, width in self.room.chunks(self.room.count):
            text = Text(self.room.lanes * width, self.text)
            for part, y in enumerate(self._together(text, range(first, first + width), k)):
                if y:
                    place = self.room.low(first, k) if part else self.room.high(first, k)
                    text.store(y, place // width, self._base(k, self.room.apart))

    def _together(self, text: Text, nodes: Sequence[int], k: int) -> Wide:
        """Coefficients k of several nodes in one vector.

        The vector is put together in registers, because a load of it would wait for the stores of its parts.
        """
        high = self._joined(text, [self._hi(n, k) for n in nodes])
        if k > self.wide:
            return high, ""
        low = self._joined(text, [self._lo(n, k) for n in nodes])
        # float coefficients of higher orders use only the high parts, which are inaccurate after cancellation unless
        # they are renormalized
        return fast_two_sum(text, high, low) if k else (high, low)

    def _put_sides(self, k: int, of_variables: bool) -> None:
        """Stores coefficients k of the factors in each :class:`integrable.series.room.Side`.

        Stored are the sides that consist of variables if ``of_variables``, else all other sides.
        """
        for side in self.room.placed:
            if of_variables != (max(side.factors) < self.room.count):
                continue
            if side.shared and not any((n, k, 0) in self._recent for n in side.factors):
                continue
            text = Text(self.room.lanes * side.width, self.text)
            for part, y in enumerate(self._together(text, side.factors, k)):
                if y:
                    self._built[side.place, k, part] = y
                    if not side.shared:
                        text.store(y, self._place(side, k, part), self._base(k, side.width * side.apart))

    def _place(self, side: Side, k: int, part: int) -> int:
        return side.place + (part * (self.order + 1) + k) * side.apart

    # --- sums of products

    def _convolved(self, n: int, begin: int, end: int, k: int) -> Wide | None:
        """Σ p_j q_{k−j} over begin ≤ j < end, for the factors p, q of a node; None for an empty sum."""
        p, q = self.room.factors[n]
        before = self._sum_of_earlier(n, k)
        terms = [term for term in _terms(p == q, begin, end, k) if not all(term[1:])]
        # the term with the factor that is computed later comes last
        terms.sort(key=lambda term: p if term[1] else q)
        pairs = _pairs(terms, lambda side, order: self._value((p, q)[side], order))
        if before and not before[1]:
            # a factor is doubled, not a partial sum, so that all terms are in one sum and the newest is added last
            pairs = [(1, x, _doubled(self.text, y) if f == 2 else y) for f, x, y in pairs]
        return _summed(self.text, pairs, k <= self.wide, before) if pairs or before else None

    def _sum_of_earlier(self, n: int, k: int) -> Wide | None:
        """Σ p_j q_{k−j} over 0 < j < k, for the factors of a node, taken from the vector with this sum."""
        nodes = self.room.pack_of[n]
        found = self._sums_of_earlier(nodes, k)
        return found and self._apart(self._vector(nodes), nodes, found)[n]

    def _sums_of_earlier(self, nodes: tuple[int, ...], k: int) -> Wide | None:
        if k > 1 and nodes not in self._sums:
            text, sides = self._vector(nodes), self.room.sides[nodes]
            if self._before:
                self._sums[nodes] = self._of_round(text, nodes, k)
            else:
                self._sums[nodes] = self._products(text, sides, _terms(len(sides) == 1, 1, k, k), k)
        return self._sums.get(nodes)

    def _vector(self, nodes: tuple[int, ...]) -> Text:
        return Text(self.room.lanes * self.room.packs[nodes], self.text)

    def _group(self, nodes: tuple[int, ...], k: int) -> dict[int, Wide]:
        """The coefficients k of several products, computed in one vector."""
        pack = self.room.pack_of[nodes[0]]
        text, sides, before = self._vector(pack), self.room.sides[pack], None
        terms = _terms(len(sides) == 1, 0, k + 1, k)
        if self._before or nodes[0] not in self.room.at_once:
            terms, before = [term for term in terms if not all(term[1:])], self._sums_of_earlier(pack, k)
        if nodes[0] in self.room.at_once:
            return self._apart(text, nodes, self._products(text, sides, terms, k, before))

        def joined(side: int, order: int) -> Wide:
            factors = [self.room.factors[n][side] for n in nodes]
            high, low = (self._joined(text, [part(n, order) for n in factors]) for part in (self._hi, self._lo))
            return high, low

        return self._apart(text, nodes, _summed(text, _pairs(terms, joined), True, before))

    def _joined(self, text: Text, parts: list[str]) -> str:
        """Joins the parts into one vector, whose remaining lanes repeat the last part."""
        width = text.lanes // self.room.lanes
        return joined_lanes(text, parts + parts[-1:] * (width - len(parts)), self.room.lanes)

    def _products(
        self, text: Text, sides: Sequence[Side], terms: Sequence[Term], k: int, before: Wide | None = None
    ) -> Wide:
        """``before`` plus a vector with the sums of several products; the factors are side by side in memory."""
        wide = k <= self.wide

        def fetched(side: int, order: int) -> Wide:
            high, low = (
                self._fetched(text, (sides[0], sides[-1])[side], order, part) if wide or not part else ""
                for part in (0, 1)
            )
            return high, low

        return _summed(text, _pairs(terms, fetched), wide, before)

    def _earlier_orders(self, nodes: tuple[int, ...], done: str) -> list[Wide]:
        """Σ p_j q_{k−j} over 0 < j < k in double-doubles, for the order k of the round."""
        text, sides, begin = self._vector(nodes), self.room.sides[nodes], self._loop.begin
        left, right = sides[0], sides[-1]
        here_right = self._base(begin, right.width * right.apart)

        def term(count: str, sums: list[str]) -> list[str]:
            up = self._further("%s", count, self._floats(left))
            down = self._further(here_right, count, -self._floats(right))
            x, y = (
                (text.load(self._place(side, k, 0), there), text.load(self._place(side, k, 1), there))
                for side, k, there in ((left, 1, up), (right, begin - 1, down))
            )
            return [*text.wide_plus_product((sums[0], sums[1]), x, y)]

        end = self.text.write(f"add i64 {done}, {begin - 1}")
        high, low = self._repeated(f"terms{nodes[0]}", text, [text.real(0.0)] * 2, (end, 1), term)
        return [(high, low)]

    def _earlier_rounds(self, nodes: tuple[int, ...], done: str) -> list[Wide]:
        """For each order k of the round: Σ p_j q_{k−j} over the j for which j and k − j belong to earlier rounds.

        In a square the terms j and k − j are equal, so only j up to the middle are summed.
        """
        text, sides, begin = self._vector(nodes), self.room.sides[nodes], self._loop.begin
        left, right, square = sides[0], sides[-1], len(sides) == 1
        at_once, last = (AT_ONCE // 2, (begin - 1) // 2) if square else (AT_ONCE, begin - 1)
        # the first terms, j ≤ ``first``, are added after the loop, because their right factors are the newest. The
        # number of terms in the loop is a multiple of ``at_once``
        first = AT_ONCE - 1 + (last - AT_ONCE + 1) % at_once
        sums = [text.real(0.0)] * AT_ONCE
        if square:
            done = self.text.write(f"lshr i64 {done}, 1")
            sums = self._middles(text, left, self._further("%s", done, self._floats(left)), last)
        here_right = self._base(begin, right.width * right.apart)

        def terms(count: str, sums: list[str]) -> list[str]:
            up = self._further("%s", count, self._floats(left))
            down = self._further(here_right, count, -self._floats(right))
            for j in range(first + 1, first + at_once + 1):
                self._add(text, sums, AT_ONCE, (up, left, j), (down, right, begin - j), square)
            return sums

        end = text.write(f"add i64 {done}, {last - first}")
        known = self._repeated(f"sum{nodes[0]}", text, sums, (end, at_once), terms)
        for j in range(first, 0, -1):
            self._add(text, known, j, ("%s", left, j), (here_right, right, begin - j), square)
        return [(x, "") for x in known]

    def _repeated(
        self, name: str, text: Text, sums: list[str], steps: tuple[str, int],
        terms: Callable[[str, list[str]], list[str]],
    ) -> list[str]:  # fmt: skip
        """Writes a loop that adds ``terms`` to ``sums``, with a count from 0 to an end by a step; returns the sums."""
        lines, kind, (end, step) = self.text.lines, text.types.double, steps
        lines += [f"  br label %{name}_begin", f"{name}_begin:", f"  br label %{name}", f"{name}:"]
        count, further, known, here = text.fresh(), text.fresh(), [text.fresh() for _ in sums], len(lines)
        more = text.write(f"icmp slt i64 {count}, {end}")
        lines += [f"  br i1 {more}, label %{name}_terms, label %{name}_end", f"{name}_terms:"]
        later = terms(count, list(known))
        lines += [f"  {further} = add i64 {count}, {step}", f"  br label %{name}", f"{name}_end:"]
        places = f"%{name}_begin ], [ ", f"%{name}_terms ]"
        lines[here:here] = [
            f"  {count} = phi i64 [ 0, {places[0]}{further}, {places[1]}",
            *(
                f"  {x} = phi {kind} [ {before}, {places[0]}{after}, {places[1]}"
                for x, before, after in zip(known, sums, later, strict=True)
            ),
        ]
        return known

    def _floats(self, side: Side) -> int:
        """The number of floats between consecutive orders of a side."""
        return side.width * side.apart * self.room.lanes

    def _middles(self, text: Text, side: Side, base: str, last: int) -> list[str]:
        """For each order k of a round, the middle terms of the square: Σ p_j p_{k−j} over ``last`` < j < k − ``last``.

        The pointer ``base`` advances half as fast as the order, as j and k − j ≈ ½k do.
        """
        sums = []
        for k in range(self._loop.begin, self._loop.begin + AT_ONCE):
            total = text.real(0.0)
            for j in range(last + 1, k // 2 + 1):
                x, y = (text.load(self._place(side, i, 0), base) for i in (j, k - j))
                total = text.fma(x if 2 * j == k else text.fadd(x, x), y, total)
            sums.append(total)
        return sums

    def _add(self, text: Text, sums: list[str], count: int, left: Factor, right: Factor, twice: bool) -> None:
        """Adds to ``sums``[m], m < ``count``, the product of the ``left`` coefficient and the coefficient m orders
        after the ``right`` one, doubled if ``twice``.
        """
        (up, side, j), (down, other, i) = left, right
        x = text.load(self._place(side, j, 0), up)
        x = text.fadd(x, x) if twice else x
        for m in range(min(count, AT_ONCE)):
            y = text.load(self._place(other, i + m, 0), down)
            sums[m] = text.fma(x, y, sums[m])

    def _of_round(self, text: Text, nodes: tuple[int, ...], k: int) -> Wide:
        """Σ p_j q_{k−j} over 0 < j < k, from the sum over earlier rounds."""
        sides, m = self.room.sides[nodes], k - self._loop.begin
        total, low = self._before[nodes][m]
        for j in range(m, 0, -1):
            for i in (j, k - j):
                x, y = self._fetched(text, sides[0], i, 0), self._fetched(text, sides[-1], k - i, 0)
                total = text.fma(x, y, total)
        return total, low

    def _apart(self, text: Text, nodes: tuple[int, ...], x: Wide) -> dict[int, Wide]:
        return {n: (self._part(text, x[0], i), self._part(text, x[1], i)) for i, n in enumerate(nodes)}

    def _part(self, text: Text, x: str, slot: int) -> str:
        """The number in slot ``slot`` of a vector of several numbers."""
        kind, lanes = text.types.double, self.room.lanes
        if not x or text.lanes == lanes:
            return x
        if lanes == 1:
            return text.write(f"extractelement {kind} {x}, i32 {slot}")
        places = ", ".join(f"i32 {slot * lanes + i}" for i in range(lanes))
        return text.write(f"shufflevector {kind} {x}, {kind} undef, <{lanes} x i32> <{places}>")

    def _fetched(self, text: Text, side: Side, k: int, part: int) -> str:
        """Coefficients of order k of a side's factors, as a vector: the high parts, or the low parts if ``part``."""
        key = side.place, k, part
        if key not in self._built:
            # coefficients of the current order are in registers, except those of order 0 of variables
            if any((n, k, part) in self._recent for n in side.factors):
                parts = [self._lo(n, k) if part else self._hi(n, k) for n in side.factors]
                self._built[key] = self._joined(text, parts)
            else:
                return text.load(self._place(side, k, part), self._base(k, side.width * side.apart))
        return self._built[key]


def _terms(square: bool, begin: int, end: int, k: int) -> list[Term]:
    """The terms of Σ p_j q_{k−j} over begin ≤ j < end; the term with the newest coefficients comes last."""
    if not square:
        found = [(1, j, k - j) for j in range(begin, end)]
    else:
        found = [(2, j, k - j) for j in range(begin, (k + 1) // 2) if k - j < end]
        if k % 2 == 0 and begin <= k // 2 < end:
            found.append((1, k // 2, k // 2))
    return sorted(found, key=lambda term: max(term[1:]))


def _pairs(terms: Sequence[Term], value: Callable[[int, int], Wide]) -> list[tuple[int, Wide, Wide]]:
    """(f, x, y) for each term f·x·y; the coefficients x and y are ``value(side, order)``, x of the higher order."""
    values = ((f, (i, value(0, i)), (j, value(1, j))) for f, i, j in terms)
    return [(f, x[1], y[1]) if x[0] >= y[0] else (f, y[1], x[1]) for f, x, y in values]


def _summed(text: Text, pairs: Sequence[tuple[int, Wide, Wide]], wide: bool, before: Wide | None) -> Wide:
    """``before`` + Σ f·x·y over the ``pairs``, of which the last is added last. The others with f = 2 are summed first,
    and their sum is doubled.
    """
    last = pairs[-1:] if wide else []
    earlier = pairs[: len(pairs) - len(last)]
    twice = [(x, y) for f, x, y in earlier if f == 2]
    once = [(x, y) for f, x, y in earlier if f == 1]
    once += [(x, _doubled(text, y) if f == 2 else y) for f, x, y in last]
    if wide:
        total = _wide_total(text, twice, None) if twice else None
        if total is not None:
            total = _doubled(text, total)
        if before is not None:
            total = before if total is None else text.wide_sum(before, total)
        return _wide_total(text, once, total)
    half, rest = _total(text, twice, ""), _total(text, once, before[0] if before else "")
    if not half:
        return rest, ""
    return (text.fma(half, text.real(2.0), rest) if rest else text.fadd(half, half)), ""


def _doubled(text: Text, x: Wide) -> Wide:
    return text.fadd(x[0], x[0]), text.fadd(x[1], x[1]) if x[1] else ""


def _wide_total(text: Text, pairs: Sequence[tuple[Wide, Wide]], total: Wide | None) -> Wide:
    for x, y in pairs:
        total = text.wide_product(x, y) if total is None else text.wide_plus_product(total, x, y)
    assert total is not None
    return total


def _total(text: Text, pairs: Sequence[tuple[Wide, Wide]], before: str) -> str:
    """``before`` + Σ x·y in floats, as two partial sums that the processor computes in parallel."""
    sums: list[str] = [before] if before else []
    for i, ((x, _), (y, _)) in enumerate(pairs):
        if len(sums) < min(2, max(1, len(pairs) // 2)):
            sums.append(text.fmul(x, y))
        else:
            m = i % len(sums)
            sums[m] = text.fma(x, y, sums[m])
    return text.fadd(*sums) if len(sums) == 2 else sums[0] if sums else ""
