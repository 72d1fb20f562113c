"""Functions that compiled loops on moving points share: the first estimate of a small translation, and repeated
addition.
"""

from __future__ import annotations

from collections.abc import Callable

from integrable.moving_point import addition
from integrable.moving_point.addition import Real, Row
from jacobian.native.expressions import Expressions
from jacobian.native.kinds import FLOAT, HIGHS, INT, WIDE, ArrayKind, TupleKind, Value, single
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL as SPECIAL_NUMBERS


def _estimate(series: Row, f0: Real, eps: Real) -> tuple[Real, Real]:
    """:func:`integrable.moving_point.addition.estimate` for floats."""
    return -series[1] * f0 * eps * eps / 12, f0 * eps * eps / 4


def estimate_in_floats(series: Row, f0: Real, eps: Real) -> tuple[Real, Real]:
    """:func:`integrable.moving_point.addition.estimate` for double-doubles, from their high parts."""
    r = f0 * eps * eps / 4
    m = -series[1] * r / 3
    if abs(eps) >= 1e-100:
        m, r = addition_centre(series[:addition_terms], f0, eps, m, r, 6)
    return m, r


addition_centre, addition_terms = addition.centre, addition.FLOAT_TERMS


def estimated(b: Expressions, series: Value, f0: Value, eps: Value) -> Value:
    """:func:`integrable.moving_point.addition.estimate` in compiled code, for floats or double-doubles."""
    if single(eps.kind) is not WIDE:
        return b.call(_estimate, [series, f0, eps])
    high = [b.rounded(x) for x in (f0, eps)]
    return b.call(estimate_in_floats, [Value(HIGHS, series.parts), *high])


def leading_parts(b: Expressions, x: Value) -> Value:
    """:func:`integrable.moving_point.addition.leading` in compiled code: the high parts of double-doubles."""
    if isinstance(x.kind, ArrayKind):
        return Value(HIGHS, x.parts) if x.kind.item is WIDE else x
    return b.rounded(x)


SPECIAL: dict[Callable[..., object], Callable[..., Value]] = {
    **SPECIAL_NUMBERS,
    addition.estimate: estimated,
    addition.leading: leading_parts,
}
_POINT = TupleKind((FLOAT,) * 10)
LIBRARY = Library(
    "moving_point",
    {"march": (addition.march, (TupleKind((FLOAT,) * 6), TupleKind((FLOAT,) * 8), _POINT, _POINT, INT))},
    SPECIAL,
)
