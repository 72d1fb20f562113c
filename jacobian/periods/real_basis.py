"""The data of theta functions on the real torus of a curve y² = f(x) of degree 5, in long numbers: the periods in a
symplectic basis with real a-cycles, and the odd characteristics that belong to the branch points.

Paths go straight from branch point to branch point. Sheets are chosen so that τ is symmetric with Im τ > 0. Let
∫_{r₀}^{r_i} = Ap + Bq for the branch points r_i; the entries of 2p and 2q are integers. Exactly one of the 16
characteristics η₀ makes all η₀ + 2(q, p) odd (Mumford 1984).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import combinations, product
from math import gcd
from typing import Any, NamedTuple

from jacobian.element import Complex
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.periods.paths import Vector, along

Matrix = tuple[Vector, Vector]
Whole = tuple[int, int, int, int]

# the relative asymmetry up to which τ counts as symmetric, in long numbers and in floats
NEARLY, NEARLY_IN_FLOATS = 1e-22, 1e-6


class Periods(NamedTuple):
    """``cycles``: a₁, a₂, b₁, b₂ as vectors of integrals of (dx/y, x dx/y); ``halves``: the integrals from the first
    root to every branch point, the last of which is infinity.
    """

    cycles: list[Vector]
    halves: list[Vector]


def half_integrals(Z: LongField, roots: list[Complex], lead: Complex) -> Periods:
    """The cycles and half-periods of the curve with five ``roots``, ordered as the vertices of a simple polygon."""
    sides = [along(Z, roots, lead, k) for k in range(4)]
    for signs in product((1, -1), repeat=3):
        cycles = cycles_of(sides, signs)
        # a test in floats rules out most choices of signs at less cost
        if not symmetric(ratio(rough(cycles)), NEARLY_IN_FLOATS):
            continue
        tau = ratio(cycles)
        if not symmetric(tau, NEARLY):
            continue
        if tau[0][0].imag < 0:
            cycles[:2] = [(-x, -y) for x, y in cycles[:2]]
            tau = ratio(cycles)
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


def cycles_of(sides: Sequence[Vector], signs: Sequence[int]) -> list[Vector]:
    """The periods of a₁, a₂, b₁, b₂ from the integrals along four ``sides`` of the polygon in :func:`half_integrals`.
    ``signs`` are those of y on the sides after the first.
    """
    a, b, c, d = ((2 * s * x, 2 * s * y) for s, (x, y) in zip((1, *signs), sides, strict=True))
    return [a, (a[0] + c[0], a[1] + c[1]), b, d]


def symmetric(tau: Matrix, nearly: float) -> bool:
    return bool(abs(tau[0][1] - tau[1][0]) <= nearly * (1 + abs(tau[0][1])))


def rough(vectors: Sequence[Vector]) -> list[tuple[Any, Any]]:
    return [(complex(x), complex(y)) for x, y in vectors]


def solved(columns: Sequence[Vector], w: Vector) -> Vector:
    """The solution x of Σ x_k·column_k = w for two columns."""
    (a, c), (b, d) = columns
    area = a * d - b * c
    return (w[0] * d - w[1] * b) / area, (w[1] * a - w[0] * c) / area


def ratio(cycles: Sequence[Vector]) -> Matrix:
    """The matrix τ = A⁻¹B of the periods."""
    first, second = (solved(cycles[:2], w) for w in cycles[2:])
    return (first[0], second[0]), (first[1], second[1])


def coordinates(cycles: Sequence[Vector], tau: Matrix, vectors: Sequence[Vector]) -> list[tuple[Any, Any, Any, Any]]:
    """The real (p₁, p₂, q₁, q₂) with Ap + Bq = w for each vector w; ``cycles``: columns of A and B, ``tau``: A⁻¹B."""
    (t11, t12), (_, t22) = tau
    area = t11.imag * t22.imag - t12.imag**2
    found = []
    for w in vectors:
        z1, z2 = solved(cycles[:2], w)
        q1 = (z1.imag * t22.imag - z2.imag * t12.imag) / area
        q2 = (z2.imag * t11.imag - z1.imag * t12.imag) / area
        found.append((z1.real - t11.real * q1 - t12.real * q2, z2.real - t12.real * q1 - t22.real * q2, q1, q2))
    return found


def combined(whole: Whole, cycles: Sequence[Vector]) -> Vector:
    """The periods of the cycle Σ n_k·cycle_k, n = ``whole``."""
    x, y = (sum(n * c[k] for n, c in zip(whole, cycles, strict=True)) for k in (0, 1))
    return x, y


def crossing(u: Whole, v: Whole) -> int:
    """The intersection number of two cycles, given by their coordinates in a symplectic basis."""
    return u[0] * v[2] + u[1] * v[3] - u[2] * v[0] - u[3] * v[1]


def real_basis(found: Periods) -> Periods:
    """The periods in a symplectic basis with A real, Im τ reduced (Minkowski) and Re τ in {0, ½}."""
    cycles = rough(found.cycles)
    conjugates = coordinates(cycles, ratio(cycles), [(x.conjugate(), y.conjugate()) for x, y in cycles])
    a1, a2, b1, b2 = ((round(a), round(b), round(c), round(d)) for a, b, c, d in conjugates)
    return reduced(Periods([combined(v, found.cycles) for v in real_cycles((a1, a2, b1, b2))], found.halves))


@cache
def real_cycles(rows: tuple[Whole, Whole, Whole, Whole]) -> tuple[Whole, Whole, Whole, Whole]:
    """A symplectic basis with real a₁, a₂, each cycle as its coordinates in a given symplectic basis.

    ``rows``: the coordinates of the complex conjugates of the cycles of the given basis.
    """
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
            return a1, a2, b1, b2
    raise PrecisionLoss("the real periods of this curve were not found")


def reduced(found: Periods) -> Periods:
    """The same periods in a basis with 2|Y₁₂| ≤ Y₁₁ ≤ Y₂₂, Y = Im τ."""
    a1, a2, b1, b2 = found.cycles
    while True:
        tau = ratio(rough((a1, a2, b1, b2)))
        y11, y12, y22 = (x.imag for x in (tau[0][0], tau[0][1], tau[1][1]))
        turns = round(y12 / y11)
        if y22 < y11 * (1 - 1e-9):
            a1, a2, b1, b2 = a2, a1, b2, b1
        elif turns:
            # A → AU, B → BU⁻ᵀ, U = (1 0; turns 1)
            a1 = a1[0] + turns * a2[0], a1[1] + turns * a2[1]
            b2 = b2[0] - turns * b1[0], b2[1] - turns * b1[1]
        else:
            break
    shifts = [[int((x.real + 0.25) // 1) for x in row] for row in tau]
    b1, b2 = (
        (b[0] - m * a1[0] - n * a2[0], b[1] - m * a1[1] - n * a2[1])
        for b, m, n in ((b1, shifts[0][0], shifts[1][0]), (b2, shifts[0][1], shifts[1][1]))
    )
    return Periods([a1, a2, b1, b2], found.halves)


def characteristics(found: Periods) -> list[Whole]:
    """The odd characteristics (ε₁, ε₂, δ₁, δ₂) = η₀ + 2(q, p) modulo 2 of the branch points, whose half-periods are
    Ap + Bq. η₀ is the same for all.
    """
    cycles = rough(found.cycles)
    bits = [[round(2 * x) % 2 for x in row] for row in coordinates(cycles, ratio(cycles), rough(found.halves))]
    for e1, e2, d1, d2 in product((0, 1), repeat=4):
        chars = [((e1 + q1) % 2, (e2 + q2) % 2, (d1 + p1) % 2, (d2 + p2) % 2) for p1, p2, q1, q2 in bits]
        if all((a * c + b * d) % 2 for a, b, c, d in chars):
            return chars
    raise PrecisionLoss("the characteristics of this curve's branch points were not found")
