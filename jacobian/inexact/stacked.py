"""The stacked linear systems of inexact composition: one formula for generic, equal, near and opposite points.

Cantor's algorithm needs greatest common divisors, which do not exist in floats. Here the function q·y − p(x) that
vanishes on both divisors is found as the null vector of a stacked linear system, by orthogonal transformations:

    L·U ≡ q·(V' − V)  (mod U')      and      L·(V + V') ≡ q·W  (mod U'),      W = (f − V²)/U,    p = q·V + U·L.

The first congruence alone is the classical one; it loses all digits when D' = (U', V') approaches D = (U, V). The
second fails when D' approaches −D. Together, with q kept as an unknown, they determine p/q wherever the sum depends
continuously on the summands; q → 0 means that a point of D' meets the opposite of a point of D. The sum has U'' ∝
(p² − q²f)/(U·U'). V'' solves a system stacked in the same way, to which the equation of the curve is added. Each row is
divided by its rounding noise.

Sizes are compared directly, since :mod:`jacobian.inexact.composition` chooses units in which the points are at |x| ≤ 1
and f is of size 1. Numbers are those of a field, or have more bits. The argument ``field`` decides which numbers are
zero and which column is the largest. It is a :class:`jacobian.inexact.composition.Plain` or a
:class:`jacobian.inexact.decided.Pass`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from jacobian.errors import NotRepresentable, PrecisionLoss
from jacobian.inexact.dense import (
    Coefficients,
    Number,
    absolute,
    added,
    bound,
    divided,
    least_squares,
    multiplication,
    norm,
    null_vector,
    pivoted_qr,
    product,
    remainder,
    residue,
    size,
)

Pair = tuple[Coefficients, Coefficients]

# in p = q·V + U·L digits cancel if |p| < |U|; the remainder that :func:`compose` returns is at least ε|U|/(FEWER·|p|)
FEWER = 16

UNDETERMINED = "the digits of the summands do not determine their sum; use more digits"
_AT_INFINITY = (
    "the sum has a point at infinity, which inexact split models of even genus do not carry; use an exact field"
)


class Total(NamedTuple):
    """A sum (u, v), the function q·y − p(x) that vanishes on both summands and on the opposite of their sum, and the
    lean of the sum (:mod:`jacobian.inexact.at_infinity`).
    """

    u: Coefficients
    v: Coefficients
    p: Coefficients
    q: Number
    lean: int = 0


def compose(
    field: Any, genus: int, f: Sequence[Number], first: Pair, second: Pair, plus: complex | None = None
) -> tuple[Total, Number]:
    """The reduced sum of two pairs (u, v), neither of them (1, 0), on y² = f(x), and a remainder.

    The remainder is the largest one of the divisions that are exact but for rounding, relative to its terms. ``plus``
    is described in :class:`jacobian.inexact.at_infinity.Infinity`; without it NotRepresentable is raised where a point
    goes to infinity.
    """
    (u1, v1), (u2, v2) = first, second
    f, (w1, _), both = list(f), residue(f, u1, v1), product(u1, u2)
    slope, q = _interpolant(field, first, second, w1)
    p = added([q * c for c in v1], product(u1, slope))
    if len(both) - 1 <= genus and not field.is_zero(q, size(p), of_degree=False):
        v = [c / q for c in p]
        # the error of (L, q) is relative to the largest entry, so a small p has a large relative error
        return Total(both, v, p, q), max(departure(f, both, v), field.eps * size(u1) / (FEWER * (size(p) or 1)))
    p, q = _without_noise(field, f, p, q)
    u, rest, lean = _monic_quotient(field, f, p, q, both, plus)
    if len(u) == 1:
        return Total([field.one], [], p, q, lean), rest
    slope2, _ = divided(added(p, [-q * c for c in v2]), u2)
    summands = ((slope, v1, w1), (slope2, v2, residue(f, u2, v2)[0]))
    v = _second_polynomial(field, f, u, p, q, summands)
    # for either summand p is q·V + U·L, so it is accurate to the last bits of the larger of these terms
    terms = added(product(absolute(u1), absolute(slope)), [abs(q * c) for c in v1])
    terms = added(terms, added(product(absolute(u2), absolute(slope2)), [abs(q * c) for c in v2]))
    rest = max(rest, departure(f, u, v), _mismatch(u, v, p, q, terms))
    while len(u) - 1 > genus:
        u, v, more = _reduction_step(field, f, u, v, plus)
        lean += more
        rest = max(rest, departure(f, u, v))
    return Total(u, v, p, q, lean), rest


def _interpolant(field: Any, first: Pair, second: Pair, w1: Coefficients) -> tuple[Coefficients, Number]:
    """(L, q) of norm 1 with L·U ≡ q·(V' − V) and L·(V + V') ≡ q·W modulo U', W = (f − V²)/U = ``w1``."""
    (u1, v1), (u2, v2) = first, second
    m = len(u2) - 1
    trace, difference = added(v1, v2), added(v2, [-c for c in v1])
    noise1, noise2, modulus = absolute(u1), added(absolute(v1), absolute(v2)), bound(u2)
    rows, weights = [], []
    for factor, value, noise, value_noise in ((u1, difference, noise1, noise2), (trace, w1, noise2, absolute(w1))):
        # the size of the rows before cancellation
        weight = size(remainder(noise, modulus)) or 1
        weights.append(size(remainder(value_noise, modulus)) / weight)
        for row, right in zip(multiplication(factor, u2), remainder(value, u2), strict=True):
            rows.append([*(c / weight for c in row), -right / weight])
    unit = max(weights) or 1
    columns = [list(column) for column in zip(*[[*row[:m], row[m] / unit] for row in rows], strict=True)]
    order, triangle = pivoted_qr(columns, field.largest)
    free = sum(field.is_zero(triangle[k][k], 1, of_degree=False) for k in range(m))
    if free == m:
        raise PrecisionLoss(UNDETERMINED)
    if free:  # with free + 1 pairs of opposite points q = 0, and L vanishes at the other points of U'
        order, triangle = pivoted_qr(columns[: m - free], field.largest)
        solution = null_vector(order, triangle) + [field.zero] * (free + 1)
    else:
        solution = null_vector(order, triangle)
    solution = [*solution[:m], solution[m] / unit]
    length = norm(solution)
    return [x / length for x in solution[:m]], solution[m] / length


def _without_noise(field: Any, f: Coefficients, p: Coefficients, q: Number) -> tuple[Coefficients, Number]:
    """p and q with leading terms set to zero where they are rounding noise."""
    scale = max(size(p), abs(q) * size(f) ** 0.5)
    p = list(p)
    while 2 * len(p) - 1 > len(f) and field.is_zero(p[-1], scale):
        p.pop()
    if 2 * len(p) - 1 <= len(f) and field.is_zero(q * abs(f[-1]) ** 0.5, scale):
        q = field.zero
        while p and field.is_zero(p[-1], scale):
            p.pop()
        if not p:
            raise PrecisionLoss(UNDETERMINED)
    return p, q


def _monic_quotient(
    field: Any, f: Coefficients, p: Coefficients, q: Number, both: Coefficients, plus: complex | None
) -> tuple[Coefficients, Number, int]:
    """(p² − q²f)/(U·U') made monic, its relative remainder, and the lean (:class:`Total`); ``both`` is U·U'."""
    psi, lean = product(p, p), 0
    terms = size(psi)
    if q:
        cancels = len(psi) == len(f) and field.is_zero(psi[-1] - q * q * f[-1], abs(psi[-1]))
        psi = added(psi, [-q * q * c for c in f])
        if cancels:
            lean = _vanishing(field, psi, p[-1] / q, plus, terms)
    quotient, rest = divided(psi, both)
    return [c / quotient[-1] for c in quotient[:-1]] + [field.one], size(rest) / (terms or 1), lean


def _vanishing(field: Any, psi: Coefficients, lead: Number, plus: complex | None, scale: Number) -> int:
    """The change of the lean (:class:`Total`) by a function y − w that vanishes at infinity.

    ``lead`` is the leading coefficient of w. ``psi`` is proportional to w² − f, whose leading coefficients are zero;
    they are removed from ``psi``.
    """
    if plus is None:
        raise NotRepresentable(_AT_INFINITY)
    degree = len(psi)
    psi.pop()
    while psi and field.is_zero(psi[-1], scale):
        psi.pop()
    return len(psi) - degree if (lead * plus.conjugate()).real > 0 else degree - len(psi)


def _second_polynomial(
    field: Any,
    f: Coefficients,
    u: Coefficients,
    p: Coefficients,
    q: Number,
    summands: Sequence[tuple[Coefficients, ...]],
) -> Coefficients:
    """V'' from q·V'' ≡ −p, L·(V'' − V) ≡ −q·W for both ``summands`` (L, V, W), and V''² ≡ f, all modulo U''."""
    m = len(u) - 1
    rows: list[Coefficients] = []
    right: Coefficients = []
    modulus, unit = bound(u), size(f) ** 0.5

    def stack(factor: Coefficients, value: Coefficients, noise: Coefficients) -> None:
        # if U'' has the root 0, the value of ``factor`` there may be rounding noise: a row that consists of noise must
        # not be divided by a smaller number
        least = field.eps**0.5 * size(factor)
        weight = size(remainder(noise, modulus)) + unit * (size(remainder(absolute(factor), modulus)) + least) or 1
        for row, c in zip(multiplication(factor, u), remainder(value, u), strict=True):
            rows.append([x / weight for x in row])
            right.append(c / weight)

    stack([q], [-c for c in p], absolute(p))
    for slope, v, w in summands:
        noise = added(product(absolute(slope), absolute(v)), [abs(q * c) for c in w])
        stack(slope, added(product(slope, v), [-q * c for c in w]), noise)
    # these rows are smaller than the noise of the rows above; they select a small solution where opposite points leave
    # more than one
    small = field.eps / (unit or 1)
    rows.extend([small if i == j else field.zero for j in range(m)] for i in range(m))
    right.extend([field.zero] * m)
    solution = least_squares(rows, right)
    # if opposite points cancelled, only the curve determines the tangent at a multiple point of D + D'. Every round
    # doubles the order to which the tangent is known
    for _ in range(max(2, m.bit_length())):
        del rows[3 * m :], right[3 * m :]
        sizes = absolute(solution)
        stack(
            [2 * c for c in solution], added(f, product(solution, solution)), added(absolute(f), product(sizes, sizes))
        )
        solution = least_squares(rows, right)
    return solution


def _reduction_step(
    field: Any, f: Coefficients, u: Coefficients, v: Coefficients, plus: complex | None
) -> tuple[Coefficients, Coefficients, int]:
    """The pair after one step of Cantor's reduction (u, v) → ((f − v²)/u, −v), and the change of its lean
    (:mod:`jacobian.inexact.at_infinity`).
    """
    scale = max(size(v), size(f) ** 0.5)
    v = list(v)
    while v and field.is_zero(v[-1], scale):
        v.pop()
    psi, lean = added(f, [-c for c in product(v, v)]), 0
    if 2 * len(v) - 1 == len(f) and field.is_zero(f[-1] - v[-1] * v[-1], abs(f[-1])):
        lean = _vanishing(field, psi, v[-1], plus, scale**2)
    quotient, _ = divided(psi, u)
    if len(quotient) >= len(u):
        raise NotRepresentable(_AT_INFINITY)
    u = [c / quotient[-1] for c in quotient[:-1]] + [field.one]
    return u, remainder([-c for c in v], u), lean


def departure(f: Coefficients, u: Coefficients, v: Coefficients) -> Number:
    """The largest coefficient of f − v² mod u, relative to the size of its terms."""
    sizes = absolute(v)
    return _relative(residue(f, u, v)[1], added(absolute(f), product(sizes, sizes)), u)


def _mismatch(u: Coefficients, v: Coefficients, p: Coefficients, q: Number, terms: Coefficients) -> Number:
    """The largest coefficient of p + q·v mod u, relative to the size of its terms; ``terms`` are those of p."""
    return _relative(remainder(added(p, [q * c for c in v]), u), added(terms, [abs(q * c) for c in v]), u)


def _relative(rest: Coefficients, terms: Coefficients, u: Coefficients) -> Number:
    """The largest |rest_i|/b_i, where b_i ≥ 0 bounds the coefficient of x^i in ``terms`` modulo u. A b_i below 2^−20 of
    the largest bound is replaced by this fraction.
    """
    terms = remainder(terms, bound(u))
    least = max(terms, default=0) / 2**20
    return max((abs(c) / max(t, least) for c, t in zip(rest, terms, strict=False)), default=0) if least else 0
