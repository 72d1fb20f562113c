"""States of :class:`~integrable.deformations.tilde.Tilde`, and of systems isometric to it, from a point on each curve.

The functions run on long numbers, and compiled on double-doubles (:mod:`integrable.deformations.quick_states`). On
each curve R_low, R_middle and R_high are multiples of sn, cn and dn, which are computed by theta functions
(:mod:`integrable.mumford.elliptic_torus`). Roots R_i are triples in the order of e_i: low, middle, high. Phases are in
turns, one per real period of a curve.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from integrable.mumford.elliptic_torus import theta_quotients
from integrable.torus.theta_series import circle
from jacobian.element import Real
from jacobian.native.kinds import BOOL, FLOAT, FLOATS, WIDES, TupleKind, record
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL
from jacobian.numbers.abreast import abreast
from jacobian.numbers.roots import root

Row = Any
Three = tuple[Real, Real, Real]


class Track(NamedTuple):
    """One curve; ``table`` is that of :func:`integrable.mumford.elliptic_torus.theta_quotients`.

    ``inverse`` is that of :func:`integrable.torus.theta_series.circle`. ``numbers`` are the factors of θ₁/θ₄, θ₂/θ₄
    and θ₃/θ₄ in R_low, R_middle and R_high, the phase of the start counted from Z = e_low, z at the three e_i, and
    1/scale, where Z = scale·z + shift.
    """

    numbers: Row
    table: Row
    inverse: Row


class Frame(NamedTuple):
    """The body and the integrals of a motion.

    Without a potential ``numbers`` are three signed weights of w_i/|M|, three 1 − da_i, three weights of N_i
    (:mod:`~integrable.deformations.two_curves`), three a_i, then d, μ1, μ2, λ1, λ2, the sign of the permutation that
    orders the axes, and the sign of γ and M. If ``in_poles`` (repelling poles), they are three a_i, three b_i, three
    c_i, the signs of the γ_i, λ1, λ2, H and K. ``back`` is the diagonal of the lift to a check or hat pair, used if
    ``lifted``. ``sizes`` are the units in which errors of H and K of the tilde pair are measured.
    """

    numbers: Row
    back: Row
    lifted: bool
    in_poles: bool
    sizes: tuple[Real, Real]


def states(first: Track, second: Track, frame: Frame, phases: Row, found: tuple[Row, Row, Row]) -> float:
    """Writes γ and M at pairs of phases since the start; returns the largest change of H and K relative to
    ``frame.sizes``.

    ``phases`` holds the pairs one after the other. The first row of ``found`` receives six floats per pair, the second
    their remainders; the third is working memory for the roots.
    """
    out, rest, roots = found
    count, worst = len(phases) // 2, 0.0
    put_roots(first, phases, 0, roots)
    put_roots(second, phases, 1, roots)
    for n in range(count):
        p = roots[6 * n], roots[6 * n + 1], roots[6 * n + 2]
        q = roots[6 * n + 3], roots[6 * n + 4], roots[6 * n + 5]
        gamma, M = tilde_state(frame, p, q, first, second)
        drift = poles_drift_of(frame, gamma, M) if frame.in_poles else integrals_drift_of(frame, gamma, M)
        if not drift <= worst:
            worst = drift
        gamma, M = lifted_state(frame, gamma, M)
        put_split(gamma, out, rest, 6 * n)
        put_split(M, out, rest, 6 * n + 3)
    return worst


def tilde_state(frame: Frame, p: Three, q: Three, first: Track, second: Track) -> tuple[Three, Three]:
    """(γ, M) of the tilde pair, from the roots on both curves."""
    if frame.in_poles:
        return state_in_poles(frame.numbers, p, q, first, second)
    return free_state(frame.numbers, p, q, first, second)


def put_roots(track: Track, phases: Row, which: int, roots: Row) -> None:
    """Writes the roots R_i of the first or second curve (``which`` = 0, 1) at all pairs of phases."""
    numbers = track.numbers
    for n in abreast(0, len(phases) // 2):
        # sn and cn have twice the period, hence half the phase
        c, s = circle((phases[2 * n + which] + numbers[3]) / 2, track.inverse)
        low, middle, high = theta_quotients(track.table, c, s)
        place = 6 * n + 3 * which
        roots[place], roots[place + 1] = numbers[0] * low, numbers[1] * middle
        roots[place + 2] = numbers[2] * high


def put_split(vector: Three, out: Row, rest: Row, place: int) -> None:
    """Writes three numbers, rounded to floats, to ``out``, and the remainders to ``rest``."""
    out[place], out[place + 1], out[place + 2] = float(vector[0]), float(vector[1]), float(vector[2])
    rest[place] = float(vector[0] - out[place])
    rest[place + 1] = float(vector[1] - out[place + 1])
    rest[place + 2] = float(vector[2] - out[place + 2])


def height(track: Track, r: Three) -> Real:
    """z at the roots R_i, computed from the smallest of them (see :class:`Track`)."""
    numbers = track.numbers
    if abs(r[0]) <= abs(r[1]) and abs(r[0]) <= abs(r[2]):
        return numbers[4] + r[0] * r[0] * numbers[7]
    if abs(r[1]) <= abs(r[2]):
        return numbers[5] - r[1] * r[1] * numbers[7]
    return numbers[6] - r[2] * r[2] * numbers[7]


def free_state(b: Row, p: Three, q: Three, first: Track, second: Track) -> tuple[Three, Three]:
    """(γ, M) of the tilde pair without potential, from the roots on both curves (``b``: ``Frame.numbers``).

    Since μ1 > 0 > μ2, the axes of low and high are exchanged on the second curve.
    """
    d, mu1, mu2 = b[12], b[13], b[14]
    f1, f2 = 1 / (1 + d * height(first, p)), 1 / (1 + d * height(second, q))
    # the roots are put in the order of the axes, smallest moment first; the axis of the smallest moment has e_high on
    # the first curve and e_low on the second
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
    size = b[18] / root(x0 * x0 + x1 * x1 + x2 * x2)
    gamma = (x0 * size, x1 * size, x2 * size)
    momentum = b[17] * b[18] * root((b[15] - b[16]) / gap)
    return gamma, crossed((momentum * e0, momentum * e1, momentum * e2), gamma)


def crossed(x: Three, y: Three) -> Three:
    """x × y."""
    return x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]


def integrals_drift_of(frame: Frame, gamma: Three, M: Three) -> float:
    """The larger of the relative changes of H = λ1 + λ2 and K = −λ1λ2 (:mod:`integrable.deformations.tilde`)."""
    b = frame.numbers
    d, a0, a1, a2 = b[12], b[9], b[10], b[11]
    l0, l1, l2 = a0 * M[0], a1 * M[1], a2 * M[2]
    m1 = l0 * M[0] + l1 * M[1] + l2 * M[2]
    m2 = M[0] * M[0] + M[1] * M[1] + M[2] * M[2]
    s = a0 * gamma[0] * gamma[0] + a1 * gamma[1] * gamma[1] + a2 * gamma[2] * gamma[2]
    xi = l0 * gamma[0] + l1 * gamma[1] + l2 * gamma[2]
    # ``slow`` is 1/G = 1 − ds
    slow = b[3] * gamma[0] * gamma[0] + b[4] * gamma[1] * gamma[1] + b[5] * gamma[2] * gamma[2]
    spin = xi * xi / slow
    energy, second = m1 - s * m2 + 2 * d * spin, spin * (m2 - d * (m1 + d * spin))
    change = float(abs(energy - b[15] - b[16])) / frame.sizes[0]
    return max(change, float(abs(second + b[15] * b[16])) / frame.sizes[1])


def state_in_poles(b: Row, p: Three, q: Three, first: Track, second: Track) -> tuple[Three, Three]:
    """(γ, M) of the tilde pair with repelling poles, where the heights z on the curves are the ũ_k.

    ``b`` is ``Frame.numbers``. The formulas are those of :mod:`integrable.deformations.pole_flow`.
    """
    u1, u2 = height(first, p), height(second, q)
    gap = u2 - u1
    # y_k = ũ_k'/gap, so that V(x) = −y1(u2 − x) − y2(x − u1)
    y1, y2 = 2 * p[0] * p[1] * p[2] * first.numbers[7] / gap, 2 * q[0] * q[1] * q[2] * second.numbers[7] / gap
    h2 = (b[12] - b[13]) / gap
    x0, w0 = component_in_poles(b[0] - u1, b[0] - u2, y1, y2, h2, b[3], b[6], b[9])
    x1, w1 = component_in_poles(b[1] - u1, b[1] - u2, y1, y2, h2, b[4], b[7], b[10])
    x2, w2 = component_in_poles(b[2] - u1, b[2] - u2, y1, y2, h2, b[5], b[8], b[11])
    return (x0, x1, x2), crossed((w0, w1, w2), (x0, x1, x2))


def component_in_poles(
    over: Real, under: Real, y1: Real, y2: Real, h2: Real, b: Real, c: Real, sign: Real
) -> tuple[Real, Real]:
    """(γ_i, w_i) from ``over`` = a_i − ũ1 and ``under`` = a_i − ũ2, whose product is c_iE_i²; y_k is ũ_k'/(ũ2 − ũ1)."""
    v = y1 * under - y2 * over
    x = sign * root((4 * b * c * c + v * v) / (4 * h2 * c * over * under))
    return x, v / (2 * c * x)


def poles_drift_of(frame: Frame, gamma: Three, M: Three) -> float:
    """The larger of the relative changes of H and K with repelling poles (:mod:`integrable.deformations.tilde`)."""
    b = frame.numbers
    x0, x1, x2 = gamma[0] * gamma[0], gamma[1] * gamma[1], gamma[2] * gamma[2]
    s = b[0] * x0 + b[1] * x1 + b[2] * x2
    p0, p1, p2 = b[3] / x0, b[4] / x1, b[5] / x2
    l0, l1, l2 = b[0] * M[0], b[1] * M[1], b[2] * M[2]
    m1, m2 = l0 * M[0] + l1 * M[1] + l2 * M[2], M[0] * M[0] + M[1] * M[1] + M[2] * M[2]
    xi = l0 * gamma[0] + l1 * gamma[1] + l2 * gamma[2]
    t0, t1, t2 = s - b[0], s - b[1], s - b[2]
    energy = m1 - s * m2 - p0 * (t1 + t2) - p1 * (t2 + t0) - p2 * (t0 + t1)
    second = (m2 + p0 + p1 + p2) * (xi * xi - p0 * t1 * t2 - p1 * t2 * t0 - p2 * t0 * t1)
    change = float(abs(energy - b[14])) / frame.sizes[0]
    return max(change, float(abs(second - b[15])) / frame.sizes[1])


def lifted_state(frame: Frame, gamma: Three, M: Three) -> tuple[Three, Three]:
    """(γ, M) of the check or hat pair, as by :func:`integrable.phase.isometry.lift`; unchanged for a tilde pair."""
    if not frame.lifted:
        return gamma, M
    b0, b1, b2 = frame.back[0], frame.back[1], frame.back[2]
    turned = (b0 * gamma[0], b1 * gamma[1], b2 * gamma[2])
    size = 1 / root(turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2])
    w = crossed(M, gamma)
    image = (turned[0] * size, turned[1] * size, turned[2] * size)
    return image, crossed(turned, (w[0] / b0, w[1] / b1, w[2] / b2))


def paces(first: Track, second: Track, numbers: Row, places: tuple[Row, Row], table: Row, room: Row) -> None:
    """Writes dt/dτ = 1/g to ``table``, row by row, on a grid of phases since the start.

    ``places`` are the phases in pairs: rows are phases on the first curve, columns those on the second. ``numbers`` are
    d and the weights of 1 + dz_k in g². ``room`` is working memory of 6 numbers per pair.
    """
    downwards, across = places
    rows, columns = len(downwards) // 2, len(across) // 2
    roots = room[6 * rows :]
    put_roots(first, downwards, 0, room)
    put_roots(second, across, 1, roots)
    put_shares(first, numbers[0], numbers[1], rows, room)
    put_shares(second, numbers[0], numbers[2], columns, roots[3:])
    for i in range(rows):
        for j in abreast(0, columns):
            table[i * columns + j] = 1 / root(room[6 * i] + roots[6 * j + 3])


def put_shares(track: Track, d: Real, weight: Real, count: int, roots: Row) -> None:
    """Replaces the first root of each triple by weight·(1 + dz), z the height there; triples are six numbers apart."""
    for n in range(count):
        place = 6 * n
        roots[place] = weight * (1 + d * height(track, (roots[place], roots[place + 1], roots[place + 2])))


_TRACK = record(Track, WIDES, WIDES, WIDES)
_FRAME = record(Frame, WIDES, WIDES, BOOL, BOOL, TupleKind((FLOAT, FLOAT)))
LIBRARY = Library(
    "deformations",
    {
        "states": (states, (_TRACK, _TRACK, _FRAME, WIDES, TupleKind((FLOATS, FLOATS, WIDES)))),
        "paces": (paces, (_TRACK, _TRACK, WIDES, TupleKind((WIDES, WIDES)), WIDES, WIDES)),
    },
    SPECIAL,
)
