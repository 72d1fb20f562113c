"""Endomorphisms seen in periods: known rings, exact relations, and L-polynomials that exclude further ones."""

from __future__ import annotations

from itertools import product

import flint
import numpy as np
import pytest

from jacobian import GF, QQ, ArgumentError, FieldError, HyperellipticCurve, Infeasible, PrecisionLoss
from jacobian.arithmetic.endomorphism_algebras import algebra, hilbert, is_norm, seen, squarefree
from jacobian.periods.endomorphisms import endomorphisms
from tests.jacobian.test_published_curves import ROWS
from tests.jacobian.test_published_curves import curve as published

CURVES = {
    # f, h, the algebra over ℂ, the algebra over QQ
    "generic": ([1, -1, 0, 0, 0, 1], [], "QQ", "QQ"),
    "fifth roots of unity": ([1, 0, 0, 0, 0, 1], [], "QQ[x]/(x^4 + x^3 + x^2 + x + 1)", "QQ"),
    "X_1(13)": ([0, 0, 0, 0, 1, 1], [1, 1, 0, 1], "M_2(QQ)", "QQ(√-3)"),
    "X_0(23)": ([-7, 10, -11, 2, 2, -8, 1], [], "QQ(√5)", "QQ(√5)"),
    "in x²": ([1, 0, 1, 0, 1, 0, 2], [], "QQ × QQ", "QQ × QQ"),
    "X_0(37)": ([-37, 0, -9, 0, -11, 0, 1], [], "QQ × QQ", "QQ × QQ"),
    "x⁶ + 1": ([1, 0, 0, 0, 0, 0, 1], [], "M_2(QQ(√-3))", "M_2(QQ)"),
}


def curve(name):
    return HyperellipticCurve(QQ, *CURVES[name][:2])


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", CURVES)
def test_known_algebras(name):
    C = curve(name)
    found = endomorphisms(C, 60)
    result = seen(found, C.l_polynomials(400))
    assert (result.geometric.name, result.rational.name) == CURVES[name][2:]
    assert result.primes > 60
    assert result.proven == (name == "generic")


def test_quaternions():
    """Over the closure, 20736.l.373248.1 has the quaternions of discriminant 6 (LMFDB)."""
    C = published(ROWS["20736.l.373248.1"])
    result = seen(endomorphisms(C), C.l_polynomials(400))
    assert result.geometric.name == "quaternion algebra of discriminant 6"
    assert result.rational.name == "QQ"


@pytest.mark.parametrize("name", CURVES)
def test_the_matrices_are_a_ring_with_one(name):
    """A·Π = Π·R holds in balls, and products are combinations again, exactly."""
    found = endomorphisms(curve(name), 60)
    matrices = [flint.fmpz_mat([list(row) for row in R]) for R in found.matrices]
    with found.periods.cover.numbers.working():
        big = flint.acb_mat(found.periods.big)
        for R in matrices:
            A = flint.acb_mat([[(big * flint.acb_mat(R))[i, j] for j in range(2)] for i in range(2)])
            A = A * flint.acb_mat(found.periods.A).inv()
            assert all(abs(x) < 1e-40 for x in (A * big - big * flint.acb_mat(R)).entries())
    entries = flint.fmpz_mat([R.entries() for R in matrices])
    one = flint.fmpz_mat(4, 4, [int(i == j) for i, j in product(range(4), repeat=2)])
    for X in [one, *(R * S for R in matrices for S in matrices)]:
        grown = flint.fmpz_mat([*entries.tolist(), X.entries()])
        assert grown.rank() == entries.rank() == len(matrices)
        # the same lattice: X is an integral combination
        assert [row for row in grown.hnf().tolist() if any(row)] == entries.hnf().tolist()


def test_the_mean_of_the_square_of_a1_is_the_rank_over_the_rationals():
    """Costa, Fité & Sutherland 2019, to the accuracy of 1000 primes."""
    for name in CURVES:
        C = curve(name)
        found = len(endomorphisms(C, 60).rational)
        assert abs(C.l_polynomials(2**13).moments(2)[0, 2] - found) < 0.3 * found**0.5


def test_l_polynomials_of_another_curve_contradict():
    generic = curve("generic").l_polynomials(400)
    for name in ("X_0(23)", "X_0(37)", "x⁶ + 1"):
        with pytest.raises(PrecisionLoss, match="use more digits"):
            seen(endomorphisms(curve(name), 60), generic)


def test_norms():
    """Norms for X_0(23) at 2, with real multiplication by √5; of a square; of (x² + x + 3)(x² − x + 3), whose roots
    contain √−11.
    """
    assert [is_norm([1, 1, 3, 2, 4], d) for d in (5, 2, 1)] == [True, False, False]
    assert all(is_norm([1, 2, 7, 6, 9], d) for d in (1, 2, 5, -3))
    assert [is_norm([1, 0, 5, 0, 9], d) for d in (1, -11, -7, 2)] == [True, True, False, False]


def test_hilberts_symbol():
    """Compared with primitive solutions of ax² + by² = z² modulo p^3, for p = 2 modulo 2^6: a unit among them is 1."""
    for a, b in product((-3, -2, -1, 1, 2, 3, 5, 6), repeat=2):
        for p in (2, 3, 5):
            modulus = 2**6 if p == 2 else p**3
            first = np.arange(modulus)[:, None] ** 2
            second = first.T
            sides = (a + b * first - second, a * first + b - second, a * first + b * second - 1)
            solvable = any((side % modulus == 0).any() for side in sides)
            assert (hilbert(a, b, p) == 1) == solvable, (a, b, p)
    assert squarefree(-72) == -2


def test_genus_1_and_3():
    assert algebra(endomorphisms(HyperellipticCurve(QQ, [0, -1, 0, 1])).matrices).name == "QQ(√-1)"
    E = HyperellipticCurve(QQ, [1, 2, 0, 1])
    assert seen(endomorphisms(E), E.l_polynomials(100)).proven
    C = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 0, 0, 1])
    result = seen(endomorphisms(C, 60), C.l_polynomials(100))
    assert (result.geometric.dimension, result.geometric.commutative) == (6, True)
    assert (result.rational.name, result.proven) == ("QQ", False)


def test_what_has_no_endomorphisms_to_look_for():
    with pytest.raises(FieldError, match="QQ"):
        endomorphisms(HyperellipticCurve(GF(7), [1, 0, 0, 0, 0, 1]))
    with pytest.raises(Infeasible, match="genus 5"):
        endomorphisms(HyperellipticCurve(QQ, [1, -1, *[0] * 9, 1]))
    with pytest.raises(ArgumentError, match="digits"):
        endomorphisms(curve("generic"), 10)
