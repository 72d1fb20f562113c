"""The Abel–Jacobi map of a curve over RR, CC or MP(dps), from divisor classes to ℂ^g modulo periods, and its inverse.

The integrals are those of :mod:`jacobian.periods.image`, by Fejér's rule. For the inverse, Newton's method follows a
segment from the image of a divisor of random points to z, in doubles, then refines the divisor at the field's own
precision. A class of weight g contains one divisor of g points, so any solution is the right one.
"""

from __future__ import annotations

import cmath
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from random import Random
from typing import Any

from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import JacobianError, NotOnCurve, PrecisionLoss, shown
from jacobian.fields.protocol import Field
from jacobian.law.divisor import Divisor
from jacobian.periods.image import AbelImage, Point, full_weight
from jacobian.periods.matrix import nearest, periods
from jacobian.periods.quadrature import Vector, complex_field, plus, working_numbers
from jacobian.periods.roots import horner

# the largest numbers of Newton steps from all starts together, in doubles and in 40 digits
MOST_STEPS, MOST_LONG_STEPS = 1000, 100


class AbelMap(AbelImage):
    """The Abel–Jacobi map D ↦ Σ ∫ x^k dx/(y + h/2), k = 0 … g−1, of a curve over RR, CC or MP(dps).

    ``periods``: its PeriodMatrix; ``curve``: the curve over the complex field, whose Jacobian contains the results of
    ``inverse``. ``roots``: the roots of f + h²/4, if known. Raises the exceptions of
    :func:`jacobian.periods.matrix.periods`.
    """

    def __init__(self, curve: HyperellipticCurve, roots: Sequence[Any] | None = None) -> None:
        self.periods = periods(curve, roots)
        self.given = curve
        self.field = complex_field(curve.field)
        self.curve = curve if curve.field == self.field else complexified(curve, self.field)
        self._others: dict[Any, AbelMap] = {}

    def _value(self) -> tuple[object, ...]:
        return self.given, self.cover.given

    def __reduce__(self) -> tuple[object, ...]:
        return AbelMap, self._value()

    def __repr__(self) -> str:
        return f"Abel–Jacobi map of {self.given!r}"

    def __call__(self, D: Divisor) -> tuple[Any, ...]:
        """The image of a class of ``curve``: g complex numbers, reduced modulo periods to coordinates in [−½, ½].

        If the map was made from a curve over a real field, classes of this curve are accepted too.

        Points that nearly coincide cost digits, because the roots of u are then ill-conditioned.
        """
        D = self.check_divisor(D)
        image = self.periods.reduce(self._image_of(self._points_of(D), self._weight_of(D)))
        return tuple(self.field.coerce(x) for x in image)

    def inverse(self, z: Sequence[Any]) -> Divisor:
        """The divisor class, in the Jacobian of ``curve``, whose image is z modulo periods; z: g numbers of any size.

        It is the identity for z in the lattice (to half the digits), otherwise a class of weight g. PrecisionLoss where
        the class has less weight or nearly coinciding points, where Newton's method does not reach it, or where
        the result is off the curve or has another image.
        """
        given = self.check_image(z)
        target = [self.cover.numbers.convert(self.field.coerce(x, f"z[{i}]")) for i, x in enumerate(given)]
        distances = [abs(c - nearest(c)) for c in self.periods.coordinates(target)]
        J = self.curve.jacobian()
        if max(distances) < self.cover.numbers.ten(-self.cover.numbers.digits // 2):
            return J.zero()
        points = self._polished(self._rough_inverse(target), target)
        field = self.field
        try:
            result = J.from_points([(field.coerce(x), field.coerce(Y - self._half_h(x))) for x, Y in points])
            J.from_mumford(result.u, result.v, result.n)
        except NotOnCurve as error:
            raise PrecisionLoss(
                f"z = {shown(z)}: the divisor found is not on the curve; use more digits ({error})"
            ) from None
        return self._checked(result, target)

    def _checked(self, D: Divisor, target: Vector) -> Divisor:
        """D, if its image agrees with the target to all but 8 digits; else PrecisionLoss. The points of D are the roots
        of u, which may be ill-conditioned.
        """
        image = self._image_of(self._points_of(D), self._weight_of(D))
        size = max(abs(c - nearest(c)) for c in self.periods.coordinates(plus(target, image, -1)))
        if not size < 10**8 * self.field.eps:
            raise PrecisionLoss(
                f"z = {shown(target)}: the image of the divisor that was found is off by {float(size):.1e}; use more "
                "digits"
            )
        return D

    def _rough_inverse(self, target: Vector) -> list[Point]:
        """Points whose image is near the target, from a search in doubles or, if that fails, in 40 digits."""
        from jacobian.fields import CC, MP

        numbers, failure = self.cover.numbers, ""
        for field in (self.field if numbers.machine else CC, MP(40, complex=True)):
            A = self if field == self.field else self._on_field(field)
            try:
                found = A._search([A.cover.numbers.convert(x) for x in target])
            except PrecisionLoss as error:
                failure = str(error)
                continue
            return [self._above(numbers.convert(x), Y) for x, Y in found]
        raise PrecisionLoss(failure)

    def _on_field(self, field: Field) -> AbelMap:
        if field not in self._others:
            convert = working_numbers(field).convert
            # roots with fewer digits than the field are computed again
            fewer = self.cover.numbers.digits < working_numbers(field).digits
            roots = None if fewer else [convert(e) for e in self.cover.roots]
            self._others[field] = AbelMap(complexified(self.given, field), roots)
        return self._others[field]

    def _search(self, target: Vector) -> list[Point]:
        """Points whose image is near the target, by continuation from up to six random divisors."""
        rng, failure = Random(0), "no start"
        steps = iter(range(MOST_STEPS if self.cover.numbers.machine else MOST_LONG_STEPS))
        for _ in range(6):
            try:
                points = self._by_continuation(target, rng, steps)
                if max(map(abs, self.periods.coordinates(self._gap(points, target)))) < 1e-3:
                    return points
                failure = "the path missed the target"
            except (JacobianError, ArithmeticError) as error:
                failure = str(error)
        raise PrecisionLoss(f"z = {shown(target)}: no divisor of weight g was found there ({failure})")

    def _by_continuation(self, target: Vector, rng: Random, steps: Iterator[int]) -> list[Point]:
        """Points whose image is near the target, by Newton's method along the segment from a random divisor's image.

        The number of steps is limited by the iterator ``steps``; PrecisionLoss where this is used up.
        """
        points = self._start(rng)
        begin, gap = self._image_of(points, full_weight(self.curve)), self._gap(points, target)
        done, step, tried = 0.0, 0.25, 0
        while done < 1:
            ahead, tried = min(1.0, done + step), tried + 1
            try:
                points = self._polished(points, plus(begin, gap, ahead), islice(steps, 5), 1e-5)
                done, step = ahead, 2 * step
            except (PrecisionLoss, ArithmeticError):
                step /= 4
            if step < 1e-4 or tried > 60:
                raise PrecisionLoss("Newton's method found no way from the start")
        return points

    def _start(self, rng: Random) -> list[Point]:
        """g random points with abscissas near the branch points."""
        roots = [complex(e) for e in self.cover.roots]
        centre = sum(roots) / len(roots)
        radius = max(abs(e - centre) for e in roots)
        xs = [centre + radius * cmath.rect(0.3 + rng.random(), 6.3 * rng.random()) for _ in range(self.curve.genus)]
        convert = self.cover.numbers.convert
        return [self._above(convert(x), rng.choice((1, -1)) * (1 + 1j)) for x in xs]

    def _polished(
        self, points: list[Point], target: Vector, allowed: Iterable[int] = range(12), tolerance: Any = None
    ) -> list[Point]:
        """The points after Newton's method for the image ``target``.

        The iteration ends when all coordinates of the target minus the image in the basis of periods are below
        ``tolerance``; PrecisionLoss if it does not converge within the steps ``allowed``.
        """
        numbers, last, size = self.cover.numbers, None, None
        for _ in allowed:
            gap = self._gap(points, target)
            size = max(abs(c) for c in self.periods.coordinates(gap))
            if size < (tolerance or numbers.ten(3 - numbers.digits)):
                return points
            if last is not None and last <= size < numbers.ten(6 - numbers.digits):
                return points
            if last is not None and size > 2 * last:
                break
            last = size
            steps = self._steps(points, gap)
            points = [self._moved(x, Y, step) for (x, Y), step in zip(points, steps, strict=True)]
        if size is None:
            raise PrecisionLoss("Newton's method found no way to z in the steps allowed")
        raise PrecisionLoss(f"Newton's method stopped at the distance {float(size):.1e} from z; use more digits")

    def _moved(self, x: Any, Y: Any, step: Any) -> Point:
        slope = horner([i * c for i, c in enumerate(self.cover.coefficients)][1:], x)
        return self._above(x + step, Y + slope * step / (2 * Y))


def complexified(curve: HyperellipticCurve, field: Any) -> HyperellipticCurve:
    """``curve`` over a complex field; the point ∞₊ stays ∞₊."""
    move: Any = complex if field.dps is None else field.coerce
    f, h = [move(c) for c in curve.f], [move(c) for c in curve.h]
    result = HyperellipticCurve(field, f, h)
    if curve.model == "split":
        near, far = (abs(move(curve.infinity_plus) - z) for z in (result.infinity_plus, result.infinity_minus))
        if far < near:
            result = HyperellipticCurve(field, f, h, result.infinity_minus)
    return result
