"""The motion along an oval by additions of (℘(τ), ℘'(τ)), without theta functions: the readable oracle.

    R_i(u + v) = (s_i(v)R_i'(u) + R_i(u)s_j(v)s_k(v))/(℘(v) − Z(u)),   s_i = √(℘ − e_i),   R_i' = ±R_jR_k.

τ is reduced modulo the real period. s_i(v) is computed by doublings from a Laurent series. (The addition formula is
Weierstrass's.)
"""

from math import ceil


def moved(oval, tau):
    """The roots R_i of a SeparatedOval after a time τ from its start."""
    turns = oval.field.context.nint(tau / oval.period)
    rest = tau - turns * oval.period
    r = added(oval.low, oval.signs, oval.start, translation(oval, rest)) if rest else list(oval.start)
    if turns % 2:
        for i in (oval.low, oval.middle):
            r[i] = -r[i]
    return r


def added(low, signs, r, s):
    """The roots R_i at the sum of a point with roots r and a translation s."""
    # ℘(v) − Z(u) = s_i² ∓ R_i²; an i for which this is a sum avoids cancellation
    j = (low + 1) % 3
    down = s[j] * s[j] + r[j] * r[j]
    return [(s[n] * signs[n] * r[n - 2] * r[n - 1] + r[n] * s[n - 2] * s[n - 1]) / down for n in range(3)]


def translation(oval, v):
    """s_i(v) = √(℘(v) − e_i), 0 < |v| ≤ half a period, from the Laurent series at v/2^m and m doublings."""
    K = oval.field
    mean = sum(oval.e) / 3
    centred = [x - mean for x in oval.e]
    one, two, three = centred
    series = laurent(K, -4 * (one * two + two * three + three * one), 4 * one * two * three)
    size, halvings = max(map(abs, centred)), 0
    sign, v = (1, v) if v > 0 else (-1, -v)
    while v * v * size > 1 / 16:
        v, halvings = v / 2, halvings + 1
    square = v * v
    tail = K.zero
    for c in reversed(series):
        tail = tail * square + c
    # v²(℘ − e) = 1 − v²e + v⁴·tail
    s = [K.context.sqrt(abs(1 - square * e + square * square * tail)) / v for e in centred]
    for _ in range(halvings):
        s = doubled(oval, s)
    return [sign * x for x in s]


def doubled(oval, s):
    """s_i(2v) from s_i(v), without differences except in s_high, which vanishes at half a period."""
    down = 2 * s[0] * s[1] * s[2]
    result = [oval.field.zero] * 3
    middle = (s[oval.middle] ** 4 + oval.swing * oval.above) / down
    result[oval.middle] = middle
    result[oval.low] = oval.field.context.sqrt(middle * middle + oval.swing)
    result[oval.high] = (s[oval.high] ** 4 - oval.breadth * oval.above) / down
    return result


def laurent(K, g2, g3):
    """The Laurent coefficients c_0, c_1, … of ℘(v) = v⁻² + v²Σ c_n v^(2n), ℘'² = 4℘³ − g2℘ − g3."""
    count = ceil(0.5 * K.dps + 10)
    c = [K.zero, K.zero, g2 / 20, g3 / 28]
    for n in range(4, count + 2):
        # each product c_m·c_(n−m), m ≠ n − m, occurs twice
        middle = (n + 1) // 2
        total = 2 * K.dot(c[2:middle], c[n - 2 : n - middle : -1])
        if n % 2 == 0:
            total += c[middle] * c[middle]
        c.append(3 * total / ((2 * n + 1) * (n - 3)))
    return c[2:]
