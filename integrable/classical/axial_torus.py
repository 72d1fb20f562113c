"""Far states of Lagrange's top and the spherical pendulum in closed form.

The constants of :mod:`integrable.classical.axial_loops` are computed once, in long numbers.

With the roots x₁ ≤ z ≤ x₂ ≤ 1 ≤ x₃ of f the moduli are m = (x₂ − x₁)/(x₃ − x₁) and m' = 1 − m. The zeros of g are at
u = K + is₁ and u = is₂, where z = ±1: sn²(s₁|m') = (1 − x₂)(x₃ − x₁)/((1 − x₁)(x₃ − x₂)), sc²(s₂|m') = (1 + x₁)/(x₂ −
x₁). The rate R of rotation about the vertical follows from the logarithmic derivatives of the two factors of g at
turning points of z. For the factor that vanishes at z = 1 the turning point is x₁, for the other factor x₂.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from math import acos, cos
from typing import Any, NamedTuple

import gmpy2
import numpy as np

from integrable.classical.axial import AxialSystem, Axis, state_of
from integrable.classical.axial_loops import LIBRARY, AxialThetas, axis_at
from integrable.mumford.columns import Column, Columns
from integrable.mumford.elliptic_torus import EllipticOval, first_kind
from integrable.mumford.flow import MumfordFlow, Point
from integrable.portrait.separated import SeparatedTorus
from integrable.torus.clock import TURNS, FarTimes
from integrable.torus.theta_series import half_turn, inverse_factorials, long_numbers
from jacobian import RR, poly
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.numbers.double_double import double_double_row

# roots are computed with BITS bits, of which half are lost if two roots nearly coincide. All other numbers have
# FEWER_BITS bits
BITS, FEWER_BITS = 400, 180
# largest number of Newton steps from a root in floats
NEWTON_STEPS = 8
# gaps between the roots of f and ±1 (:class:`Gaps`) have no correct digits below LOST times the spread of the roots. A
# swing x₂ − x₁ below NOTHING times the other gaps has no effect on states in floats
LOST, NOTHING = 2.0**-130, 2.0**-90
Arrays = tuple[np.ndarray, ...]


class AxialTorus(FarTimes):
    """States of a motion of :class:`~integrable.classical.axial.AxialSystem` in floats at any times.

    PrecisionLoss on a separatrix, or if double-doubles cannot distinguish the motion from a separatrix or from rest.
    """

    def __init__(self, system: AxialSystem, state: Point) -> None:
        with long_numbers(BITS) as N:
            inner = system._constrained(N, system._inside(N, state))
            axis, top = system._axis(N, inner), system._top(N, inner)
            gaps = Gaps.of(N, system._curve(N, inner))
        with long_numbers(FEWER_BITS) as N:
            numbers, table = _steady(N, gaps, axis) if gaps.steady else _turning(N, gaps, axis)
            row = double_double_row((*numbers, *(top or (N.zero,) * 3)))
            self._motion = AxialThetas(row, double_double_row(table), inverse_factorials(), top is not None)
        self._nods, self._turns = map(float, numbers[:2])
        self.paces = [self._nods, self._turns]

    @property
    def witnesses(self) -> np.ndarray:
        """Two times for a comparison of methods: more than a period after the start, and more than a period before."""
        return np.array(TURNS) / (self._nods or self._turns or 1.0)

    def at(self, times: np.ndarray) -> np.ndarray:
        """q and p at the given times, shape (N, 6)."""
        out = np.empty(6 * len(times))
        LIBRARY.axial_states(self._motion, np.ascontiguousarray(times, dtype=np.float64), out)
        return out.reshape(-1, 6)


class AxialFlow(MumfordFlow):
    """The motion of a state; states in floats at far times are computed in closed form."""

    _of_a_torus = True

    def _made_torus(self) -> Any:
        return AxialTorus(self.system, self.start)

    def _read(self, torus: AxialTorus, times: np.ndarray) -> np.ndarray:
        return torus.at(times).reshape(-1, 2, 3)

    def _ends(self, N: LongField) -> list[Real]:
        # g can vanish only at an end z = ±1 whose constant m is 0
        m = self.system._axis(N, self._inner(N)).m
        return [e for e, x in zip((N.one, -N.one), m, strict=True) if x == 0]

    def _reader_on(self, N: LongField, torus: SeparatedTorus) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
        """Overrides :meth:`MumfordFlow._reader_on`, in floats.

        The horizontal part of the axis is g = C·e^{iδ}√|z − 1|√|z + 1|, with the angle δ about the vertical. A square
        root that can vanish is replaced by a lift, which changes its sign where it vanishes.
        """
        system, inner, pairs, K = self.system, self._inner(RR), torus.pairs(self._ends(N)), Columns()
        axis, top = system._axis(RR, inner), system._top(RR, inner)

        def horizontal(s: np.ndarray, c: np.ndarray, wave: np.ndarray) -> Arrays:
            """(z, z', g, g'): the axis' height z, its horizontal part g for C = 1 and e^{iδ} = ``wave``, and rates."""
            u, v, lifts = pairs.at(K, [(Column(s), Column(c))])
            z, rate, found = -u[0].hi, v[0].hi, iter(lifts)
            turn = axis.w + 0 * z
            size, slope = 1 + 0 * z, 0 * z
            for side, m in zip((1, -1), axis.m, strict=True):
                root = np.sqrt(np.maximum(1 - side * z, 0))
                if m == 0:
                    sigma, climb = (x.hi for x in next(found))
                    root, rise = sigma, -side * climb / 2
                else:
                    rise, turn = -side * rate / (2 * root), turn + side * m / (2 * root * root)
                size, slope = size * root, slope * root + size * rise
            return z, rate, wave * size, wave * (slope + 1j * turn * size)

        _, _, g, g_rate = horizontal(*np.array([[float(x)] for x in (*torus.halves[0], 1)]))
        own, rates = complex(*axis.g), complex(*axis.g_rate)
        unit = own / g[0] if abs(g[0]) > abs(g_rate[0]) else rates / g_rate[0]

        def read(points: np.ndarray, times: np.ndarray) -> np.ndarray:
            s, c, x, y = points[:, :, 0]
            z, rate, g, g_rate = horizontal(s, c, unit * (x + 1j * y))
            q, p = state_of((g.real, g.imag, z), (g_rate.real, g_rate.imag, rate), top)
            return np.stack([*q, *(x + 0 * z for x in p)], axis=1).reshape(-1, 2, 3)

        return read


class Gaps(NamedTuple):
    """The gaps between the roots x₁, x₂, x₃ of f and ±1.

    ``first`` is x₁, ``swing`` x₂ − x₁, ``above`` x₃ − x₂, ``down`` (1 − x₁, 1 − x₂), ``beyond`` x₃ − 1, ``up``
    (1 + x₁, 1 + x₂). ``steady`` is true if the axis does not nod.
    """

    first: Real
    swing: Real
    above: Real
    down: tuple[Real, Real]
    beyond: Real
    up: tuple[Real, Real]
    steady: bool

    @staticmethod
    def of(N: LongField, f: poly.Poly) -> Gaps:
        """The gaps of a cubic f with leading coefficient 2 and f(±1) ≤ 0."""
        mean, slope = -f[2] / 6, f[1] / 2
        square, cube = mean * mean - slope / 3, mean**3 - mean * slope / 2 - f[0] / 4
        if not square > 0:
            raise PrecisionLoss("this motion is on a separatrix")
        # the outer root that is far from both others is computed first
        size, side = N.sqrt(square), 1 if cube > 0 else -1
        cosine = min(1.0, abs(float(cube / (size * square))))
        x = mean + side * 2 * size * cos(acos(cosine) / 3)
        for _ in range(NEWTON_STEPS):
            move = (((x - 3 * mean) * x + slope) * x + f[0] / 2) / ((3 * x - 6 * mean) * x + slope)
            x -= move
            if abs(move) <= size * N.root_of_eps:
                break
        middle = (3 * mean - x) / 2
        spread = N.sqrt(max(middle * middle - (slope - 2 * x * middle), N.zero))
        x1, x2, x3 = (middle - spread, middle + spread, x) if side > 0 else (x, middle - spread, middle + spread)
        down1, down2, beyond, up1, up2 = 1 - x1, abs(1 - x2), abs(x3 - 1), abs(1 + x1), 1 + x2
        swing, above = abs(x2 - x1), x3 - x2
        lost = size * LOST
        if not min(above, down1, up2) > lost:
            raise PrecisionLoss("this motion is on a separatrix or at rest, or too near to be told from it")
        steady = swing < NOTHING * min(above, down1, up2)
        if not (steady or swing > lost):
            raise PrecisionLoss("this motion is too near to one at rest")
        return Gaps(x1, swing, above, (down1, down2), beyond, (up1, up2), bool(steady))


def _steady(N: LongField, gaps: Gaps, axis: Axis) -> tuple[Sequence[Real], Sequence[Real]]:
    """The numbers and the table of :class:`AxialThetas` for an axis that turns about the vertical without nodding."""
    pace, (m1, m2) = axis.w, axis.m
    down, up = gaps.down[0] - gaps.swing / 2, gaps.up[1] - gaps.swing / 2
    pace = pace + (m1 / (2 * down) if m1 else 0) - (m2 / (2 * up) if m2 else 0)
    turns, none = pace / (2 * half_turn()), N.zero
    numbers = (none, turns, none, *axis.g, none, pace, axis.z, none, none)
    row = (N.one, none, none, N.one, none, none, none, N.one)
    return numbers, row


def _turning(N: LongField, gaps: Gaps, axis: Axis) -> tuple[Sequence[Real], Sequence[Real]]:
    """The numbers and the table of :class:`AxialThetas` for an axis that nods between x₁ and x₂."""
    (down1, down2), (up1, up2), swing, (m1, m2) = gaps.down, gaps.up, gaps.swing, axis.m
    oval = EllipticOval(N, swing, gaps.above, _start(N, gaps, axis))
    quarter, others, nome, thetas = oval.thetas.mean, oval.thetas.others, oval.thetas.nome, oval.thetas.few
    alpha = first_kind(N, others, N.sqrt(down2 * oval.breadth), N.sqrt(swing * gaps.beyond)) * quarter
    beta = first_kind(N, others, N.sqrt(up1), N.sqrt(swing)) * quarter
    first, of_first = _waves(nome, alpha if m1 > 0 else -alpha, len(thetas) // 4)
    second, of_second = _waves(nome, -beta if m2 > 0 else beta, len(thetas) // 4)
    pace = N.sqrt(oval.breadth / 2) * quarter
    about = axis.w + m1 / (2 * down1) - m2 / (2 * up2) - pace * (of_first + of_second)
    table: list[Real] = []
    for n, (one, other) in enumerate(zip(first, second, strict=True)):
        table += [*one, *(x if n % 2 == 0 else -x for x in other), *thetas[4 * n : 4 * n + 4]]
    # these are factors of the roots R_k of :class:`EllipticOval`, for which z − x₁ = R₁² and z' = √2·R₁R₂R₃
    height = oval.factors[0] ** 2
    slope = N.sqrt(N.coerce(2)) * oval.factors[0] * oval.factors[1] * oval.factors[2]
    half = half_turn()
    numbers = (pace / half, about / (2 * half), oval.phase, N.one, N.zero, pace, about, gaps.first, height)
    return _scaled(N, (*numbers, slope), table, axis), table


def _scaled(N: LongField, numbers: Sequence[Real], table: Sequence[Real], axis: Axis) -> Sequence[Real]:
    """The ``numbers`` of :class:`AxialThetas` with C = 1, changed to the C of a motion that starts at ``axis``."""
    (x, y, _), (dx, dy, _) = axis_at(AxialThetas(numbers, table, _long_inverse(), False), N.zero)
    by_rate = max(abs(x), abs(y)) * abs(numbers[5]) <= max(abs(dx), abs(dy))
    own, found = (axis.g_rate, (dx, dy)) if by_rate else (axis.g, (x, y))
    factor = gmpy2.mpc(*own) / gmpy2.mpc(*found)
    return *numbers[:3], factor.real, factor.imag, *numbers[5:]


@cache
def _long_inverse() -> list[Real]:
    with long_numbers(FEWER_BITS) as N:
        return [N.coerce(high) + low for high, low in inverse_factorials().tolist()]


def _waves(nome: Real, angle: Real, count: int) -> tuple[list[tuple[Real, Real]], Real]:
    """For k = 2n + 1, n < ``count``, the sum and the difference of the coefficients of e^{ikv} and e^{−ikv} in
    θ₂(v − i·angle), divided by the largest of all. The second result is −iθ₂'/θ₂ at −i·angle.
    """
    grown, rows = gmpy2.exp(2 * abs(angle)), []
    for n in range(count):
        size = nome ** (n * n + n)
        large, small = size * grown**n, size / grown ** (n + 1)
        rows.append((large + small, small - large if angle < 0 else large - small))
    slope = sum((2 * n + 1) * difference for n, (_, difference) in enumerate(rows))
    return rows, slope / sum(total for total, _ in rows)


def _start(N: LongField, gaps: Gaps, axis: Axis) -> tuple[Real, Real]:
    """R₁ = ±√(z − x₁), with the sign of z', and R₂ = √(x₂ − z) at the start (:class:`EllipticOval`)."""
    low, high = max(axis.z - gaps.first, N.zero), max(gaps.first + gaps.swing - axis.z, N.zero)
    # z'² = 2(z − x₁)(x₂ − z)(x₃ − z) gives the smaller of the gaps z − x₁ and x₂ − z from the larger
    square, far = axis.rate * axis.rate / 2, gaps.swing + gaps.above
    if low < high:
        low = square / (high * (far - low))
    else:
        high = square / (low * (gaps.above + high))
    return N.sqrt(low) if axis.rate >= 0 else -N.sqrt(low), N.sqrt(high)
