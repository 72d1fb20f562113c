"""Periods of the differentials x^k dx/(y + h/2), k < g, of a curve over RR, CC or MP(dps): matrices and real ovals."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import ArgumentError, FieldError, PrecisionLoss
from jacobian.immutable import Immutable
from jacobian.linear import pivoted
from jacobian.periods.branched_cover import BranchedCover, Edge, crossings
from jacobian.periods.quadrature import Vector, plus

Matrix = list[list[Any]]


class Oval(NamedTuple):
    """A bounded oval over ``start`` ≤ x ≤ ``end`` and its ``periods`` 2∫ x^k dx/|y + h/2|, k = 0 … g−1."""

    start: Any
    end: Any
    periods: tuple[Any, ...]


@dataclass(frozen=True, eq=False)
class PeriodMatrix(Immutable):
    """Periods of x^k dx/(y + h/2), k < g, as numbers of a complex field or as balls.

    ``A`` and ``B``: g×g tuples of rows, A[k][j] = ∮ of differential k along a_j, with a_i·b_j = δ_ij and no other
    crossings. ``cover`` and ``edges``: branch points, and the tree of segments between them with half-periods;
    ``cycles``: a_1 … a_g, b_1 … b_g as integral combinations of the lifts of the edges. ``working``: (A, B) with guard
    digits. ``recipe``: a function and its arguments, from which pickle makes the matrix again.
    """

    A: tuple[tuple[Any, ...], ...]
    B: tuple[tuple[Any, ...], ...]
    cover: BranchedCover
    edges: tuple[Edge, ...]
    working: Matrix
    cycles: tuple[tuple[int, ...], ...]
    recipe: tuple[Callable[..., PeriodMatrix], tuple[Any, ...]]

    def _value(self) -> tuple[object, ...]:
        return self.recipe

    def __reduce__(self) -> tuple[object, ...]:
        return self.recipe

    def __repr__(self) -> str:
        return f"<period matrix of {self.recipe[1][0]!r}>"

    @property
    def big(self) -> tuple[tuple[Any, ...], ...]:
        """The matrix (A, B): g rows of 2g numbers."""
        return tuple((*a, *b) for a, b in zip(self.A, self.B, strict=True))

    @cached_property
    def tau(self) -> tuple[tuple[Any, ...], ...]:
        """The matrix τ = A⁻¹B, which is symmetric with a positive definite imaginary part."""
        return self.cover.rounded(self._working_tau)

    @cached_property
    def _working_tau(self) -> Matrix:
        g = self.cover.genus
        with self.cover.numbers.working():
            columns = [solve([row[:g] for row in self.working], [row[g + j] for row in self.working]) for j in range(g)]
        return [list(row) for row in zip(*columns, strict=True)]

    def coordinates(self, z: Sequence[Any]) -> list[Any]:
        """The 2g real coordinates c with z = (A, B)·c, as working numbers; they are integers for z in the lattice."""
        g, numbers = self.cover.genus, self.cover.numbers
        if len(z) != g:
            raise ArgumentError(f"z has {len(z)} entries: g = {g} are needed")
        with numbers.working():
            z = [numbers.convert(x) for x in z]
            rows = [[x.real for x in row] for row in self.working] + [[x.imag for x in row] for row in self.working]
            return solve(rows, [x.real for x in z] + [x.imag for x in z])

    def reduce(self, z: Sequence[Any]) -> list[Any]:
        """z minus a vector of the lattice, so that its coordinates are in [−½, ½], as working numbers."""
        whole = [nearest(c) for c in self.coordinates(z)]
        with self.cover.numbers.working():
            return [
                self.cover.numbers.convert(x) - sum(m * p for m, p in zip(whole, row, strict=True))
                for x, row in zip(z, self.working, strict=True)
            ]

    def bilinear_residual(self) -> Any:
        """The largest |τ_ij − τ_ji|, which would be zero by Riemann's bilinear relations if nothing were rounded."""
        tau = self._working_tau
        with self.cover.numbers.working():
            return max(abs(tau[i][j] - tau[j][i]) for i in range(len(tau)) for j in range(len(tau)))


def periods(curve: HyperellipticCurve, roots: Sequence[Any] | None = None) -> PeriodMatrix:
    """The PeriodMatrix of a curve over RR, CC or MP(dps), of any genus.

    ``roots``: the roots of f + h²/4, if known (ArgumentError where they do not fit). Over MP(dps) the entries are
    correct to about dps digits of the largest one; Riemann's relations are checked. PrecisionLoss where branch points
    coincide at this precision, Infeasible where one is too near to the segment between two others, FieldError over
    exact fields.
    """
    cover = BranchedCover(curve, roots)
    return period_matrix(cover, (periods, (curve, cover.given)))


def period_matrix(cover: BranchedCover, recipe: tuple[Callable[..., PeriodMatrix], tuple[Any, ...]]) -> PeriodMatrix:
    """The PeriodMatrix of a cover; for ``recipe`` see :class:`PeriodMatrix`."""
    edges = [cover.edge(i, j) for i, j in cover.tree()]
    basis = symplectic_basis(crossings(edges))
    working = [
        [2 * sum(m * edge.integrals[k] for m, edge in zip(cycle, edges, strict=True) if m) for cycle in basis]
        for k in range(cover.genus)
    ]
    g = cover.genus
    first, second = ([row[part] for row in working] for part in (slice(g), slice(g, None)))
    cycles = tuple(map(tuple, basis))
    result = PeriodMatrix(cover.rounded(first), cover.rounded(second), cover, tuple(edges), working, cycles, recipe)
    _check_riemann(result)
    return result


def symplectic_basis(matrix: list[list[int]]) -> list[list[int]]:
    """A symplectic basis: integer rows a_1 … a_g, b_1 … b_g with a_i·b_j = δ_ij and all other products 0.

    ``matrix``: the products of the given cycles, an alternating integer matrix of determinant 1. PrecisionLoss if it
    has another determinant, because crossings were then misjudged.
    """
    size = len(matrix)

    def dot(v: list[int], w: list[int]) -> int:
        return sum(v[i] * matrix[i][j] * w[j] for i in range(size) if v[i] for j in range(size) if w[j])

    rest = [[int(i == j) for j in range(size)] for i in range(size)]
    first, second = [], []
    while rest:
        a = rest.pop(0)
        while True:  # Euclid's algorithm on the numbers a·v
            rest.sort(key=lambda v: (dot(a, v) == 0, abs(dot(a, v))))
            b, size_b = rest[0], dot(a, rest[0])
            if size_b == 0:
                raise PrecisionLoss("the crossings of the cycles do not form a unimodular matrix; use more digits")
            if all(dot(a, v) == 0 for v in rest[1:]):
                break
            rest[1:] = [plus(v, b, -(dot(a, v) // size_b)) for v in rest[1:]]
        if abs(size_b) != 1:
            raise PrecisionLoss("the crossings of the cycles do not form a unimodular matrix; use more digits")
        b = [size_b * x for x in b]
        rest = [plus(v, a, -dot(v, b)) for v in rest[1:]]
        first.append(a)
        second.append(b)
    return first + second


def _check_riemann(result: PeriodMatrix) -> None:
    tau, numbers = result._working_tau, result.cover.numbers
    scale = max(abs(x) for row in tau for x in row)
    if not result.bilinear_residual() <= numbers.ten(-numbers.digits // 2) * scale or not _is_positive(tau):
        raise PrecisionLoss(
            "the periods do not satisfy Riemann's bilinear relations at this precision; use more digits"
        )


def _is_positive(tau: Matrix) -> bool:
    """Whether Im τ is positive definite, by elimination."""
    rows = [[x.imag for x in row] for row in tau]
    for k, row in enumerate(rows):
        if not row[k] > 0:
            return False
        for other in rows[k + 1 :]:
            factor = other[k] / row[k]
            other[:] = [x - factor * y for x, y in zip(other, row, strict=True)]
    return True


def real_periods(curve: HyperellipticCurve, roots: Sequence[Any] | None = None) -> list[Oval]:
    """The bounded ovals of a curve over RR or MP(dps), by ascending x, each with 2∫ x^k dx/|y + h/2|, k < g.

    They lie between neighbouring real roots of F = f + h²/4, where F is positive. The integrals are computed by
    Gauss–Chebyshev quadrature in real numbers. FieldError over a complex or an exact field; other exceptions are those
    of :func:`periods`.
    """
    cover = BranchedCover(curve, roots)
    if not cover.real:
        raise FieldError(f"field = {curve.field.name}: ovals belong to a curve over RR or MP(dps)")
    found = []
    line = sorted(e.real for e in cover.roots if e.imag == 0)
    for a, b in pairwise(line):
        # between a and b the sign of F is that of lead·(−1)^(number of roots from b on)
        if (sum(1 for e in line if e >= b) % 2 == 1) == (cover.lead.real < 0):
            found.append(_oval(cover, a, b))
    return found


def _oval(cover: BranchedCover, a: Any, b: Any) -> Oval:
    field = cover.curve.field
    i, j = (next(k for k, e in enumerate(cover.roots) if e.imag == 0 and e.real == x) for x in (a, b))
    first, *others = cover.edge(i, j).integrals
    size = 2 * abs(first)
    # the phase of Y is constant on the oval, so the integrals have real ratios
    periods = (size, *(size * (x / first).real for x in others))
    return Oval(field.coerce(a), field.coerce(b), tuple(map(field.coerce, periods)))


def nearest(c: Any) -> int:
    """The integer nearest to a real working number, or to the midpoint of a ball."""
    if isinstance(c, float):
        return round(c)
    if hasattr(c, "context"):
        return int(c.context.nint(c))
    if not c.is_finite():
        raise PrecisionLoss("a coordinate is not known; use more digits")
    middle = c.mid().fmpq()
    return int((2 * middle + 1).floor() // 2)


def solve(rows: Matrix, right: Vector) -> Vector:
    """The solution of a small linear system, by elimination with row exchanges; PrecisionLoss for a singular one."""
    solution = pivoted([[*row, c] for row, c in zip(rows, right, strict=True)])
    if solution is None:
        raise PrecisionLoss("a singular system: the divisor is in a special position, or the precision too low")
    return solution
