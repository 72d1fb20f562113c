"""Discrete logarithms on every model, by each of the three methods."""

from random import Random

import pytest

from jacobian import GF, ArgumentError, CurveMismatch, HyperellipticCurve, Infeasible, NotAMultiple
from jacobian.finite.discrete_log import baby_step_giant_step, kangaroo, pohlig_hellman
from jacobian.finite.integers import factorization
from tests.jacobian.group_curves import random_curve
from tests.jacobian.jacobian_rows import ROWS

MEDIUM = [
    pytest.param(random_curve(GF(*q), genus, "log", model=model).jacobian(), id=f"GF{q} genus {genus} {model}")
    for q, genus, model in [
        ((10007,), 2, "ramified"),
        ((10007,), 2, "split"),
        ((10007,), 2, "inert"),
        ((1009,), 3, "split"),
        ((2, 8), 2, "ramified"),
        ((3, 5), 2, "split"),
    ]
]


@pytest.mark.thinned(2)
@pytest.mark.parametrize("row", [pytest.param(r, id=str(r)) for r in ROWS if r.field == "GF(7)" and r.genus <= 2])
def test_all_logarithms_in_small_groups(row):
    J = row.curve.jacobian()
    base = max(list(J.points())[:60], key=lambda D: D.order())
    multiples = [J.zero()]
    while len(multiples) < base.order():
        multiples.append(multiples[-1] + base)
    for m, D in enumerate(multiples):
        assert J.log(base, D) == m
    for m, D in list(enumerate(multiples))[::5]:
        assert J.log(base, D, interval=(m, m)) == m == J.log(base, D, interval=(m - 3, m + 3))
    inside = set(multiples)
    for D in [D for D in J.points() if D not in inside][:20]:
        with pytest.raises(NotAMultiple, match="is no multiple"):
            J.log(base, D)


@pytest.mark.thinned(3)
@pytest.mark.parametrize("J", MEDIUM)
def test_pohlig_hellman(J):
    rng = Random(8)
    base = J.random(rng)
    order = base.order()
    for _ in range(4):
        m = rng.randrange(order)
        target = m * base
        assert J.log(base, target) == m == J.log(base, target, order=order)
        assert J.log(base, target, order=J.order(), primes=list(factorization(J.order()))) == m
        assert pohlig_hellman(base, target, factorization(order)) == m


@pytest.mark.thinned(3)
@pytest.mark.parametrize("J", MEDIUM)
def test_intervals(J):
    rng = Random(9)
    base = J.random(rng)
    order = base.order()
    for width in (1, 10, 5000, 40_000):
        low = rng.randrange(-order, order)
        m = low + rng.randrange(width)
        target = m * base
        found = baby_step_giant_step(base, target, low, low + width - 1)
        assert found is not None
        assert low <= found <= m
        assert (found - m) % order == 0
        for seed in range(3):
            found = kangaroo(base, target, low, low + width - 1, Random(seed))
            assert found is not None
            assert low <= found < low + width
            assert found * base == target


def test_kangaroos_and_steps_find_nothing_outside():
    J = random_curve(GF(10007), 2, "outside").jacobian()
    base = J.random(Random(10))
    assert base.order() > 10**6
    assert baby_step_giant_step(base, 2001 * base, 0, 2000) is None
    assert kangaroo(base, 5000 * base, 0, 200, Random(0)) is None
    with pytest.raises(NotAMultiple, match=r"0 ≤ m ≤ 2000"):
        J.log(base, 2001 * base, interval=(0, 2000))


def test_kangaroos_make_few_jumps(monkeypatch):
    J = random_curve(GF(999_983), 2, "jumps").jacobian()
    base, rng, width = J.random(Random(11)), Random(12), 1 << 20
    additions = 0
    add = type(base).__add__

    def counted(self, other):
        nonlocal additions
        additions += 1
        return add(self, other)

    monkeypatch.setattr(type(base), "__add__", counted)
    trials = 8
    for seed in range(trials):
        m = rng.randrange(width)
        assert kangaroo(base, m * base, 0, width - 1, Random(seed)) == m
    # 2√w are expected, and a few more because of the distances between traps
    assert additions < trials * 4 * 1024


def test_logarithm_in_a_group_of_prime_order():
    J = random_curve(GF(101), 2, "prime").jacobian()
    factors = factorization(J.order())
    prime = max(factors)
    base = J.order() // prime ** factors[prime] * J.random(Random(13))
    assert J.log(base, 1234567 * base) == 1234567 % base.order()


def test_errors_of_logarithms():
    J = random_curve(GF(10007), 2, "errors").jacobian()
    base = J.random(Random(14))
    other = random_curve(GF(10007), 2, "other").jacobian().random(Random(1))
    with pytest.raises(CurveMismatch, match=r"target = .* does not lie in"):
        J.log(base, other)
    with pytest.raises(ArgumentError, match=r"interval = \(3, 1\) is empty"):
        J.log(base, base, interval=(3, 1))
    with pytest.raises(ArgumentError, match=r"interval = 5: a pair of ints"):
        J.log(base, base, interval=5)
    with pytest.raises(ArgumentError, match=r"order = 5: a non-zero multiple"):
        J.log(base, base, order=5)
    with pytest.raises(Infeasible, match=r"2\^48 at most"):
        J.log(base, base, interval=(0, 2**50))


def test_a_known_order_replaces_one_that_is_out_of_reach():
    # Gaudry and Harley 2000: #J is published, and counting does not reach p = 10^19 + 51
    p = 10**19 + 51
    f = [2089986280348253421, 4944592307816406286, 9716939937510582097, 4626433832795028841, 3141592653589793238, 1]
    J = HyperellipticCurve(GF(p), f).jacobian()
    order, prime = 99999999982871020671452277000281660080, 7054215880371151972602291562049
    base = prime * J.from_mumford([12, p - 8, 1], [6040410131658928447, 2381762898308099354])
    assert J.log(base, 1234 * base, order=order // prime) == 1234 % base.order(multiple=order // prime)
    with pytest.raises(Infeasible, match="prime q up to"):
        J.log(base, base)
