"""The states of :class:`integrable.deformations.separated_flow.OvalCarrier` on bare reals, for compilation as they
stand: the same additions with the axes in the order of their moments.

Roots R_i and s_i are triples in the order of e_i: low, middle, high. Rows are double-doubles when compiled
(:data:`LIBRARY`), lists of numbers of any precision otherwise.
"""

from __future__ import annotations

from math import floor
from typing import Any, NamedTuple

from integrable.torus.clock_loops import on_circle
from jacobian.native.kinds import BOOL, FLOAT, FLOATS, INT, WIDES, TupleKind, record
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL
from jacobian.numbers.roots import root

Real = Any
Row = Any
Three = tuple[Real, Real, Real]

# where the Laurent series of ℘ is summed: |v|²·size at most
NEAR = 1 / 16
# modes whose speed is less than this part of its terms are resonant where they are loud, and where they hardly move
RESONANT, STILL = 2.0**-10, 2.0**-40


class Track(NamedTuple):
    """One curve: ``numbers`` are its period, e_middle − e_low, e_high − e_low, e_high − e_middle, the three e_i less
    their mean, the three e_i and the roots R_i of the start; ``size`` the power of two above the largest centred |e_i|;
    ``series`` that of v²℘ in powers of v²·size from the second on, numbers of moderate size in all units.
    """

    numbers: Row
    series: Row
    size: float


class Frame(NamedTuple):
    """The body: ``numbers`` are three weights of e_i with their signs, three 1 − da_i, three weights of n_i, three a_i,
    then d, μ1, μ2, λ1, λ2, the speed of τ, the sign of an odd order of the axes, that of γ and M; ``back`` the diagonal
    of the lift to the pair asked for, ``lifted`` whether there is one; ``sizes`` of H and K.
    """

    numbers: Row
    back: Row
    lifted: bool
    sizes: tuple[float, float]


def states(first: Track, second: Track, frame: Frame, tau: Row, out: Row, rest: Row) -> float:
    """γ and M at values of τ into ``out``, six numbers each, what floats leave of them into ``rest``: the largest
    change of H and K over their sizes.
    """
    worst = 0.0
    for n in range(len(tau)):
        t = tau[n] * frame.numbers[17]
        gamma, M, drift = state(frame, moved(first, t), moved(second, t), first, second)
        if not drift <= worst:
            worst = drift
        if frame.lifted:
            gamma, M = lifted(frame.back, gamma, M)
        put(gamma, out, rest, 6 * n)
        put(M, out, rest, 6 * n + 3)
    return worst


def put(vector: Three, out: Row, rest: Row, place: int) -> None:
    """Three numbers as floats, and what is left of them."""
    out[place], out[place + 1], out[place + 2] = float(vector[0]), float(vector[1]), float(vector[2])
    rest[place] = float(vector[0] - out[place])
    rest[place + 1] = float(vector[1] - out[place + 1])
    rest[place + 2] = float(vector[2] - out[place + 2])


def moved(track: Track, tau: Real) -> Three:
    """The roots R_i at τ."""
    numbers = track.numbers
    start = (numbers[10], numbers[11], numbers[12])
    turns = floor(float(tau / numbers[0]) + 0.5)
    left = tau - float(turns) * numbers[0]
    found = start if left == 0 else added(start, translation(track, left))
    if turns % 2 != 0:
        found = (-found[0], -found[1], found[2])
    return found


def added(r: Three, s: Three) -> Three:
    """:meth:`integrable.deformations.oval.Oval.added`."""
    scale = 1 / (s[1] * s[1] + r[1] * r[1])
    return (
        (s[0] * r[1] * r[2] + r[0] * s[1] * s[2]) * scale,
        (r[1] * s[0] * s[2] - s[1] * r[0] * r[2]) * scale,
        (r[2] * s[0] * s[1] - s[2] * r[0] * r[1]) * scale,
    )


def translation(track: Track, v: Real) -> Three:
    """:meth:`integrable.deformations.oval.Oval.translation`."""
    numbers, series = track.numbers, track.series
    near = abs(v)
    halvings = 0
    while float(near) * float(near) * track.size > NEAR:
        near = near * 0.5
        halvings += 1
    square = near * near
    x = square * track.size
    tail = 0 * near
    for n in range(len(series) - 1, -1, -1):
        tail = tail * x + series[n]
    tail = tail * x * x + 1
    s0 = root(tail - square * numbers[4]) / near
    s1 = root(tail - square * numbers[5]) / near
    s2 = root(tail - square * numbers[6]) / near
    for _ in range(halvings):
        scale = 1 / (2 * s0 * s1 * s2)
        q1, q2 = s1 * s1, s2 * s2
        s1 = (q1 * q1 + numbers[1] * numbers[3]) * scale
        s0 = root(s1 * s1 + numbers[1])
        s2 = (q2 * q2 - numbers[2] * numbers[3]) * scale
    if v < 0:
        return -s0, -s1, -s2
    return s0, s1, s2


def height(track: Track, r: Three, mu: Real) -> Real:
    """Z/μ at the roots R_i, from the root that is least."""
    numbers = track.numbers
    if abs(r[0]) <= abs(r[1]) and abs(r[0]) <= abs(r[2]):
        z = numbers[7] + r[0] * r[0]
    elif abs(r[1]) <= abs(r[2]):
        z = numbers[8] - r[1] * r[1]
    else:
        z = numbers[9] - r[2] * r[2]
    return z / mu


def state(frame: Frame, p: Three, q: Three, first: Track, second: Track) -> tuple[Three, Three, float]:
    """(γ, M, the change of H and K) of the tilde pair from the roots on both curves, μ1 > 0 > μ2: low and high are
    each other's on the second.
    """
    b = frame.numbers
    d, mu1, mu2 = b[12], b[13], b[14]
    f1, f2 = 1 / (1 + d * height(first, p, mu1)), 1 / (1 + d * height(second, q, mu2))
    # by axis, the least moment first: it has e_high of the first curve and e_low of the second
    p0, p1, p2, q0, q1, q2 = p[2], p[1], p[0], q[0], q[1], q[2]
    e0, e1, e2 = b[0] * p0 * q0, b[1] * p1 * q1, b[2] * p2 * q2
    length = root(e0 * e0 + e1 * e1 + e2 * e2)
    gap = f1 * f2 * (p1 * p1 / mu1 - q1 * q1 / mu2)
    scale = 2 * length * f1 * f2 / (mu1 * mu2 * gap)
    n0 = scale * b[6] * (p1 * p2 * f1 * q0 + q1 * q2 * f2 * p0)
    n1 = scale * b[7] * (q2 * q0 * f2 * p1 - p2 * p0 * f1 * q1)
    n2 = -scale * b[8] * (p0 * p1 * f1 * q2 + q0 * q1 * f2 * p2)
    e0, e1, e2 = e0 / length, e1 / length, e2 / length
    r0, r1, r2 = e0 / b[3], e1 / b[4], e2 / b[5]
    lean = (r0 * n0 + r1 * n1 + r2 * n2) / (r0 * e0 + r1 * e1 + r2 * e2)
    x0, x1, x2 = (lean * e0 - n0) / b[3], (lean * e1 - n1) / b[4], (lean * e2 - n2) / b[5]
    size = b[19] / root(x0 * x0 + x1 * x1 + x2 * x2)
    gamma = (x0 * size, x1 * size, x2 * size)
    momentum = b[18] * b[19] * root((b[15] - b[16]) / gap)
    M = crossed((momentum * e0, momentum * e1, momentum * e2), gamma)
    return gamma, M, drift(frame, gamma, M)


def crossed(x: Three, y: Three) -> Three:
    """x × y."""
    return x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]


def drift(frame: Frame, gamma: Three, M: Three) -> float:
    """The larger change of H = λ1 + λ2 and K = −λ1λ2 over their sizes (:mod:`integrable.deformations.tilde`)."""
    b = frame.numbers
    d, a0, a1, a2 = b[12], b[9], b[10], b[11]
    l0, l1, l2 = a0 * M[0], a1 * M[1], a2 * M[2]
    m1 = l0 * M[0] + l1 * M[1] + l2 * M[2]
    m2 = M[0] * M[0] + M[1] * M[1] + M[2] * M[2]
    s = a0 * gamma[0] * gamma[0] + a1 * gamma[1] * gamma[1] + a2 * gamma[2] * gamma[2]
    xi = l0 * gamma[0] + l1 * gamma[1] + l2 * gamma[2]
    # 1/G = 1 − ds
    slow = b[3] * gamma[0] * gamma[0] + b[4] * gamma[1] * gamma[1] + b[5] * gamma[2] * gamma[2]
    spin = xi * xi / slow
    energy, second = m1 - s * m2 + 2 * d * spin, spin * (m2 - d * (m1 + d * spin))
    change = float(abs(energy - b[15] - b[16])) / frame.sizes[0]
    return max(change, float(abs(second + b[15] * b[16])) / frame.sizes[1])


def lifted(back: Row, gamma: Three, M: Three) -> tuple[Three, Three]:
    """:func:`integrable.phase.isometry.lift`."""
    b0, b1, b2 = back[0], back[1], back[2]
    turned = (b0 * gamma[0], b1 * gamma[1], b2 * gamma[2])
    size = 1 / root(turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2])
    w = crossed(M, gamma)
    image = (turned[0] * size, turned[1] * size, turned[2] * size)
    return image, crossed(turned, (w[0] / b0, w[1] / b1, w[2] / b2))


class Waves(NamedTuple):
    """A clock: t = mean·x + Σ e_mn sin mθ₁ cos nθ₂ + o_mn cos mθ₁ sin nθ₂ − origin, θ_k = 2π(a_kx + b_k). ``numbers``
    are the mean, the origin, 2π, a₁, b₁, a₂, b₂; ``even`` and ``odd`` the e_mn and o_mn row by row, ``columns`` to a
    row; ``room`` is for 2·columns numbers.
    """

    numbers: Row
    even: Row
    odd: Row
    columns: int
    room: Row


def misses(waves: Waves, x: Row, t: Row, out: Row) -> None:
    """What the clock shows at every x, less t, into ``out``."""
    for n in range(len(x)):
        out[n] = shown(waves, x[n]) - t[n]


def shown(waves: Waves, x: Real) -> Real:
    """What the clock shows."""
    room, columns = waves.room, waves.columns
    p, q, c, s = circles(waves, x)
    total = waves.numbers[0] * x - waves.numbers[1]
    place = 0
    for _ in range(len(waves.even) // columns):
        even, odd = 0 * x, 0 * x
        for n in range(columns):
            even += waves.even[place] * room[2 * n]
            odd += waves.odd[place] * room[2 * n + 1]
            place += 1
        total += q * even + p * odd
        p, q = p * c - q * s, p * s + q * c
    return total


def paces(waves: Waves, rates: Row, x: Row, out: Row) -> None:
    """1/g at every x into ``out``, from its c_mn row by row as the clock's."""
    room, columns = waves.room, waves.columns
    for i in range(len(x)):
        p, q, c, s = circles(waves, x[i])
        total = 0 * p
        place = 0
        for _ in range(len(rates) // columns):
            for n in range(columns):
                total += p * rates[place] * room[2 * n]
                place += 1
            p, q = p * c - q * s, p * s + q * c
        out[i] = total


def circles(waves: Waves, x: Real) -> tuple[Real, Real, Real, Real]:
    """1, 0, cos θ₁, sin θ₁ at x, and those of all nθ₂ in the clock's room."""
    numbers, room = waves.numbers, waves.room
    c, s = on_circle(fraction(numbers[5] * x + numbers[6]), numbers[2])
    p, q = 1 + 0 * x, 0 * x
    for n in range(waves.columns):
        room[2 * n], room[2 * n + 1] = p, q
        p, q = p * c - q * s, p * s + q * c
    c, s = on_circle(fraction(numbers[3] * x + numbers[4]), numbers[2])
    return 1 + 0 * x, 0 * x, c, s


def fraction(turns: Real) -> Real:
    """What is left of a number of turns beyond whole ones."""
    return turns - float(floor(float(turns) + 0.5))


class Modes(NamedTuple):
    """What 1/g = Σ c_mn cos mθ₁ cos nθ₂ is made of, 0 ≤ m ≤ ``rows``, 0 ≤ n ≤ ``columns``: ``numbers`` are d, the
    weights of 1 + dz_k in g², μ1, μ2, and of half a turn over rows and over columns cosine and sine. ``table`` is for
    the c_mn row by row, ``room`` for 3·(rows + columns) numbers.
    """

    numbers: Row
    rows: int
    columns: int
    table: Row
    room: Row


def expand(first: Track, second: Track, modes: Modes) -> None:
    """The c_mn of 1/g, by cosine transforms along both phases of its values at half turns over rows and columns."""
    numbers, rows, columns, table, room = modes
    # of either curve its part of g²
    heights(first, numbers[0], numbers[1], numbers[3], rows, room, 0)
    heights(second, numbers[0], numbers[2], numbers[4], columns, room, rows + 1)
    place = 0
    for i in range(rows + 1):
        for j in range(columns + 1):
            table[place] = 1 / root(room[i] + room[rows + 1 + j])
            place += 1
    powers(numbers[7], numbers[8], columns, room)
    for i in range(rows + 1):
        transform(table, i * (columns + 1), 1, columns, room)
    powers(numbers[5], numbers[6], rows, room)
    for j in range(columns + 1):
        transform(table, j, columns + 1, rows, room)


def heights(track: Track, d: Real, weight: Real, mu: Real, count: int, out: Row, place: int) -> None:
    """weight·(1 + dz) at the phases πj/count, j = 0 … count."""
    numbers = track.numbers
    step = translation(track, numbers[0] / (2 * count))
    r = (0 * mu, root(numbers[1]), root(numbers[2]))
    for j in range(count + 1):
        out[place + j] = weight * (1 + d * height(track, r, mu))
        r = added(r, step)


def powers(c: Real, s: Real, count: int, out: Row) -> None:
    """cos πj/count, j = 0 … 2·count − 1, from the cosine and sine of π/count."""
    p, q = 1 + 0 * c, 0 * c
    for j in range(2 * count):
        out[j] = p
        p, q = p * c - q * s, p * s + q * c


def transform(table: Row, place: int, stride: int, count: int, room: Row) -> None:
    """c_k with Σ c_k cos(πjk/count) = v_j, j, k = 0 … count, in place of the v_j; ``room`` begins with the cosines."""
    half, line = (count - 1) // 2, 2 * count
    # cos(π(count − j)k/count) = ±cos(πjk/count): of even k sums are enough, of odd k differences
    for j in range(count + 1):
        other = table[place + (count - j) * stride]
        if j <= half:
            room[line + j] = table[place + j * stride] + other
        elif 2 * j > count:
            room[line + j] = other - table[place + j * stride]
        else:
            room[line + j] = other
    for k in range(count + 1):
        begin, way = (line, 1) if k % 2 == 0 else (line + count, -1)
        total = room[begin] * 0.5
        turn = 0
        for j in range(1, half + 1):
            turn += k
            if turn >= 2 * count:
                turn -= 2 * count
            total += room[begin + way * j] * room[turn]
        if count % 2 == 0 and k % 2 == 0:
            middle = room[line + count // 2]
            total += middle if k % 4 == 0 else -middle
        ends = 2 if k == 0 or k == count else 1
        table[place + k * stride] = total * 2.0 / float(count * ends)


def integrate(modes: Modes, speeds: Row, least: float, even: Row, odd: Row) -> bool:
    """The e_mn and o_mn of :class:`Waves` from the c_mn of at least ``least``, where θ₁ and θ₂ turn at ``speeds``:
    whether no mode is resonant.
    """
    place, mean = -1, float(modes.table[0])
    for m in range(modes.rows + 1):
        for n in range(modes.columns + 1):
            place += 1
            value = modes.table[place]
            even[place], odd[place] = 0 * value, 0 * value
            if place == 0 or abs(float(value)) < least:
                continue
            one, other = float(m) * speeds[0], float(n) * speeds[1]
            slow, terms = abs(float(one - other)), float(one + other)
            # a quiet mode may be slow: what it swings by is no more than the mean is in a radian
            if slow < RESONANT * terms and (slow < STILL * terms or abs(float(value)) > slow * mean):
                return False
            if m == 0 or n == 0:
                # cos mθ₁, or cos nθ₂
                even[place], odd[place] = (value / one, 0 * value) if n == 0 else (0 * value, value / other)
            else:
                # the mean of cos(mθ₁ + nθ₂) and cos(mθ₁ − nθ₂)
                up, down = value * 0.5 / (one + other), value * 0.5 / (one - other)
                even[place], odd[place] = up + down, up - down
    return True


_TRACK = record(Track, WIDES, WIDES, FLOAT)
_FRAME = record(Frame, WIDES, WIDES, BOOL, TupleKind((FLOAT, FLOAT)))
_WAVES = record(Waves, WIDES, WIDES, WIDES, INT, WIDES)
_MODES = record(Modes, WIDES, INT, INT, WIDES, WIDES)
LIBRARY = Library(
    "deformations",
    {
        "states": (states, (_TRACK, _TRACK, _FRAME, WIDES, FLOATS, FLOATS)),
        "misses": (misses, (_WAVES, WIDES, WIDES, WIDES)),
        "paces": (paces, (_WAVES, WIDES, WIDES, WIDES)),
        "expand": (expand, (_TRACK, _TRACK, _MODES)),
        "integrate": (integrate, (_MODES, WIDES, FLOAT, WIDES, WIDES)),
    },
    SPECIAL,
)
