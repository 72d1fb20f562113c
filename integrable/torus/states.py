"""States of the ball and the top at any point of their torus, from three theta functions; on bare reals, compiled or
interpreted.

In the unit max a, component i of γ̃ and w̃ belongs to the branch point α_i = a_i/max a, and d stands for d·max a:

    γ̃_i ∝ C_iθ_i(φ),   w̃ = γ̃ × M̃/|M̃| ∝ −C_i∂θ_i(φ) less its part along γ̃,   C_i⁴ = |α_i − ζ|/((1 − dα_i)Π|α_i − α_j|)

where θ_i is the theta function of α_i, ∂ is the derivative in the direction (0, 1), and ζ = H1/(H2·max a) (Thomae;
Mumford 1984). γ̃ and M̃ belong to the upright body, so that (γ̃, M̃) = 0.
"""

from __future__ import annotations

from math import floor
from typing import NamedTuple

from integrable.moving_point.addition import Real, Row
from integrable.torus.lifts import AROUND, CHECKED, Torus, frame_at, most_strayed, put_around
from jacobian.numbers.abreast import abreast
from jacobian.numbers.roots import root


class BodyStates(NamedTuple):
    """The data from which states are computed: the torus, and a ``matrix`` (p, q, r, s) with γ = pγ̃ + q·w̃×γ̃ and
    M = rγ̃ + s·w̃×γ̃. The vectors γ̃ and w̃ are defined in :mod:`integrable.torus.states`.
    """

    torus: Torus
    matrix: Row


def third_of(frame: Row) -> tuple[Real, Real, Real]:
    """M̃/|M̃| = w̃ × γ̃ from the ``frame`` (γ̃, w̃)."""
    x, y, z, p, q, s = frame
    return q * z - s * y, s * x - p * z, p * y - q * x


def whole_turns(x: Real) -> tuple[Real, int]:
    """(fraction in [0, 1), whole turns) of x, |x| below 2^52."""
    whole = floor(float(x))
    rest = x - whole
    # x is below ``whole`` if the low part of a double-double is negative
    if rest < 0:
        rest, whole = rest + 1, whole - 1
    return rest, whole


def state_at(body: BodyStates, first: Real, second: Real, out: Row, place: int) -> None:
    """Writes γ and M to out[place … place + 5]. ``first`` and ``second`` are the phases, in turns since the start."""
    matrix = body.matrix
    p, q, r, s = matrix[0], matrix[1], matrix[2], matrix[3]
    (first, turn1), (second, turn2) = whole_turns(first), whole_turns(second)
    frame = frame_at(body.torus, first + turn1 % 2, second + turn2 % 2)
    third = third_of(frame)
    for c in range(3):
        out[place + c] = float(p * frame[c] + q * third[c])
        out[place + 3 + c] = float(r * frame[c] + s * third[c])


def states_at(body: BodyStates, phases: Row, out: Row) -> None:
    """Writes γ and M, six floats for each pair of ``phases``, which are in turns since the start."""
    zero = 0 * body.matrix[0]
    for i in abreast(0, len(phases) // 2):
        state_at(body, phases[2 * i] + zero, phases[2 * i + 1] + zero, out, 6 * i)


def phases_at(rates: Row, tau: Row, out: Row) -> None:
    """Writes both phases at values of τ, in turns since the start, modulo 2; ``rates`` begins with the turns of both
    phases per unit of τ.
    """
    for i in abreast(0, len(tau)):
        first, turn1 = whole_turns(rates[0] * tau[i])
        second, turn2 = whole_turns(rates[1] * tau[i])
        out[2 * i], out[2 * i + 1] = first + turn1 % 2, second + turn2 % 2


def strayed(body: BodyStates, motion: Row, frequencies: Row, room: Row, out: Row) -> None:
    """Compares the states with the equations of motion by :func:`integrable.torus.lifts.most_strayed`. ``motion`` is a
    :func:`integrable.torus.lattice.motion_row`, ``frequencies`` are turns of the phases per unit of its time.
    """
    right = room[6 * AROUND * CHECKED :]
    put_around(body.torus, frequencies, room)
    for n in abreast(0, CHECKED):
        at, to = 6 * AROUND * n, 6 * n
        x, y, z, p, q, s = room[at], room[at + 2], room[at + 4], room[at + 1], room[at + 3], room[at + 5]
        u, v, w = third_of((x, y, z, p, q, s))
        dx, dy, dz, du, dv, dw = velocity(motion, (x, y, z, p, q, s))
        right[to], right[to + 2], right[to + 4] = dx, dy, dz
        # the derivative of w̃ = γ̃ × M̃/|M̃|
        right[to + 1] = dy * w - dz * v + y * dw - z * dv
        right[to + 3] = dz * u - dx * w + z * du - x * dw
        right[to + 5] = dx * v - dy * u + x * dv - y * du
    most_strayed(frequencies, 6, room, right, out)


def velocity(motion: Row, frame: Row) -> Row:
    """The derivatives of γ̃ and M̃/|M̃| with respect to the time of ``motion``, a
    :func:`integrable.torus.lattice.motion_row`.
    """
    x, y, z, _, _, _ = frame
    u, v, w = third_of(frame)
    d, r, origin = motion[8], motion[10], motion[11]
    a, b, c = motion[4], motion[5], motion[6]
    square = (r - d * a) * x * x + (r - d * b) * y * y + (r - d * c) * z * z
    a, b, c = origin + a, origin + b, origin + c
    pull = d * (a * x * u + b * y * v + c * z * w) / square
    half = root(square) / 2
    a, b, c = half * a * (u + pull * x), half * b * (v + pull * y), half * c * (w + pull * z)
    return y * c - z * b, z * a - x * c, x * b - y * a, v * c - w * b, w * a - u * c, u * b - v * a
