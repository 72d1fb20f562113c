"""The kinds of values in compiled loops and their LLVM representation: every value is a sequence of scalars.

Kinds are equal if their fields are. A value of compiled code is a :class:`Value`: its kind and the LLVM
operands of its scalars; an integer known at compile time is written as a literal.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from jacobian.native.code import LANES


class CompileError(TypeError):
    """Raised if a loop contains something that cannot be compiled, or gets arguments of kinds that it does not take."""


@dataclass(frozen=True)
class Kind:
    """The kind of a number. ``leaves``: the LLVM types of its scalars, two for double-doubles and complex numbers."""

    name: str
    leaves: tuple[str, ...]
    rank: int = -1
    """The result of an operation on two kinds of numbers has the kind of higher rank."""
    single: Any = None
    """The kind of one lane, for a vector kind; None for a scalar kind."""


BOOL = Kind("bool", ("i1",), 0)
INT = Kind("int", ("i64",), 1)
FLOAT = Kind("float", ("double",), 2)
WIDE = Kind("double-double", ("double", "double"), 3)
LONG = Kind("long", ("i128",), 4)
"""A natural number below 2^128."""
COMPLEX = Kind("complex", ("double", "double"), 5)
NONE = Kind("None", ())
OBJECT = Kind("object", ())
"""An object known at compile time: a function, a class, a module or a dictionary."""
_ABREAST = {
    kind: Kind(f"{kind.name} abreast", tuple(f"<{LANES} x {leaf}>" for leaf in kind.leaves), kind.rank, kind)
    for kind in (BOOL, INT, FLOAT, WIDE)
}


def abreast(kind: Any) -> Any:
    """The kind of a vector of LANES values of this kind; for a tuple, the tuple of its items' vector kinds."""
    if isinstance(kind, TupleKind):
        return TupleKind(tuple(map(abreast, kind.items)), kind.named)
    if is_abreast(kind):
        return kind
    if kind not in _ABREAST:
        raise CompileError(f"no {kind} abreast")
    return _ABREAST[kind]


def is_abreast(kind: Any) -> bool:
    """Whether ``kind`` is a vector kind, with a value in each SIMD lane."""
    return getattr(kind, "single", None) is not None


def single(kind: Any) -> Any:
    """The kind of one lane of a vector kind; a scalar kind itself."""
    return kind.single if is_abreast(kind) else kind


@dataclass(frozen=True)
class ArrayKind:
    """A C-contiguous array. ``item`` is the kind of its items: floats, integers, longs, double-doubles or complex
    numbers. An item takes ``parts`` words; ``stored`` is the NumPy type of integers of fewer than 8 bytes.
    """

    item: Kind
    ndim: int = 1
    parts: int = 1
    stored: str = ""

    @property
    def leaves(self) -> tuple[str, ...]:
        return ("ptr",) + ("i64",) * self.ndim

    @cached_property
    def dtype(self) -> np.dtype[Any]:
        return np.dtype(self.stored or ("int64" if self.item in (INT, LONG) else "float64"))

    @cached_property
    def axes(self) -> int:
        """The number of axes of the NumPy array."""
        return self.ndim + (self.parts > 1)

    @property
    def memory(self) -> str:
        """The LLVM type of one word of the array in memory."""
        return f"i{8 * self.dtype.itemsize}" if self.item in (INT, LONG) else "double"


INTS, FLOATS, WIDES = ArrayKind(INT), ArrayKind(FLOAT), ArrayKind(WIDE, parts=2)
HIGHS = ArrayKind(FLOAT, parts=2)
"""The high parts of double-doubles."""
LONGS = ArrayKind(LONG, parts=2)
EIGHTS, WIDE_EIGHTS = ArrayKind(_ABREAST[FLOAT], parts=LANES), ArrayKind(_ABREAST[WIDE], parts=2 * LANES)
"""Items of LANES floats, or double-doubles, one for each SIMD lane."""


@dataclass(frozen=True)
class TupleKind:
    """A tuple, or a NamedTuple of the class ``named``."""

    items: tuple[Any, ...]
    named: Any = None

    @cached_property
    def leaves(self) -> tuple[str, ...]:
        return tuple(leaf for item in self.items for leaf in item.leaves)

    @cached_property
    def plain(self) -> bool:
        """Whether every item is passed as a single unconverted word."""
        return all(item in (BOOL, INT, FLOAT) for item in self.items)

    @cached_property
    def forms(self) -> tuple[tuple[Any, ...], ...] | None:
        """The forms (:func:`form_of`) of the tuple's items; None if their words are passed unconverted."""
        return None if self.plain else tuple(map(form_of, self.items))

    def place(self, index: int) -> tuple[Any, int, int]:
        """(kind, begin, end) of an item, whose scalars are those of the tuple with the indices begin to end − 1."""
        if not -len(self.items) <= index < len(self.items):
            raise CompileError(f"index {index} of a tuple of {len(self.items)}")
        index %= len(self.items)
        begin = sum(len(item.leaves) for item in self.items[:index])
        return self.items[index], begin, begin + len(self.items[index].leaves)

    def has(self, name: str) -> bool:
        """Whether the tuple is a NamedTuple with a field ``name``."""
        return self.named is not None and name in self.named._fields

    def field(self, name: str) -> int:
        """The index of a field of a NamedTuple."""
        if not self.has(name):
            raise CompileError(f"{self.named or 'a tuple'} has no field {name}")
        return int(self.named._fields.index(name))


def form_of(kind: Any) -> tuple[Any, ...]:
    """(kind, dtype, axes, forms): all that a call inspects of a kind, computed once.

    An array has a dtype and a number of axes, a tuple the forms of its items. Entries that do not apply are None or 0.
    """
    if isinstance(kind, ArrayKind):
        return kind, kind.dtype, kind.axes, None
    return kind, None, 0, kind.forms if isinstance(kind, TupleKind) else None


@dataclass(frozen=True)
class FunctionKind:
    """A function, ``thing``, passed as an argument. Its caller is compiled separately for each function passed."""

    thing: Any
    leaves: tuple[str, ...] = ()


def record(named: Any, *items: Any) -> TupleKind:
    return TupleKind(items, named)


class Value(NamedTuple):
    """A kind and the LLVM operands of its scalars; for :data:`OBJECT`, the Python object itself."""

    kind: Any
    parts: tuple[Any, ...]

    def item(self, index: int) -> Value:
        kind, begin, end = self.kind.place(index)
        return Value(kind, self.parts[begin:end])

    def known(self) -> int:
        """The value as a Python int; it must be an integer known at compile time."""
        if not self.is_known:
            raise CompileError("an integer known while compiling is needed")
        return int(self.parts[0])

    @property
    def is_known(self) -> bool:
        """Whether the value is an integer known at compile time."""
        return self.kind is INT and self.parts[0].lstrip("-").isdigit()


def together(values: list[Value], named: Any = None) -> Value:
    """A tuple, or a NamedTuple, of values."""
    return Value(TupleKind(tuple(x.kind for x in values), named), tuple(part for x in values for part in x.parts))


def is_number(kind: Any) -> bool:
    return isinstance(kind, Kind) and kind.rank >= 0


def meeting(first: Any, second: Any) -> Any:
    """The kind that can hold the values of both kinds; CompileError if there is none."""
    if first == second:
        return first
    if is_number(first) and is_number(second):
        if is_abreast(first) or is_abreast(second):
            return abreast(meeting(single(first), single(second)))
        return first if first.rank > second.rank else second
    if isinstance(first, TupleKind) and isinstance(second, TupleKind) and len(first.items) == len(second.items):
        named = first.named if first.named is second.named else None
        return TupleKind(tuple(map(meeting, first.items, second.items)), named)
    raise CompileError(f"{first} and {second} in one variable")


def returned_type(kind: Any) -> str:
    """The LLVM type of a function's result."""
    leaves = kind.leaves
    if len(leaves) < 2:
        return str(leaves[0]) if leaves else "void"
    return "{" + ", ".join(leaves) + "}"
