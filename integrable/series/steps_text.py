"""The LLVM text of a Taylor step of a tape: the coefficients of all orders, one after the other.

Coefficients up to the order ``wide`` are double-doubles, higher ones floats. The two walks of
:mod:`integrable.series.walk` are lanes of one vector. Recent values stay in registers, and products of them are added
last, because all other terms of the sum are known one order earlier. The code for low orders has no loop. Higher orders
are computed in a loop, AT_ONCE orders in each round. For a large tape the orders in double-doubles have a loop too.
Without loops the code would exceed the processor's instruction cache, and fetching it would take most of the time.
"""

from __future__ import annotations

from integrable.series.room import FIRST, RATIOS, UNITS, Room
from integrable.series.sums_text import Loop, Sums
from integrable.series.tape import CONSTANT, DIFFERENCE, MULTIPLE, PRODUCT, ROOT, SUM, VARIABLE
from integrable.series.text import Text, Wide
from jacobian.numbers.double_double_steps import quotient, reciprocal, square_root

# lines of a basic block: LLVM's compile time for a block grows with the square of its length
BLOCK = 150


class Series(Sums):
    """The LLVM text that computes a walk's coefficients."""

    def __init__(self, room: Room, count: int) -> None:
        super().__init__(room)
        self._shown = count
        self._begin = next((n for n, kind in enumerate(self.tape.kinds) if kind not in (VARIABLE, CONSTANT)), 0)
        self._divisors: dict[int, Wide] = {}
        self._blocks = 0

    def function(self) -> str:
        """The function; the constants, units of time and coefficients of order 0 must be in memory before its call."""
        text, done = self.text, 0
        for loop in self.loops:
            for k in range(done, loop.begin):
                self._built.clear()
                self._order(k)
            if loop.begin < loop.end:
                self._rounds(loop)
            done = loop.end
        head = "define void @series(ptr noalias %s) nounwind {\nentry:\n  %word = load i64, ptr %s\n"
        # the first word is never −1; the branch that is never taken keeps LLVM from joining the blocks
        head += "  %never = icmp eq i64 %word, -1\n"
        return "\n".join([head, *text.lines, "  ret void", "out:", "  ret void", "}"])

    def _order(self, k: int) -> None:
        """Writes the instructions for coefficients k of all nodes and k + 1 of the variables."""
        tape = self.tape
        self._recent = {key: x for key, x in self._recent.items() if key[1] == k}
        self._divisors, self._sums = {}, {}
        self._put_sides(k, of_variables=True)
        for n in range(self._begin, len(tape.kinds)):
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
        self._put_sides(k, of_variables=False)
        for i in range(self.room.count):
            self._put(i, k + 1, self._integrated(self._value(tape.results[i], k), k))
        self._put_variables(k + 1)

    def _rounds(self, loop: Loop) -> None:
        lines, name = self.text.lines, f"orders{loop.begin}"
        following = f"%{name}_next"
        lines += [f"  br label %{name}_begin", f"{name}_begin:", f"  br label %{name}", f"{name}:"]
        done = self.text.write(f"phi i64 [ 0, %{name}_begin ], [ {following}, %{name}_again ]")
        self._begin_round(loop, done)
        for k in range(loop.begin, loop.begin + loop.at_once):
            self._order(k)
        lines += [f"  br label %{name}_again", f"{name}_again:", f"  {following} = add i64 {done}, {loop.at_once}"]
        more = self.text.write(f"icmp slt i64 {following}, {loop.end - loop.begin}")
        lines += [f"  br i1 {more}, label %{name}, label %{name}_end", f"{name}_end:"]
        self._recent, self._built, self._moving, self._before = {}, {}, {}, {}

    def _end_of_block(self) -> None:
        lines = self.text.lines
        if len(lines) > BLOCK * (self._blocks + 1):
            self._blocks = len(lines) // BLOCK
            label = f"block{self._blocks}"
            lines += [f"  br i1 %never, label %out, label %{label}", f"{label}:"]

    # --- one node

    def _node(self, n: int, k: int) -> Wide:
        kind, p, q = self.tape.kinds[n], self.tape.left[n], self.tape.right[n]
        if kind in (SUM, DIFFERENCE):
            return self._sum(kind, p, q, k)
        if kind == MULTIPLE:
            return self._times(self._value(q, k), self._value(p, 0), k)
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
            minus = self.text.wide_negative(rest)
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
            y = self.text.wide_negative(y)
        if k and self._constant(p):
            return y
        x = self._value(p, k)
        # the node with the larger index is computed later, so it is added last
        return self._plus(x, y) if q >= p else self._plus(y, x)

    def _plus(self, x: Wide, y: Wide) -> Wide:
        """x + y for a y that becomes available after x."""
        return self.text.wide_sum(x, y) if x[1] and y[1] else (self.text.fadd(x[0], y[0]), "")

    def _times(self, x: Wide, y: Wide, k: int) -> Wide:
        """x·y for an x that becomes available after y."""
        return self.text.wide_product(x, y) if k <= self.wide else (self.text.fmul(x[0], y[0]), "")

    def _divisor(self, n: int, k: int) -> Wide:
        """1/d_0 for a quotient by d, and 1/(2r_0) for a root r, by which the recurrences of node n multiply."""
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
        """Coefficient k + 1 of a variable, computed from coefficient k of its derivative."""
        base = self._base(k, 1)
        unit = self.text.load(UNITS + k, base)
        if k + 1 > self.wide:
            # after cancellation both parts overlap, and the high part alone has too few digits
            return self.text.fmul(self.text.fadd(*rate) if rate[1] else rate[0], unit), ""
        if (k + 1) & k == 0 and base == "%s":
            # k + 1 is a power of two, so that unit/(k + 1) has no low part
            return self.text.fmul(rate[0], unit), self.text.fmul(rate[1], unit)
        return self.text.wide_product(rate, (unit, self.text.load(self.room.lows_of_units + k, base)))

    def ratios(self) -> str:
        """The LLVM function that stores five maxima over the variables: of |coefficient|/(size of the variable) at the
        last two orders and at the first two orders in floats, and of the coefficients of orders 2 and 3.
        """
        self.text = Text(self.room.lanes)
        last, several = self.order, self.room.chunks(self._shown)
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
            # a variable that is 0 up to the order 3 does not limit the step; rows are compared by parts of the state
            kind, zero = text.types.double, text.real(0.0)
            some = text.write(f"fcmp ogt {kind} {size}, {zero}")
            over = text.write(f"select {text.types.bit} {some}, {kind} {over}, {kind} {zero}")
            found = [text.fmul(at(k), over) for k in orders] + [text.larger(near[3], near[2])]
            for m, x in enumerate(found):
                best = ""
                for slot in range(width):
                    part = self._part(text, x, slot)
                    best = self.text.larger(part, best) if best else part
                if first:
                    best = self.text.larger(best, self.text.load(RATIOS + m))
                self.text.store(best, RATIOS + m)
        return "\n".join(["define void @ratios(ptr noalias %s) nounwind {", *self.text.lines, "  ret void", "}"])
