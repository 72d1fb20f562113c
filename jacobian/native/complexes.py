"""Complex numbers in compiled loops: their operators, parts and conjugates."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jacobian.native.kinds import COMPLEX, FLOAT, CompileError, Value


def parts_of(b: Any, x: Value) -> tuple[str, str | None]:
    """The real and the imaginary part; a real number has None as imaginary part."""
    return (x.parts[0], x.parts[1]) if x.kind is COMPLEX else (b.cast(x, FLOAT).parts[0], None)


def binary(b: Any, name: str, x: Value, y: Value) -> Value:
    """A sum, a difference or a product, in the fewest operations on real numbers."""
    (x0, x1), (y0, y1) = parts_of(b, x), parts_of(b, y)
    if name == "Mult":
        low, high = b.float_binary(name, x0, y0), None
        if x1 is not None and y1 is not None:
            low = b.float_binary("Sub", low, b.float_binary(name, x1, y1))
        crossed = [b.float_binary(name, s, t) for s, t in ((x0, y1), (x1, y0)) if s is not None and t is not None]
        high = b.float_binary("Add", *crossed) if len(crossed) == 2 else crossed[0]
        return Value(COMPLEX, (low, high))
    if name not in ("Add", "Sub"):
        raise CompileError(f"{name} of complex numbers")
    if y1 is None:
        high = x1
    elif x1 is None:
        high = b.fneg(y1) if name == "Sub" else y1
    else:
        high = b.float_binary(name, x1, y1)
    return Value(COMPLEX, (b.float_binary(name, x0, y0), high))


def conjugate(b: Any, x: Value) -> Value:
    """The conjugate of x; x itself if it is real."""
    return Value(COMPLEX, (x.parts[0], b.fneg(x.parts[1]))) if x.kind is COMPLEX else x


def real(b: Any, x: Value) -> Value:
    return Value(FLOAT, (x.parts[0],)) if x.kind is COMPLEX else x


def imaginary(b: Any, x: Value) -> Value:
    return Value(FLOAT, (x.parts[1] if x.kind is COMPLEX else "0.0",))


PARTS: dict[str, Callable[[Any, Value], Value]] = {"real": real, "imag": imaginary}
METHODS: dict[str, Callable[[Any, Value], Value]] = {"conjugate": conjugate}
"""The attributes and methods of numbers."""
