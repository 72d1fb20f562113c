"""GF(2^n) on one word and two: compiled with and without the processor's product, in Python, and by python-flint."""

import flint
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from jacobian import ArgumentError
from jacobian.native.binary import CONTEXTS
from jacobian.native.kinds import LONG
from jacobian.native.library import Library
from jacobian.numbers import words
from jacobian.numbers.binary import binary_context, carryless_product, product_of_words


def irreducible(degree, tail):
    """The first irreducible polynomial from x^degree + tail on."""
    number = (1 << degree) + tail
    while True:
        factors = flint.nmod_poly([number >> i & 1 for i in range(degree + 1)], 2).factor()[1]
        if len(factors) == 1 and factors[0][1] == 1:
            return number
        number += 2


DENSE = 0x5DEECE66D
MODULI = [0b111, 0b1011, 0x11B, *(irreducible(n, tail) for n in (61, 63, 64, 89, 127) for tail in (1, DENSE))]
ELEMENT = st.one_of(st.integers(0, 3), st.integers(1, 4).map(lambda k: -k), st.integers(0, 2**128 - 1))
WORD = st.integers(0, 2**64 - 1)


def operations(K, a, b, c, d):
    first = K.dot(a, b), K.dot(a, b, c, d), K.dot(a, b, c, d, a, c)
    sums = K.add(a, b), K.sub(a, b), K.neg(a), K.fit(a), K.settled(a)
    last = K.dot(a, b, c, d, a, c, b, d), K.to_word(a), K.from_word(a), K.canonical(a)
    return (*first, K.dot(c, c), *sums, *last)


def inverted(K, a):
    return words.inverse(K, a)


# without the processor's instruction
PORTABLE = {product_of_words: lambda b, x, y: None}
LIBRARIES = {
    (name, kind): Library(
        f"test_binary_{name}_{kind.__name__}",
        {"operations": (operations, (K, *[LONG] * 4)), "inverted": (inverted, (K, LONG))},
        functions,
    )
    for name, functions in (("portable", PORTABLE), ("here", {}))
    for kind, K in CONTEXTS.items()
}
PRODUCT = Library("test_binary_product", {"product": (product_of_words, (LONG, LONG))}, PORTABLE)


@pytest.mark.thinned(4)
@pytest.mark.parametrize("modulus", MODULI, ids=hex)
@settings(max_examples=40)
@given(elements=st.tuples(*[ELEMENT] * 4))
@example(elements=(-1, -1, -1, -1))
def test_operations(modulus, elements):
    K = binary_context(modulus)
    n = K.degree
    polynomials = flint.fmpz_mod_poly_ctx(flint.fmpz_mod_ctx(2))
    F = flint.fq_default_ctx(modulus=polynomials([modulus >> i & 1 for i in range(n + 1)]))
    elements = [x % (1 << n) for x in elements]
    a, b, c, d = (F([x >> i & 1 for i in range(n)]) for x in elements)
    x = [K.to_word(e) for e in elements]
    assert [K.from_word(y) for y in x] == elements
    found = operations(K, *x)
    for name in ("portable", "here"):
        run = LIBRARIES[name, type(K)]
        assert run.operations(K, *x) == found
        if elements[0]:
            assert K.dot(run.inverted(K, x[0]), x[0]) == K.one
            assert run.inverted(K, x[0]) == words.inverse(K, x[0])
    product, two, three, square, plus, minus, same, fitted, settled, four, encoded, decoded, least = found
    totals = a * b, a * b + c * d, a * b + c * d + a * c, c * c, a + b, a - b, a * b + c * d + a * c + b * d
    for word, total in zip((product, two, three, square, plus, minus, four), totals, strict=True):
        assert K.from_word(word) == sum(int(e) << i for i, e in enumerate(total.to_list()))
    assert {same, fitted, settled, least} == {x[0]}
    assert decoded == elements[0]
    assert K.from_word(encoded) == x[0]


@settings(max_examples=200)
@given(x=WORD, y=WORD)
@example(x=2**64 - 1, y=2**64 - 1)
def test_products_of_words(x, y):
    assert PRODUCT.product(x, y) == product_of_words(x, y) == carryless_product(x, y)


@pytest.mark.parametrize("modulus", MODULI[:3])
def test_every_inverse_of_a_small_field(modulus):
    K = binary_context(modulus)
    for x in range(1, 1 << K.degree):
        assert K.dot(words.inverse(K, x), x) == K.one


@pytest.mark.parametrize("modulus", [0b11, 0b110, (1 << 128) + 135, 0])
def test_what_two_words_do_not_hold(modulus):
    with pytest.raises(ArgumentError, match="irreducible polynomial of degree 2 to 127"):
        binary_context(modulus)
