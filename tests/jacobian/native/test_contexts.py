"""What loops over fields are written with: methods, tables of functions by class, short integers, complex numbers."""

from math import sqrt
from random import Random
from typing import NamedTuple

import numpy as np
import pytest

from jacobian.native.kinds import (
    COMPLEX,
    FLOAT,
    INT,
    INTS,
    ArrayKind,
    CompileError,
    TupleKind,
    record,
)  # fmt: skip
from jacobian.native.library import Library


class Modulo(NamedTuple):
    """Sums of products modulo m, and a constant of the class."""

    m: int
    shift = 1

    def total(self, *terms):
        first = terms[0] * terms[1]
        return first if len(terms) == 2 else first + self.total(*terms[2:])

    def dot(self, *terms):
        return self.total(*terms) % self.m

    def moved(self, x):
        for _ in range(3):
            x = (x + self.shift) % self.m
        return x


class Twice(Modulo):
    """The same modulo m, with another constant."""

    shift = 2


def plain(K, x):
    return K.moved(x)


def again(K, x):
    return K.moved(K.moved(x))


STEPS = {plain: {Modulo: plain, Twice: again}}
ROUNDS = {Modulo: 1, Twice: 5}


def by_class(K, a, b, c):
    total = 0
    for i in range(3):
        total += (i + 1) * K.dot(a, b)
    if len((a, b)) == 3:
        total += a.nothing
    return total, K.dot(a, b, b, c, c, a), STEPS[plain][type(K)](K, a), K.shift + ROUNDS[type(K)]


def rows_by_class(K, x, out):
    for j in range(len(x)):
        first, second, third, fourth = by_class(K, x[j], x[j] + 1, 3)
        out[j] = first + 10 * second + 100 * third + 1000 * fourth


def shorts(words, marks, truths, out):
    for j in range(len(words)):
        out[j] = words[j] + marks[j]
        words[j] = -words[j]
        marks[j] = 255 - marks[j]
        truths[j] = not truths[j]


def complex_numbers(z, w, x, k):
    turned = z * w + x * z - w.conjugate()
    sizes = z.real * z.real + z.imag * z.imag, x.imag + x.real, x.conjugate()
    higher = z if x > 0 else 1 + z
    return turned, -z, z - x, x - z, k * z, z * (1 / sqrt(sizes[0])), higher, *sizes


def complex_rows(row, f, out):
    for i in range(len(row)):
        total = f[2]
        for k in range(2):
            total = total * row[i] + f[1 - k]
        out[i] = total


def quotient(z, w):
    return z / w


def unknown_method(K, x):
    return K.nothing(x)


def _library(kind, inlined_but):
    K, rows = record(kind, INT), (INTS, INTS)
    functions = {"by_class": (by_class, (K, INT, INT, INT)), "rows_by_class": (rows_by_class, (K, *rows))}
    return Library(f"test_contexts_{kind.__name__}_{inlined_but is None}", functions, inlined_but=inlined_but)


CLASSES = [(kind, _library(kind, but)) for kind in (Modulo, Twice) for but in (None, (), (again,))]
COMPLEXES = ArrayKind(COMPLEX, parts=2)
WORDS = {stored: ArrayKind(INT, stored=stored) for stored in ("int32", "uint16", "int8")}
LOOPS = Library(
    "test_contexts",
    {
        **{
            f"shorts_{stored}": (shorts, (kind, ArrayKind(INT, stored="uint8"), ArrayKind(INT, stored="bool"), INTS))
            for stored, kind in WORDS.items()
        },
        "complex_numbers": (complex_numbers, (COMPLEX, COMPLEX, FLOAT, INT)),
        "complex_rows": (complex_rows, (COMPLEXES, TupleKind((COMPLEX,) * 3), COMPLEXES)),
    },
)


@pytest.mark.parametrize(("kind", "library"), CLASSES)
def test_methods_and_tables_of_functions(kind, library):
    K, rng = kind(101), Random(kind.__name__)
    for _ in range(50):
        numbers = [rng.randrange(101) for _ in range(3)]
        assert library.by_class(K, *numbers) == by_class(K, *numbers)
    x, out, expected = np.arange(101), np.zeros(101, np.int64), np.zeros(101, np.int64)
    library.rows_by_class(K, x, out)
    rows_by_class(K, x, expected)
    assert out.tolist() == expected.tolist()


@pytest.mark.parametrize("stored", WORDS)
def test_short_integers(stored):
    low, high = (0, 2) if stored == "uint16" else (-(2**7), 2**7)
    words = np.array([low, high - 1, 0, 1], stored)
    marks, truths = np.array([0, 255, 128, 7], np.uint8), np.array([True, False, True, False])
    expected, out = words.astype(np.int64) + marks, np.empty(4, np.int64)
    negated = (-words.astype(np.int64)).astype(stored)
    getattr(LOOPS, f"shorts_{stored}")(words, marks, truths, out)
    assert out.tolist() == expected.tolist()
    assert words.tolist() == negated.tolist()
    assert marks.tolist() == [255, 0, 127, 248]
    assert truths.tolist() == [False, True, False, True]


def test_complex_numbers():
    rng = Random(3)
    for _ in range(50):
        z, w = (complex(rng.gauss(0, 1), rng.gauss(0, 1)) for _ in range(2))
        x, k = rng.gauss(0, 1), rng.randrange(-9, 9)
        found, true = LOOPS.complex_numbers(z, w, x, k), complex_numbers(z, w, x, k)
        # the scalars of the result: two for each complex number
        wanted = [part for y in true for part in ((y.real, y.imag) if type(y) is complex else (y,))]
        assert len(found) == len(wanted)
        assert max(abs(a - b) for a, b in zip(found, wanted, strict=True)) < 1e-13


def test_complex_rows():
    rng = np.random.default_rng(1)
    row = rng.normal(size=20) + 1j * rng.normal(size=20)
    f, out, true = (1.5, -2j, 3 + 1j), np.empty((20, 2)), np.empty(20, complex)
    LOOPS.complex_rows(row.view(float).reshape(20, 2), f, out)
    complex_rows(row, f, true)
    assert np.abs(out.view(complex).ravel() - true).max() < 1e-13


@pytest.mark.parametrize(
    ("function", "kinds", "words"),
    [
        (quotient, (COMPLEX, FLOAT), "Div of complex numbers"),
        (unknown_method, (record(Modulo, INT), INT), "Modulo has no nothing"),
    ],
)
def test_what_is_refused(function, kinds, words):
    library = Library("test_contexts_refused", {"refused": (function, kinds)})
    with pytest.raises(CompileError, match=words):
        library.refused(*[1] * len(kinds))
