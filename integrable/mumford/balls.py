"""Motions on Jacobians of any genus in balls: the additions of :mod:`integrable.mumford.translations`, with bounds on
every truncation error.

A composition and a reduction step are identities between exact divisors. So they map balls around divisors to balls
around results. If a resultant or a leading coefficient is a ball that contains 0, the result has no bound.

E(τ) solves g equations for the sums Σ∫x^k dx/y over the points of E by the interval Newton method (Moore 1966). Each
integral is a power series in one variable. Cauchy's estimate on a disc where f does not vanish bounds its remainder.
Lifts and integrals of the second and third kind are single-valued on C^g, where all paths from 0 to cτ are equivalent.
So they may be continued along the paths of the points.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from integrable.moving_point.balls import BallField, around
from integrable.mumford.fields import multiplier
from integrable.mumford.motion import Placed
from integrable.mumford.series import through
from integrable.mumford.translations import GroupTranslations, Pair, reference
from jacobian import poly
from jacobian.element import Numbers, Real
from jacobian.errors import PrecisionLoss
from jacobian.linear import pivoted
from jacobian.numbers.long_reals import BallReals
from jacobian.relatives.extended import Extended

# h is about 2^−PART of the time in which a point reaches the boundary of its disc; T(2^k h) is in general position from
# about k = FRACTION on
PART, FRACTION = 4, 12
# largest number of halvings of the disc around a point, and of Newton steps
MOST_HALVES, MOST_STEPS = 256, 60
# largest imaginary part that rounding may leave of a real root, relative to the largest root of f
REAL = 1e-9


class _Elementary:
    """exp and log of balls."""

    @staticmethod
    def exp(x: Any) -> Any:
        """e^x."""
        return x.exp()

    @staticmethod
    def log(x: Any) -> Any:
        """log x."""
        return x.log()


class Balls(BallField):
    """The field of balls of ``bits`` bits, real or complex, in place of long numbers; enter it with ``with``."""

    context = _Elementary()

    def __init__(self, bits: int, complex: bool = False) -> None:
        from flint import acb

        self.bits, self.complex = bits, complex
        super().__init__(BallReals(bits))
        self._acb: Any = acb
        self.zero, self.one = self.coerce(0), self.coerce(1)
        # a ball counts as 0 only if it is proven to be 0
        self.eps = abs(self.zero)

    def __enter__(self) -> Balls:
        self._reals.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self._reals.__exit__(*error)

    def coerce(self, value: Any, argument: str = "value") -> Any:
        """The ball of radius 0 around a number; a ball is returned unchanged."""
        if not self.complex:
            return super().coerce(value)
        if isinstance(value, self._acb):
            return value
        return self._acb(self._reals.number(value.real), self._reals.number(value.imag))

    def nearest(self, x: Any) -> int:
        """The integer nearest to the real part of the midpoint of x."""
        return self._reals.nearest(x.real)

    def balls(self, values: Sequence[Any]) -> list[Any]:
        """Returns ``values`` unchanged: they are balls already."""
        return list(values)

    def from_ball(self, x: Any) -> Any:
        """Returns the ball ``x`` unchanged."""
        return x


class PointIntegrals:
    """The integrals ∫x^k dx/y, k = 0 … g, and ∫dx/(y(x − e)), e in ``others``, from a point of y² = f(x) to nearby
    points.
    """

    def __init__(self, K: Balls, f: poly.Poly, point: tuple[Any, Any], others: Sequence[Any], order: int) -> None:
        from flint import ctx

        self._field, self._point = K, point
        (x, y), genus = point, (len(f) - 2) // 2
        if not abs(y) > 0:
            raise PrecisionLoss("a point of reference is not seen to be apart from the branch points: use more digits")
        self._f = poly.shift(K, poly.scale(K, 1 / poly.evaluate(K, f, x), f), x)
        self.radius = self._disc([x - e for e in others])
        kind, polynomial = flint_kinds(K.complex)
        cap, ctx.cap = ctx.cap, order
        try:
            rate = kind(list(self._f)).rsqrt() / y
            rows = [rate]
            for _ in range(genus):
                rows.append(rows[-1] * kind([x, K.one]))
            rows += [rate / kind([x - e, K.one]) for e in others]
            self._rows = [polynomial([K.zero, *(c / (m + 1) for m, c in enumerate(row.coeffs()))]) for row in rows]
        finally:
            ctx.cap = cap
        # on the disc |f| is at least half of |f(x)|, and the distance to each e at least half of |x − e|
        most = (2**0.5 / abs(y)).abs_upper()
        sizes = [(abs(x) + self.radius) ** k for k in range(genus + 1)] + [2 / abs(x - e) for e in others]
        self._bounds = [(most * size * self.radius).abs_upper() for size in sizes]
        self._order = order

    def _disc(self, apart: Sequence[Any]) -> Any:
        """A radius within which f changes by less than half its value, at most half the distance to any other point."""
        arb = type(abs(self._field.one))
        radius = arb(2) ** 64
        while not (
            sum((abs(c) * radius**k for k, c in enumerate(self._f[1:], 1)), arb(0)) < 0.5
            and all(radius < abs(e) / 2 for e in apart)
        ):
            radius = radius / 2
            if not radius > 2.0**-MOST_HALVES:
                raise PrecisionLoss("a point of reference has no disc around it: use more digits")
        return radius

    def at(self, move: Any) -> list[Any]:
        """The integrals from x to x + ``move``, |move| < ``radius``."""
        part = (abs(move) / self.radius).abs_upper()
        rest = part ** (self._order + 1) / (1 - part)
        if not rest >= 0:
            raise PrecisionLoss("a time is not known well enough to enclose the motion there: use more digits")
        return [ball_around(row(move), rest * bound) for row, bound in zip(self._rows, self._bounds, strict=True)]

    def reached(self, move: Any) -> tuple[Any, Any]:
        """The point of the curve at x + ``move``, |move| < ``radius``; there √(f/f(x)) is the principal root."""
        if not abs(move) < self.radius:
            raise PrecisionLoss("a time is not known well enough to enclose the motion there: use more digits")
        x, y = self._point
        return x + move, y * self._field.sqrt(poly.evaluate(self._field, self._f, move))


class EnclosedReference:
    """The divisor E(τ) in balls: its points solve Σ∫x^k dx/y = c_kτ, with the points of E as the lower ends.

    The interval Newton method encloses them.
    """

    def __init__(self, field: Balls, points: Sequence[PointIntegrals], pair: Any, direction: Sequence[Any]) -> None:
        self._field, self._points, self._direction = field, points, direction
        u, _ = pair
        n, slope = multiplier(field, u, direction), poly.derivative(field, u)
        starts = [point.reached(field.zero) for point in points]
        self._rates = [-poly.evaluate(field, n, x) * y / poly.evaluate(field, slope, x) for x, y in starts]
        self.reach = min(float((p.radius / abs(rate)).lower()) for p, rate in zip(points, self._rates, strict=True))
        """The approximate time in which a point reaches the boundary of its disc."""

    def at(self, time: Numbers) -> tuple[poly.Poly, poly.Poly, Any, list[Any]]:
        """(U, V, Ω, the third-kind integrals) of E(τ)."""
        K, g = self._field, len(self._points)
        moves = self._moves(time)
        pair = through(K, *map(list, zip(*map(PointIntegrals.reached, self._points, moves), strict=True)))
        sums = [sum(row, K.zero) for row in zip(*map(PointIntegrals.at, self._points, moves), strict=True)]
        return *pair, sums[g], sums[g + 1 :]

    def _moves(self, time: Any) -> list[Any]:
        middle = [(rate * time).mid() for rate in self._rates]
        step = self._newton(time, middle, middle)
        # quadratic convergence to the last bits, or to the accuracy of the time
        for _ in range(MOST_STEPS):
            middle, before = [(x + y).mid() for x, y in zip(middle, step, strict=True)], step
            step = self._newton(time, middle, middle)
            width = [2 * abs(x).abs_upper() for x in step]
            found = self._newton(time, middle, [ball_around(x, w) for x, w in zip(middle, width, strict=True)])
            if all(abs(x) < w for x, w in zip(found, width, strict=True)) and not self._shrinks(step, before):
                return [x + y for x, y in zip(middle, found, strict=True)]
        raise PrecisionLoss("a translation could not be enclosed at this precision: use more digits")

    @staticmethod
    def _shrinks(step: Sequence[Any], before: Sequence[Any]) -> bool:
        return any(2 * abs(x).abs_upper() < abs(y).abs_upper() for x, y in zip(step, before, strict=True))

    def _newton(self, time: Any, middle: Sequence[Any], box: Sequence[Any]) -> list[Any]:
        """The Newton step −J(box)⁻¹F(middle), F_k = Σ_i∫x^k dx/y − c_kτ."""
        K, count = self._field, len(self._points)
        sums = zip(*(p.at(x) for p, x in zip(self._points, middle, strict=True)), strict=True)
        rest = [c * time - sum(row, K.zero) for c, row in zip(self._direction, sums, strict=False)]
        ends = [p.reached(x) for p, x in zip(self._points, box, strict=True)]
        found = pivoted([[*(x**k / y for x, y in ends), rest[k]] for k in range(count)])
        if found is None:
            raise PrecisionLoss("a translation could not be enclosed at this precision: use more digits")
        return found


def ball_around(x: Any, radius: Real) -> Any:
    """A real or complex ball that contains all numbers within an upper bound of ``radius`` of a number in x."""
    from flint import acb

    return acb(around(x.real, radius), around(x.imag, radius)) if isinstance(x, acb) else around(x, radius)


def flint_kinds(complex: bool) -> tuple[Any, Any]:
    """flint's classes of (power series, polynomials) over real or complex balls."""
    import flint

    return (flint.acb_series, flint.acb_poly) if complex else (flint.arb_series, flint.arb_poly)


class EnclosedTranslations(GroupTranslations):
    """The translations T(τ) of a motion, computed in balls."""

    _fraction = FRACTION

    def _reference(self) -> tuple[list[Any], list[Any]]:
        # points in different ovals, because balls widen more for points far from all branch points
        K, group = self.field, self.group
        xs: list[Any] = [] if K.complex else list(map(K.coerce, middles_of_ovals(group.f)))[: group.genus + 1]
        ys = [K.sqrt(poly.evaluate(K, group.f, x)) for x in xs]
        more, roots = reference(group)
        return [*xs, *more][: group.genus + 1], [*ys, *roots][: group.genus + 1]

    def _expanded(self, points: Any, pair: Pair, direction: Sequence[Any], others: Sequence[Any]) -> Any:
        K, order = self.field, self._order()
        near = [PointIntegrals(K, self.group.f, p, others, order) for p in zip(*points, strict=True)]
        found = EnclosedReference(K, near, pair, direction)
        self.unit = K.coerce(2.0 ** (math.frexp(found.reach)[1] - 1 - PART))
        return found

    def _order(self) -> int:
        return self.field.bits // (PART - 1) + 8

    def _on_curve(self, D: Extended) -> Extended:
        # divisors stay as they are: a better midpoint would not narrow a ball
        return D


def middles_of_ovals(f: poly.Poly) -> list[float]:
    """The midpoints of the bounded intervals where f > 0, between real roots computed in floats."""
    import numpy as np

    size = max(abs(c) for c in f)
    scaled = [float(c / size) for c in f[::-1]]
    found = np.roots(scaled)
    ends = np.sort(found[abs(found.imag) <= REAL * abs(found).max(initial=0)].real)
    return [float(x) for x in (ends[1:] + ends[:-1]) / 2 if np.polyval(scaled, x) > 0]


class EnclosedPlace(Placed):
    """A motion whose divisors are computed in balls."""

    _kind = EnclosedTranslations
