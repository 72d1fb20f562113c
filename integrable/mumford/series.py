"""Power series of a motion on y² = f(x) from one pair.

The equations are polynomial (:mod:`integrable.mumford.fields`), so the recurrences of
:mod:`integrable.series.recurrences` give the coefficients in turn. If the points of the pair are known, series in one
variable suffice. The sums Σ∫x^k dx/y over the points grow as c_kτ. Since 1/y satisfies a linear equation of first
order, a recurrence gives the coefficients of each integral. Newton's method then finds the points at τ.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from integrable.mumford.fields import Poly, multiplier, rates_and_quotients
from integrable.series.recurrences import coefficients
from integrable.series.tape import recorded
from jacobian import poly
from jacobian.errors import PrecisionLoss
from jacobian.fields.inexact import InexactField
from jacobian.inexact.long_field import LongField
from jacobian.linear import pivoted

# number of last coefficients from which the radius of a series is estimated
LAST = 4
# largest number of Newton steps; convergence is quadratic
MOST_STEPS = 60
# Newton's method ends when the square of a step, relative to the radius of a series, is below this many units of the
# last bit
SMALL = 2.0**-8


class _Operators(InexactField):
    """The field over which a formula is recorded; its constants are those of ``field``."""

    name = "recorded numbers"

    def __init__(self, field: LongField) -> None:
        self.zero, self.one = field.zero, field.one

    def coerce(self, value: Any, argument: str = "value") -> Any:
        """The number unchanged."""
        return value

    def dot(self, xs: Sequence[Any], ys: Sequence[Any]) -> Any:
        """Σ x_i y_i."""
        return sum((x * y for x, y in zip(xs, ys, strict=True)), self.zero)


class MotionSeries:
    """The power series of motions along a direction, with lifts at the branch points ``ends``."""

    def __init__(self, field: LongField, f: Poly, direction: Sequence[Any], ends: Sequence[Any]) -> None:
        K, g = _Operators(field), len(direction)

        def formula(y: Sequence[Any]) -> list[Any]:
            u, v = (*y[:g], K.one), tuple(y[g : 2 * g])
            turning = multiplier(K, u, direction)
            (of_u, of_v), quotients = rates_and_quotients(K, f, u, v, turning)
            return [*of_u[:-1], *of_v, *lift_rates(K, (turning, *quotients), ends, y[2 * g :])]

        self._zero, self._tape = field.zero, recorded(formula, 2 * (g + len(ends)))

    def rows(self, start: Sequence[Any], order: int) -> list[list[Any]]:
        """The first ``order`` Taylor coefficients of U, V and the σ and ν of each lift, from their start values."""
        tape = self._tape
        series = [self._zero] * (order * len(tape.kinds))
        series[::order] = [*start, *tape.constants[len(start) :]]
        coefficients(tape.kinds, tape.left, tape.right, tape.results, 0, order - 1, 1, series)
        return [series[i * order : (i + 1) * order] for i in range(len(start))]


def radius_of(rows: Sequence[Sequence[Any]]) -> float:
    """An estimate of the radius of convergence of power series, the smallest over all rows.

    It is (|earlier coefficients|/|last ones|)^(1/number of terms between), which does not depend on the unit of time.
    """
    found, order = [], len(rows[0])
    between = order // 2 - LAST
    for row in rows:
        last, earlier = (max(abs(c) for c in row[end - LAST : end]) for end in (order, order - between))
        if last and earlier:
            # the ratio may exceed the range of floats, but its root does not
            found.append(float((earlier / last) ** (1 / between)))
    return min(found, default=1.0)


def lift_rates(K: Any, factors: tuple[Poly, Poly, Poly], ends: Sequence[Any], roots: Sequence[Any]) -> list[Any]:
    """The rates of each lift: σ' = ½(nν − mσ), ν' = ½(mν + wσ) at its branch point; ``factors`` are n, m, w.

    They follow from κσ² = U(e), κσν = V(e), κν² = −W(e) and U' = nV − mU, V' = −½(nW − wU).
    """
    found = []
    for e, sigma, nu in zip(ends, roots[::2], roots[1::2], strict=True):
        n, m, w = (poly.evaluate(K, b, e) for b in factors)
        found += [(n * nu - m * sigma) / 2, (m * nu + w * sigma) / 2]
    return found


class PointSeries:
    """Power series of ∫x^k dx/y, k = 0 … g, and ∫dx/(y(x − e)), e in ``others``, from a point of y² = f(x).

    They have ``order`` terms over an inexact field. ``count`` is the number of integrals, ``radius`` an estimate of the
    radius of convergence.
    """

    def __init__(self, K: LongField, f: Poly, point: tuple[Any, Any], others: Sequence[Any], order: int) -> None:
        self._field, self._point = K, point
        x, y = point
        self._f = poly.shift(K, f, x)
        rates = [_inverse_root(self._f, 1 / y, order)]
        for _ in range((len(f) - 2) // 2):
            last = rates[-1]
            rates.append([x * b + a for a, b in zip((K.zero, *last), last, strict=False)])
        rates += [_over(x - e, rates[0]) for e in others]
        self.radius = radius_of([rates[0]])
        self._rows = [[c / (m + 1) for m, c in enumerate(row)][::-1] for row in rates]
        self.count = len(rates)

    def integral(self, k: int, move: Any) -> Any:
        """The k-th integral from x to x + ``move``."""
        total = self._field.zero
        for c in self._rows[k]:
            total = (total + c) * move
        return total

    def reached(self, move: Any) -> tuple[Any, Any]:
        """The point of the curve at x + ``move``."""
        x, y = self._point
        return x + move, y * self._field.sqrt(poly.evaluate(self._field, self._f, move) / self._f[0])


def _inverse_root(f: Poly, first: Any, order: int) -> list[Any]:
    """The series of w = f^(−1/2) with the constant term ``first``, from 2fw' = −f'w."""
    row = [first]
    for n in range(1, order):
        total = sum(c * ((2 * n - j) * row[n - j]) for j, c in enumerate(f[1 : n + 1], 1))
        row.append(-total / (2 * n * f[0]))
    return row


def _over(start: Any, row: Sequence[Any]) -> list[Any]:
    """The series of ``row`` divided by start + m, where m is the variable."""
    found: list[Any] = []
    for c in row:
        found.append((c - found[-1]) / start if found else c / start)
    return found


class PointMotion:
    """D(τ) along a direction from the pair with ``points`` (xs, ys), with the third-kind integrals for ``others``.

    ``reach`` is the approximate τ at which a point reaches the radius of its series.
    """

    def __init__(
        self, K: LongField, f: Poly, points: Any, direction: Sequence[Any], others: Sequence[Any], order: int
    ) -> None:
        self._field, self._direction = K, direction
        self._points = [PointSeries(K, f, point, others, order) for point in zip(*points, strict=True)]
        self._rates = self._newton(K.one, [K.zero] * len(self._points))
        reaches = (p.radius / abs(rate) for p, rate in zip(self._points, self._rates, strict=True))
        self.reach = min(map(float, reaches))

    def at(self, time: Any) -> tuple[Poly, Poly, Any, list[Any]]:
        """(U, V, Ω, the third-kind integrals) at a time well within ``reach``."""
        K, g = self._field, len(self._points)
        moves = [rate * time for rate in self._rates]
        for _ in range(MOST_STEPS):
            step = self._newton(time, moves)
            moves = [x + y for x, y in zip(moves, step, strict=True)]
            part = max(abs(x) / p.radius for x, p in zip(step, self._points, strict=True))
            if part * part <= SMALL * K.eps:
                ends = [p.reached(x) for p, x in zip(self._points, moves, strict=True)]
                rest = [
                    sum((p.integral(k, x) for p, x in zip(self._points, moves, strict=True)), K.zero)
                    for k in range(g, self._points[0].count)
                ]
                return *through(K, *map(list, zip(*ends, strict=True))), rest[0], rest[1:]
        raise PrecisionLoss("a translation was not found at this precision: use more digits")

    def _newton(self, time: Any, moves: Sequence[Any]) -> list[Any]:
        """The Newton step J⁻¹(cτ − F), F_k = Σ_i∫x^k dx/y."""
        ends = [p.reached(x) for p, x in zip(self._points, moves, strict=True)]
        powers = [1 / y for _, y in ends]
        rows = []
        for k, c in enumerate(self._direction):
            rest = c * time
            for p, move in zip(self._points, moves, strict=True):
                rest -= p.integral(k, move)
            rows.append([*powers, rest])
            powers = [power * x for power, (x, _) in zip(powers, ends, strict=True)]
        found = pivoted(rows)
        if found is None:
            raise PrecisionLoss("a translation was not found at this precision: use more digits")
        return found


def through(K: Any, xs: Sequence[Any], ys: Sequence[Any]) -> tuple[Poly, Poly]:
    """(U, V) of points with different x, by Lagrange interpolation; V has all its coefficients."""
    total = [K.zero] * len(xs)
    for j, (x, y) in enumerate(zip(xs, ys, strict=True)):
        others = poly.from_roots(K, [*xs[:j], *xs[j + 1 :]])
        scale = K.div(y, poly.evaluate(K, others, x))
        total = [K.add(a, K.mul(scale, b)) for a, b in zip(total, others, strict=True)]
    return poly.from_roots(K, xs), tuple(total)
