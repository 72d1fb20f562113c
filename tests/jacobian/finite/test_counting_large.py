"""Characteristic polynomials of Frobenius: the search compared with counts, closed forms, and general laws."""

import signal
import sys
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from math import isqrt
from random import Random

import numpy as np
import pytest

from jacobian import GF, QQ, FieldError, HyperellipticCurve, Infeasible
from jacobian.finite import counting, frobenius, hasse_witt, weil
from jacobian.finite.search import search
from tests.jacobian.group_curves import random_curve

COUNTED = [
    *[(23, 1, g, model, h) for g in (2, 3) for model in ("ramified", "split", "inert") for h in (False, True)],
    (53, 1, 3, "ramified", False),
    *[pytest.param(53, 1, 3, model, False, marks=pytest.mark.slow) for model in ("split", "inert")],
    *[(101, 1, 2, model, False) for model in ("ramified", "split", "inert")],
    *[(13, 1, 4, model, False) for model in ("ramified", "split", "inert")],
    (17, 1, 1, "split", True),
    (997, 1, 1, "inert", False),
    (3, 3, 2, "split", True),
    (3, 2, 3, "inert", True),
    (5, 2, 2, "ramified", False),
    (7, 2, 2, "inert", True),
    (2, 5, 2, "ramified", True),
    (2, 5, 2, "inert", True),
    (2, 4, 3, "split", True),
    (2, 3, 4, "ramified", True),
]


def obeys_weil(chi, q):
    """The functional equation χ(T) = T^2g χ(q/T)/q^g, and |α| = √q for every root: R(z) has real roots in ±2√q."""
    g = (len(chi) - 1) // 2
    assert [chi[i] for i in range(g)] == [q ** (g - i) * chi[2 * g - i] for i in range(g)]
    assert chi[-1] == 1
    roots = np.roots(chi[::-1])
    # a root of multiplicity up to g is found to the g-th root of the precision
    return bool(np.all(np.abs(np.abs(roots) / q**0.5 - 1) < 1e-3))


@pytest.mark.thinned(4)
@pytest.mark.parametrize(("p", "k", "genus", "model", "with_h"), COUNTED)
def test_the_search_agrees_with_counting(p, k, genus, model, with_h):
    for seed in range(2):
        C = random_curve(GF(p, k), genus, seed, model=model, with_h=with_h)
        chi = counting.frobenius_polynomial(C)
        assert search(C) == chi
        assert C.jacobian().frobenius_polynomial() == chi
        assert obeys_weil(chi, p**k)
        modulo = hasse_witt.frobenius_modulo_p(C)
        if modulo is not None:
            assert [c % p for c in chi[::-1][1 : genus + 1]] == modulo
        opposite = [c if i % 2 == 0 else -c for i, c in enumerate(chi)]
        assert counting.frobenius_polynomial(C.quadratic_twist()) == opposite


GENUS_ONE = [
    *[(200_003, 1, model) for model in ("ramified", "split", "inert")],
    (1_000_003, 1, "split"),
    (2, 13, "ramified"),
    (2, 14, "split"),
    (3, 9, "ramified"),
    (5, 6, "inert"),
]


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("p", "k", "model"), GENUS_ONE)
def test_genus_one_needs_no_count_and_no_matrix(p, k, model, monkeypatch):
    curves = [random_curve(GF(p, k), 1, seed, model=model, with_h=p == 2) for seed in range(3)]
    counted = [counting.frobenius_polynomial(C) for C in curves]
    monkeypatch.setattr("jacobian.finite.search.frobenius_modulo_p", None)
    monkeypatch.setattr(counting, "count_points", None)
    assert [search(C) for C in curves] == counted


def test_groups_of_small_exponent_in_genus_one():
    # x³ + b over GF(p²), p ≡ 2 modulo 3: traces ±2p and ±p; for ±2p the group is (Z/(p ± 1))², every order a divisor
    K, orders = GF(89, 2), set()
    for index in range(90, 100):
        C = HyperellipticCurve(K, [K.element(index), 0, 0, 1])
        for E in (C, C.quadratic_twist()):
            chi = search(E)
            assert chi == counting.frobenius_polynomial(E)
            orders.add(sum(chi))
    assert {88**2, 90**2} <= orders


@pytest.mark.parametrize("p", [10**12 + 61, 2**61 - 31, pytest.param(10**20 + 129, marks=pytest.mark.slow)])
def test_genus_one_by_complex_multiplication(p):
    # y² = x³ − x, p = a² + b² with an odd a: the trace is ±2a, and all eight classes of (Z/2 × Z/4) are there
    root = next(r for r in (pow(n, p // 4, p) for n in range(2, 99)) if r * r % p == p - 1)
    a, b = p, root
    while b * b > p:
        a, b = b, a % b
    a, b = sorted((b, isqrt(p - b * b)), key=lambda c: c % 2 == 0)
    assert a * a + b * b == p
    (trace,) = (t for t in (2 * a, -2 * a) if (p + 1 - t) % 8 == 0)
    assert HyperellipticCurve(GF(p), [0, -1, 0, 1]).jacobian().frobenius_polynomial() == [p, -trace, 1]


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("p", "k", "genus"), [(3, 3, 2), (3, 3, 3), (5, 2, 3), (7, 2, 3), (5, 3, 2)])
def test_hasse_witt_over_extensions(p, k, genus):
    C = random_curve(GF(p, k), genus, "norm", with_h=True)
    S = [counting.count_points(C, i) - p ** (k * i) - 1 for i in (1, 2)]
    assert [a % p for a in weil.leading(S)[1:]] == hasse_witt.frobenius_modulo_p(C)[:2]


def test_the_recurrence_gives_the_coefficients_of_the_power(monkeypatch):
    """Two computations of the same matrix agree on both sides of the prime where the method changes."""
    for p, genus in ((20_011, 2), (20021, 3), (20_011, 20), (19_997, 2)):
        C = random_curve(GF(p), genus, "recurrence")
        found = []
        for limit in (0, 10**6):
            monkeypatch.setattr(hasse_witt, "COMPILED_FROM", limit)
            found.append(hasse_witt.cartier_manin(C))
        assert found[0] == found[1]


@pytest.mark.thinned(2)
@pytest.mark.parametrize("p", [10007, 100_003, 999_983])
@pytest.mark.parametrize("genus", [2, 3])
def test_large_primes(p, genus):
    rng = Random(p)
    for model in ("ramified", "split"):
        C = random_curve(GF(p), genus, "large", model=model)
        chi = C.jacobian().frobenius_polynomial()
        assert obeys_weil(chi, p)
        assert p + 1 + chi[-2] == counting.count_points(C)
        order = sum(chi)
        assert (p**0.5 - 1) ** (2 * genus) <= order <= (p**0.5 + 1) ** (2 * genus)
        assert all(not order * C.jacobian().random(rng) for _ in range(5))
        other = C.quadratic_twist()
        if other.model != "inert" or genus == 2:
            assert not sum(c * (-1) ** i for i, c in enumerate(chi)) * other.jacobian().random(rng)


def power_of(factor, exponent):
    total = [1]
    for _ in range(exponent):
        product = [0] * (len(total) + len(factor) - 1)
        for i, a in enumerate(total):
            for j, b in enumerate(factor):
                product[i + j] += a * b
        total = product
    return total


@pytest.mark.parametrize(
    ("p", "prime", "expected"),
    [
        # y² = x^ℓ + 1 is supersingular when −1 is a power of p modulo ℓ (Weil 1949, Jacobi sums)
        (9_929, 5, lambda p: power_of([p, 0, 1], 2)),
        (99_989, 5, lambda p: power_of([p, 0, 1], 2)),
        (99_923, 5, lambda p: [p**2, 0, 0, 0, 1]),
        (9_967, 5, lambda p: [p**2, 0, 0, 0, 1]),
        (10_037, 7, lambda p: power_of([p, 0, 1], 3)),
        (100_043, 7, lambda p: power_of([p, 0, 1], 3)),
        (20_011, 7, lambda p: [p**3, 0, 0, 0, 0, 0, 1]),
    ],
)
def test_supersingular_curves_where_orders_alone_decide_little(p, prime, expected):
    residue = p % prime
    assert residue in {5: {2, 3, 4}, 7: {3, 5, 6}}[prime]
    C = HyperellipticCurve(GF(p), [1] + [0] * (prime - 1) + [1])
    assert C.jacobian().frobenius_polynomial() == expected(p)


def test_a_curve_with_many_automorphisms():
    # ##J = (p+1)³ with the structure (420, 420, 420): orders of elements leave 37 polynomials possible
    C = HyperellipticCurve(GF(419), [0, 1, 0, 0, 0, 0, 0, 0, 1])
    assert search(C) == power_of([419, 0, 1], 3)


@pytest.mark.parametrize(("p", "k", "genus"), [(2, 2, 2), (2, 3, 2), (3, 2, 2), (3, 2, 3), (5, 2, 2)])
def test_extension_of_the_polynomial(p, k, genus):
    below = random_curve(GF(p), genus, "below", with_h=True)
    above = HyperellipticCurve(GF(p, k), below.f, below.h)
    chi = weil.extend(counting.frobenius_polynomial(below), p, k)
    assert counting.frobenius_polynomial(above) == chi == above.jacobian().frobenius_polynomial()


def test_koblitz_curves_have_an_order_in_any_degree():
    K = GF(2, 61)
    J = HyperellipticCurve(K, [1, 0, 1, 0, 0, 1], [0, 1]).jacobian()
    chi = J.frobenius_polynomial()
    assert chi[0] == K.order**2
    assert not J.order() * J.random(Random(0))
    assert J.order() % HyperellipticCurve(GF(2), [1, 0, 1, 0, 0, 1], [0, 1]).jacobian().order() == 0


def test_real_parts_go_back_and_forth():
    rng = Random(4)
    for g in range(1, 7):
        r = [1, *[rng.randrange(-50, 50) for _ in range(g)]]
        chi = weil.from_real_part(r, 11)
        assert weil.real_part(chi[::-1][: g + 1], 11, g) == r
        # χ(T) = T^g R(T + q/T) at a rational T: T + 11/T
        T = Fraction(5)
        point = T + 11 / T
        assert sum(c * T**i for i, c in enumerate(chi)) == T**g * sum(c * point ** (g - i) for i, c in enumerate(r))


def test_limits_are_named():
    with pytest.raises(
        Infeasible, match=r"GF\(2305843009213693951\).* prime q up to 562949953421312, other q up to 1048576"
    ):
        random_curve(GF(2**61 - 1), 2, 0).jacobian().order()
    with pytest.raises(Infeasible, match="other q up to 1048576"):
        random_curve(GF(2, 31), 2, 0).jacobian().order()
    with pytest.raises(Infeasible, match=r"characteristic polynomials fit the counts over GF\(9973\^1\)"):
        random_curve(GF(9973), 5, 0).jacobian().order()
    with pytest.raises(FieldError, match="QQ"):
        HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian().order()


@pytest.mark.slow
@pytest.mark.parametrize(("p", "genus"), [(9_999_991, 2), (9_999_991, 3), (499, 4), (1009, 4)])
def test_the_far_end(p, genus):
    C = random_curve(GF(p), genus, "far", model="ramified")
    chi = C.jacobian().frobenius_polynomial()
    assert obeys_weil(chi, p)
    assert all(not sum(chi) * C.jacobian().random(Random(i)) for i in range(5))


@pytest.mark.slow
@pytest.mark.parametrize("p", [311, 419, 1009, 2003])
def test_genus_3_against_counts_over_the_quadratic_extension(p):
    for model in ("ramified", "split", "inert"):
        C = random_curve(GF(p), 3, "quadratic", model=model)
        chi = C.jacobian().frobenius_polynomial()
        S = [counting.count_points(C, i) - p**i - 1 for i in (1, 2)]
        assert weil.leading(S) == chi[::-1][:3]


@pytest.mark.parametrize(
    ("p", "genus"),
    [(10_000_019, 2), (10_000_019, 1), pytest.param(100_000_007, 3, marks=pytest.mark.slow)],
)
def test_primes_whose_points_are_not_counted(p, genus):
    """The trace comes from the Cartier–Manin matrix: the orders of the curve and of its twist annihilate classes."""
    C = random_curve(GF(p), genus, "beyond counting", model="ramified")
    J, twist, rng = C.jacobian(), C.quadratic_twist().jacobian(), Random(p)
    chi = J.frobenius_polynomial()
    assert obeys_weil(chi, p)
    for group, order in ((J, sum(chi)), (twist, sum(c * (-1) ** i for i, c in enumerate(chi)))):
        assert not any(order * group.random(rng) for _ in range(5))


def test_what_is_not_compiled_ends_where_counting_does(monkeypatch):
    monkeypatch.setattr("jacobian.finite.search.interpreted", lambda: True)
    with pytest.raises(Infeasible, match=r"field = GF\(10000079\)"):
        HyperellipticCurve(GF(10_000_079), [1, 2, 0, 0, 0, 1]).jacobian().order()


def test_genus_1_by_pari_and_by_search(monkeypatch):
    """For all models; the search is used outside the main thread and without cypari. The handler of Ctrl-C remains
    Python's.
    """
    pytest.importorskip("cypari")
    p, rng = 2**30 - 35, Random(3)
    curves = [
        random_curve(GF(p), 1, seed, model=model) for seed in range(3) for model in ("ramified", "split", "inert")
    ]
    handler = signal.getsignal(signal.SIGINT)
    frobenius._pari.cache_clear()
    assert [frobenius.by_pari(C) for C in curves] == [search(C) for C in curves]
    assert signal.getsignal(signal.SIGINT) is handler
    J = random_curve(GF(2**61 - 1), 1, "long", model="ramified").jacobian()
    assert not J.order() * J.random(rng)
    with ThreadPoolExecutor(1) as pool:
        assert pool.submit(frobenius.by_pari, curves[0]).result() is None
    monkeypatch.setitem(sys.modules, "cypari", None)
    frobenius._pari.cache_clear()
    assert frobenius.by_pari(curves[0]) is None
    frobenius._pari.cache_clear()
