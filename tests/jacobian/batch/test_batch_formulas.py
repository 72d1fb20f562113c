"""The two-halves formulas of genus 2: no word overflows, and their values are those of Cantor."""

from fractions import Fraction

import pytest

from jacobian.addition import genus2_words as formulas
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


def test_the_bounds_catch_an_overflow():
    with pytest.raises(AssertionError, match="exceeds"):
        Bounds(True).dot(1, 1, 1, 1, HALF, HALF)
    with pytest.raises(AssertionError, match="exceeds"):
        Bounds(False).add(3, 2)
