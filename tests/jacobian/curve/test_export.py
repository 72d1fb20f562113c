"""Curves and divisors for other systems and back: python-flint itself, and PARI where cypari is installed."""

from itertools import product
from random import Random

import flint
import pytest

from jacobian import GF, QQ, RR, FieldError, HyperellipticCurve
from tests.jacobian.group_curves import next_curve, random_curve

PRIME, LARGE, NINE = GF(10007), GF(2**89 - 1), GF(3, 2, (2, 2, 1))


@pytest.mark.parametrize("K", [PRIME, LARGE, QQ], ids=str)
def test_through_flint_and_back(K):
    C = HyperellipticCurve(K, ["1/2", 3, 0, 0, 0, 1], [1, 1])
    f, h = C.to_flint()
    assert HyperellipticCurve(K, f, h) == C
    assert type(f).__module__.startswith("flint")
    D = C.jacobian().random(Random(1))
    assert C.jacobian().from_mumford(*D.to_flint()) == D
    assert f.degree() == 5
    assert K.coerce(f.coeffs()[1]) == K.coerce(3)


def test_flint_over_extension_fields():
    C = random_curve(NINE, 2, "flint", with_h=True)
    f, h = C.to_flint()
    assert [NINE.coerce(list(map(int, c.to_list()))) for c in f.coeffs()] == list(C.f)
    assert len(h.coeffs()) == len(C.h)
    with pytest.raises(FieldError, match=r"f\[0\] = .* is not an element of GF\(3\^2"):
        HyperellipticCurve(NINE, f, h)


def test_residues_of_another_modulus_are_refused():
    for wrong in (flint.nmod(3, 101), flint.nmod(0, 101), flint.fmpz_mod_ctx(2**89 - 1)(0)):
        with pytest.raises(FieldError, match=r"lies in GF\(.*\), not in GF\(10007\)"):
            PRIME.coerce(wrong)
    with pytest.raises(FieldError, match=r"f\[0\] = 1 lies in GF\(7\), not in GF\(10007\)"):
        HyperellipticCurve(PRIME, flint.nmod_poly([1, 2, 0, 0, 0, 1], 7))
    with pytest.raises(FieldError, match="is not an element of QQ"):
        QQ.coerce(flint.nmod(3, 101))
    assert PRIME.coerce(flint.fmpq(1, 2)) == PRIME.coerce("1/2")


def test_floats_are_not_written():
    C = HyperellipticCurve(RR, [1, 2, 0, 0, 0, 1])
    for write in (C.to_flint, C.to_pari, C.to_sage):
        with pytest.raises(FieldError, match="field = RR"):
            write()


def test_texts():
    C = HyperellipticCurve(GF(7), [2, 0, 1, 0, 0, 1])
    assert C.to_pari() == "[Mod(2, 7)*x^0 + Mod(1, 7)*x^2 + Mod(1, 7)*x^5, Mod(0, 7)]"
    assert C.to_sage() == "R = PolynomialRing(GF(7), 'x')\nC = HyperellipticCurve(R([2, 0, 1, 0, 0, 1]), R([]))"
    C = HyperellipticCurve(QQ, ["-1/2", 0, 1, 0, 0, 1], 1)
    assert C.to_pari() == "[(-1/2)*x^0 + (1)*x^2 + (1)*x^5, (1)*x^0]"
    # -1/2 would be a float in a Python program
    sage = "R = PolynomialRing(QQ, 'x')\nC = HyperellipticCurve(R([QQ('-1/2'), 0, 1, 0, 0, 1]), R([1]))"
    assert C.to_sage() == sage
    C = HyperellipticCurve(NINE, [5, 1, 0, 1])
    generator, vector = C.to_pari().split("; ")
    assert generator == "a = ffgen(Mod(1, 3)*(2*x^0 + 2*x^1 + 1*x^2), 'a)"
    assert vector == "[(2*a^0 + 1*a^1)*x^0 + (1*a^0 + 0*a^1)*x^1 + (1*a^0 + 0*a^1)*x^3, (0*a^0 + 0*a^1)]"
    assert "GF(3**2, 'a', modulus=GF(3)['x']([2, 2, 1]))" in C.to_sage()
    assert "R.base_ring()([2, 1])" in C.to_sage()


@pytest.mark.thinned(3)
@pytest.mark.parametrize("count", [2, pytest.param(40, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("K", "genera"),
    [(GF(p), (1, 2, 3)) for p in (3, 5, 7, 11, 23)]
    + [(GF(p), (1, 2)) for p in (47, 101, 251)]
    # without genus 1: some curves over GF(9) overflow any stack of PARI 2.15.4 and 2.17.4
    + [(K, (2, 3)) for K in (NINE, GF(5, 2), GF(3, 3))],
    ids=str,
)
def test_pari_counts_as_we_do(K, genera, count):
    pari = pytest.importorskip("cypari").pari
    pari.allocatemem(10**8, silent=True)
    polynomial, rng = pari("v -> hyperellcharpoly(v)"), Random(count)
    for genus, model, i in product(genera, ("ramified", "split", "inert"), range(count)):
        C = next_curve(K, genus, rng, model=model, with_h=i % 2)
        found = polynomial(pari(C.to_pari()))
        assert [int(c) for c in found.Vecrev()] == C.jacobian().frobenius_polynomial()
        if K.degree == 1:
            f, h = pari(C.to_pari())
            assert HyperellipticCurve(K, f, h) == C
            with pytest.raises(FieldError, match="not in GF"):
                HyperellipticCurve(GF(13), f, h)


def test_pari_counts_as_we_do_in_characteristic_2():
    # hyperellcharpoly of PARI 2.15.4 and 2.17.4 refuses curves over GF(2^k), k > 1, and from genus 3 on over GF(2):
    # "domain error in hyperellpadicfrobenius: H is singular at 2"; PARI does compute the orders of elliptic
    # curves, and test_brute_force.py tries every pair (x, y)
    pari = pytest.importorskip("cypari").pari
    rng, polynomial = Random(2), pari("v -> hyperellcharpoly(v)")
    for _ in range(300):
        C = next_curve(GF(2), 2, rng)
        found = [int(c) for c in polynomial(pari(C.to_pari())).Vecrev()]
        assert found == C.jacobian().frobenius_polynomial()
    for n in (13, 20, 31):
        K = GF(2, n, [int(c) for c in pari(f"Vecrev(lift(ffinit(2, {n})))")])
        a2, a6 = K.random(rng), K.random(rng)
        C = HyperellipticCurve(K, [a6, 0, a2, 1], [0, 1])
        pari(f"a = ffgen(ffinit(2, {n}), 'a)")
        b2, b6 = (" + ".join(f"{c}*a^{i}" for i, c in enumerate(K.coefficients(b))) for b in (a2, a6))
        assert C.jacobian().order() == int(pari(f"ellcard(ellinit([a^0, {b2}, 0, 0, {b6}]))"))


def test_rational_numbers_of_pari():
    pari = pytest.importorskip("cypari").pari
    C = HyperellipticCurve(QQ, ["-1/2", 0, 1, 0, 0, 1], 1)
    f, h = pari(C.to_pari())
    assert HyperellipticCurve(QQ, f, h) == C
    assert QQ.coerce(pari("3/4")) == QQ.coerce("3/4")
    with pytest.raises(FieldError, match="is not an element of QQ"):
        QQ.coerce(pari("sqrt(2)"))
