"""The data of theta functions on the real torus of a curve y² = f(x) of degree 5, in long numbers. They are periods in
a basis in which real motions are real, the odd characteristics of the branch points, and the image of a pair of points.

Paths go straight from branch point to branch point (Gauss–Chebyshev quadrature) and to points (Gauss–Legendre). Sheets
are chosen so that τ is symmetric with Im τ > 0. Exactly one of the 16 characteristics η₀ makes all η₀ + 2(q, p)_i odd,
where ∫_{r₀}^{r_i} = Ap + Bq (Mumford 1984).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import combinations, product
from math import ceil, gcd, log
from typing import Any, NamedTuple

from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField

Vector = tuple[Any, Any]
Whole = tuple[int, int, int, int]

# digits of integrals, and the largest number of nodes of a rule; beyond it, branch points nearly meet
DIGITS, MOST_NODES = 36, 2400
# bits of the nodes of quadrature rules
BITS = 180
# allowed distance from a whole number, due to rounding
NEARLY = 1e-22


class Periods(NamedTuple):
    """``cycles``: a₁, a₂, b₁, b₂ as vectors of integrals of (dx/y, x dx/y); ``halves``: the integrals from the first
    root to every branch point, infinity the last.
    """

    cycles: list[Vector]
    halves: list[Vector]


def half_integrals(Z: LongField, roots: list[Any], lead: Any) -> Periods:
    """The half-periods of five roots in the order of a simple polygon. Sheets are chosen so that τ is symmetric with Im
    τ positive.
    """
    sides = [along(Z, roots, lead, k) for k in range(4)]
    for signs in product((1, -1), repeat=3):
        a, b, c, d = ((2 * s * x, 2 * s * y) for s, (x, y) in zip((1, *signs), sides, strict=True))
        cycles = [a, (a[0] + c[0], a[1] + c[1]), b, d]
        tau = ratio(Z, cycles)
        if abs(tau[0][1] - tau[1][0]) > NEARLY * (1 + abs(tau[0][1])):
            continue
        if tau[0][0].imag < 0:
            cycles[:2], tau = [(-x, -y) for x, y in cycles[:2]], tuple(tuple(-x for x in row) for row in tau)
        if tau[0][0].imag > 0 and tau[0][0].imag * tau[1][1].imag > tau[0][1].imag ** 2:
            break
    else:
        raise PrecisionLoss("the periods of this curve were not found")
    halves = [(Z.zero, Z.zero)]
    for x, y in sides:
        halves.append((halves[-1][0] + x, halves[-1][1] + y))
    # the half-periods of all branch points sum to 0
    halves.append((-sum(x for x, _ in halves), -sum(y for _, y in halves)))
    return Periods(cycles, halves)


def along(Z: LongField, roots: list[Any], lead: Any, k: int) -> Vector:
    """∫(dx/y, x dx/y) along the straight path from root k to the next one, by Gauss–Chebyshev quadrature."""
    import gmpy2

    middle, half = (roots[k] + roots[k + 1]) / 2, (roots[k + 1] - roots[k]) / 2
    others = [r for i, r in enumerate(roots) if i not in (k, k + 1)]
    count = nodes_needed([(r - middle) / half for r in others])
    factor = Z.sqrt(Z.coerce(lead)) * Z.coerce(1j)
    for r in others:
        factor *= Z.sqrt(middle - r)
    totals = [Z.zero, Z.zero]
    for c in chebyshev_nodes(checked(count)):
        x, w = middle + half * c, Z.one
        for r in others:
            w *= Z.sqrt((x - r) / (middle - r))
        totals[0] += 1 / w
        totals[1] += x / w
    scale = gmpy2.const_pi() / count / factor
    return totals[0] * scale, totals[1] * scale


def image(Z: LongField, roots: list[Any], lead: Any, halves: list[Vector], pair: tuple[Any, Any, Any, Any]) -> Vector:
    """The sum, modulo periods, of the integrals from the first root to both points of a pair (u₀, u₁, v₀, v₁).

    The pair is U = x² + u₁x + u₀, V = v₁x + v₀.
    """
    u0, u1, v0, v1 = map(Z.coerce, pair)
    spread = Z.sqrt(u1 * u1 / 4 - u0)
    total = Z.zero, Z.zero
    for x in (spread - u1 / 2, -spread - u1 / 2):
        added = to_point(Z, roots, lead, halves, (x, v0 + v1 * x))
        total = total[0] + added[0], total[1] + added[1]
    return total


def to_point(Z: LongField, roots: list[Any], lead: Any, halves: list[Vector], point: Vector) -> Vector:
    """The integrals from the first root to a point (x₁, y₁), modulo periods.

    The path x = r + (x₁ − r)t² starts at the root r that takes fewest nodes.
    """
    (x1, y1), rules = point, []
    for k, r in enumerate(roots):
        if x1 == r:
            return halves[k]
        others = [e for i, e in enumerate(roots) if i != k]
        poles = [(e - r) / (x1 - r) for e in others]
        rules.append((nodes_needed([Z.sqrt(pole) for pole in poles]), k))
    count, k = min(rules)
    r, others = roots[k], [e for i, e in enumerate(roots) if i != k]
    end = Z.sqrt(Z.coerce(lead)) * Z.sqrt(x1 - r)
    for e in others:
        end *= Z.sqrt(x1 - e)
    totals = [Z.zero, Z.zero]
    for t, weight in legendre_nodes(checked(count)):
        x, w = r + (x1 - r) * t * t, Z.one
        for e in others:
            w *= Z.sqrt((x - e) / (x1 - e))
        totals[0] += weight / w
        totals[1] += weight * x / w
    # y at the end of the path, on this sheet or the opposite one
    scale = (2 if abs(end - y1) < abs(end + y1) else -2) * (x1 - r) / end
    return halves[k][0] + totals[0] * scale, halves[k][1] + totals[1] * scale


def nodes_needed(poles: Sequence[Any]) -> int:
    """The number of nodes of a rule on [−1, 1] for an integrand with these branch points, an even number."""
    rates = []
    for pole in map(complex, poles):
        root = (pole * pole - 1) ** 0.5
        rates.append(abs(log(abs(pole + root))))
    count = ceil(DIGITS * log(10) / (2 * max(min(rates), 1e-9))) + 6
    # a multiple of 8: quadrature rules are cached
    return count + -count % 8


def checked(count: int) -> int:
    """The number of nodes; raises PrecisionLoss if it exceeds MOST_NODES."""
    if count > MOST_NODES:
        raise PrecisionLoss("branch points are too near to each other")
    return count


@cache
def chebyshev_nodes(count: int) -> list[Any]:
    """The Chebyshev nodes cos((n + ½)π/count), n < count."""
    import gmpy2

    with LongField(BITS):
        return [gmpy2.cos(gmpy2.const_pi() * (2 * n + 1) / (2 * count)) for n in range(count)]


@cache
def legendre_nodes(count: int) -> list[tuple[Any, Any]]:
    """The positive nodes of Gauss's rule for an even count, with their weights."""
    from flint import arb, ctx

    before = ctx.prec
    try:
        ctx.prec = BITS + 20
        found = [arb.legendre_p_root(count, k, weight=True) for k in range(count // 2)]
    finally:
        ctx.prec = before
    with LongField(BITS) as N:
        return [(abs(N.from_ball(x)), N.from_ball(w)) for x, w in found]


def solved(Z: LongField, columns: Sequence[Vector], w: Vector) -> Vector:
    """The solution x of Σ x_k·column_k = w for two columns."""
    (a, c), (b, d) = columns
    area = a * d - b * c
    return (w[0] * d - w[1] * b) / area, (w[1] * a - w[0] * c) / area


def ratio(Z: LongField, cycles: Sequence[Vector]) -> tuple[tuple[Any, ...], ...]:
    """The matrix τ = A⁻¹B of the periods."""
    first, second = (solved(Z, cycles[:2], w) for w in cycles[2:])
    return (first[0], second[0]), (first[1], second[1])


def coordinates(Z: LongField, cycles: Sequence[Vector], w: Vector) -> tuple[Any, Any, Any, Any]:
    """The real coordinates (p₁, p₂, q₁, q₂) with w = Ap + Bq."""
    (t11, t12), (_, t22) = ratio(Z, cycles)
    z1, z2 = solved(Z, cycles[:2], w)
    area = t11.imag * t22.imag - t12.imag**2
    q1 = (z1.imag * t22.imag - z2.imag * t12.imag) / area
    q2 = (z2.imag * t11.imag - z1.imag * t12.imag) / area
    return z1.real - t11.real * q1 - t12.real * q2, z2.real - t12.real * q1 - t22.real * q2, q1, q2


def combined(whole: Whole, cycles: Sequence[Vector]) -> Vector:
    """The periods of the integral combination ``whole`` of the cycles."""
    x, y = (sum(n * c[k] for n, c in zip(whole, cycles, strict=True)) for k in (0, 1))
    return x, y


def crossing(u: Whole, v: Whole) -> int:
    """The intersection number of two cycles."""
    return u[0] * v[2] + u[1] * v[3] - u[2] * v[0] - u[3] * v[1]


def real_basis(Z: LongField, found: Periods) -> Periods:
    """The periods in a symplectic basis with A real, Im τ reduced (Minkowski) and Re τ in {0, ½}."""
    rows = []
    for x, y in found.cycles:
        whole = coordinates(Z, found.cycles, (x.conjugate(), y.conjugate()))
        rows.append([round(float(n)) for n in whole])
    few = range(-2, 3)
    small = sorted(((a, b, c, d) for a, b, c, d in product(few, few, few, few)), key=lambda v: sum(x * x for x in v))
    fixed = [v for v in small if any(v) and all(sum(v[i] * rows[i][j] for i in range(4)) == v[j] for j in range(4))]
    for a1, a2 in combinations(fixed, 2):
        minors = [a1[i] * a2[j] - a1[j] * a2[i] for i in range(4) for j in range(i)]
        if crossing(a1, a2) or gcd(*minors) != 1:
            continue
        b1 = next((b for b in small if crossing(a1, b) == 1 and crossing(a2, b) == 0), None)
        b2 = b1 and next((b for b in small if (crossing(a1, b), crossing(a2, b), crossing(b1, b)) == (0, 1, 0)), None)
        if b1 and b2:
            return reduced(Z, Periods([combined(v, found.cycles) for v in (a1, a2, b1, b2)], found.halves))
    raise PrecisionLoss("the real periods of this curve were not found")


def reduced(Z: LongField, found: Periods) -> Periods:
    """The same periods in a basis with 2|Y₁₂| ≤ Y₁₁ ≤ Y₂₂, Y = Im τ."""
    a1, a2, b1, b2 = found.cycles
    while True:
        tau = ratio(Z, (a1, a2, b1, b2))
        y11, y12, y22 = (float(x.imag) for x in (tau[0][0], tau[0][1], tau[1][1]))
        turns = round(y12 / y11)
        if y22 < y11 * (1 - 1e-9):
            a1, a2, b1, b2 = a2, a1, b2, b1
        elif turns:
            # A → AU, B → BU⁻ᵀ, U = (1 0; n 1)
            a1 = a1[0] + turns * a2[0], a1[1] + turns * a2[1]
            b2 = b2[0] - turns * b1[0], b2[1] - turns * b1[1]
        else:
            break
    shifts = [[int((float(x.real) + 0.25) // 1) for x in row] for row in tau]
    b1, b2 = (
        (b[0] - m * a1[0] - n * a2[0], b[1] - m * a1[1] - n * a2[1])
        for b, m, n in ((b1, shifts[0][0], shifts[1][0]), (b2, shifts[0][1], shifts[1][1]))
    )
    return Periods([a1, a2, b1, b2], found.halves)


def characteristics(Z: LongField, found: Periods) -> list[Whole]:
    """The characteristics (ε₁, ε₂, δ₁, δ₂) of the odd theta functions that belong to the branch points."""
    bits = [[round(2 * float(x)) % 2 for x in coordinates(Z, found.cycles, w)] for w in found.halves]
    for e1, e2, d1, d2 in product((0, 1), repeat=4):
        chars = [((e1 + q1) % 2, (e2 + q2) % 2, (d1 + p1) % 2, (d2 + p2) % 2) for p1, p2, q1, q2 in bits]
        if all((a * c + b * d) % 2 for a, b, c, d in chars):
            return chars
    raise PrecisionLoss("the characteristics of this curve's branch points were not found")
