"""Evaluates the interpolants of a panel (:mod:`integrable.moving_point.short`) in floats; compiled unchanged."""

from __future__ import annotations

from math import sqrt

from integrable.moving_point.addition import Row
from integrable.moving_point.short_rows import LOT, RATE, FloatMotion, Request, Rule, ShortRoom
from integrable.phase.body import energies
from jacobian.numbers.abreast import abreast

# Newton's iteration ends after a step smaller than this
LAST = 1e-9
# the factor that splits a float into two halves of its digits (Veltkamp)
SPLIT = 2.0**27 + 1


def read_off(room: ShortRoom, rule: Rule, request: Request, left: float, half: float, i: int, sign: int) -> int:
    """Writes the states at all requested times on the panel from ``left`` to left + 2·half, beginning with the ``i``-th
    time. Returns the index of the first time beyond the panel.
    """
    clock = request.physical or request.clock
    full, rest = antiderivative(room, rule, half) if clock else (0.0, 0.0)
    end, length = i, full if request.physical else 2.0
    while 0 <= end < len(request.order) and gone_by(room, request, left, half, request.order[end], sign) <= length:
        end += sign
    begin, stop = (i, end) if sign > 0 else (end + 1, i + 1)
    for k in abreast(begin, stop):
        at = request.order[k]
        gone = gone_by(room, request, left, half, at, sign)
        if request.physical:
            x = place_of(room, gone, full)
            request.other[at] = sign * (left + half * (1 + x))
        else:
            x = gone - 1
            if clock:
                request.other[at] = sign * (room.sums[0] + (room.sums[1] + half * clenshaw(room.elapsed, x)))
        interpolated(room, rule, x, request.out, 6 * at)
    if clock:
        passed(room.sums, half, full, rest)
    count = len(rule.nodes)
    for e in range(6):
        room.last[e] = room.values[(e + 1) * count - 1 - LOT]
    return end


def passed(sums: Row, half: float, full: float, rest: float) -> None:
    """Adds half·(full + rest) to ``sums``, the high and low part of the time at the left end of a panel."""
    # ``half`` has few digits, so its product with the upper half of a float's digits is exact
    split = full * SPLIT
    top = split - (split - full)
    first, more = half * top, half * ((full - top) + rest) + sums[1]
    total = sums[0] + first
    back = total - sums[0]
    more += (sums[0] - (total - back)) + (first - back)
    sums[0] = total + more
    sums[1] = more - (sums[0] - total)


def gone_by(room: ShortRoom, request: Request, left: float, half: float, at: int, sign: int) -> float:
    """The distance of a requested time from the left end of the panel, in half panels."""
    high, low = abs(request.high[at]), sign * request.low[at]
    if request.physical:
        return ((high - room.sums[0]) + (low - room.sums[1])) / half
    return ((high - left) + low) / half


def antiderivative(room: ShortRoom, rule: Rule, half: float) -> tuple[float, float]:
    """Writes the Chebyshev coefficients of 1/g and of its integral from the panel's left end. Returns the integral over
    the panel as the sum of two floats.
    """
    count, series, integral = len(rule.nodes), room.slowness, room.elapsed
    # 1/g is expanded after one of its values is subtracted: otherwise rounding errors of the matrix would cause the
    # same relative error in every panel
    base = room.rates[0]
    for k in range(count):
        series[k] = 0.0
    # the inner loop runs over coefficients, so that the compiler vectorizes it
    for j in range(count):
        value = room.rates[j] - base
        for k in range(count):
            series[k] += rule.coefficients[j * count + k] * value
    # ``base`` is added last, since the rest of the integral is small
    part = series[0]
    series[0] += base
    integral[count], integral[count - 1] = series[count - 1] / (2 * count), series[count - 2] / (2 * (count - 1))
    for k in range(count - 2, 1, -1):
        integral[k] = (series[k - 1] - series[k + 1]) / (2 * k)
    integral[1] = series[0] - series[2] / 2
    even, odd, middle = 0.0, 0.0, series[0]
    for k in range(count, 1, -1):
        if k % 2 == 0:
            even += integral[k]
        else:
            odd += integral[k]
    odd += part - series[2] / 2
    integral[0] = odd + base - even
    # ``middle`` is the series at the centre; its difference from 1/g there in wide numbers measures the clock's error
    for k in range(2, count, 2):
        middle += -series[k] if k % 4 == 2 else series[k]
    room.sums[2] += (room.point[RATE] - middle) * 2 * half
    whole = 2 * base + 2 * odd
    return whole, 2 * odd - (whole - 2 * base)


def place_of(room: ShortRoom, target: float, full: float) -> float:
    """The x at which the integral of 1/g from −1 equals ``target``, by Newton's method confined to [−1, 1]."""
    low, high, step = -1.0, 1.0, 2.0
    x = min(1.0, max(-1.0, -1 + 2 * target / full))
    # SIMD lanes that have converged skip their steps; once all have, the nested loops make only few further tests
    for _ in range(8):
        if abs(step) >= LAST:
            for _ in range(8):
                if abs(step) >= LAST:
                    gone = clenshaw(room.elapsed, x) - target
                    low, high = low if gone > 0 else x, x if gone > 0 else high
                    step = gone / clenshaw(room.slowness, x)
                    there = x - step
                    held = there if low < there < high else (low + high) / 2
                    x = held if abs(step) >= LAST else min(1.0, max(-1.0, there))
    return x


def clenshaw(coefficients: Row, x: float) -> float:
    """A Chebyshev series at x (Clenshaw 1955)."""
    b1, b2 = 0.0, 0.0
    for k in range(len(coefficients) - 1, 0, -1):
        # in this order the next iteration waits for one instruction only
        b1, b2 = (coefficients[k] - b2) + 2 * x * b1, b1
    return coefficients[0] + x * b1 - b2


def interpolated(room: ShortRoom, rule: Rule, x: float, out: Row, place: int) -> None:
    """Writes γ and M at x on the panel, by barycentric interpolation (Berrut & Trefethen 2004)."""
    count, values = len(rule.nodes), room.values
    q0, q1, q2, q3, q4, q5, total = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(count // 2):
        k = count - 1 - j
        left, right = x - rule.nodes[j], x - rule.nodes[k]
        # at a node the term of that node dominates, and its large factor cancels when the state is normalized
        left, right = left if left != 0 else 1e-30, right if right != 0 else 1e-30
        # one division serves both nodes
        scale = 1 / (left * right)
        w, v = rule.weights[j] * right * scale, rule.weights[k] * left * scale
        total += w + v
        q0 += w * values[j] + v * values[k]
        q1 += w * values[count + j] + v * values[count + k]
        q2 += w * values[2 * count + j] + v * values[2 * count + k]
        q3 += w * values[3 * count + j] + v * values[3 * count + k]
        q4 += w * values[4 * count + j] + v * values[4 * count + k]
        q5 += w * values[5 * count + j] + v * values[5 * count + k]
    side = 1.0 if total > 0 else -1.0
    short_state(room.motion, side * q0, side * q1, side * q2, side * q3, side * q4, side * q5, out, place)


def short_state(
    motion: FloatMotion, s0: float, s1: float, s2: float, n0: float, n1: float, n2: float, out: Row, place: int
) -> None:  # fmt: skip
    """Writes γ and M of the given motion. (s, n) are γ and w = γ × M/|M| of the upright motion, times a common factor
    above 0.
    """
    scale = 1 / sqrt(s0 * s0 + s1 * s1 + s2 * s2)
    x, y, z = s0 * scale, s1 * scale, s2 * scale
    lean = x * n0 + y * n1 + z * n2
    w0, w1, w2 = n0 - lean * x, n1 - lean * y, n2 - lean * z
    scale = motion.momentum / sqrt(w0 * w0 + w1 * w1 + w2 * w2)
    m0, m1, m2 = (w1 * z - w2 * y) * scale, (w2 * x - w0 * z) * scale, (w0 * y - w1 * x) * scale
    a, b, c, d = motion.matrix
    if b != 0:
        x, y, z, m0, m1, m2 = (
            a * x + b * m0, a * y + b * m1, a * z + b * m2, c * x + d * m0, c * y + d * m1, c * z + d * m2,
        )  # fmt: skip
    out[place], out[place + 1], out[place + 2] = x, y, z
    out[place + 3], out[place + 4], out[place + 5] = m0, m1, m2


def largest_drift(motion: FloatMotion, out: Row, count: int) -> float:
    """The largest relative change of H1 or H2 from their start values."""
    worst = 0.0
    for i in range(count):
        k = 6 * i
        gamma, M = (out[k], out[k + 1], out[k + 2]), (out[k + 3], out[k + 4], out[k + 5])
        h1, h2 = energies(motion.a, motion.contact, motion.d, gamma, M)
        for x in (h1 / motion.energies[0], h2 / motion.energies[1]):
            worst = abs(x - 1) if not abs(x - 1) <= worst else worst
    return worst
