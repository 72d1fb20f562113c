"""States at far times of motions of genus 1 with real data: theta functions give sn, cn and dn of a phase linear in
time.

On y² = ℓ(x − x₁)(x − x₂)(x − x₃), ℓ > 0, the point moves between x₁ and x₂. There x = x₁ + (x₂ − x₁)sn², x₂ − x = (x₂ −
x₁)cn² and x₃ − x = (x₃ − x₁)dn². So lifts at branch points are multiples of sn, cn and dn, signs included. Models with
ℓ < 0 are first transformed by x ↦ −x, those of degree 4 by x ↦ 1/(E − x), where E is the largest root.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import atan2, pi
from typing import NamedTuple

import numpy as np

from integrable.mumford.branch_points import APART, SMALL, all_real, coincident, long_roots
from integrable.mumford.columns import Column
from integrable.mumford.motion import Start
from integrable.torus.clock import FarTimes
from integrable.torus.theta_series import circle, half_turn, inverse_factorials, long_numbers
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.native.kinds import FLOATS, WIDES
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL
from jacobian.numbers.abreast import abreast
from jacobian.numbers.double_double import double_double_row
from jacobian.relatives.extended import Extended, Lift

Row = np.ndarray

# bits in which a torus is set up
BITS = 200
# series end at a term below LAST; beyond MOST_TERMS terms double-doubles cannot distinguish the motion from one on a
# separatrix
LAST, MOST_TERMS = 2.0**-113, 26
# |sn| or |cn| below which a point counts as being at its branch point
NEAR = 1e-8


def elliptic_points(numbers: Row, table: Row, inverse: Row, times: Row, out: Row) -> None:
    """Writes sn, cn and dn at the given times, three numbers per time. The compiler takes this source unchanged.

    ``numbers`` are half turns of the phase per unit time, half turns at the start, and the factors of θ₁/θ₄, θ₂/θ₄ and
    θ₃/θ₄. ``table`` are the coefficients of harmonics 2n + 1 of θ₁ and θ₂, and 2n of θ₃ and θ₄. ``inverse`` is
    :func:`integrable.torus.theta_series.inverse_factorials`.
    """
    for i in abreast(0, len(times)):
        c, s = circle((numbers[0] * times[i] + numbers[1]) / 2, inverse)
        sn, cn, dn = theta_quotients(table, c, s)
        out[3 * i], out[3 * i + 1] = numbers[2] * sn, numbers[3] * cn
        out[3 * i + 2] = numbers[4] * dn


def theta_quotients(table: Row | Sequence[Real], cv: Real, sv: Real) -> tuple[Real, Real, Real]:
    """θ₁/θ₄, θ₂/θ₄ and θ₃/θ₄ at v, which are multiples of sn, cn and dn, from cos v and sin v.

    ``table`` is that of :func:`elliptic_points`.
    """
    zero = 0 * cv
    ce, se, c2, s2 = 1 + zero, zero, cv * cv - sv * sv, 2 * cv * sv
    t1, t2, t3, t4 = zero, zero, zero, zero
    for n in range(len(table) // 4):
        k = 4 * n
        t1, t2 = t1 + table[k] * (ce * sv + se * cv), t2 + table[k + 1] * (ce * cv - se * sv)
        t3, t4 = t3 + table[k + 2] * ce, t4 + table[k + 3] * ce
        ce, se = ce * c2 - se * s2, ce * s2 + se * c2
    over = 1 / t4
    return t1 * over, t2 * over, t3 * over


LIBRARY = Library("elliptic", {"elliptic_points": (elliptic_points, (WIDES, WIDES, WIDES, FLOATS, WIDES))}, SPECIAL)


class CubicModel(NamedTuple):
    """A cubic with leading coefficient ``lead`` = ℓ > 0, and the start of a motion on it.

    ``first``, ``swing`` and ``above`` are x₁, x₂ − x₁ and x₃ − x₂; ``place`` and ``height`` are x and y of the point;
    ``pace`` is dx/y per unit time. ``side`` is −1 if the sign of x was reversed. ``pole`` is the root that was moved to
    infinity.
    """

    lead: Real
    first: Real
    swing: Real
    above: Real
    place: Real
    height: Real
    pace: Real
    side: int
    pole: Real | None = None


class EllipticTorus(FarTimes):
    """The divisor D of a motion of genus 1 at any times, in double-doubles.

    ``place(K)`` returns the :class:`Start` over K. PrecisionLoss if branch points are not real or too close, if the
    point is on an unbounded branch or at rest, for data other than lifts, and for lifts on a model of degree 4.
    """

    def __init__(self, place: Callable[[LongField], Start]) -> None:
        with long_numbers(BITS) as N:
            start = place(N)
            ends = [kind.e for kind in start.kinds if isinstance(kind, Lift)]
            if len(start.v) != 1 or len(ends) != len(start.kinds) or (ends and len(start.f) == 5):
                raise PrecisionLoss("a motion of genus 1 without lifts but at branch points is needed")
            roots = long_roots(N, start.f, ends)
            if not all_real(roots) or coincident(N, roots):
                raise PrecisionLoss("branch points are not real, or not told apart")
            model = _model(N, start, roots)
            wide = model.swing + model.above
            levels, table, (two, three, four) = theta_table(N, N.sqrt(model.swing / wide), N.sqrt(model.above / wide))
            quarter = levels[-1][0]
            low, high = max(model.place - model.first, N.zero), max(model.first + model.swing - model.place, N.zero)
            v = part_of_round(N, levels, N.sqrt(low), N.sqrt(high))
            pace = N.sqrt(model.lead * wide) / 2 * abs(model.pace)
            ahead = model.height * model.pace >= 0
            half = half_turn()
            turns = pace * quarter / half, (v if ahead else -v) / half
            numbers = (*turns, three / two, four / two, four / three)
            self._numbers, self._inverse = double_double_row(numbers), inverse_factorials()
            self._table = double_double_row(table)
            # θ changes its sign after half a turn
            self.paces, self._side = [float(numbers[0]) / 2], model.side
            self._first, self._swing = Column.of(model.first), Column.of(model.swing)
            self._pole = None if model.pole is None else Column.of(model.pole)
            # y = slope·sn·cn·dn
            slope = 2 * model.swing * pace / model.pace
            self._slope = Column.of(slope)
            at_start = [*self._points(np.zeros(1))]
            self._lifts = [
                _lift(N, model, slope, at_start, (e, datum)) for e, datum in zip(ends, start.data, strict=True)
            ]

    def at(self, times: np.ndarray) -> Extended:
        """The pairs with their data at N times, as columns of N numbers."""
        parts = self._points(times)
        sn, cn, dn = parts
        x, y = self._side * (self._first + self._swing * sn * sn), self._slope * sn * cn * dn
        if self._pole is not None:
            x, y = self._pole - 1 / x, y / (x * x)
        data = []
        for kappa, size, slope, which in self._lifts:
            data.append((kappa, size * parts[which], slope * parts[which - 1] * parts[which - 2]))
        return Extended((-x, Column(1.0)), (y,), tuple(data))

    def _points(self, times: np.ndarray) -> tuple[Column, Column, Column]:
        """sn, cn and dn at the given times."""
        out = np.empty((3 * len(times), 2))
        given = np.ascontiguousarray(times, dtype=np.float64)
        LIBRARY.elliptic_points(self._numbers, self._table, self._inverse, given, out)
        sn, cn, dn = (Column(*np.ascontiguousarray(out[k::3].T)) for k in range(3))
        return sn, cn, dn


def _model(N: LongField, start: Start, roots: Sequence[Real]) -> CubicModel:
    """The cubic model of a start; ``roots`` are the roots of f in ascending order."""
    lead, x, y, pace, pole = start.f[-1], -start.u[0], start.v[0], start.direction[0], None
    if len(roots) == 4:
        *roots, pole = roots
        lead, x = -lead, 1 / (pole - x)
        for e in roots:
            lead = lead * (pole - e)
        roots, y = [1 / (pole - e) for e in roots], y * x * x
    side = 1
    if lead < 0:
        side, lead, x, pace, roots = -1, -lead, -x, -pace, [-e for e in reversed(roots)]
    first, second, third = roots
    if not (pace and x - first >= -SMALL * (third - first) <= second - x):
        raise PrecisionLoss("the point is not between branch points")
    return CubicModel(lead, first, second - first, third - second, x, y, pace, side, pole)


def _lift(
    N: LongField, model: CubicModel, slope: Real, at_start: Sequence[Column], given: tuple[Real, Sequence[Real]]
) -> tuple[Column, Column, Column, int]:
    """(κ, the factor of σ, the factor of ν, the index of σ among sn, cn, dn) for a lift given as (e, datum)."""
    e, (kappa, sigma, nu) = given
    x, swing = model.side * e, model.swing
    gaps = [abs(x - root) for root in (model.first, model.first + swing, model.first + swing + model.above)]
    which = gaps.index(min(gaps))
    square = model.side * (-swing, swing, swing + model.above)[which] / kappa
    if not square > 0:
        raise PrecisionLoss(APART)
    size = N.sqrt(square)
    own, one, other = (float(at_start[k].hi[0]) for k in (which, which - 1, which - 2))
    # if the point is at e, ν carries the sign
    if (own * sigma if which == 2 or abs(own) > NEAR else one * other * slope / kappa * nu) < 0:
        size = -size
    return Column.of(kappa), Column.of(size), Column.of(slope / (kappa * size)), which


def means(N: LongField, b: Real) -> list[tuple[Real, Real]]:
    """The steps (a, b) of the arithmetic-geometric mean of 1 and b; the last pair is the mean."""
    a, found = N.one, []
    while True:
        found.append((a, b))
        if abs(a - b) <= a * N.root_of_eps:
            return [*found, ((a + b) / 2, (a + b) / 2)]
        a, b = (a + b) / 2, N.sqrt(a * b)


def part_of_round(N: LongField, levels: list[tuple[Real, Real]], sine: Real, cosine: Real) -> Real:
    """F(φ)·π/(2K) for the angle φ, |φ| ≤ π/2, whose sine and cosine are proportional to the given ones (Landen).

    ``levels`` are the :func:`means` of 1 and k'.
    """
    import gmpy2

    size = N.sqrt(sine * sine + cosine * cosine)
    # (s, c) is a point on the circle; ``rough`` is its angle in floats, from which full turns are counted
    s, c = sine / size, cosine / size
    rough = atan2(s, c)
    for a, b in levels[:-1]:
        p, q = (a - b) * s * c, a * c * c + b * s * s
        size = N.sqrt(p * p + q * q)
        p, q, s, c = p / size, q / size, 2 * s * c, (c - s) * (c + s)
        s, c = s * q - c * p, c * q + s * p
        rough = 2 * rough - atan2(p, q)
    rest = gmpy2.atan2(s, c)
    rounds = round((rough - float(rest)) / (2 * pi))
    return (rest + 2 * rounds * half_turn()) / 2 ** (len(levels) - 1)


def first_kind(N: LongField, levels: list[tuple[Real, Real]], sine: Real, cosine: Real) -> Real:
    """F(φ), the elliptic integral of the first kind; arguments as for :func:`part_of_round`."""
    return part_of_round(N, levels, sine, cosine) / levels[-1][0]


def nome_of(N: LongField, levels: list[tuple[Real, Real]], others: list[tuple[Real, Real]]) -> Real:
    """The nome e^(−πK'/K), from the means of 1 and k', and those of 1 and k."""
    import gmpy2

    return gmpy2.exp(-half_turn() * levels[-1][0] / others[-1][0])


def terms_of(nome: Real) -> int:
    """The number of terms of the theta series; PrecisionLoss near a separatrix."""
    count = next((n for n in range(2, MOST_TERMS) if nome ** (n * n) < LAST), 0)
    if not count:
        raise PrecisionLoss("this motion is too near to a separatrix")
    return count


def thetas(N: LongField, nome: Real, count: int) -> tuple[list[Real], list[Real], tuple[Real, Real, Real]]:
    """Coefficients of harmonics 2n + 1 of θ₂ and of harmonics 2n of θ₃, and the values of θ₂, θ₃ and θ₄ at 0.

    Coefficients and value of θ₂ are divided by its first coefficient.
    """
    odd, even = [nome ** (n * n + n) for n in range(count)], [2 * nome ** (n * n) for n in range(count)]
    even[0] = N.one
    return odd, even, (sum(odd), sum(even), sum(even[::2]) - sum(even[1::2]))


class ThetaTable(NamedTuple):
    """The constants of the theta functions of one modulus, in long numbers.

    ``levels`` are the :func:`means` of 1 and k', ``table`` is that of :func:`theta_quotients`, and ``at_zero`` are θ₂,
    θ₃ and θ₄ at 0.
    """

    levels: list[tuple[Real, Real]]
    table: list[Real]
    at_zero: tuple[Real, Real, Real]


def theta_table(N: LongField, k: Real, k1: Real) -> ThetaTable:
    """The ThetaTable of the modulus k, k² + k₁² = 1; PrecisionLoss near a separatrix."""
    levels = means(N, k1)
    nome = nome_of(N, levels, means(N, k))
    return ThetaTable(levels, *theta_rows(N, nome, terms_of(nome)))


def theta_rows(N: LongField, nome: Real, count: int) -> tuple[list[Real], tuple[Real, Real, Real]]:
    """The table of :func:`theta_quotients` with ``count`` terms, and the values of θ₂, θ₃ and θ₄ at 0."""
    odd, even, at_zero = thetas(N, nome, count)
    table = []
    for n, (o, e) in enumerate(zip(odd, even, strict=True)):
        sign = 1 - 2 * (n % 2)
        table += [sign * o, o, e, sign * e]
    return table, at_zero
