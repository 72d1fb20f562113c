"""From points to divisors: Mumford pairs built up point by point."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Any, NamedTuple

from jacobian import poly
from jacobian.addition import cantor
from jacobian.addition.ladder import MOST_BITS, bits_of
from jacobian.curve.curve import HyperellipticCurve
from jacobian.curve.points import AffinePoint, Given, Point
from jacobian.errors import ArgumentError, Infeasible, NotRepresentable, entries, shown, whole
from jacobian.fields.change import Embedding
from jacobian.law.divisor import Divisor, GroupLaw

# the largest multiplicity of a point, and the largest number of points of a sum, since points are added one by one
MOST_REPEATED, MOST_POINTS = 100, 100_000
# AT_ONCE·g points, or a few more, are interpolated as one Mumford pair; the group adds the classes of these pairs
AT_ONCE = 8


class Descent(NamedTuple):
    """The embedding of the field K of a curve into a finite extension, and the same curve over the extension."""

    curve: HyperellipticCurve
    inclusion: Embedding

    def orbit(self, point: AffinePoint) -> list[AffinePoint]:
        """A point over the extension and its conjugates over K."""
        orbit = [point]
        while (following := AffinePoint(*map(self.inclusion.frobenius, orbit[-1]))) != point:
            orbit.append(following)
        return orbit

    def orbits(self, points: list[AffinePoint]) -> list[list[AffinePoint]]:
        """Points, each of which occurs as often as its conjugates, grouped into sets of conjugates."""
        left, found = Counter(points), []
        for point in points:
            if left[point]:
                found.append(self.orbit(point))
                left.subtract(found[-1])
        return found


def repeated(points: Iterable[Given], multiplicities: Iterable[int] | None) -> list[Given]:
    """A list with each point repeated by its multiplicity, an int ≥ 0."""
    points, numbers = counted(points, multiplicities)
    if len(points) > MOST_POINTS:
        raise ArgumentError(
            f"points: {len(points)} of them are added one by one, {MOST_POINTS} at most; take multiples in the group, "
            "such as m * J.from_points([P, P])"
        )
    if numbers is None:
        return points
    result = []
    for i, (point, number) in enumerate(zip(points, numbers, strict=True)):
        wanted = "that is not an int ≥ 0; for −P give the opposite point"
        number = whole(number, f"multiplicities: multiplicities[{i}]", wanted, 0)
        if number > MOST_REPEATED:
            raise ArgumentError(
                f"multiplicities: {shown(number)} points are added one by one, {MOST_REPEATED} at most; take multiples "
                "in the group, such as m * J.from_points([P, P])"
            )
        result += [point] * number
    return result


def counted(points: Iterable[Any], multiplicities: Iterable[Any] | None) -> tuple[list[Any], list[Any] | None]:
    """The points and their multiplicities as two lists of equal length, whose entries are not checked."""
    points = entries(points, "points", "a sequence of pairs (x, y) and points at infinity")
    if multiplicities is None:
        return points, None
    numbers = entries(multiplicities, "multiplicities", "a sequence of ints, one for each point,")
    if len(numbers) != len(points):
        raise ArgumentError(f"multiplicities = {shown(numbers)}: {len(points)} of them are needed, one for each point")
    return points, numbers


def divisor_of_points(J: GroupLaw, points: list[Point], descent: Descent | None = None) -> Divisor:
    """The class of Σ P_i minus infinity, as :meth:`jacobian.group.Jacobian.from_points` says."""
    C = J.curve
    if C.model == "inert" and len(points) % 2:
        raise NotRepresentable(
            f"points: {len(points)} of them; an inert model needs an even number, its infinity being one place"
        )
    affine = [point for point in points if isinstance(point, AffinePoint)]
    semireduced, cancelled = _cancel_opposites(descent.curve if descent else C, affine)
    n = None
    if C.model == "split":
        # ΣP − r·∞₋ has n = ⌈g/2⌉ + (points at ∞₊) + (pairs cancelled); n is lower by r/2 if (r/2)(∞₊ + ∞₋) is
        # subtracted instead of r·∞₋
        at_plus = sum(1 for point in points if not isinstance(point, AffinePoint) and point.sign == 1)
        n = at_plus + cancelled + (C.genus - len(points) + 1) // 2
    return _exact_sum(J, semireduced, n, descent) if C.field.exact else _inexact_sum(J, semireduced, n)


def _exact_sum(J: GroupLaw, points: list[AffinePoint], n: int | None, descent: Descent | None) -> Divisor:
    """The class of Σ P_i minus infinity over an exact field. A few points at a time become a reduced class, and the
    group adds these classes, because the time for one pair grows like the cube of its number of points.

    On a split model a part of weight w at ∞₊ adds w − ⌈g/2⌉ to n. The weight of the last part is chosen so that the sum
    has the weight n.
    """
    C = J.curve
    often = {point: count // 2 for point, count in Counter(points).items() if count > AT_ONCE * C.genus}
    if often and descent is None:
        # 2k copies of a point P are added as k times the class of 2P. The weight n at ∞₊ falls by 1/2 for each point
        # (:func:`divisor_of_points`), so without these 2k points it is larger by k
        rest = list((Counter(points) - Counter({point: 2 * k for point, k in often.items()})).elements())
        total = _exact_sum(J, rest, None if n is None else n + sum(often.values()), None)
        for point, k in often.items():
            total = _added(J, total, _multiple_of_pair(J, point, k))
        return total
    *others, last = _parts(C, points, descent)
    total = J.zero()
    for part in others:
        weight = None if n is None else (C.genus - len(part) + 1) // 2
        if n is not None and weight is not None:
            n += (C.genus + 1) // 2 - weight
        total = _added(J, total, _reduced(J, part, weight, descent))
    final = _reduced(J, last, n, descent)
    return _added(J, total, final) if others else final


def _multiple_of_pair(J: GroupLaw, point: AffinePoint, k: int) -> Divisor:
    """k(2P − (∞₊ + ∞₋)), on a ramified model 2k(P − ∞)."""
    pair = divisor_of_points(J, [point, point])
    try:
        return J.multiply(k, pair)
    except Infeasible:
        raise _too_long(J) from None


def _added(J: GroupLaw, D: Divisor, E: Divisor) -> Divisor:
    if bits_of(J.curve.field, D.u, D.v) > MOST_BITS:
        raise _too_long(J)
    return D + E


def _too_long(J: GroupLaw) -> Infeasible:
    return Infeasible(
        f"points: partial sums have numbers of more than {MOST_BITS} bits over {J.curve.field.name}, to which no more "
        "is added; fewer points, or modulo primes (change_ring), where numbers stay short"
    )


def _parts(C: HyperellipticCurve, points: list[AffinePoint], descent: Descent | None) -> list[list[AffinePoint]]:
    """The points divided into parts of at least 8g points, an even number on an inert model; the last part may have
    fewer. Conjugate points are in one part.
    """
    if len(points) <= AT_ONCE * C.genus:
        return [points]
    parts: list[list[AffinePoint]] = [[]]
    for orbit in descent.orbits(points) if descent else ([point] for point in points):
        if len(parts[-1]) >= AT_ONCE * C.genus and (C.model != "inert" or len(parts[-1]) % 2 == 0):
            parts.append([])
        parts[-1] += orbit
    return parts


def _reduced(J: GroupLaw, points: list[AffinePoint], n: int | None, descent: Descent | None) -> Divisor:
    u, v = pair_of_points(descent.curve if descent else J.curve, points)
    if descent is not None:
        u, v = (tuple(map(descent.inclusion.back, a)) for a in (u, v))
    return J._reduced(u, v, n)


def _inexact_sum(J: GroupLaw, points: list[AffinePoint], n: int | None) -> Divisor:
    """The class of Σ P_i minus infinity over an inexact field, as a sum of parts of at most g points. On a split
    model all points must form one reduced class: their number r is at most g, and 0 ≤ n ≤ g − r.
    """
    from jacobian.law.inexact_points import in_order

    g = J.curve.genus
    if n is not None and not 0 <= n <= g - len(points):
        raise NotRepresentable(
            f"points: {len(points)} with the weight {shown(n)} at ∞₊, not in 0 … {g - len(points)}; "
            f"over {J.field.name} add smaller sums"
        )
    points = in_order(points)
    parts = [points[start : start + g] for start in range(0, len(points), g)] or [[]]
    total, *rest = [Divisor(J, *pair_of_points(J.curve, part), n) for part in parts]
    for part in rest:
        total = total + part
    return total


def _cancel_opposites(C: HyperellipticCurve, points: list[AffinePoint]) -> tuple[list[AffinePoint], int]:
    """The points left after all pairs P, ιP are removed, ι(x, y) = (x, −y − h(x)), and the number of these pairs. Two
    copies of a branch point are such a pair.
    """
    if not C.field.exact:
        return _cancel_inexact(C, points)
    K = C.field
    kept: Counter[AffinePoint] = Counter()
    for point in points:
        opposite = AffinePoint(point.x, K.neg(K.add(point.y, poly.evaluate(K, C.h, point.x))))
        if kept[opposite]:
            kept[opposite] -= 1
        else:
            kept[point] += 1
    return list(kept.elements()), (len(points) - kept.total()) // 2


def _cancel_inexact(C: HyperellipticCurve, points: list[AffinePoint]) -> tuple[list[AffinePoint], int]:
    """:func:`_cancel_opposites` over an inexact field, where y is known only up to rounding."""
    from jacobian.law.inexact_points import opposite

    kept: list[AffinePoint] = []
    for point in points:
        other = next((earlier for earlier in kept if opposite(C, point, earlier)), None)
        if other is None:
            kept.append(point)
        else:
            kept.remove(other)
    return kept, (len(points) - len(kept)) // 2


def pair_of_points(C: HyperellipticCurve, points: list[AffinePoint]) -> tuple[poly.Poly, poly.Poly]:
    """The Mumford pair (u, v) through the points, which may be repeated; no two of them are opposite.

    Over an inexact field :mod:`jacobian.law.inexact_points` computes it; else Newton's interpolation. Each point adds
    k·u to v: a new point (x₀, y₀) with k = (y₀ − v(x₀))/u(x₀), a repeated one with k = w(x₀)/(2y₀ + h(x₀)), w = (f −
    hv − v²)/u.
    """
    K = C.field
    if not K.exact:
        from jacobian.law import inexact_points

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
