"""Words: the compiled operations equal those on Python ints, and those equal arithmetic modulo p."""

from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jacobian import ArgumentError
from jacobian.native.kinds import FLOAT, INT
from jacobian.native.library import Library
from jacobian.native.words import CONTEXTS
from jacobian.numbers import words
from jacobian.numbers.words import Double, Lazy32, Lazy64, OneWord, Wide32, Wide64, double_context, word_context

PRIMES = {Lazy32: (3, 5, 2**29 - 3), Wide32: (2**29 + 11, 2**31 - 1), Lazy64: (2**31 + 11, 2**61 - 1)}
PRIMES[Wide64] = (2**62 - 57, 2**63 - 25)
ROWS = [pytest.param(p, id=f"{kind.__name__}-{p}") for kind, primes in PRIMES.items() for p in primes]


def four_dots(K, a, b, c, d):
    return (
        K.dot(a, b),
        K.dot(a, b, c, d),
        K.dot(a, b, c, d, a, c),
        K.dot(a, b, c, d, a, c, b, d),
    )


def sums(K, x, y):
    return K.add(x, y), K.sub(x, y), K.neg(x), K.fit(x)


def least(K, x):
    return K.canonical(x), K.settled(x)


def inverted(K, x):
    return words.inverse(K, x)


def coded(K, a, x):
    return K.to_word(a), K.from_word(x)


def _library(kind):
    x = FLOAT if kind is Double else INT
    entries = {"four_dots": (four_dots, 4), "sums": (sums, 2), "least": (least, 1), "inverted": (inverted, 1)}
    if kind not in (Double, OneWord):
        entries["coded"] = coded, 2
    functions = {name: (function, (CONTEXTS[kind], *[x] * count)) for name, (function, count) in entries.items()}
    return Library(f"test_words_{kind.__name__}", functions)


COMPILED = {kind: _library(kind) for kind in (*PRIMES, Double, OneWord)}
"""The compiled functions above, for each kind of context."""
INVERSE = Library("test_words_inverse", {"inverse_modulo": (words.inverse_modulo, (INT, INT))})


def test_contexts():
    for kind, primes in PRIMES.items():
        for p in primes:
            assert type(word_context(p)) is kind
    assert type(word_context(7, 64)) is Lazy64
    assert type(word_context(2**61 - 1)) is Lazy64
    for p in (2, 9 * 2, 2**63 + 29, 1, -7):
        with pytest.raises(ArgumentError, match="p ="):
            word_context(p)
    for p, bits in ((2**31 + 11, 32), (7, 16)):
        with pytest.raises(ArgumentError, match="bits ="):
            word_context(p, bits)


@pytest.mark.parametrize("p", ROWS)
def test_dots(p):
    K, rng = word_context(p), Random(p)
    for _ in range(300):
        a, b, c, d = elements = [rng.randrange(p) for _ in range(4)]
        if rng.random() < 0.3:
            a, b, c, d = elements = [rng.choice([0, 1, p // 2, p // 2 + 1, p - 1]) for _ in range(4)]
        x = [K.to_word(e) for e in elements]
        assert [K.from_word(y) for y in x] == elements
        found = COMPILED[type(K)].four_dots(K, *x)
        products = (a * b, a * b + c * d, a * b + c * d + a * c, a * b + c * d + a * c + b * d)
        assert [K.from_word(y) for y in found] == [total % p for total in products]
        mine = (K.dot(*x[:2]), K.dot(*x), K.dot(*x, x[0], x[2]))
        assert found == (*mine, K.dot(*x, x[0], x[2], x[1], x[3]))


@pytest.mark.parametrize("p", ROWS)
def test_dots_at_the_bounds(p):
    """The largest operands and sums of products that are allowed, with every sign."""
    K = word_context(p)
    a, b = (p, p // 2) if K.wide else (4 * p, 2 * p)
    for x in (a, -a):
        for y in (b, -b):
            one, two, three, _ = COMPILED[type(K)].four_dots(K, x, y, y, x)
            results = {(x, y): one, (x, y, y, x): two} | ({} if K.wide else {(x, y, y, x, x, y): three})
            for arguments, result in results.items():
                assert result == K.dot(*arguments)
                total = sum(u * v for u, v in zip(arguments[::2], arguments[1::2], strict=True))
                assert (result << K.bits) % p == total % p
                assert abs(result) <= (abs(total) >> K.bits) + p // 2 + 1


@pytest.mark.parametrize("p", ROWS)
def test_sums_and_least_residues(p):
    K, rng = word_context(p), Random(p)
    ends = [0, 1, p // 2, -(p // 2), p // 2 - 1]
    for _ in range(200):
        x, y = (rng.choice(ends) if rng.random() < 0.3 else rng.randrange(p) - p // 2 for _ in range(2))
        assert COMPILED[type(K)].sums(K, x, y) == (
            K.add(x, y),
            K.sub(x, y),
            K.neg(x),
            K.fit(x),
        )
        assert (K.add(x, y) - x - y) % p == 0
        total = x + y if K.wide else x + y + x // 2
        canonical, settled = COMPILED[type(K)].least(K, total)
        assert canonical == settled == K.canonical(total) == K.settled(total)
        assert abs(canonical) <= p // 2
        assert (canonical - total) % p == 0
        if not K.wide:
            for far in (4 * p, -4 * p, 3 * p + x, x - 3 * p):
                assert COMPILED[type(K)].least(K, far)[1] == K.settled(far) == K.canonical((far + p // 2) % p - p // 2)


@pytest.mark.parametrize("p", ROWS)
def test_inverses_and_codes(p):
    K, rng = word_context(p), Random(p)
    for a in [1, p - 1, p // 2, p // 2 + 1, *(rng.randrange(1, p) for _ in range(100))]:
        x = K.to_word(a)
        assert COMPILED[type(K)].inverted(K, x) == words.inverse(K, x) == K.to_word(pow(a, -1, p))
        assert COMPILED[type(K)].coded(K, a, x) == (x, a) == (K.to_word(a), K.from_word(x))
    assert COMPILED[type(K)].coded(K, 0, 0) == (0, 0)


@given(st.data())
def test_modular_inverse(data):
    p = data.draw(st.sampled_from([primes[-1] for primes in PRIMES.values()]))
    x = data.draw(st.integers(1, p // 2)) * data.draw(st.sampled_from([1, -1]))
    found = INVERSE.inverse_modulo(x, p)
    assert found == words.inverse_modulo(x, p)
    assert found * x % p == 1
    assert abs(found) < p


# --- floats


@pytest.mark.parametrize("p", [3, 101, 2**31 + 11, 2**49 - 81])
def test_products_of_floats(p):
    """Exact up to the bounds: a product below 16·p², sums below 16·p."""
    K, rng = double_context(p), Random(p)
    for i in range(500):
        a, b, c, d = (rng.randint(-2 * p, 2 * p) for _ in range(4))
        if i < 100:
            a, b = rng.choice([4 * p - 1, 1 - 4 * p]), rng.choice([4 * p - 1, 4 * p - 2, p, p // 2])
        x = [float(e) for e in (a, b, c, d)]
        totals = (a * b, a * b + c * d, a * b + c * d + a * c, a * b + c * d + a * c + b * d)
        for terms, total, found in zip((1, 2, 3, 4), totals, COMPILED[type(K)].four_dots(K, *x), strict=True):
            assert found == int(found)
            assert (int(found) - total) % p == 0
            assert (int(K.dot(*x, *x)) - 2 * (a * b + c * d)) % p == 0
            # for each product, one half and three roundings of a quotient below 16·p
            assert abs(found) <= terms * 3.6 * p
        settled = COMPILED[type(K)].least(K, x[0])[1]
        assert (int(settled) - a) % p == 0
        assert abs(settled) <= p // 2


@pytest.mark.parametrize("p", [3, 101, 2**49 - 81])
def test_inverses_of_floats(p):
    K, rng = double_context(p), Random(p)
    for a in [1, p - 1, *(rng.randrange(1, p) for _ in range(100))]:
        assert COMPILED[type(K)].inverted(K, K.balanced(a)) == K.balanced(pow(a, -1, p))


def test_primes_that_floats_do_not_take():
    for p in (2, 9 * 2, 2**49 + 69):
        with pytest.raises(ArgumentError, match="below 2"):
            double_context(p)


@pytest.mark.parametrize("p", [3, 101, 2**29 - 3, 2**30 - 35])
def test_least_residues(p):
    """One remainder for four products, of residues in [0, p)."""
    K, rng = OneWord(p, 1), Random(p)
    run = COMPILED[OneWord]
    for i in range(200):
        a, b, c, d = x = [rng.randrange(p) for _ in range(4)] if i else [p - 1] * 4
        totals = a * b, a * b + c * d, a * b + c * d + a * c, a * b + c * d + a * c + b * d
        assert run.four_dots(K, *x) == tuple(total % p for total in totals)
        assert run.sums(K, a, b) == ((a + b) % p, (a - b) % p, -a % p, a)
        assert run.least(K, a) == (a, a)
        assert not a or run.inverted(K, a) == pow(a, -1, p)
