"""The libraries of compiled loops over rows, one for each class of contexts and each class of equations."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

from jacobian.batch import block_loops, random_loops, row_loops
from jacobian.native.kinds import FLOAT, INT, INTS, LONG, ArrayKind, TupleKind, record
from jacobian.native.library import Library
from jacobian.native.words import CONTEXTS
from jacobian.numbers import tables, words
from jacobian.numbers.binary import BinaryTwoWords, BinaryWord
from jacobian.numbers.two_words import TwoWords

NUMBERS: dict[type, ArrayKind] = {
    **dict.fromkeys((words.Lazy32, words.Wide32), ArrayKind(INT, stored="int32")),
    **dict.fromkeys((words.Lazy64, words.Wide64), INTS),
    **dict.fromkeys((tables.BinaryTable, tables.OddTable), ArrayKind(INT, stored="uint16")),
    words.Double: ArrayKind(FLOAT),
    **dict.fromkeys((TwoWords, BinaryWord, BinaryTwoWords), ArrayKind(LONG, parts=2)),
}
"""How the words of each kind of context are stored in rows."""
IN_LANES = (words.Lazy32, words.Wide32, words.Double)
"""The contexts whose loops LLVM vectorises."""
BYTES, SPAN = ArrayKind(INT, stored="uint8"), TupleKind((INT, INT))


def equation(context: Any, model: Any) -> TupleKind:
    """The kind, in compiled code, of an equation of the class ``model`` of :mod:`jacobian.addition.short`."""
    return record(model, *[NUMBERS[context].item] * len(model._fields))


def room_of_sums(context: Any) -> TupleKind:
    """The kind of the memory that a sum uses: the indices of special rows, and scratch."""
    return TupleKind((INTS, NUMBERS[context]))


@cache
def sums(context: Any, model: Any) -> Library:
    """The library of additions and doublings by explicit formulas, for a class of contexts and a class of equations."""
    flat, C = NUMBERS[context], equation(context, model)
    rows = replace(flat, ndim=2)
    first = TupleKind((rows, BYTES))
    entries = {
        "add_rows": (block_loops.add_rows, (CONTEXTS[context], C, first, first, rows, SPAN, room_of_sums(context))),
        "double_rows": (block_loops.double_rows, (CONTEXTS[context], C, first, rows, SPAN, room_of_sums(context))),
    }
    name = f"sums_on_{model.__name__}_of_{context.__name__}".lower()
    return Library(name, entries, inlined_but=() if context in IN_LANES else None)


@cache
def conversions(context: Any) -> Library:
    """The library of conversions, changes of equation, negation and selection, for a class of contexts."""
    K, flat = CONTEXTS[context], NUMBERS[context]
    # rows are stored in short integers where these suffice, other numbers in full words
    rows, numbers, R = replace(flat, ndim=2), replace(flat, stored=""), replace(flat, ndim=2, stored="")
    entries = {
        "encode_rows": (K, R, rows),
        "decode_rows": (K, rows, R),
        "shift_rows": (K, numbers, rows, BYTES, R),
        "scale_rows": (K, numbers, rows, BYTES),
        "first_off_curve": (K, TupleKind((numbers, numbers)), rows, BYTES, R),
        "negate_rows": (K, numbers, TupleKind((rows, BYTES)), rows, SPAN, R),
        "select_rows": (
            TupleKind((replace(flat, ndim=3), replace(BYTES, ndim=2), replace(BYTES, ndim=2))),
            INTS,
            TupleKind((rows, BYTES, BYTES)),
        ),
    }
    return _library("rows", context, row_loops, entries)


@cache
def cantor(context: Any) -> Library:
    """The library of Cantor's algorithm on rows, for a class of contexts."""
    rows, table = TupleKind((replace(NUMBERS[context], ndim=2), BYTES, BYTES)), ArrayKind(INT, 2)
    room = record(row_loops.Room, table, INTS, INTS)
    counts = {"cantor_add": 2, "cantor_double": 1, "cantor_negate": 1}
    entries = {
        name: (CONTEXTS[context], INTS, TupleKind((rows,) * count), rows, INTS, room) for name, count in counts.items()
    }
    return _library("cantor", context, row_loops, entries)


@cache
def points(context: Any) -> Library:
    """The library of random points and the classes through them, for a class of contexts."""
    K, flat = CONTEXTS[context], replace(NUMBERS[context], stored="")
    table = replace(flat, ndim=2)
    differences = record(random_loops.Differences, flat, flat)
    entries: dict[str, tuple[Any, ...]] = {"through_points": (K, TupleKind((table, table)), table, BYTES, differences)}
    if context not in (tables.BinaryTable, tables.OddTable):
        chains = record(random_loops.Powers, flat, flat, table)
        roots = TupleKind((INTS, flat.item, INT))
        entries["lift"] = K, flat, roots, flat, flat, BYTES, BYTES, chains
    return _library("points", context, random_loops, entries)


def _library(name: str, context: type, module: Any, entries: dict[str, tuple[Any, ...]]) -> Library:
    functions = {each: (getattr(module, each), kinds) for each, kinds in entries.items()}
    return Library(f"{name}_of_{context.__name__}".lower(), functions)
