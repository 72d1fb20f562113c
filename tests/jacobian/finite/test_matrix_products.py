"""Coefficients of F^((p−1)/2) in time Õ(√p), compared with the recurrence and with complex multiplication, at every
size of p.
"""

import logging
import os
import subprocess
import sys
from functools import reduce
from itertools import islice
from random import Random

import numpy as np
import pytest
from flint import nmod_poly

from jacobian import GF, HyperellipticCurve, Infeasible, progress
from jacobian.fields.primality import is_prime
from jacobian.finite import complex_multiplication, counting, hasse_witt, matrix_products, weil
from jacobian.finite.matrix_products import Products, step
from jacobian.finite.search import Candidates, Side, search
from jacobian.numbers.convolution import balanced
from tests.jacobian.group_curves import random_curve


def primes_from(p):
    return (q for q in range(p, 2 * p) if is_prime(q))


def by_both(p, degree, beta, rng):
    K, count = GF(p), max(1, (degree - 1) // 2)
    F = [rng.randrange(1, p), *[rng.randrange(p) for _ in range(degree)]]
    ratios = [K.div(c, F[0]) for c in F[1:]]
    start = K.power(F[0], (p - 1) // 2)
    power = nmod_poly(F, p) ** ((p - 1) // 2)
    return [int(power[p - 1 - j]) for j in range(count)], Products(p, ratios, beta=beta).last(start, count)


def test_every_prime_of_a_range():
    rng = Random(2)
    for i, p in enumerate(islice(primes_from(2050), 16)):
        plain, found = by_both(p, 3 + i % 8, 512, rng)
        assert plain == found, p


@pytest.mark.parametrize(
    ("p", "degree", "beta"), [(4099, 5, 1024), (8209, 6, 2048), (10007, 20, 512), (20_011, 7, 1024), (65_537, 5, 4096)]
)
def test_doublings_and_later_points(p, degree, beta):
    plain, found = by_both(p, degree, beta, Random(p))
    assert plain == found


def test_the_step_grows_with_the_root_within_the_memory():
    assert [step(p, 5) for p in (10**9 + 7, 10**12 + 39)] == [1 << 15, 1 << 20]
    for d in (5, 8, 20):
        assert 16 * d * d * step(2**49 - 81, d) <= matrix_products.MEMORY


@pytest.mark.parametrize("p", [2**49 - 81, 10**14 + 31, 10**12 + 39])
def test_products_modulo_large_primes_are_those_of_integers(p):
    """The values at the end of the doubling, and their shifts, for primes beyond the reach of a full run."""
    assert is_prime(p)
    rng, beta, d = Random(p), 2048, 5
    ratios = [rng.randrange(p) for _ in range(d)]
    work = Products(p, ratios, beta=beta)
    values, later = np.empty((d * d, beta)), np.empty((d * d, beta))
    work._double(values, np.empty((d * d, beta)))
    work._shift(values, [(beta, later)])
    for array, point in ((values, 0), (values, 1), (values, beta - 1), (later, 0), (later, beta - 3)):
        x = (point + (beta if array is later else 0)) * beta
        factors = (matrix(p, ratios, x + k) for k in range(1, beta))
        product = reduce(lambda a, b: b @ a % p, factors)
        assert array[:, point].tolist() == [balanced(int(c), p) for c in product.ravel()]


def matrix(p, ratios, k):
    d, half = len(ratios), (p + 1) // 2
    found = np.zeros((d, d), dtype=object)
    found[0] = [(half * i - k) * c % p for i, c in enumerate(ratios, 1)]
    for i in range(1, d):
        found[i, i - 1] = k
    return found


@pytest.mark.thinned(3)
@pytest.mark.parametrize("genus", [1, 2, 3, 4])
@pytest.mark.parametrize("model", ["ramified", "split", "inert"])
def test_frobenius_modulo_p_is_that_of_the_recurrence(genus, model, monkeypatch):
    # one of them is large enough for the compiled recurrence
    for with_h, p in enumerate((2053, 20_011)):
        C = random_curve(GF(p), genus, "modulo p", model=model, with_h=bool(with_h))
        plain, matrix = hasse_witt.frobenius_modulo_p(C), hasse_witt.cartier_manin(C)
        monkeypatch.setattr(hasse_witt, "PRODUCTS_FROM", 2048)
        assert hasse_witt.frobenius_modulo_p(C) == plain
        assert hasse_witt.cartier_manin(C) == matrix
        monkeypatch.undo()


@pytest.mark.parametrize(
    "f",
    [
        # only rational roots 0, 1, 2, …; only the rational root 0; h² + 4f of degree 6 with a root
        [0, 24, -50, 35, -10, 1],
        [0, 3, 0, 0, 0, 1],
        [0, -120, 274, -225, 85, -15, 1],
        [5, 0, 0, 0, 0, 1],
        [1, 0, 0, 0, 0, 0, 1],
    ],
)
def test_special_curves(f, monkeypatch):
    for p in islice(primes_from(2050), 3):
        C = HyperellipticCurve(GF(p), f)
        plain = hasse_witt.frobenius_modulo_p(C)
        monkeypatch.setattr(hasse_witt, "PRODUCTS_FROM", 2048)
        assert hasse_witt.frobenius_modulo_p(C) == plain
        assert plain[0] == (counting.count_points(C) - p - 1) % p
        monkeypatch.undo()


@pytest.mark.thinned(4)
@pytest.mark.parametrize(
    ("p", "degree"),
    [
        (1_048_601, 5),
        (10_000_141, 5),
        (1_000_000_021, 5),
        (10_000_019, 7),
        pytest.param(10**12 + 61, 5, marks=pytest.mark.slow),
    ],
)
def test_curves_with_complex_multiplication(p, degree):
    C = HyperellipticCurve(GF(p), [3] + [0] * (degree - 1) + [1])
    assert p > hasse_witt.PRODUCTS_FROM
    assert search(C) == complex_multiplication.frobenius_polynomial(C)


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    ("p", "genus", "model"), [(10**9 + 7, 2, "split"), (10**9 + 7, 3, "ramified"), (10**10 + 19, 1, "inert")]
)
def test_orders_annihilate_the_curve_and_its_twist(p, genus, model):
    C = random_curve(GF(p), genus, "orders", model=model)
    chi = C.jacobian().frobenius_polynomial()
    twisted = [c * (-1) ** i for i, c in enumerate(chi)]
    rng = np.random.default_rng(1)
    for E, order in ((C, sum(chi)), (C.quadratic_twist(), sum(twisted))):
        if E.model != "inert" or genus == 2:
            assert not any(order * D for D in E.jacobian().random(rng, size=20))
    low, high = C.jacobian().order_bounds()
    assert low <= sum(chi) <= high


def test_all_candidates_that_annihilate_a_class_are_found():
    """Many candidates annihilate classes of small order; none of them may be missed."""
    C = HyperellipticCurve(GF(103), [0, 1, 0, 0, 0, 0, 0, 0, 1])
    p, side = 103, Side(C, 1)
    a = weil.leading([counting.count_points(C) - p - 1])
    known = tuple(weil.real_part(a, p, 3))
    candidates = Candidates(p, 3, known, tuple(hasse_witt.frobenius_modulo_p(C)[1:]), p)
    every = [[*prefix, value] for prefix in candidates.prefixes() for value in candidates.last(prefix)]
    for seed in range(2):
        D = side.J.random(Random(seed))
        for E in (D, 8 * D, side.J.zero()):
            fitting = [r for r in every if not side.order(r, p) * E]
            assert sorted(side.annihilating(E, candidates)) == sorted(fitting)


def test_what_is_out_of_reach_is_refused_at_once():
    with pytest.raises(Infeasible, match=r"characteristic polynomials fit GF\(1000000000039\) in genus 4"):
        random_curve(GF(10**12 + 39), 4, 0).jacobian().order()
    with pytest.raises(
        Infeasible, match=r"field = GF\(2305843009213693951\): the Cartier–Manin matrix is computed up to p = 2\^49"
    ):
        random_curve(GF(2**61 - 1), 2, 0).cartier_manin()


def test_progress_is_logged(caplog, monkeypatch):
    for name in ("FIRST", "SAID_AGAIN"):
        monkeypatch.setattr(progress, name, 0.0)
    with caplog.at_level(logging.INFO, "jacobian.progress"):
        hasse_witt.cartier_manin(HyperellipticCurve(GF(4_194_319), [3, 1, 4, 1, 5, 1]))
    said = [record.getMessage() for record in caplog.records]
    assert said[0].startswith(f"Cartier–Manin matrix modulo 4194319, β = {step(4_194_319, 5)}: ")
    parts = [int(text.split(": ")[1].split(" %")[0]) for text in said]
    assert parts == sorted(parts)
    assert parts[-1] == 100
    assert all("s left" in text for text in said)


@pytest.mark.slow
def test_a_first_order_says_nothing_of_the_hours_that_compilation_seemed_to_show(tmp_path):
    """While numba compiled for seven seconds, the progress line used to predict "0 % done, about 2879 s left"."""
    asked = "from jacobian import *; print(HyperellipticCurve(GF(10**7 + 19), [1, -1, 0, 0, 0, 1]).jacobian().order())"
    places = {"NUMBA_CACHE_DIR": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path)}
    run = subprocess.run(
        [sys.executable, "-c", asked], env=os.environ | places, capture_output=True, text=True, check=True, timeout=120
    )
    assert (run.stdout, run.stderr) == ("99963488582862\n", "")
    assert not list(tmp_path.rglob("*.nbc"))
