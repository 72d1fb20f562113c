"""Compiled loops compared with the same loops interpreted: every statement and operator, and the refusals."""

import json
import math
import subprocess
import sys
from fractions import Fraction
from random import Random
from typing import NamedTuple

import numpy as np
import pytest

from jacobian.native import kept
from jacobian.native.kinds import (
    FLOAT,
    FLOATS,
    INT,
    INTS,
    LONG,
    LONGS,
    WIDES,
    ArrayKind,
    CompileError,
    TupleKind,
    record,
)  # fmt: skip
from jacobian.native.library import Library, Packed
from jacobian.native.special import SPECIAL
from jacobian.numbers.abreast import abreast
from jacobian.numbers.double_double import pack, unpack
from jacobian.numbers.roots import negligible, root
from jacobian.numbers.sums import joined, plus_product

FACTOR = 3


class Pair(NamedTuple):
    first: float
    second: int


def whole_numbers(a, b):
    """Quotients rounded down, remainders, bits, powers."""
    return a // b, a % b, a << 3, a >> 1, a & b, a | b, -a, abs(a), max(a, b, 7), min(a, b), 2**5 + a * FACTOR, a != b


def real_numbers(x, y, n):
    low, high = min(x, y), max(1, x, y)
    mantissa, exponent = math.frexp(x)
    whole = math.floor(x) + math.ceil(y) + int(y)
    powers = 2.0**n * abs(x) ** 0.5
    functions = math.sin(x) + math.cos(y) * math.log(abs(x)) + math.exp(-abs(y)) + math.log2(high) + math.sqrt(high)
    between = low < x - y <= high or x != y
    return low, high, mantissa, exponent, whole, powers, functions, between, x / n, n / 3, math.ldexp(x, n), root(high)


def ways(n, row):
    """Loops with every kind of exit, conditions that must not be evaluated, both kinds of while."""
    total, seen, k = 0, 0.0, 0
    for i in range(n - 1, -1, -2):
        if i % 5 == 3:
            continue
        if total > 200:
            break
        total += i
    while k < len(row) and row[k] >= 0:
        seen += row[k]
        k += 1
    for x in row:
        seen += x if x > 0 else -x
    for size in (1, 2.5, n):
        if size > 40:
            break
        for _ in range(3):
            if seen > 1e9:
                continue
            seen += size
    while True:
        total += 7 if n in (13, k) else 9
        if total > 215:
            return total, seen, k
        if total % 11 == 0:
            break
    return -total, seen, k


def widened(n):
    """A variable that is first an integer and later a float, and an early return."""
    x, name = 0, (1, 2.0)
    for k in range(n):
        x += k / 2
        name = name[1], x
    if n > 3:
        return x, name
    return 0, name


def tuples(pair, numbers, k):
    (a, b), c = (pair.first, pair.second), numbers[k]
    other = Pair(a + c, b + 1)
    chosen = other if b > 2 else Pair(numbers[0], 0)
    return (*chosen, chosen.first, len(numbers), numbers[2])


def arrays(table, counts, out):
    rows, columns = table.shape
    for i in range(rows):
        row, part = table[i], out[i * columns : (i + 1) * columns]
        for j in range(columns):
            part[j] = row[j] + table[i, columns - 1 - j]
            part[j] *= counts[i]
        counts[i] += len(out[i : i + 100])
    out[0] = out[1] = ended(out)


def ended(row, last=2):
    return row[last] + row[len(row) - 1]


def wide_numbers(xs, y, n, out):
    total = 0
    for i in range(len(xs)):
        total = total * y + xs[i] / (n + 1) - i
    total -= xs[0] * 2 if total > y else y
    out[0], out[1], out[2] = total, root(abs(total)), max(total, xs[1], 3)
    out[3] = float(total) + negligible(xs[0], xs[1])
    out[4] = float(negligible(xs[0] * 1e-40, xs[1])) - n / xs[2]


def sum_of_products(xs, ys, sizes, out):
    total, beside = xs[0] * 0, 0.0
    for i in range(len(xs)):
        total = plus_product(total, xs[i], ys[i])
        beside = plus_product(beside, sizes[i], 0.5)
    out[0], out[1], out[2] = joined(total, total), plus_product(xs[0], 4, sizes[0]), 0 * xs[0] + beside


def long_numbers(a, b, n, row, out):
    """Natural numbers below 2^128: sums, shifts, bits, relations, arrays; an integer combined with one becomes one."""
    x, best = 1, a
    for i in range(len(row)):
        x = x + row[i]
        out[len(row) - 1 - i] = x - row[i]
        if row[i] > best or row[i] == 5:
            best = row[i]
    k = n + (3 if a < b else 7)
    return best, (a >> n) + (b >> k), a & b, a | b, a ^ b, (a & 255) << k, a <= b, a != b, bool(a), best if a > b else b


def larger(x, y):
    return x + y


def smaller(x, y):
    return x - y, 1


def twice(way, x, y):
    return again(way, x, y), way(y, x)


def again(way, x, y):
    return way(x, x * y)


def functions(x, y):
    """A function that is passed on as an argument: compiled separately for each, with results of different kinds."""
    (a, n), (b, m) = twice(smaller, x, y)
    c, d = twice(larger, x, y)
    return a, b, c, d, n + m


ROWS = ArrayKind(FLOAT, 2)
LOOPS = Library(
    "test_loops",
    {
        "whole_numbers": (whole_numbers, (INT, INT)),
        "real_numbers": (real_numbers, (FLOAT, FLOAT, INT)),
        "ways": (ways, (INT, FLOATS)),
        "widened": (widened, (INT,)),
        "tuples": (tuples, (record(Pair, FLOAT, INT), TupleKind((FLOAT,) * 3), INT)),
        "arrays": (arrays, (ROWS, INTS, FLOATS)),
        "functions": (functions, (FLOAT, FLOAT)),
        "long_numbers": (long_numbers, (LONG, LONG, INT, LONGS, LONGS)),
        "wide_numbers": (wide_numbers, (WIDES, FLOAT, INT, WIDES)),
        "sum_of_products": (sum_of_products, (WIDES, WIDES, FLOATS, WIDES)),
    },
    SPECIAL,
)


def same(found, true):
    assert len(found) == len(true)
    for x, y in zip(found, true, strict=True):
        if isinstance(y, tuple):
            y = y[0]
        assert x == y or abs(x - y) <= 1e-14 * abs(y), (found, true)


@pytest.mark.parametrize("size", [1, 1e-9, 1e9])
def test_sums_of_products(size):
    """Right to the digits of double-doubles relative to the sum of the terms' sizes, or to twice these digits."""
    rng = Random(5)
    for count in range(1, 30):
        xs, ys = ([Fraction(rng.getrandbits(104) - (1 << 103), 1 << 100) for _ in range(count)] for _ in range(2))
        if count > 3:
            # cancelling terms
            xs[-1], ys[-1] = -xs[1] * Fraction(size), ys[1] / Fraction(size)
        sizes, out = np.array([float(abs(x)) for x in xs]), np.empty((3, 2))
        LOOPS.sum_of_products(pack(xs), pack(ys), sizes, out)
        found = unpack(out)
        xs, ys = unpack(pack(xs)), unpack(pack(ys))
        true = [None] * 3
        sum_of_products(xs, ys, list(map(Fraction, sizes.tolist())), true)
        bound = 4 * count**2 * Fraction(2) ** -106 * sum(abs(x * y) for x, y in zip(xs, ys, strict=True))
        assert abs(found[0] - true[0]) <= bound
        assert abs(out[0, 1]) <= 2.0**-53 * abs(out[0, 0])
        assert abs(found[1] - true[1]) <= Fraction(2) ** -102 * abs(true[1]) + bound
        assert found[2] == true[2] or abs(found[2] - true[2]) <= 1e-15 * true[2]


def test_whole_numbers():
    rng = Random(1)
    for _ in range(300):
        a, b = rng.randint(-50, 50), rng.choice((-7, -3, -1, 1, 2, 5, 64))
        assert LOOPS.whole_numbers(a, b) == tuple(map(int, whole_numbers(a, b)))


def test_real_numbers():
    rng = Random(2)
    for _ in range(300):
        x, y, n = rng.uniform(-9, 9), rng.choice((rng.uniform(-9, 9), 2.0, -3.0)), rng.randint(1, 9)
        same(LOOPS.real_numbers(x, y, n), real_numbers(x, y, n))


def test_functions_as_arguments():
    same(LOOPS.functions(3.5, -1.25), functions(3.5, -1.25))


def test_ways_through():
    rng = Random(3)
    seen = set()
    for _ in range(300):
        row = [rng.choice((1.0, 2.5, 0.0, 3.0, -1.0)) for _ in range(rng.randint(0, 5))]
        n = rng.randint(0, 60)
        true = ways(n, row)
        same(LOOPS.ways(n, np.array(row)), true)
        seen.add(true[0] > 0)
    assert seen == {True, False}


@pytest.mark.parametrize("n", [0, 1, 3, 4, 9])
def test_a_variable_becomes_wider(n):
    x, *pair = LOOPS.widened(n)
    true, other = widened(n)
    assert (x, tuple(pair)) == (true, other)
    assert isinstance(x, float)


def test_tuples_and_fields():
    for b in (1, 5):
        for k in range(3):
            given = Pair(0.5, b), (1.0, 2.0, 4.0), k
            same(LOOPS.tuples(*given), tuples(*given))


def test_arrays():
    table, counts, out = np.arange(6.0).reshape(2, 3), np.array([2, 5]), np.zeros(6)
    found = counts.copy(), out.copy()
    arrays(table, counts, out)
    LOOPS.arrays(table, *found)
    assert (found[0].tolist(), found[1].tolist()) == (counts.tolist(), out.tolist())


def test_long_numbers():
    rng = Random(4)
    for _ in range(100):
        a, b = (rng.choice((rng.getrandbits(127), rng.getrandbits(63), 2**64, 2**128 - 1, 0, 7)) for _ in range(2))
        row, n = [rng.getrandbits(rng.choice((60, 64, 65, 125))) for _ in range(6)] + [5], rng.randint(1, 100)
        true_out = [0] * len(row)
        true = long_numbers(a, b, n, row, true_out)
        words = np.frombuffer(b"".join(x.to_bytes(16, "little") for x in row), np.int64).reshape(-1, 2)
        out = np.zeros_like(words)
        assert LOOPS.long_numbers(a, b, n, words, out) == true
        assert [int.from_bytes(x.tobytes(), "little") for x in out] == true_out


def test_wide_numbers():
    from fractions import Fraction

    xs = [Fraction(1, 3), Fraction(2, 7), Fraction(5, 11)]
    given, y, out = pack(xs), 0.75, np.empty((5, 2))
    LOOPS.wide_numbers(given, y, 4, out)
    total = Fraction(0)
    for i, x in enumerate(xs):
        total = total * Fraction(y) + x / 5 - i
    total -= xs[0] * 2 if total > y else Fraction(y)
    found = unpack(out)
    assert abs(found[0] - total) < Fraction(1, 10**30)
    assert abs(found[1] ** 2 - abs(total)) < Fraction(1, 10**30)
    assert found[2] == 3
    assert found[3] == Fraction(float(total))
    assert abs(found[4] - (1 - 4 / xs[2])) < Fraction(1, 10**30)


def test_not_a_number_holds_no_relation():
    nan = float("nan")
    found = LOOPS.real_numbers(nan, 2.0, 3)
    assert (found[1], found[7]) == (2.0, 1)


@pytest.mark.parametrize(
    "array", [np.zeros(3, dtype=np.float32), np.zeros(8)[::2], np.zeros((2, 2)), np.zeros(3, dtype=int)]
)
def test_arrays_of_another_kind_are_refused(array):
    with pytest.raises(TypeError, match="is needed, C-contiguous"):
        LOOPS.ways(1, array)


def test_words_made_beforehand():
    row = np.array([1.0, 2.0])
    assert LOOPS.ways(3, Packed(row, FLOATS)) == LOOPS.ways(3, row)


def test_libraries_that_are_forgotten_leave_the_others_alone():
    """An engine frees the target machine with which it was made."""
    import gc

    kept_one = Library("test_forgotten", {"widened": (widened, (INT,))}, SPECIAL)
    assert kept_one.widened(0)[0] == 0
    for k in range(3):
        library = Library(f"test_forgotten_{k}", {"ways": (ways, (INT, FLOATS))}, SPECIAL)
        call = library.ways
        del library
        gc.collect()
        assert call(3, np.ones(2))[2] == 2
    assert kept_one.widened(4)[0] == widened(4)[0]
    assert LOOPS.widened(4)[0] == widened(4)[0]


# --- what is not compiled


def with_a_list(n):
    return [n]


def unknown(n):
    return n + earlier  # noqa: F821


def two_kinds(n):
    x = n
    if n > 3:
        x = (n, n)
    return x


def recursive(n):
    return recursive(n - 1)


def negative_index(row):
    return row[-1]


def long_and_float(x):
    return x + 0.5


def long_quotient(x):
    return x // 3


def into_integers(counts):
    counts[0] = 0.5


def some_lanes_store(row):
    for i in abreast(0, len(row)):
        if row[i] > 0:
            row[i] = 0.0


@pytest.mark.parametrize(
    ("function", "kind", "words"),
    [
        (with_a_list, INT, "List is not compiled"),
        (unknown, INT, "earlier is not known"),
        (two_kinds, INT, "in one variable"),
        (recursive, INT, "calls itself"),
        (negative_index, FLOATS, "negative indices"),
        (into_integers, INTS, "into an array of"),
        (some_lanes_store, FLOATS, "only some lanes store"),
        (long_and_float, LONG, "for Kind"),
        (long_quotient, LONG, "FloorDiv of longs"),
    ],
)
def test_what_is_refused_says_where(function, kind, words):
    library = Library("test_refused", {"loop": (function, (kind,))}, SPECIAL)
    with pytest.raises(CompileError, match=f"line [0-9]+ of .*{function.__name__}: .*{words}"):
        library.loop(1)


def test_names_that_a_library_does_not_have():
    with pytest.raises(AttributeError, match="test_loops has no sine"):
        _ = LOOPS.sine


# --- on disk

SOURCE = """
from jacobian.native.kinds import INT
from jacobian.native.library import Library
from numbers_there import FACTOR
def times(n):
    return n * FACTOR
LIBRARY = Library("test_kept", {"times": (times, (INT,))}, {})
"""
RUN = """
import json, sys
sys.path.insert(0, sys.argv[1])
import logging
said = []
handler = logging.Handler()
handler.emit = lambda record: said.append(record.getMessage())
logging.getLogger("jacobian.native.library").addHandler(handler)
logging.getLogger("jacobian.native.library").setLevel(logging.INFO)
from loops_there import LIBRARY
print(json.dumps([LIBRARY.times(7), said]))
"""


SAID = "compiling test kept: once, a few seconds"


def run(folder, **environment):
    import os

    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", RUN, str(folder)],
        capture_output=True, text=True, timeout=100, check=False,
        env={**os.environ, "NUMBA_CACHE_DIR": str(folder / "kept"), "PYTHONDONTWRITEBYTECODE": "1", **environment},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_objects_are_kept_until_a_source_changes(tmp_path):
    (tmp_path / "loops_there.py").write_text(SOURCE)
    (tmp_path / "numbers_there.py").write_text("FACTOR = 3\n")
    assert run(tmp_path) == [21, [SAID]]
    assert run(tmp_path) == [21, []]
    (tmp_path / "loops_there.py").write_text(SOURCE.replace("n * FACTOR", "n * FACTOR + 1"))
    assert run(tmp_path) == [22, [SAID]]
    # a file that is not an object, or half of one
    (kept_file,) = (tmp_path / "kept").iterdir()
    kept_file.write_bytes(kept_file.read_bytes()[:-10])
    assert run(tmp_path) == [22, [SAID]]
    kept_file.write_bytes(b"nothing")
    assert run(tmp_path) == [22, [SAID]]


def test_a_number_is_looked_at_wherever_it_is_made(tmp_path):
    """A constant in a file without functions of the loops is computed from a constant in another file, which the loops
    do not name.
    """
    (tmp_path / "loops_there.py").write_text(SOURCE)
    (tmp_path / "numbers_there.py").write_text("from others_there import HALF\nFACTOR = 2 * HALF\n")
    (tmp_path / "others_there.py").write_text("HALF = 3\n")
    assert run(tmp_path) == [42, [SAID]]
    (tmp_path / "others_there.py").write_text("HALF = 5\n# read again\n")
    assert run(tmp_path) == [70, [SAID]]


def test_entries_that_are_called_otherwise_are_made_again(tmp_path):
    """The compiled code is in one file, and the way to call it in another."""
    lines = SOURCE.splitlines(keepends=True)
    (tmp_path / "numbers_there.py").write_text("def times(n):\n    return n + n\n")
    called = "from numbers_there import times\n" + "".join(x for x in lines if "FACTOR" not in x and "def " not in x)
    (tmp_path / "loops_there.py").write_text(called)
    assert run(tmp_path) == [14, [SAID]]
    (tmp_path / "loops_there.py").write_text(called.replace("(INT,)", "(FLOAT,)").replace("INT\n", "INT, FLOAT\n"))
    assert run(tmp_path) == [14.0, [SAID]]


def test_every_source_of_the_compiler_is_looked_at():
    """These are the modules of this package that a fresh process imports in order to compile, except those that any
    import loads.
    """
    needed = "import jacobian.native.library, jacobian.native.special, jacobian.native.modular, jacobian.native.binary"
    names = "import sys; print(*[m for m in sys.modules if m.startswith('jacobian.') and sys.modules[m].__file__])"
    said = [
        subprocess.run([sys.executable, "-c", f"{first}; {names}"], capture_output=True, text=True, check=True).stdout
        for first in ("import jacobian", f"import jacobian; {needed}")
    ]
    plain, there = (set(line.split()) for line in said)
    sources = kept.compiler()
    assert there - plain <= sources | {"jacobian.native", "jacobian.numbers"}
    assert {"jacobian.numbers.double_double_steps", "jacobian.numbers.double_double"} <= sources
    assert all(kept.stamps(sources).values())


def test_sources_that_are_compiled_are_looked_at(monkeypatch):
    """The sources that the compiler compiles count too: after a change of the multiplication of double-doubles an
    object is invalid.
    """
    from integrable.torus.compiled import LIBRARY

    assert LIBRARY.periods
    found = kept.find(kept.place(), "torus", LIBRARY._made_for())
    own = {"integrable.torus.theta_setup", "integrable.torus.states", "jacobian.numbers.fourier"}
    assert own | kept.compiler() <= set(found.modules)
    before = kept.stamps
    for changed in ("jacobian.numbers.double_double_steps", "integrable.torus.theta_setup"):
        monkeypatch.setattr(kept, "stamps", lambda modules, changed=changed: before(modules) | {changed: "other"})
        assert not LIBRARY.is_kept()
    monkeypatch.setattr(kept, "stamps", before)
    assert LIBRARY.is_kept()


def test_where_nothing_can_be_written(monkeypatch, tmp_path):
    from jacobian.numbers import compiler

    (tmp_path / "file").write_text("")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file"))
    assert kept.place() is None
    compiler.say_once.cache_clear()
    library = Library("test_nowhere", {"widened": (widened, (INT,))}, SPECIAL)
    with pytest.warns(compiler.NoCacheWarning):
        assert library.widened(0)[0] == 0
