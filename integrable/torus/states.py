"""States anywhere on a torus, on bare reals for numba as they stand: a corner and two translations."""

from __future__ import annotations

from math import floor
from typing import Any

from integrable.moving_point.addition import carried
from integrable.torus.tables import point_in, small_translation
from integrable.torus.walks import IDENTITY
from jacobian.numbers.roots import root

Real = Any
Row = Any


def whole_turns(x: Real) -> tuple[Real, int]:
    """(fraction in [0, 1), whole turns) of x, |x| below 2^52."""
    whole = floor(float(x))
    rest = x - whole
    # the low part of a double-double may lead below 0
    if rest < 0:
        rest, whole = rest + 1, whole - 1
    return rest, whole


def state_at(torus: Any, first: Real, second: Real, turn1: int, turn2: int, out: Row, place: int) -> None:
    """γ and M at the phases (first, second) in [0, 1) after so many whole turns, into out[place … place + 5].

    The nearest corner, and two translations near the identity.
    """
    f, axes, matrix, states, tables, parts, centres, turns, sizes = torus
    rows, columns, terms = sizes
    i, j = floor(float(first) * rows + 0.5), floor(float(second) * columns + 0.5)
    a, b = first - i / rows, second - j / columns
    if i == rows:
        i, turn1 = 0, turn1 + 1
    if j == columns:
        j, turn2 = 0, turn2 + 1
    point = point_in(states, (i * columns + j) * 10)
    x, y = parts[0] * a + parts[1] * b, parts[2] * a + parts[3] * b
    # the translation has a pole at 0, where it is the identity
    if abs(x) > IDENTITY:
        point = carried(f, axes, point, small_translation(axes, centres[0], tables, 0, terms, x))
    if abs(y) > IDENTITY:
        point = carried(f, axes, point, small_translation(axes, centres[1], tables, 4 * terms, terms, y))
    s1, s2, s3, n1, n2, n3 = point[4], point[5], point[6], point[7], point[8], point[9]
    if turn1 % 2 != 0:
        s1, s2, s3, n1, n2, n3 = turned(turns[0], turns[1], turns[2], s1, s2, s3, n1, n2, n3)
    if turn2 % 2 != 0:
        s1, s2, s3, n1, n2, n3 = turned(turns[3], turns[4], turns[5], s1, s2, s3, n1, n2, n3)
    square = s1 * s1 + s2 * s2 + s3 * s3
    lean = (s1 * n1 + s2 * n2 + s3 * n3) / square
    scale = 1 / root(square)
    n1, n2, n3 = n1 - lean * s1, n2 - lean * s2, n3 - lean * s3
    s1, s2, s3 = s1 * scale, s2 * scale, s3 * scale
    m1, m2, m3 = n2 * s3 - n3 * s2, n3 * s1 - n1 * s3, n1 * s2 - n2 * s1
    p, q, r, s = matrix
    out[place] = float(p * s1 + q * m1)
    out[place + 1] = float(p * s2 + q * m2)
    out[place + 2] = float(p * s3 + q * m3)
    out[place + 3] = float(r * s1 + s * m1)
    out[place + 4] = float(r * s2 + s * m2)
    out[place + 5] = float(r * s3 + s * m3)


def turned(
    t1: float, t2: float, t3: float, s1: Real, s2: Real, s3: Real, n1: Real, n2: Real, n3: Real
) -> tuple[Real, Real, Real, Real, Real, Real]:
    """The pairs with the signs t."""
    return t1 * s1, t2 * s2, t3 * s3, t1 * n1, t2 * n2, t3 * n3


def states_at_phases(torus: Any, phases: Row, out: Row) -> None:
    """γ and M at pairs of phases in turns, one after the other in ``phases``: six floats each."""
    zero = 0 * torus[1][0]
    for i in range(len(phases) // 2):
        first, turn1 = whole_turns(phases[2 * i] + zero)
        second, turn2 = whole_turns(phases[2 * i + 1] + zero)
        state_at(torus, first, second, turn1, turn2, out, 6 * i)


def states_at_tau(torus: Any, frequencies: Any, tau: Row, out: Row) -> None:
    """γ and M at the times ``tau`` of the flow, six floats each; ``frequencies`` are turns in a unit of τ."""
    for i in range(len(tau)):
        first, turn1 = whole_turns(frequencies[0] * tau[i])
        second, turn2 = whole_turns(frequencies[1] * tau[i])
        state_at(torus, first, second, turn1, turn2, out, 6 * i)
