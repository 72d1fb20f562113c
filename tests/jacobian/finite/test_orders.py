"""Orders of classes compared with a walk through the cyclic group, and factoring of integers."""

import json
from math import gcd, inf, lcm, prod
from pathlib import Path
from random import Random

import pytest

from jacobian import GF, QQ, RR, ArgumentError, FieldError, HyperellipticCurve, Infeasible
from jacobian.fields.primality import is_prime
from jacobian.finite.integers import factorization, value
from tests.jacobian.group_curves import random_curve
from tests.jacobian.jacobian_rows import ROWS
from tests.jacobian.law.test_reference_cases import curve_of, divisor_of, of_kind

SMALL = [pytest.param(row, id=str(row)) for row in ROWS if row.field == "GF(7)" and row.genus <= 2]
CASES = json.loads((Path(__file__).parents[2] / "data" / "jacobian_cases.json").read_text(encoding="utf-8"))["cases"]


def walked(D):
    """The order of D, one addition at a time."""
    count, total = 1, D
    while total:
        count, total = count + 1, total + D
    return count


@pytest.mark.parametrize("row", SMALL)
def test_orders_of_classes(row):
    J = row.curve.jacobian()
    for D in [*row.pool, *list(J.points())[::7]]:
        assert D.order() == walked(D)
        assert D.order(multiple=J.order() * 6) == D.order(multiple=-J.order()) == walked(D)


@pytest.mark.parametrize("row", SMALL)
def test_the_exponent_is_the_least_common_multiple_of_the_orders(row):
    J = row.curve.jacobian()
    assert J.exponent() == lcm(*[D.order() for D in J.points()])


def test_orders_in_a_large_group():
    rng = Random(5)
    J = random_curve(GF(999_983), 3, "order", model="split").jacobian()
    N = J.order()
    for _ in range(3):
        D = J.random(rng)
        order = D.order()
        assert not order * D
        assert all(order // prime * D for prime in factorization(order))
        assert (6 * D).order() == order // gcd(order, 6)
        assert N % order == 0


@pytest.mark.parametrize("case", of_kind("group_order"))
def test_published_group_orders_are_orders_from_their_primes(case):
    J = curve_of(case).jacobian()
    D = divisor_of(J, case["inputs"]["D"])
    order, primes = int(case["expected"]["order"]), list(map(int, case["expected"]["prime_factors"]))
    rest = order
    for prime in primes:
        while rest % prime == 0:
            rest //= prime
    known = [*primes, *factorization(rest)]
    found = D.order(multiple=order, primes=known)
    assert not found * D
    assert order % found == 0
    assert all(found // prime * D for prime in known if found % prime == 0)
    assert all(found % prime == 0 for prime in primes)


@pytest.mark.parametrize("case", of_kind("torsion"))
def test_rational_torsion_orders(case):
    if "D" not in case["inputs"]:
        return
    D = divisor_of(curve_of(case).jacobian(), case["inputs"]["D"])
    assert D.order() == case["expected"]["order_of_D"]
    assert D.jacobian.zero().order() == 1


def test_rational_classes_of_infinite_order():
    J = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian()
    assert J.from_points([(0, 1)]).order() == 5
    assert J.from_points([(-1, 0)]).order() == 2
    J = HyperellipticCurve(QQ, [4, 0, 0, 1, 0, 1]).jacobian()
    assert J.from_points([(0, 2)]).order() == inf
    J = HyperellipticCurve(QQ, [1, 1, 0, 0, 3, 0, 1]).jacobian()
    plus, minus = J.curve.points_at_infinity()
    assert J(plus, minus).order() == inf
    assert J.zero().order() == 1


def test_errors_of_orders():
    J = random_curve(GF(101), 2, "errors").jacobian()
    D = J.random(Random(1))
    with pytest.raises(ArgumentError, match=r"multiple = 7: a non-zero multiple of the order"):
        D.order(multiple=7)
    with pytest.raises(ArgumentError, match=r"multiple = 0"):
        D.order(multiple=0)
    with pytest.raises(ArgumentError, match=r"primes = \[2\]: the prime factors of"):
        D.order(primes=[2])
    with pytest.raises(ArgumentError, match=r"multiple = 2\.5"):
        D.order(multiple=2.5)
    with pytest.raises(Infeasible, match="prime q up to"):
        random_curve(GF(2**61 - 1), 2, 0).jacobian().zero().order()
    with pytest.raises(FieldError, match="exact fields"):
        HyperellipticCurve(RR, [1, 0, 0, 0, 0, 1]).jacobian().zero().order()


def test_factorizations():
    rng = Random(6)
    large = [rng.randrange(1, 10**15) for _ in range(40)]
    for n in [*range(1, 500), *large, 2**64, 2**61 - 1, 10007**2, 2003 * 2011, 2003**3]:
        factors = factorization(n)
        assert value(factors) == n
        assert all(map(is_prime, factors))
        assert list(factors) == sorted(factors)
    assert factorization(999_983**2 * 10_007 * 1_000_003) == {10_007: 1, 999_983: 2, 1_000_003: 1}
    assert factorization(720, primes=[2, 3, 5]) == {2: 4, 3: 2, 5: 1}


def test_numbers_of_every_size():
    primes = [10**12 + 39, 10**12 + 39, 10**9 + 7, 10**9 + 9, 3, 2**89 - 1]
    assert factorization(prod(primes)) == {3: 1, 10**9 + 7: 1, 10**9 + 9: 1, 10**12 + 39: 2, 2**89 - 1: 1}
    assert factorization(2**521 - 1) == {2**521 - 1: 1}
    assert factorization((2**61 - 1) * (10**29 + 319)) == {2**61 - 1: 1, 10**29 + 319: 1}
    assert factorization(10007**60) == {10007: 60}


def test_errors_of_factoring():
    with pytest.raises(ArgumentError, match=r"n = 0"):
        factorization(0)
    with pytest.raises(ArgumentError, match=r"primes = \[2, 15\]"):
        factorization(30, [2, 15])
    with pytest.raises(ArgumentError, match="all of them"):
        factorization(30, [2, 3])


def test_a_number_too_hard_to_factor():
    n = prod([2**89 - 1, 2**107 - 1])
    with pytest.raises(Infeasible, match=f"{n} is composite.* give its prime factors"):
        factorization(n)


def test_curves_with_a_long_discriminant():
    """The first used to run for hours and the second never ended; the primes of the third are found."""
    for a in (10**40 + 7, 10**5000 + 7):
        with pytest.raises(Infeasible, match="give its prime factors"):
            HyperellipticCurve(QQ, [a, 10**39 + 9, 0, 0, 0, 1]).bad_primes()
    # the discriminant of x⁵ + a is 5⁵a⁴
    assert HyperellipticCurve(QQ, [10**40 + 121, 0, 0, 0, 0, 1]).bad_primes() == [2, 5, 10**40 + 121]
