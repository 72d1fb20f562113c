"""Compiles every library of loops beforehand: ``python -m jacobian compile``.

Compiled code is stored in the folder of :func:`jacobian.native.kept.place`, for this version of the code and for this
processor. A library that is not there is compiled at its first use.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from time import perf_counter
from typing import Any

from jacobian.addition.calls import library as of_classes
from jacobian.addition.class_loops import Plain
from jacobian.addition.short import BinaryQuintic, BinarySextic, Quintic, Septic, Sextic
from jacobian.arithmetic import decision, walk
from jacobian.batch import libraries as of_rows
from jacobian.batch import sums
from jacobian.finite import hasse_witt, miller, product_kernels
from jacobian.native.library import Library
from jacobian.numbers.binary import BinaryTwoWords, BinaryWord
from jacobian.numbers.tables import BinaryTable, OddTable
from jacobian.numbers.two_words import TwoWords
from jacobian.numbers.words import Double, Lazy32, Lazy64, Wide32, Wide64
from jacobian.relatives import pseudo_sums

BINARY: tuple[Any, ...] = (BinaryTable, BinaryWord, BinaryTwoWords)
ON_ROWS: tuple[Any, ...] = (Wide32, Wide64, OddTable, TwoWords, *BINARY)
"""The contexts for which the loops on arrays of divisors are compiled. A context has the constants of a field's
arithmetic, and its class is that of all fields with the same compiled code. Sums by explicit formulas are compiled for
further contexts.
"""


def equations(context: Any) -> tuple[Any, ...]:
    """The classes of short equations (:mod:`jacobian.addition.short`) whose formulas are compiled for a context."""
    if context in BINARY:
        return BinaryQuintic, BinarySextic
    return (Quintic, Sextic) if context in (OddTable, Double) else (Quintic, Sextic, Septic)


def libraries() -> Iterator[Library]:
    """Yields every library of compiled loops."""
    for context in (Wide64, OddTable, TwoWords, *BINARY):
        models = (
            equations(context) if context in (TwoWords, BinaryWord, BinaryTwoWords) else (Plain, *equations(context))
        )
        yield from (of_classes(context, model) for model in models)
    for context in ON_ROWS:
        yield of_rows.conversions(context)
        if context not in (BinaryWord, BinaryTwoWords):
            yield of_rows.points(context)
        if context not in (TwoWords, BinaryWord, BinaryTwoWords):
            yield of_rows.cantor(context)
    for context in (Lazy32, Lazy64, Double, *ON_ROWS):
        yield from (of_rows.sums(context, model) for model in equations(context))
    yield from (sums.library(*kind) for kind in product((False, True), (6, 7)) if kind != (True, 6))
    yield from (decision.library(), walk.library(), hasse_witt.library(), product_kernels.kernels())
    yield from (miller.LIBRARY, pseudo_sums.COMPILED)


def compile_all() -> Iterator[tuple[str, float]]:
    """Compiles the libraries one after the other; yields (name, seconds) of each. Loading a library from disk takes
    about 10 ms.
    """
    for library in libraries():
        begun = perf_counter()
        library.load()
        yield library.name.replace("_", " "), perf_counter() - begun
