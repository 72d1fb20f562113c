"""States at any point of a torus, from a corner by two translations; on bare reals, compiled or interpreted."""

from __future__ import annotations

from math import floor
from typing import NamedTuple

from integrable.moving_point.addition import Real, Row, carried, moving_point
from integrable.phase.coordinates import directions_of
from integrable.torus.tables import SmallSteps, four, small_in_tuples, small_translation
from integrable.torus.walks import IDENTITY, Curve, in_tuples
from jacobian.numbers.abreast import abreast


class Torus(NamedTuple):
    """The data from which states are computed: the moving points at the corners of the cells, ten numbers each, and the
    translations inside a cell. ``matrix`` is (p, q, r, s) with γ = pγ̃ + q·w̃×γ̃ and M = rγ̃ + s·w̃×γ̃, where γ̃ is that
    of the upright body and w̃ = γ̃×M̃/|M̃|. ``turns`` are the factors ±1 of σ1, σ2, σ3 over each period; ``cells`` is
    (rows, columns).
    """

    curve: Curve
    matrix: Row
    states: Row
    small: SmallSteps
    turns: Row
    cells: tuple[int, int]


def torus_in_tuples(torus: Torus) -> Torus:
    """The torus with tuples for rows, whose numbers compiled loops then hold in registers."""
    small = small_in_tuples(torus.small)
    return Torus(in_tuples(torus.curve), four(torus.matrix), torus.states, small, torus.turns, torus.cells)


def whole_turns(x: Real) -> tuple[Real, int]:
    """(fraction in [0, 1), whole turns) of x, |x| below 2^52."""
    whole = floor(float(x))
    rest = x - whole
    # x is below ``whole`` if the low part of a double-double is negative
    if rest < 0:
        rest, whole = rest + 1, whole - 1
    return rest, whole


def state_at(torus: Torus, first: Real, second: Real, turn1: int, turn2: int, out: Row, place: int) -> None:
    """Writes γ and M at the phases (first, second) in [0, 1) after ``turn1`` and ``turn2`` whole turns to
    out[place … place + 5].
    """
    put_state(point_at(torus, first, second, turn1, turn2), torus.matrix, out, place)


def put_state(point: Row, matrix: Row, out: Row, place: int) -> None:
    """Writes γ and M of a moving point to out[place … place + 5]; ``matrix`` is that of :class:`Torus`."""
    gamma, M = directions_of(point)
    p, q, r, s = matrix
    for c in range(3):
        out[place + c] = float(p * gamma[c] + q * M[c])
        out[place + 3 + c] = float(r * gamma[c] + s * M[c])


def point_at(torus: Torus, first: Real, second: Real, turn1: int, turn2: int) -> Row:
    """The moving point at these phases, from the nearest corner."""
    i, j = floor(float(first) * torus.cells[0] + 0.5), floor(float(second) * torus.cells[1] + 0.5)
    return point_beside(torus, (i, j), first, second, turn1, turn2)


def point_beside(torus: Torus, corner: tuple[int, int], first: Real, second: Real, turn1: int, turn2: int) -> Row:
    """The moving point at these phases, from ``corner`` = (row, column), by two translations near the identity."""
    (rows, columns), parts, (i, j) = torus.cells, torus.small.parts, corner
    a, b = first - i / rows, second - j / columns
    if i == rows:
        i, turn1 = 0, turn1 + 1
    if j == columns:
        j, turn2 = 0, turn2 + 1
    point = moving_point(torus.states, (i * columns + j) * 10)
    x, y = parts[0] * a + parts[1] * b, parts[2] * a + parts[3] * b
    # the series of a translation has a pole at 0, where the translation is the identity
    if abs(x) > IDENTITY:
        point = carried(torus.curve.f, torus.curve.axes, point, small_translation(torus.small, 0, x))
    if abs(y) > IDENTITY:
        point = carried(torus.curve.f, torus.curve.axes, point, small_translation(torus.small, 1, y))
    if turn1 % 2 != 0:
        point = turned(point, torus.turns, 0)
    if turn2 % 2 != 0:
        point = turned(point, torus.turns, 3)
    return point


def turned(point: Row, turns: Row, first: int) -> Row:
    """The point with its pairs multiplied by the signs turns[first … first + 2]."""
    t1, t2, t3 = turns[first], turns[first + 1], turns[first + 2]
    return (
        point[0],
        point[1],
        point[2],
        point[3],
        t1 * point[4],
        t2 * point[5],
        t3 * point[6],
        t1 * point[7],
        t2 * point[8],
        t3 * point[9],
    )


def states_at_phases(torus: Torus, phases: Row, out: Row) -> None:
    """Writes γ and M, six floats each, at the pairs of phases in ``phases``, in turns."""
    near, zero = torus_in_tuples(torus), 0 * torus.curve.axes[0]
    for i in abreast(0, len(phases) // 2):
        first, turn1 = whole_turns(phases[2 * i] + zero)
        second, turn2 = whole_turns(phases[2 * i + 1] + zero)
        state_at(near, first, second, turn1, turn2, out, 6 * i)


def states_at_tau(torus: Torus, frequencies: Row, tau: Row, out: Row) -> None:
    """Writes γ and M, six floats each, at values of τ; ``frequencies`` are the turns of both phases per unit of τ."""
    near = torus_in_tuples(torus)
    for i in abreast(0, len(tau)):
        first, turn1 = whole_turns(frequencies[0] * tau[i])
        second, turn2 = whole_turns(frequencies[1] * tau[i])
        state_at(near, first, second, turn1, turn2, out, 6 * i)
