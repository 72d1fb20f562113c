"""Symbolic constants of a kind of systems: formulas recorded with them hold for all systems of the kind."""

from __future__ import annotations

from dataclasses import dataclass
from math import frexp
from typing import Any

from integrable.series.tape import DIFFERENCE, GROWTH, PRODUCT, SUM, Operand, Recorded
from jacobian.element import Real
from jacobian.fields.inexact import InexactField

Key = tuple[Any, ...]
"""The key of a symbol: ('constant', i), ('number', x) or (kind of a tape's operation, key, key)."""


@dataclass(frozen=True, repr=False)
class Symbol(Operand):
    """A constant whose value is known when a walk begins; ``key`` describes its computation."""

    key: Key

    def __repr__(self) -> str:
        # the names of compiled objects on disk derive from this text, so it is the same in every process
        return repr(self.key)

    @staticmethod
    def operation(kind: int, x: object, y: object) -> Any:
        if isinstance(x, Recorded) or isinstance(y, Recorded):
            return NotImplemented
        for one, other in ((x, y), (y, x)):
            if isinstance(other, int | float):
                if other == 0 and (kind == SUM or (kind == DIFFERENCE and other is y)):
                    return one
                if other in (0, 1) and kind == PRODUCT:
                    return one if other else 0.0
        return Symbol((kind, key_of(x), key_of(y)))


def key_of(x: Any) -> Key:
    return x.key if isinstance(x, Symbol) else ("number", float(x))


class SymbolField(InexactField):
    """The field over which the formulas of a kind of systems are recorded: floats, symbols, and recorded numbers."""

    name = "symbols"
    zero, one, eps = 0.0, 1.0, 2.0**-53

    def coerce(self, value: Any, argument: str = "value") -> Any:
        """Returns symbols and recorded numbers unchanged, 0 and powers of two as floats, and other numbers as symbols.

        A division by a constant is recorded as a product with its reciprocal, which is exact in floats only for powers
        of two.
        """
        if isinstance(value, Operand):
            return value
        x = float(value)
        return x if frexp(x)[0] in (0.0, 0.5, -0.5) else Symbol(("number", x))

    def sqrt(self, x: Real) -> Real:
        return x**0.5

    class context:
        @staticmethod
        def expm1(x: Recorded) -> Recorded:
            return x.function(GROWTH)
