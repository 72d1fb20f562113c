"""Translations and additions of short runs (:mod:`integrable.moving_point.short`), compiled unchanged. Centres of
panels are in wide numbers. The nodes around them are in floats, or in wide numbers where floats do not suffice.
"""

from __future__ import annotations

from math import sqrt

from integrable.moving_point.addition import (
    Row,
    carried,
    curve_of,
    moving_point,
    noise,
    opposite,
    put,
    rate_at,
    settled,
    shift,
)
from integrable.moving_point.problem import CONTACT
from integrable.moving_point.short_rows import (
    AHEAD,
    FINEST,
    HALF,
    LOT,
    MOVED,
    OFF,
    ORDER_GAIN,
    ORDERS,
    PANEL,
    POINT,
    RATE,
    SHADOW,
    WIDE_ORDERS,
    Rule,
    ShortRoom,
    axes_of,
    unit_axes,
)  # fmt: skip
from integrable.moving_point.translations import Expansion, expand_orders, high_parts
from integrable.phase.body import Vector
from integrable.phase.coordinates import gamma_and_w
from jacobian.element import Real
from jacobian.numbers.abreast import abreast
from jacobian.numbers.roots import root

# the initial relative distance from the motion to its shadow (:mod:`integrable.moving_point.short`); it exceeds the
# error of several additions in double-doubles
OFF_BY = 2.0**-99
# :func:`levelled` turns ν. Where the squared derivative of f − V² − UW with respect to the turn is this fraction of its
# upper bound, the damped turn is half the required one
LEAST_SLOPE = 2.0**-20
# if a product Π(α_i − α_j) is smaller than this, sums of quantities divided by it have too few digits
LEAST_KAPPA = 2.0**-33


def panel_steps(room: ShortRoom, h: float) -> bool:
    """Computes the translations by h/2^l, h half the length of a panel, for levels l up to FINEST or further. The
    expansion gives them at levels where its truncation error is below the rounding of wide numbers; doubling gives the
    longer translations. Returns whether the expansion suffices at some level.
    """
    rows = room.series
    expand_orders(curve_of(room.wide), rows, 0, WIDE_ORDERS)
    # the contributions of further orders are so small that floats suffice
    expand_orders(room.motion.f, high_parts(rows), WIDE_ORDERS, ORDERS)
    level, eps = 0, h
    while level < HALF and not exact_at(rows, eps):
        level, eps = level + 1, eps / 2
    room.made[0], room.made[1], room.made[2] = 0, 0, max(level, FINEST)
    small_steps(room, eps, level, room.made[2])
    for place in range(HALF - level + 1, HALF + 1):
        step = moving_point(room.steps, 10 * (place - 1))
        put(shift(curve_of(room.wide), unit_axes(room.wide), step, step), room.steps, 10 * place)
    return level < HALF


def exact_at(rows: Expansion, eps: float) -> bool:
    """Whether the terms of an expansion fall fast enough at eps. The omitted terms are then below the rounding of wide
    numbers, and the terms computed in floats below the rounding of floats.
    """
    square, exact = eps * eps, True
    fourth, fall = square * square, square * ORDER_GAIN
    # u0 and u1 begin with order 1, and v1 begins with the constant 2
    a = max(abs(float(rows.u0[1])), abs(float(rows.u0[2])) * square)
    b = max(abs(float(rows.u1[1])), abs(float(rows.u1[2])) * square)
    c = max(abs(float(rows.v0[0])), abs(float(rows.v0[1])) * square, abs(float(rows.v0[2])) * fourth)
    power = 1.0
    for _ in range(1, WIDE_ORDERS):
        power *= fall
    for k in range(WIDE_ORDERS, ORDERS):
        exact = exact and abs(float(rows.u0[k])) * power <= a and abs(float(rows.u1[k])) * power <= b
        power *= fall
        exact = exact and abs(float(rows.v0[k])) * power <= c and abs(float(rows.v1[k])) * power <= 2
    return exact


def small_steps(room: ShortRoom, eps: float, first: int, last: int) -> None:
    """Computes the translations at the levels ``first`` … ``last`` by their expansion; the first is by ``eps``."""
    rows, axes = room.series, unit_axes(room.wide)
    for level in range(first, last + 1):
        # ``rates`` is still unused, so it holds the times meanwhile
        room.rates[level], eps = eps, eps / 2
    for level in abreast(first, last + 1):
        put(expanded(rows, axes, room.rates[level]), room.steps, 10 * (HALF - level))


def expanded(rows: Expansion, axes: Row, eps: Real) -> Row:
    """The translation by eps, from its expansion."""
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


def node_steps(room: ShortRoom, rule: Rule, h: float) -> None:
    """Computes the translations by h·x/2^level for all nodes x, with h as in :func:`panel_steps`, in wide numbers and
    in floats. The level is the first whose translations are not computed yet.
    """
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


def put_node(room: ShortRoom, rule: Rule, level: int, j: int, origin: Real) -> None:
    """Writes the translations to the j-th positive node of a level and to its mirror image, by one addition to
    the translation ``origin``.
    """
    count, power = len(rule.nodes), rule.sums[2 * j + 1]
    step = moving_point(room.steps, 10 * (HALF - level - abs(power)))
    if power < 0:
        step = opposite(step)
    there = carried(curve_of(room.wide), unit_axes(room.wide), origin, step)
    put(there, room.wide_nodes, 10 * ((level + 1) * count - 1 - j))
    put(opposite(there), room.wide_nodes, 10 * (level * count + j))


def moved_row(wide: Row, points: Row, origin: int, steps: Row, place: int, sign: int, target: int, point: Row) -> None:
    """Writes row ``origin`` of ``points``, moved by a translation or its inverse, to row ``target``. The values of
    :func:`looked_at` for that row go to ``point``.
    """
    step = moving_point(steps, 10 * place)
    if sign < 0:
        step = opposite(step)
    there = carried(curve_of(wide), axes_of(wide), moving_point(points, 10 * origin), step)
    put(there, points, 10 * target)
    looked_at(wide, points, target, point, 0)


def steps_ahead(room: ShortRoom) -> None:
    """Computes the translations by 1 … :data:`AHEAD` panels. For k ≥ 1 the translation by k + 2 panels is the sum of
    those by 2 and by k.
    """
    longer(room, HALF, HALF, PANEL)
    longer(room, PANEL, PANEL, PANEL + 1)
    for k in abreast(2, AHEAD):
        longer(room, PANEL + 1, PANEL + k - 2, PANEL + k)
    room.made[0] = AHEAD


def longer(room: ShortRoom, origin: int, by: int, target: int) -> None:
    """Writes the sum of two rows of translations, corrected as in :func:`led_on`, to row ``target``."""
    wide, steps = room.wide, room.steps
    there = carried(curve_of(wide), unit_axes(wide), moving_point(steps, 10 * origin), moving_point(steps, 10 * by))
    if no_level(wide, 0) or no_level(wide, 1) or no_level(wide, 2):
        # two equal or nearly equal moments leave the level undetermined
        put(settled(curve_of(wide), unit_axes(wide), there, noise(moving_point(steps, 10 * by))), steps, 10 * target)
    else:
        # translations have κ_i = 1, so r_i is divided by κ_i
        r = wide[CONTACT] / wide[9], wide[CONTACT + 1] / wide[10], wide[CONTACT + 2] / wide[11]
        x, y, _ = framed(wide, r, there)
        put(on_pairs(wide, r, x, levelled(wide, r, x, y, 0.0)), steps, 10 * target)


def no_level(wide: Row, i: int) -> bool:
    """Whether κ_i = r_i·Π(α_i − α_j) is 0 or too small for Σσ²/Π(α_i − α_j) to determine the level set of a
    translation.
    """
    return abs(float(wide[9 + i])) <= LEAST_KAPPA * float(wide[CONTACT + i])


def go_ahead(room: ShortRoom, first: bool, sign: int) -> None:
    """Computes the moving points of the motion and of its shadow at the centre of the first panel if ``first``, else of
    the next :data:`AHEAD` panels, and the data of :func:`seen` at each.
    """
    if first:
        for j in abreast(0, 2):
            led_on(room, 2 * AHEAD + j, HALF, sign, AHEAD - 1 + AHEAD * j, j * OFF_BY)
        seen(room, AHEAD - 1)
        return
    if room.made[0] < AHEAD:
        steps_ahead(room)
    for j in abreast(0, 2 * AHEAD):
        side = j // AHEAD
        led_on(room, AHEAD - 1 + AHEAD * side, PANEL + j - AHEAD * side, sign, j, side * OFF_BY)
    for j in abreast(0, AHEAD):
        seen(room, j)


def led_on(room: ShortRoom, origin: int, place: int, sign: int, target: int, off: float) -> None:
    """Writes row ``origin`` of ``ahead``, moved by a translation or its inverse and restored to its level set, to row
    ``target``. ``off`` is that of :func:`levelled`.

    U and V are recomputed from the pairs. Where a point of the divisor passes a branch point e, x − e is of the order
    of σ² and is lost to rounding; an addition keeps the digits of a small pair. Long translations also amplify
    deviations from the level set.
    """
    wide, r = room.wide, contact_of(room.wide)
    step = moving_point(room.steps, 10 * place)
    if sign < 0:
        step = opposite(step)
    there = carried(curve_of(wide), axes_of(wide), moving_point(room.ahead, 10 * origin), step)
    x, y, by = framed(wide, r, there)
    put(on_pairs(wide, r, x, levelled(wide, r, x, y, off)), room.ahead, 10 * target)
    room.seen[POINT * target + MOVED] = float(by)


def framed(wide: Row, r: Vector[Real], point: Row) -> tuple[Vector[Real], Vector[Real], Real]:
    """(σ, ν, deviation): the pairs of a point, corrected so that Σrσ² = 1, Σrσν = 0, and Σrν² makes the coefficient of
    x⁴ in f − V² − UW vanish. W is the cubic with the leading coefficient of f and W(α_i) = −κ_iν_i², where κ_i =
    r_iΠ(α_i − α_j). The deviation is the relative correction of Σrσ² plus that of Σrν².
    """
    x, y = (point[4], point[5], point[6]), (point[7], point[8], point[9])
    total = wide[6] + wide[7] + wide[8]
    square = inner(r, x, x)
    x = times(1 / root(square), x)
    y = less(y, inner(r, x, y), x)
    # the coefficient of x⁴ in f − V² − UW = 0 determines inner(r, y, y)
    size = wide[5] * (-inner(times_each(r, sums(wide)), x, x) - total) - wide[4]
    scale = size / inner(r, y, y)
    return x, times(root(scale), y), abs(square - 1) + abs(scale - 1)


def levelled(wide: Row, r: Vector[Real], x: Vector[Real], y: Vector[Real], off: float) -> Vector[Real]:
    """``y``, the ν of the pairs that :func:`framed` returns, after one Newton step towards f ≡ V² mod U. The step turns
    ν about σ = ``x``; it is damped where f − V² mod U hardly depends on the turn. ``off`` is the relative difference of
    H1/H2 on the required level set from H1/H2 of the motion.

    f − V² − UW, with the W of :func:`framed`, is a multiple of Π(x − α_i). It is evaluated at c, below the least α_i.
    """
    low, high = min(wide[6], wide[7], wide[8]), max(wide[6], wide[7], wide[8])
    c = low - (high - low) / 2
    e = wide[6] - c, wide[7] - c, wide[8] - c
    top = e[0] * e[1] * e[2]
    p = r[0] * e[1] * e[2], r[1] * e[2] * e[0], r[2] * e[0] * e[1]
    z = (x[1] * y[2] - x[2] * y[1]) / r[0], (x[2] * y[0] - x[0] * y[2]) / r[1], (x[0] * y[1] - x[1] * y[0]) / r[2]
    u, v = inner(p, x, x), inner(p, x, y)
    value = (c + (wide[0] + off * wide[0]) / (wide[6] * wide[7] * wide[8])) * top * (1 - wide[5] * c)
    left = value - v * v + u * (inner(p, y, y) + wide[5] * top)
    slope = 2 * (u * inner(p, y, z) - v * inner(p, x, z))
    most = abs(e[1] * e[2]) + abs(e[2] * e[0]) + abs(e[0] * e[1])
    bound = LEAST_SLOPE * most * most * most * most * abs(inner(r, z, z) * inner(r, y, y))
    return less(y, left * slope / (slope * slope + bound), z)


def on_pairs(wide: Row, r: Vector[Real], x: Vector[Real], y: Vector[Real]) -> Row:
    """The moving point with the pairs σ = ``x`` and ν = ``y``; at the branch points U = κσ² and V = κσν."""
    p = wide[7] * wide[8], wide[8] * wide[6], wide[6] * wide[7]
    p, q = times_each(r, p), times_each(r, sums(wide))
    return inner(p, x, x), -inner(q, x, x), inner(p, x, y), -inner(q, x, y), x[0], x[1], x[2], y[0], y[1], y[2]


def sums(wide: Row) -> Vector[Real]:
    """The sums α_2 + α_3, α_3 + α_1 and α_1 + α_2."""
    return wide[7] + wide[8], wide[8] + wide[6], wide[6] + wide[7]


def inner(r: Vector[Real], x: Vector[Real], y: Vector[Real]) -> Real:
    """Σr_i·x_i·y_i."""
    return r[0] * x[0] * y[0] + r[1] * x[1] * y[1] + r[2] * x[2] * y[2]


def times_each(x: Vector[Real], y: Vector[Real]) -> Vector[Real]:
    return x[0] * y[0], x[1] * y[1], x[2] * y[2]


def times(k: Real, x: Vector[Real]) -> Vector[Real]:
    return k * x[0], k * x[1], k * x[2]


def less(x: Vector[Real], k: Real, y: Vector[Real]) -> Vector[Real]:
    """x − k·y."""
    return x[0] - k * y[0], x[1] - k * y[1], x[2] - k * y[2]


def seen(room: ShortRoom, j: int) -> None:
    """Writes the data of the j-th precomputed centre and its distance from the shadow (:mod:`.short`): the distance in
    σ relative to |σ|, plus the distance in ν, relative to |w| = 1.
    """
    looked_at(room.wide, room.ahead, j, room.seen, POINT * j)
    here, there, square, apart, lean = 10 * j, 10 * (j + AHEAD), 0.0, 0.0, 0.0
    for i in range(3):
        sigma = float(room.ahead[there + 4 + i])
        square += sigma * sigma
        apart += abs(float(room.ahead[there + 4 + i] - room.ahead[here + 4 + i]))
        lean += abs(float(room.ahead[there + 7 + i] - room.ahead[here + 7 + i]))
    room.seen[POINT * j + SHADOW] = apart / sqrt(square) + lean
    room.seen[POINT * j + OFF] += room.seen[POINT * j + MOVED]


def contact_of(wide: Row) -> Vector[Real]:
    """r_i = I_i/(I_i + d)."""
    return wide[CONTACT], wide[CONTACT + 1], wide[CONTACT + 2]


def contact_in_floats(wide: Row) -> tuple[Real, ...]:
    """r_i = I_i/(I_i + d) in floats, then their rounding errors: without these all nodes would have a common error."""
    r0, r1, r2 = wide[CONTACT], wide[CONTACT + 1], wide[CONTACT + 2]
    x, y, z = float(r0), float(r1), float(r2)
    return x, y, z, float(r0 - x), float(r1 - y), float(r2 - z)


def looked_at(wide: Row, points: Row, target: int, point: Row, place: int) -> None:
    """Writes row ``target`` of ``points`` in floats, with 1/g and the deviation of H2 there, to ``point`` at
    ``place``.
    """
    there = moving_point(points, 10 * target)
    for i in range(10):
        point[place + i] = float(points[10 * target + i])
    point[place + RATE] = float(rate_at(axes_of(wide), there))
    _, (x, y, z) = gamma_and_w(there)
    # w is in units of |M|, so |w|² differs from 1 as H2 does from its value at the start
    point[place + OFF] = abs(float(x * x + y * y + z * z - 1))


def wide_values(
    wide: Row, points: Row, origin: int, steps: Row, place: int, mirrored: bool, values: Row, rates: Row
) -> None:
    """:func:`node_values` computed in wide numbers and rounded."""
    point = moving_point(points, 10 * origin)
    (r0, r1, r2), zero = contact_of(wide), 0 * wide[0]
    r = r0, r1, r2, zero, zero, zero
    node_values((curve_of(wide), axes_of(wide), r), point, steps, place, mirrored, values, rates)


def node_values(
    motion: tuple[tuple[Real, ...], tuple[Real, ...], tuple[Real, ...]],
    point: tuple[Real, ...],
    steps: Row,
    place: int,
    mirrored: bool,
    values: Row,
    rates: Row,
) -> None:
    """Writes γ, w and 1/g at the nodes about a point, by one addition each. ``motion`` has f, ``axes``, and the r_i
    with their rounding errors after them. The translations begin at ``place`` of ``steps``; ``mirrored`` takes them in
    reverse order, for time that runs backward.
    """
    (f, axes, r), count = motion, len(rates)
    for j in abreast(0, count):
        k = place + 10 * (count - 1 - j if mirrored else j)
        there = carried(f, axes, point, moving_point(steps, k))
        # Σrσ² differs from 1 only by a rounding error that all three σ have in common
        x, y, z = there[4] * there[4], there[5] * there[5], there[6] * there[6]
        off = (r[0] * x + r[1] * y + r[2] * z - 1) + (r[3] * x + r[4] * y + r[5] * z)
        rates[j] = float(rate_at(axes, there) * (1 + off / 2))
        put_gamma_and_w(there, values, j, count)


def put_gamma_and_w(point: tuple[Real, ...], values: Row, place: int, stride: int) -> None:
    """Writes γ and w of the upright motion at a moving point, six floats ``stride`` apart."""
    (x, y, z), (w1, w2, w3) = gamma_and_w(point)
    values[place], values[place + stride], values[place + 2 * stride] = float(x), float(y), float(z)
    place += 3 * stride
    values[place], values[place + stride], values[place + 2 * stride] = float(w1), float(w2), float(w3)
