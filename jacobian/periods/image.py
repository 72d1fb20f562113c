"""From divisors to ℂ^g: integrals of x^k dx/(y + h/2) from a branch point e₀ to the points of a divisor.

The path to a point P begins at the branch point e from which the quadrature converges fastest, and is
x = e + (x_P − e)s², 0 ≤ s ≤ 1; with Y = y + h/2, Y/s has no zero on it. The integral from e₀ to e is a half-period
(:mod:`jacobian.periods.branched_cover`). On a ramified model the integral from ∞ to e₀ is −Σ ∫_{e₀}^{e_i}, since
Σ e_i − (2g+1)∞ is the divisor of Y.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import ArgumentError, CurveMismatch, Infeasible, entries, shown
from jacobian.immutable import Immutable
from jacobian.law.divisor import Divisor
from jacobian.periods.matrix import PeriodMatrix, solve
from jacobian.periods.quadrature import Vector, from_branch_point, plus
from jacobian.periods.roots import horner, simple_roots

Point = tuple[Any, Any]

# a straight path may pass too near to a branch point. Then x = c + 1/ξ is substituted, with c in one of these
# directions from the branch points' centre: a straight path of ξ is an arc of a circle in x
_DIRECTIONS = (0.37 + 1.93j, 0.52 - 1.71j, -1.86 - 0.44j, 1.77 + 0.23j)


class AbelImage(Immutable):
    """Maps divisors of ``given``, or of the same curve over the complex field, ``curve``, to ℂ^g modulo periods."""

    periods: PeriodMatrix
    given: HyperellipticCurve
    curve: HyperellipticCurve

    @property
    def cover(self) -> Any:
        """The branch points, and the numbers in which the integrals are computed."""
        return self.periods.cover

    def check_divisor(self, D: Any) -> Divisor:
        """D, if it is a divisor class of ``curve`` or ``given``; else CurveMismatch."""
        if not isinstance(D, Divisor) or D.jacobian.curve not in (self.curve, self.given):
            raise CurveMismatch(f"D = {shown(D)} is not a divisor class of {self.given!r}")
        return D

    def check_image(self, z: Any) -> list[Any]:
        """The g entries of z; else ArgumentError."""
        wanted = f"{self.given.genus} numbers"
        given = entries(z, "z", wanted)
        if len(given) != self.given.genus:
            raise ArgumentError(f"z = {shown(z)}: {wanted} are needed")
        return given

    def _points_of(self, D: Divisor) -> list[Point]:
        """The points (x, Y) of D as working numbers."""
        numbers = self.cover.numbers
        u, v = [numbers.convert(c) for c in D.u], [numbers.convert(c) for c in D.v]
        if len(u) == 1:
            return []
        return [(x, horner(v, x) + self._half_h(x)) for x in simple_roots(numbers, u)]

    def _above(self, x: Any, rough: Any) -> Point:
        """The point (x, Y) of Y² = f + h²/4 whose Y is nearer to ``rough``."""
        return x, self.cover.numbers.root(horner(self.cover.coefficients, x), rough)

    def _gap(self, points: Sequence[Point], target: Vector) -> Vector:
        """``target`` minus the image of the class of g points, reduced modulo periods."""
        return self.periods.reduce(plus(target, self._image_of(points, full_weight(self.curve)), -1))

    def _steps(self, points: Sequence[Point], gap: Vector) -> Vector:
        """The changes dx_i of the abscissas in Newton's method: Σ x_i^k dx_i/Y_i = gap_k, k < g."""
        return solve([[x**k / Y for x, Y in points] for k in range(self.curve.genus)], gap)

    def _half_h(self, x: Any) -> Any:
        h = self.given.h
        return horner([self.cover.numbers.convert(c) for c in h], x) / 2 if h else 0

    def _weight_of(self, D: Divisor) -> int:
        """The w with D = Σ(P_i − e₀) + w·(∞₊ − e₀) as classes, on a ramified model Σ(P_i − e₀) + w·(e₀ − ∞)."""
        degree = len(D.u) - 1
        if D.jacobian.curve.model == "ramified":
            return degree
        return 0 if D.n is None else 2 * D.n + degree - 2 * ((self.curve.genus + 1) // 2)

    def _image_of(self, points: Sequence[Point], weight: int) -> Vector:
        total: Vector = [self.cover.numbers.convert(0)] * self.curve.genus
        for point in points:
            total = plus(total, self._to_point(point))
        return plus(total, self._from_infinity(), weight) if weight else total

    def _to_point(self, point: Point) -> Vector:
        """The integrals from e₀ to a point, modulo periods; the path to it is straight or an arc of a circle."""
        g, cover = self.curve.genus, self.cover

        def forms(x: Any) -> Vector:
            return [x**k for k in range(g)]

        try:
            i, integral = from_branch_point(cover.numbers, cover.roots, cover.lead, point, forms)
            return plus(self.half_periods[i], integral)
        except Infeasible as error:
            failure = error
        for direction in _DIRECTIONS:
            c = self._outside(direction)
            xi = 1 / (point[0] - c)
            try:
                return self._to_image(c, xi, point[1] * xi ** (g + 1))
            except Infeasible as error:
                failure = error
        raise failure

    def _outside(self, direction: complex) -> Any:
        """A point in the given direction from the centre of the branch points, at some distance from all of them."""
        roots = self.cover.roots
        centre = sum(roots) / len(roots)
        radius = max(abs(e - centre) for e in roots)
        return centre + radius * self.cover.numbers.convert(direction)

    def _to_image(self, c: Any, xi: Any, eta: Any) -> Vector:
        """The integrals from e₀ to the point (ξ, η) of η² = ξ^(2g+2)·F(c + 1/ξ), modulo periods; ξ = 0 is ∞."""
        cover, g, half_periods = self.cover, self.curve.genus, self.half_periods
        lead = cover.lead
        for e in cover.roots:
            lead = lead * (c - e)
        images = [1 / (e - c) for e in cover.roots]
        if self.curve.model == "ramified":
            images = [*images, 0 * c]
            half_periods = [*half_periods, self._from_infinity()]

        def forms(t: Any) -> Vector:
            return [-((c * t + 1) ** k) * t ** (g - 1 - k) for k in range(g)]

        i, integral = from_branch_point(cover.numbers, images, lead, (xi, eta), forms)
        return plus(half_periods[i], integral)

    @cached_property
    def half_periods(self) -> list[Vector]:
        """The integrals from e₀ to each branch point of ``periods.cover.roots``, modulo periods, as working numbers."""
        cover = self.cover
        found: dict[int, Vector] = {0: [cover.numbers.convert(0)] * cover.genus}
        for edge in self.periods.edges:
            found[edge.j] = plus(found[edge.i], edge.integrals)
        if len(found) < len(cover.roots):
            # Σ e_i − (g+1)(∞₊+∞₋) is the divisor of Y, and 2e₀ ~ ∞₊+∞₋: the last integral is minus the others' sum
            (last,) = set(range(len(cover.roots))) - set(found)
            found[last] = [-sum(values) for values in zip(*found.values(), strict=True)]
        return [found[i] for i in range(len(cover.roots))]

    def _from_infinity(self) -> Vector:
        """The integrals from ∞ to e₀ on a ramified model, from e₀ to ∞₊ on a split model, modulo periods."""
        if self.curve.model == "ramified":
            return [-sum(values) for values in zip(*self.half_periods, strict=True)]
        g, numbers = self.curve.genus, self.cover.numbers
        # Y/x^(g+1) at ∞₊
        value = numbers.convert(self.curve.infinity_plus)
        if len(self.given.h) == g + 2:
            value += numbers.convert(self.given.h[g + 1]) / 2
        value = numbers.root(self.cover.lead, value)
        return self._to_image(self._outside(_DIRECTIONS[0]), numbers.convert(0), value)


def full_weight(curve: HyperellipticCurve) -> int:
    """The number w of :meth:`AbelImage._weight_of` for a class that ``Jacobian.from_points`` makes of g points."""
    return curve.genus if curve.model == "ramified" else -(curve.genus % 2)
