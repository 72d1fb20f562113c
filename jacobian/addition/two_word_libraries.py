"""The compiled loops of :mod:`jacobian.addition.two_word_loops`: for each kind of field and equation one library for
single classes and one for rows.
"""

from __future__ import annotations

from typing import Any

from jacobian.addition import genus2_words, genus3_words, two_word_loops, two_word_steps
from jacobian.addition.genus2_words import BinaryQuintic, BinarySextic, Quintic, Sextic
from jacobian.addition.genus3_words import Septic
from jacobian.curve.curve import HyperellipticCurve
from jacobian.native import binary, modular
from jacobian.native.kinds import INT, INTS, LONG, LONGS, ArrayKind, TupleKind, record
from jacobian.native.library import Library
from jacobian.numbers.binary import BinaryContext, binary_context
from jacobian.numbers.two_words import TwoWords, two_words

COEFFICIENTS = {Quintic: 3, Sextic: 5, BinaryQuintic: 6, BinarySextic: 9, Septic: 4}
MODELS = {model: record(model, *[LONG] * count) for model, count in COEFFICIENTS.items()}
CONTEXTS: dict[type, Any] = {TwoWords: modular.CONTEXT, **binary.CONTEXTS}
ROWS = ArrayKind(LONG, 2, 2)
WITH_DEGREES, SPAN = TupleKind((ROWS, INTS)), TupleKind((INT, INT))


def context_of(K: Any) -> TwoWords | BinaryContext:
    """The context of GF(p), p odd, or GF(2^n), n > 1."""
    if K.characteristic == 2:
        return binary_context(sum(c << i for i, c in enumerate(K.modulus)))
    return two_words(K.p)


def equation_of(C: HyperellipticCurve, to_word: Any) -> Any:
    """The coefficients that the explicit formulas of genus 2 or 3 use; None if they do not apply."""
    return genus2_words.short_equation(C, to_word) or genus3_words.short_equation(C, to_word)


def _library(name: str, context: type, model: type, entries: dict[str, tuple[Any, ...]]) -> Library:
    functions = {each: (getattr(two_word_loops, each), (CONTEXTS[context], *kinds)) for each, kinds in entries.items()}
    return Library(f"{model.__name__.lower()}_{name}_of_{context.__name__.lower()}", functions)


def _single(context: type, model: type) -> Library:
    C, residues = MODELS[model], TupleKind((LONG,) * (2 * two_word_steps.GENUS[model]))
    entries = {
        "add_classes": (C, residues, residues),
        "double_class": (C, residues),
        "multiple_of_class": (C, residues, INTS, ROWS),
    }
    return _library("classes", context, model, entries)


def _rows(context: type, model: type) -> Library:
    C = MODELS[model]
    entries = {
        "add_rows": (C, WITH_DEGREES, WITH_DEGREES, ROWS, SPAN, INTS, ROWS),
        "double_rows": (C, WITH_DEGREES, ROWS, SPAN, INTS, ROWS),
        "negate_rows": (C, LONGS, WITH_DEGREES, ROWS, SPAN, ROWS),
        "encode_rows": (ROWS,),
        "decode_rows": (ROWS,),
        "shift_rows": (LONGS, ROWS, INTS, ROWS),
        "scale_rows": (LONGS, ROWS, INTS),
        "first_off_curve": (TupleKind((LONGS, LONGS)), ROWS, INTS, ROWS),
    }
    return _library("rows", context, model, entries)


_KINDS = [
    (context, model) for context in CONTEXTS for model in MODELS
    if (context is TwoWords) == (model in (Quintic, Sextic, Septic))
]  # fmt: skip
SINGLE_LIBRARIES = {kinds: _single(*kinds) for kinds in _KINDS}
"""The libraries for single classes, by the kinds of context and equation."""
ROW_LIBRARIES = {kinds: _rows(*kinds) for kinds in _KINDS}
"""The libraries for rows, by the kinds of context and equation."""
