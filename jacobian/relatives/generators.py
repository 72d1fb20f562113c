"""Generators, modulo torsion, of the group that some classes over QQ generate in genus 2, by canonical heights.

Each class is either independent of those before it, or n times it is exactly an integral combination of these up to
torsion (:func:`jacobian.relatives.heights.dependence`). With n > 1 the lattice has grown, and Euclid's algorithm on
coordinates finds a basis of it.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import inf
from typing import Any, NamedTuple

from jacobian.curve.points import AffinePoint
from jacobian.law.divisor import Divisor
from jacobian.numbers.long_reals import BallReals
from jacobian.periods.matrix import nearest
from jacobian.relatives.heights import canonical_height, dependence, pairings


class Generators(NamedTuple):
    """``classes``: independent ones, so that the rank is at least their number by proof; ``regulator``: the determinant
    of their pairings, a ball. Together with torsion they generate the given group, which need not be all of J(QQ).
    """

    classes: tuple[Divisor, ...]
    regulator: Any


def generators(classes: Iterable[Divisor], digits: int = 20) -> Generators:
    """Generators of the group of these classes modulo torsion, each pairing with ``digits`` digits.

    Errors as :func:`jacobian.relatives.heights.canonical_height`; PrecisionLoss if this many digits do not decide a
    relation.
    """
    basis: list[Divisor] = []
    for D in classes:
        if D.order() == inf:
            basis = _with(basis, D, digits)
    basis = _reduced(basis, digits)
    matrix = pairings(basis, digits)
    with BallReals(64 + 4 * digits):
        return Generators(tuple(basis), matrix.det())


def from_points(J: Any, height: int, digits: int = 20) -> Generators:
    """:func:`generators` of the differences of rational points with x of up to this height."""
    points = sorted(J.curve.points(height), key=lambda P: isinstance(P, AffinePoint))
    return generators((J(P, points[0]) for P in points[1:]), digits)


def _with(basis: list[Divisor], D: Divisor, digits: int) -> list[Divisor]:
    """A basis of the lattice that these classes and D, of infinite order, generate."""
    found = dependence(pairings([*basis, D], digits), [*basis, D], digits)
    if found is None:
        return [*basis, D]
    m, n = found
    rows = [([n * int(i == j) for j in range(len(basis))], G) for i, G in enumerate(basis)]
    return basis if n == 1 else _euclid([*rows, (m, D)])


def _euclid(rows: list[tuple[list[int], Divisor]]) -> list[Divisor]:
    """The classes of a basis of the lattice of integral rows: the rows are brought to echelon form with them."""
    found = []
    for column in range(len(rows[0][0])):
        while True:
            rows.sort(key=lambda row: (not row[0][column], abs(row[0][column])))
            (first, D), rest = rows[0], rows[1:]
            if not first[column] or not any(row[column] for row, _ in rest):
                break
            quotients = [row[column] // first[column] for row, _ in rest]
            rows[1:] = [
                ([a - q * b for a, b in zip(row, first, strict=True)], E - q * D)
                for q, (row, E) in zip(quotients, rest, strict=True)
            ]
        if first[column]:
            found.append(D)
            rows = rest
    return found


def _reduced(basis: list[Divisor], digits: int) -> list[Divisor]:
    """A basis of the same lattice of small heights (LLL), the smaller first."""
    from flint import fmpz_mat

    if not basis:
        return []
    matrix = pairings(basis, digits)
    size, scale = len(basis), 10 ** (digits // 2)
    gram = fmpz_mat([[nearest(scale * matrix[max(i, j), min(i, j)]) for j in range(size)] for i in range(size)])
    _, T = gram.lll(transform=True, rep="gram")
    zero = basis[0].jacobian.zero()
    reduced = [sum((int(m) * G for m, G in zip(row, basis, strict=True)), zero) for row in T.tolist()]
    return sorted(reduced, key=lambda D: float(canonical_height(D, digits)))
