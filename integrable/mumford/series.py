"""Motions on y² = f(x) near one pair whose points are known, from power series in one variable for each point.

The sums Σ∫x^k dx/y over the points grow as c_kτ. Each integral is a series in balls; Cauchy's estimate on a disc where
f does not vanish bounds its remainder. The interval Newton method (Moore 1966) encloses the points at τ. Motions in
long numbers use the midpoints of the balls. Lifts and integrals of the second and third kind are single-valued
functions of cτ ∈ C^g, so their values at D(τ) may be computed along the paths of the points.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from integrable.moving_point.balls import Balls, around
from integrable.moving_point.legendre import doubling_precisions
from jacobian import poly
from jacobian.element import Arithmetic, Element, Real
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.linear import pivoted
from jacobian.poly import Poly

if TYPE_CHECKING:
    from typing import TypeAlias

    from flint import acb, arb

    Ball: TypeAlias = arb | acb

# on the disc |m| ≤ ``radius`` around a point (x, y) the term of order k of f(x + m)/f(x) is at most WITHIN^(−k)
WITHIN = 2.5
# Newton's method takes ROUGH_STEPS steps at ROUGH_BITS bits, and at most MOST_STEPS at full precision
ROUGH_BITS, ROUGH_STEPS, MOST_STEPS = 64, 4, 60
# bits of the balls beyond those of long numbers: the solution of the equations loses some
GUARD_BITS = 32


class PointIntegrals:
    """The integrals ∫x^k dx/y, k = 0 … g, and ∫dx/(y(x − e)), e in ``others``, from a point of y² = f(x) to nearby
    points.
    """

    def __init__(self, K: Balls, f: Poly, point: tuple[Ball, Ball], others: Sequence[Ball], order: int) -> None:
        from flint import acb_poly, arb_poly

        self._one, self._point = K.one, point
        (x, y), genus = point, (len(f) - 2) // 2
        if not abs(y) > 0:
            raise PrecisionLoss("a point of reference is not seen to be apart from the branch points: use more digits")
        f = poly.shift(K, poly.scale(K, 1 / poly.evaluate(K, f, x), f), x)
        self.radius = self._disc(f, [x - e for e in others])
        rates = [_inverse_root(f, 1 / y, order)]
        for _ in range(genus):
            rates.append([x * b + a for a, b in zip((K.zero, *rates[-1]), rates[-1], strict=False)])
        rates += [_over(x - e, rates[0]) for e in others]
        polynomial = acb_poly if K.complex else arb_poly
        self._f = polynomial(list(f))
        self._rows = [polynomial([K.zero, *(c / (m + 1) for m, c in enumerate(row))]) for row in rates]
        # on the disc |f| is at least a third of |f(x)|, and the distance to each e at least half of |x − e|
        most = (abs(3 * K.one).sqrt() / abs(y)).abs_upper()
        sizes = [(abs(x) + self.radius) ** k for k in range(genus + 1)] + [2 / abs(x - e) for e in others]
        self._bounds = [(most * size * self.radius).abs_upper() for size in sizes]
        self._order = order

    def _disc(self, f: Poly, apart: Sequence[Ball]) -> arb:
        """A radius of a disc on which |f/f(x) − 1| ≤ Σ WITHIN^(−k) = 2/3, at most half of each |x − e| in ``apart``."""
        sizes = [abs(c).abs_upper() for c in f[1:]]
        reaches = [x ** (-self._one.real / k) / WITHIN for k, x in enumerate(sizes, 1) if x > 0]
        radius = min((x.abs_lower() for x in (*reaches, *(abs(e) / 2 for e in apart))), key=float)
        if not radius > 0:
            raise PrecisionLoss("a point of reference has no disc around it: use more digits")
        return radius

    def at(self, move: Ball, which: slice) -> list[Ball]:
        """Selected integrals from x to x + ``move``, |move| < ``radius``."""
        part = (abs(move) / self.radius).abs_upper()
        rest = part ** (self._order + 1) / (1 - part)
        if not rest >= 0:
            raise PrecisionLoss("a time is not known well enough to enclose the motion there: use more digits")
        return [
            around(row(move), rest * bound) for row, bound in zip(self._rows[which], self._bounds[which], strict=True)
        ]

    def reached(self, move: Ball) -> tuple[Ball, Ball]:
        """The point of the curve at x + ``move``, |move| < ``radius``; there √(f/f(x)) is the principal root."""
        if not abs(move) < self.radius:
            raise PrecisionLoss("a time is not known well enough to enclose the motion there: use more digits")
        x, y = self._point
        return x + move, y * self._f(move).sqrt()


def _inverse_root(f: Poly, first: Ball, order: int) -> list[Ball]:
    """The series of w = ``first``·f^(−1/2) for f(0) = 1, by 2fw' = −f'w."""
    row = [first]
    for n in range(1, order):
        total = sum(c * ((2 * n - j) * row[n - j]) for j, c in enumerate(f[1 : n + 1], 1))
        row.append(-total / (2 * n))
    return row


def _over(start: Ball, row: Sequence[Ball]) -> list[Ball]:
    """The quotient of the series ``row`` in m by start + m."""
    found: list[Ball] = []
    for c in row:
        found.append((c - found[-1]) / start if found else c / start)
    return found


class PointMotion:
    """D(τ) along a direction from the pair with ``points`` (xs, ys), with the integrals of the third
    kind ∫dx/(y(x − e)) for each e in ``others``.

    ``field`` is a field of long numbers, or of balls, which then contain D(τ). Series have ``order`` terms.
    """

    def __init__(
        self,
        field: LongField | Balls,
        f: Poly,
        points: tuple[Sequence[Real], Sequence[Real]],
        direction: Sequence[Real],
        others: Sequence[Real],
        order: int,
    ) -> None:
        self._field = field
        self._balls = field if isinstance(field, Balls) else Balls(field.bits + GUARD_BITS, field.complex)
        with self._balls as K:
            curve, poles, self._direction = (field.balls(row) for row in (f, others, direction))
            pairs = zip(*map(field.balls, points), strict=True)
            self._points = [PointIntegrals(K, tuple(curve), pair, poles, order) for pair in pairs]
            self._rates = self._solved(self._direction, [K.zero] * len(self._points))
            reaches = (p.radius / abs(rate) for p, rate in zip(self._points, self._rates, strict=True))
            self.reach = min(float(x.lower()) for x in reaches)
            """The approximate time at which the first point reaches the boundary of its disc."""

    def at(self, time: Real) -> tuple[Poly, Poly, Real, list[Real]]:
        """(U, V, Ω, integrals of the third kind) of the divisor D(τ), τ = ``time``; Ω = Σ∫x^g dx/y over its points."""
        back = self._field.from_ball
        with self._balls as K:
            moves = self._moves(*self._field.balls([time]))
            u, v = through(K, *map(list, zip(*map(PointIntegrals.reached, self._points, moves), strict=True)))
            omega, *thirds = map(back, self._sums(moves, slice(len(self._points), None)))
            return tuple(map(back, u)), tuple(map(back, v)), omega, thirds

    def _moves(self, time: Ball) -> list[Ball]:
        """The distances x − x(0) of the points of D(τ) from those of D(0)."""
        K = self._balls
        middle = [(rate * time).mid() for rate in self._rates]
        # Newton's steps double the number of correct bits, and the first guess has about PART = 6 of them
        # (:mod:`integrable.mumford.translations`)
        for bits in (*[ROUGH_BITS] * ROUGH_STEPS, *doubling_precisions(K.bits, ROUGH_BITS)[:-1]):
            with K.reals.at(bits):
                step = self._solved(self._missing(time, middle), middle)
            middle = [(x + y).mid() for x, y in zip(middle, step, strict=True)]
        for _ in range(MOST_STEPS):
            missing = self._missing(time, middle)
            step = self._solved(missing, middle)
            width = [2 * abs(x).abs_upper() for x in step]
            found = self._solved(missing, [around(x, w) for x, w in zip(middle, width, strict=True)])
            # the iteration ends when ``found``, the Newton step over the box, is at most twice as wide as that at its
            # midpoint, whose width comes from rounding and from the radius of the time
            if all(abs(x) <= w and x.rad() <= 2 * y.rad() for x, y, w in zip(found, step, width, strict=True)):
                return [x + y for x, y in zip(middle, found, strict=True)]
            middle = [(x + y).mid() for x, y in zip(middle, step, strict=True)]
        raise PrecisionLoss("a translation was not found at this precision: use more digits")

    def _missing(self, time: Ball, moves: Sequence[Ball]) -> list[Ball]:
        """The residuals c_kτ − Σ_i∫x^k dx/y at τ = ``time``, with ``moves`` as in :meth:`_moves`."""
        sums = self._sums(moves, slice(len(self._points)))
        return [c * time - total for c, total in zip(self._direction, sums, strict=True)]

    def _sums(self, moves: Sequence[Ball], which: slice) -> list[Ball]:
        integrals = (p.at(x, which) for p, x in zip(self._points, moves, strict=True))
        return [sum(row, self._balls.zero) for row in zip(*integrals, strict=True)]

    def _solved(self, missing: Sequence[Ball], box: Sequence[Ball]) -> list[Ball]:
        """The Newton step J(box)⁻¹·``missing``, J_ki = x_i^k/y_i."""
        ends = [p.reached(x) for p, x in zip(self._points, box, strict=True)]
        found = pivoted([[*(x**k / y for x, y in ends), rest] for k, rest in enumerate(missing)])
        if found is None:
            raise PrecisionLoss("a translation was not found at this precision: use more digits")
        return found


def through(K: Arithmetic[Element], xs: Sequence[Element], ys: Sequence[Element]) -> tuple[Poly, Poly]:
    """The pair (U, V) of points with different x, by Lagrange interpolation; V keeps leading zeros."""
    total = [K.zero] * len(xs)
    for j, (x, y) in enumerate(zip(xs, ys, strict=True)):
        others = poly.from_roots(K, [*xs[:j], *xs[j + 1 :]])
        scale = K.div(y, poly.evaluate(K, others, x))
        total = [K.add(a, K.mul(scale, b)) for a, b in zip(total, others, strict=True)]
    return poly.from_roots(K, xs), tuple(total)
