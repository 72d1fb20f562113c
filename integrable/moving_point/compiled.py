"""Functions that the compiled loops on moving points share, and the compiled loop of repeated additions."""

from __future__ import annotations

from collections.abc import Callable

from integrable.moving_point import addition
from jacobian.native.expressions import Expressions
from jacobian.native.kinds import FLOAT, HIGHS, INT, WIDE, ArrayKind, TupleKind, Value
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL as SPECIAL_NUMBERS


def leading_parts(b: Expressions, x: Value) -> Value:
    """:func:`integrable.moving_point.addition.leading` in compiled code: the high parts of double-doubles."""
    if isinstance(x.kind, ArrayKind):
        return Value(HIGHS, x.parts) if x.kind.item is WIDE else x
    return b.rounded(x)


SPECIAL: dict[Callable[..., object], Callable[..., Value]] = {**SPECIAL_NUMBERS, addition.leading: leading_parts}
_POINT = TupleKind((FLOAT,) * 10)
LIBRARY = Library(
    "moving_point",
    {"march": (addition.march, (TupleKind((FLOAT,) * 6), TupleKind((FLOAT,) * 8), _POINT, _POINT, INT))},
    SPECIAL,
)
