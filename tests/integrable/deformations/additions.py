"""The motion along an oval by additions of (℘(τ), ℘'(τ)), without theta functions, and the states of the pairs from
points on both ovals by sums over the axes: the readable oracle.

    R_i(u + v) = (s_i(v)R_i'(u) + R_i(u)s_j(v)s_k(v))/(℘(v) − Z(u)),   s_i = √(℘ − e_i),   R_i' = ±R_jR_k.

τ is reduced modulo the real period. s_i(v) is computed by doublings from a Laurent series. (The addition formula is
Weierstrass's.)
"""

from math import ceil

import gmpy2

from integrable.phase.body import cross
from integrable.phase.isometry import lift
from jacobian import poly

# R_1' = R_2R_3, R_2' = −R_3R_1, R_3' = −R_1R_2
SIGNS = (1, -1, -1)


def branch_points(oval):
    """The e_i of an EllipticOval, counted from the first."""
    return [oval.field.zero, oval.swing, oval.breadth]


def moved(oval, tau):
    """The roots R_i of an EllipticOval after a time τ from its start."""
    turns = gmpy2.rint(tau / oval.period)
    rest = tau - turns * oval.period
    r = added(0, SIGNS, oval.start, translation(oval, rest)) if rest else list(oval.start)
    return [-r[0], -r[1], r[2]] if turns % 2 else r


def added(low, signs, r, s):
    """The roots R_i at the sum of a point with roots r and a translation s."""
    # ℘(v) − Z(u) = s_i² ∓ R_i²; an i for which this is a sum avoids cancellation
    j = (low + 1) % 3
    down = s[j] * s[j] + r[j] * r[j]
    return [(s[n] * signs[n] * r[n - 2] * r[n - 1] + r[n] * s[n - 2] * s[n - 1]) / down for n in range(3)]


def translation(oval, v):
    """s_i(v) = √(℘(v) − e_i), 0 < |v| ≤ half a period, from the Laurent series at v/2^m and m doublings."""
    K, e = oval.field, branch_points(oval)
    mean = sum(e) / 3
    centred = [x - mean for x in e]
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
    s = [K.sqrt(abs(1 - square * e + square * square * tail)) / v for e in centred]
    for _ in range(halvings):
        s = doubled(oval, s)
    return [sign * x for x in s]


def doubled(oval, s):
    """s_i(2v) from s_i(v), without differences except in s_high, which vanishes at half a period."""
    down = 2 * s[0] * s[1] * s[2]
    middle = (s[1] ** 4 + oval.swing * oval.above) / down
    return [
        oval.field.sqrt(middle * middle + oval.swing), middle, (s[2] ** 4 - oval.breadth * oval.above) / down,
    ]  # fmt: skip


def laurent(K, g2, g3):
    """The Laurent coefficients c_0, c_1, … of ℘(v) = v⁻² + v²Σ c_n v^(2n), ℘'² = 4℘³ − g2℘ − g3."""
    count = ceil(0.15 * K.bits + 10)
    c = [K.zero, K.zero, g2 / 20, g3 / 28]
    for n in range(4, count + 2):
        # each product c_m·c_(n−m), m ≠ n − m, occurs twice
        middle = (n + 1) // 2
        total = 2 * K.dot(c[2:middle], c[n - 2 : n - middle : -1])
        if n % 2 == 0:
            total += c[middle] * c[middle]
        c.append(3 * total / ((2 * n + 1) * (n - 3)))
    return c[2:]


def height(oval, r):
    """Z − e_1 at the roots R_i, computed from the smallest of them."""
    i = min(range(3), key=lambda n: abs(r[n]))
    return branch_points(oval)[i] + SIGNS[i] * r[i] * r[i]


def state(carrier, first, second):
    """(γ, M) of a carrier's inner system from the roots R_i on both curves."""
    if carrier.inner.potential is not None:
        return state_in_poles(carrier, first, second)
    gamma, M = free_state(carrier, first[::-1], second)
    return lift(carrier.field, carrier.frame.back, gamma, M) if carrier.frame.back else (gamma, M)


def free_state(carrier, first, second):
    """(γ, M) of the tilde pair without potential, from the roots at the three axes on both curves."""
    body, K, frame, slopes = carrier.pair.body, carrier.field, carrier.frame, (SIGNS[::-1], SIGNS)
    e = [w * x * y for w, x, y in zip(frame.weights, first, second, strict=True)]
    length = K.sqrt(K.dot(e, e))
    # Z_k = e_1 + height, and e_1 is μ_k/I_i at the axis of the largest moment, or of the smallest one
    z = [
        1 / body.inertia[i] + height(curve, r) / mu
        for i, curve, r, mu in zip((2, 0), carrier.curves, (first[::-1], second), carrier.mu, strict=True)
    ]
    f = [1 / (1 + body.d * x) for x in z]
    # ũ2 − ũ1 as a sum without cancellation, since the two lie on opposite sides of the middle a_i
    gap = f[0] * f[1] * (first[1] ** 2 / abs(carrier.mu[0]) + second[1] ** 2 / abs(carrier.mu[1]))
    scale = 2 * length * f[0] * f[1] / (carrier.mu[0] * carrier.mu[1] * gap)
    n = []
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        left = first[j] * first[k] * f[0] * slopes[1][i] * second[i]
        right = second[j] * second[k] * f[1] * slopes[0][i] * first[i]
        n.append(scale * body.contact[i] * (left - right) / (frame.weights[i] * body.differences[i]))
    e = [x / length for x in e]
    square = sum(x * x / r for x, r in zip(e, body.contact, strict=True))
    lean = sum(x * y / r for x, y, r in zip(e, n, body.contact, strict=True)) / square
    gamma = [(lean * x - y) / r for x, y, r in zip(e, n, body.contact, strict=True)]
    size = frame.side * K.sqrt(K.dot(gamma, gamma))
    x, y, z = (x / size for x in gamma)
    momentum = frame.side * K.sqrt((carrier.lambdas[0] - carrier.lambdas[1]) / gap)
    return (x, y, z), cross(K, tuple(momentum * x for x in e), (x, y, z))


def state_in_poles(carrier, first, second):
    """(γ, M) of the tilde pair in repelling poles, by the cofactor (f − V²)/U."""
    K, a, c, b = carrier.field, carrier.inner.a, carrier.inner.body.differences, carrier.inner.potential.poles
    one, two = carrier.lambdas
    points = []
    for curve, levels, r, value in zip(carrier.curves, carrier.levels, (first, second), carrier.lambdas, strict=True):
        points.append((levels[0] + height(curve, r) / value, 2 * r[0] * r[1] * r[2] / value))
    (u1, y1), (u2, y2) = points
    h2 = (one - two) / (u2 - u1)
    slope = (y2 - y1) / (u2 - u1)
    V, U = (slope * u1 - y1, -slope), (u1 * u2, -u1 - u2, K.one)
    f = poly.scale(K, K.coerce(4), poly.from_roots(K, a))
    f = poly.mul(K, f, (one + u1 * h2, -h2))
    for i in range(3):
        f = poly.sub(K, f, poly.scale(K, 4 * b[i] * c[i], poly.from_roots(K, (a[i - 2], a[i - 1]))))
    cofactor = poly.quotient(K, poly.sub(K, f, poly.mul(K, V, V)), U)
    gamma, w = [], []
    for i, sign in enumerate(carrier.frame.signs):
        square = poly.evaluate(K, cofactor, a[i]) / (cofactor[2] * c[i])
        x = sign * K.sqrt(abs(square))
        gamma.append(x)
        w.append((V[0] + V[1] * a[i]) / (2 * c[i] * x))
    return tuple(gamma), cross(K, tuple(w), tuple(gamma))
