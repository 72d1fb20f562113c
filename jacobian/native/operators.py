"""Operators and builtin functions on values of compiled loops."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from functools import wraps
from typing import Any

from jacobian.native import complexes
from jacobian.native.code import ABREAST, LANES, SINGLE, ZERO, Code, constant, repeated
from jacobian.native.kinds import (
    BOOL,
    COMPLEX,
    FLOAT,
    INT,
    LONG,
    WIDE,
    CompileError,
    TupleKind,
    Value,
    abreast,
    is_abreast,
    is_number,
    meeting,
    single,
)  # fmt: skip

ARITHMETIC = {"Add": "add", "Sub": "sub", "Mult": "mul"}
BITS = {"LShift": "shl", "RShift": "ashr", "BitAnd": "and", "BitOr": "or", "BitXor": "xor"}
RELATIONS = {"Lt": ("olt", "slt"), "LtE": ("ole", "sle"), "Gt": ("ogt", "sgt"), "GtE": ("oge", "sge"),
             "Eq": ("oeq", "eq"), "NotEq": ("une", "ne")}  # fmt: skip
FOLDED: dict[str, Callable[[int, int], int]] = {
    "Add": operator.add, "Sub": operator.sub, "Mult": operator.mul, "Pow": operator.pow, "Mod": operator.mod,
    "FloorDiv": operator.floordiv, "LShift": operator.lshift, "BitAnd": operator.and_, "Lt": operator.lt,
    "LtE": operator.le, "Gt": operator.gt, "GtE": operator.ge, "Eq": operator.eq, "NotEq": operator.ne,
}  # fmt: skip
"""The operators and relations that are computed at compile time if both operands are known."""


def integer(n: int) -> Value:
    """An integer known at compile time."""
    return Value(INT, (str(n),))


def real(x: float) -> Value:
    """A float known at compile time."""
    return Value(FLOAT, (constant(x),))


def in_lanes(method: Callable[..., Value]) -> Callable[..., Value]:
    """The method, extended to vector operands: the same instructions act on all lanes."""

    @wraps(method)
    def done(self: Operators, *given: Any) -> Value:
        values = [x for item in given for x in (item if isinstance(item, list) else [item]) if isinstance(x, Value)]
        if not any(is_abreast(x.kind) for x in values):
            return method(self, *given)
        arguments = [
            [self.lanes(x) for x in item] if isinstance(item, list)
            else self.lanes(item) if isinstance(item, Value) else item
            for item in given
        ]  # fmt: skip
        self.types = ABREAST
        try:
            found = method(self, *arguments)
        finally:
            self.types = SINGLE
        return Value(abreast(found.kind), found.parts)

    return done


class Operators(Code):
    """Instructions on typed values. ``contract`` is the text of LLVM's fast-math flag for float operations."""

    def __init__(self, contract: str) -> None:
        super().__init__()
        self.contract = contract

    def cast(self, value: Value, kind: Any) -> Value:
        """The value converted to a kind of the same or a higher ``Kind.rank``."""
        if value.kind == kind:
            return value
        if is_abreast(kind):
            return self.cast_lanes(value, kind)
        if isinstance(kind, TupleKind) and isinstance(value.kind, TupleKind):
            items = [self.cast(value.item(i), item) for i, item in enumerate(kind.items)]
            return Value(kind, tuple(part for item in items for part in item.parts))
        if is_abreast(value.kind) or not (is_number(value.kind) and is_number(kind)):
            raise CompileError(f"{value.kind} for {kind}")
        if kind is LONG:
            return self.long_of(value)
        if kind is COMPLEX:
            return Value(COMPLEX, (*self.cast(value, FLOAT).parts, ZERO))
        types = self.types
        if kind is INT:
            return Value(INT, (self.write(f"zext {types.bit} {value.parts[0]} to {types.word}"),))
        if value.kind in (INT, BOOL):
            if value.is_known:
                high = self.literal("double", constant(float(int(value.parts[0]))))
            else:
                name, leaf = ("sitofp", types.word) if value.kind is INT else ("uitofp", types.bit)
                high = self.write(f"{name} {leaf} {value.parts[0]} to {types.double}")
            value = Value(FLOAT, (high,))
        return value if kind is FLOAT else Value(WIDE, (value.parts[0], self.literal("double", ZERO)))

    def long_of(self, value: Value) -> Value:
        """The long of a non-negative integer."""
        if value.kind is not INT:
            raise CompileError(f"{value.kind} for {LONG}")
        return Value(LONG, (value.parts[0] if value.is_known else self.write(f"zext i64 {value.parts[0]} to i128"),))

    def cast_lanes(self, value: Value, kind: Any) -> Value:
        """The value converted to a vector kind."""
        if not is_abreast(value.kind):
            value = self.cast(value, kind.single)
            given = zip(kind.single.leaves, value.parts, strict=True)
            return Value(kind, tuple(self.repeat(leaf, part) for leaf, part in given))
        self.types = ABREAST
        found = self.cast(Value(single(value.kind), value.parts), kind.single)
        self.types = SINGLE
        return Value(kind, found.parts)

    def lanes(self, value: Value) -> Value:
        """A number repeated in all lanes; its kind is that of one lane, as methods decorated by :func:`in_lanes`
        require.
        """
        if not is_number(value.kind):
            raise CompileError(f"{value.kind} with numbers abreast")
        return Value(single(value.kind), self.cast(value, abreast(single(value.kind))).parts)

    def repeat(self, leaf: str, part: str) -> str:
        """A vector that holds the scalar in every lane."""
        if not part.startswith("%"):
            return repeated(leaf, {"0": "false", "1": "true"}[part] if leaf == "i1" else part, LANES)
        many = f"<{LANES} x {leaf}>"
        first = self.write(f"insertelement {many} poison, {leaf} {part}, i64 0")
        return self.write(f"shufflevector {many} {first}, {many} poison, <{LANES} x i32> zeroinitializer")

    def some(self, condition: str) -> str:
        """Whether a condition holds in any lane, as an i1."""
        bits = self.write(f"bitcast {ABREAST.bit} {condition} to i{LANES}")
        return self.write(f"icmp ne i{LANES} {bits}, 0")

    def float_of(self, value: Value) -> str:
        """The name of a value as an LLVM double: a float, a converted integer, or the high part of a double-double."""
        return str(value.parts[0] if value.kind is WIDE else self.cast(value, FLOAT).parts[0])

    def truth(self, value: Value) -> Value:
        """Whether the value is not zero."""
        return value if single(value.kind) is BOOL else self.compare("NotEq", value, integer(0))

    @in_lanes
    def logical(self, name: str, *truths: Value) -> Value:
        """Whether all of the truths hold (``and``), at least one (``or``), or an odd number of them (``xor``)."""
        found, *others = (x.parts[0] for x in truths)
        for other in others:
            found = self.write(f"{name} {self.types.bit} {found}, {other}")
        return Value(BOOL, (found,))

    def wide(self, name: str, parts: tuple[Any, ...]) -> Value:
        """The double-double result of one of :data:`jacobian.numbers.double_double_steps.FUNCTIONS`."""
        double, pairs = self.types.double, f"{{{self.types.double}, {self.types.double}}}"
        arguments = ", ".join(f"{double} {part}" for part in parts)
        pair = self.write(f"call {pairs} @wide.{name}{self.types.mark}({arguments})")
        return Value(WIDE, tuple(self.write(f"extractvalue {pairs} {pair}, {k}") for k in range(2)))

    @in_lanes
    def negative(self, x: Value) -> Value:
        if x.kind is INT:
            if x.is_known:
                return integer(-x.known())
            return Value(INT, (self.int_binary("Sub", self.literal("i64", "0"), x.parts[0]),))
        return Value(x.kind, tuple(self.fneg(part) for part in x.parts))

    @in_lanes
    def binary(self, name: str, x: Value, y: Value) -> Value:
        """The result of a binary operator on x and y; ``name`` is its class in ``ast``."""
        if isinstance(x.kind, TupleKind) and isinstance(y.kind, TupleKind) and name == "Add":
            return Value(TupleKind(x.kind.items + y.kind.items), x.parts + y.parts)
        if not (is_number(x.kind) and is_number(y.kind)):
            raise CompileError(f"{name} of {x.kind} and {y.kind}")
        if x.is_known and y.is_known and name in FOLDED and not (name == "Pow" and y.known() < 0):
            return integer(FOLDED[name](x.known(), y.known()))
        if COMPLEX in (x.kind, y.kind):
            return complexes.binary(self, name, x, y)
        if LONG in (x.kind, y.kind):
            return Value(LONG, (self.long_binary(name, self.cast(x, LONG).parts[0], self.cast(y, LONG).parts[0]),))
        if WIDE in (x.kind, y.kind):
            return self.wide_binary(name, x, y)
        if name == "Div" or FLOAT in (x.kind, y.kind):
            return Value(FLOAT, (self.float_binary(name, self.float_of(x), self.float_of(y)),))
        return Value(INT, (self.int_binary(name, self.cast(x, INT).parts[0], self.cast(y, INT).parts[0]),))

    def wide_binary(self, name: str, x: Value, y: Value) -> Value:
        """:meth:`binary` if one operand is a double-double. Integers are converted to floats, exactly up to 2^53."""
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

    def long_binary(self, name: str, x: str, y: str) -> str:
        """:meth:`binary` for longs; the result must lie in [0, 2^128)."""
        operation = {**ARITHMETIC, **BITS, "RShift": "lshr"}.get(name)
        if operation is None:
            raise CompileError(f"{name} of longs")
        return self.write(f"{operation} i128 {x}, {y}")

    def float_binary(self, name: str, x: str, y: str) -> str:
        if name == "Pow":
            return self.intrinsic("pow", x, y)
        operation = {"Add": "fadd", "Sub": "fsub", "Mult": "fmul", "Div": "fdiv"}.get(name)
        if operation is None:
            raise CompileError(f"{name} of floats")
        return self.write(f"{operation} {self.contract} {self.types.double} {x}, {y}")

    def int_binary(self, name: str, x: str, y: str) -> str:
        """:meth:`binary` for integers; quotients are rounded down, as in Python."""
        word, bit = self.types.word, self.types.bit
        if name in ARITHMETIC:
            # nsw (no signed wrap): indices never overflow, and LLVM can then vectorise loops over them
            return self.write(f"{ARITHMETIC[name]} nsw {word} {x}, {y}")
        if name in BITS:
            return self.write(f"{BITS[name]} {word} {x}, {y}")
        if name not in ("FloorDiv", "Mod"):
            raise CompileError(f"{name} of integers")
        zero = self.literal("i64", "0")
        rest = self.write(f"srem {word} {x}, {y}")
        signs = self.write(f"xor {word} {rest}, {y}")
        below = self.write(f"icmp slt {word} {signs}, {zero}")
        some = self.write(f"icmp ne {word} {rest}, {zero}")
        off = self.write(f"and {bit} {below}, {some}")
        if name == "Mod":
            more = self.write(f"select {bit} {off}, {word} {y}, {word} {zero}")
            return self.write(f"add {word} {rest}, {more}")
        quotient, less = self.write(f"sdiv {word} {x}, {y}"), self.write(f"zext {bit} {off} to {word}")
        return self.write(f"sub {word} {quotient}, {less}")

    @in_lanes
    def compare(self, name: str, x: Value, y: Value) -> Value:
        kind = meeting(x.kind, y.kind)
        if not is_number(kind) or name not in RELATIONS:
            raise CompileError(f"{name} of {x.kind} and {y.kind}")
        if x.is_known and y.is_known:
            return Value(BOOL, (str(int(FOLDED[name](x.known(), y.known()))),))
        x, y = self.cast(x, kind), self.cast(y, kind)
        of_floats, of_integers = RELATIONS[name]
        double, word, bit = self.types[:3]
        if kind is LONG:
            unsigned = of_integers.replace("s", "u")
            return Value(BOOL, (self.write(f"icmp {unsigned} i128 {x.parts[0]}, {y.parts[0]}"),))
        if kind is not WIDE:
            relation = (
                f"fcmp {of_floats} {double}" if kind is FLOAT else f"icmp {of_integers} {word if kind is INT else bit}"
            )
            return Value(BOOL, (self.write(f"{relation} {x.parts[0]}, {y.parts[0]}"),))
        strict = {"ole": "olt", "oge": "ogt"}.get(of_floats, of_floats)
        first = self.write(f"fcmp {strict} {double} {x.parts[0]}, {y.parts[0]}")
        second = self.write(f"fcmp {of_floats} {double} {x.parts[1]}, {y.parts[1]}")
        if name in ("Eq", "NotEq"):
            return Value(BOOL, (self.write(f"{'and' if name == 'Eq' else 'or'} {bit} {first}, {second}"),))
        same = self.write(f"fcmp oeq {double} {x.parts[0]}, {y.parts[0]}")
        both = self.write(f"and {bit} {same}, {second}")
        return Value(BOOL, (self.write(f"or {bit} {first}, {both}"),))

    def chosen(self, condition: str, x: Value, y: Value) -> Value:
        """x if the condition holds, else y; both have been computed before."""
        if self.types is not SINGLE:
            return self.blended(condition, x, y)
        parts = tuple(
            p if p == q else self.write(f"select i1 {condition}, {leaf} {p}, {leaf} {q}")
            for leaf, p, q in zip(x.kind.leaves, x.parts, y.parts, strict=True)
        )
        return Value(x.kind, parts)

    def blended(self, condition: str, x: Value, y: Value) -> Value:
        """In each lane x if the condition holds there, else y."""
        kind = abreast(x.kind)
        parts = tuple(
            p if p == q else self.write(f"select {ABREAST.bit} {condition}, {leaf} {p}, {leaf} {q}")
            for leaf, p, q in zip(kind.leaves, x.parts, y.parts, strict=True)
        )
        return Value(x.kind, parts)

    @in_lanes
    def extremum(self, relation: str, values: list[Value]) -> Value:
        """The smallest or largest value, by the relation; of equal values, the first."""
        kind = values[0].kind
        for value in values:
            kind = meeting(kind, value.kind)
        best = self.cast(values[0], kind)
        for value in values[1:]:
            value = self.cast(value, kind)
            best = self.chosen(self.compare(relation, value, best).parts[0], value, best)
        return best

    @in_lanes
    def absolute(self, x: Value) -> Value:
        if x.kind is FLOAT:
            return Value(FLOAT, (self.intrinsic("fabs", x.parts[0]),))
        head = Value(FLOAT, x.parts[:1]) if x.kind is WIDE else x
        zero = Value(INT, (self.literal("i64", "0"),))
        return self.chosen(self.compare("Lt", head, zero).parts[0], self.negative(x), x)

    @in_lanes
    def root(self, x: Value) -> Value:
        return self.wide("root", x.parts) if x.kind is WIDE else self.function("sqrt", x)

    @in_lanes
    def function(self, name: str, x: Value) -> Value:
        """The value of the LLVM intrinsic ``name`` at a float."""
        return Value(FLOAT, (self.intrinsic(name, self.float_of(x)),))

    @in_lanes
    def rounded(self, x: Value) -> Value:
        """A number rounded to a float; for a double-double, its high part."""
        return Value(FLOAT, (self.float_of(x),))

    @in_lanes
    def whole(self, x: Value) -> Value:
        """The float truncated to an integer; not-a-number becomes 0."""
        if x.kind in (INT, BOOL):
            return self.cast(x, INT)
        double, word, suffix = self.types.double, self.types.word, self.types.suffix
        name = f"llvm.fptosi.sat.{suffix.replace('f', 'i')}.{suffix}"
        return Value(INT, (self.write(f"call {word} @{name}({double} {self.float_of(x)})"),))

    def frexp(self, x: Value) -> Value:
        """The pair (mantissa, exponent) of x, as ``math.frexp`` returns it."""
        slot = self.slot("i32")
        mantissa = self.write(f"call double @frexp(double {self.float_of(x)}, ptr {slot})")
        exponent = self.write(f"load i32, ptr {slot}")
        return Value(TupleKind((FLOAT, INT)), (mantissa, self.write(f"sext i32 {exponent} to i64")))

    def ldexp(self, x: Value, n: Value) -> Value:
        exponent = self.write(f"trunc i64 {self.cast(n, INT).parts[0]} to i32")
        return Value(FLOAT, (self.write(f"call double @ldexp(double {self.float_of(x)}, i32 {exponent})"),))


BUILTINS: dict[Any, Callable[..., Value]] = {
    len: lambda b, x: integer(len(x.kind.items)) if isinstance(x.kind, TupleKind) else Value(INT, (x.parts[1],)),
    abs: Operators.absolute,
    float: Operators.rounded,
    int: Operators.whole,
    bool: Operators.truth,
    max: lambda b, *xs: b.extremum("Gt", list(xs)),
    min: lambda b, *xs: b.extremum("Lt", list(xs)),
    math.floor: lambda b, x: x if single(x.kind) is INT else b.whole(b.function("floor", x)),
    math.ceil: lambda b, x: x if single(x.kind) is INT else b.whole(b.function("ceil", x)),
    math.sqrt: lambda b, x: b.function("sqrt", x),
    math.frexp: Operators.frexp,
    math.ldexp: Operators.ldexp,
    **{getattr(math, name): (lambda b, x, n=name: b.function(n, x)) for name in ("sin", "cos", "log", "log2", "exp")},
}
# LLVM's functions, by the number of their arguments
FUNCTIONS_OF_LLVM = {
    1: ("sqrt", "fabs", "rint", "floor", "ceil", "sin", "cos", "log", "log2", "exp"),
    2: ("pow",),
    3: ("fma",),
}
DECLARED = "\n".join(
    [
        *(
            f"declare {types.double} @llvm.{name}.{types.suffix}({', '.join([types.double] * count)})"
            for types in (SINGLE, ABREAST)
            for count, names in FUNCTIONS_OF_LLVM.items()
            for name in names
        ),
        *(
            f"declare {types.word} @llvm.fptosi.sat.{types.suffix.replace('f', 'i')}.{types.suffix}({types.double})"
            for types in (SINGLE, ABREAST)
        ),
        "declare i128 @llvm.cttz.i128(i128, i1)",
        "declare <2 x i64> @llvm.x86.pclmulqdq(<2 x i64>, <2 x i64>, i8)",
        "declare double @frexp(double, ptr)",
        "declare double @ldexp(double, i32)",
    ]
)
