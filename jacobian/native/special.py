"""Functions of this package that the compiler replaces by its own instructions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jacobian.native.kinds import WIDE, Value, single
from jacobian.native.operators import Operators, in_lanes, real
from jacobian.native.words import ARITHMETIC
from jacobian.numbers.double_double import EPS
from jacobian.numbers.double_double_steps import joined as joined_steps
from jacobian.numbers.double_double_steps import plus_product as step_of_sum
from jacobian.numbers.roots import negligible, root
from jacobian.numbers.sums import joined, plus_product


def adds_nothing(b: Operators, small: Value, large: Value) -> Value:
    """Instructions for :func:`jacobian.numbers.roots.negligible`."""
    if single(large.kind) is WIDE:
        # the bound refers to hi + lo, not to hi alone: lo may hold digits far below those of hi
        return b.compare("LtE", b.absolute(small), b.binary("Mult", real(EPS), b.absolute(large)))
    return b.compare("Eq", b.binary("Add", large, small), large)


@in_lanes
def one_more(b: Operators, total: Value, x: Value, y: Value) -> Value:
    """Instructions for :func:`jacobian.numbers.sums.plus_product`; if all arguments are double-doubles, the two parts
    of the total may overlap."""
    if any(v.kind is not WIDE for v in (total, x, y)):
        return b.binary("Add", total, b.binary("Mult", x, y))
    return Value(WIDE, step_of_sum(b, *total.parts, *x.parts, *y.parts))


@in_lanes
def both(b: Operators, x: Value, y: Value) -> Value:
    """Instructions for :func:`jacobian.numbers.sums.joined`; if both are double-doubles, their parts may overlap."""
    if any(v.kind is not WIDE for v in (x, y)):
        return b.binary("Add", x, y)
    return Value(WIDE, joined_steps(b, *x.parts, *y.parts))


SPECIAL: dict[Any, Callable[..., Any]] = {
    **ARITHMETIC,
    root: Operators.root,
    negligible: adds_nothing,
    plus_product: one_more,
    joined: both,
}
