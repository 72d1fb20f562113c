"""States at far times of motions of genus 1 with real data: theta functions give sn, cn and dn of a phase linear in
time.

On y² = ℓ(x − x₁)(x − x₂)(x − x₃), ℓ > 0, the divisor is one point, with x from x₁ to x₂ (:class:`EllipticOval`). There
x − x₁ = (x₂ − x₁)sn², x₂ − x = (x₂ − x₁)cn² and x₃ − x = (x₃ − x₁)dn². So lifts at branch points are multiples of sn,
cn and dn, signs included. Models with ℓ < 0 are first transformed by x ↦ −x, those of degree 4 by x ↦ 1/(E − x), where
E is the largest root.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import atan2, pi, prod
from typing import NamedTuple

import gmpy2
import numpy as np

from integrable.mumford.branch_points import APART, SMALL, all_real, coincident, long_roots
from integrable.mumford.columns import Column
from integrable.mumford.motion import Start
from integrable.torus.clock import FarTimes
from integrable.torus.theta_series import circle, half_turn, inverse_factorials, long_numbers
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.native.kinds import INT, WIDES, TupleKind, record
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL
from jacobian.numbers.abreast import abreast
from jacobian.numbers.double_double import double_double_row
from jacobian.relatives.extended import Extended, Lift

Row = np.ndarray

# precision in bits of the set-up of a torus
BITS = 200
# theta series end at a term below LAST; if these are MOST_TERMS terms or more, double-doubles cannot distinguish the
# motion from one on a separatrix
LAST, MOST_TERMS = 2.0**-113, 26
# |sn| or |cn| below which a point counts as being at its branch point
NEAR = 1e-8


class OvalThetas(NamedTuple):
    """The data of an :class:`EllipticOval` that :func:`oval_points` needs.

    ``numbers`` are turns of the phase per unit time, turns at the start, and the factors of θ₁/θ₄, θ₂/θ₄ and θ₃/θ₄ in
    R₁, R₂ and R₃. ``table`` are the coefficients of harmonics 2n + 1 of θ₁ and θ₂, and 2n of θ₃ and θ₄. ``inverse`` is
    :func:`integrable.torus.theta_series.inverse_factorials`.
    """

    numbers: Row
    table: Row
    inverse: Row


def oval_points(oval: OvalThetas, times: Row, place: tuple[int, int], out: Row) -> None:
    """Writes the roots R₁, then R₂, then R₃ of an :class:`EllipticOval` at the N = ``len(out)``/3 times
    ``times[begin + step·n]``, where (begin, step) = ``place``. This source is compiled unchanged.
    """
    numbers, count, (begin, step) = oval.numbers, len(out) // 3, place
    for n in abreast(0, count):
        # the argument of the theta functions is half the phase of Z, since sn and cn have twice the period of Z
        c, s = circle((numbers[0] * times[begin + step * n] + numbers[1]) / 2, oval.inverse)
        one, two, three = theta_quotients(oval.table, c, s)
        out[n], out[count + n], out[2 * count + n] = numbers[2] * one, numbers[3] * two, numbers[4] * three


def theta_quotients(table: Row | Sequence[Real], cv: Real, sv: Real) -> tuple[Real, Real, Real]:
    """θ₁/θ₄, θ₂/θ₄ and θ₃/θ₄ at v, which are multiples of sn, cn and dn, from cos v and sin v.

    ``table`` is that of :class:`OvalThetas`.
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


OVAL = record(OvalThetas, WIDES, WIDES, WIDES)
LIBRARY = Library("elliptic", {"oval_points": (oval_points, (OVAL, WIDES, TupleKind((INT, INT)), WIDES))}, SPECIAL)


class EllipticOval:
    """A point that moves on Z'² = 4(Z − e₁)(Z − e₂)(Z − e₃) in the oval e₁ ≤ Z ≤ e₂ ≤ e₃, in long numbers.

    The roots R₁ = √(Z − e₁), R₂ = √(e₂ − Z) and R₃ = √(e₃ − Z) are multiples of sn, cn and dn. Their signs are those
    for which Z' = 2R₁R₂R₃ and R₃ > 0, so R₁ and R₂ change sign. ``swing`` is e₂ − e₁, ``above`` is e₃ − e₂. As an
    argument ``start`` has R₁ and R₂ ≥ 0 at the start, as an attribute also R₃. ``period`` is the time in which Z
    returns, ``phase`` the turns since Z = e₁.
    """

    def __init__(self, N: LongField, swing: Real, above: Real, start: Sequence[Real]) -> None:
        self.field, self.swing, self.above = N, swing, above
        self.breadth, (one, two, *_) = swing + above, start
        self.start = one, two, N.sqrt(above + two * two)
        narrow, wide = N.sqrt(swing), N.sqrt(self.breadth)
        self.thetas = theta_table(N, narrow / wide, N.sqrt(above) / wide)
        second, third, fourth = self.thetas.at_zero
        self.factors = narrow * third / second, narrow * fourth / second, wide * fourth / third
        self.period = half_turn() / (wide * self.thetas.mean)
        # in an oval of length 0 the phase is arbitrary
        self.phase = part_of_round(N, self.thetas.levels, one, two) / half_turn() if swing else N.zero

    def at(self, turns: Real) -> tuple[Real, Real, Real]:
        """The roots R₁, R₂ and R₃ at a phase."""
        angle = half_turn() * (turns - 2 * gmpy2.rint(turns / 2))
        found = theta_quotients(self.thetas.table, gmpy2.cos(angle), gmpy2.sin(angle))
        one, two, three = (factor * x for factor, x in zip(self.factors, found, strict=True))
        return one, two, three

    def moved(self, time: Real) -> tuple[Real, Real, Real]:
        """The roots R₁, R₂ and R₃ at a time after the start."""
        return self.at(time / self.period + self.phase)

    def packed(self, rate: Real) -> OvalThetas:
        """The oval in double-doubles, for a phase that makes ``rate`` turns per unit time."""
        numbers = double_double_row((rate, self.phase, *self.factors))
        return OvalThetas(numbers, double_double_row(self.thetas.few), inverse_factorials())

    def time_below(self, depth: Real) -> Real:
        """The length of the imaginary time in which Z moves from e₁ to e₁ − ``depth``."""
        N = self.field
        return first_kind(N, self.thetas.others, N.sqrt(depth), N.sqrt(self.swing)) / N.sqrt(self.breadth)

    def time_above(self, height: Real) -> Real:
        """The time from Z = e₃ + ``height`` to infinity."""
        N = self.field
        return first_kind(N, self.thetas.levels, N.sqrt(self.breadth), N.sqrt(height)) / N.sqrt(self.breadth)


class CubicModel(NamedTuple):
    """A cubic with leading coefficient ``lead`` = ℓ > 0, and the start of a motion on it.

    ``first``, ``swing`` and ``above`` are x₁, x₂ − x₁ and x₃ − x₂ for the roots x₁ ≤ x₂ ≤ x₃. ``place`` and ``height``
    are x and y of the point; ``pace`` is dx/y per unit time. ``side`` is −1 if the sign of x was reversed. ``pole`` is
    the root that was moved to infinity.
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

    ``place(K)`` returns the :class:`Start` over K. PrecisionLoss if branch points are not real or too close, or
    if the point is on an unbounded branch or at rest. It is also raised if the start has data other than lifts, or
    lifts on a model of degree 4.
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
            model = _model(start, roots)
            low, high = max(model.place - model.first, N.zero), max(model.first + model.swing - model.place, N.zero)
            side = 1 if model.height * model.pace >= 0 else -1
            oval = EllipticOval(N, model.swing, model.above, (side * N.sqrt(low), N.sqrt(high)))
            lead = N.sqrt(model.lead)
            self._oval = oval.packed(lead * abs(model.pace) / (2 * oval.period))
            # the roots R₁ and R₂ have twice the period of Z
            self.paces, self._side = [float(self._oval.numbers[0, 0]) / 2], model.side
            self._first = Column.of(model.first)
            self._pole = None if model.pole is None else Column.of(model.pole)
            # y = slope·R₁R₂R₃
            slope = lead if model.pace > 0 else -lead
            self._slope = Column.of(slope)
            self._lifts = [_lift(N, model, slope, oval, (e, datum)) for e, datum in zip(ends, start.data, strict=True)]

    def at(self, times: np.ndarray) -> Extended:
        """The pairs with their data at N times, as columns of N numbers."""
        given, out = np.zeros((len(times), 2)), np.empty((3 * len(times), 2))
        given[:, 0] = times
        LIBRARY.oval_points(self._oval, given, (0, 1), out)
        one, two, three = parts = [Column(*np.ascontiguousarray(x.T)) for x in out.reshape(3, -1, 2)]
        x, y = self._side * (self._first + one * one), self._slope * one * two * three
        if self._pole is not None:
            x, y = self._pole - 1 / x, y / (x * x)
        data = tuple(
            (kappa, size * parts[which], slope * parts[which - 1] * parts[which - 2])
            for kappa, size, slope, which in self._lifts
        )
        return Extended((-x, Column(1.0)), (y,), data)


def _model(start: Start, roots: Sequence[Real]) -> CubicModel:
    """The cubic model of a start; ``roots`` are the roots of f in ascending order."""
    lead, x, y, pace, pole = start.f[-1], -start.u[0], start.v[0], start.direction[0], None
    if len(roots) == 4:
        *roots, pole = roots
        lead, x = prod((pole - e for e in roots), start=-lead), 1 / (pole - x)
        roots, y = [1 / (pole - e) for e in roots], y * x * x
    side = 1
    if lead < 0:
        side, lead, x, pace, roots = -1, -lead, -x, -pace, [-e for e in reversed(roots)]
    first, second, third = roots
    if not (pace and x - first >= -SMALL * (third - first) <= second - x):
        raise PrecisionLoss("the point is not between branch points")
    return CubicModel(lead, first, second - first, third - second, x, y, pace, side, pole)


def _lift(
    N: LongField, model: CubicModel, slope: Real, oval: EllipticOval, given: tuple[Real, Sequence[Real]]
) -> tuple[Column, Column, Column, int]:
    """(κ, s, n, k) for the lift (κ, σ, ν) at e: at all times σ is s times the root with index k among R₁, R₂ and R₃,
    and ν is n times the product of the other two. ``given`` is e with the lift at the start.
    """
    e, (kappa, sigma, nu) = given
    x, swing = model.side * e, model.swing
    gaps = [abs(x - root) for root in (model.first, model.first + swing, model.first + swing + model.above)]
    which = gaps.index(min(gaps))
    square = model.side * (-1, 1, 1)[which] / kappa
    if not square > 0:
        raise PrecisionLoss(APART)
    size = N.sqrt(square)
    own, one, other = (oval.start[k] for k in (which, which - 1, which - 2))
    # the sign of s follows from σ, or from ν if the point is at e, where σ = 0
    if (own * sigma if own * own > NEAR * NEAR * swing else one * other * slope / kappa * nu) < 0:
        size = -size
    return Column.of(kappa), Column.of(size), Column.of(slope / (kappa * size)), which


def means(N: LongField, b: Real) -> list[tuple[Real, Real]]:
    """The pairs (a_n, b_n) of the arithmetic-geometric mean of a_0 = 1 and b_0 = ``b``; in the last, a_n = b_n."""
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
    size = N.sqrt(sine * sine + cosine * cosine)
    # ``rough`` is the angle in floats, which counts the full turns that (s, c) does not show
    s, c = sine / size, cosine / size
    rough = atan2(s, c)
    for a, b in levels[:-1]:
        # φ is replaced by φ + ψ with a·tan ψ = b·tan φ
        one, two, both = a * c * c, b * s * s, s * c
        s, c = (a + b) * both, one - two
        size = N.sqrt(s * s + c * c)
        rough = 2 * rough - atan2((a - b) * both / size, (one + two) / size)
        s, c = s / size, c / size
    rest = gmpy2.atan2(s, c)
    rounds = round((rough - float(rest)) / (2 * pi))
    return (rest + 2 * rounds * half_turn()) / 2 ** (len(levels) - 1)


def first_kind(N: LongField, levels: list[tuple[Real, Real]], sine: Real, cosine: Real) -> Real:
    """F(φ), the elliptic integral of the first kind; arguments as for :func:`part_of_round`."""
    return part_of_round(N, levels, sine, cosine) / levels[-1][0]


def terms_of(nome: Real, last: Real) -> int:
    """The number of terms of the theta series that are larger than ``last``; at least 2."""
    count = 2
    while nome ** (count * count) >= last:
        count += 1
    return count


class ThetaTable(NamedTuple):
    """The constants of the theta functions of one modulus, in long numbers.

    ``levels`` are the :func:`means` of 1 and k', ``others`` those of 1 and k (none if k = 0). ``table`` is that of
    :class:`OvalThetas`, and ``at_zero`` are θ₂, θ₃ and θ₄ at 0. θ₁ and θ₂ are divided by their common first
    coefficient.
    """

    levels: list[tuple[Real, Real]]
    others: list[tuple[Real, Real]]
    nome: Real
    table: list[Real]
    at_zero: tuple[Real, Real, Real]

    @property
    def mean(self) -> Real:
        """The arithmetic-geometric mean of 1 and k'."""
        return self.levels[-1][0]

    @property
    def few(self) -> list[Real]:
        """The rows of ``table`` that double-doubles need; PrecisionLoss near a separatrix."""
        count = terms_of(self.nome, LAST)
        if not count < MOST_TERMS:
            raise PrecisionLoss("this motion is too near to a separatrix")
        return self.table[: 4 * count]


def theta_table(N: LongField, k: Real, k1: Real) -> ThetaTable:
    """The ThetaTable of the modulus k, k² + k₁² = 1."""
    levels, others = means(N, k1), means(N, k) if k else []
    # e^(−πK'/K), where K and K' are proportional to 1/mean(1, k₁) and 1/mean(1, k)
    nome = gmpy2.exp(-half_turn() * levels[-1][0] / others[-1][0]) if k else N.zero
    odd: list[Real] = []
    even: list[Real] = []
    table: list[Real] = []
    power, square = N.one, N.one
    # ``power`` is nome^n, ``square`` is nome^(n²)
    while len(odd) < 2 or square >= N.eps:
        o, e = square * power, 2 * square if odd else N.one
        table += [-o, o, e, -e] if len(odd) % 2 else [o, o, e, e]
        odd.append(o)
        even.append(e)
        power = power * nome
        square = o * power
    return ThetaTable(levels, others, nome, table, (sum(odd), sum(even), sum(even[::2]) - sum(even[1::2])))
