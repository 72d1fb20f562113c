"""Double-double numbers for code compiled by numba: importing this module makes the types known.

In compiled code ``number(hi, lo)`` is a number and ``numbers(array)`` a view of a float array (…, 2) whose items are
numbers and rows of numbers; + − × ÷, comparisons, abs, max, min, float() and ``roots.root`` take them, mixed with
floats and integers (which count as floats: exact up to 2^53). Attributes ``hi`` and ``lo`` read the parts.

Functions that use them must be compiled without fastmath (:data:`JIT`): an optimizer that contracts or reorders sums
would take the error terms for zero. Lowering refuses it. The algorithms are
those of :mod:`jacobian.numbers.double_double_steps`.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.errors import LoweringError, TypingError
from numba.core.typing.templates import AbstractTemplate, ConcreteTemplate, infer_global, signature
from numba.extending import (
    intrinsic,
    lower_builtin,
    lower_cast,
    make_attribute_wrapper,
    models,
    overload,
    register_model,
)

from jacobian.numbers.double_double_steps import FUNCTIONS, Pair

JIT = {"nogil": True, "error_model": "numpy", "fastmath": False}
"""Options of ``numba.njit`` for functions on double-double numbers."""


class DoubleDouble(types.Type):
    """The numba type of one number."""

    def __init__(self) -> None:
        super().__init__(name="double_double")

    def unify(self, typingctx: Any, other: Any) -> Any:
        """A double-double and a float or integer meet as a double-double."""
        return self if isinstance(other, (types.Float, types.Integer)) else None


class DoubleDoubleArray(types.Type):
    """The numba type of an array of numbers with ``ndim`` axes, a view of a C-contiguous float array of one more."""

    def __init__(self, ndim: int) -> None:
        self.ndim = ndim
        self.data = types.Array(types.float64, ndim + 1, "C")
        super().__init__(name=f"double_double_array({ndim})")


double_double = DoubleDouble()


@register_model(DoubleDouble)
class _NumberModel(models.StructModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, [("hi", types.float64), ("lo", types.float64)])


@register_model(DoubleDoubleArray)
class _ArrayModel(models.StructModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, [("data", fe_type.data)])


make_attribute_wrapper(DoubleDouble, "hi", "hi")
make_attribute_wrapper(DoubleDouble, "lo", "lo")
make_attribute_wrapper(DoubleDoubleArray, "data", "data")

# --- instructions ---------------------------------------------------------------------------------------------------


class _Builder:
    """llvmlite's instructions as :class:`jacobian.numbers.double_double_steps.Instructions`."""

    one = ir.Constant(ir.DoubleType(), 1.0)

    def __init__(self, b: Any) -> None:
        self._b = b
        self.fadd, self.fsub, self.fmul, self.fdiv, self.fneg, self.fma = b.fadd, b.fsub, b.fmul, b.fdiv, b.fneg, b.fma

    def fsqrt(self, x: Any) -> Any:
        return self._b.call(self._b.module.declare_intrinsic("llvm.sqrt", [x.type]), [x])

    def unless_zero(self, x: Any, y: Any) -> Any:
        """y, but x where x = 0."""
        return self._b.select(self._b.fcmp_ordered("==", x, ir.Constant(x.type, 0.0)), x, y)


def _less(b: Any, xh: Any, xl: Any, yh: Any, yl: Any, relation: str) -> Any:
    equal = b.fcmp_ordered("==", xh, yh)
    return b.or_(b.fcmp_ordered(relation[0], xh, yh), b.and_(equal, b.fcmp_ordered(relation, xl, yl)))


def _equal(b: Any, xh: Any, xl: Any, yh: Any, yl: Any) -> Any:
    return b.and_(b.fcmp_ordered("==", xh, yh), b.fcmp_ordered("==", xl, yl))


# --- operators --------------------------------------------------------------------------------------------------------

DD, FLOAT, INTEGER = double_double, types.float64, types.int64


def _called(context: Any, b: Any, name: str, args: list[Any]) -> Any:
    """A call of a function of the module with the instructions of FUNCTIONS[name]."""
    if context.fastmath:
        raise LoweringError(
            "double-double numbers in a function compiled with fastmath; use double_double_compiled.JIT"
        )
    double = ir.DoubleType()
    result = context.get_value_type(DD)
    kind = ir.FunctionType(result, [double] * len(args))
    function = cgutils.get_or_insert_function(b.module, kind, f"double_double.{name}")
    if not function.blocks:
        function.linkage = "linkonce_odr"
        function.attributes.add("noinline")
        function.attributes.add("nounwind")
        inner = ir.IRBuilder(function.append_basic_block("entry"))
        high, low = FUNCTIONS[name][0](_Builder(inner), *function.args)
        value = inner.insert_value(ir.Constant(result, ir.Undefined), high, 0)
        inner.ret(inner.insert_value(value, low, 1))
    return b.call(function, args)


def _parts(b: Any, value: Any) -> Pair:
    return b.extract_value(value, 0), b.extract_value(value, 1)


def _values(context: Any, b: Any, kinds: Any, args: Any) -> list[Any]:
    """hi and lo of double-doubles, and floats as they are, in a row."""
    found: list[Any] = []
    for kind, value in zip(kinds, args, strict=True):
        found.extend(_parts(b, value) if kind == DD else [context.cast(b, value, kind, FLOAT)])
    return found


def _negated(b: Any, values: list[Any]) -> list[Any]:
    return [b.fneg(x) for x in values]


def _turned(values: list[Any]) -> list[Any]:
    """A float and a double-double the other way round."""
    return [*values[1:], values[0]]


_BOTH, _RIGHT, _LEFT = (DD, DD), (DD, FLOAT), (FLOAT, DD)

# operator → kinds of the arguments → (name of the algorithm, its arguments)
_OPERATIONS: dict[Any, dict[Any, tuple[str, Callable[[Any, list[Any]], list[Any]]]]] = {
    operator.add: {
        _BOTH: ("sum", lambda b, v: v),
        _RIGHT: ("sum_float", lambda b, v: v),
        _LEFT: ("sum_float", lambda b, v: _turned(v)),
    },
    operator.sub: {
        _BOTH: ("sum", lambda b, v: [*v[:2], *_negated(b, v[2:])]),
        _RIGHT: ("sum_float", lambda b, v: [*v[:2], *_negated(b, v[2:])]),
        _LEFT: ("sum_float", lambda b, v: _turned([v[0], *_negated(b, v[1:])])),
    },
    operator.mul: {
        _BOTH: ("product", lambda b, v: v),
        _RIGHT: ("product_float", lambda b, v: v),
        _LEFT: ("product_float", lambda b, v: _turned(v)),
    },
    operator.truediv: {
        _BOTH: ("quotient", lambda b, v: v),
        _RIGHT: ("quotient_by_float", lambda b, v: v),
        _LEFT: ("quotient_of_float", lambda b, v: _turned(v)),
    },
}
_INPLACE = {
    operator.add: operator.iadd,
    operator.sub: operator.isub,
    operator.mul: operator.imul,
    operator.truediv: operator.itruediv,
}
_KINDS = [(DD, DD), (DD, FLOAT), (FLOAT, DD), (DD, INTEGER), (INTEGER, DD)]


def _register(symbol: Any, result: Any, kinds: list[Any], lower: Callable[..., Any]) -> None:
    cases = [signature(result, *kind) for kind in kinds]
    infer_global(symbol)(type("Template", (ConcreteTemplate,), {"cases": cases}))
    for kind in kinds:
        lower_builtin(symbol, *kind)(lower)


def _arithmetic(symbol: Any) -> Callable[..., Any]:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        name, order = _OPERATIONS[symbol][tuple(DD if kind == DD else FLOAT for kind in sig.args)]
        return _called(context, builder, name, order(builder, _values(context, builder, sig.args, args)))

    return lower


for _symbol, _inplace in _INPLACE.items():
    for _name in (_symbol, _inplace):
        _register(_name, DD, _KINDS, _arithmetic(_symbol))


def _comparison(relation: str) -> Callable[..., Any]:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        x, y = (_parts(builder, context.cast(builder, v, k, DD)) for k, v in zip(sig.args, args, strict=True))
        if relation in ("==", "!="):
            equal = _equal(builder, *x, *y)
            return equal if relation == "==" else builder.not_(equal)
        return _less(builder, *x, *y, relation)

    return lower


for _symbol, _relation in (
    (operator.lt, "<"),
    (operator.le, "<="),
    (operator.gt, ">"),
    (operator.ge, ">="),
    (operator.eq, "=="),
    (operator.ne, "!="),
):
    _register(_symbol, types.boolean, _KINDS, _comparison(_relation))


def _made(context: Any, b: Any, high: Any, low: Any) -> Any:
    value = b.insert_value(ir.Constant(context.get_value_type(DD), ir.Undefined), high, 0)
    return b.insert_value(value, low, 1)


def _lower_neg(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return _made(context, builder, *_negated(builder, list(_parts(builder, args[0]))))


def _lower_abs(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    negative = builder.fcmp_ordered("<", _parts(builder, args[0])[0], ir.Constant(ir.DoubleType(), 0.0))
    return builder.select(negative, _lower_neg(context, builder, sig, args), args[0])


_register(operator.neg, DD, [(DD,)], _lower_neg)
_register(abs, DD, [(DD,)], _lower_abs)


@lower_cast(types.Float, DoubleDouble)
def _float_to_number(context: Any, builder: Any, fromty: Any, toty: Any, value: Any) -> Any:
    high = context.cast(builder, value, fromty, FLOAT)
    return _made(context, builder, high, ir.Constant(ir.DoubleType(), 0.0))


@lower_cast(types.Integer, DoubleDouble)
def _integer_to_number(context: Any, builder: Any, fromty: Any, toty: Any, value: Any) -> Any:
    return _float_to_number(context, builder, fromty, toty, value)


def _extremum(symbol: Any, relation: str) -> None:
    class Template(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            known = all(kind == DD or isinstance(kind, (types.Float, types.Integer)) for kind in args)
            return signature(DD, *args) if known and DD in args and not kws else None

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        best, *rest = (context.cast(builder, x, kind, DD) for kind, x in zip(sig.args, args, strict=True))
        for x in rest:
            better = _less(builder, *_parts(builder, x), *_parts(builder, best), relation)
            best = builder.select(better, x, best)
        return best

    infer_global(symbol)(Template)
    lower_builtin(symbol, types.VarArg(types.Any))(lower)  # type: ignore[attr-defined]


_extremum(max, ">")
_extremum(min, "<")

# --- in compiled code -------------------------------------------------------------------------------------------------


@intrinsic
def number(typingctx, hi, lo):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    """The double-double hi + lo of two floats, |lo| at most half a unit in the last place of hi."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _made(context, builder, *args)

    return DD(FLOAT, FLOAT), lower


@intrinsic
def numbers(typingctx, array):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    """A C-contiguous float array (…, 2) as an array of double-doubles: the same memory."""
    if not isinstance(array, types.Array) or array.layout != "C" or array.dtype != FLOAT or array.ndim < 2:
        raise TypingError(f"numbers({array}): a C-contiguous float64 array (…, 2) is needed")
    kind = DoubleDoubleArray(array.ndim - 1)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        view = cgutils.create_struct_proxy(sig.return_type)(context, builder)
        view.data = args[0]
        context.nrt.incref(builder, sig.args[0], args[0])
        return view._getvalue()

    return kind(kind.data), lower


@intrinsic
def square_root(typingctx, x):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    """√x of a double-double."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _called(context, builder, "root", list(_parts(builder, args[0])))

    return DD(DD), lower


@overload(float)
def _float(x):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    if isinstance(x, DoubleDouble):
        return lambda x: x.hi
    return None


@overload(len)
def _len(array):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    if isinstance(array, DoubleDoubleArray):
        return lambda array: len(array.data)
    return None


@overload(operator.getitem)
def _getitem(array, index):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    if not isinstance(array, DoubleDoubleArray) or not isinstance(index, types.Integer):
        return None
    if array.ndim == 1:
        return lambda array, index: number(array.data[index, 0], array.data[index, 1])
    return lambda array, index: numbers(array.data[index])


@overload(operator.setitem)
def _setitem(array, index, value):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    if not isinstance(array, DoubleDoubleArray) or array.ndim != 1:
        return None

    def store(array, index, value):  # type: ignore[no-untyped-def]
        x = 0.0 + value
        array.data[index, 0] = x.hi
        array.data[index, 1] = x.lo

    def store_float(array, index, value):  # type: ignore[no-untyped-def]
        array.data[index, 0] = value
        array.data[index, 1] = 0.0

    return store if isinstance(value, DoubleDouble) else store_float
