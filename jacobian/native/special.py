"""Functions of this package that compiled loops have instructions of their own for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jacobian.native.kinds import WIDE, Value, single
from jacobian.native.operators import Operators, real
from jacobian.numbers.double_double import EPS
from jacobian.numbers.roots import negligible, root


def adds_nothing(b: Operators, small: Value, large: Value) -> Value:
    """:func:`jacobian.numbers.roots.negligible`."""
    if single(large.kind) is WIDE:
        # lo may hold digits far below those of the number
        return b.compare("LtE", b.absolute(small), b.binary("Mult", real(EPS), b.absolute(large)))
    return b.compare("Eq", b.binary("Add", large, small), large)


SPECIAL: dict[Any, Callable[..., Value]] = {root: Operators.root, negligible: adds_nothing}
