"""Integrals of dx/y and x dx/y along straight paths between branch points of y² = f(x), deg f = 5, and to other points.

A compiled loop sums an integrand over the nodes of a quadrature rule in double-doubles. With x = a + (b − a)v on a path
from a to b, the rule is a Gauss rule in v, or in √v if b is no branch point. Where real branch points nearly meet, it
is the trapezoidal rule in log(v/(1 − v)).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from math import ceil
from typing import NamedTuple

import numpy as np

from jacobian.element import Complex, Real
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.native.kinds import INTS, WIDES
from jacobian.native.library import Library
from jacobian.numbers.double_double import double_double_row
from jacobian.numbers.long_reals import BallReals
from jacobian.numbers.roots import root
from jacobian.periods.quadrature import ellipse

Row = np.ndarray
Vector = tuple[Complex, Complex]

# digits of integrals
DIGITS = 33
# largest number of nodes of a Gauss rule: if more are needed, branch points nearly meet. If all branch points are real,
# the trapezoidal rule, one table for all paths, replaces Gauss rules of more than MOST_NODES_IF_REAL nodes
MOST_NODES, MOST_NODES_IF_REAL = 2400, 400
# number of nodes of the trapezoidal rule on either side of the middle of a path, SPACING apart in log(v/(1 − v)). Its
# error is e^(−2π²/SPACING) = 5e-35. Omitting the ends adds e^(−NODES·SPACING/2) = 5e-55, or 1e-33 if a branch point
# lies at a distance of 1e-42 from an end
NODES, SPACING = 1000, 0.25
# below this distance of a point x from a branch point, relative to |x|, x counts as the branch point
NEAR = 2.0**-140
# bits of the nodes of quadrature rules
BITS = 180


def along(Z: LongField, roots: Sequence[Complex], lead: Complex, k: int) -> Vector:
    """∫(dx/y, x dx/y) along the straight path from root k to the next one."""
    a, b = roots[k : k + 2]
    middle, half = (a + b) / 2, (b - a) / 2
    others = [r for i, r in enumerate(roots) if i not in (k, k + 1)]
    path = straight(Z, a, b, others)
    count = nodes_needed([(r - middle) / half for r in others])
    zeroth, first = path_integrals(path, logistic_rule(False) if path.graded(count) else chebyshev_rule(count))
    # √((x − a)(x − b)) = ±i(b − a)√(v(1 − v)) and dx = (b − a)dv, hence the factor i
    factor = Z.sqrt(Z.coerce(lead)) * Z.coerce(1j) * path.factor
    return zeroth / factor, (a * zeroth + (b - a) * first) / factor


def image(Z: LongField, roots: list[Complex], lead: Complex, halves: list[Vector], pair: Sequence[Complex]) -> Vector:
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


def to_point(Z: LongField, roots: list[Complex], lead: Complex, halves: list[Vector], point: Vector) -> Vector:
    """The integrals from the first root to a point (x₁, y₁), modulo periods.

    The path goes straight from the root r from which it needs the fewest nodes. If a Gauss rule is used, it is one in
    the variable √(x − r).
    """
    (x1, y1), rules = point, []
    for k, r in enumerate(roots):
        if abs(x1 - r) <= NEAR * abs(x1):
            return halves[k]
        rules.append((nodes_needed([Z.sqrt((e - r) / (x1 - r)) for i, e in enumerate(roots) if i != k]), k))
    count, k = min(rules)
    r, others = roots[k], [e for i, e in enumerate(roots) if i != k]
    path = straight(Z, r, x1, others)
    first, second = path_integrals(path, logistic_rule(True) if path.graded(count) else legendre_rule(count))
    factor = Z.sqrt(Z.coerce(lead)) * Z.sqrt(x1 - r) * path.factor
    end = factor
    for near, e in zip(path.ends, others, strict=True):
        end *= Z.sqrt((x1 - e) / (near - e))
    # y, continued along the path, ends at y1 or at −y1, which decides the sign
    scale = (1 if abs(end - y1) < abs(end + y1) else -1) * (x1 - r) / factor
    return halves[k][0] + first * scale, halves[k][1] + (r * first + (x1 - r) * second) * scale


class StraightPath(NamedTuple):
    """A straight path from a to b. For each other branch point e, ``ends`` has the end nearer to e, and ``sides``
    whether it is b; ``poles`` has (other end − end)/(end − e). ``factor`` is Π√(end − e).
    """

    ends: list[Complex]
    sides: list[int]
    poles: list[Complex]
    factor: Complex

    def graded(self, count: int) -> bool:
        """Whether the trapezoidal rule is used rather than a Gauss rule of ``count`` nodes."""
        if count > MOST_NODES_IF_REAL and not any(q.imag for q in self.poles):
            return True
        if count > MOST_NODES:
            raise PrecisionLoss("branch points are too near to each other")
        return False


def straight(Z: LongField, a: Complex, b: Complex, others: Sequence[Complex]) -> StraightPath:
    """The :class:`StraightPath` from a to b; ``others`` are the other branch points."""
    sides = [int(abs(b - e) < abs(a - e)) for e in others]
    ends = [b if side else a for side in sides]
    factor, poles = Z.one, []
    for side, end, e in zip(sides, ends, others, strict=True):
        poles.append((a - b if side else b - a) / (end - e))
        factor *= Z.sqrt(end - e)
    return StraightPath(ends, sides, poles, factor)


def path_integrals(path: StraightPath, rule: Row) -> tuple[Complex, Complex]:
    """∫dμ/w and ∫v dμ/w for the measure dμ of a rule, where x = a + (b − a)v and w = Π√((x − e)/(end − e)) over the
    other branch points e; ``end`` is the end of the path nearer to e.
    """
    import gmpy2

    poles = double_double_row(x for q in path.poles for x in (q.real, q.imag))
    out = np.empty((4, 2))
    LIBRARY.path_sums(rule, poles, np.array(path.sides), out)
    zeroth, first = (
        gmpy2.mpc(x, y) + gmpy2.mpc(x_low, y_low) for (x, x_low), (y, y_low) in out.reshape(2, 2, 2).tolist()
    )
    return zeroth, first


def path_sums(rule: Row, poles: Row, sides: Row, out: Row) -> None:
    """Writes the sums of weight/w and v·weight/w over the nodes of a rule, w = Π√(1 + sq) over the poles q.

    ``rule`` has v, 1 − v and the weight of each node; ``poles`` has the real and imaginary parts of the q. s is v where
    the item of ``sides`` is 0, and 1 − v where it is 1.
    """
    zero = 0 * rule[0]
    a, b, c, d = zero, zero, zero, zero
    for n in range(len(rule) // 3):
        v, x, y = rule[3 * n], 1 + zero, zero
        for k in range(len(sides)):
            s = rule[3 * n + sides[k]]
            p, q = complex_root(1 + s * poles[2 * k], s * poles[2 * k + 1])
            x, y = x * p - y * q, x * q + y * p
        over = rule[3 * n + 2] / (x * x + y * y)
        x, y = x * over, -(y * over)
        a, b, c, d = a + x, b + y, c + v * x, d + v * y
    out[0], out[1], out[2], out[3] = a, b, c, d


def complex_root(x: Real, y: Real) -> tuple[Real, Real]:
    """The principal square root of x + iy."""
    if y == 0 and x > 0:
        return root(x), y
    size = root(x * x + y * y)
    if x > 0:
        first = root((size + x) / 2)
        return first, y / (2 * first)
    second = root((size - x) / 2)
    first = abs(y) / (2 * second)
    if y > 0:
        return first, second
    return first, -second


LIBRARY = Library("path_sums", {"path_sums": (path_sums, (WIDES, WIDES, INTS, WIDES))})


def nodes_needed(poles: Sequence[Complex]) -> int:
    """The number of nodes, a multiple of 8, of a Gauss rule on [−1, 1] for an integrand singular at the ``poles``."""
    digits = min(ellipse(complex(pole)) for pole in poles)
    count = ceil(DIGITS / (2 * max(digits, 1e-9))) + 6
    return count + -count % 8


def rule_of(nodes: Iterable[tuple[Complex, Complex, Complex]]) -> Row:
    """The array in double-doubles of a rule with these (v, 1 − v, weight)."""
    return double_double_row(x for row in nodes for x in row)


@cache
def chebyshev_rule(count: int) -> Row:
    """Gauss's rule for dv/√(v(1 − v)) on [0, 1]."""
    import gmpy2

    with LongField(BITS) as N:
        pi = gmpy2.const_pi()
        cosines = [gmpy2.cos(pi * (2 * n + 1) / (2 * count)) for n in range(count)]
        return rule_of(((1 + c) / 2, (1 - c) / 2, N.coerce(pi / count)) for c in cosines)


@cache
def legendre_rule(count: int) -> Row:
    """The Gauss–Legendre rule in t on [−1, 1], v = t², as a rule for dv/√v = 2dt on [0, 1]; ``count`` is even."""
    from flint import arb

    with BallReals(BITS + 20):
        found = [arb.legendre_p_root(count, k, weight=True) for k in range(count // 2)]
    with LongField(BITS) as N:
        pairs = [(N.from_ball(x) ** 2, 2 * N.from_ball(w)) for x, w in found]
        return rule_of((v, 1 - v, w) for v, w in pairs)


@cache
def logistic_rule(regular: bool) -> Row:
    """The trapezoidal rule in t = log(v/(1 − v)), for dv/√(v(1 − v)), or for dv/√v if ``regular``.

    If all branch points are real and outside [0, 1], the nearest singularities in t are ±iπ. So the accuracy does not
    depend on how near the branch points are to [0, 1].
    """
    import gmpy2

    with LongField(BITS) as N:
        rows = []
        for n in range(-NODES, NODES + 1):
            s = gmpy2.exp(N.coerce(n * SPACING))
            v, rest = s / (1 + s), 1 / (1 + s)
            rows.append((v, rest, SPACING * N.sqrt(v) * (rest if regular else N.sqrt(rest))))
        return rule_of(rows)
