"""Double-double arithmetic against exact rational arithmetic, with the proven bounds."""

import operator
from fractions import Fraction
from math import isqrt
from random import Random

import gmpy2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jacobian import MP, ArgumentError
from jacobian.inexact import genus2_real
from jacobian.native.kinds import FLOATS, INT, WIDE, WIDES, ArrayKind
from jacobian.native.library import Library
from jacobian.native.program import Program
from jacobian.native.special import SPECIAL
from jacobian.numbers import double_double
from jacobian.numbers.long_reals import BareReals

U2 = Fraction(1, 2**106)  # u², u = 2^-53
OPERATIONS = {
    "x + y": (3, operator.add),
    "x - y": (3, operator.sub),
    "x * y": (4, operator.mul),
    "x / y": (Fraction(49, 5), operator.truediv),
    "x + float": (2, lambda x, y, z: x + z),
    "float - x": (2, lambda x, y, z: z - x),
    "x * float": (2, lambda x, y, z: x * z),
    "float / x": (Fraction(49, 5), lambda x, y, z: z / x),
    "x / float": (3, lambda x, y, z: x / z),
    "-x": (0, lambda x, y, z: -x),
    "abs(x)": (0, lambda x, y, z: abs(x)),
    "max(1, x, y)": (0, lambda x, y, z: max(1, x, y)),
    "min(x, y, float)": (0, lambda x, y, z: min(x, y, z)),
    "float(x)": (0, None),
    "int + x": (2, lambda x, y, z: 3 + x),
    "x - int": (2, lambda x, y, z: x - 7),
    "x * int": (2, lambda x, y, z: x * 3),
    "int / x": (Fraction(49, 5), lambda x, y, z: 2 / x),
    "root(abs(x))": (Fraction(25, 8), None),
}


def evaluate(xs, ys, floats, rows, relations):
    for i in range(len(xs)):
        x, y, z, row = xs[i], ys[i], floats[i], rows[i]
        row[0] = x + y
        row[1] = x - y
        row[2] = x * y
        row[3] = x / y
        row[4] = x + z
        row[5] = z - x
        row[6] = x * z
        row[7] = z / x
        row[8] = x / z
        row[9] = -x
        row[10] = abs(x)
        row[11] = max(1, x, y)
        row[12] = min(x, y, z)
        row[13] = float(x)
        row[14] = 3 + x
        row[15] = x - 7
        row[16] = x * 3
        row[17] = 2 / x
        row[18] = genus2_real.root(abs(x))
        relations[i, 0] = x < y
        relations[i, 1] = x <= y
        relations[i, 2] = x > y
        relations[i, 3] = x >= y
        relations[i, 4] = x == y
        relations[i, 5] = x != y
        relations[i, 6] = x < z
        relations[i, 7] = z <= x
        relations[i, 8] = x == z
        relations[i, 9] = x > 1


def polynomials(table, points, out):
    """Variables that are first an integer or a float; in-place operators; rows and items of arrays."""
    for i in range(len(table)):
        total, last, point = 0, 1.0, points[0]
        for k in range(len(table[i])):
            total = total * point + table[i][k]
            last = total
        total += 1
        total -= point
        total *= 2
        total /= 3.0
        out[i] = total + 0 * last


TABLES = ArrayKind(WIDE, 2, 2)
LOOPS = Library(
    "test_double_double",
    {
        "evaluate": (evaluate, (WIDES, WIDES, FLOATS, TABLES, ArrayKind(INT, 2))),
        "polynomials": (polynomials, (TABLES, WIDES, WIDES)),
    },
    SPECIAL,
)


def check(triples):
    """Every operation on every (x, y, float), all nonzero, with x and y as pairs: within the bounds, and normalized."""
    first, second = (np.array([row[k] for row in triples]) for k in (0, 1))
    floats = np.array([row[2] for row in triples])
    out, relations = np.empty((len(triples), len(OPERATIONS), 2)), np.empty((len(triples), 10), dtype=np.int64)
    LOOPS.evaluate(first, second, floats, out, relations)
    for i, (pair, pair2, single) in enumerate(triples):
        x, y, z = sum(map(Fraction, pair)), sum(map(Fraction, pair2)), Fraction(single)
        for k, (name, (bound, exact)) in enumerate(OPERATIONS.items()):
            high, low = out[i, k]
            assert high + low == high
            found = Fraction(high) + Fraction(low)
            if name == "root(abs(x))":
                assert_root(found, abs(x), bound)
                continue
            if name == "float(x)":
                assert (high, low) == (float(x), 0)
                continue
            true = exact(x, y) if k < 4 else exact(x, y, z)
            assert abs(found - true) <= bound * U2 * (1 + Fraction(1, 10**12)) * abs(true), (name, pair, pair2, single)
        expected = [x < y, x <= y, x > y, x >= y, x == y, x != y, x < z, z <= x, x == z, x > 1]
        assert relations[i].tolist() == expected


def assert_root(found, square, bound):
    shift = 2 ** (2 * (400 - (square.numerator.bit_length() - square.denominator.bit_length()) // 2))
    true = Fraction(isqrt(int(square * shift)), isqrt(shift))
    assert abs(found - true) <= (bound * U2 + Fraction(1, 2**380)) * true


def normalized(high, low):
    """(hi, lo) with lo below half a unit of hi."""
    total = high + low
    return total, low - (total - high)


def random_number(rng, exponents):
    high = rng.choice((-1, 1)) * rng.uniform(1, 2) * 2.0 ** rng.randint(*exponents)
    # every distance between the parts: adjacent, with a gap of zeros, no low part
    kind = rng.randrange(4)
    low = 0.0 if kind == 0 else high * rng.uniform(-1, 1) * 2.0 ** -(53 if kind < 3 else rng.randint(54, 120))
    return normalized(high, low)


@pytest.mark.parametrize("exponents", [(0, 1), (-3, 3), (-60, 60), (-300, 300)])
def test_random_numbers(exponents):
    rng = Random(f"{exponents}")
    check([[random_number(rng, exponents), random_number(rng, exponents), rng.gauss(0, 2)] for _ in range(500)])


def test_cancellation():
    """y = −x up to the last bits of either part, and floats equal or next to the high part."""
    rng, rows = Random(5), []
    for _ in range(1000):
        x = random_number(rng, (-4, 4))
        change = rng.choice((0.0, 1.0, -1.0)) * 2.0 ** rng.choice((-50, -53, -90, -104, -106)) * x[0]
        y = normalized(-x[0], -x[1] + change)
        rows.append([x, y if rng.random() < 0.7 else (-y[0], -y[1]), np.nextafter(x[0], rng.choice((-9e9, x[0], 9e9)))])
    check(rows)


parts = st.floats(min_value=1e-60, max_value=1e60) | st.floats(min_value=-1e60, max_value=-1e-60)
pairs = st.builds(lambda high, part: normalized(high, high * part * 2.0**-53), parts, st.floats(-1, 1))


@settings(max_examples=100)
@given(st.lists(st.tuples(pairs, pairs, parts), min_size=1, max_size=4))
def test_any_numbers(triples):
    check(triples)


def test_zero():
    out, relations = np.empty((1, len(OPERATIONS), 2)), np.empty((1, 10), dtype=np.int64)
    LOOPS.evaluate(np.zeros((1, 2)), np.array([[2.0, 0.0]]), np.array([0.5]), out, relations)
    found = dict(zip(OPERATIONS, out[0].tolist(), strict=True))
    assert found["x + y"] == [2, 0]
    assert found["x * y"] == found["x / y"] == found["root(abs(x))"] == found["abs(x)"] == [0, 0]
    assert found["x / float"] == [0, 0]


def test_in_place_and_mixed_variables():
    table = [[Fraction(1, 3), Fraction(-2, 7), Fraction(5, 11)], [Fraction(1), Fraction(2), Fraction(1, 9)]]
    x, out = Fraction(1, 13), np.empty((2, 2))
    LOOPS.polynomials(double_double.pack(table), double_double.pack([x]), out)
    for row, found in zip(table, double_double.unpack(out), strict=True):
        true = ((row[0] * x + row[1]) * x + row[2] + 1 - x) * 2 / 3
        assert abs(found - true) < 40 * U2


def test_no_instruction_of_double_doubles_may_be_contracted():
    """An optimizer that contracts or reorders sums would find the error terms to be zero; in floats it may contract."""
    text = {}
    for kinds in ((WIDES, WIDES, FLOATS, TABLES, ArrayKind(INT, 2)), (FLOATS, FLOATS)):
        program = Program(SPECIAL)
        program.entry("entry", evaluate if len(kinds) > 2 else products, kinds)
        text[len(kinds)] = program.text()
    assert "contract" not in text[5]
    assert "fmul contract double" in text[2]


def products(xs, ys):
    return xs[0] * ys[0] + xs[1]


@pytest.mark.parametrize("array", [np.ones((2, 4))[:, ::2], np.ones((2, 2), dtype=np.float32), np.ones(2)])
def test_what_is_no_array_of_numbers(array):
    with pytest.raises(TypeError, match="is needed, C-contiguous"):
        LOOPS.polynomials(np.ones((1, 1, 2)), array, np.ones((1, 2)))


# --- conversions ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("x", "expected"),
    [
        (2**53 + 1, (2.0**53, 1.0)),
        (np.int64(2**53 + 1), (2.0**53, 1.0)),
        (0.1, (0.1, 0.0)),
        (np.float64(0.1), (0.1, 0.0)),
        (Fraction(1) + Fraction(1, 2**80), (1.0, 2.0**-80)),
        (MP(40).coerce(1) + MP(40).coerce(2) ** -100, (1.0, 2.0**-100)),
        (0, (0.0, 0.0)),
    ],
)
def test_split(x, expected):
    assert double_double.split(x) == expected


@given(st.fractions(-(10**9), 10**9))
def test_split_is_the_nearest(x):
    high, low = double_double.split(x)
    assert high == float(x)
    assert abs(Fraction(high) + Fraction(low) - x) <= U2 * abs(x)


def test_split_of_a_long_double_keeps_its_rest():
    third = np.longdouble(1) / 3
    high, low = double_double.split(third)
    assert np.longdouble(high) + low == third


@pytest.mark.parametrize("bits", [40, 60, 200, 900])
def test_split_of_long_reals_does_not_depend_on_their_context(bits):
    reals = BareReals(bits)
    with reals:
        numbers = [reals.number(k) / 7 * reals.number(10) ** (k - 5) for k in range(-3, 12)]
    for x in numbers:
        high, low = double_double.split(x)
        exact = Fraction(*map(int, x.as_integer_ratio()))
        assert high == float(exact)
        assert abs(Fraction(high) + Fraction(low) - exact) <= U2 * abs(exact)
    with pytest.raises(ArgumentError, match="x ="), reals:
        double_double.split(reals.number(0) / 0)


@pytest.mark.parametrize(
    "x",
    ["0.1", None, 1j, float("nan"), float("inf"), 10**400, Fraction(10**400), gmpy2.mpfr("1e400"), gmpy2.mpc(1, 2)],
)
def test_what_is_no_real_number(x):
    with pytest.raises(ArgumentError, match="x ="):
        double_double.split(x)
    with pytest.raises(ArgumentError, match="x ="):
        double_double.pack([1.0, x])


def test_arrays():
    K = MP(50)
    third = K.one / 3
    packed = double_double.pack([[third, 1, 0.5], [-third, Fraction(1, 3), 2**60 + 1]])
    assert packed.shape == (2, 3, 2)
    back = double_double.unpack(packed, K.coerce)
    assert abs(back[0][0] - third) < K.coerce(2) ** -107
    assert back[1][2] == 2**60 + 1
    assert double_double.unpack(packed)[1][1] == double_double.unpack(packed)[0][0]
    assert double_double.pack(third).shape == (2,)
    assert np.array_equal(double_double.pack(np.arange(3.0)), [[0, 0], [1, 0], [2, 0]])
    with pytest.raises(ArgumentError, match="last axis"):
        double_double.unpack(np.zeros((2, 3)))
