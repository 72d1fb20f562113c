"""The formulas of genus 2 and 3 before and after the inversion: no word overflows."""

from fractions import Fraction

import pytest

from jacobian.addition.short import Quintic, Septic, Sextic
from jacobian.addition.word_steps import STEPS
from tests.jacobian.numbers.word_bounds import Bounds, DoubleBounds

HALF = Fraction(1, 2)
CONTEXTS = [Bounds(False), Bounds(True), DoubleBounds()]
NAMES = ["lazy", "wide", "double"]


def steps_of(model):
    """The steps, and an equation and a class whose numbers are as large as canonical ones get."""
    return STEPS[model], model(*[HALF] * len(model._fields)), (HALF,) * (2 * model.genus)


def both_quotients(steps, K, C, row):
    return steps.chord(K, C, row, row), steps.tangent(K, C, row)


@pytest.mark.parametrize("K", CONTEXTS, ids=NAMES)
@pytest.mark.parametrize("model", [Quintic, Sextic], ids=["ramified", "split"])
def test_no_word_overflows(model, K):
    steps, C, line = steps_of(model)
    # the second half of a row may follow either of the two
    quotient = tuple(map(max, *both_quotients(steps, K, C, line)))
    assert K.canonical(steps.product(K, C, quotient)) == HALF
    cubic = steps.cubic(K, C, quotient, HALF, line)
    u = steps.u(K, C, cubic, line, line)
    assert (*u, *steps.v(K, C, cubic, u, line)) == line
    assert steps.closed(K, C, quotient, HALF, line, line) == line
    assert steps.opposite(K, C, line) == line


@pytest.mark.parametrize("K", CONTEXTS, ids=NAMES)
def test_no_word_overflows_in_genus_3(K):
    steps, C, row = steps_of(Septic)
    quotient = tuple(map(max, *both_quotients(steps, K, C, row)))
    assert K.canonical(steps.product(K, C, quotient)) == HALF
    bent = steps.bent(K, C, quotient, HALF)
    meeting = steps.meeting(K, C, bent, row, row)
    middle = steps.middle(K, C, bent, meeting, row, row)
    u = steps.u(K, C, meeting, middle)
    assert (*u, *steps.v(K, C, u, middle)) == row
    assert steps.closed(K, C, quotient, HALF, row, row) == row


def test_the_bounds_catch_an_overflow():
    with pytest.raises(AssertionError, match="exceeds"):
        Bounds(True).dot(1, 1, 1, 1, HALF, HALF)
    with pytest.raises(AssertionError, match="exceeds"):
        Bounds(False).add(3, 2)
