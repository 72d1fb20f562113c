"""The Abel–Jacobi map of a curve over RR, CC or MP(dps), from divisor classes to ℂ^g modulo periods, and its inverse.

Integrals of x^k dx/(y + h/2) run from a branch point e to a point by the path x = e + (x_P − e)s², on which Y/s has
no zero: Fejér's rule in s, from the branch point of fastest convergence. Between branch points they are half-periods
(:mod:`jacobian.periods.branched_cover`), and so is the integral from ∞ of a ramified model, −Σ ∫_{e₀}^{e_i}, since Σ
e_i − (2g+1)∞ is the divisor of Y.

The inverse follows Newton's method along a segment from the image of a divisor of random points to z, in doubles; then
it polishes at the field's own precision. A class of weight g has one divisor, so that no step can lead astray.
"""

from __future__ import annotations

import cmath
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from itertools import islice
from random import Random
from typing import Any

from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import (
    ArgumentError,
    CurveMismatch,
    Infeasible,
    JacobianError,
    NotOnCurve,
    PrecisionLoss,
    entries,
    shown,
)
from jacobian.immutable import Immutable
from jacobian.law.divisor import Divisor
from jacobian.periods.matrix import Oval, PeriodMatrix, nearest, periods, real_periods, solve
from jacobian.periods.quadrature import Vector, complex_field, from_branch_point, working_numbers
from jacobian.periods.roots import horner, simple_roots

__all__ = ["AbelMap", "Oval", "PeriodMatrix", "periods", "real_periods"]

Point = tuple[Any, Any]

# of Newton's method, from all starts together, in doubles and in 40 digits
MOST_STEPS, MOST_LONG_STEPS = 1000, 100

_DIRECTIONS = (0.37 + 1.93j, 0.52 - 1.71j, -1.86 - 0.44j, 1.77 + 0.23j)


class AbelMap(Immutable):
    """The Abel–Jacobi map D ↦ Σ ∫ x^k dx/(y + h/2), k = 0 … g−1, of a curve over RR, CC or MP(dps).

    ``periods``: its PeriodMatrix; ``curve``: the curve over the complex field, whose Jacobian the inverse lands in.
    ``roots``: those of f + h²/4, where they are known. Raises as :func:`jacobian.periods.matrix.periods`.
    """

    def __init__(self, curve: HyperellipticCurve, roots: Sequence[Any] | None = None) -> None:
        self.periods = periods(curve, roots)
        self.given = curve
        self.field = complex_field(curve.field)
        self.curve = curve if curve.field == self.field else _complexified(curve, self.field)
        self._cover = self.periods.cover
        self._others: dict[Any, AbelMap] = {}

    def _value(self) -> tuple[Any, ...]:
        return self.given, self._cover.given

    def __reduce__(self) -> Any:
        return AbelMap, self._value()

    def __repr__(self) -> str:
        return f"Abel–Jacobi map of {self.given!r}"

    def __call__(self, D: Divisor) -> tuple[Any, ...]:
        """The image of a divisor class of ``curve`` (or of the curve given, if real): g complex numbers, reduced modulo
        periods to coordinates in [−½, ½].

        Points that nearly coincide cost digits, as the roots of u lose them.
        """
        if not isinstance(D, Divisor) or D.jacobian.curve not in (self.curve, self.given):
            raise CurveMismatch(f"D = {shown(D)} is not a divisor class of {self.given!r}")
        image = self.periods.reduce(self._image(self._points(D), self._weight(D)))
        return tuple(self.field.coerce(x) for x in image)

    # --- the map

    def _points(self, D: Divisor) -> list[Point]:
        """The points (x, Y) of D as working numbers."""
        numbers = self._cover.numbers
        u, v = [numbers.convert(c) for c in D.u], [numbers.convert(c) for c in D.v]
        if len(u) == 1:
            return []
        return [(x, horner(v, x) + self._half_h(x)) for x in simple_roots(numbers, u)]

    def _half_h(self, x: Any) -> Any:
        h = self.given.h
        return horner([self._cover.numbers.convert(c) for c in h], x) / 2 if h else 0

    def _weight(self, D: Divisor) -> int:
        """The multiple of ∞₊ that stands beside Σ(P_i − e₀); on a ramified model that of e₀ − ∞."""
        degree = len(D.u) - 1
        if D.jacobian.curve.model == "ramified":
            return degree
        return 0 if D.n is None else 2 * D.n + degree - 2 * ((self.curve.genus + 1) // 2)

    def _image(self, points: Sequence[Point], weight: int) -> Vector:
        total: Vector = [self._cover.numbers.convert(0)] * self.curve.genus
        for point in points:
            total = _plus(total, self._to_point(point))
        return _plus(total, self._from_infinity(), weight) if weight else total

    def _to_point(self, point: Point) -> Vector:
        """∫ from e₀ to a point, modulo periods; where no straight path will do, along an arc of a circle."""
        g, cover = self.curve.genus, self._cover

        def forms(x: Any) -> Vector:
            return [x**k for k in range(g)]

        try:
            i, integral = from_branch_point(cover.numbers, cover.roots, cover.lead, point, forms)
            return _plus(self.half_periods[i], integral)
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
        """A point at some distance from the branch points."""
        roots = self._cover.roots
        centre = sum(roots) / len(roots)
        radius = max(abs(e - centre) for e in roots)
        return centre + radius * self._cover.numbers.convert(direction)

    def _to_image(self, c: Any, xi: Any, eta: Any) -> Vector:
        """∫ from e₀ to the point (ξ, η) of η² = ξ^(2g+2)·F(c + 1/ξ), modulo periods: ∞ is ξ = 0."""
        cover, g, half_periods = self._cover, self.curve.genus, self.half_periods
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
        return _plus(half_periods[i], integral)

    @cached_property
    def half_periods(self) -> list[Vector]:
        """∫ from e₀ to every branch point of ``periods.cover.roots``, modulo periods, as working numbers."""
        cover = self._cover
        found: dict[int, Vector] = {0: [cover.numbers.convert(0)] * cover.genus}
        for edge in self.periods.edges:
            found[edge.j] = _plus(found[edge.i], edge.integrals)
        if len(found) < len(cover.roots):
            # Σ e_i − (g+1)(∞₊+∞₋) is the divisor of Y, and 2e₀ ~ ∞₊+∞₋: the last one is minus the sum of the others
            (last,) = set(range(len(cover.roots))) - set(found)
            found[last] = [-sum(values) for values in zip(*found.values(), strict=True)]
        return [found[i] for i in range(len(cover.roots))]

    def _from_infinity(self) -> Vector:
        """∫ from ∞ to e₀ on a ramified model, from e₀ to ∞₊ on another, modulo periods."""
        if self.curve.model == "ramified":
            return [-sum(values) for values in zip(*self.half_periods, strict=True)]
        g, numbers = self.curve.genus, self._cover.numbers
        value = numbers.convert(self.curve.infinity_plus)
        if len(self.given.h) == g + 2:
            value += numbers.convert(self.given.h[g + 1]) / 2
        return self._to_image(self._outside(_DIRECTIONS[0]), numbers.convert(0), value)

    # --- the inverse

    def inverse(self, z: Sequence[Any]) -> Divisor:
        """The divisor class with the image z, in the Jacobian of ``curve``: g numbers, of any size, modulo periods.

        The identity for z in the lattice (to half the digits), otherwise a class of weight g: PrecisionLoss where the
        class has less weight or nearly coinciding points, where no way to it is found in some hundred steps of Newton's
        method, or where the class that was found is not on the curve or has another image.
        """
        wanted = f"{self.curve.genus} numbers"
        given = entries(z, "z", wanted)
        if len(given) != self.curve.genus:
            raise ArgumentError(f"z = {shown(z)}: {wanted} are needed")
        target = [self._cover.numbers.convert(self.field.coerce(x, f"z[{i}]")) for i, x in enumerate(given)]
        distances = [abs(c - nearest(c)) for c in self.periods.coordinates(target)]
        J = self.curve.jacobian()
        if max(distances) < self._cover.numbers.ten(-self._cover.numbers.digits // 2):
            zero: Divisor = J.zero()
            return zero
        points = self._polished(self._rough_inverse(target), target)
        field = self.field
        try:
            result = J.from_points([(field.coerce(x), field.coerce(Y - self._half_h(x))) for x, Y in points])
            J.from_mumford(result.u, result.v, result.n)
        except NotOnCurve as error:
            raise PrecisionLoss(f"z = {z}: what was found is off the curve; use more digits ({error})") from None
        return self._checked(result, target)

    def _checked(self, D: Divisor, target: Vector) -> Divisor:
        """D, if its image is the target to all but some digits: its coefficients may not determine its points."""
        image = self._image(self._points(D), self._weight(D))
        size = max(abs(c - nearest(c)) for c in self.periods.coordinates(_plus(target, image, -1)))
        if not size < 10**8 * self.field.eps:
            raise PrecisionLoss(
                f"z = {target}: the image of the divisor that was found is off by {float(size):.1e}; use more digits"
            )
        return D

    def _rough_inverse(self, target: Vector) -> list[Point]:
        """Points whose image is near the target, as working numbers: in doubles, or where that fails in 40 digits."""
        from jacobian.fields import CC, MP

        numbers, failure = self._cover.numbers, ""
        for field in (self.field if numbers.machine else CC, MP(40, complex=True)):
            A = self if field == self.field else self._on_field(field)
            try:
                found = A._search([A._cover.numbers.convert(x) for x in target])
            except PrecisionLoss as error:
                failure = str(error)
                continue
            return [self._on_curve(numbers.convert(x), Y) for x, Y in found]
        raise PrecisionLoss(failure)

    def _on_field(self, field: Any) -> AbelMap:
        """The map over another field, made once."""
        if field not in self._others:
            convert = working_numbers(field).convert
            # roots with fewer digits than the field has are found again
            fewer = self._cover.numbers.digits < working_numbers(field).digits
            roots = None if fewer else [convert(e) for e in self._cover.roots]
            self._others[field] = AbelMap(_complexified(self.given, field), roots)
        return self._others[field]

    def _search(self, target: Vector) -> list[Point]:
        """Points whose image is near the target, from several starts."""
        rng, failure, steps = (
            Random(0),
            "no start",
            iter(range(MOST_STEPS if self._cover.numbers.machine else MOST_LONG_STEPS)),
        )
        for _ in range(6):
            try:
                points = self._by_continuation(target, rng, steps)
                if self._residual_size(points, target) < 1e-3:
                    return points
                failure = "the path missed the target"
            except (JacobianError, ArithmeticError) as error:
                failure = str(error)
        raise PrecisionLoss(f"z = {target}: no divisor of weight g was found there ({failure})")

    def _by_continuation(self, target: Vector, rng: Random, steps: Iterator[int]) -> list[Point]:
        points = self._start(rng)
        begin, gap = self._image(points, self._full_weight), self._gap(points, target)
        done, step, tried = 0.0, 0.25, 0
        while done < 1:
            ahead, tried = min(1.0, done + step), tried + 1
            try:
                points = self._polished(points, _plus(begin, gap, ahead), islice(steps, 5), 1e-5)
                done, step = ahead, 2 * step
            except (PrecisionLoss, ArithmeticError):
                step /= 4
            if step < 1e-4 or tried > 60:
                raise PrecisionLoss("Newton's method found no way from the start")
        return points

    @property
    def _full_weight(self) -> int:
        """What :meth:`_weight` is for ``from_points`` of g points."""
        return self.curve.genus if self.curve.model == "ramified" else -(self.curve.genus % 2)

    def _start(self, rng: Random) -> list[Point]:
        roots = [complex(e) for e in self._cover.roots]
        centre = sum(roots) / len(roots)
        radius = max(abs(e - centre) for e in roots)
        xs = [centre + radius * cmath.rect(0.3 + rng.random(), 6.3 * rng.random()) for _ in range(self.curve.genus)]
        convert = self._cover.numbers.convert
        return [self._on_curve(convert(x), rng.choice((1, -1)) * (1 + 1j)) for x in xs]

    def _on_curve(self, x: Any, rough: Any) -> Point:
        """(x, Y) with the Y on the side of a rough value."""
        return x, self._cover.numbers.root(horner(self._cover.coefficients, x), complex(rough))

    def _gap(self, points: Sequence[Point], target: Vector) -> Vector:
        """target − image of the points, reduced modulo periods."""
        return self.periods.reduce(_plus(target, self._image(points, self._full_weight), -1))

    def _residual_size(self, points: Sequence[Point], target: Vector) -> Any:
        return max(abs(c) for c in self.periods.coordinates(self._gap(points, target)))

    def _polished(
        self, points: list[Point], target: Vector, allowed: Iterable[int] = range(12), tolerance: Any = None
    ) -> list[Point]:
        """Newton's method for Σ ∫ = target: Σ x_i^k dx_i/Y_i = gap_k. PrecisionLoss where it does not settle in the
        steps allowed.
        """
        g, numbers = self.curve.genus, self._cover.numbers
        digits = numbers.digits
        if len(points) != g:
            raise PrecisionLoss(f"a divisor of weight {len(points)} < g = {g} came up")
        last = size = None
        for _ in allowed:
            gap = self._gap(points, target)
            size = max(abs(c) for c in self.periods.coordinates(gap))
            if size < (tolerance or numbers.ten(3 - digits)) or (
                last is not None and last <= size < numbers.ten(6 - digits)
            ):
                return points
            if last is not None and size > 2 * last:
                break
            last = size
            steps = solve([[x**k / Y for x, Y in points] for k in range(g)], gap)
            points = [self._moved(x, Y, step) for (x, Y), step in zip(points, steps, strict=True)]
        if size is None:
            raise PrecisionLoss("Newton's method found no way to z in the steps allowed")
        raise PrecisionLoss(f"Newton's method stopped at the distance {float(size):.1e} from z; use more digits")

    def _moved(self, x: Any, Y: Any, step: Any) -> Point:
        slope = horner([i * c for i, c in enumerate(self._cover.coefficients)][1:], x)
        return self._on_curve(x + step, Y + slope * step / (2 * Y))


def _plus(a: Vector, b: Vector, factor: Any = 1) -> Vector:
    return [x + factor * y for x, y in zip(a, b, strict=True)]


def _complexified(curve: HyperellipticCurve, field: Any) -> HyperellipticCurve:
    """The curve over a complex field, ∞₊ being the same point."""
    machine = not hasattr(field, "dps")

    def move(c: Any) -> Any:
        return complex(c) if machine else field.coerce(c)

    f, h = [move(c) for c in curve.f], [move(c) for c in curve.h]
    result = HyperellipticCurve(field, f, h)
    if curve.model == "split":
        near, far = (abs(move(curve.infinity_plus) - z) for z in (result.infinity_plus, result.infinity_minus))
        if far < near:
            result = HyperellipticCurve(field, f, h, result.infinity_minus)
    return result
