"""Picard's iteration on the equations of motion of a pair, in python-flint's power series: an oracle for the series of
:mod:`integrable.mumford.series`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from integrable.mumford.fields import cofactor, multiplier, padded, rates
from jacobian import poly
from jacobian.fields.inexact import InexactField
from jacobian.inexact.long_field import LongField
from jacobian.numbers.long_reals import BallReals
from jacobian.poly import Poly

# bits beyond those of the field
GUARD = 64
# number of last coefficients from which the radius of a series is estimated
LAST = 4


def lift_rates(K: Any, factors: tuple[Poly, Poly, Poly], ends: Sequence[Any], roots: Sequence[Any]) -> list[Any]:
    """The rates of each lift: σ' = ½(nν − mσ), ν' = ½(mν + wσ) at its branch point; ``factors`` are n, m, w.

    They follow from κσ² = U(e), κσν = V(e), κν² = −W(e) and U' = nV − mU, V' = −½(nW − wU).
    """
    found = []
    for e, sigma, nu in zip(ends, roots[::2], roots[1::2], strict=True):
        n, m, w = (poly.evaluate(K, b, e) for b in factors)
        found += [(n * nu - m * sigma) / 2, (m * nu + w * sigma) / 2]
    return found


class SeriesField(InexactField):
    """Power series in time over balls, to flint's ``ctx.cap`` terms."""

    name = "power series over balls"

    def __init__(self, complex: bool) -> None:
        from flint import acb_series, arb_series

        self._type: Any = acb_series if complex else arb_series
        self.zero, self.one = self._type([0]), self._type([1])

    def coerce(self, value: Any, argument: str = "value") -> Any:
        """The constant series of a ball, the series of a list of them."""
        return self._type(value if isinstance(value, list) else [value])

    def dot(self, xs: Sequence[Any], ys: Sequence[Any]) -> Any:
        """Σ x_i y_i."""
        return sum((x * y for x, y in zip(xs, ys, strict=True)), self.zero)


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


class PicardSeries:
    """A motion near a pair: coefficients of U, V, of the second-kind datum Ω, of the third-kind integrals
    ∫n(x_e)/U(x_e)dτ of points x_e (0 at the pair) and of the σ and ν of lifts, ascending in time.

    ``radius``: roughly the radius of convergence, a float.
    """

    def __init__(self, field: LongField, rows: list[list[Any]], size: int) -> None:
        self.field = field
        self.rows = [[field.from_ball(c) for c in row] for row in rows]
        self.size = size
        self.order = len(rows[0])
        self.radius = radius_of(self.rows)

    def at(self, time: Any) -> tuple[Poly, Poly, Any, list[Any]]:
        """(U, V, Ω, the third-kind integrals) at a time well inside the radius."""
        values = []
        for row in self.rows:
            total = self.field.zero
            for c in reversed(row):
                total = total * time + c
            values.append(total)
        size = self.size
        return (
            (*values[:size], self.field.one),
            tuple(values[size : 2 * size]),
            values[2 * size],
            values[2 * size + 1 :],
        )


def taylor(
    field: LongField,
    f: Poly,
    pair: tuple[Poly, Poly],
    direction: Sequence[Any],
    order: int,
    points: Sequence[Any] = (),
    lifts: Sequence[tuple[Any, Any, Any]] = (),
) -> PicardSeries:
    """``order`` coefficients of the motion from a pair along a direction, with the third-kind integrals of points, and
    with ``lifts``, (e, σ, ν) at branch points e.
    """
    from flint import ctx

    u, v = pair
    size = len(v)
    with BallReals(field.bits + GUARD):
        roots = [x for _, *pair in lifts for x in pair]
        rows = [[c] for c in field.balls((*u[:-1], *v, field.zero, *[field.zero for _ in points], *roots))]
        curve, turning, places = field.balls(f), field.balls(direction), field.balls(points)
        ends = field.balls([e for e, _, _ in lifts])
        cap = ctx.cap
        try:
            for k in range(1, order):
                ctx.cap = k
                _extend(SeriesField(field.complex), rows, size, curve, turning, places, ends)
        finally:
            ctx.cap = cap
    return PicardSeries(field, rows, size)


def _extend(
    K: SeriesField,
    rows: list[list[Any]],
    size: int,
    f: list[Any],
    direction: list[Any],
    points: list[Any],
    ends: list[Any],
) -> None:
    """One more coefficient to every row."""
    k = len(rows[0])
    moving = tuple(map(K.coerce, rows[: 2 * size]))
    whole = (*moving[:size], K.one)
    n = tuple(map(K.coerce, direction))
    turning = multiplier(K, whole, n)
    curve, v = tuple(map(K.coerce, f)), moving[size:]
    of_u, of_v = rates(K, curve, whole, v, n)
    quotients = (poly.divide(K, poly.mul(K, turning, a), whole)[0] for a in (v, cofactor(K, curve, whole, v)))
    thirds = [poly.evaluate(K, turning, x) / poly.evaluate(K, whole, x) for x in map(K.coerce, points)]
    second = second_kind_rate(K, whole, n)
    roots = list(map(K.coerce, rows[len(rows) - 2 * len(ends) :]))
    of_roots = lift_rates(K, (turning, *quotients), list(map(K.coerce, ends)), roots)
    for row, rate in zip(rows, (*of_u[:-1], *of_v, second, *thirds, *of_roots), strict=True):
        row.append(rate[k - 1] / k)


def second_kind_rate(K: Any, u: Poly, direction: Sequence[Any]) -> Any:
    """Σ x_i^g x_i'/y_i = −[x^{g−1}](x^g·n mod U) along a direction: the rate of the second-kind datum."""
    size = len(u) - 1
    moved = poly.mod(K, (*[K.zero] * size, *multiplier(K, u, direction)), u)
    return K.neg(padded(K, moved, size)[-1])
