"""Sums of points on y² = f(x), deg f = 2g + 1, with hundreds of digits, and the effect of rounding of the summands on
them.

The oracle shares nothing with the package: it uses Newton's interpolation through distinct points and Cantor's
reduction step, on mpmath's numbers. The conditioning is found by changes of the summands' coefficients by one unit of
the last bit, after which their points are projected back onto the curve.
"""

import mpmath

WIDE = mpmath.MPContext()
WIDE.dps = 300


def wide(x):
    """The number in WIDE, exactly."""
    if isinstance(x, float):
        return WIDE.mpf(x)
    if hasattr(x, "_mpf_"):
        return WIDE.make_mpf(x._mpf_)
    return WIDE.mpf(x.numerator) / x.denominator if hasattr(x, "numerator") else WIDE.mpf(x)


def value(a, x):
    total = WIDE.zero
    for c in reversed(a):
        total = total * x + c
    return total


def product(a, b):
    result = [WIDE.zero] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            result[i + j] += x * y
    return result


def divided(a, b):
    rest, m = list(a), len(b) - 1
    quotient = [WIDE.zero] * max(0, len(rest) - m)
    for i in reversed(range(len(quotient))):
        quotient[i] = rest[i + m] / b[m]
        rest = [c - quotient[i] * b[k - i] if i <= k <= i + m else c for k, c in enumerate(rest)]
    return quotient, rest[:m]


def through(points):
    """(u, v) of points with distinct x."""
    u, v = [WIDE.one], []
    for x, y in points:
        k = (y - value(v, x)) / value(u, x)
        v = [(v[i] if i < len(v) else 0) + k * c for i, c in enumerate(u)]
        u = product(u, [-x, WIDE.one])
    return u, v


def reduced(f, genus, u, v):
    """Cantor's reduction."""
    while len(u) - 1 > genus:
        square = product(v, v)
        rest = [(f[i] if i < len(f) else 0) - (square[i] if i < len(square) else 0) for i in range(len(square + f))]
        while not rest[-1]:
            rest.pop()
        quotient = divided(rest, u)[0]
        u = [c / quotient[-1] for c in quotient]
        v = [-c for c in divided(v, u)[1]]
        v += [WIDE.zero] * (len(u) - 1 - len(v))
    return u, v


def total(f, genus, points):
    """(u, v) of the reduced sum of points with distinct x."""
    return reduced(f, genus, *through(points))


def moved(f, points, eps, rng):
    """Points of the curve near the given ones, which belong to relative changes of the coefficients of (u, v) by up to
    eps.
    """
    u, v = ([c * (1 + eps * rng.uniform(-1, 1)) for c in part] for part in through(points))
    u[-1] = WIDE.one
    slope = [i * c for i, c in enumerate(u)][1:]
    found = []
    for x, y in points:
        for _ in range(12):
            x -= value(u, x) / value(slope, x)
        y = value(v, x)
        root = WIDE.sqrt(value(f, x))
        found.append((x, root if abs(root - y) < abs(root + y) else -root))
    return found


def conditioning(f, genus, summands, eps, rng, trials=3):
    """The sum (u, v) and the changes of its coefficients with the last bits of the summands; None if even its degree
    changes.
    """
    u, v = total(f, genus, [point for points in summands for point in points])
    shift = [WIDE.zero] * (len(u) + len(v))
    for _ in range(trials):
        try:
            near = total(f, genus, [point for points in summands for point in moved(f, points, eps, rng)])
        except ZeroDivisionError:
            # the last bits decide whether two points coincide or are opposite
            return (u, v), None
        if len(near[0]) != len(u):
            return (u, v), None
        shift = [max(s, abs(a - b)) for s, a, b in zip(shift, (*near[0], *near[1]), (*u, *v), strict=True)]
    return (u, v), shift


def share(found, exact, shift, eps):
    """The error of (u, v) relative to its conditioning and its own rounding, where u and v are each scaled by the size
    of the points.
    """
    u, v = exact
    m = len(u) - 1
    radius = max(abs(c) ** (WIDE.one / (m - i)) for i, c in enumerate(u[:-1]))
    worst = 0
    for part, other, by in ((found[0], u, shift[: m + 1]), (found[1], v, shift[m + 1 :])):
        error = max(abs(wide(a) - b) * radius**i for i, (a, b) in enumerate(zip(part, other, strict=True)))
        allowed = max((s + eps * abs(c)) * radius**i for i, (s, c) in enumerate(zip(by, other, strict=True)))
        worst = max(worst, error / allowed)
    return float(worst)


def roots(u):
    """The roots of u."""
    return WIDE.polyroots(u[::-1], maxsteps=500, extraprec=2000) if len(u) > 1 else []
