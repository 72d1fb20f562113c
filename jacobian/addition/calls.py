"""One addition, doubling or multiple of reduced triples, each in a single call of compiled code.

The loops are those of :mod:`jacobian.addition.class_loops`. They are compiled at their first use for a class of fields
and of equations, and stored on disk. Over fields of word size they cover all classes of all curves. Over GF(p) with p
of two words and GF(2^n), 16 < n < 128, only explicit formulas are compiled; the Python kernel takes the special cases.
"""

from __future__ import annotations

from functools import cache
from struct import Struct
from typing import Any

from jacobian.addition import class_loops
from jacobian.addition.cantor import Triple
from jacobian.addition.cantor_words import packed_curve, width
from jacobian.addition.class_loops import ROWS, Plain
from jacobian.addition.short import MODELS, short_equation
from jacobian.curve.curve import HyperellipticCurve
from jacobian.fields.table import TableField
from jacobian.native.direct import BYTES, Objects, Rows, Scratch
from jacobian.native.kinds import INT, INTS, LONG, ArrayKind, TupleKind, record
from jacobian.native.library import Library
from jacobian.native.words import CONTEXTS
from jacobian.numbers.binary import BinaryContext, binary_context
from jacobian.numbers.tables import BinaryTable, OddTable, table_context
from jacobian.numbers.two_words import TwoWords, two_words
from jacobian.numbers.words import Wide64, word_context


def context(K: Any) -> Any:
    """The context of a word-size field: the constants of its compiled arithmetic. All primes share one class of
    contexts, because loops are compiled separately for each class. A separate class for small primes would save only
    a tenth of the time of a multiple.
    """
    return table_context(K) if isinstance(K, TableField) else Wide64(*word_context(K.p, 64))


def two_word_context(K: Any) -> TwoWords | BinaryContext:
    """The context of GF(p), p odd and below 2^128, or GF(2^n), 1 < n < 128."""
    if K.characteristic == 2:
        return binary_context(sum(c << i for i, c in enumerate(K.modulus)))
    return two_words(K.p)


@cache
def library(context: type, model: type) -> Library:
    """The compiled loops for classes of contexts and of equations; ``Plain`` stands for Cantor's algorithm alone."""
    short = context in (Wide64, BinaryTable, OddTable)
    item = INT if short else LONG
    head = CONTEXTS[context], record(model, *[item] * len(model._fields))  # type: ignore[attr-defined]
    kinds: dict[str, tuple[Any, ...]] = {}
    if short:
        # the arguments: scratch memory, then two classes or one, and for a multiple the scalar and its digits
        kinds["sum_in_place"] = (INTS, Objects((Rows(ROWS), INTS)))
        kinds["multiple_in_place"] = (INTS, Objects((Rows(ROWS), INTS, BYTES, INTS), unlocked=True))
    if model is not Plain:
        g = MODELS[model][0].genus
        one = TupleKind((item,) * g), TupleKind((item,) * g)
        kinds["add_classes"], kinds["double_class"] = (Objects((*one, *one)),), (Objects(one),)
        if not short:
            odd = Scratch(ArrayKind(LONG, 2, 2), (2 * g, 8))
            kinds["multiple_of_class"] = (Objects((*one, BYTES, INTS, odd), unlocked=True),)
    entries = {name: (getattr(class_loops, name), (*head, *rest)) for name, rest in kinds.items()}
    return Library(f"classes_on_{model.__name__}_of_{context.__name__}".lower(), entries)


class WordKernel:
    """Addition, doubling and multiples of reduced triples on one curve that is its own ``arithmetic_model``, over a
    word-size field.

    Sums use Cantor's algorithm; multiples use the explicit formulas of ``equation`` where they apply.
    """

    def __init__(self, C: HyperellipticCurve, equation: Any = None) -> None:
        g, K = C.genus, context(C.field)
        equation = Plain() if equation is None else equation
        run, curve = library(K.__class__, equation.__class__), packed_curve(C, K.to_word)
        self._sum, self._times = (each(K, equation, curve) for each in (run.sum_in_place, run.multiple_in_place))
        # compiled calls use addresses of K and ``curve``, so both are kept alive; sums run one at a time in ``_room``
        self._pointed, self._size = (K, curve), 8 * ROWS * (4 * g + 8)
        self._room, self._split, self._middle = bytearray(self._size), C.model == "split", 4 + g
        self._result = Struct(f"{width(g)}q")
        # the struct at index k packs the k words of one or two classes, padded to the width of a result
        self._structs = [Struct(f"{count}q{8 * max(0, width(g) - count)}x") for count in range(6 + 2 * (2 * g + 1) + 1)]

    def sum_of(self, a: Triple, b: Triple) -> Triple:
        (u1, v1, n1), (u2, v2, n2) = a, b
        count = 6 + len(u1) + len(v1) + len(u2) + len(v2)
        pack = self._structs[count].pack
        data = bytearray(pack(len(u1), len(v1), n1 or 0, len(u2), len(v2), n2 or 0, *u1, *v1, *u2, *v2))
        self._sum(self._room, data)
        return self._unpacked(data)

    def double(self, a: Triple) -> Triple:
        return self.multiple(2, a)

    def multiple(self, m: int, a: Triple) -> Triple:
        u, v, n = a
        data = bytearray(self._structs[3 + len(u) + len(v)].pack(len(u), len(v), n or 0, *u, *v))
        self._times(bytearray(self._size), data, *scalar(m))
        return self._unpacked(data)

    def _unpacked(self, data: bytearray) -> Triple:
        words = self._result.unpack_from(data)
        nu, nv, n = words[:3]
        middle = self._middle
        return words[3 : 3 + nu], words[middle : middle + nv], n if self._split else None


def scalar(m: int) -> tuple[bytes, bytearray]:
    """The little-endian bytes of m > 0, and memory for its signed digits."""
    size = (m.bit_length() + 7) >> 3
    return m.to_bytes(size, "little"), bytearray(64 * size + 8)


class ExplicitKernel:
    """Addition and doubling by explicit formulas on a curve with a short equation, in the context K. The kernel
    ``others`` handles special cases.
    """

    def __init__(self, C: HyperellipticCurve, K: Any, equation: Any, others: Any) -> None:
        self._run = library(K.__class__, equation.__class__)
        self._add, self._twice = self._run.add_classes(K, equation), self._run.double_class(K, equation)
        self._K, self._others, self._genus = K, others, C.genus
        self._weight = 0 if C.model == "split" else None

    # if v has g coefficients, u has degree g; classes with a shorter v go to the kernel ``others``

    def sum_of(self, a: Triple, b: Triple) -> Triple:
        (u1, v1, _), (u2, v2, _) = a, b
        if len(v1) == self._genus == len(v2):
            u, v, general = self._add(u1, v1, u2, v2)
            if general:
                return u, v, self._weight
        return self._others.sum_of(a, b)

    def double(self, a: Triple) -> Triple:
        u, v, _ = a
        if len(v) == self._genus:
            u, v, general = self._twice(u, v)
            if general:
                return u, v, self._weight
        return self._others.double(a)

    def multiple(self, m: int, a: Triple) -> Triple:
        return self._others.multiple(m, a)


class TwoWordKernel(ExplicitKernel):
    """The kernel of a curve with a short equation over a field whose elements take two words; ``others`` is the kernel
    in Python.
    """

    def __init__(self, C: HyperellipticCurve, others: Any) -> None:
        K = two_word_context(C.field)
        equation = short_equation(C, K.to_word)
        super().__init__(C, K, equation, others)
        self._times = self._run.multiple_of_class(K, equation)

    def multiple(self, m: int, a: Triple) -> Triple:
        u, v, _ = a
        if len(v) == self._genus:
            u, v, general = self._times(u, v, *scalar(m))
            if general:
                return u, v, self._weight
        return super().multiple(m, a)


def word_kernel(C: HyperellipticCurve) -> WordKernel | ExplicitKernel:
    """The compiled kernel of a curve that is its own ``arithmetic_model``: over GF(p), 2 < p < 2^63, or TableField."""
    K = context(C.field)
    equation = short_equation(C, K.to_word)
    general = WordKernel(C, equation)
    return general if equation is None else ExplicitKernel(C, K, equation, general)


def is_kept(C: HyperellipticCurve, two_words: bool) -> bool:
    """Whether the compiled loops for C are on disk, those of :func:`two_word_context` if ``two_words``."""
    K: Any = (two_word_context if two_words else context)(C.field)
    equation: Any = short_equation(C, K.to_word) or Plain()
    return library(K.__class__, equation.__class__).is_kept()
