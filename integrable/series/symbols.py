"""Symbolic constants of a kind of systems: formulas recorded with them hold for all systems of the kind."""

from __future__ import annotations

from math import frexp
from typing import Any

from integrable.series.tape import GROWTH, Recorded
from jacobian.fields.inexact import InexactField

Key = tuple[Any, ...]
"""The key of a symbol: ('constant', i), ('number', x) or (operator, key, key)."""


class Symbol:
    """A constant whose value is known when a walk begins; ``key`` says how it is computed."""

    __slots__ = ("key",)

    def __init__(self, *key: Any) -> None:
        self.key: Key = key

    def __repr__(self) -> str:
        # the same in every process, because names of objects on disk derive from it
        return repr(self.key)

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Symbol) and self.key == other.key

    def __add__(self, other: Any) -> Any:
        return self if _is(other, 0) else _operation("+", self, other)

    def __radd__(self, other: Any) -> Any:
        return self if _is(other, 0) else _operation("+", other, self)

    def __sub__(self, other: Any) -> Any:
        return self if _is(other, 0) else _operation("-", self, other)

    def __rsub__(self, other: Any) -> Any:
        return _operation("-", other, self)

    def __mul__(self, other: Any) -> Any:
        return self if _is(other, 1) else 0.0 if _is(other, 0) else _operation("*", self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        return _operation("/", self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return _operation("/", other, self)

    def __neg__(self) -> Any:
        return _operation("*", -1.0, self)


def key_of(x: Any) -> Key:
    """The key of a symbol or of a number."""
    return x.key if isinstance(x, Symbol) else ("number", float(x))


def _is(x: Any, n: int) -> bool:
    return isinstance(x, int | float) and x == n


def _operation(sign: str, x: Any, y: Any) -> Any:
    if isinstance(x, Recorded) or isinstance(y, Recorded):
        return NotImplemented
    return Symbol(sign, key_of(x), key_of(y))


class SymbolField(InexactField):
    """The field of the constants of a recorded formula: floats and symbols."""

    name = "symbols"
    zero, one, eps = 0.0, 1.0, 2.0**-53

    def coerce(self, value: Any, argument: str = "value") -> Any:
        """Returns a symbol unchanged, 0 and powers of two as floats, and other numbers as symbols.

        The reciprocals of powers of two are exact in floats. Other reciprocals, such as 1/3, need more digits.
        """
        if isinstance(value, Symbol):
            return value
        x = float(value)
        return x if frexp(x)[0] in (0.0, 0.5, -0.5) else Symbol("number", x)


class Functions:
    """Functions of recorded numbers other than the four operations and roots."""

    @staticmethod
    def expm1(x: Recorded) -> Recorded:
        """e^x − 1."""
        return x.function(GROWTH)
