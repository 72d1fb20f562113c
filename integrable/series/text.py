"""LLVM instructions for straight-line code: memory access, vectors, and double-doubles whose parts may overlap."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count

from jacobian.native.code import Code, constant, types_in
from jacobian.numbers.double_double_steps import two_product, two_sum

Wide = tuple[str, str]
"""The names of the two parts (hi, lo) of a double-double, or (float, "")."""


class Text(Code):
    """Instructions on vectors of ``lanes`` floats. The position n in memory is n such vectors after the pointer %s."""

    def __init__(self, lanes: int, before: Text | None = None) -> None:
        super().__init__(types_in(lanes))
        self.lanes = lanes
        # the instructions are appended to the text ``before``, which may have another vector width
        self._numbers: Iterator[int] = count() if before is None else before._numbers
        self.lines = self.lines if before is None else before.lines

    def fresh(self) -> str:
        return f"%x{next(self._numbers)}"

    def real(self, x: float) -> str:
        """The literal of the constant x, in all lanes."""
        return self.literal("double", constant(x))

    def load(self, place: int, base: str = "%s") -> str:
        there = self.write(f"getelementptr {self.types.double}, ptr {base}, i64 {place}")
        return self.write(f"load {self.types.double}, ptr {there}, align 8")

    def store(self, x: str, place: int, base: str = "%s") -> None:
        there = self.write(f"getelementptr {self.types.double}, ptr {base}, i64 {place}")
        self.lines.append(f"  store {self.types.double} {x}, ptr {there}, align 8")

    def larger(self, x: str, y: str) -> str:
        """The larger of x and y; y if either is NaN."""
        over = self.write(f"fcmp ogt {self.types.double} {x}, {y}")
        return self.write(f"select {self.types.bit} {over}, {self.types.double} {x}, {self.types.double} {y}")

    def fabs(self, x: str) -> str:
        return self.intrinsic("fabs", x)

    def spread(self, x: str) -> str:
        """The scalar x in all lanes."""
        return x if self.lanes == 1 else self.gathered([x] * self.lanes)

    def gathered(self, parts: Sequence[str]) -> str:
        """A vector of the given floats, one per lane."""
        found = "undef"
        for lane, part in enumerate(parts):
            found = self.write(f"insertelement {self.types.double} {found}, double {part}, i32 {lane}")
        return found

    # --- double-doubles, as sums whose parts may overlap. An operand that becomes available late is used last, so that
    # most of the work is done before

    def wide_negative(self, x: Wide) -> Wide:
        return self.fneg(x[0]), self.fneg(x[1]) if x[1] else ""

    def wide_sum(self, x: Wide, y: Wide) -> Wide:
        """x + y of double-doubles; the low part of y, which is computed after that of x, is used last."""
        s, e = two_sum(self, x[0], y[0])
        return s, self.fadd(self.fadd(e, x[1]), y[1])

    def wide_product(self, x: Wide, y: Wide) -> Wide:
        """x·y of double-doubles; the low part of x, which is computed after that of y, is used last."""
        p, e = two_product(self, x[0], y[0])
        return p, self.fma(x[1], y[0], self.fma(x[0], y[1], e))

    def wide_plus_product(self, total: Wide, x: Wide, y: Wide) -> Wide:
        """total + x·y of double-doubles; the low part of x, which is computed last, is used after that of y."""
        p, e = two_product(self, x[0], y[0])
        s, f = two_sum(self, total[0], p)
        return s, self.fadd(total[1], self.fadd(f, self.fma(x[1], y[0], self.fma(x[0], y[1], e))))


def joined_lanes(text: Text, parts: Sequence[str], lanes: int) -> str:
    """The concatenation of vectors of ``lanes`` floats; their number must be a power of two."""
    found = list(parts)
    while len(found) > 1:
        order = ", ".join(f"i32 {i}" for i in range(2 * lanes))
        kind = f"<{lanes} x double>"
        pairs = zip(found[::2], found[1::2], strict=True)
        found = [
            text.write(f"shufflevector {kind} {a}, {kind} {b}, <{2 * lanes} x i32> <{order}>")
            if lanes > 1
            else Text(2, text).gathered((a, b))
            for a, b in pairs
        ]
        lanes *= 2
    return found[0]
