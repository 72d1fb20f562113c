"""Sums of points on y² = f(x) to hundreds of digits: interpolation through all points, then Cantor's reduction, and the
effect of rounding of the summands' coefficients on the sum. Nothing of the packages is imported.
"""

from __future__ import annotations

from collections.abc import Sequence
from random import Random
from typing import Any

import mpmath

CONTEXT = mpmath.MPContext()
CONTEXT.dps = 600
Point = tuple[Any, Any]
Poly = list[Any]
SAMPLES = 4


def lifted(f: Sequence[Any], x: Any, sign: int) -> Point | None:
    """The point over x; None where f(x) < 0 or x is a branch point."""
    value = at(f, x)
    if value == 0 or (not isinstance(value, CONTEXT.mpc) and value < 0):
        return None
    return x, sign * CONTEXT.sqrt(value)


def pair(f: Sequence[Any], points: Sequence[Point]) -> tuple[Poly, Poly]:
    """(u, v) of a sum of points without opposite ones; equal points count with multiplicity (Newton; Cantor 1987)."""
    u, v = [CONTEXT.one], [CONTEXT.zero]
    for x, y in points:
        here = at(u, x)
        if here == 0:
            w = divided(minus(f, product(v, v)), u)[0]
            k = at(w, x) / (2 * y)
        else:
            k = (y - at(v, x)) / here
        v, u = minus(v, [-k * c for c in u]), product(u, [-x, CONTEXT.one])
    return u, v[: max(1, len(u) - 1)]


def reduced(f: Sequence[Any], genus: int, u: Poly, v: Poly) -> tuple[Poly, Poly]:
    """Steps (u, v) → ((f − v²)/u, −v) until deg u ≤ g or a step no longer lowers it."""
    while len(u) - 1 > genus:
        rest = trimmed(divided(minus(f, product(v, v)), u)[0])
        if len(rest) >= len(u):
            break
        u = [c / rest[-1] for c in rest]
        v = divided([-c for c in v], u)[1]
    return u, v


def total(f: Sequence[Any], genus: int, points: Sequence[Point]) -> tuple[Poly, Poly]:
    """(u, v) of the reduced sum; a point and its exact opposite cancel."""
    kept: list[Point] = []
    for x, y in points:
        if (x, -y) in kept:
            kept.remove((x, -y))
        else:
            kept.append((x, y))
    return reduced(f, genus, *pair(f, kept))


def rounding(f: Sequence[Any], genus: int, summands: Sequence[Sequence[Point]], eps: float) -> list[Any]:
    """The largest changes of the coefficients of the sum's (u, v), over ``SAMPLES`` random relative changes by ``eps``
    of the coefficients of f and of the summands' u and v; points stay on the curve.
    """
    base, rng = flat(total(f, genus, [P for part in summands for P in part])), Random(0)
    worst = [eps * abs(c) for c in base]
    pairs = [pair(f, part) for part in summands]
    for _ in range(SAMPLES):
        moved_f = [c * (1 + eps * rng.choice((-1, 1))) for c in f]
        moved = [
            P for part, (u, v) in zip(summands, pairs, strict=True) for P in _moved(f, moved_f, part, u, v, eps, rng)
        ]
        found = flat(total(moved_f, genus, moved))
        if len(found) != len(base):
            return [CONTEXT.inf] * len(base)
        worst = [max(w, abs(x - y)) for w, x, y in zip(worst, found, base, strict=True)]
    return worst


def _moved(f: Any, moved_f: Any, points: Any, u: Poly, v: Poly, eps: float, rng: Random) -> list[Point]:
    change = [c * eps * rng.choice((-1, 1)) for c in u[:-1]] + [0]
    noise = [abs(c) * eps for c in v]
    slope = [i * c for i, c in enumerate(f)][1:]
    found = []
    for i, (x, y) in enumerate(points):
        others = [abs(x - z) for j, (z, _) in enumerate(points) if j != i]
        rest = CONTEXT.fprod(others)
        near = min(others, default=CONTEXT.inf)
        shift = at(change, x) / rest if rest else CONTEXT.inf
        if abs(shift) > near / 4:
            # roots that nearly coincide move as roots of higher order do
            power = 1 + sum(d <= 4 * near for d in others)
            apart = CONTEXT.fprod(d for d in others if d > 4 * near)
            shift = rng.choice((-1, 1)) * (abs(at(change, x)) / apart) ** (CONTEXT.one / power)
        # a changed ordinate is the right one of a nearby point
        lean = at(slope, x)
        if lean:
            shift += rng.choice((-1, 1)) * min(abs(2 * y * at(noise, abs(x)) / lean), abs(x) / 8)
        value = CONTEXT.sqrt(at(moved_f, x + shift))
        found.append((x + shift, value if abs(value - y) < abs(value + y) else -value))
    return found


def flat(uv: tuple[Poly, Poly]) -> list[Any]:
    """The coefficients of u without the leading one, then as many of v."""
    u, v = uv
    size = len(u) - 1
    return [*u[:size], *(v + [CONTEXT.zero] * size)[:size]]


def at(a: Sequence[Any], x: Any) -> Any:
    value = CONTEXT.zero
    for c in reversed(a):
        value = value * x + c
    return value


def product(a: Sequence[Any], b: Sequence[Any]) -> Poly:
    result = [CONTEXT.zero] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            result[i + j] += x * y
    return result


def minus(a: Sequence[Any], b: Sequence[Any]) -> Poly:
    size = max(len(a), len(b))
    x, y = ([*c, *[CONTEXT.zero] * (size - len(c))] for c in (a, b))
    return [p - q for p, q in zip(x, y, strict=True)]


def divided(a: Sequence[Any], monic: Sequence[Any]) -> tuple[Poly, Poly]:
    rest, m = list(a), len(monic) - 1
    for i in range(len(rest) - m - 1, -1, -1):
        for j in range(m):
            rest[i + j] -= rest[i + m] * monic[j]
    return rest[m:], rest[:m] or [CONTEXT.zero]


def trimmed(a: Poly) -> Poly:
    """The polynomial without leading terms that vanish to all but a hundred digits."""
    size = max(abs(c) for c in a)
    while len(a) > 1 and abs(a[-1]) <= size * CONTEXT.mpf(10) ** (100 - CONTEXT.dps):
        a = a[:-1]
    return a
