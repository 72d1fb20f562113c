"""Generators, modulo torsion, of the group that some classes over QQ generate in genus 2, by canonical heights.

Each class D is either independent of the classes before it, or nD is an integral combination of them up to torsion, for
some n > 0 (:func:`jacobian.relatives.heights.dependence`). If n > 1, D enlarges the lattice that those classes span
modulo torsion, and Hermite's normal form of coordinates gives a basis of the larger lattice.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import inf
from typing import Any, NamedTuple

from jacobian.law.divisor import Divisor
from jacobian.periods.matrix import nearest
from jacobian.relatives.heights import canonical_height, dependence, pairings, regulator
from jacobian.relatives.rational_torsion import differences


class Generators(NamedTuple):
    """Independent ``classes`` that generate the given group modulo torsion, and their ``regulator``.

    The regulator is the determinant of the height pairings of the classes, a ball without 0. This proves that the rank
    of J(QQ) is at least the number of classes. The given group need not be all of J(QQ).
    """

    classes: tuple[Divisor, ...]
    regulator: Any


def generators(classes: Iterable[Divisor], digits: int = 20) -> Generators:
    """Generators, modulo torsion, of the group that ``classes`` generate; each pairing has ``digits`` digits.

    Exceptions are those of :func:`jacobian.relatives.heights.canonical_height`; PrecisionLoss if this many digits do
    not decide whether a class depends on the others.
    """
    basis: list[Divisor] = []
    for D in classes:
        if D.order() == inf:
            basis = _with(basis, D, digits)
    basis = _reduced(basis, digits)
    return Generators(tuple(basis), regulator(basis, digits))


def from_points(J: Any, height: int, digits: int = 20) -> Generators:
    """Generators, modulo torsion, of the group of the differences of rational points with x of at most this height."""
    return generators(differences(J, height), digits)


def _with(basis: list[Divisor], D: Divisor, digits: int) -> list[Divisor]:
    """A basis, modulo torsion, of the lattice that ``basis`` and D, a class of infinite order, generate."""
    found = dependence(pairings([*basis, D], digits), [*basis, D], digits)
    if found is None:
        return [*basis, D]
    m, n = found
    # n times the coordinates of each class in the basis
    rows = [[n * int(i == j) for j in range(len(basis))] for i in range(len(basis))]
    return basis if n == 1 else _spanned([*rows, m], [*basis, D])


def _spanned(rows: Sequence[Sequence[int]], classes: Sequence[Divisor]) -> list[Divisor]:
    """A basis of the lattice spanned by classes of which ``rows`` has the integral coordinates, the rank being one less
    than the number of classes. Hermite's normal form of the rows, each with a unit vector appended, has in the place of
    the unit vectors the combinations of the classes.
    """
    from flint import fmpz_mat

    size = len(classes)
    matrix = fmpz_mat([[*row, *(int(i == j) for j in range(size))] for i, row in enumerate(rows)])
    return [_combined(row[-size:], classes) for row in matrix.hnf().tolist()[:-1]]


def _combined(row: Sequence[Any], classes: Sequence[Divisor]) -> Divisor:
    return sum((int(m) * D for m, D in zip(row, classes, strict=True)), classes[0].jacobian.zero())


def _reduced(basis: list[Divisor], digits: int) -> list[Divisor]:
    """A basis with small heights of the lattice that ``basis`` spans, found by LLL and sorted by height."""
    from flint import fmpz_mat

    if not basis:
        return []
    matrix = pairings(basis, digits)
    size, scale = len(basis), 10 ** (digits // 2)
    gram = fmpz_mat([[nearest(scale * matrix[max(i, j), min(i, j)]) for j in range(size)] for i in range(size)])
    _, T = gram.lll(transform=True, rep="gram")
    reduced = [_combined(row, basis) for row in T.tolist()]
    return sorted(reduced, key=lambda D: float(canonical_height(D, digits)))
