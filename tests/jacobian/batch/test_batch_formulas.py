"""The formulas of genus 2 and 3 before and after the inversion: no word overflows."""

from fractions import Fraction

import pytest

from jacobian.addition import genus2_words as formulas
from jacobian.addition import genus3_words
from tests.jacobian.numbers.word_bounds import Bounds, DoubleBounds

HALF = Fraction(1, 2)
STEPS = {
    model: [getattr(formulas, f"{step}_{degree}") for step in ("tangent", "product", "cubic", "sum_u", "sum_v")]
    for model, degree in (("ramified", "quintic"), ("split", "sextic"))
}
CURVES = {"ramified": formulas.Quintic(*[HALF] * 3), "split": formulas.Sextic(*[HALF] * 5)}


@pytest.mark.parametrize("K", [Bounds(False), Bounds(True), DoubleBounds()], ids=["lazy", "wide", "double"])
@pytest.mark.parametrize("model", STEPS)
def test_no_word_overflows(model, K):
    C, line = CURVES[model], (HALF,) * 4
    tangent, product, cubic_of, sum_u, sum_v = STEPS[model]
    for quotient in (formulas.chord(K, line, line), tangent(K, C, line)):
        assert K.canonical(product(K, C, quotient)) == HALF
        cubic = cubic_of(K, C, quotient, HALF, line)
        u = sum_u(K, C, cubic, line, line)
        assert (*u, *sum_v(K, C, cubic, u, line)) == line


@pytest.mark.parametrize("K", [Bounds(False), Bounds(True)], ids=["lazy", "wide"])
def test_no_word_overflows_in_genus_3(K):
    C, row = genus3_words.Septic(*[HALF] * 4), (HALF,) * 6
    for quotient in (genus3_words.chord(K, row, row), genus3_words.tangent(K, C, row)):
        assert K.canonical(genus3_words.product(K, quotient)) == HALF
        assert genus3_words.closed(K, C, quotient, HALF, row, row) == row


def test_the_bounds_catch_an_overflow():
    with pytest.raises(AssertionError, match="exceeds"):
        Bounds(True).dot(1, 1, 1, 1, HALF, HALF)
    with pytest.raises(AssertionError, match="exceeds"):
        Bounds(False).add(3, 2)
