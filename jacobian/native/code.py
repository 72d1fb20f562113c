"""LLVM's instructions as text: a function's, one after the other, and those of double-double numbers.

With u = 2^-53 the relative errors of double-doubles are, barring underflow and overflow: sum 3u² + 13u³, product 4u²,
quotient 9.8u² (Joldes, Muller & Popescu 2017, algorithms 6, 12, 18; with a float 4, 9, 15: 2u², 2u², 3u²; the bound of
the product from Muller & Rideau 2022), root 25u²/8 (Lefèvre, Louvet, Muller, Picot & Rideau 2023, algorithm
SQRTDWtoDW). The error-free sums and product are Knuth's (two_sum), Dekker's and that of fused multiplication (Hida, Li
& Bailey 2001). No instruction here carries a fast-math flag, which would take the error terms for zero.
"""

from __future__ import annotations

import struct
from typing import Any

Pair = tuple[str, str]
ONE, ZERO = "1.0", "0.0"


def constant(x: float) -> str:
    """A float as LLVM reads it, to the last bit."""
    return "0x" + struct.pack(">d", x).hex().upper()


class Code:
    """Instructions of one function: ``lines``, in the order in which they are written, and ``slots`` before them."""

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


# --- double-doubles -------------------------------------------------------------------------------------------------


def two_sum(b: Code, x: str, y: str) -> Pair:
    """x + y and its error, exactly."""
    s = b.fadd(x, y)
    z = b.fsub(s, x)
    return s, b.fadd(b.fsub(x, b.fsub(s, z)), b.fsub(y, z))


def fast_two_sum(b: Code, x: str, y: str) -> Pair:
    """The same for |x| ≥ |y| or x = 0."""
    s = b.fadd(x, y)
    return s, b.fsub(y, b.fsub(s, x))


def two_product(b: Code, x: str, y: str) -> Pair:
    """x·y and its error, exactly."""
    p = b.fmul(x, y)
    return p, b.fma(x, y, b.fneg(p))


def total(b: Code, xh: str, xl: str, yh: str, yl: str) -> Pair:
    """x + y."""
    sh, sl = two_sum(b, xh, yh)
    th, tl = two_sum(b, xl, yl)
    vh, vl = fast_two_sum(b, sh, b.fadd(sl, th))
    return fast_two_sum(b, vh, b.fadd(tl, vl))


def total_float(b: Code, xh: str, xl: str, y: str) -> Pair:
    """x + y of a float y."""
    sh, sl = two_sum(b, xh, y)
    return fast_two_sum(b, sh, b.fadd(xl, sl))


def product(b: Code, xh: str, xl: str, yh: str, yl: str) -> Pair:
    """x·y."""
    ch, c1 = two_product(b, xh, yh)
    c2 = b.fma(xl, yh, b.fma(xh, yl, b.fmul(xl, yl)))
    return fast_two_sum(b, ch, b.fadd(c1, c2))


def product_float(b: Code, xh: str, xl: str, y: str) -> Pair:
    """x·y of a float y."""
    ch, cl = two_product(b, xh, y)
    return fast_two_sum(b, ch, b.fma(xl, y, cl))


def reciprocal(b: Code, yh: str, yl: str) -> Pair:
    """1/y."""
    th = b.fdiv(ONE, yh)
    rest = b.fma(b.fneg(yh), th, ONE)
    eh, el = fast_two_sum(b, rest, b.fneg(b.fmul(yl, th)))
    dh, dl = product_float(b, eh, el, th)
    return total_float(b, dh, dl, th)


def quotient(b: Code, xh: str, xl: str, yh: str, yl: str) -> Pair:
    """x/y."""
    return product(b, *reciprocal(b, yh, yl), xh, xl)


def quotient_of_float(b: Code, yh: str, yl: str, x: str) -> Pair:
    """x/y of a float x."""
    return product_float(b, *reciprocal(b, yh, yl), x)


def quotient_by_float(b: Code, xh: str, xl: str, y: str) -> Pair:
    """x/y of a float y."""
    th = b.fdiv(xh, y)
    ph, pl = two_product(b, th, y)
    rest = b.fadd(b.fsub(b.fsub(xh, ph), pl), xl)
    return fast_two_sum(b, th, b.fdiv(rest, y))


def square_root(b: Code, xh: str, xl: str) -> Pair:
    """√x."""
    sh = b.write(f"call double @llvm.sqrt.f64(double {xh})")
    rest = b.fadd(xl, b.fma(b.fneg(sh), sh, xh))
    sl = b.fdiv(rest, b.fadd(sh, sh))
    zero = b.write(f"fcmp oeq double {xh}, {ZERO}")
    return fast_two_sum(b, sh, b.write(f"select i1 {zero}, double {xh}, double {sl}"))


WIDE_FUNCTIONS: dict[str, tuple[Any, int]] = {
    "sum": (total, 4),
    "sum_float": (total_float, 3),
    "product": (product, 4),
    "product_float": (product_float, 3),
    "quotient": (quotient, 4),
    "quotient_of_float": (quotient_of_float, 3),
    "quotient_by_float": (quotient_by_float, 3),
    "root": (square_root, 2),
}
"""How they are called in a module, and how many floats they take."""


def wide_functions() -> str:
    """The functions of double-doubles as a module has them.

    Not inlined: an addition of divisors calls some 600 of them, and compiling it would take twice as long for a few per
    cent of its time.
    """
    texts = []
    for name, (emit, count) in WIDE_FUNCTIONS.items():
        code = Code()
        high, low = emit(code, *(f"%a{i}" for i in range(count)))
        pair = code.write(f"insertvalue {{double, double}} undef, double {high}, 0")
        pair = code.write(f"insertvalue {{double, double}} {pair}, double {low}, 1")
        arguments = ", ".join(f"double %a{i}" for i in range(count))
        head = f"define internal {{double, double}} @wide.{name}({arguments}) noinline nounwind"
        texts.append("\n".join([f"{head} {{", *code.lines, f"  ret {{double, double}} {pair}", "}"]))
    return "\n".join(texts)
