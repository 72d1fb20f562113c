"""A curve as a double cover Y² = F(x) = f + h²/4 of the line: branch points, a spanning tree of them, half-periods.

An edge is a segment between two branch points, and its lift to the curve is a closed path, a cycle. The cycles used are
the lifts of the 2g edges of the Euclidean minimal spanning tree of the branch points (after Molin and Neurohr 2019,
with this tree); integrals are computed by Gauss–Chebyshev quadrature. The lifts of two edges with a common end cross
there once; Y is a local parameter, and the directions of the lifts in Y give the sign of the crossing. No other lifts
meet, since the edges of a minimal tree are disjoint except for their ends.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import comb
from typing import Any, NamedTuple

from jacobian.curve.curve import HyperellipticCurve, check_curve
from jacobian.errors import ArgumentError, PrecisionLoss, shown
from jacobian.fields import CC
from jacobian.periods.quadrature import Vector, complex_field, ellipse, working_numbers
from jacobian.periods.roots import check_separated, conjugated, simple_roots


class Edge(NamedTuple):
    """An edge of the tree from branch point i to j, with its integrals ∫ x^k dx/Y.

    ``directions``: the directions in which Y/√F'(e) moves along the edge's lift, at e = e_i and e = e_j; modulus 1.
    """

    i: int
    j: int
    integrals: Vector
    directions: tuple[complex, complex]


class BranchedCover:
    """The double cover Y² = lead·Π(x − e). ``roots``: the branch points e, in the arithmetic ``numbers``.

    The argument ``roots``: the e in any order, if known.
    """

    def __init__(self, curve: HyperellipticCurve, roots: Sequence[Any] | None = None) -> None:
        self.curve = check_curve(curve)
        self.genus = curve.genus
        self.numbers = numbers = working_numbers(curve.field)
        K: Any = curve.field
        self.real = K.exact or not K.complex
        four = [numbers.convert(c) for c in curve.discriminant]
        self.coefficients = [c / 4 for c in four[: 2 * self.genus + 2 if curve.model == "ramified" else None]]
        self.lead = self.coefficients[-1]
        self.given: tuple[Any, ...] | None = None
        if roots is None:
            self.roots = simple_roots(numbers, self.coefficients)
            self.roots = conjugated(numbers, self.roots) if self.real else self.roots
        else:
            self.roots = self._check(roots)
        check_separated(numbers, self.roots)
        self._rough = [complex(e) for e in self.roots]

    def _check(self, roots: Sequence[Any]) -> Vector:
        """The given roots as working numbers; ArgumentError if Π(x − e) is not F/lead."""
        numbers, degree = self.numbers, len(self.coefficients) - 1
        if isinstance(roots, str) or not isinstance(roots, Iterable) or len(roots := list(roots)) != degree:
            raise ArgumentError(f"roots = {shown(roots)}: {degree} numbers are needed, the roots of f + h²/4")
        self.given = tuple(roots)
        found = [numbers.convert(self._coerced(e, f"roots[{i}]")) for i, e in enumerate(roots)]
        product: Vector = [self.lead]
        K: Any = self.curve.field
        for e in found:
            product = [b - e * a for a, b in zip([*product, 0], [0, *product], strict=True)]
        for i, (c, d) in enumerate(zip(self.coefficients, product, strict=True)):
            scale = abs(self.lead) * comb(degree, i) * max(abs(e) for e in found) ** (degree - i)
            if abs(c - d) > 1e4 * K.eps * scale:
                raise ArgumentError(
                    f"roots = {shown(list(roots))}: they give another coefficient of x^{i} than the curve has"
                )
        return found

    def _coerced(self, e: Any, argument: str) -> Any:
        if self.numbers.machine:
            return CC.coerce(e, argument)
        if hasattr(e, "_mpf_") or hasattr(e, "_mpc_") or isinstance(e, complex):
            return e
        return self.curve.field.coerce(e, argument)

    def rounded(self, matrix: Sequence[Vector]) -> tuple[tuple[Any, ...], ...]:
        """Rows of working numbers as numbers of the complex field that contains the field of the curve."""
        field = complex_field(self.curve.field)
        return tuple(tuple(field.coerce(x) for x in row) for row in matrix)

    def tree(self) -> list[tuple[int, int]]:
        """2g edges of the Euclidean minimal spanning tree of the branch points, beginning at the first (Prim 1957)."""
        e = self._rough
        inside = [0]
        edges: list[tuple[int, int]] = []
        while len(edges) < 2 * self.genus:
            rest = [j for j in range(len(e)) if j not in inside]
            i, j = min(((i, j) for i in inside for j in rest), key=lambda ij: abs(e[ij[0]] - e[ij[1]]))
            inside.append(j)
            edges.append((i, j))
        return edges

    def edge(self, i: int, j: int, count: int | None = None) -> Edge:
        """The edge from branch point i to j with its integrals of x^k dx/Y, k < ``count`` (by default g), on one sheet.

        In the variable t, x = middle + half·t, let the u_k be the other branch points. Then
        Y = c·√(1−t²)·Π√(±(t − u_k)), where the signs are such that each √(±(t − u_k)) is holomorphic near [−1, 1].
        """
        numbers = self.numbers
        a, b = self.roots[i], self.roots[j]
        middle, half = (a + b) / 2, (b - a) / 2
        others = [(e - middle) / half for k, e in enumerate(self.roots) if k not in (i, j)]
        right = sum(1 for u in others if u.real > 0)
        c = numbers.sqrt(self.lead * half ** len(self.roots) * (1 if right % 2 else -1))
        moments = self._moments(others, self.genus if count is None else count)
        factor = half / c * numbers.pi
        integrals = [
            factor * sum(comb(k, m) * middle ** (k - m) * half**m * moments[m] for m in range(k + 1))
            for k in range(len(moments))
        ]
        # the directions in which Y moves along the lift at both ends e, each divided by the direction of a fixed √F'(e)
        rough = [(complex(u), u.real > 0) for u in others]
        start = _unit(_unit(c) * rough_root(rough, -1) / self._slope_root(i))
        end = _unit(-_unit(c) * rough_root(rough, 1) / self._slope_root(j))
        return Edge(i, j, integrals, (start, end))

    def _moments(self, others: Vector, count: int) -> Vector:
        """∫ t^m/Π√(±(t − u_k)) dt/(π√(1−t²)) over [−1, 1], m < ``count``, with the signs of :meth:`edge`.

        ``others`` are the u_k.
        """
        n = self.numbers.node_count(2 * min((ellipse(complex(u)) for u in others), default=8))
        return self._means(others, n, count)

    def _means(self, others: Vector, n: int, count: int) -> Vector:
        """The mean of t^m/Π√(±(t − u_k)) over the n Chebyshev nodes, m < ``count``, with the signs of :meth:`edge`.

        ``others`` are the u_k.
        """
        numbers, moments = self.numbers, [self.numbers.real(0)] * count
        real = all(u.imag == 0 for u in others)
        right, left = ([u for u in others if (u.real > 0) == side] for side in (True, False))
        rough = [(complex(u), u.real > 0) for u in others]
        if real:
            right, left = [u.real for u in right], [u.real for u in left]
        for node in numbers.nodes(n):
            for t in (node, -node):
                point = t if real else numbers.convert(t)
                product = 1
                for u in right:
                    product = product * (u - point)
                for u in left:
                    product = product * (point - u)
                if real:
                    weight = 1 / (product**0.5 if numbers.machine else numbers.sqrt(product))
                else:
                    weight = 1 / numbers.root(product, rough_root(rough, float(t)))
                for m in range(count):
                    moments[m] += weight
                    weight = weight * t
        return [x / n for x in moments]

    def _slope_root(self, i: int) -> complex:
        """A square root of F'(e_i)/|F'(e_i)|."""
        value = _unit(self.lead)
        for k, e in enumerate(self.roots):
            if k != i:
                value *= _unit(self.roots[i] - e)
        return complex(value) ** 0.5


def _unit(z: Any) -> complex:
    return complex(z / abs(z))


def rough_root(others: Sequence[tuple[complex, bool]], t: float) -> complex:
    """Π√(±(t − u)) with principal roots, to a few digits.

    ``others``: pairs of u and whether ± is −; :meth:`BranchedCover.edge` takes − for Re u > 0.
    """
    value = 1 + 0j
    for u, right in others:
        # for t in [−1, 1] the radicand stays off the negative axis
        value *= (u - t if right else t - u) ** 0.5
    return value


def crossings(edges: Sequence[Edge]) -> list[list[int]]:
    """The matrix of intersection numbers of the edges' lifts, from their directions at common branch points.

    Edges of a minimal tree meet at 60° or more, and their lifts in Y at 30° or more. PrecisionLoss if two lifts nearly
    touch.
    """
    size = len(edges)
    matrix = [[0] * size for _ in range(size)]
    for k, first in enumerate(edges):
        for m in range(k):
            second = edges[m]
            for p, v in zip((first.i, first.j), first.directions, strict=True):
                for q, w in zip((second.i, second.j), second.directions, strict=True):
                    if p == q:
                        sine = (v.conjugate() * w).imag
                        if abs(sine) < 0.25:
                            raise PrecisionLoss("two cycles touch where they should cross; use more digits")
                        sign = 1 if sine > 0 else -1
                        matrix[k][m], matrix[m][k] = sign, -sign
    return matrix
