"""Periods in balls contain the values at twice the digits, agree with other integrators, and satisfy Riemann's
relations and the theta identities of hyperelliptic curves as balls.
"""

import pickle
from fractions import Fraction
from random import Random

import pytest
from flint import acb, acb_mat, arb, ctx, fmpq, fmpz_mat

from jacobian import CC, GF, MP, QQ, RR, ArgumentError, HyperellipticCurve, PrecisionLoss, poly
from jacobian.periods.balls import BallNumbers
from jacobian.periods.branched_cover import crossings
from jacobian.periods.matrix import periods
from jacobian.periods.proven import period_balls
from jacobian.periods.siegel import siegel_reduced
from tests.jacobian.periods.ball_curves import random_curve

KINDS = ("small", "complex", "cluster")


def _contain(P, Q):
    return all(x.contains(y) for row, other in zip(P.big, Q.big, strict=True) for x, y in zip(row, other, strict=True))


def _form(g):
    return fmpz_mat([[(j == i + g) - (i == j + g) for j in range(2 * g)] for i in range(2 * g)])


def test_numbers_of_every_kind_become_balls_that_contain_them():
    numbers, third, wide = BallNumbers(80), fmpq(1, 3), MP(60)
    with numbers.working():
        assert numbers.convert(7) == acb(7)
        assert numbers.ten(3) == arb(1000)
        assert numbers.ten(-2).contains(arb(fmpq(1, 100)))
        assert numbers.convert(0.1) == acb(0.1)
        assert numbers.convert(1 - 0.1j) == acb(1, -0.1)
        assert numbers.convert(Fraction(1, 3)).contains(acb(third))
        near = numbers.convert(wide.coerce("1/3"))
        assert near.contains(acb(third))
        assert near.real.rad() < 1e-20
        ball = arb(1, 0.25)
        for x, of in ((ball, acb(ball)), (acb(ball, 2), acb(ball, 2))):
            assert numbers.convert(x).contains(of)
            assert of.contains(numbers.convert(x))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("g", [1, 2, 3, pytest.param(6, marks=pytest.mark.slow)])
def test_balls_contain_twice_the_digits(g, kind):
    C = random_curve(Random(f"{g} {kind}"), g, kind)
    P, Q = period_balls(C, 20), period_balls(C, 40)
    assert _contain(P, Q)
    largest = max(abs(complex(x)) for row in P.big for x in row)
    assert max(float(x.rad()) for row in P.big for x in row) <= 1e-20 * largest


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("g", [1, 2, 4])
def test_riemann_s_relations_hold_as_balls(g, kind):
    P = period_balls(random_curve(Random(f"relations {g} {kind}"), g, kind), 25)
    tau = P.tau
    assert all((tau[i][j] - tau[j][i]).contains(0) for i in range(g) for j in range(i))
    with P.cover.numbers.working():
        imaginary = acb_mat([[x.imag for x in row] for row in tau])
        minors = [acb_mat([[imaginary[i, j] for j in range(k)] for i in range(k)]).det().real for k in range(1, g + 1)]
        assert all(minor > 0 for minor in minors)


def test_edges_of_very_different_length_cross_too():
    # directions at a common end used to be compared without their lengths, here 2 and 2e-5
    roots = [Fraction(x, 10**6) for x in (122288, 465101, 465104, 465107)]
    P = period_balls(HyperellipticCurve(QQ, poly.from_roots(QQ, roots)), 15)
    Q = periods(HyperellipticCurve(MP(30), poly.from_roots(MP(30), [MP(30).coerce(e) for e in roots])))
    with P.cover.numbers.working():
        found = [c for column in zip(*Q.big, strict=True) for c in P.coordinates(column)]
        assert max(abs(float(c - round(float(c)))) for c in found) < 1e-12


def test_the_cycles_are_a_symplectic_basis():
    P = period_balls(HyperellipticCurve(QQ, [3, 1, 4, 1, -5, 9, 2, 6]), 20)
    cycles, crossing = fmpz_mat([list(c) for c in P.cycles]), fmpz_mat(crossings(P.edges))
    assert cycles * crossing * cycles.transpose() == _form(3)


def test_an_elliptic_curve_has_the_periods_of_the_mean():
    # y² = x³ − x: the lattice is a square one with the real period 2∫₁^∞ dx/√(x³ − x) = Γ(1/4)²/√(2π)
    P = period_balls(HyperellipticCurve(QQ, [0, -1, 0, 1]), 40)
    with P.cover.numbers.working():
        omega = (arb(1) / 4).gamma() ** 2 / (2 * arb.pi()).sqrt()
        area = abs((P.A[0][0].conjugate() * P.B[0][0]).imag)
    assert area.overlaps(omega**2)
    assert float(area.rad()) < 1e-38


def test_an_edge_is_what_flint_s_integrator_encloses():
    C = HyperellipticCurve(QQ, [3, 1, 4, 1, -5, 9, 2])
    P = period_balls(C, 20)
    cover, edge = P.cover, P.edges[0]
    a, b = cover.roots[edge.i], cover.roots[edge.j]
    others = [e for k, e in enumerate(cover.roots) if k not in (edge.i, edge.j)]
    with cover.numbers.working():
        # x = m + h·sin θ: dx/Y = ±dθ/√(−lead·Π(x − e_k))
        middle, half = (a + b) / 2, (b - a) / 2
        directions = [acb(abs(middle - e)) / (middle - e) for e in others]

        def integrand(theta, analytic):
            x = middle + half * theta.sin()
            value = acb(1)
            for e, d in zip(others, directions, strict=True):
                value = value * ((x - e) * d).sqrt(analytic=analytic)
            return 1 / value

        constant = -cover.lead
        for d in directions:
            constant = constant / d
        square = acb.integral(integrand, -arb.pi() / 2, arb.pi() / 2) ** 2 / constant
    assert square.overlaps(edge.integrals[0] ** 2)
    assert float(square.rad()) < 1e-18


@pytest.mark.parametrize("g", [2, 3])
def test_they_span_the_lattice_that_is_found_in_multiprecision(g):
    f = [Random(g).randint(-9, 9) for _ in range(2 * g + 2)] + [1]
    P, Q = period_balls(HyperellipticCurve(QQ, f), 30), periods(HyperellipticCurve(MP(30), f))
    rows = []
    for column in zip(*Q.big, strict=True):
        found = P.coordinates(column)
        rows.append([round(float(c)) for c in found])
        with P.cover.numbers.working():
            assert max(abs(float(c - n)) for c, n in zip(found, rows[-1], strict=True)) < 1e-27
    matrix = fmpz_mat(rows)
    assert matrix * _form(g) * matrix.transpose() == _form(g)


@pytest.mark.parametrize(
    ("f", "vanishing"), [([3, 1, 4, 1, -5, 9, 2], 0), ([7, 1, 1, 0, 2, 0, 0, 1], 1), ([1, 5, -2, *[3] * 7, 1], 10)]
)
def test_reduced_matrices_are_ready_for_theta(f, vanishing):
    """In genus 2, 3 and 4, the number of even theta constants of a hyperelliptic curve that vanish is 0, 1 and 10
    (Mumford 1984).
    """
    P = period_balls(HyperellipticCurve(QQ, f), 30)
    g = P.cover.genus
    tau, matrix = siegel_reduced(P)
    assert matrix * _form(g) * matrix.transpose() == _form(g)
    assert all(abs(float(tau[i, j].real)) < 0.501 for i in range(g) for j in range(g))
    assert float(tau[0, 0].imag) > 0.866 - 1e-3
    with P.cover.numbers.working():
        constants = tau.theta(acb_mat([[0]] * g))
    even = [k for k in range(4**g) if bin((k >> g) & k & (2**g - 1)).count("1") % 2 == 0]
    assert sum(1 for k in even if constants[0, k].contains(0)) == vanishing
    assert all(constants[0, k].contains(0) for k in range(4**g) if k not in even)


def test_coefficients_are_taken_as_the_numbers_that_they_are():
    third = period_balls(HyperellipticCurve(QQ, [1, 0, 0, "1/3", 0, 1]), 30)
    double = period_balls(HyperellipticCurve(MP(20), [1, 0, 0, 1 / 3, 0, 1]), 30)
    exact = period_balls(HyperellipticCurve(QQ, [1, 0, 0, Fraction(1 / 3), 0, 1]), 30)
    assert all(x.overlaps(y) for r, s in zip(exact.big, double.big, strict=True) for x, y in zip(r, s, strict=True))
    assert not any(x.overlaps(y) for r, s in zip(third.big, double.big, strict=True) for x, y in zip(r, s, strict=True))


def test_what_cannot_be_had_is_refused_by_name():
    with pytest.raises(ArgumentError, match="QQ, RR, CC or MP"):
        period_balls(HyperellipticCurve(GF(7), [1, 0, 0, 0, 0, 1]))
    with pytest.raises(ArgumentError, match="a HyperellipticCurve"):
        period_balls([1, 2])
    with pytest.raises(ArgumentError, match="digits"):
        period_balls(HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]), 0)
    for wrong in (3, periods(HyperellipticCurve(CC, [1, 2, 0, 0, 0, 1]))):
        with pytest.raises(ArgumentError, match=r"found = .*: a period matrix in balls"):
            siegel_reduced(wrong)
    for K in (RR, CC):
        with pytest.raises(ArgumentError, match="double root"):
            period_balls(HyperellipticCurve(K, poly.from_roots(K, [1, 1, 2, 3, 4])))
    with pytest.raises(PrecisionLoss, match="not separated"):
        period_balls(HyperellipticCurve(CC, poly.from_roots(CC, [1, 1, 2, 3, 1j])))


def test_the_precision_of_flint_is_as_before_and_balls_can_be_pickled():
    before = ctx.prec
    P = period_balls(HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]), 50)
    assert ctx.prec == before
    assert pickle.loads(pickle.dumps(P)) == P
