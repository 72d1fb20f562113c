"""A Taylor step of a tape as straight-line code: the coefficients of all orders, one after the other.

Coefficients up to the order ``wide`` are double-doubles, higher ones floats. The two walks are lanes of one vector.
Recent values stay in registers, because a wide load waits for narrow stores just made. Their products are added last,
because all other terms of the sum are known one order earlier.
"""

from __future__ import annotations

from collections.abc import Sequence

from integrable.series.room import FIRST, RATIOS, UNITS, Room, chunks
from integrable.series.tape import CONSTANT, DIFFERENCE, MULTIPLE, PRODUCT, ROOT, SUM, VARIABLE
from integrable.series.text import Text, Wide, joined_lanes
from jacobian.numbers.double_double_steps import fast_two_sum, quotient, reciprocal, square_root, two_product, two_sum

# number of lines in a block: LLVM's compile time for a block grows with the square of its length
BLOCK = 150
Term = tuple[int, int, int]
"""(factor, j, k − j), for the term factor·p_j q_{k−j}."""


class Series:
    """The LLVM text that computes the coefficients of a room."""

    def __init__(self, room: Room, count: int) -> None:
        self.room, self.tape, self._shown = room, room.tape, count
        self.wide, self.order = room.orders
        self.text = Text(room.lanes)
        self._recent: dict[tuple[int, int, int], str] = {}
        self._built: dict[tuple[int, int, int], str] = {}
        self._divisors: dict[int, Wide] = {}
        self._sums: dict[int, Wide] = {}
        self._blocks = 0

    def function(self) -> str:
        """The LLVM function; the room must hold its constants, units and coefficients of order 0 before the call."""
        text, tape = self.text, self.tape
        begin = next((n for n, kind in enumerate(tape.kinds) if kind not in (VARIABLE, CONSTANT)), len(tape.kinds))
        for n in sorted(set(self.room.copies) & set(range(begin))):
            self._copy(n, 0, self._value(n, 0))
        for k in range(self.order):
            self._recent = {key: x for key, x in self._recent.items() if key[1] == k}
            self._built, self._divisors, self._sums = {}, {}, {}
            for n in range(begin, len(tape.kinds)):
                self._end_of_block()
                nodes = self.room.members.get(n, ())
                if not nodes or k > self.wide:
                    self._put(n, k, self._node(n, k))
                elif nodes[0] == n:
                    for each, x in self._group(nodes, k).items():
                        self._put(each, k, x)
                if k == 0 and n in self.room.inverses:
                    self._put_inverse(n)
            self._end_of_block()
            for i in range(self.room.count):
                self._put(i, k + 1, self._integrated(self._value(tape.results[i], k), k))
        self._put_ratios()
        head = "define void @series(ptr noalias %s) nounwind {\nentry:\n  %word = load i64, ptr %s\n"
        # no room begins with this word; the branch that is never taken keeps LLVM from joining the blocks
        head += "  %never = icmp eq i64 %word, -1\n"
        return "\n".join([head, *text.lines, "  ret void", "out:", "  ret void", "}"])

    def _end_of_block(self) -> None:
        lines = self.text.lines
        if len(lines) > BLOCK * (self._blocks + 1):
            self._blocks = len(lines) // BLOCK
            label = f"block{self._blocks}"
            lines += [f"  br i1 %never, label %out, label %{label}", f"{label}:"]

    # --- coefficients in memory and in registers

    def _hi(self, n: int, k: int) -> str:
        return self._recent.get((n, k, 0)) or self.text.load(self.room.high(n, k))

    def _lo(self, n: int, k: int) -> str:
        return self._recent.get((n, k, 1)) or self.text.load(self.room.low(n, k))

    def _value(self, n: int, k: int) -> Wide:
        """Coefficient k of node n: (hi, lo) up to the order ``wide``, then (float, "")."""
        return self._hi(n, k), self._lo(n, k) if k <= self.wide else ""

    def _put(self, n: int, k: int, x: Wide) -> None:
        room, text, newest = self.room, self.text, x
        if x[1]:
            # float coefficients of higher orders use high parts only; renormalize, or cancellation would leave them
            # inaccurate
            x = fast_two_sum(text, *x)
        if k == 0:
            newest = x
        if room.has(n, k):
            text.store(x[0], room.high(n, k))
            if x[1] and k <= self.wide:
                text.store(x[1], room.low(n, k))
        # the next operations use the value before it is renormalized, and so do not wait
        self._recent[n, k, 0] = newest[0]
        if x[1]:
            self._recent[n, k, 1] = newest[1]
        if k < self.order:
            self._copy(n, k, x)

    def _copy(self, n: int, k: int, x: Wide) -> None:
        for base, width, slot in self.room.copies.get(n, ()):
            self.text.store(x[0], base + k * width + slot)
            if x[1] and k <= self.wide:
                self.text.store(x[1], base + (self.order + 1 + k) * width + slot)

    # --- one node

    def _node(self, n: int, k: int) -> Wide:
        kind, p, q = self.tape.kinds[n], self.tape.left[n], self.tape.right[n]
        if kind in (SUM, DIFFERENCE):
            return self._sum(kind, p, q, k)
        if kind == MULTIPLE:
            return self._times(self._value(p, 0), self._value(q, k), k)
        if kind == PRODUCT:
            return self._convolved(n, 0, k + 1, k) or (self.text.real(0.0), "")
        if k == 0:
            x = self._value(p, 0)
            if self.wide < 0:
                return (self.text.fsqrt(x[0]) if kind == ROOT else self.text.fdiv(x[0], self._hi(q, 0))), ""
            return square_root(self.text, *x) if kind == ROOT else quotient(self.text, *x, *self._value(q, 0))
        rest = self._convolved(n, 1 if kind == ROOT else 0, k, k) if n in self.room.factors else None
        top = None if self._constant(p) else self._value(p, k)
        if rest is not None:
            minus = (self.text.fneg(rest[0]), self.text.fneg(rest[1]) if rest[1] else "")
            top = minus if top is None else self._plus(top, minus)
        # the coefficients of a constant beyond order 0 are 0
        nothing = self.text.real(0.0)
        return self._times(top or (nothing, nothing), self._divisor(n, k), k)

    def _constant(self, n: int) -> bool:
        return self.tape.kinds[n] == CONSTANT

    def _sum(self, kind: int, p: int, q: int, k: int) -> Wide:
        if k and self._constant(q):
            return self._value(p, k)
        y = self._value(q, k)
        if kind == DIFFERENCE:
            y = self.text.fneg(y[0]), self.text.fneg(y[1]) if y[1] else ""
        return y if k and self._constant(p) else self._plus(self._value(p, k), y)

    def _plus(self, x: Wide, y: Wide) -> Wide:
        return self.text.wide_sum(x, y) if x[1] and y[1] else (self.text.fadd(x[0], y[0]), "")

    def _times(self, x: Wide, y: Wide, k: int) -> Wide:
        return self.text.wide_product(x, y) if k <= self.wide else (self.text.fmul(x[0], y[0]), "")

    def _divisor(self, n: int, k: int) -> Wide:
        """The reciprocal of the divisor's coefficient of order 0; for a root, of twice the root's."""
        if n not in self._divisors:
            place = self.room.inverses[n]
            self._divisors[n] = self.text.load(place), self.text.load(place + 1) if k <= self.wide else ""
        return self._divisors[n]

    def _put_inverse(self, n: int) -> None:
        text = self.text
        root = self.tape.kinds[n] == ROOT
        x = self._value(n if root else self.tape.right[n], 0)
        found = reciprocal(text, *x) if x[1] else (text.fdiv(text.one, x[0]), "")
        for i, part in enumerate(found):
            if part:
                text.store(text.fmul(text.real(0.5), part) if root else part, self.room.inverses[n] + i)

    def _integrated(self, rate: Wide, k: int) -> Wide:
        """Coefficient k + 1 of a variable, from coefficient k of its derivative."""
        room = self.room
        unit = self.text.load(UNITS + k)
        if k + 1 > self.wide:
            return self.text.fmul(rate[0], unit), ""
        if (k + 1) & k == 0:
            # k + 1 is a power of two, so that unit/(k + 1) has no low part
            return self.text.fmul(rate[0], unit), self.text.fmul(rate[1], unit)
        return self.text.wide_product(rate, (unit, self.text.load(room.lows_of_units + k)))

    # --- sums of products

    def _convolved(self, n: int, begin: int, end: int, k: int) -> Wide | None:
        """Σ p_j q_{k−j} over begin ≤ j < end, for the factors p, q of a node; None for an empty sum."""
        p, q = self.room.factors[n]
        terms, before = _terms(p == q, begin, end, k), None
        if n in self.room.pack_of:
            before = self._sum_of_earlier(n, k)
            terms = [term for term in terms if not all(term[1:])]
        pairs = [(f, self._value(p, i), self._value(q, j)) for f, i, j in terms]
        if before and not before[1]:
            # doubling a factor keeps all terms in one sum; the newest term waits for no other
            pairs = [(1, (self.text.fadd(x[0], x[0]), "") if f == 2 else x, y) for f, x, y in pairs]
        return _summed(self.text, pairs, k <= self.wide, before) if pairs or before else None

    def _sum_of_earlier(self, n: int, k: int) -> Wide | None:
        """Σ p_j q_{k−j} over 0 < j < k, for the factors of a node, computed in one vector with those of other nodes."""
        if k > 1 and n not in self._sums:
            nodes = self.room.pack_of[n]
            text = Text(self.room.lanes * self.room.packs[nodes], self.text)
            self._sums |= self._apart(
                text, nodes, self._products(text, nodes, _terms(len(self.room.sides[nodes]) == 1, 1, k, k), k)
            )
        return self._sums.get(n)

    def _group(self, nodes: tuple[int, ...], k: int) -> dict[int, Wide]:
        """The coefficients k of several products, computed in one vector."""
        text = Text(self.room.lanes * len(nodes), self.text)
        if nodes in self.room.sides:
            return self._apart(
                text, nodes, self._products(text, nodes, _terms(len(self.room.sides[nodes]) == 1, 0, k + 1, k), k)
            )
        sums = [self._sum_of_earlier(n, k) for n in nodes]
        before = None
        if k > 1:
            before = self._joined(text, [x[0] for x in sums if x]), self._joined(text, [x[1] for x in sums if x])
        factors = [[self.room.factors[n][side] for n in nodes] for side in (0, 1)]
        pairs = []
        for _, i, j in _terms(False, 0, 1, k) + (_terms(False, k, k + 1, k) if k else []):
            x, y = (
                (self._joined(text, [self._hi(n, o) for n in side]), self._joined(text, [self._lo(n, o) for n in side]))
                for side, o in zip(factors, (i, j), strict=True)
            )
            pairs.append((1, x, y))
        return self._apart(text, nodes, _summed(text, pairs, True, before))

    def _joined(self, text: Text, parts: list[str]) -> str:
        return joined_lanes(text, parts, self.room.lanes)

    def _products(self, text: Text, nodes: tuple[int, ...], terms: Sequence[Term], k: int) -> Wide:
        """The sums of several products in one vector; their factors are contiguous in memory."""
        sides, wide = self.room.sides[nodes], k <= self.wide
        pairs = []
        for f, i, j in terms:
            x, y = (
                (self._fetched(text, side, order, 0), self._fetched(text, side, order, 1) if wide else "")
                for side, order in ((sides[0], i), (sides[-1], j))
            )
            pairs.append((f, x, y))
        return _summed(text, pairs, wide, None)

    def _apart(self, text: Text, nodes: tuple[int, ...], x: Wide) -> dict[int, Wide]:
        return {n: (self._part(text, x[0], i), self._part(text, x[1], i)) for i, n in enumerate(nodes)}

    def _part(self, text: Text, x: str, slot: int) -> str:
        """The number in slot ``slot`` of a vector of several numbers."""
        if not x:
            return ""
        kind, lanes = text.types.double, self.room.lanes
        if lanes == 1:
            return text.write(f"extractelement {kind} {x}, i32 {slot}")
        places = ", ".join(f"i32 {slot * lanes + i}" for i in range(lanes))
        return text.write(f"shufflevector {kind} {x}, {kind} undef, <{lanes} x i32> <{places}>")

    def _fetched(self, text: Text, side: tuple[tuple[int, ...], int], k: int, low: int) -> str:
        """Coefficients k of the factors on one side of a group, as one vector."""
        factors, base = side
        count = text.lanes // self.room.lanes
        if all((n, k, low) in self._recent for n in factors):
            key = base, k, low
            if key not in self._built:
                parts = [self._recent[n, k, low] for n in factors]
                self._built[key] = joined_lanes(text, parts, self.room.lanes)
            return self._built[key]
        place = base + (low * (self.order + 1) + k) * count
        return text.load(place // count)

    def _put_ratios(self) -> None:
        """Stores the largest ratio of the last two, and of the first two float, coefficients to the variable's size."""
        last, several = self.order, chunks(self._shown)
        orders = [last - 1, last, self.wide + 1, self.wide + 2]
        for first, width in several:
            text = Text(self.room.lanes * width, self.text)

            def at(k: int, first: int = first, width: int = width, text: Text = text) -> str:
                return text.fabs(text.load(self.room.high(first, k) // width))

            near = [at(k) for k in range(FIRST)]
            size = near[0]
            for x in near[1:]:
                size = text.larger(x, size)
            over = text.fdiv(text.one, text.larger(size, text.real(1e-300)))
            found = [text.fmul(at(k), over) for k in orders] + [text.larger(near[3], near[2])]
            for m, x in enumerate(found):
                best = ""
                for slot in range(width):
                    part = self._part(text, x, slot)
                    best = self.text.larger(part, best) if best else part
                if first:
                    best = self.text.larger(best, self.text.load(RATIOS + m))
                self.text.store(best, RATIOS + m)


def _terms(square: bool, begin: int, end: int, k: int) -> list[Term]:
    """The terms of Σ p_j q_{k−j} over begin ≤ j < end; the one with the newest coefficients comes last."""
    if not square:
        found = [(1, j, k - j) for j in range(begin, end)]
    else:
        found = [(2, j, k - j) for j in range(begin, (k + 1) // 2) if k - j < end]
        if k % 2 == 0 and begin <= k // 2 < end:
            found.append((1, k // 2, k // 2))
    return sorted(found, key=lambda term: max(term[1:]))


def _summed(text: Text, pairs: Sequence[tuple[int, Wide, Wide]], wide: bool, before: Wide | None) -> Wide:
    """``before`` + Σ factor·x·y; terms of factor 2 are summed apart and doubled once."""
    twice = [(x, y) for f, x, y in pairs if f == 2]
    once = [(x, y) for f, x, y in pairs if f == 1]
    if wide:
        total = _wide_total(text, twice, None) if twice else None
        if total is not None:
            total = text.fadd(total[0], total[0]), text.fadd(total[1], total[1])
        if before is not None:
            total = before if total is None else text.wide_sum(before, total)
        return _wide_total(text, once, total)
    half, rest = _total(text, twice, ""), _total(text, once, before[0] if before else "")
    if not half:
        return rest, ""
    return (text.fma(half, text.real(2.0), rest) if rest else text.fadd(half, half)), ""


def _wide_total(text: Text, pairs: Sequence[tuple[Wide, Wide]], total: Wide | None) -> Wide:
    for x, y in pairs:
        p, e = two_product(text, x[0], y[0])
        e = text.fma(x[1], y[0], text.fma(x[0], y[1], e))
        if total is None:
            total = p, e
        else:
            s, f = two_sum(text, total[0], p)
            total = s, text.fadd(total[1], text.fadd(e, f))
    assert total is not None
    return total


def _total(text: Text, pairs: Sequence[tuple[Wide, Wide]], before: str) -> str:
    """``before`` + Σ x·y in floats, as two partial sums that run in parallel."""
    sums: list[str] = [before] if before else []
    for i, ((x, _), (y, _)) in enumerate(pairs):
        if len(sums) < min(2, max(1, len(pairs) // 2)):
            sums.append(text.fmul(x, y))
        else:
            m = i % len(sums)
            sums[m] = text.fma(x, y, sums[m])
    return text.fadd(*sums) if len(sums) == 2 else sums[0] if sums else ""
