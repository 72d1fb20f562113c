"""Motions of genus 2 on a compact real torus at the compiled speed of the ball.

A real curve y² = f(x) whose roots are all real has two ovals that the points of a pair run round. An abscissa ξ,
x = A + Bξ, takes it to the curve that :mod:`integrable.torus` knows, (ξ − ζ)Π(α_i − ξ)(1 − ξ) with the ovals before
ξ = 1; on models of even degree the largest root E has been sent to infinity before, by 1/(E − x). Corners, periods and
translations are those of the ball there; what is another is the direction, and what is read: the pair and its lifts.
Data of the second and third kind, and time where it is not linear, are integrals of functions of U along the motion
(:mod:`integrable.mumford.torus_integrals`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import pi
from typing import Any, NamedTuple

import numpy as np

from integrable.moving_point.bare_problem import BareProblem
from integrable.mumford.columns import Column, Columns
from integrable.mumford.fields import cofactor, second_kind_rate
from integrable.mumford.motion import Start
from integrable.mumford.torus_integrals import GridRate, TorusIntegral, datum_after
from integrable.torus.access import MOST_TURNS, TorusClock
from integrable.torus.corners import Corners
from integrable.torus.loops import CompiledLoops
from integrable.torus.witness import TURNS
from jacobian import MP, RR, poly
from jacobian.errors import PrecisionLoss
from jacobian.numbers.long_reals import BareReals
from jacobian.periods.quadrature import Numbers
from jacobian.periods.roots import check_separated, conjugated, simple_roots
from jacobian.relatives.extended import Extended, Lift, SecondKind, ThirdKind

DIGITS = 50
# U at a branch point, beside x², where σ is not read off it
SMALL = 1e-20
MOST_CELLS, MOST_SAMPLES = 1 << 12, 1 << 16
# turns to the witness of a clock's mean rate, and those up to which it serves floats
FAR, CLOCKED = 2.0**40, 2.0**26
# numbers of a row: U, V, and σ and ν at three ends of ovals and at the root beyond them
COLUMNS = 12
APART = "the points of the pair are not one in each oval"


class Model(NamedTuple):
    """A curve, its pair u₀, u₁ and v₀, v₁, the direction, and the roots, ascending on even models."""

    lead: Any
    u: Sequence[Any]
    v: Sequence[Any]
    direction: Sequence[Any]
    roots: Sequence[Any]


class Setup(NamedTuple):
    """What :class:`Corners` takes of a motion: α_i, κ_i, the moving point, ζ and d in ξ, and the kinds of numbers."""

    bare_problem: BareProblem
    wide: Any
    reals: BareReals
    floats_given: None = None


class RealTorus(Corners):
    """D of a :class:`Start` of genus 2 in double-double numbers, at any times at once.

    ``place(K)`` makes the start in the numbers of K; ``rate(K, u)`` is dt/dτ > 0 at a pair where time is not linear.
    PrecisionLoss where there is no such torus: branch points that are not real or too close, points that are not one in
    each oval, lifts at other points or on a model of even degree.
    """

    def __init__(self, place: Callable[[Any], Start], rate: Callable[..., Any] | None = None) -> None:
        K, start = MP(DIGITS), place(MP(DIGITS))
        if len(start.v) != 2 or not all(isinstance(kind, (Lift, SecondKind, ThirdKind)) for kind in start.kinds):
            raise PrecisionLoss("a motion of genus 2 without lifts but at branch points is needed")
        ends = [kind.e for kind in start.kinds if isinstance(kind, Lift)]
        roots = real_roots(K, start.f, ends)
        # what is sent to infinity
        self._pole = roots[-1] if len(roots) == 6 else None
        lifts = {kind.e: data for kind, data in zip(start.kinds, start.data, strict=True) if isinstance(kind, Lift)}
        if self._pole is not None and lifts:
            raise PrecisionLoss("lifts on a model of even degree")
        odd = Model(start.f[-1], start.u[:2], start.v, start.direction, roots)
        model = odd if self._pole is None else without_root(odd)
        super().__init__(self._set_up(K, model, lifts), CompiledLoops(), MOST_CELLS)  # type: ignore[arg-type]
        self._place_in_units(K, model.direction)
        self._kinds, self._first = start.kinds, start.data
        self._integrals(start, rate)

    @property
    def witnesses(self) -> np.ndarray:
        """Times at which every sign that a period changes has been changed, in both directions; by a clock a far one
        too, which its mean rate decides.
        """
        farthest = MOST_TURNS / 8 / self._fastest
        tau = np.clip([turns / float(nu) for nu in self.frequencies for turns in TURNS], -farthest, farthest)
        return tau if self.clock is None else np.append(tau, FAR / self._fastest) * float(self.mean)

    def at(self, times: np.ndarray) -> Extended:
        """The pairs with their data, of columns of N numbers."""
        turns = self._turns(times)
        if turns > MOST_TURNS:
            raise PrecisionLoss(f"{turns:.1e} turns of a phase are more than double-double numbers hold")
        tau, phases = self._phases(times)
        u, v, lifts = self.pairs(phases)
        if self._second_kind is None:
            return Extended(u, v, tuple(lifts))
        omega, read = self._second_kind.at(times, tau, phases), iter(lifts)
        data = [
            next(read) if isinstance(kind, Lift) else datum_after(kind, Column.of(first), omega)
            for kind, first in zip(self._kinds, self._first, strict=True)
        ]
        return Extended(u, v, tuple(data))

    def reaches(self, times: np.ndarray) -> bool:
        """Whether what the witnesses are right to makes these times right to the last bits of floats."""
        return self._turns(times) <= (MOST_TURNS if self.clock is None else CLOCKED)

    def _turns(self, times: np.ndarray) -> float:
        rate = 1.0 if self.clock is None else float(self.mean)
        return float(np.abs(times).max(initial=0)) / rate * self._fastest

    def _phases(self, times: np.ndarray) -> tuple[Column, np.ndarray]:
        """τ, and both phases in turns, shape (2N, 2)."""
        if self.clock is None:
            tau = Column(times, np.zeros(len(times)))
            turned = [tau * Column.of(nu) for nu in self.frequencies]
            return tau, np.stack([np.stack([x.hi, x.lo], axis=-1) for x in turned], axis=1).reshape(-1, 2)
        phases, delays = self.clock.phases(times)
        return Column(times) / Column.of(self.mean) + Column(delays), phases

    def pairs(self, phases: np.ndarray) -> tuple[tuple[Any, ...], tuple[Any, ...], list[tuple[Any, ...]]]:
        """U, V and the lifts at pairs of phases in turns, shape (2N, 2), as columns."""
        out = self.loops.room(COLUMNS * (len(phases) // 2))
        self.loops.points_at_phases(self.torus, self._row, phases, out)
        rows = np.ascontiguousarray(out.reshape(-1, COLUMNS, 2).T)
        u0, u1, v0, v1, *pairs = (Column(high, low) for high, low in zip(rows[0], rows[1], strict=True))
        a, b, height = self._numbers
        slope = height * v1 / b
        u: Sequence[Any] = (b * b * u0 - a * b * u1 + a * a, b * u1 - 2 * a)
        v: Sequence[Any] = (height * v0 - a * slope, slope)
        if self._pole is not None:
            u, v = with_root(Column.of(self._pole), u, v)
        lifts = [
            (kappa, size * pairs[place], size * height / (b * b) * pairs[place + 4])
            for kappa, size, place in self._read
        ]
        return (*u, Column(1.0)), tuple(v), lifts

    def _integrals(self, start: Start, rate: Callable[..., Any] | None) -> None:
        """The clock, and Ω where a datum needs it."""
        self._most, scale, clock = MOST_SAMPLES, 2 * pi * self._fastest, None
        self.clock: TorusClock | None = None
        self._second_kind: TorusIntegral | None = None
        if rate is not None:
            clock = GridRate(self, lambda phases: rate(Columns(), self.pairs(phases)[0]), scale)
            if not clock.values.hi.min() > 0:
                raise PrecisionLoss("time does not grow along this motion")
            self.mean = mean = clock.mean
            nu1, nu2 = self.frequencies
            rates = (nu1 / mean, nu2 / mean, nu1, nu2, 1 / mean, mean, nu1, nu2, mean, 2 * self.setup.wide.context.pi)
            self.clock = TorusClock(self, *clock.spectrum, self.loops.row(rates), scale)
        if not all(isinstance(kind, Lift) for kind in start.kinds):
            direction = tuple(map(Column.of, start.direction))
            of_omega = GridRate(
                self, lambda phases: second_kind_rate(Columns(), self.pairs(phases)[0], direction), scale
            )
            self._second_kind = TorusIntegral(of_omega, clock, self.frequencies)

    def _set_up(self, K: Any, model: Model, lifts: dict[Any, tuple[Any, ...]]) -> Setup:
        """The motion in ξ: x = first + second·ξ, y = height·η; and where and by what factor lifts are read."""
        sign = 1 if model.lead > 0 else -1
        e1, e2, e3, e4, far = sorted(model.roots, key=lambda e: sign * e)
        second = 2 * (far - e1)
        first, height = far - second, K.sqrt(abs(model.lead) * abs(second) ** 5)
        self._affine = first, second, height
        # of the inner ends of the ovals the one without a lift is ζ
        middle, zeta = (e2, e3) if e2 in lifts else (e3, e2)
        axes, sizes, sigmas, nus = (e1, middle, e4), [], [], []
        for e, sense in zip(axes, (1, -1, 1), strict=True):
            kappa, sigma, nu = lifts.get(e) or standard(K, model, e, sense)
            if kappa * sense <= 0:
                raise PrecisionLoss(APART)
            sizes.append(abs(second) * K.sqrt(sense / kappa))
            sigmas.append(sigma / sizes[-1])
            nus.append(nu * second**2 / (height * sizes[-1]))
        if far in lifts:
            sizes.append(abs(second) / K.sqrt(lifts[far][0]) * (1 if lifts[far][1] > 0 else -1))
        order = [(*axes, far).index(e) for e in lifts]
        self._read = [(Column.of(data[0]), sizes[i], i) for data, i in zip(lifts.values(), order, strict=True)]
        xi = tuple((e - first) / second for e in (*axes, zeta, far))
        (u0, u1), (v0, v1) = model.u, model.v
        u = (((first + u1) * first + u0) / second**2, (u1 + 2 * first) / second)
        v = ((v0 + v1 * first) / height, v1 * second / height)
        row = (*xi[:3], K.one, -K.one, K.one, K.one, K.zero)
        reals = BareReals(K.context.prec)
        axes, point = reals.row(row), reals.row((*u, *v, *sigmas, *nus))
        zeta, one, none = reals.number(xi[3]), reals.number(1), reals.number(0)
        return Setup(BareProblem((none,) * 6, axes, point, zeta, one, one, one, none, None, one), K, reals)

    def _place_in_units(self, K: Any, direction: Sequence[Any]) -> None:
        """x and y in the units of the torus, and how fast the phases go."""
        origin, length, lift = self.setup.reals.element(K, self.units.origin), self.units.length, self.units.lift
        first, second, height = self._affine
        a, b, height = first + second * origin, second * length, height * length**2 * lift
        self._numbers = tuple(map(Column.of, (a, b, height)))
        self._read = [(k, Column.of(size * (length if i == 3 else 1)), i) for k, size, i in self._read]
        self.frequencies = self.turns_along(
            direction[0] * height / b, (direction[1] - a * direction[0]) * height / b**2
        )
        self._fastest = max(abs(float(nu)) for nu in self.frequencies)
        self._row = self.loops.row(((1 - origin) / length,))


def real_roots(K: Any, f: poly.Poly, known: Sequence[Any]) -> list[Any]:
    """The roots of f, ascending, some of them ``known``; PrecisionLoss where one is not real, or two are not told
    apart.
    """
    rest = poly.quotient(K, f, poly.from_roots(K, known))
    # in floats first, where double roots are told soonest
    for numbers in (Numbers(RR), Numbers(K)):
        roots = conjugated(numbers, simple_roots(numbers, [numbers.convert(c) for c in rest]))
        if any(x.imag for x in roots):
            raise PrecisionLoss("branch points are not real")
    roots = sorted([*known, *(K.coerce(x.real) for x in roots)])
    check_separated(Numbers(K), roots)
    return roots


def standard(K: Any, model: Model, e: Any, kappa: int) -> tuple[Any, Any, Any]:
    """(κ, σ, ν) at a branch point e where nothing is carried: κσ² = U, κσν = V, κν² = −W with κ = ±1."""
    whole, v = (*model.u, K.one), tuple(model.v)
    height, slope = kappa * poly.evaluate(K, whole, e), kappa * poly.evaluate(K, v, e)
    if height > SMALL * e**2:
        sigma = K.sqrt(height)
        return kappa, sigma, slope / sigma
    # a point of the pair is here
    f = poly.scale(K, model.lead, poly.from_roots(K, model.roots))
    square = -kappa * poly.evaluate(K, cofactor(K, f, whole, v), e)
    if square <= 0:
        raise PrecisionLoss(APART)
    nu = K.sqrt(square)
    return kappa, slope / nu, nu


def without_root(even: Model) -> Model:
    """The motion in X = 1/(E − x), E the largest root of a model of even degree, y = y_X/X³."""
    (u0, u1), (v0, v1), (*roots, pole) = even.u, even.v, even.roots
    lead = -even.lead
    for e in roots:
        lead *= pole - e
    # U = (x − E)² + a(x − E) + b, and X³y = (mX − v₁)X² with m = V(E), X² = sX − p on the pair
    a, b, m = u1 + 2 * pole, (pole + u1) * pole + u0, v1 * pole + v0
    s, p = a / b, 1 / b
    v = (-m * s * p + v1 * p, m * (s * s - p) - v1 * s)
    c0, c1 = even.direction
    return Model(lead, (p, -s), v, (pole * c0 - c1, c0), [1 / (pole - e) for e in roots])


def with_root(pole: Any, u: Sequence[Any], v: Sequence[Any]) -> tuple[Sequence[Any], Sequence[Any]]:
    """The pairs in x = E − 1/X of pairs in X."""
    (p, s), (y, slope) = u, v
    for _ in range(3):
        # over X, 1/X = −(X + s)/p on the pair
        y, slope = slope - s * y / p, -y / p
    a, b = -s / p, 1 / p
    # X = p(x − E) − s there
    slope, y = slope * p, y - slope * s
    return (pole * pole - a * pole + b, a - 2 * pole), (y - slope * pole, slope)
