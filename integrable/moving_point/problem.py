"""The motion of a body in the units of the flow: its curve, start and scales, in any real numbers.

:func:`problem_row` runs on bare reals and on balls, and is compiled unchanged for double-doubles.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from integrable.moving_point.addition import Real, Row
from integrable.moving_point.translations import REACH
from integrable.phase.body import Vector, energies
from integrable.phase.coordinates import directions_of
from integrable.phase.upright import parallel, transformation
from jacobian.errors import ArgumentError
from jacobian.numbers.long_reals import BareReals
from jacobian.numbers.roots import root

# positions of the parts of a :func:`problem_row`, beginning after f and the axes; ROW is its length
START, TIME_SCALE, RATIO, HEAVINESS, MOMENTUM, HALF_STEP, MATRIX, SLOWNESS = 14, 24, 25, 26, 27, 28, 29, 33
CONTACT, INVARIANTS, ROW = 34, 37, 39
# number of last bits of |γ × M|/|M| that are not significant
SPARE_BITS = 15
Contact = tuple[Vector[Real], Real]
"""r_i = I_i/(I_i + d) and d of a body."""


class Problem(NamedTuple):
    """The motion of a body from γ and M. Numbers are bare reals, balls, floats or mpf.

    ``f`` holds the coefficients of the curve, ascending. ``axes`` and the moving point ``start`` are as in
    :mod:`integrable.moving_point.addition`. The unit of x is X = max a_i; times are τ' = 2X|M|·τ and t' = 2X|M|·t.
    ``ratio`` is H1/(H2·X), ``d`` d·X, ``time_scale`` 2X|M|, ``momentum`` |M| and ``half_step`` half of a basic step.
    ``matrix`` is the inverse of Chaplygin's transformation of a tilted state, else None. ``slowness`` is the constant
    product of 1/g and √((1 − du₁)(1 − du₂)) of the upright motion, where u₁ and u₂ are the roots of U.
    """

    f: Row
    axes: Row
    start: Row
    ratio: Real
    d: Real
    time_scale: Real
    momentum: Real
    half_step: Real
    matrix: Row | None
    slowness: Real

    @property
    def branch_points(self) -> Row:
        """The roots of f; bare reals and balls need their ``with reals`` block."""
        rest = () if self.d == 0 else (1 / self.d,)
        return (*self.axes[:3], self.ratio, *rest)

    @property
    def row(self) -> Row:
        """The beginning of a :func:`problem_row`: the numbers of this problem, of which ``slowness`` is the last."""
        matrix = self.matrix or (1, 0, 0, 1)
        numbers = self.time_scale, self.ratio, self.d, self.momentum, self.half_step
        return (*self.f, *self.axes, *self.start, *numbers, *matrix, self.slowness)

    def over(self, number: Callable[[Real], Real]) -> Problem:
        """The motion in other numbers; ``number`` converts each."""
        f, axes, start = (tuple(map(number, row)) for row in self[:3])
        matrix = self.matrix and tuple(map(number, self.matrix))
        ratio, d, time_scale, momentum, half_step, slowness = map(number, (*self[3:8], self.slowness))
        return Problem(f, axes, start, ratio, d, time_scale, momentum, half_step, matrix, slowness)

    @staticmethod
    def of(reals: BareReals, given: Row, tilted: bool) -> Problem:
        """The problem of the moments, d, γ and M in ``given``. ArgumentError for M = 0; NotRepresentable for a tilted
        state with M ∥ γ.
        """
        with reals:
            row = reals.row(given)
            check(row[4:7], row[7:], tilted, reals.bits - SPARE_BITS)
            found = [reals.number(0)] * ROW
            problem_row(row, tilted, found)
            scale, ratio, d, momentum, half_step = found[TIME_SCALE:MATRIX]
            matrix = tuple(found[MATRIX:SLOWNESS]) if tilted else None
            return Problem(
                tuple(found[:6]), tuple(found[6:START]), tuple(found[START:TIME_SCALE]), ratio, d, scale, momentum,
                half_step, matrix, found[SLOWNESS],
            )  # fmt: skip


def problem_row(given: Row, tilted: bool, out: Row) -> None:
    """Writes the row of a :class:`Problem` to ``out``, from the moments, d, γ and M in ``given``; then
    r_i = I_i/(I_i + d) of the upright body, and H1 and H2 of the given motion. The ``matrix`` is the identity for an
    upright state.
    """
    d = given[3]
    a, (r, e), gamma, M, (k, s, p, rise), (h1, h2) = upright_motion(given, tilted)
    top, spin = max(a[0], a[1], a[2]), root(M[0] * M[0] + M[1] * M[1] + M[2] * M[2])
    ratio = put_curve(given, a, (r, e), gamma, M, out)
    moving_start(a, (r, e), gamma, M, spin, out)
    across = s * s / p
    out[12], out[13] = s, d * k * across * top * spin
    out[TIME_SCALE], out[RATIO], out[HEAVINESS], out[MOMENTUM] = 2 * top * spin, ratio, e * top, spin
    out[HALF_STEP] = 2 * REACH * min(out[6], out[7], out[8], ratio) / root(-out[0])
    out[MATRIX], out[MATRIX + 1], out[MATRIX + 2], out[MATRIX + 3] = across, -(s * k), across * rise, s
    # r_i = 1 − dα_i, and Πr_i = (1 − du₁)(1 − du₂)/g² for the roots u₁ and u₂ of U
    out[SLOWNESS] = s * root(r[0] * r[1] * r[2])
    out[CONTACT], out[CONTACT + 1], out[CONTACT + 2] = r
    out[INVARIANTS], out[INVARIANTS + 1] = h1, h2


def upright_motion(
    given: Row, tilted: bool
) -> tuple[Vector[Real], Contact, Vector[Real], Vector[Real], tuple[Real, Real, Real, Real], tuple[Real, Real]]:
    """From the moments, d, γ and M in ``given``: the a_i = 1/(I_i + d) of both the given and the upright motion; (r_i,
    d), γ and M of the upright motion, r_i = I_i/(I_i + d); (k, s, p, dkH1) of Chaplygin's transformation; and (H1, H2)
    of the given motion.
    """
    I0, I1, I2, d = given[0], given[1], given[2], given[3]
    a = (1 / (I0 + d), 1 / (I1 + d), 1 / (I2 + d))
    length = 1 / root(given[4] * given[4] + given[5] * given[5] + given[6] * given[6])
    x, y, u, m0, m1, m2 = given[4] * length, given[5] * length, given[6] * length, given[7], given[8], given[9]
    h1, h2 = energies(a, (I0 * a[0], I1 * a[1], I2 * a[2]), d, (x, y, u), (m0, m1, m2))
    k, s, p, rise, e = 0 * d, 1 + 0 * d, 1 + 0 * d, 0 * d, d
    if tilted:
        c = x * m0 + y * m1 + u * m2
        w0, w1, w2 = y * m2 - u * m1, u * m0 - x * m2, x * m1 - y * m0
        k, rest, s, rise = transformation(c, h1, h2, w0 * w0 + w1 * w1 + w2 * w2, d)
        p = s / root(rest)
        x, y, u, m0, m1, m2 = (
            p * (x + k * m0), p * (y + k * m1), p * (u + k * m2),
            s * (m0 - rise * x), s * (m1 - rise * y), s * (m2 - rise * u),
        )  # fmt: skip
        less = d * k * c
        I0, I1, I2, e = I0 - less, I1 - less, I2 - less, d * rest
    tilt, body = x * m0 + y * m1 + u * m2, ((I0 * a[0], I1 * a[1], I2 * a[2]), e)
    M = (m0 - tilt * x, m1 - tilt * y, m2 - tilt * u)
    return a, body, (x, y, u), M, (k, s, p, rise), (h1, h2)


def check(gamma: Row, M: Row, tilted: bool, bits: int) -> None:
    """Raises ArgumentError for M = 0, and NotRepresentable for a tilted state with M ∥ γ to about this many bits."""
    (x, y, z), (a, b, c) = gamma, M
    square = a * a + b * b + c * c
    if square == 0:
        raise ArgumentError("M = (0, 0, 0): the body is at rest; a flow needs M ≠ 0")
    u, v, w = y * c - z * b, z * a - x * c, x * b - y * a
    if tilted and (u * u + v * v + w * w) * (1 << 2 * bits) <= square:
        raise parallel(float(x * a + y * b + z * c))


def put_curve(given: Row, a: Vector[Real], body: Contact, gamma: Vector[Real], M: Vector[Real], out: Row) -> Real:
    """Writes the coefficients of f = (x − ratio)·Π(α_i − x)·(1 − dX·x), ascending, then α_i = a_i/X, to
    ``out``, and the κ_i of the lifts, κ_iσ_i² = U(α_i). Returns the ratio H1/(H2·X). X is the largest a_i.
    """
    contact, d = body
    h1, h2 = energies(a, contact, d, gamma, M)
    top = max(a[0], a[1], a[2])
    ratio = h1 / (h2 * top)
    out[0], out[1] = -ratio, 1 + 0 * ratio
    for i in range(2, 6):
        out[i] = 0 * ratio
    for j in range(4):
        constant, slope = 1 + 0 * ratio, -d * top
        if j < 3:
            constant, slope = a[j] / top, -1 + 0 * ratio
            out[6 + j] = constant
        for i in range(j + 2, 0, -1):
            out[i] = constant * out[i] + slope * out[i - 1]
        out[0] = constant * out[0]
    # differences of the a_i are computed from differences of the moments, which are exact
    d01, d12 = (given[1] - given[0]) * a[0] * a[1], (given[2] - given[1]) * a[1] * a[2]
    d20, unit = (given[0] - given[2]) * a[2] * a[0], 1 / (top * top)
    out[9] = -contact[0] * d01 * d20 * unit
    out[10] = -contact[1] * d12 * d01 * unit
    out[11] = -contact[2] * d20 * d12 * unit
    return ratio


def moving_start(a: Vector[Real], body: Contact, gamma: Vector[Real], M: Vector[Real], spin: Real, out: Row) -> None:
    """Writes the moving point of γ and M to ``out``."""
    (r0, r1, r2), d = body
    x, y, u = gamma
    g = 1 / root(r0 * x * x + r1 * y * y + r2 * u * u)
    w0, w1, w2 = (y * M[2] - u * M[1]) / spin, (u * M[0] - x * M[2]) / spin, (x * M[1] - y * M[0]) / spin
    lean = g * d * (a[0] * x * w0 + a[1] * y * w1 + a[2] * u * w2)
    s0, s1, s2 = g * x, g * y, g * u
    n0, n1, n2 = w0 + lean * s0, w1 + lean * s1, w2 + lean * s2
    al0, al1, al2 = out[6], out[7], out[8]
    out[14] = r0 * s0 * s0 * al1 * al2 + r1 * s1 * s1 * al2 * al0 + r2 * s2 * s2 * al0 * al1
    out[15] = -(r0 * s0 * s0 * (al1 + al2) + r1 * s1 * s1 * (al2 + al0) + r2 * s2 * s2 * (al0 + al1))
    out[16] = r0 * s0 * n0 * al1 * al2 + r1 * s1 * n1 * al2 * al0 + r2 * s2 * n2 * al0 * al1
    out[17] = -(r0 * s0 * n0 * (al1 + al2) + r1 * s1 * n1 * (al2 + al0) + r2 * s2 * n2 * (al0 + al1))
    out[18], out[19], out[20], out[21], out[22], out[23] = s0, s1, s2, n0, n1, n2


def vectors(point: Row, momentum: Real, matrix: Row | None) -> tuple[Vector[Real], Vector[Real]]:
    """(γ, M) of a moving point of bare reals, mpf or balls.

    ``momentum`` is |M|; ``matrix`` is that of the :class:`Problem`.
    """
    gamma, M = directions_of(point)
    M = (M[0] * momentum, M[1] * momentum, M[2] * momentum)
    if matrix is None:
        return gamma, M
    a, b, c, d = matrix
    (x, y, z), (m0, m1, m2) = gamma, M
    return (a * x + b * m0, a * y + b * m1, a * z + b * m2), (c * x + d * m0, c * y + d * m1, c * z + d * m2)
