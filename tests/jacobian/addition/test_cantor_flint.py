"""The additions that run on python-flint: equal to Cantor in Python, and used where they pay."""

from itertools import product
from random import Random

import pytest

from jacobian import GF, QQ, HyperellipticCurve, poly
from jacobian.addition import cantor, cantor_flint
from jacobian.addition.choice import kernel, python_kernel
from tests.jacobian.group_curves import inside
from tests.jacobian.jacobian_rows import ROWS


@pytest.mark.thinned(5)
@pytest.mark.parametrize("row", [pytest.param(row, id=str(row)) for row in ROWS])
def test_equal_to_cantor(row):
    C = row.curve.arithmetic_model
    on_flint = cantor_flint.FlintCantor(C)
    triples = [inside(D) for D in row.pool][: 4 if row.K == QQ else 9]
    for a in triples:
        assert on_flint.double(a) == cantor.double(C, a)
    for a, b in product(triples, repeat=2):
        assert on_flint.sum_of(a, b) == cantor.sum_of(C, a, b), (a, b)


@pytest.mark.parametrize("bits", [31, 61, 89, 127, 521])
def test_primes_below_and_above_a_machine_word(bits):
    rng = Random(bits)
    K = GF(2**bits - 1)
    C = HyperellipticCurve(K, poly.random(K, 8, rng, monic=True))
    J = C.jacobian()
    assert C.model == "split"
    D = J.from_points([C.random_point(rng) for _ in range(3)])
    add, double, _ = python_kernel(C)
    total = (D.u, D.v, D.n)
    for m in range(2, 12):
        total = double(total) if m == 2 else add(total, (D.u, D.v, D.n))
        assert m * D == J.from_mumford(*total)


def test_elements_stay_ints_and_fractions(rng):
    C = HyperellipticCurve(GF(3, 5, (1, 2, 0, 0, 0, 1)), [1, 5, 7, 0, 2, 0, 0, 1])
    D = 3 * C.jacobian().random(rng)
    assert {type(c) for c in (*D.u, *D.v)} == {int}
    E = 3 * HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian().from_points([(0, 1)])
    assert {type(c).__name__ for c in (*E.u, *E.v)} == {"Fraction"}


CURVES = {
    "QQ": (HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]), True),
    "genus 3, degree 8 with h": (HyperellipticCurve(GF(101), [1, 1, 0, 0, 0, 0, 0, 0, 1], [1]), True),
    "genus 3, degree 8": (HyperellipticCurve(GF(101), [1, 1, 0, 0, 0, 0, 0, 0, 1]), False),
    "genus 3, not monic": (HyperellipticCurve(GF(101), [1, 1, 0, 0, 0, 0, 0, 2]), True),
    "genus 3, explicit": (HyperellipticCurve(GF(101), [1, 1, 0, 0, 0, 0, 0, 1]), False),
    "genus 1": (HyperellipticCurve(GF(101), [1, 1, 0, 1]), True),
    "GF(3^40)": (HyperellipticCurve(GF(3, 40, (2, 1, *[0] * 38, 1)), [1, 2, 0, 0, 0, 1]), True),
    "genus 2": (HyperellipticCurve(GF(101), [1, 1, 0, 0, 0, 1]), False),
    "GF(2^127)": (
        HyperellipticCurve(GF(2, 127, (1, 1, *[0] * 125, 1)), [1, 1, 0, 0, 0, 0, 0, 1], [1]),
        False,
    ),
}


@pytest.mark.parametrize("name", CURVES)
def test_where_it_pays(name):
    C, expected = CURVES[name]
    assert cantor_flint.pays(C) == expected
    assert isinstance(getattr(kernel(C)[0], "__self__", None), cantor_flint.FlintCantor) == expected
    assert not isinstance(getattr(python_kernel(C)[0], "__self__", None), cantor_flint.FlintCantor)


def test_long_primes_stay_with_the_explicit_formulas():
    assert not cantor_flint.pays(HyperellipticCurve(GF(2**2203 - 1), [1, 1, 0, 0, 0, 1]))
