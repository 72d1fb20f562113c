"""Operators and builtin functions on values of compiled loops."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from jacobian.native.code import ZERO, Code, constant
from jacobian.native.kinds import (
    BOOL,
    FLOAT,
    INT,
    WIDE,
    CompileError,
    TupleKind,
    Value,
    is_number,
    meeting,
)  # fmt: skip

ARITHMETIC = {"Add": "add", "Sub": "sub", "Mult": "mul"}
BITS = {"LShift": "shl", "RShift": "ashr", "BitAnd": "and", "BitOr": "or", "BitXor": "xor"}
FOLDED: dict[str, Callable[[int, int], Any]] = {
    "Add": lambda x, y: x + y, "Sub": lambda x, y: x - y, "Mult": lambda x, y: x * y, "Pow": lambda x, y: x**y,
    "FloorDiv": lambda x, y: x // y, "Mod": lambda x, y: x % y, "LShift": lambda x, y: x << y,
    "BitAnd": lambda x, y: x & y,
}  # fmt: skip
RELATIONS = {"Lt": ("olt", "slt"), "LtE": ("ole", "sle"), "Gt": ("ogt", "sgt"), "GtE": ("oge", "sge"),
             "Eq": ("oeq", "eq"), "NotEq": ("une", "ne")}  # fmt: skip


def integer(n: int) -> Value:
    """One known while compiling."""
    return Value(INT, (str(n),))


def real(x: float) -> Value:
    """A float known while compiling."""
    return Value(FLOAT, (constant(x),))


class Operators(Code):
    """Instructions with kinds: ``contract`` is the fast-math flag of floats, as LLVM writes it."""

    def __init__(self, contract: str) -> None:
        super().__init__()
        self.contract = contract

    def cast(self, value: Value, kind: Any) -> Value:
        """The value in a kind that its own meets in."""
        if value.kind == kind:
            return value
        if isinstance(kind, TupleKind) and isinstance(value.kind, TupleKind):
            items = [self.cast(value.item(i), item) for i, item in enumerate(kind.items)]
            return Value(kind, tuple(part for item in items for part in item.parts))
        if not (is_number(value.kind) and is_number(kind)):
            raise CompileError(f"{value.kind} for {kind}")
        if kind is INT:
            return Value(INT, (self.write(f"zext i1 {value.parts[0]} to i64"),))
        if value.kind in (INT, BOOL):
            if value.is_known:
                high = constant(float(int(value.parts[0])))
            else:
                high = self.write(f"{'sitofp' if value.kind is INT else 'uitofp'} {value.kind.leaves[0]} "
                                  f"{value.parts[0]} to double")  # fmt: skip
            value = Value(FLOAT, (high,))
        return value if kind is FLOAT else Value(WIDE, (value.parts[0], ZERO))

    def float_of(self, value: Value) -> str:
        """The operand of a float, an integer or the high part of a double-double."""
        return str(value.parts[0] if value.kind is WIDE else self.cast(value, FLOAT).parts[0])

    def truth(self, value: Value) -> str:
        """Whether it is not zero, as an i1."""
        if value.kind is BOOL:
            return str(value.parts[0])
        return str(self.compare("NotEq", value, integer(0)).parts[0])

    def wide(self, name: str, parts: tuple[Any, ...]) -> Value:
        """A call of one of :data:`jacobian.numbers.double_double_steps.FUNCTIONS`."""
        arguments = ", ".join(f"double {part}" for part in parts)
        pair = self.write(f"call {{double, double}} @wide.{name}({arguments})")
        return Value(WIDE, tuple(self.write(f"extractvalue {{double, double}} {pair}, {k}") for k in range(2)))

    def negative(self, x: Value) -> Value:
        """−x."""
        if x.kind is INT:
            return integer(-x.known()) if x.is_known else Value(INT, (self.write(f"sub i64 0, {x.parts[0]}"),))
        return Value(x.kind, tuple(self.fneg(part) for part in x.parts))

    def binary(self, name: str, x: Value, y: Value) -> Value:
        """x and y under the operator of that class of ``ast``."""
        if isinstance(x.kind, TupleKind) and isinstance(y.kind, TupleKind) and name == "Add":
            return Value(TupleKind(x.kind.items + y.kind.items), x.parts + y.parts)
        if not (is_number(x.kind) and is_number(y.kind)):
            raise CompileError(f"{name} of {x.kind} and {y.kind}")
        if x.is_known and y.is_known and name in FOLDED and not (name == "Pow" and y.known() < 0):
            return integer(FOLDED[name](x.known(), y.known()))
        if WIDE in (x.kind, y.kind):
            return self.wide_binary(name, x, y)
        if name == "Div" or FLOAT in (x.kind, y.kind):
            return Value(FLOAT, (self.float_binary(name, self.float_of(x), self.float_of(y)),))
        return Value(INT, (self.int_binary(name, self.cast(x, INT).parts[0], self.cast(y, INT).parts[0]),))

    def wide_binary(self, name: str, x: Value, y: Value) -> Value:
        """The same where one is a double-double; integers count as floats, exact up to 2^53."""
        if name == "Sub":
            name, y = "Add", self.negative(y)
        if name in ("Add", "Mult"):
            if x.kind is not WIDE:
                x, y = y, x
            called = {"Add": "sum", "Mult": "product"}[name]
            if y.kind is WIDE:
                return self.wide(called, x.parts + y.parts)
            return self.wide(f"{called}_float", (*x.parts, self.float_of(y)))
        if name != "Div":
            raise CompileError(f"{name} of double-doubles")
        if x.kind is not WIDE:
            return self.wide("quotient_of_float", (*y.parts, self.float_of(x)))
        if y.kind is not WIDE:
            return self.wide("quotient_by_float", (*x.parts, self.float_of(y)))
        return self.wide("quotient", x.parts + y.parts)

    def float_binary(self, name: str, x: str, y: str) -> str:
        """The same of floats."""
        if name == "Pow":
            return self.write(f"call double @llvm.pow.f64(double {x}, double {y})")
        operation = {"Add": "fadd", "Sub": "fsub", "Mult": "fmul", "Div": "fdiv"}.get(name)
        if operation is None:
            raise CompileError(f"{name} of floats")
        return self.write(f"{operation} {self.contract} double {x}, {y}")

    def int_binary(self, name: str, x: str, y: str) -> str:
        """The same of integers; quotients are rounded down."""
        if name in ARITHMETIC:
            # what leaves 64 bits is no index: loops over indices are made vectors then
            return self.write(f"{ARITHMETIC[name]} nsw i64 {x}, {y}")
        if name in BITS:
            return self.write(f"{BITS[name]} i64 {x}, {y}")
        if name not in ("FloorDiv", "Mod"):
            raise CompileError(f"{name} of integers")
        rest = self.write(f"srem i64 {x}, {y}")
        signs = self.write(f"xor i64 {rest}, {y}")
        below = self.write(f"icmp slt i64 {signs}, 0")
        some = self.write(f"icmp ne i64 {rest}, 0")
        off = self.write(f"and i1 {below}, {some}")
        if name == "Mod":
            more = self.write(f"select i1 {off}, i64 {y}, i64 0")
            return self.write(f"add i64 {rest}, {more}")
        quotient, less = self.write(f"sdiv i64 {x}, {y}"), self.write(f"zext i1 {off} to i64")
        return self.write(f"sub i64 {quotient}, {less}")

    def compare(self, name: str, x: Value, y: Value) -> Value:
        """Whether the relation holds."""
        kind = meeting(x.kind, y.kind)
        if not is_number(kind) or name not in RELATIONS:
            raise CompileError(f"{name} of {x.kind} and {y.kind}")
        x, y = self.cast(x, kind), self.cast(y, kind)
        of_floats, of_integers = RELATIONS[name]
        if kind is not WIDE:
            relation = f"fcmp {of_floats} double" if kind is FLOAT else f"icmp {of_integers} {kind.leaves[0]}"
            return Value(BOOL, (self.write(f"{relation} {x.parts[0]}, {y.parts[0]}"),))
        strict = {"ole": "olt", "oge": "ogt"}.get(of_floats, of_floats)
        first = self.write(f"fcmp {strict} double {x.parts[0]}, {y.parts[0]}")
        second = self.write(f"fcmp {of_floats} double {x.parts[1]}, {y.parts[1]}")
        if name in ("Eq", "NotEq"):
            return Value(BOOL, (self.write(f"{'and' if name == 'Eq' else 'or'} i1 {first}, {second}"),))
        same = self.write(f"fcmp oeq double {x.parts[0]}, {y.parts[0]}")
        both = self.write(f"and i1 {same}, {second}")
        return Value(BOOL, (self.write(f"or i1 {first}, {both}"),))

    def chosen(self, condition: str, x: Value, y: Value) -> Value:
        """x where the i1 holds, else y: both are computed."""
        parts = tuple(
            p if p == q else self.write(f"select i1 {condition}, {leaf} {p}, {leaf} {q}")
            for leaf, p, q in zip(x.kind.leaves, x.parts, y.parts, strict=True)
        )
        return Value(x.kind, parts)

    # --- builtin functions

    def extremum(self, relation: str, values: list[Value]) -> Value:
        """The first of the least or the largest."""
        kind = values[0].kind
        for value in values:
            kind = meeting(kind, value.kind)
        best = self.cast(values[0], kind)
        for value in values[1:]:
            value = self.cast(value, kind)
            best = self.chosen(self.compare(relation, value, best).parts[0], value, best)
        return best

    def absolute(self, x: Value) -> Value:
        """|x|."""
        if x.kind is FLOAT:
            return Value(FLOAT, (self.write(f"call double @llvm.fabs.f64(double {x.parts[0]})"),))
        head = Value(FLOAT, x.parts[:1]) if x.kind is WIDE else x
        return self.chosen(self.compare("Lt", head, integer(0)).parts[0], self.negative(x), x)

    def root(self, x: Value) -> Value:
        """√x."""
        return self.wide("root", x.parts) if x.kind is WIDE else self.function("sqrt", x)

    def function(self, name: str, x: Value) -> Value:
        """One of LLVM's functions of a float."""
        return Value(FLOAT, (self.write(f"call double @llvm.{name}.f64(double {self.float_of(x)})"),))

    def whole(self, x: Value) -> Value:
        """The float cut to an integer; not-a-number becomes 0."""
        if x.kind in (INT, BOOL):
            return self.cast(x, INT)
        return Value(INT, (self.write(f"call i64 @llvm.fptosi.sat.i64.f64(double {self.float_of(x)})"),))

    def frexp(self, x: Value) -> Value:
        """(mantissa, exponent)."""
        slot = self.slot("i32")
        mantissa = self.write(f"call double @frexp(double {self.float_of(x)}, ptr {slot})")
        exponent = self.write(f"load i32, ptr {slot}")
        return Value(TupleKind((FLOAT, INT)), (mantissa, self.write(f"sext i32 {exponent} to i64")))

    def ldexp(self, x: Value, n: Value) -> Value:
        """x·2^n."""
        exponent = self.write(f"trunc i64 {self.cast(n, INT).parts[0]} to i32")
        return Value(FLOAT, (self.write(f"call double @ldexp(double {self.float_of(x)}, i32 {exponent})"),))


def length(b: Operators, x: Value) -> Value:
    """len(x)."""
    return integer(len(x.kind.items)) if isinstance(x.kind, TupleKind) else Value(INT, (x.parts[1],))


# what compiled loops may call besides functions that are compiled
BUILTINS: dict[Any, Callable[..., Value]] = {
    len: length,
    abs: Operators.absolute,
    float: lambda b, x: Value(FLOAT, (b.float_of(x),)),
    int: Operators.whole,
    bool: lambda b, x: Value(BOOL, (b.truth(x),)),
    max: lambda b, *xs: b.extremum("Gt", list(xs)),
    min: lambda b, *xs: b.extremum("Lt", list(xs)),
    math.floor: lambda b, x: x if x.kind is INT else b.whole(b.function("floor", x)),
    math.ceil: lambda b, x: x if x.kind is INT else b.whole(b.function("ceil", x)),
    math.sqrt: lambda b, x: b.function("sqrt", x),
    math.frexp: Operators.frexp,
    math.ldexp: Operators.ldexp,
    **{getattr(math, name): (lambda b, x, n=name: b.function(n, x)) for name in ("sin", "cos", "log", "log2", "exp")},
}
# their declarations, as a module has them
DECLARED = "\n".join(
    [
        *(f"declare double @llvm.{name}.f64(double)" for name in (
            "sqrt", "fabs", "floor", "ceil", "sin", "cos", "log", "log2", "exp",
        )),
        "declare double @llvm.fma.f64(double, double, double)",
        "declare double @llvm.pow.f64(double, double)",
        "declare i64 @llvm.fptosi.sat.i64.f64(double)",
        "declare double @frexp(double, ptr)",
        "declare double @ldexp(double, i32)",
    ]
)  # fmt: skip
