"""Random real curves of genus 2, pairs of divisors at every distance, and their sums by the cubic through four points.

The oracle shares nothing with the package: it moves coincident and opposite points apart by 1e-70 and works
with 240 digits.
Errors: max |difference of coefficients| over max(1, |coefficients of the sum|)·max(1, |those of the summands|).
"""

from dataclasses import dataclass
from functools import cache
from random import Random
from statistics import median

import mpmath

WIDE = mpmath.MPContext()
WIDE.dps = 240
APART = WIDE.mpf(10) ** -70
EXACTLY = None
DISTANCES = (*range(16), EXACTLY)
WORST, TYPICAL = 1e-10, 1e-13

# variant: the points near which (P2, Q2) of D' lie, in terms of the points (P, Q) of D; "-" marks opposite points
VARIANTS = {
    "near D": ("near", "near"),
    "near -P, near Q": ("near -", "near"),
    "near -P, other generic": ("near -", "generic"),
    "near P, other generic": ("near", "generic"),
    "exactly -P, near Q": ("opposite", "near"),
}
CELLS = [(variant, k) for variant in VARIANTS for k in DISTANCES]


@dataclass(frozen=True)
class Row:
    """A sum: float f, and the Mumford pairs of D, D', D + D' in WIDE numbers (u without its leading 1)."""

    f: tuple
    first: tuple
    second: tuple
    total: tuple

    def error(self, u, v):
        """The error of a sum (u, v), u with or without its leading 1."""
        found = [WIDE.mpf(getattr(c, "_mpf_", c)) for c in (*u[:2], *v)]
        difference = max(abs(x - y) for x, y in zip(found, self.total, strict=True))
        return float(difference / max(1, *map(abs, self.total)) / max(1, *map(abs, self.first + self.second)))


@cache
def rows(variant, k, count=40):
    """``count`` seeded sums of one variant; k is minus the decimal exponent of the distance, None for coincidence."""
    rng = Random(f"{variant} {k}")
    found = []
    while len(found) < count:
        row = _row(VARIANTS[variant], k, rng)
        if row is not None:
            found.append(row)
    return found


def random_curve(rng):
    """f of degree 5 with five real roots in [−2, 2] and a leading coefficient in [0.5, 4], as floats."""
    f = [rng.uniform(0.5, 4)]
    for _ in range(5):
        root = rng.uniform(-2, 2)
        f = [x - root * y for x, y in zip([0.0, *f], [*f, 0.0], strict=True)]
    return tuple(f)


def random_point(f, rng):
    """A real point with y² ≥ 0.01."""
    while True:
        point = lift(f, WIDE.mpf(rng.uniform(-3, 3)), rng.choice((1, -1)))
        if point is not None:
            return point


def lift(f, x, sign):
    square = _value(f, x)
    return (x, sign * WIDE.sqrt(square)) if square >= 0.01 else None


def mumford(P, Q):
    """(u0, u1, v0, v1) of P + Q for two points with different x."""
    (x1, y1), (x2, y2) = P, Q
    slope = (y1 - y2) / (x1 - x2)
    return x1 * x2, -x1 - x2, y1 - slope * x1, slope


def chord_sum(f, points):
    """(u0, u1, v0, v1) of four points with different x: Newton's cubic p, u = (p² − f)/Π(x − x_i), v = −p."""
    p, product = [WIDE.zero] * 4, [WIDE.one]
    for x, y in points:
        step = (y - _value(p, x)) / _value(product, x)
        p = [a + step * b for a, b in zip(p, [*product, 0, 0, 0], strict=False)]
        product = [a - x * b for a, b in zip([0, *product], [*product, 0], strict=True)]
    rest = [sum(p[i] * p[k - i] for i in range(max(0, k - 3), min(3, k) + 1)) for k in range(7)]
    rest = [a - b for a, b in zip(rest, (*f, 0), strict=True)]
    u = []
    for top in (6, 5, 4):
        u.insert(0, rest[top])
        for j in range(5):
            rest[top - 4 + j] -= u[0] * product[j]
    u0, u1 = u[0] / u[2], u[1] / u[2]
    high = p[2] - u1 * p[3]
    return u0, u1, -(p[0] - u0 * high), -(p[1] - u0 * p[3] - u1 * high)


def _value(a, x):
    total = WIDE.zero
    for c in reversed(a):
        total = total * x + c
    return total


def _row(stances, k, rng):
    f = random_curve(rng)
    points = random_point(f, rng), random_point(f, rng)
    distance = 0 if k is None else WIDE.mpf(10) ** -k
    others, apart = [], []
    for point, stance in zip(points, stances, strict=True):
        sign = (1 if point[1] > 0 else -1) * (-1 if stance in ("near -", "opposite") else 1)
        offset = 0 if stance == "opposite" else distance * rng.choice((1, -1, 0.5))
        other = random_point(f, rng) if stance == "generic" else lift(f, point[0] + offset, sign)
        others.append(other)
        apart.append(other if stance == "generic" or offset else other and lift(f, point[0] + APART, sign))
    if None in others or None in apart:
        return None
    return Row(f, mumford(*points), mumford(*others), chord_sum(f, (*points, *apart)))


def assert_accurate(add, rows):
    """Every error of ``add(row) → (u, v)`` is below 1e-10, and the median below 1e-13."""
    errors = [row.error(*add(row)) for row in rows]
    assert max(errors) < WORST
    assert median(errors) < TYPICAL
