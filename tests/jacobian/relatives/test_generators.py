"""Generators modulo torsion of groups whose generators are known independently."""

from __future__ import annotations

from random import Random

from jacobian import QQ, HyperellipticCurve
from jacobian.relatives.generators import from_points, generators
from jacobian.relatives.heights import regulator, relation
from tests.jacobian.test_published_curves import ROWS, curve

J = HyperellipticCurve(QQ, [1, 2, 0, 0, 0, 1]).jacobian()
D, E = J.from_points([(0, 1)]), J.from_points([(1, 2)])


def close(found, expected):
    return abs(float(found) / float(expected) - 1) < 1e-12


def test_a_lattice_grows_to_the_one_that_holds_all_classes():
    """Sublattices of ℤD + ℤE by random combinations, with D and E in the lattice at the end."""
    rng, whole = Random(5), regulator([D, E])
    for _ in range(4):
        classes = [rng.randint(-3, 3) * D + rng.randint(-3, 3) * E for _ in range(3)]
        found = generators([*classes, 2 * D, 3 * D - 2 * E, E - D])
        assert len(found.classes) == 2
        assert close(found.regulator, whole)


def test_the_index_is_kept():
    """No class is divided beyond the group: 2D and 3E generate a subgroup of index 6."""
    found = generators([2 * D, 3 * E, 2 * D + 3 * E, J.zero()])
    assert close(found.regulator, 36 * regulator([D, E]))
    assert close(generators([4 * D, 6 * D]).regulator, 4 * regulator([D]))
    assert relation(list(found.classes)) is None


def test_torsion_is_left_out():
    T = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian()
    found = generators([T.from_points([(0, 1)]), T.zero()])
    assert found.classes == ()
    assert float(found.regulator) == 1


def test_generators_of_small_points():
    """The regulators of published curves, of rank 3 at most: 25913.a.25913.1 has two points at infinity."""
    found = from_points(J, 100)
    assert len(found.classes) == 2
    assert close(found.regulator, regulator([D, E]))
    for label in ("587.a.587.1", "8281.a.8281.1", "25913.a.25913.1"):
        group = curve(ROWS[label]).jacobian()
        expected = [group.from_mumford(*given) for given in ROWS[label]["classes"]]
        found = from_points(group, 100)
        assert len(found.classes) == len(expected)
        assert close(found.regulator, regulator(expected))
