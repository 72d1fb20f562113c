"""Random classes in large genus, all classes of large groups, and sums of very many points."""

from collections import Counter
from random import Random

import pytest

from jacobian import GF, ArgumentError, HyperellipticCurve, Infeasible
from jacobian.law import sampling

F4 = GF(2, 2, (1, 1, 1))
SMALL = {
    "ramified": HyperellipticCurve(GF(3), [1, 2, 0, 0, 0, 1]),
    "split": HyperellipticCurve(GF(3), [1, 0, 2, 0, 1, 0, 1]),
    "inert": HyperellipticCurve(GF(3), [1, 1, 0, 1, 0, 0, 2]),
    "even": HyperellipticCurve(F4, [2, 0, 1, 1], [1]),
}


@pytest.mark.thinned(3)
@pytest.mark.parametrize("name", SMALL)
def test_sums_of_places_are_uniform(name, monkeypatch):
    """The method of large genus on groups that can be counted: χ² within five standard deviations."""
    monkeypatch.setattr(sampling, "MOST_GENUS", 0)
    J, rng, times = SMALL[name].jacobian(), Random(5), 5
    n = J.order()
    counts = Counter(J.random(rng) for _ in range(times * n))
    found = sum((counts[D] - times) ** 2 / times for D in J.points())
    assert abs(found - (n - 1)) < 5 * (2 * n) ** 0.5


@pytest.mark.parametrize("genus", [13, 40])
def test_random_classes_in_large_genus(genus):
    """Rejection would keep one of 2^g pairs, and never ended in genus 50."""
    f = [Random(3).randrange(101) for _ in range(2 * genus + 1)]
    J = HyperellipticCurve(GF(101), [*f, 1]).jacobian()
    D, E = J.random(Random(1)), J.random(Random(2))
    assert D == J.random(Random(1)) != E
    assert D.degree >= genus - 2
    assert J.from_mumford(D.u, D.v) == D
    assert D + E - D == E


def test_too_large_a_genus_is_refused():
    rng = Random(3)
    J = HyperellipticCurve(GF(101), [*(rng.randrange(101) for _ in range(2001)), 1]).jacobian()
    with pytest.raises(Infeasible, match="genus 1000: "):
        J.random(Random(1))


def test_classes_of_a_large_group_are_not_listed():
    J = HyperellipticCurve(GF(2**61 - 1), [1, 1, 0, 0, 0, 1]).jacobian()
    with pytest.raises(Infeasible, match="up to 1000000000 are listed"):
        J.points()


def test_a_point_a_million_times():
    """One addition after the other took minutes."""
    J = HyperellipticCurve(GF(101), [1, 0, 0, 0, 0, 1]).jacobian()
    assert J.from_points([(0, 1)] * 10**4) == 10**4 * J((0, 1))
    with pytest.raises(ArgumentError, match="points: 1000000 of them are added one by one, 100000 at most"):
        J.from_points([(0, 1)] * 10**6)
    with pytest.raises(ArgumentError, match="multiplicities"):
        J.from_points([(0, 1)], multiplicities=[10**6])
