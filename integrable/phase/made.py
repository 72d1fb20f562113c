"""The base class of values that are determined by their constructor arguments, such as systems and bodies."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from integrable.phase.state import MOST_BITS
from jacobian import RR
from jacobian.errors import ArgumentError
from jacobian.immutable import Immutable


class Made(Immutable):
    """A value that its constructor arguments determine: ``type(x)(**x.arguments, field=x.field) == x``. Its ``repr`` is
    this constructor call, written with names from :mod:`jacobian` and :mod:`integrable`.
    """

    field: Any

    @property
    def arguments(self) -> dict[str, object]:
        """The arguments of the constructor by name, without the field: numbers and sequences of numbers."""
        raise NotImplementedError

    @property
    def identity(self) -> dict[str, object]:
        """The identity of this value, for JSON: its type, its field, and every argument to the last bit.

        ArgumentError where the arguments do not reproduce the value, as in a subclass with further arguments.
        """
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            again = type(self)(**self.arguments, field=self.field)  # type: ignore[call-arg]
        if again != self:
            raise ArgumentError(f"{self!r}: its property arguments lacks some; a class of your own returns all of them")
        kind = type(self)
        given = {name: _plain(value) for name, value in self.arguments.items()}
        return {"type": f"{kind.__module__}.{kind.__qualname__}", "arguments": given, "field": repr(self.field)}

    def __repr__(self) -> str:
        given = [f"{name}={_text(_plain(value))}" for name, value in self.arguments.items()]
        if self.field is not RR:
            given.append(f"field={self.field!r}")
        return f"{type(self).__name__}({', '.join(given)})"


def _plain(value: object) -> object:
    """``value`` as ints, floats, strings and tuples of these, which a field converts to exactly the same numbers."""
    if isinstance(value, Sequence) and not isinstance(value, str):
        return tuple(map(_plain, value))
    if isinstance(value, Fraction):
        top, below = _short(value.numerator), _short(value.denominator)
        return top if below == 1 else f"{top}/{below}"
    if type(value) is int:
        return _short(value)
    return _decimal(value) if hasattr(value, "_mpf_") else value


def _short(n: int) -> int | str:
    """The int itself, or its text in base 16 if it is too long for Python to write in decimals."""
    return n if n.bit_length() < MOST_BITS else hex(n)


def _text(value: object) -> str:
    """The ``repr`` of a plain value; an int that is stored as text in base 16 is written without quotes."""
    if isinstance(value, tuple):
        return f"({', '.join(map(_text, value))}{',' if len(value) == 1 else ''})"
    return value if isinstance(value, str) and "0x" in value[:3] and "/" not in value else repr(value)


def _decimal(x: Any) -> float | str:
    """A number as a float if that is exact, otherwise as a string with as many digits as needed."""
    from mpmath.libmp import repr_dps, to_str

    if float(x) == x:
        return float(x)
    context = x.context
    short = to_str(x._mpf_, context.dps)
    return short if context.mpf(short) == x else to_str(x._mpf_, repr_dps(context.prec))
