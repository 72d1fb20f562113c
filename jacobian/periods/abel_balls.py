"""The Abel–Jacobi map and its inverse in balls: images with proven errors, and divisors proven to have a given image.

The image is that of :mod:`jacobian.periods.image`, with the quadratures of :mod:`jacobian.periods.balls`. The inverse
begins with approximate points from :class:`jacobian.periods.abel.AbelMap` in floats. Newton's method in the midpoints
of balls sharpens them. Then the interval Newton operator (Moore 1966) on a box of x-coordinates proves that exactly one
divisor with x in the box has the given image.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, NamedTuple, TypeVar

from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import ArgumentError, Infeasible, NotRepresentable, PrecisionLoss, shown
from jacobian.immutable import Immutable
from jacobian.law.divisor import Divisor
from jacobian.periods.abel import AbelMap, complexified
from jacobian.periods.ball_cover import ball_roots, exact_polynomial
from jacobian.periods.image import AbelImage, Point
from jacobian.periods.matrix import PeriodMatrix
from jacobian.periods.proven import TRIALS, is_within, largest, period_balls
from jacobian.periods.quadrature import Vector
from jacobian.periods.roots import horner

Result = TypeVar("Result")

# starting from doubles, at most MOST_STEPS Newton steps are made on the midpoints of balls; a proof is tried at PROOFS
# precisions
MOST_STEPS, PROOFS = 20, 3


class BallDivisor(NamedTuple):
    """A divisor of g points: the ``points`` (x, y) as pairs of balls, and its Mumford pair (u, v), ascending."""

    points: tuple[Point, ...]
    u: tuple[Any, ...]
    v: tuple[Any, ...]


class AbelBalls(Immutable):
    """The Abel–Jacobi map D ↦ Σ ∫ x^k dx/(y + h/2), k = 0 … g−1, of a curve over QQ, RR, CC or MP(dps), in balls.

    Radii are at most 10^−digits times the largest period. Conventions are those of AbelMap, the map in floats.
    Exceptions are those of :func:`jacobian.periods.proven.period_balls`.
    """

    def __init__(self, curve: HyperellipticCurve, digits: int = 30) -> None:
        self.curve, self.digits = curve, digits
        self.periods = period_balls(curve, digits)
        self._images = [_Image(curve, self.periods)]

    def _value(self) -> tuple[object, ...]:
        return self.curve, self.digits

    def __reduce__(self) -> tuple[object, ...]:
        return AbelBalls, self._value()

    def __repr__(self) -> str:
        return f"Abel–Jacobi map of {self.curve!r} in balls"

    def __call__(self, D: Divisor) -> tuple[Any, ...]:
        """The image of a divisor class of ``curve``: g balls, reduced modulo periods to coordinates in [−½, ½].

        Over RR, CC and MP, where u and v are rounded, this is the image of the divisor whose points have the roots of u
        as x and are on the sheet nearer to v. PrecisionLoss where u has nearly equal roots.
        """
        D = self._images[0].check_divisor(D)

        def image(at: _Image) -> tuple[Any, ...] | None:
            found = at.of(D)
            return tuple(found) if is_within([found], self._radius()) else None

        return self._at_some_precision(image, "the image")

    def inverse(self, z: Sequence[Any]) -> BallDivisor:
        """The divisor of weight g with the image z, in balls that provably contain it for every z in the given balls.

        ``z``: g balls, or numbers taken as exact, modulo periods. PrecisionLoss where the class has, or may have, less
        weight, where points nearly coincide with each other, with a branch point or with infinity, or where z is not
        known well enough; NotRepresentable on an inert model of odd genus.
        """
        first = self._images[0]
        given = [first.checked(x, f"z[{i}]") for i, x in enumerate(first.check_image(z))]
        if self.curve.model == "inert" and self.curve.genus % 2:
            raise NotRepresentable(f"{self.curve!r} is inert of odd genus: there is no class of g points")
        with first.cover.numbers.working():
            target = first.target(given)
            if all(abs(x).contains(0) for x in target):
                raise PrecisionLoss("z may be a period, whose class has no points; use more digits")
            near = [complex(x) for x in target]
        floats = self._floats
        rough = floats._rough_inverse([floats.cover.numbers.convert(x) for x in near])
        return self._at_some_precision(lambda at: at.proven(given, rough), "the divisor", PROOFS)

    @cached_property
    def _floats(self) -> AbelMap:
        from jacobian.fields import CC

        # the branch points are passed on, because the coefficients in doubles do not determine clusters of them
        return AbelMap(complexified(self.curve, CC), [complex(e) for e in self.periods.cover.roots])

    def _radius(self) -> Any:
        return self.periods.cover.numbers.ten(-self.digits) * largest(self.periods)

    def _at_some_precision(self, work: Callable[[_Image], Result | None], what: str, trials: int = TRIALS) -> Result:
        """The result of ``work`` at the first precision at which it succeeds."""
        failure = "the radii are too large"
        for trial in range(trials):
            if trial == len(self._images):
                self._images.append(_Image(self.curve, period_balls(self.curve, self.digits * 2**trial)))
            at = self._images[trial]
            try:
                with at.cover.numbers.working():
                    found = work(at)
            except (PrecisionLoss, Infeasible, ZeroDivisionError) as error:
                failure = str(error)
                continue
            if found is not None:
                return found
        raise PrecisionLoss(f"{what} is not proven to {self.digits} digits ({failure})")


class _Image(AbelImage):
    """The Abel–Jacobi map at one precision; its methods are called inside ``with numbers.working():``."""

    def __init__(self, curve: HyperellipticCurve, periods: PeriodMatrix) -> None:
        self.periods, self.given, self.curve = periods, curve, curve

    def of(self, D: Divisor) -> Vector:
        """The image of D, reduced modulo periods."""
        return self.periods.reduce(self._image_of(self._points_of(D), self._weight_of(D)))

    def _points_of(self, D: Divisor) -> list[Point]:
        numbers = self.cover.numbers
        if len(D.u) == 1:
            return []
        v = [numbers.convert(c) for c in D.v or (0,)]
        return [self._above(x, horner(v, x) + self._half_h(x)) for x in ball_roots(numbers, *exact_polynomial(D.u))]

    def checked(self, x: Any, argument: str) -> Any:
        """x, if it is a finite number or a ball; else ArgumentError."""
        try:
            self.cover.numbers.convert(x)
        except (AttributeError, ArithmeticError, TypeError, ValueError):
            raise ArgumentError(f"{argument} = {shown(x)}: a finite number or a ball is needed") from None
        return x

    def target(self, z: Sequence[Any]) -> Vector:
        """z as balls, reduced modulo periods."""
        return self.periods.reduce([self.cover.numbers.convert(x) for x in z])

    def proven(self, z: Sequence[Any], rough: Sequence[Point]) -> BallDivisor:
        """The divisor of :meth:`AbelBalls.inverse`, from approximations of its points; else PrecisionLoss."""
        numbers, target = self.cover.numbers, self.target(z)
        exact = [self._above(numbers.convert(x).mid(), numbers.convert(Y)) for x, Y in rough]
        points = self._sharpened(exact, target)
        gap = self._gap(points, target)
        radii = [2 * abs(step) + numbers.ten(-2 * numbers.digits) for step in self._steps(points, gap)]
        box = [self._above(numbers.widened(x, r), Y) for (x, Y), r in zip(points, radii, strict=True)]
        found = [x + step for (x, _), step in zip(points, self._steps(box, gap), strict=True)]
        if not all(x.contains_interior(y) for (x, _), y in zip(box, found, strict=True)):
            raise PrecisionLoss("no divisor is proven to lie there")
        return self._divisor([self._above(x, Y) for x, (_, Y) in zip(found, points, strict=True)])

    def _sharpened(self, points: list[Point], target: Vector) -> list[Point]:
        """The points after Newton's method on the midpoints of balls, until a step is above half of the last one."""
        last = None
        for _ in range(MOST_STEPS):
            steps = self._steps(points, self._gap(points, target))
            size = max(float(abs(step).mid()) for step in steps)
            points = [self._above((x + step).mid(), Y) for (x, Y), step in zip(points, steps, strict=True)]
            if last is not None and not size < last / 2:
                return points
            last = size
        return points

    def _divisor(self, points: Sequence[Point]) -> BallDivisor:
        numbers = self.cover.numbers
        xs, ys = [x for x, _ in points], [Y - self._half_h(x) for x, Y in points]
        acb_poly = numbers.flint.acb_poly
        v = acb_poly.interpolate(xs, ys)
        if not all(c.is_finite() for c in (*xs, *ys, *v.coeffs())):
            raise PrecisionLoss("points of the divisor nearly coincide")
        u = acb_poly.from_roots(xs)
        return BallDivisor(tuple(zip(xs, ys, strict=True)), tuple(u.coeffs()), tuple(v.coeffs()))
