"""From points to divisors: Mumford pairs built up point by point."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from operator import index
from typing import TYPE_CHECKING, Any

from jacobian import cantor, poly
from jacobian.curve import HyperellipticCurve
from jacobian.divisor import Divisor
from jacobian.errors import ArgumentError, NotRepresentable, shown
from jacobian.points import AffinePoint, Point

if TYPE_CHECKING:
    from jacobian.group import Jacobian

Descent = Callable[[poly.Poly], poly.Poly]
# one by one: a hundred take a fifth of a second, and the time grows with the cube
MOST_REPEATED = 100


def repeated(points: Iterable[Any], multiplicities: Iterable[Any] | None) -> list[Any]:
    """Each point as often as its multiplicity, an int ≥ 0, says."""
    if not isinstance(points, Iterable):
        raise ArgumentError(f"points = {points!r}: a sequence of pairs (x, y) and points at infinity is needed")
    points = list(points)
    if multiplicities is None:
        return points
    if not isinstance(multiplicities, Iterable):
        raise ArgumentError(f"multiplicities = {multiplicities!r}: a sequence of ints is needed, one for each point")
    numbers = list(multiplicities)
    if len(numbers) != len(points):
        raise ArgumentError(f"multiplicities = {numbers}: {len(points)} of them are needed, one for each point")
    result = []
    for point, number in zip(points, numbers, strict=True):
        if isinstance(number, bool) or not hasattr(number, "__index__") or number < 0:
            raise ArgumentError(f"multiplicities: {number!r} is not an int ≥ 0; for −P give the opposite point")
        if number > MOST_REPEATED:
            raise ArgumentError(
                f"multiplicities: {shown(number)} points are added one by one, {MOST_REPEATED} at most; take multiples "
                "in the group, such as m * J.from_points([P, P])"
            )
        result += [point] * index(number)
    return result


def divisor_of_points(
    J: Jacobian, points: list[Point], above: HyperellipticCurve | None = None, back: Descent | None = None
) -> Divisor:
    """The class of Σ P_i minus infinity, as :meth:`jacobian.group.Jacobian.from_points` says.

    ``above``: the curve over an extension field, where the points are; ``back`` takes polynomials over it to the field
    of J.
    """
    C = J.curve
    if C.model == "inert" and len(points) % 2:
        raise NotRepresentable(
            f"points: {len(points)} of them; an inert model needs an even number, its infinity being one place"
        )
    affine = [point for point in points if isinstance(point, AffinePoint)]
    semireduced, cancelled = _cancel_opposites(above or C, affine)
    n = None
    if C.model == "split":
        # the class of ΣP − r·∞₋ has n = ⌈g/2⌉ + (points at ∞₊) + (pairs cancelled); then r·∞₋ is shared evenly
        at_plus = sum(1 for point in points if not isinstance(point, AffinePoint) and point.sign == 1)
        n = at_plus + cancelled + (C.genus - len(points) + 1) // 2
    if C.field.exact:
        u, v = pair_of_points(above or C, semireduced)
        if back is not None:
            u, v = back(u), back(v)
        return J._out(cantor.reduce(J._model, J._in_triple(u, v, n)))
    return _inexact_sum(J, semireduced, n)


def _inexact_sum(J: Jacobian, points: list[AffinePoint], n: int | None) -> Divisor:
    """Parts of at most g points, added by the inexact kernel; on a split model one part, with its weight in range."""
    from jacobian.inexact_points import in_order

    g = J.curve.genus
    if n is not None and not 0 <= n <= g - len(points):
        raise NotRepresentable(
            f"points: {len(points)} with the weight {n} at ∞₊, not in 0 … {g - len(points)}; "
            f"over {J.field.name} add smaller sums"
        )
    points = in_order(points)
    parts = [points[start : start + g] for start in range(0, len(points), g)] or [[]]
    total, *rest = [Divisor(J, *pair_of_points(J.curve, part), n) for part in parts]
    for part in rest:
        total = total + part
    return total


def _cancel_opposites(C: HyperellipticCurve, points: list[AffinePoint]) -> tuple[list[AffinePoint], int]:
    """The points without pairs P, ιP, and the number of pairs taken out (a branch point is its own opposite)."""
    if not C.field.exact:
        return _cancel_inexact(C, points)
    K = C.field
    kept: list[AffinePoint] = []
    cancelled = 0
    for point in points:
        opposite = AffinePoint(point.x, K.neg(K.add(point.y, poly.evaluate(K, C.h, point.x))))
        if opposite in kept:
            kept.remove(opposite)
            cancelled += 1
        else:
            kept.append(point)
    return kept, cancelled


def _cancel_inexact(C: HyperellipticCurve, points: list[AffinePoint]) -> tuple[list[AffinePoint], int]:
    """The same, where y is known to rounding only."""
    from jacobian.inexact_points import opposite

    kept: list[AffinePoint] = []
    for point in points:
        other = next((earlier for earlier in kept if opposite(C, point, earlier)), None)
        if other is None:
            kept.append(point)
        else:
            kept.remove(other)
    return kept, (len(points) - len(kept)) // 2


def pair_of_points(C: HyperellipticCurve, points: list[AffinePoint]) -> tuple[poly.Poly, poly.Poly]:
    """(u, v) through the points, repeated ones with their multiplicity; no point beside its opposite.

    Over an inexact field :mod:`jacobian.inexact_points`; else one point at a time (Newton's interpolation):
    v → v + u·k with k(x₀) = (y₀ − v(x₀))/u(x₀) for a new x₀, and k(x₀) = w(x₀)/(2v + h)(x₀), w = (f − hv − v²)/u,
    where u(x₀) = 0 already.
    """
    K = C.field
    if not K.exact:
        from jacobian import inexact_points

        return inexact_points.pair_of_points(C, points)
    u: poly.Poly = (K.one,)
    v: poly.Poly = ()
    for i, (x, y) in enumerate(points):
        if any(x == earlier.x for earlier in points[:i]):
            w = cantor.cofactor(C, u, v)
            slope = K.add(K.add(y, y), poly.evaluate(K, C.h, x))
            k = K.div(poly.evaluate(K, w, x), slope)
        else:
            k = K.div(K.sub(y, poly.evaluate(K, v, x)), poly.evaluate(K, u, x))
        v = poly.add(K, v, poly.trim(K, poly.scale(K, k, u)))
        u = poly.mul(K, u, (K.neg(x), K.one))
    return u, v
