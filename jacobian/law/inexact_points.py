"""From points to Mumford pairs over RR, CC and MP.

The interpolation uses more digits than the field and rounds once, so its result does not depend on the order of the
points.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from jacobian.curve.curve import HyperellipticCurve
from jacobian.curve.points import AffinePoint
from jacobian.errors import PrecisionLoss, shown
from jacobian.inexact.dense import added, product, remainder, residue, value_at
from jacobian.inexact.digits import Digits

# rounding the coefficients of v may change v(x) = y at a point by at most this part of y
KNOWN = 2**-7
# (x, y) is taken for a rounded point of y² = f(x) if |f(x) − y²| ≤ NEAR·ε·y²
NEAR = 2**20


def in_order(points: Sequence[AffinePoint]) -> list[AffinePoint]:
    """The points in an order that depends only on their values."""
    return sorted(points, key=lambda point: (point.x.real, point.x.imag, point.y.real, point.y.imag))


def opposite(C: HyperellipticCurve, P: AffinePoint, Q: AffinePoint) -> bool:
    """Whether P and Q have the same x and are nearer to being opposite, y_P + y_Q + h(x) = 0, than to being equal. A
    branch point is its own opposite.
    """
    return bool(P.x == Q.x and abs(P.y + Q.y + value_at(C.h, P.x)) <= abs(P.y - Q.y))


def pair_of_points(C: HyperellipticCurve, points: Sequence[AffinePoint]) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """The Mumford pair (u, v) through the points. No two of them are opposite, so equal x mean a repeated point.

    PrecisionLoss is raised if the rounded coefficients of v do not reproduce y at some point, because the x differ too
    much in size.
    """
    field: Any = C.field
    points = in_order(points)
    bits = 1 - field.exponent(field.eps)
    sizes = [field.exponent(P.x) for P in points if P.x] or [0]
    spread = 2 * len(C.f) * (max(sizes) - min(sizes))
    with Digits(field, bits * (4 + 2 * len(points)) + spread) as digits:
        f, half = [digits.number(c) for c in C.f], [digits.number(c) / 2 for c in C.h]
        f = added(f, product(half, half))
        u, v = _through(digits, f, half, points)
        return (*map(digits.element, u[:-1]), field.one), _rounded(digits, points, f, v)


def _through(digits: Any, f: list[Any], half: list[Any], points: Sequence[AffinePoint]) -> tuple[Any, Any]:
    """(u, v) by Newton's interpolation on y² = f, where y stands for the given y + h/2. Each point adds k·u to v: a new
    point (x₀, y₀) with k = (y₀ − v(x₀))/u(x₀), a repeated one with k = w(x₀)/(2y₀), w = (f − v²)/u.
    """
    one = digits.number(digits.field.one)
    u: list[Any] = [one]
    v: list[Any] = []
    found: dict[Any, Any] = {}
    for point in points:
        key = digits.field.key(point.x)
        if key in found:
            x, y = found[key]
            k = value_at(residue(f, u, v)[0], x) / (2 * y)
        else:
            x = digits.number(point.x)
            y = _on_curve(digits, digits.number(point.y) + value_at(half, x), value_at(f, x))
            found[key] = x, y
            k = (y - value_at(v, x)) / value_at(u, x)
        v = added(v, [k * c for c in u])
        u = product(u, [-x, one])
    return u, remainder(added(v, [-c for c in half]), u)


def _on_curve(digits: Any, y: Any, square: Any) -> Any:
    """The square root of ``square`` near y, by Newton's method; y itself if y² and ``square`` differ by more than
    rounding, as they may near a branch point.
    """
    if abs(square - y * y) > NEAR * digits.own_eps * abs(y * y):
        return y
    for _ in range(digits.bits.bit_length()):
        y = (y + square / y) / 2 if y != 0 else y
    return y


def _rounded(digits: Any, points: Sequence[AffinePoint], f: list[Any], v: list[Any]) -> tuple[Any, ...]:
    """v rounded to the field; PrecisionLoss unless it still reproduces y at the points."""
    result = tuple(map(digits.element, v))
    kept = [digits.number(c) for c in result]
    for point in points:
        x = digits.number(point.x)
        height = max(abs(c) * abs(x) ** i for i, c in enumerate(f)) ** 0.5
        size = max(abs(value_at(v, x)), digits.own_eps**0.5 * height)
        if abs(value_at(kept, x) - value_at(v, x)) > KNOWN * size:
            raise PrecisionLoss(
                f"point = {shown(point)}: the coefficients of v, rounded to {digits.field.name}, lose its y beside "
                "points of other sizes; use more digits"
            )
    return result
