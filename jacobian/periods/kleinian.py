"""Kleinian functions of genus 2: ℘_ij and ζ_i at z in ℂ², as symmetric functions of the divisor with the image z.

On Y² = F(x) let z be the image of P_1 + P_2, z = Σ ∫ (dx/Y, x dx/Y), and let e be a branch point or infinity. For any
two points (s, S) and (t, T) among P_1, P_2 and, for finite e, (e, 0),

    ℘_11 + ℘_12 (s + t) + ℘_22 st = (F(s, t) − 2ST)/(4(s − t)²),    F(s, t) = Σ s^i t^i (2F_2i + F_2i+1 (s + t))

(Klein 1888; Baker 1907). With Π = (x − e)(x − x_1)(x − x_2) and the differentials ρ_j of
:mod:`jacobian.periods.second_kind`, ζ_j = −Σ ∫ ρ_j + ½ Σ Y_k·c_j(x_k)/Π′(x_k), c_1 = 2x − e − x_1 − x_2 and c_2 = 1
(after Buchstaber, Enolskii & Leykin 1997). All of it is computed modulo Mumford's polynomial u, so that no quotient
becomes 0/0 when P_1 and P_2 coincide: if F = V² + u·w, the right-hand side for P_1, P_2 is −(w_0 + u_0 w_2 + u_0²
w_4)/4.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple

from jacobian.errors import ArgumentError, PrecisionLoss, shown, whole
from jacobian.immutable import Immutable
from jacobian.periods.abel import AbelMap
from jacobian.periods.abel_balls import AbelBalls
from jacobian.periods.image import AbelImage
from jacobian.periods.matrix import nearest
from jacobian.periods.quadrature import Vector, from_branch_point, plus
from jacobian.periods.roots import horner
from jacobian.periods.second_kind import SecondKind, moments, second_kind


class Wp(NamedTuple):
    """The values of ℘_ij = −∂²(log σ)/∂z_i∂z_j at a point."""

    p11: Any
    p12: Any
    p22: Any


class KleinianFunctions(Immutable):
    """The functions ℘_ij and ζ_i of a curve of genus 2, in the numbers of its AbelMap or AbelBalls.

    Their poles are the classes [P − e]. On a ramified model e is infinity, and ℘_22 = F_5 (x_1 + x_2)/4. On other
    models e is the branch point of number ``branch_point`` in ``abel.periods.cover.roots``. ArgumentError for another
    genus.
    """

    def __init__(self, abel: AbelMap | AbelBalls, branch_point: int | None = None) -> None:
        if not isinstance(abel, (AbelMap, AbelBalls)) or abel.curve.genus != 2:
            raise ArgumentError(f"abel = {shown(abel)}: the AbelMap or AbelBalls of a curve of genus 2 is needed")
        ramified = abel.curve.model == "ramified"
        if ramified != (branch_point is None):
            wanted = "none, infinity being it" if ramified else "the number of one, 0 … 5"
            raise ArgumentError(f"branch_point = {shown(branch_point)}: on a {abel.curve.model} model {wanted}")
        if branch_point is not None:
            branch_point = whole(branch_point, "branch_point", "the number of a branch point is an int, 0 … 5", 0, 5)
        self.abel, self.branch_point = abel, branch_point

    def __repr__(self) -> str:
        return f"<Kleinian functions of {self.abel.curve!r}>"

    def wp(self, z: Sequence[Any]) -> Wp:
        """(℘_11, ℘_12, ℘_22) at z, two numbers of any size. Exceptions are those of ``abel.inverse``; PrecisionLoss
        near the poles.
        """
        with self._image.cover.numbers.working():
            return Wp(*self._out(self._wp(self._divisor(z))))

    def zeta(self, z: Sequence[Any]) -> tuple[Any, Any]:
        """(ζ_1, ζ_2) at z. The functions are odd, and ∂ζ_i/∂z_j = −℘_ij.

        If a period of the first kind is added to z, the corresponding period of the second kind is subtracted from ζ.
        Infeasible where a branch point is too near to all paths.
        """
        image, numbers = self._image, self._image.cover.numbers
        with numbers.working():
            at, given = self._divisor(z), [numbers.convert(x) for x in image.check_image(z)]
            first, second = self._integrals(at)
            rows = [[*a, *b] for a, b in zip(self._second.A, self._second.B, strict=True)]
            lattice = [nearest(c) for c in image.periods.coordinates(plus(given, first, -1))]
            whole_periods = [sum(n * numbers.convert(x) for n, x in zip(lattice, row, strict=True)) for row in rows]
            found = [c - r - h for c, r, h in zip(self._algebraic(at), second, whole_periods, strict=True)]
            one, two = self._out(found)
            return one, two

    @property
    def _image(self) -> AbelImage:
        return self.abel if isinstance(self.abel, AbelImage) else self.abel._images[-1]

    @cached_property
    def _second(self) -> SecondKind:
        return second_kind(self._image.periods)

    def _out(self, values: Vector) -> Vector:
        return [self.abel.field.coerce(x) for x in values] if isinstance(self.abel, AbelMap) else values

    def _divisor(self, z: Sequence[Any]) -> _Divisor:
        numbers = self._image.cover.numbers
        found = self.abel.inverse(z)
        u, v = ([numbers.convert(c) for c in row] for row in (found.u, found.v))
        if len(u) < 3:
            raise PrecisionLoss(f"z = {shown(z)}: the functions have poles there, or nearly")
        return _Divisor(u, v, [numbers.convert(c) / 2 for c in self.abel.curve.h])

    def _wp(self, at: _Divisor) -> Vector:
        numbers, coefficients = self._image.cover.numbers, self._image.cover.coefficients
        F = [*map(numbers.convert, coefficients), *[0] * (7 - len(coefficients))]
        s, p, (v0, v1) = at.s, at.p, at.V
        w = at.divided([c - d for c, d in zip(F, [v0 * v0, 2 * v0 * v1, v1 * v1, *[0] * 4], strict=True)])
        both = -(w[0] + p * w[2] + p * p * w[4]) / 4
        if self.branch_point is None:
            return [both, -F[5] * p / 4, F[5] * s / 4]
        e = self._image.cover.roots[self.branch_point]
        odd, even = [0, *F[1::2], 0], F[::2]
        polar = [2 * even[i] * e**i + odd[i + 1] * e ** (i + 1) + (odd[i] * e ** (i - 1) if i else 0) for i in range(4)]
        inverse = at.inverse(e)
        b, a = at.times(at.reduced([c / 4 for c in polar]), at.times(inverse, inverse))
        p22 = (both - b + (e - s) * a) / horner(at.u, e)
        return [b - e * a + e * e * p22, a - e * p22, p22]

    def _algebraic(self, at: _Divisor) -> Vector:
        """½ Σ Y_k·c_j(x_k)/Π′(x_k), j = 1, 2: the part of ζ_j without integrals (:mod:`jacobian.periods.kleinian`)."""
        if self.branch_point is None:
            return [at.V[1] / 2, 0]
        e = self._image.cover.roots[self.branch_point]
        over = at.times(at.V, at.inverse(e))
        return [at.times(over, [-e - at.s, 2])[1] / 2, over[1] / 2]

    def _integrals(self, at: _Divisor) -> tuple[Vector, Vector]:
        """The integrals of x^k dx/Y, k < 2, and those of ρ_1, ρ_2 (:mod:`jacobian.periods.second_kind`), from branch
        point 0 to the points of the divisor, summed over both points. Both kinds are integrated along the same paths.
        """
        cover = self._image.cover
        powers: Vector = [0] * 5
        middle = at.s / 2
        beside = cover.numbers.sqrt(middle * middle - at.p)
        for x in (middle + beside, middle - beside):
            i, values = from_branch_point(
                cover.numbers, cover.roots, cover.lead, (x, horner(at.V, x)), lambda t: [t**k for k in range(5)]
            )
            powers = plus(plus(powers, self._halves[i]), values)
        rows = [[cover.numbers.convert(c) for c in row] for row in self._second.polynomials]
        return powers[:2], [sum(c * x for c, x in zip(row, powers, strict=True)) for row in rows]

    @cached_property
    def _halves(self) -> dict[int, Vector]:
        """The integrals of x^k dx/Y, k < 5, from branch point 0 to each branch point, along the edges of the tree.

        The path to the branch point outside the tree, if there is one, ends with a segment from its nearest neighbour.
        """
        cover = self._image.cover
        found: dict[int, Vector] = {0: [cover.numbers.convert(0)] * 5}
        for edge in self._image.periods.edges:
            found[edge.j] = plus(found[edge.i], moments(cover, edge.i, edge.j))
        for last in set(range(len(cover.roots))) - set(found):
            near = min(found, key=lambda i: float(abs(cover.roots[i] - cover.roots[last])))
            found[last] = plus(found[near], moments(cover, near, last))
        return found


class _Divisor:
    """The divisor P_1 + P_2 as (u, V), V = v + h/2 modulo u, and the ring of polynomials modulo u = x² − s·x + p.

    Elements of the ring are two coefficients, ascending.
    """

    def __init__(self, u: Vector, v: Vector, half_h: Vector) -> None:
        self.u, self.s, self.p = u, -u[1], u[0]
        self.V = plus([*v, 0, 0][:2], self.reduced(half_h))

    def times(self, a: Vector, b: Vector) -> Vector:
        top = a[1] * b[1]
        return [a[0] * b[0] - self.p * top, a[0] * b[1] + a[1] * b[0] + self.s * top]

    def reduced(self, a: Vector) -> Vector:
        found: Vector = [0, 0]
        for c in reversed(a):
            found = plus(self.times(found, [0, 1]), [c, 0])
        return found

    def divided(self, a: Vector) -> Vector:
        """The quotient of ``a`` by u without the remainder, deg a = 6."""
        rest, found = list(a), [0] * 5
        for i in range(4, -1, -1):
            found[i] = rest[i + 2]
            rest[i + 1] += self.s * found[i]
            rest[i] -= self.p * found[i]
        return found

    def inverse(self, e: Any) -> Vector:
        """The inverse of x − e modulo u, by u = (x − e)(x + e − s) + u(e)."""
        value = horner(self.u, e)
        return [(self.s - e) / value, -1 / value]
