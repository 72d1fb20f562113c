"""Two words: the compiled operations equal those on Python ints, and those equal arithmetic modulo p."""

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from jacobian import ArgumentError
from jacobian.native.kinds import LONG, TupleKind
from jacobian.native.library import Library
from jacobian.native.modular import CONTEXT
from jacobian.numbers import two_words as module
from jacobian.numbers import words
from jacobian.numbers.two_words import two_words

PRIMES = (
    3,
    5,
    2**31 - 1,
    2**63 - 25,
    2**63 + 29,
    2**64 - 59,
    2**64 + 13,
    2**89 - 1,
    2**126 - 137,
    2**127 - 1,
    2**128 - 159,
)
SMALL, ELEMENT = st.integers(0, 3), st.integers(0, 2**128 - 1)
ELEMENTS = st.tuples(*[st.one_of(SMALL, SMALL.map(lambda k: -k), ELEMENT)] * 4)


def operations(K, a, b, c, d):
    first = K.dot(a, b), K.dot(a, b, c, d), K.dot(a, b, c, d, a, c)
    sums = K.add(a, b), K.sub(a, b), K.neg(a), K.fit(a), K.settled(a)
    last = K.dot(a, b, c, d, a, c, b, d), K.to_word(a), K.from_word(a), K.canonical(a)
    return (*first, *sums, *last)


def inverted(K, a):
    return words.inverse(K, a)


COMPILED = Library(
    "test_two_words",
    {"operations": (operations, (CONTEXT, *[LONG] * 4)), "inverted": (inverted, (CONTEXT, LONG))},
)


@pytest.mark.thinned(2)
@pytest.mark.parametrize("p", PRIMES)
@settings(max_examples=80)
@given(elements=ELEMENTS)
@example(elements=(-1, -1, -1, -1))
def test_operations(p, elements):
    a, b, c, d = (x % p for x in elements)
    K = two_words(p)
    x = [K.to_word(e) for e in (a, b, c, d)]
    assert [K.from_word(y) for y in x] == [a, b, c, d]
    found = COMPILED.operations(K, *x)
    assert all(0 <= y < p for y in found)
    # the function in Python may leave −x unreduced
    assert [y % p for y in operations(K, *x)] == list(found)
    product, two, three, plus, minus, negative, fitted, settled, four, encoded, decoded, least = found
    totals = a * b, a * b + c * d, a * b + c * d + a * c, a + b, a - b, -a, a * b + c * d + a * c + b * d
    assert [K.from_word(y) for y in (product, two, three, plus, minus, negative, four)] == [t % p for t in totals]
    assert (fitted, settled, least, decoded) == (x[0], x[0], x[0], a)
    assert K.from_word(encoded) == x[0]
    if a:
        inverse = COMPILED.inverted(K, x[0])
        assert inverse == words.inverse(K, x[0])
        assert K.from_word(inverse) == pow(a, -1, p)


@pytest.mark.parametrize("p", PRIMES[:2])
def test_every_inverse_modulo_a_small_prime(p):
    K = two_words(p)
    for x in range(1, p):
        assert K.from_word(COMPILED.inverted(K, x)) * K.from_word(x) % p == 1


class Long(int):
    """A natural number below 2^128 as in compiled code, where shifts by 128 bits or more are undefined."""

    def __lshift__(self, n):
        assert 0 <= n < 128
        return int(self) << n


@pytest.mark.parametrize("p", PRIMES)
def test_an_inverse_shifts_by_less_than_two_words(p, monkeypatch):
    monkeypatch.setattr(module, "long", Long)
    K = two_words(p)
    for x in {1, 2, 3 % p or 1, p // 2, p - 1}:
        assert K.dot(module.inverse(K, x), x) == K.one


@pytest.mark.parametrize("p", [2, 1, 2**64, 2**128 + 51, -7])
def test_what_two_words_do_not_hold(p):
    with pytest.raises(ArgumentError, match="two words take an odd prime below 2"):
        two_words(p)


def test_a_line_is_a_row_of_longs():
    assert TupleKind((LONG,) * 2).leaves == ("i128", "i128")
