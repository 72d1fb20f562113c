"""States of the ball and the top at any point of their torus, from three theta functions; on bare reals, compiled or
interpreted.

At the axis α_i

    γ̃_i ∝ C_iθ_i(φ),   w̃ = γ̃ × M̃/|M̃| ∝ −C_i∂θ_i(φ) less its part along γ̃,   C_i⁴ = |α_i − ζ|/((1 − dα_i)Π|α_i − α_j|)

where θ_i is the theta function of the branch point α_i, ∂ the derivative in the direction (0, 1) and
ζ = H1/(H2·max a) (Thomae; Mumford 1984). γ̃ and M̃ are those of the upright body, (γ̃, M̃) = 0.
"""

from __future__ import annotations

from math import floor
from typing import NamedTuple

from integrable.moving_point.addition import Real, Row
from integrable.torus.theta_series import ThetaSums, circle, is_odd, row_sums, theta
from jacobian.numbers.abreast import abreast
from jacobian.numbers.roots import root
from jacobian.numbers.sums import joined, plus_product

# positions in ``numbers`` of a :class:`Torus`, after the matrix: the phases of the start in turns, the factors of the
# theta functions, r − dα_i (:func:`integrable.torus.lattice.motion_row`), α and β of the tilt term of 1/g, and
# α_k − α_j for cyclic (i, j, k)
PLACES, FACTORS, CONTACT, TILT, GAPS, NUMBERS = 4, 6, 9, 12, 14, 17
# number of columns of a grid whose sums are computed together, so that they stay in a cache
TOGETHER = 64
# number of points at which the equations of motion are checked, and the largest step of a phase there, in turns: the
# error of the quotients of differences is about the fourth power of 2π·STEP times the highest harmonic
CHECKED, STEP = 8, 2.0**-24


class Torus(NamedTuple):
    """The data from which states are computed: the theta functions of the three axes, and ``numbers``, whose first
    four are a matrix (p, q, r, s) with γ = pγ̃ + q·w̃×γ̃ and M = rγ̃ + s·w̃×γ̃.
    """

    sums: ThetaSums
    numbers: Row


def frame_at(torus: Torus, first: Real, second: Real) -> Row:
    """(γ̃, w̃) at phases in turns from the start, below 2: larger phases would lose digits."""
    sums, numbers = torus.sums, torus.numbers
    one = circle((first + numbers[PLACES]) / 2, sums.inverse)
    two = circle((second + numbers[PLACES + 1]) / 2, sums.inverse)
    x, p = theta(sums, 0, one, two)
    y, q = theta(sums, 1, one, two)
    z, s = theta(sums, 2, one, two)
    return frame_from(numbers, (x, y, z), (p, q, s))


def frame_from(numbers: Row, values: Row, slopes: Row) -> Row:
    """(γ̃, w̃) from the theta functions and their derivatives."""
    a, b, c = numbers[FACTORS], numbers[FACTORS + 1], numbers[FACTORS + 2]
    x, y, z = a * values[0], b * values[1], c * values[2]
    p, q, s = a * slopes[0], b * slopes[1], c * slopes[2]
    size = 1 / root(x * x + y * y + z * z)
    x, y, z = x * size, y * size, z * size
    lean = x * p + y * q + z * s
    p, q, s = lean * x - p, lean * y - q, lean * z - s
    size = 1 / root(p * p + q * q + s * s)
    return x, y, z, p * size, q * size, s * size


def third_of(frame: Row) -> tuple[Real, Real, Real]:
    """M̃/|M̃| = w̃ × γ̃."""
    x, y, z, p, q, s = frame
    return q * z - s * y, s * x - p * z, p * y - q * x


def state_at(torus: Torus, first: Real, second: Real, turn1: int, turn2: int, out: Row, place: int) -> None:
    """Writes γ and M at the phases (first, second) in [0, 1) after ``turn1`` and ``turn2`` whole turns to
    out[place … place + 5].
    """
    frame = frame_at(torus, first + turn1 % 2, second + turn2 % 2)
    third = third_of(frame)
    p, q, r, s = torus.numbers[0], torus.numbers[1], torus.numbers[2], torus.numbers[3]
    for c in range(3):
        out[place + c] = float(p * frame[c] + q * third[c])
        out[place + 3 + c] = float(r * frame[c] + s * third[c])


def whole_turns(x: Real) -> tuple[Real, int]:
    """(fraction in [0, 1), whole turns) of x, |x| below 2^52."""
    whole = floor(float(x))
    rest = x - whole
    # x is below ``whole`` if the low part of a double-double is negative
    if rest < 0:
        rest, whole = rest + 1, whole - 1
    return rest, whole


def states_at_phases(torus: Torus, phases: Row, out: Row) -> None:
    """Writes γ and M, six floats each, at the pairs of phases in ``phases``, in turns from the start."""
    zero = 0 * torus.numbers[0]
    for i in abreast(0, len(phases) // 2):
        first, turn1 = whole_turns(phases[2 * i] + zero)
        second, turn2 = whole_turns(phases[2 * i + 1] + zero)
        state_at(torus, first, second, turn1, turn2, out, 6 * i)


def states_at_tau(torus: Torus, frequencies: Row, tau: Row, out: Row) -> None:
    """Writes γ and M, six floats each, at values of τ; ``frequencies`` are the turns of both phases per unit of τ."""
    for i in abreast(0, len(tau)):
        first, turn1 = whole_turns(frequencies[0] * tau[i])
        second, turn2 = whole_turns(frequencies[1] * tau[i])
        state_at(torus, first, second, turn1, turn2, out, 6 * i)


# --- 1/g on a grid


def gridded(torus: Torus, sizes: tuple[int, int], coarser: tuple[int, int], room: Row, rates: Row, others: Row) -> None:
    """Writes 1/g on a grid of one turn of either phase from the start to ``rates``, and to ``others`` 1/g with an odd
    number of γ_i reversed, which differs for a tilted body. ``sizes`` are the rows and columns of the grid.

    Points of a coarser grid, whose rows and columns are ``coarser`` apart (0: there is none), are left out. ``room`` is
    memory for 4·TOGETHER + 2·rows numbers per harmonic of φ₁ in each theta series.
    """
    sums, numbers = torus.sums, torus.numbers
    classes, height, _ = sums.sizes
    rows, columns = sizes
    zero, circles = 0 * numbers[0], 4 * classes * height * TOGETHER
    for r in abreast(0, rows):
        put_harmonics(sums, circle((zero + r / rows + numbers[PLACES]) / 2, sums.inverse), room, circles + 2 * r, rows)
    for begin in range(0, columns, TOGETHER):
        count = min(TOGETHER, columns - begin)
        for j in abreast(0, count):
            c, s = circle(((begin + j) / columns + numbers[PLACES + 1]) / 2, sums.inverse)
            for k in range(classes):
                for i in range(height):
                    p, q, dp, dq = row_sums(sums, k, i, (c, s))
                    place = 4 * (k * height + i) * TOGETHER + j
                    room[place], room[place + TOGETHER] = p, q
                    room[place + 2 * TOGETHER], room[place + 3 * TOGETHER] = dp, dq
        for row in range(rows):
            apart = coarser[1] if coarser[0] > 0 and row % coarser[0] == 0 else 0
            # apart − 1 new columns lie between two known ones
            new = count if apart == 0 else count // apart * (apart - 1)
            for n in abreast(0, new):
                j = n if apart == 0 else n + n // (apart - 1) + 1
                rate, other = rates_in(torus, room, (circles + 2 * row, 2 * rows), j)
                rates[row * columns + begin + j] = rate
                others[row * columns + begin + j] = other


def put_harmonics(sums: ThetaSums, angle: tuple[Real, Real], room: Row, place: int, rows: int) -> None:
    """Writes (cosine, sine) of the harmonics of φ₁ in each theta series to room[place …], 2·``rows`` numbers apart.
    ``angle`` is (cosine, sine) of πφ₁.
    """
    classes, height, _ = sums.sizes
    c, s = angle
    twice, sine = c * c - s * s, 2 * c * s
    for k in range(classes):
        a, b = 1 + 0 * c, 0 * c
        if sums.chars[4 * k] > 0:
            a, b = c, s
        for i in range(height):
            there = place + 2 * rows * (k * height + i)
            room[there], room[there + 1] = a, b
            a, b = a * twice - b * sine, a * sine + b * twice


def rates_in(torus: Torus, room: Row, circles: tuple[int, int], j: int) -> tuple[Real, Real]:
    """1/g in column j, and 1/g with an odd number of γ_i reversed, from what :func:`gridded` has put into ``room``.
    ``circles`` are the position of the first harmonic and the distance from each harmonic to the next.
    """
    sums, numbers = torus.sums, torus.numbers
    tilted = numbers[TILT + 1] != 0
    x, p = column_values(sums, 0, room, circles, j, tilted)
    y, q = column_values(sums, 1, room, circles, j, tilted)
    z, s = column_values(sums, 2, room, circles, j, tilted)
    if not tilted:
        x, y, z = numbers[FACTORS] * x, numbers[FACTORS + 1] * y, numbers[FACTORS + 2] * z
        x, y, z = x * x, y * y, z * z
        square = numbers[CONTACT] * x + numbers[CONTACT + 1] * y + numbers[CONTACT + 2] * z
        rate = numbers[TILT] * root(square / (x + y + z))
        return rate, rate
    x, y, z, p, q, s = frame_from(numbers, (x, y, z), (p, q, s))
    rate = root(numbers[CONTACT] * x * x + numbers[CONTACT + 1] * y * y + numbers[CONTACT + 2] * z * z)
    lean = numbers[GAPS] * p * y * z + numbers[GAPS + 1] * q * z * x + numbers[GAPS + 2] * s * x * y
    turn = numbers[TILT + 1] * lean / rate
    return numbers[TILT] * rate + turn, numbers[TILT] * rate - turn


def column_values(
    sums: ThetaSums, k: int, room: Row, circles: tuple[int, int], j: int, tilted: bool
) -> tuple[Real, Real]:
    """θ of class k in column j, and its derivative for a ``tilted`` body, else 0."""
    height, odd = sums.sizes[1], is_odd(sums.chars, k)
    zero = 0 * room[j]
    value, slope = zero, zero
    for i in range(height):
        place = 4 * (k * height + i) * TOGETHER + j
        there = circles[0] + circles[1] * (k * height + i)
        a, b = room[there], room[there + 1]
        p, q = room[place], room[place + TOGETHER]
        x, y, u, v = a, -b, b, a
        if odd:
            x, y, u, v = u, v, x, y
        value = plus_product(plus_product(value, x, p), y, q)
        if tilted:
            p, q = room[place + 2 * TOGETHER], room[place + 3 * TOGETHER]
            slope = plus_product(plus_product(slope, u, p), v, q)
    return joined(value, zero), joined(slope, zero)


# --- a check


def strayed(torus: Torus, motion: Row, frequencies: Row, out: Row) -> float:
    """The largest difference, relative to the largest velocity, between velocities of the states on the torus and those
    of the equations of motion. ``motion`` is a :func:`integrable.torus.lattice.motion_row`, ``frequencies`` are turns
    of the phases per unit of its time. NaN if a velocity is NaN.

    The check covers signs, periods and frequencies, for all times, because theta functions are analytic.
    """
    nu1, nu2 = frequencies[0], frequencies[1]
    step = STEP / max(abs(float(nu1)), abs(float(nu2)))
    for n in abreast(0, CHECKED):
        first, second = 0.375 * n + 0 * nu1, 0.609375 * n + 0 * nu1
        here = frame_at(torus, first, second)
        ahead, behind = (
            frame_at(torus, first + step * nu1, second + step * nu2),
            frame_at(torus, first - step * nu1, second - step * nu2),
        )
        far, back = (
            frame_at(torus, first + 2 * step * nu1, second + 2 * step * nu2),
            frame_at(torus, first - 2 * step * nu1, second - 2 * step * nu2),
        )
        right = velocity(motion, here)
        thirds = third_of(ahead), third_of(behind), third_of(far), third_of(back)
        gap, size = 0.0, 0.0
        for c in range(3):
            own = (8 * (ahead[c] - behind[c]) - (far[c] - back[c])) / (12 * step)
            gap = max(gap, abs(float(own - right[c])))
            size = max(size, abs(float(right[c])))
            own = (8 * (thirds[0][c] - thirds[1][c]) - (thirds[2][c] - thirds[3][c])) / (12 * step)
            gap = max(gap, abs(float(own - right[3 + c])))
            size = max(size, abs(float(right[3 + c])))
        out[2 * n], out[2 * n + 1] = gap, size
    most, fastest, rest = 0.0, 0.0, 0.0
    for k in range(CHECKED):
        most, fastest, rest = max(most, out[2 * k]), max(fastest, out[2 * k + 1]), rest + 0 * out[2 * k]
    return most / fastest + rest


def velocity(motion: Row, frame: Row) -> Row:
    """The derivatives of γ̃ and M̃/|M̃| in the time of ``motion``."""
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
