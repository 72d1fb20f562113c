"""L-polynomials at all primes compared with point counts, PARI, torsion, and another computation of themselves."""

from __future__ import annotations

import json
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from itertools import islice
from math import isqrt
from pathlib import Path
from random import Random
from time import sleep

import numpy as np
import pytest

from jacobian import GF, QQ, ArgumentError, FieldError, HyperellipticCurve, Infeasible, SingularCurve
from jacobian.arithmetic import forest, residues, saved
from jacobian.arithmetic.l_polynomials import l_polynomials, of_curves
from jacobian.arithmetic.residues import primes_up_to
from jacobian.finite import counting
from tests.jacobian.arithmetic.point_counts import counts, points

# every degree, h = 0 and h ≠ 0, any leading coefficient, fractions, F(0) = 0, CM, split Jacobians
EVERY_DAY = [
    ([1, -1, 0, 1], []),
    ([0, 2, 3], [1, 0, 5]),
    ([6, 0, 0, 0, -3], []),
    ([1, -1, 0, 0, 0, 1], []),
    ([0, 3, -10, -3, -10, 2, 3], []),
    ([1, 2, 0, "1/3"], [1, 1, 0, 1]),
    ([1, 0, 0, 0, 0, 1], []),
    ([1, 0, -2, 0, 3, 0, 5], []),
    (["1/4", 3, 0, 0, 1, "7/5"], [1]),
    ([1, 0, 1, 0, 0, 0, -2, 1], [1]),
    ([2, 1, 0, -1, 4, 0, 0, 0, 3], []),
    ([1, 0, 0, 0, 0, 0, 0, 1], []),
    ([0, 1, 1, 0, 0, 0, 2**80, 3], [1, 1, 0, 1]),
]


PUBLISHED = json.loads((Path(__file__).parents[2] / "data/genus2_curves.json").read_text())["curves"]


def random_curve(rng, g):
    while True:
        size = rng.choice([2, 10, 1000, 2**70])
        degree, slope = rng.choice([2 * g + 1, 2 * g + 2]), rng.choice([0, 0, g, g + 2])
        f, h = ([rng.randint(-size, size) for _ in range(n)] for n in (degree + 1, slope))
        if rng.random() < 0.3:
            f[0] = 0
        try:
            C = HyperellipticCurve(QQ, f, h)
        except (SingularCurve, ArgumentError):
            continue
        if C.genus == g:
            return C


def check_by_counting(C, bound, most=counting.ARRAY_SIZE):
    L = C.l_polynomials(bound)
    compared = 0
    for p in L.p.tolist():
        reduced = C.change_ring(GF(p))
        if p**C.genus <= most:
            assert L.polynomial(p) == counting.frobenius_polynomial(reduced)[::-1], (C, p)
            compared += 1
    assert compared
    for p in L.bad:
        with pytest.raises((SingularCurve, FieldError)):
            C.change_ring(GF(p))
    assert sorted([*L.p.tolist(), *L.bad]) == primes_up_to(bound).tolist()


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("f", "h"), EVERY_DAY)
def test_by_points_counted_one_by_one(f, h):
    C = HyperellipticCurve(QQ, f, h)
    check_by_counting(C, {1: 300, 2: 150, 3: 50}[C.genus], 10**5)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_thirty_curves_by_points_counted_one_by_one(seed):
    C = random_curve(Random(seed), 1 + seed % 3)
    check_by_counting(C, 500, 250_000)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_four_hundred_pairs_of_pari(seed):
    pari = pytest.importorskip("cypari").pari
    pari.allocatemem(10**9, silent=True)
    rng = Random(1000 + seed)
    C = random_curve(rng, 1 + seed % 3)
    L = C.l_polynomials({1: 1 << 12, 2: 1 << 11, 3: 1 << 9}[C.genus])
    for p in rng.sample(L.p[L.p > 2].tolist(), 20):
        F = "+".join(f"({c})*x^{i}" for i, c in enumerate(residues.integral_equation(C)))
        chi = pari(f"hyperellcharpoly(Mod(1,{p})*({F}))")
        assert [int(pari.polcoef(chi, i)) for i in range(2 * C.genus, -1, -1)] == L.polynomial(p), (C, p)


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("f", "h"), EVERY_DAY)
def test_orders_are_those_of_random_classes(f, h):
    """L_p(1) annihilates random classes, also at primes that only the forest reaches; a_1 is within Weil's bound."""
    C = HyperellipticCurve(QQ, f, h)
    L, g, rng = C.l_polynomials(6000), C.genus, Random(3)
    for p, row in zip(L.p.tolist(), L.coefficients.tolist(), strict=True):
        assert abs(row[0]) <= isqrt(4 * g * g * p)
    for p, order in islice(zip(L.p.tolist()[::-1], L.orders()[::-1], strict=True), 8):
        J = C.change_ring(GF(p)).jacobian()
        if g % 2 == 0 or J.curve.model != "inert":
            assert not order * J.random(rng)
        assert order == sum(L.polynomial(p))


def check_points(C, L, p, degrees):
    """The points over GF(p^k) agree with all of L_p, not only its lower half."""
    said = counts(L.polynomial(p), p, max(degrees))
    assert [said[k - 1] for k in degrees] == [points(C.discriminant, p, k) for k in degrees], (C, p)


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("f", "h"), EVERY_DAY)
def test_functional_equation(f, h):
    """The upper half of L_p, made from the lower half, gives the numbers of points over GF(p^(g+1)) … GF(p^2g)."""
    C = HyperellipticCurve(QQ, f, h)
    g, L = C.genus, C.l_polynomials(100)
    for p in L.p[(L.p > 2) & (L.p <= {1: 100, 2: 17, 3: 7}[g])].tolist():
        check_points(C, L, p, range(1, 2 * g + 1))
    if g == 2:
        # beyond 16g² by the forest, not by counting
        check_points(C, L, 67 if 67 in L.p else 71, (1, 2))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 200, 18))
def test_genus_3_by_points_over_two_fields_below_500(seed):
    """Beyond 62, where counting in the package ends: a_1 at all primes, a_2 at 20 of them, a_3 at one."""
    rng = Random(seed)
    C = random_curve(rng, 3)
    L = C.l_polynomials(500)
    for p in L.p[L.p > 62].tolist():
        check_points(C, L, p, (1,))
    for p in rng.sample(L.p[L.p > 62].tolist(), 20):
        check_points(C, L, p, (1, 2))
    check_points(C, L, rng.choice(L.p[(L.p > 62) & (L.p < 110)].tolist()), (3,))


@pytest.mark.parametrize("every", [19, pytest.param(1, marks=pytest.mark.slow)])
def test_torsion_divides_all_orders(every):
    """For published curves, and for two with known classes of order 5 and 7; torsion injects at odd primes."""
    rows = [row for row in PUBLISHED if "torsion" in row]
    assert len(rows) == 55
    given = [(row["f"], row["h"], int(np.prod(row["torsion"]))) for row in rows[::every]]
    for f, h, order in [*given, ([1, 0, 0, 0, 0, 1], [], 10), ([1, 0, 0, 0, 0, 0, 0, 1], [], 14)]:
        L = HyperellipticCurve(QQ, f, h).l_polynomials(2000)
        assert all(n % order == 0 for p, n in zip(L.p.tolist(), L.orders(), strict=True) if p > 2)


def check_published(rows, bound, chosen):
    for row in rows:
        C = HyperellipticCurve(QQ, row["f"], row["h"])
        L = C.l_polynomials(bound)
        assert list(L.bad) == [p for p in C.bad_primes() if p <= bound]
        for p in filter(chosen, L.p.tolist()):
            assert L.polynomial(p) == counting.frobenius_polynomial(C.change_ring(GF(p)))[::-1]


def test_published_curves():
    check_published(PUBLISHED[::8], 70, lambda p: p < 12 or p > 66)


@pytest.mark.slow
def test_all_published_curves():
    check_published(PUBLISHED, 150, lambda p: True)


# --- the forest, walks and matrices


@pytest.mark.thinned(3)
@pytest.mark.parametrize("g", [1, 2, 3, 4, pytest.param(6, marks=pytest.mark.slow)])
def test_matrices_are_those_of_the_power(g):
    """Compared with coefficients of F^((p−1)/2), for blocks of any size: one walk, or many trees."""
    flint = pytest.importorskip("flint")
    rng = Random(g)
    for _ in range(2):
        C = random_curve(rng, g)
        F = residues.integral_equation(C)
        primes, W = C.hasse_witt_matrices(300)
        assert len(primes) > 40
        for block in (16, 64):
            assert (residues.hasse_witt(F, g, primes, block) == W).all()
        for p, matrix in zip(primes.tolist(), W.tolist(), strict=True):
            power = flint.nmod_poly([c % p for c in F], p) ** ((p - 1) // 2)
            assert matrix == [[int(power[i * p - j]) for j in range(1, g + 1)] for i in range(1, g + 1)]


def test_matrices_are_the_transposed_ones_of_cartier_and_manin():
    C = HyperellipticCurve(QQ, [1, 2, 0, 1, 0, 0, 0, 3], [1, 1])
    primes, W = C.hasse_witt_matrices(200)
    for p, matrix in zip(primes.tolist(), W, strict=True):
        assert matrix.T.tolist() == C.change_ring(GF(p)).cartier_manin()


@pytest.mark.parametrize("bound", [15_000, pytest.param(30_000, marks=pytest.mark.slow)])
def test_large_primes_by_a_forest_and_by_one_walk(monkeypatch, bound):
    C = HyperellipticCurve(QQ, [7, 0, -3, 1, 0, 2, 5])
    walked = C.l_polynomials(bound)
    monkeypatch.setattr(forest, "WALKED_TO", 1 << 10)
    monkeypatch.setattr(forest, "BLOCK", 1 << 9)
    monkeypatch.setattr(residues, "PART", 50)
    assert (C.l_polynomials(bound).coefficients == walked.coefficients).all()


class Killed(Exception):
    pass


@pytest.mark.parametrize("after", [400, *(pytest.param(x, marks=pytest.mark.slow) for x in (60, 1500))])
def test_a_run_that_is_killed_goes_on(monkeypatch, tmp_path, after):
    """It goes on from the last saved state, with trees and without, to the same result."""
    C, path = HyperellipticCurve(QQ, [1, -1, 0, 0, 0, 1]), tmp_path / "run.npz"
    wanted = C.l_polynomials(20_000)
    monkeypatch.setattr(forest, "WALKED_TO", 1 << 10)
    monkeypatch.setattr(forest, "BLOCK", 1 << 9)
    monkeypatch.setattr(residues, "PART", 50)
    monkeypatch.setattr(saved, "EVERY", -1.0)
    reached = []

    def killed(done, total):
        if done > after:
            raise Killed

    with pytest.raises(Killed):
        l_polynomials(C, 20_000, path, killed)
    assert [p.name for p in tmp_path.iterdir()] == ["run.npz"]
    found = l_polynomials(C, 20_000, path, lambda done, total: reached.append(done))
    assert reached[0] > after
    assert (found.coefficients == wanted.coefficients).all()
    assert (found.p == wanted.p).all()
    with pytest.raises(ArgumentError, match="another run"):
        C.l_polynomials(10_000, file=path)


RUN = """
import sys
from jacobian import QQ, HyperellipticCurve
from jacobian.arithmetic import forest, residues, saved
forest.WALKED_TO, forest.BLOCK, residues.PART, saved.EVERY = 1 << 10, 1 << 9, 50, -1.0
HyperellipticCurve(QQ, [1, -1, 0, 0, 0, 1]).l_polynomials(1 << 15, file=sys.argv[1])
"""


def test_a_process_that_is_killed_leaves_a_state_to_go_on_from(monkeypatch, tmp_path):
    """Killed by SIGKILL, which no process can catch, whether or not it is writing at that moment."""
    C, path = HyperellipticCurve(QQ, [1, -1, 0, 0, 0, 1]), tmp_path / "run.npz"
    process = subprocess.Popen([sys.executable, "-c", RUN, str(path)], cwd=Path(__file__).parents[3])
    try:
        sizes: set[int] = set()
        while len(sizes) < 5:
            assert process.poll() is None
            sleep(0.005)
            if path.exists():
                sizes.add(path.stat().st_size)
    finally:
        process.kill()
        process.wait()
    monkeypatch.setattr(forest, "WALKED_TO", 1 << 10)
    monkeypatch.setattr(forest, "BLOCK", 1 << 9)
    done, _ = saved.Saved(path, C, 1 << 15, 2).load()
    reached = []
    found = l_polynomials(C, 1 << 15, path, lambda now, total: reached.append(now))
    assert reached[0] > len(done) > 50
    assert (found.coefficients == C.l_polynomials(1 << 15).coefficients).all()


def test_a_file_that_is_no_state(tmp_path):
    C = HyperellipticCurve(QQ, [1, -1, 0, 0, 0, 1])
    (tmp_path / "text").write_text("p,a1\n")
    with pytest.raises(ArgumentError, match="no state of a run"):
        C.l_polynomials(100, file=tmp_path / "text")
    with pytest.raises(ArgumentError, match="no such folder"):
        C.l_polynomials(100, file=tmp_path / "none" / "run.npz")


@pytest.mark.parametrize("path", [(0, 1), iter(()), 3, "", "a\0b", "\ud800"])
def test_a_path_that_is_none(path):
    """Found by the fuzz suite of calls: this raised pathlib's own TypeError."""
    L = HyperellipticCurve(QQ, [1, -1, 0, 0, 0, 1]).l_polynomials(10)
    for call in (lambda: L.curve.l_polynomials(10, file=path), lambda: L.to_csv(path)):
        with pytest.raises(ArgumentError, match="give the name of a file"):
            call()


def test_many_curves_on_an_executor():
    curves = [HyperellipticCurve(QQ, f, h) for f, h in EVERY_DAY[3:6]]
    alone = list(of_curves(curves, 300))
    with ProcessPoolExecutor(1) as pool:
        together = list(of_curves(curves, 300, pool))
    assert [L.curve for L in together] == curves
    assert all((a.coefficients == b.coefficients).all() for a, b in zip(alone, together, strict=True))
    with pytest.raises(ArgumentError, match="executor"):
        next(of_curves(curves, 300, "processes"))


@pytest.mark.slow
def test_many_curves_on_a_cluster_of_dask():
    distributed = pytest.importorskip("distributed")
    curves = [HyperellipticCurve(QQ, f, h) for f, h in EVERY_DAY[3:6]]
    with (
        distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        together = list(of_curves(curves, 300, client.get_executor()))
    assert [L.curve for L in together] == curves
    for C, L in zip(curves, together, strict=True):
        assert (C.l_polynomials(300).coefficients == L.coefficients).all()


# --- the record


def test_tables(tmp_path):
    L = HyperellipticCurve(QQ, [1, -1, 0, 0, 0, 1]).l_polynomials(1000)
    frame = L.to_pandas()
    assert list(frame.columns) == ["p", "a1", "a2"]
    L.to_csv(tmp_path / "L.csv")
    lines = (tmp_path / "L.csv").read_text().split("\n")
    assert (lines[0], lines[1], len(lines)) == ("p,a1,a2", "3,3,7", len(L) + 2)
    L.to_parquet(tmp_path / "L.parquet")
    pandas = pytest.importorskip("pandas")
    assert pandas.read_parquet(tmp_path / "L.parquet").equals(frame)
    assert L.p.dtype == L.coefficients.dtype == np.int64
    with pytest.raises(ValueError, match="read-only"):
        L.p[0] = 4
    with pytest.raises(ArgumentError, match="of bad reduction"):
        L.polynomial(19)
    with pytest.raises(ArgumentError, match="p = 1009"):
        L.polynomial(1009)


def test_a_bar_counts_all_primes(capsys):
    pytest.importorskip("tqdm")
    found = HyperellipticCurve(QQ, [1, -1, 0, 0, 0, 1]).l_polynomials(40, progress=True)
    assert f"{len(found.p)}/{len(found.p)}" in capsys.readouterr().err


def test_what_is_refused():
    C = HyperellipticCurve(QQ, [1, -1, 0, 0, 0, 1])
    for bound in (1, 2.5, "100", None):
        with pytest.raises(ArgumentError, match="bound"):
            C.l_polynomials(bound)
    with pytest.raises(Infeasible, match="bound"):
        C.l_polynomials(1 << 30)
    with pytest.raises(ArgumentError, match="progress"):
        C.l_polynomials(100, progress=1)
    with pytest.raises(FieldError, match=r"GF\(7\)"):
        C.change_ring(GF(7)).l_polynomials(100)
    with pytest.raises(Infeasible, match="hasse_witt_matrices"):
        HyperellipticCurve(QQ, [1, 1, 0, 0, 0, 0, 0, 0, 0, 1]).l_polynomials(100)


def test_small_bounds():
    """No primes are left to be treated together; 2 is included where the equation is good there."""
    C = HyperellipticCurve(QQ, [0, 0, 0, 0, 0, 1], [1])
    assert C.l_polynomials(2).p.tolist() == [2]
    assert C.l_polynomials(2).polynomial(2) == counting.frobenius_polynomial(C.change_ring(GF(2)))[::-1]
    assert HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).l_polynomials(2).p.tolist() == []


def test_primes_with_groups_of_small_exponent():
    """y² = x⁸ + 1 is supersingular at p ≡ 7 modulo 8: Frobenius squared is −p, and L_p = (1 + pT²)³."""
    L = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 0, 0, 0, 1]).l_polynomials(2**9)
    rows = L.coefficients[L.p % 8 == 7]
    assert len(rows) > 20
    assert [(a1, a2, a3) for a1, a2, a3 in rows.tolist()] == [(0, 3 * p, 0) for p in L.p[L.p % 8 == 7].tolist()]
