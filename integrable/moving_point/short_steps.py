"""Translations and additions of short runs (:mod:`integrable.moving_point.short`), compiled as they stand: centres of
panels in wide numbers, the nodes about them in floats, or in wide numbers where floats do not do.
"""

from __future__ import annotations

from typing import Any

from integrable.moving_point.addition import carried, moving_point, near_identity, opposite, put, rate_at, shift
from integrable.moving_point.short_rows import (
    FINEST,
    OFF,
    PANEL,
    RATE,
    Room,
    Row,
    Rule,
    axes_of,
    curve_of,
    unit_axes,
)  # fmt: skip
from integrable.moving_point.translations import power_series
from jacobian.numbers.roots import root


def panel_steps(room: Room, h: float) -> None:
    """The translations by h/2^l as far as FINEST, and the first by a panel."""
    f, axes, steps = curve_of(room.wide), unit_axes(room.wide), room.steps
    power_series(f, -1, room.series)
    power_series(f, 1, room.roots)
    step = near_identity(room.series, room.roots, f[0], axes, (0 * f[0] + h) / 2.0**FINEST, room.made[2])
    for level in range(FINEST, -1, -1):
        put(step, steps, 10 * level)
        step = shift(f, axes, step, step)
    put(step, steps, 10 * PANEL)
    room.made[0], room.made[1] = 1, 0


def node_steps(room: Room, rule: Rule, h: float) -> None:
    """The translations by h·x/2^level for all nodes x, at the next level: wide, and rounded."""
    f, axes, steps, nodes = curve_of(room.wide), unit_axes(room.wide), room.steps, room.wide_nodes
    level, count = room.made[1], len(rule.nodes)
    if level > 0:
        eps = (0 * f[0] + h) / 2.0 ** (FINEST + level)
        put(near_identity(room.series, room.roots, f[0], axes, eps, room.made[2]), steps, 10 * (FINEST + level))
    last = level * count + count - 1
    for j in range(count // 2):
        first, second = rule.sums[2 * j], rule.sums[2 * j + 1]
        if first <= FINEST:
            origin = moving_point(steps, 10 * (level + first))
        else:
            origin = moving_point(nodes, 10 * (last - (first - FINEST - 1)))
        step = moving_point(steps, 10 * (level + abs(second)))
        if second < 0:
            step = opposite(step)
        there = shift(f, axes, origin, step)
        put(there, nodes, 10 * (last - j))
        put(opposite(there), nodes, 10 * (level * count + j))
    for i in range(10 * level * count, 10 * (last + 1)):
        room.nodes[i] = float(nodes[i])
    room.made[1] += 1


def doubled(wide: Row, steps: Row, place: int) -> None:
    """Twice the translation before it into row ``place`` of ``steps``."""
    step = moving_point(steps, 10 * (place - 1))
    put(shift(curve_of(wide), unit_axes(wide), step, step), steps, 10 * place)


def moved(wide: Row, points: Row, origin: int, steps: Row, place: int, sign: int, target: int, point: Row) -> None:
    """Row ``target`` of ``points``: row ``origin`` after a translation or its inverse; and into ``point`` what
    :func:`looked_at` sees there.
    """
    step = moving_point(steps, 10 * place)
    if sign < 0:
        step = opposite(step)
    there = carried(curve_of(wide), axes_of(wide), moving_point(points, 10 * origin), step)
    put(there, points, 10 * target)
    looked_at(wide, points, target, point)


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
    for j in range(count):
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
