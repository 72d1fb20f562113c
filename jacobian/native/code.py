"""LLVM's instructions as text: a function's, one after the other, and those of double-double numbers."""

from __future__ import annotations

import struct

from jacobian.numbers.double_double_steps import FUNCTIONS

ONE, ZERO = "1.0", "0.0"


def constant(x: float) -> str:
    """A float as LLVM reads it, to the last bit."""
    return "0x" + struct.pack(">d", x).hex().upper()


class Code:
    """Instructions of one function: ``lines``, in the order in which they are written, and ``slots`` before them."""

    one = ONE

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.slots: list[str] = []
        self._count = 0

    def fresh(self) -> str:
        """A new name."""
        self._count += 1
        return f"%x{self._count}"

    def write(self, text: str) -> str:
        """An instruction with a result, whose name is returned."""
        name = self.fresh()
        self.lines.append(f"  {name} = {text}")
        return name

    def slot(self, leaf: str) -> str:
        """Room for a scalar."""
        name = self.fresh()
        self.slots.append(f"  {name} = alloca {leaf}")
        return name

    def fadd(self, x: str, y: str) -> str:
        return self.write(f"fadd double {x}, {y}")

    def fsub(self, x: str, y: str) -> str:
        return self.write(f"fsub double {x}, {y}")

    def fmul(self, x: str, y: str) -> str:
        return self.write(f"fmul double {x}, {y}")

    def fdiv(self, x: str, y: str) -> str:
        return self.write(f"fdiv double {x}, {y}")

    def fneg(self, x: str) -> str:
        return self.write(f"fneg double {x}")

    def fma(self, x: str, y: str, z: str) -> str:
        return self.write(f"call double @llvm.fma.f64(double {x}, double {y}, double {z})")

    def fsqrt(self, x: str) -> str:
        return self.write(f"call double @llvm.sqrt.f64(double {x})")

    def unless_zero(self, x: str, y: str) -> str:
        """y, but x where x = 0."""
        zero = self.write(f"fcmp oeq double {x}, {ZERO}")
        return self.write(f"select i1 {zero}, double {x}, double {y}")


def wide_functions() -> str:
    """The :data:`~jacobian.numbers.double_double_steps.FUNCTIONS` of double-doubles as a module has them."""
    texts = []
    for name, (emit, count) in FUNCTIONS.items():
        code = Code()
        high, low = emit(code, *(f"%a{i}" for i in range(count)))
        pair = code.write(f"insertvalue {{double, double}} undef, double {high}, 0")
        pair = code.write(f"insertvalue {{double, double}} {pair}, double {low}, 1")
        arguments = ", ".join(f"double %a{i}" for i in range(count))
        head = f"define internal {{double, double}} @wide.{name}({arguments}) noinline nounwind"
        texts.append("\n".join([f"{head} {{", *code.lines, f"  ret {{double, double}} {pair}", "}"]))
    return "\n".join(texts)
