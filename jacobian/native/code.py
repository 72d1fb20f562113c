"""LLVM instructions as text: the instructions of one function in order, and the functions of double-double numbers."""

from __future__ import annotations

import struct
from typing import NamedTuple

from jacobian.numbers.double_double_steps import FUNCTIONS

ONE, ZERO = "1.0", "0.0"
# LANES rounds of a loop run together in SIMD lanes (:func:`jacobian.numbers.abreast.abreast`)
LANES = 8


class Types(NamedTuple):
    """LLVM's types for a float, an integer and a bit, or for vectors with ``lanes`` of each, and suffixes of function
    names.
    """

    double: str
    word: str
    bit: str
    suffix: str
    mark: str
    lanes: int


SINGLE = Types("double", "i64", "i1", "f64", "", 1)


def types_in(n: int) -> Types:
    if n == 1:
        return SINGLE
    double, word, bit = (f"<{n} x {leaf}>" for leaf in SINGLE[:3])
    return Types(double, word, bit, f"v{n}f64", f".abreast{n}", n)


ABREAST = types_in(LANES)


def repeated(leaf: str, literal: str, lanes: int) -> str:
    """A vector constant with the same literal in every lane."""
    return f"<{', '.join([f'{leaf} {literal}'] * lanes)}>"


def constant(x: float) -> str:
    """The text of a float in LLVM's hexadecimal notation, which is exact."""
    return "0x" + struct.pack(">d", x).hex().upper()


class Code:
    """The instructions of one function. ``slots`` allocate its stack memory and come before ``lines``.

    ``types`` are the current LLVM types of floats, integers and bits.
    """

    def __init__(self, types: Types = SINGLE) -> None:
        self.types = types
        self.lines: list[str] = []
        self.slots: list[str] = []
        self._count = 0

    def fresh(self) -> str:
        self._count += 1
        return f"%x{self._count}"

    def write(self, text: str) -> str:
        """Appends an instruction with a result; returns the result's name."""
        name = self.fresh()
        self.lines.append(f"  {name} = {text}")
        return name

    def literal(self, leaf: str, text: str) -> str:
        """A constant of the current type: a scalar, or a vector with the same value in every lane."""
        return text if self.types is SINGLE else repeated(leaf, text, self.types.lanes)

    @property
    def one(self) -> str:
        return self.literal("double", ONE)

    def slot(self, leaf: str) -> str:
        """Allocates stack memory for a scalar; returns the name of its pointer."""
        name = self.fresh()
        self.slots.append(f"  {name} = alloca {leaf}")
        return name

    def fadd(self, x: str, y: str) -> str:
        return self.write(f"fadd {self.types.double} {x}, {y}")

    def fsub(self, x: str, y: str) -> str:
        return self.write(f"fsub {self.types.double} {x}, {y}")

    def fmul(self, x: str, y: str) -> str:
        return self.write(f"fmul {self.types.double} {x}, {y}")

    def fdiv(self, x: str, y: str) -> str:
        return self.write(f"fdiv {self.types.double} {x}, {y}")

    def fneg(self, x: str) -> str:
        return self.write(f"fneg {self.types.double} {x}")

    def fma(self, x: str, y: str, z: str) -> str:
        return self.intrinsic("fma", x, y, z)

    def fsqrt(self, x: str) -> str:
        return self.intrinsic("sqrt", x)

    def intrinsic(self, name: str, *arguments: str) -> str:
        """Writes a call of LLVM's function ``name`` of floats; returns the result's name."""
        double = self.types.double
        given = ", ".join(f"{double} {x}" for x in arguments)
        return self.write(f"call {double} @llvm.{name}.{self.types.suffix}({given})")

    def unless_zero(self, x: str, y: str) -> str:
        """y if x ≠ 0, and x itself if x = 0."""
        double, bit = self.types.double, self.types.bit
        zero = self.write(f"fcmp oeq {double} {x}, {self.literal('double', ZERO)}")
        return self.write(f"select {bit} {zero}, {double} {x}, {double} {y}")


def wide_functions() -> str:
    """The text of the :data:`~jacobian.numbers.double_double_steps.FUNCTIONS` of double-doubles, for scalars and for
    SIMD lanes.
    """
    texts = []
    for types in (SINGLE, ABREAST):
        double, pairs = types.double, f"{{{types.double}, {types.double}}}"
        for name, (emit, count) in FUNCTIONS.items():
            code = Code(types)
            high, low = emit(code, *(f"%a{i}" for i in range(count)))
            pair = code.write(f"insertvalue {pairs} undef, {double} {high}, 0")
            pair = code.write(f"insertvalue {pairs} {pair}, {double} {low}, 1")
            arguments = ", ".join(f"{double} %a{i}" for i in range(count))
            head = f"define internal {pairs} @wide.{name}{types.mark}({arguments}) noinline nounwind"
            texts.append("\n".join([f"{head} {{", *code.lines, f"  ret {pairs} {pair}", "}"]))
    return "\n".join(texts)
