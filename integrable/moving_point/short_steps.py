"""Translations and additions of short runs (:mod:`integrable.moving_point.short`), compiled as they stand: centres of
panels in wide numbers, the nodes about them in floats, or in wide numbers where floats do not do.
"""

from __future__ import annotations

from math import sqrt
from typing import Any

from integrable.moving_point.addition import (
    carried,
    cofactor,
    moving_point,
    noise,
    opposite,
    pair,
    put,
    rate_at,
    settled_pair,
)
from integrable.moving_point.short_rows import (
    FINEST,
    HALF,
    LOT,
    OFF,
    ORDER_BITS,
    ORDERS,
    RATE,
    SHADOW_AT,
    SHADOW_HALF,
    SHADOW_PANEL,
    SHADOW_START,
    WIDE_ORDERS,
    Room,
    Row,
    Rule,
    axes_of,
    curve_of,
    unit_axes,
)  # fmt: skip
from integrable.moving_point.translations import Expansion, expand, high_parts
from jacobian.inexact.genus2_real import add
from jacobian.numbers.abreast import abreast
from jacobian.numbers.roots import root


def panel_steps(room: Room, h: float) -> bool:
    """The translations by h/2^l, as far down as FINEST: by their expansion where it is exact to wide numbers, or from
    where it is on by doubling; whether it is so anywhere.
    """
    rows = room.series
    expand(curve_of(room.wide), rows, 0, WIDE_ORDERS)
    # further ones count for so little that floats do
    expand(curve_of(room.numbers), high_parts(rows), WIDE_ORDERS, ORDERS)
    level, eps = 0, h
    while level < HALF and not exact_at(rows, eps):
        level, eps = level + 1, eps / 2
    room.made[0], room.made[1], room.made[2] = 0, 0, max(level, FINEST)
    small_steps(room, eps, level, room.made[2])
    for place in range(HALF - level + 1, HALF + 1):
        doubled(room.wide, room.steps, place)
    return level < HALF


def exact_at(rows: Expansion, eps: float) -> bool:
    """Whether each order of an expansion brings its bits at eps: what is left out is below wide numbers then, what is
    in floats below floats.
    """
    square, exact = eps * eps, True
    fall = square * 2.0**ORDER_BITS
    for row in (rows.u0, rows.u1, rows.v0, rows.v1):
        most = max(abs(float(row[0])), abs(float(row[1])) * square, abs(float(row[2])) * square * square)
        power = fall
        for _ in range(1, WIDE_ORDERS):
            power *= fall
        for k in range(WIDE_ORDERS, ORDERS):
            exact = exact and abs(float(row[k])) * power <= most
            power *= fall
    return exact


def small_steps(room: Room, eps: float, first: int, last: int) -> None:
    """The translations at some levels, by eps at the first of them, by their expansion."""
    rows, axes = room.series, unit_axes(room.wide)
    for level in range(first, last + 1):
        # a row that nothing else is in yet
        room.rates[level], eps = eps, eps / 2
    for level in abreast(first, last + 1):
        put(expanded(rows, axes, room.rates[level]), room.steps, 10 * (HALF - level))


def expanded(rows: Expansion, axes: Row, eps: Any) -> Any:
    """The translation by eps."""
    square = (0 * rows.u0[0] + eps) * eps
    z = float(square)
    a, b, c, d = 0 * z, 0 * z, 0 * z, 0 * z
    for k in range(ORDERS - 1, WIDE_ORDERS - 1, -1):
        a, b = a * z + float(rows.u0[k]), b * z + float(rows.u1[k])
        c, d = c * z + float(rows.v0[k]), d * z + float(rows.v1[k])
    u0, u1, v0, v1 = 0 * square + a, 0 * square + b, 0 * square + c, 0 * square + d
    for k in range(WIDE_ORDERS - 1, -1, -1):
        u0, u1 = u0 * square + rows.u0[k], u1 * square + rows.u1[k]
        v0, v1 = v0 * square + rows.v0[k], v1 * square + rows.v1[k]
    v0, v1 = v0 * eps, v1 / eps
    r1, r2, r3 = (
        root((axes[0] + u1) * axes[0] + u0), root((axes[1] + u1) * axes[1] + u0), root((axes[2] + u1) * axes[2] + u0),
    )  # fmt: skip
    return u0, u1, v0, v1, r1, r2, r3, (v0 + v1 * axes[0]) / r1, (v0 + v1 * axes[1]) / r2, (v0 + v1 * axes[2]) / r3


def node_steps(room: Room, rule: Rule, h: float) -> None:
    """The translations by h·x/2^level for all nodes x, at the next level: wide, and rounded."""
    level, count = room.made[1], len(rule.nodes)
    while room.made[2] < FINEST + level:
        room.made[2] += 1
        small_steps(room, h / 2.0 ** room.made[2], room.made[2], room.made[2])
    for j in abreast(0, LOT):
        put_node(room, rule, level, j, moving_point(room.steps, 10 * (HALF - level - rule.sums[2 * j])))
    last = (level + 1) * count - 1
    for j in abreast(LOT, count // 2):
        put_node(room, rule, level, j, moving_point(room.wide_nodes, 10 * (last - rule.sums[2 * j])))
    for i in range(10 * level * count, 10 * (last + 1)):
        room.nodes[i] = float(room.wide_nodes[i])
    room.made[1] += 1


def put_node(room: Room, rule: Rule, level: int, j: int, origin: Any) -> None:
    """The translations to the j-th positive node at a level, and to its mirror image, by one addition to an origin."""
    count, power = len(rule.nodes), rule.sums[2 * j + 1]
    step = moving_point(room.steps, 10 * (HALF - level - abs(power)))
    if power < 0:
        step = opposite(step)
    there = carried(curve_of(room.wide), unit_axes(room.wide), origin, step)
    put(there, room.wide_nodes, 10 * ((level + 1) * count - 1 - j))
    put(opposite(there), room.wide_nodes, 10 * (level * count + j))


def doubled(wide: Row, steps: Row, place: int) -> None:
    """Twice the translation before it into row ``place`` of ``steps``."""
    one = 1 + 0 * wide[0]
    before, here, step = 10 * (place - 1), 10 * place, moving_point(steps, 10 * (place - 1))
    divisor, transfer = summed(wide, steps, place - 1, step, steps, place)
    rest, trust = cofactor(curve_of(wide), divisor), noise(step)
    for i in abreast(0, 3):
        x, y = steps[before + 4 + i], steps[before + 7 + i]
        sigma, nu = pair(wide[6 + i], one, x, y, x, y, transfer)
        steps[here + 4 + i], steps[here + 7 + i] = settled_pair(divisor, rest, wide[6 + i], one, sigma, nu, trust)


def moved(wide: Row, points: Row, origin: int, steps: Row, place: int, sign: int, target: int, point: Row) -> None:
    """Row ``target`` of ``points``: row ``origin`` after a translation or its inverse; and into ``point`` what
    :func:`looked_at` sees there.
    """
    step = moving_point(steps, 10 * place)
    if sign < 0:
        step = opposite(step)
    _, transfer = summed(wide, points, origin, step, points, target)
    before, by, there = 10 * origin, 10 * place, 10 * target
    for i in abreast(0, 3):
        x, y, sigma, nu = points[before + 4 + i], points[before + 7 + i], steps[by + 4 + i], sign * steps[by + 7 + i]
        points[there + 4 + i], points[there + 7 + i] = pair(wide[6 + i], wide[9 + i], x, y, sigma, nu, transfer)
    looked_at(wide, points, target, point)


def summed(wide: Row, points: Row, origin: int, step: Any, into: Row, target: int) -> Any:
    """The divisor of row ``origin`` of ``points`` after a translation, also into row ``target`` of ``into``, and the
    transfer polynomials, by which the pairs follow: three alike, so that they are done abreast.
    """
    i, k = 10 * origin, 10 * target
    point = points[i], points[i + 1], points[i + 2], points[i + 3]
    divisor, transfer = add(curve_of(wide), point, (step[0], step[1], step[2], step[3]))
    into[k], into[k + 1], into[k + 2], into[k + 3] = divisor
    return divisor, transfer


def put_on_pairs(wide: Row, points: Row, place: int) -> None:
    """The divisor of the point at ``place`` as its pairs at the middle and the last axis have it: κσ² = U, κσν = V.

    Where a point of it passes a node, x − e is lost to rounding as the square of σ. From there errors of U and V would
    grow like the square of those that inputs have, while an addition keeps the digits of small pairs.
    """
    low, high = 0, 0
    for i in range(1, 3):
        low = i if float(wide[6 + i] - wide[6 + low]) < 0 else low
        high = i if not float(wide[6 + i] - wide[6 + high]) < 0 else high
    middle = 3 - low - high
    a, b, p, q = wide[6 + middle], wide[6 + high], place + 4 + middle, place + 4 + high
    x, y = wide[9 + middle] * points[p], wide[9 + high] * points[q]
    unit = 1 / (b - a)
    u, v = x * points[p], x * points[p + 3]
    du, dv = (y * points[q] - u) * unit, (y * points[q + 3] - v) * unit
    points[place], points[place + 1] = a * b + (u - du * a), du - (a + b)
    points[place + 2], points[place + 3] = v - dv * a, dv


def shadow_moved(room: Room, first: bool, sign: int) -> float:
    """How far the shadow is off the first row of points, at the centre of the first panel or, from the centre before,
    of the next one: in σ/|σ| and ν, where |w| = 1.
    """
    shadow = room.shadow
    step = moving_point(shadow, SHADOW_HALF if first else SHADOW_PANEL)
    if sign < 0:
        step = opposite(step)
    before = moving_point(shadow, SHADOW_START if first else SHADOW_AT)
    put(carried(curve_of(shadow), axes_of(shadow), before, step), shadow, SHADOW_AT)
    put_on_pairs(shadow, shadow, SHADOW_AT)
    square, apart, lean = 0.0, 0.0, 0.0
    for i in range(3):
        sigma = float(shadow[SHADOW_AT + 4 + i])
        square += sigma * sigma
        apart += abs(float(shadow[SHADOW_AT + 4 + i] - room.points[4 + i]))
        lean += abs(float(shadow[SHADOW_AT + 7 + i] - room.points[7 + i]))
    return apart / sqrt(square) + lean


def looked_at(wide: Row, points: Row, target: int, point: Row) -> None:
    """Row ``target`` of ``points`` in floats, with 1/g and how far off H2 is there, into ``point``."""
    there = moving_point(points, 10 * target)
    for i in range(10):
        point[i] = float(points[10 * target + i])
    point[RATE] = float(rate_at(axes_of(wide), there))
    x, y, z, n0, n1, n2 = there[4], there[5], there[6], there[7], there[8], there[9]
    square = x * x + y * y + z * z
    lean = (x * n0 + y * n1 + z * n2) / square
    x, y, z = n0 - lean * x, n1 - lean * y, n2 - lean * z
    # |w| = 1
    point[OFF] = abs(float(x * x + y * y + z * z - 1))


def wide_values(
    wide: Row, points: Row, origin: int, steps: Row, place: int, mirrored: bool, values: Row, rates: Row
) -> None:
    """:func:`node_values` in wide numbers, rounded."""
    node_values(curve_of(wide), axes_of(wide), moving_point(points, 10 * origin), steps, place, mirrored, values, rates)


def node_values(f: Any, axes: Any, point: Any, steps: Row, place: int, mirrored: bool, values: Row, rates: Row) -> None:
    """γ, w and 1/g at the nodes about a point, one addition each. ``place`` is where the
    translations begin; ``mirrored``: in the order of descending τ.
    """
    count = len(rates)
    for j in abreast(0, count):
        k = place + 10 * (count - 1 - j if mirrored else j)
        there = carried(f, axes, point, moving_point(steps, k))
        rates[j] = float(rate_at(axes, there))
        gamma_and_w(there, values, j, count)


def gamma_and_w(point: Any, values: Row, place: int, stride: int) -> None:
    """γ and w = γ × M/|M| of the upright motion at a moving point, six floats ``stride`` apart. ν is w and a multiple
    of σ, which may be large on thin balls.
    """
    scale = 1 / root(point[4] * point[4] + point[5] * point[5] + point[6] * point[6])
    x, y, z = point[4] * scale, point[5] * scale, point[6] * scale
    lean = x * point[7] + y * point[8] + z * point[9]
    values[place], values[place + stride], values[place + 2 * stride] = float(x), float(y), float(z)
    values[place + 3 * stride] = float(point[7] - lean * x)
    values[place + 4 * stride] = float(point[8] - lean * y)
    values[place + 5 * stride] = float(point[9] - lean * z)
