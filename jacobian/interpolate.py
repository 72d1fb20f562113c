"""Inexact composition: one formula from generic position to exact doubling and to opposite points.

Cantor's algorithm asks for greatest common divisors, which floats do not have. Here the function q·y − p(x) that
vanishes on both divisors is found as the null vector of a stacked linear system, by orthogonal transformations:

    L·U ≡ q·(V' − V)  (mod U')      and      L·(V + V') ≡ q·W  (mod U'),      W = (f − V²)/U,    p = q·V + U·L.

The first congruence alone is the classical one; it loses all digits when D' approaches D. The second fails when D'
approaches −D. Together, with q kept as an unknown, they determine p/q wherever the sum depends continuously on the
summands: q → 0 says that a point of D' meets the opposite of a point of D. The sum has U'' ∝ (p² − q²f)/(U·U'), and V''
solves a system stacked in the same way, to which the equation of the curve is added, each row weighted by its rounding
noise.

Numbers are ``float``, ``complex``, or the ``mpf``/``mpc`` of one context; the precision is theirs.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from jacobian.errors import NotRepresentable, PrecisionLoss

Number = Any
Coefficients = list[Number]
Pair = tuple[Coefficients, Coefficients]
Triple = tuple[tuple[Number, ...], tuple[Number, ...], "int | None"]


class Sum(NamedTuple):
    """A reduced sum (u, v), and the function q·y − p(x) that relates it to the summands."""

    u: Coefficients
    v: Coefficients
    p: Coefficients
    q: Number


def add(curve: Any, first: Triple, second: Triple) -> Triple:
    """The reduced sum of two Mumford triples (u, v, n) over an inexact field.

    Raises PrecisionLoss where a degree cannot be decided, and NotRepresentable where the sum on a split model has a
    point at infinity.
    """
    _check_balanced(curve, first, second)
    half = [c / 2 for c in curve.h]
    f = _sum(curve.f, _product(half, half)) if half else list(curve.f)
    u, v, _, _ = compose(curve.field, curve.genus, f, _centred(first, half), _centred(second, half))
    if half and len(u) > 1:
        v = _sum(v, _remainder([-c for c in half], u))
    return tuple(u), tuple(v), None if first[2] is None else (curve.genus + 1) // 2 - (len(u) - 1) // 2


def _check_balanced(curve: Any, *summands: Triple) -> None:
    """On a split model one function q·y − p adds only divisors whose points at infinity are shared evenly."""
    for u, _, n in summands:
        if n is not None and 2 * n != 2 * ((curve.genus + 1) // 2) - (len(u) - 1):
            raise NotRepresentable(
                f"a summand of {len(u) - 1} points with the weight n = {n} at ∞₊ has a point at infinity, "
                "which inexact split models do not carry; use an exact field"
            )


def compose(field: Any, genus: int, f: Sequence[Number], first: Pair, second: Pair) -> Sum:
    """The reduced sum of two pairs (u, v), neither of them (1, 0), on y² = f(x) of the given arithmetic genus.

    A quartic f with ``genus=2`` is the elliptic curve with its two points at infinity glued: the sum is that of the
    generalized Jacobian with modulus ∞₊ + ∞₋, because (y − p)/x³ then takes the same value at both.
    """
    (u1, v1), (u2, v2) = first, second
    f, w1, product = list(f), _cofactor(f, u1, v1), _product(u1, u2)
    radius = max(_radius(u1), _radius(u2))
    slope, q = _interpolant(field, first, second, w1, radius)
    p = _sum([q * c for c in v1], _product(u1, slope))
    if len(product) - 1 <= genus and not field.is_zero(q, _size(p)):
        return Sum(product, [c / q for c in p], p, q)
    p, q = _without_noise(field, f, p, q, radius)
    u = _monic_quotient(field, f, p, q, product)
    if len(u) == 1:
        return Sum([field.one], [], p, q)
    slope2, _ = _divmod(_sum(p, [-q * c for c in v2]), u2)
    summands = ((slope, v1, w1), (slope2, v2, _cofactor(f, u2, v2)))
    v = _second_polynomial(field, f, u, p, q, summands, radius)
    while len(u) - 1 > genus:
        u, v = _reduction_step(field, f, u, v)
    return Sum(u, v, p, q)


def _interpolant(
    field: Any, first: Pair, second: Pair, w1: Coefficients, radius: Number
) -> tuple[Coefficients, Number]:
    """(L, q) of norm 1 with q·V + U·L ≡ q·V' (mod U'), from both congruences at once."""
    (u1, v1), (u2, v2) = first, second
    m = len(u2) - 1
    trace, difference = _sum(v1, v2), _sum(v2, [-c for c in v1])
    noise1, noise2, bound = _absolute(u1), _sum(_absolute(v1), _absolute(v2)), _bound(u2)
    powers = [radius**i for i in range(m)]
    rows, weights = [], []
    for factor, value, noise, value_noise in ((u1, difference, noise1, noise2), (trace, w1, noise2, _absolute(w1))):
        # what enters the rows before cancellation, all coefficients being measured at |x| = radius
        weight = _size_at(_remainder(noise, bound), radius) or 1
        weights.append(_size_at(_remainder(value_noise, bound), radius) / weight)
        for power, row, right in zip(powers, _multiplication(factor, u2), _remainder(value, u2), strict=True):
            scale = power / weight
            rows.append([*(c * scale / other for c, other in zip(row, powers, strict=True)), -right * scale])
    unit = max(weights) or 1
    columns = [list(column) for column in zip(*[[*row[:m], row[m] / unit] for row in rows], strict=True)]
    order, triangle = _pivoted_qr(columns)
    free = sum(field.is_zero(triangle[k][k], 1) for k in range(m))
    if free:  # free + 1 pairs of opposite points: q = 0, and L vanishes at the other points of U'
        order, triangle = _pivoted_qr(columns[: m - free])
        solution = _null_vector(order, triangle) + [field.zero] * (free + 1)
    else:
        solution = _null_vector(order, triangle)
    solution = [*(x / power for x, power in zip(solution, powers, strict=False)), solution[m] / unit]
    norm = _norm(solution)
    return [x / norm for x in solution[:m]], solution[m] / norm


def _without_noise(
    field: Any, f: Coefficients, p: Coefficients, q: Number, radius: Number
) -> tuple[Coefficients, Number]:
    """p and q with those leading terms set to zero that are rounding noise: degrees are decided here, nowhere else.

    Terms are compared at |x| = ``radius``, the size of the points of the summands.
    """
    size = max(_size_at(p, radius), abs(q) * _size_at(f, radius) ** 0.5)
    p = list(p)

    def is_zero(c: Number, degree: float) -> bool:
        return bool(field.is_zero(c * radius**degree, size))

    while 2 * len(p) - 1 > len(f) and is_zero(p[-1], len(p) - 1):
        p.pop()
    if 2 * len(p) - 1 <= len(f) and is_zero(q * abs(f[-1]) ** 0.5, (len(f) - 1) / 2):
        q = field.zero
        while is_zero(p[-1], len(p) - 1):
            p.pop()
    return p, q


def _monic_quotient(field: Any, f: Coefficients, p: Coefficients, q: Number, product: Coefficients) -> Coefficients:
    """(p² − q²f)/(U·U'), made monic."""
    psi = _product(p, p)
    if q:
        if len(psi) == len(f) and field.is_zero(psi[-1] - q * q * f[-1], abs(psi[-1])):
            raise NotRepresentable(
                "the sum has a point at infinity, which inexact split models do not carry; use an exact field"
            )
        psi = _sum(psi, [-q * q * c for c in f])
    quotient, _ = _divmod(psi, product)
    return [c / quotient[-1] for c in quotient[:-1]] + [field.one]


def _second_polynomial(
    field: Any,
    f: Coefficients,
    u: Coefficients,
    p: Coefficients,
    q: Number,
    summands: Sequence[tuple[Coefficients, ...]],
    radius: Number,
) -> Coefficients:
    """V'' from q·V'' ≡ −p, L·(V'' − V) ≡ −q·W for either summand, and V''² ≡ f, all modulo U''."""
    m = len(u) - 1
    rows: list[Coefficients] = []
    right: Coefficients = []

    bound, powers, size = _bound(u), [radius**i for i in range(m)], _size_at(f, radius) ** 0.5

    def stack(factor: Coefficients, value: Coefficients, noise: Coefficients) -> None:
        weight = (
            _size_at(_remainder(noise, bound), radius) + size * _size_at(_remainder(_absolute(factor), bound), radius)
            or 1
        )
        for power, row, c in zip(powers, _multiplication(factor, u), _remainder(value, u), strict=True):
            rows.append([x * power / weight for x in row])
            right.append(c * power / weight)

    stack([q], [-c for c in p], [abs(c) for c in p])
    for slope, v, w in summands:
        noise = _sum(_product([abs(c) for c in slope], [abs(c) for c in v]), [abs(q * c) for c in w])
        stack(slope, _sum(_product(slope, v), [-q * c for c in w]), noise)
    # below the noise of those rows: of the solutions that opposite points leave open, a small one
    small = field.eps / (size or 1)
    rows.extend([small * power if i == j else field.zero for j in range(m)] for i, power in enumerate(powers))
    right.extend([field.zero] * m)
    solution = _least_squares(rows, right)
    for _ in range(2):  # the tangent at a point of D + D' that comes from opposite points is known from the curve alone
        del rows[3 * m :], right[3 * m :]
        noise = _sum(
            [abs(c) for c in f], [abs(c) for c in _product([abs(c) for c in solution], [abs(c) for c in solution])]
        )
        stack([2 * c for c in solution], _sum(f, _product(solution, solution)), noise)
        solution = _least_squares(rows, right)
    return solution


def _reduction_step(field: Any, f: Coefficients, u: Coefficients, v: Coefficients) -> Pair:
    """One step of Cantor's reduction (u, v) → ((f − v²)/u, −v)."""
    scale = max(_size(v), _size(f) ** 0.5)
    v = list(v)
    while v and field.is_zero(v[-1], scale):
        v.pop()
    quotient = _cofactor(f, u, v)
    if len(quotient) >= len(u):
        raise NotRepresentable(
            "the sum has a point at infinity, which inexact split models do not carry; use an exact field"
        )
    u = [c / quotient[-1] for c in quotient[:-1]] + [field.one]
    return u, _remainder([-c for c in v], u)


def _centred(divisor: Triple, half: Coefficients) -> Pair:
    """(u, v) on y² = f + h²/4, by y → y + h/2."""
    u, v = list(divisor[0]), list(divisor[1])
    return u, _sum(v, _remainder(half, u)) if half and v else v


# --- dense polynomials of fixed length: nothing is trimmed here
# -----------------------------------------------------------------


def _sum(a: Sequence[Number], b: Sequence[Number]) -> Coefficients:
    short, long = (a, b) if len(a) < len(b) else (b, a)
    return [x + y for x, y in zip(short, long, strict=False)] + list(long[len(short) :])


def _product(a: Sequence[Number], b: Sequence[Number]) -> Coefficients:
    if not a or not b:
        return []
    result = [0 * a[0]] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            result[i + j] += x * y
    return result


def _divmod(a: Sequence[Number], monic: Sequence[Number]) -> Pair:
    rest, m = list(a), len(monic) - 1
    for i in range(len(rest) - m - 1, -1, -1):
        lead = rest[i + m]
        for j in range(m):
            rest[i + j] -= lead * monic[j]
    return rest[m:], rest[:m]


def _remainder(a: Sequence[Number], monic: Sequence[Number]) -> Coefficients:
    """a mod u, of length deg u exactly."""
    rest = _divmod(a, monic)[1]
    return rest + [0 * monic[0]] * (len(monic) - 1 - len(rest))


def _cofactor(f: Sequence[Number], u: Sequence[Number], v: Sequence[Number]) -> Coefficients:
    """(f − v²)/u."""
    return _divmod(_sum(f, [-c for c in _product(v, v)]), u)[0]


def _size(a: Sequence[Number]) -> Number:
    return max((abs(c) for c in a), default=0)


def _absolute(a: Sequence[Number]) -> Coefficients:
    return [abs(c) for c in a]


def _bound(monic: Sequence[Number]) -> Coefficients:
    """The modulus by which remainders of absolute values bound the remainders modulo u: nothing cancels."""
    return [-abs(c) for c in monic[:-1]] + [abs(monic[-1])]


def _radius(monic: Sequence[Number]) -> Number:
    """The size of the roots of u, within a factor; 1 if all are 0."""
    m = len(monic) - 1
    return max((abs(c) ** (1 / (m - i)) for i, c in enumerate(monic[:-1])), default=0) or 1


def _size_at(a: Sequence[Number], radius: Number) -> Number:
    """The largest term at |x| = radius."""
    return max((abs(c) * radius**i for i, c in enumerate(a)), default=0)


# --- orthogonal linear algebra on a handful of rows
# -----------------------------------------------------------------------------


def _multiplication(factor: Sequence[Number], monic: Sequence[Number]) -> list[Coefficients]:
    """The matrix of c ↦ factor·c modulo u, on coefficients."""
    column = _remainder(factor, monic)
    columns = []
    for _ in column:
        columns.append(column)
        column = _remainder([0 * monic[0], *column], monic)
    return [list(row) for row in zip(*columns, strict=True)]


def _norm(values: Any) -> Number:
    return sum(abs(x) ** 2 for x in values) ** 0.5


def _reflect(columns: list[Coefficients], k: int) -> None:
    """The Householder reflection that clears column k below its diagonal, applied to columns k, k+1, …"""
    head = columns[k][k:]
    norm = _norm(head)
    if not norm:
        return
    head[0] += norm * (head[0] / abs(head[0]) if head[0] else 1)
    factor = 2 / sum(abs(x) ** 2 for x in head)
    for column in columns[k:]:
        overlap = factor * sum(_conjugate(x) * y for x, y in zip(head, column[k:], strict=True))
        for i, x in enumerate(head, k):
            column[i] -= overlap * x


def _conjugate(x: Number) -> Number:
    return x.conjugate()


def _pivoted_qr(columns: list[Coefficients]) -> tuple[list[int], list[Coefficients]]:
    """Column order and R (by columns) of a QR factorisation that takes the largest remaining column first."""
    columns = [list(column) for column in columns]
    order = list(range(len(columns)))
    for k in range(min(len(columns), len(columns[0]))):
        largest = max(range(k, len(columns)), key=lambda j: sum(abs(x) ** 2 for x in columns[j][k:]))
        columns[k], columns[largest] = columns[largest], columns[k]
        order[k], order[largest] = order[largest], order[k]
        _reflect(columns, k)
    return order, columns


def _null_vector(order: list[int], triangle: list[Coefficients]) -> Coefficients:
    """The vector that the numerically dependent last column of R gives, in the original order."""
    n = len(order)
    solution = _back_substitute(triangle[:-1], [-x for x in triangle[-1][: n - 1]])
    result = [*solution, 1 + 0 * triangle[-1][0]]
    return [result[order.index(j)] for j in range(n)]


def _least_squares(rows: list[Coefficients], right: Coefficients) -> Coefficients:
    columns = [list(column) for column in zip(*rows, strict=True)] + [list(right)]
    for k in range(len(columns) - 1):
        _reflect(columns, k)
    return _back_substitute(columns[:-1], columns[-1])


def _back_substitute(triangle: list[Coefficients], right: Coefficients) -> Coefficients:
    n = len(triangle)
    solution = list(right[:n])
    for k in range(n - 1, -1, -1):
        if not triangle[k][k]:
            raise PrecisionLoss("the divisors are too close to a special position for this precision; use more digits")
        solution[k] = (solution[k] - sum(triangle[j][k] * solution[j] for j in range(k + 1, n))) / triangle[k][k]
    return solution
