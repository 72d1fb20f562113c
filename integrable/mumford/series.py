"""Power series, in one variable each, of a motion on y² = f(x) from one pair whose points are known.

The sums Σ∫x^k dx/y over the points grow as c_kτ. Since 1/y satisfies a linear equation of first
order, a recurrence gives the coefficients of each integral. Newton's method then finds the points at τ.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from jacobian import poly
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.linear import pivoted
from jacobian.poly import Poly

# number of last coefficients from which the radius of a series is estimated
LAST = 4
# largest number of Newton steps; convergence is quadratic
MOST_STEPS = 60
# Newton's method ends when the square of a step, relative to the radius of a series, is below this many units of the
# last bit
SMALL = 2.0**-8


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


class PointSeries:
    """Power series of ∫x^k dx/y, k = 0 … g, and ∫dx/(y(x − e)), e in ``others``, from a point of y² = f(x).

    Over an inexact field each series has ``order`` terms. ``count`` is the number of integrals, ``radius`` an estimate
    of the radius of convergence.
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
    """The pair (U, V) of points with different x, by Lagrange interpolation; V has all its coefficients."""
    total = [K.zero] * len(xs)
    for j, (x, y) in enumerate(zip(xs, ys, strict=True)):
        others = poly.from_roots(K, [*xs[:j], *xs[j + 1 :]])
        scale = K.div(y, poly.evaluate(K, others, x))
        total = [K.add(a, K.mul(scale, b)) for a, b in zip(total, others, strict=True)]
    return poly.from_roots(K, xs), tuple(total)
