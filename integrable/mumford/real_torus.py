"""Motions of genus 2 on a compact real torus, compiled with the loops of the ball.

A curve y² = f(x) whose roots are all real has two bounded ovals, on which the points of a pair move. The substitution
x = A + Bξ transforms it to the curve of :mod:`integrable.torus`, (ξ − ζ)Π(α_i − ξ)(1 − ξ), with the ovals at ξ < 1. On
models of even degree 1/(E − x) first moves the largest root E to infinity. Corners, periods and translations are those
of the ball. The direction differs, and so does the result, a pair and its lifts.

For geodesics dt/dτ is |U| at the root beyond the ovals; for a body it is 1/√U there. So the clock of a geodesic is
computed like that of a body. Its mean is a determinant of integrals over the ovals.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from math import pi
from typing import Any, NamedTuple

import numpy as np

from integrable.moving_point.arithmetic import MOST_TURNS
from integrable.moving_point.problem import Problem
from integrable.mumford.columns import Column
from integrable.mumford.fields import cofactor
from integrable.mumford.motion import Start
from integrable.torus.access import TorusClock, resolved_spectrum
from integrable.torus.corners import Corners
from integrable.torus.lattice import GivenSource
from integrable.torus.loops import CompiledLoops
from integrable.torus.survey import SPACING
from integrable.torus.witness import left_open
from jacobian import MP, RR, poly
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.numbers.long_reals import BareReals
from jacobian.periods.quadrature import working_numbers
from jacobian.periods.roots import conjugated, simple_roots
from jacobian.relatives.extended import Extended, Lift, SecondKind

# bits in which a torus is set up; digits of its periods
BITS, DIGITS = 200, 50
# size of U at a branch point, relative to x², below which σ is not computed from it
SMALL = 1e-20
MOST_CELLS, MOST_SAMPLES = 1 << 12, 1 << 16
# length of a row: U, V, and σ and ν at three branch points on the ovals and at the one beyond them
COLUMNS = 12
APART = "the points of the pair are not one in each oval"
# largest number of Newton steps to a root; allowed relative difference between the area of a torus and that of its
# periods (the largest for 147 random geodesics was 4e-31)
MOST_STEPS, SAME = 20, 1e-27


class OtherOvals(PrecisionLoss):
    """Raised if a branch point is not real, or if the pair does not have one point in each bounded oval."""


class OvalModel(NamedTuple):
    """A curve by its leading coefficient and roots, its pair u₀, u₁ and v₀, v₁, and the direction.

    The roots of a model of even degree ascend.
    """

    lead: Any
    u: Sequence[Any]
    v: Sequence[Any]
    direction: Sequence[Any]
    roots: Sequence[Any]


class RealTorus(Corners):
    """D of a :class:`Start` of genus 2 in double-doubles, at any times.

    ``place(K)`` returns the start in the numbers of K. A datum of the second kind must be the time of the motion, with
    dt/dτ = |U| at the root beyond the ovals. PrecisionLoss if branch points are not real or too close, if the ovals do
    not have one point each, and for lifts at other points or on a model of even degree.
    """

    _aslant = True

    def __init__(self, place: Callable[[Any], Start]) -> None:
        with LongField(BITS) as K:
            start = place(K)
            if len(start.v) != 2 or not all(isinstance(kind, (Lift, SecondKind)) for kind in start.kinds):
                raise PrecisionLoss("a motion of genus 2 without lifts but at branch points is needed")
            lifts = {kind.e: data for kind, data in zip(start.kinds, start.data, strict=True) if isinstance(kind, Lift)}
            roots = real_roots(K, start.f, list(lifts))
            # the root that is moved to infinity
            self._pole = Column.of(roots[-1]) if len(roots) == 6 else None
            if self._pole is not None and lifts:
                raise PrecisionLoss("lifts on a model of even degree")
            odd = OvalModel(start.f[-1], start.u[:2], start.v, start.direction, roots)
            model = odd if self._pole is None else without_root(odd)
            self._direction = model.direction
            super().__init__(self._given(K, model, lifts), CompiledLoops(), MOST_CELLS)
            self._kinds, self._first = start.kinds, start.data
            self.clock: TorusClock | None = None
            if not all(isinstance(kind, Lift) for kind in start.kinds):
                self._pace = Column.of(-start.direction[0])
                self._make_clock(K, model)

    @property
    def witnesses(self) -> np.ndarray:
        """Times at which the torus is compared with another method (:func:`integrable.torus.witness.left_open`)."""
        return left_open([*map(float, self.frequencies)], self.departs) * (
            1.0 if self.clock is None else float(self._mean)
        )

    def at(self, times: np.ndarray) -> Extended:
        """The pairs with their data at N times, as columns of N numbers."""
        turns = self._turns(times)
        if turns > MOST_TURNS:
            raise PrecisionLoss(f"{turns:.1e} turns of a phase are more than double-double numbers hold")
        u, v, lifts = self.pairs(self._phases(times))
        read = iter(lifts)
        data = [
            next(read) if isinstance(kind, Lift) else Column.of(first) + self._pace * Column(times)
            for kind, first in zip(self._kinds, self._first, strict=True)
        ]
        return Extended(u, v, tuple(data))

    def reaches(self, times: np.ndarray) -> bool:
        """Whether double-doubles resolve the fraction of a turn at all of these times."""
        return self._turns(times) <= MOST_TURNS

    def _turns(self, times: np.ndarray) -> float:
        rate = 1.0 if self.clock is None else float(self._mean)
        return float(np.abs(times).max(initial=0)) / rate * self._fastest

    def _phases(self, times: np.ndarray) -> np.ndarray:
        """Both phases in turns, shape (2N, 2)."""
        if self.clock is not None:
            return self.clock.phases(times)[0]
        turned = [Column(times) * nu for nu in map(Column.of, self.frequencies)]
        return np.stack([np.stack([x.hi, x.lo], axis=-1) for x in turned], axis=1).reshape(-1, 2)

    def pairs(self, phases: np.ndarray) -> tuple[tuple[Any, ...], tuple[Any, ...], list[tuple[Any, ...]]]:
        """U, V and the lifts, as columns, at N pairs of phases in turns; ``phases`` has the shape (2N, 2)."""
        out = self.loops.room(COLUMNS * (len(phases) // 2))
        self.loops.points_at_phases(self.torus, self._row, phases, out)
        rows = np.ascontiguousarray(out.reshape(-1, COLUMNS, 2).T)
        u0, u1, v0, v1, *pairs = (Column(high, low) for high, low in zip(rows[0], rows[1], strict=True))
        a, b, height = self._numbers
        slope = height * v1 / b
        u: Sequence[Any] = (b * b * u0 - a * b * u1 + a * a, b * u1 - 2 * a)
        v: Sequence[Any] = (height * v0 - a * slope, slope)
        if self._pole is not None:
            u, v = with_root(self._pole, u, v)
        lifts = [
            (kappa, size * pairs[place], size * height / (b * b) * pairs[place + 4])
            for kappa, size, place in self._read
        ]
        return (*u, Column(1.0)), tuple(v), lifts

    def _make_clock(self, K: LongField, model: OvalModel) -> None:
        """Sets the clock of a motion with dt/dτ = |U| at the root beyond the ovals, which must be x = 0."""
        first, second, _ = self._affine
        if model.direction[1] != 0 or abs(first + second) > SMALL * abs(second):
            raise PrecisionLoss("a datum of the second kind that is not the time")
        wide, loops, element = self.setup.wide, self.loops, self.setup.reals.element
        sums = loops.room(2)
        loops.mean_height(self._motion, loops.row((wide.context.exp(-wide.coerce(SPACING) / 2),)), sums)
        mean, area = loops.wide(sums, wide)
        (a1, b1), (a2, b2) = (loops.wide(period, wide) for period in self.lattice.periods)
        if not abs(area / abs(a1 * b2 - b1 * a2) - 1) <= SAME:
            raise PrecisionLoss("integrals over the ovals are not those of the periods")
        size = element(wide, second**2)
        self._mean = mean = mean * size * self.units.lift**4
        scale, (nu1, nu2) = 2 * pi * self._fastest, self.frequencies
        # Σσ² is U(1)/Π(1 − α_i)
        heights = float(second**2 * self._beyond)
        self._most = MOST_SAMPLES
        tables: dict[int, np.ndarray] = {}

        def samples(sizes: tuple[int, int], known: np.ndarray | None) -> np.ndarray:
            rates = self.samples(sizes, None if known is None else tables[known.size])
            slow = Column(rates[..., 0], rates[..., 1])
            found = heights / (slow * slow)
            table = np.stack([found.hi, found.lo], axis=-1)
            tables[table.size] = rates
            return table

        resolve = partial(self.resolved, samples=samples)
        spectrum = resolved_spectrum(loops, resolve, list(map(float, self.frequencies)), scale, loops.noise)
        rates = (nu1 / mean, nu2 / mean, nu1, nu2, 1 / mean, mean, nu1, nu2, mean, 2 * wide.context.pi)
        self.clock = TorusClock(loops, spectrum, loops.row(rates), scale, max(self.closure, loops.noise / 64))

    def _given(self, K: LongField, model: OvalModel, lifts: dict[Any, tuple[Any, ...]]) -> GivenSource:
        """The motion in ξ, η with x = first + second·ξ, y = height·η; also sets how to read lifts from a row."""
        sign = 1 if model.lead > 0 else -1
        e1, e2, e3, e4, far = sorted(model.roots, key=lambda e: sign * e)
        second = 2 * (far - e1)
        first, height = far - second, K.sqrt(abs(model.lead) * abs(second) ** 5)
        self._affine = first, second, height
        # ζ is the inner end of an oval that carries no lift
        middle, zeta = (e2, e3) if e2 in lifts else (e3, e2)
        axes, sizes, sigmas, nus = (e1, middle, e4), [], [], []
        alphas = [(e - first) / second for e in axes]
        slopes = poly.derivative(K, poly.from_roots(K, alphas))
        # with these κ, Σσ² is U(1)/Π(1 − α_i), as for a body
        kappas = [poly.evaluate(K, slopes, e) * (1 - e) for e in alphas]
        self._beyond = (1 - alphas[0]) * (1 - alphas[1]) * (1 - alphas[2])
        for e, sense, own in zip(axes, (1, -1, 1), kappas, strict=True):
            kappa, sigma, nu = lifts.get(e) or standard(K, model, e, sense)
            if kappa * sense <= 0:
                raise OtherOvals(APART)
            sizes.append(abs(second) * K.sqrt(own / kappa))
            sigmas.append(sigma / sizes[-1])
            nus.append(nu * second**2 / (height * sizes[-1]))
        if far in lifts:
            sizes.append(abs(second) / K.sqrt(lifts[far][0]) * (1 if lifts[far][1] > 0 else -1))
        order = [(*axes, far).index(e) for e in lifts]
        self._read = [(Column.of(data[0]), sizes[i], i) for data, i in zip(lifts.values(), order, strict=True)]
        (u0, u1), (v0, v1) = model.u, model.v
        u = (((first + u1) * first + u0) / second**2, (u1 + 2 * first) / second)
        v = ((v0 + v1 * first) / height, v1 * second / height)
        one, none = K.one, K.zero
        row, point = (*alphas, *kappas, one, none), (*u, *v, *sigmas, *nus)
        problem = Problem((none,) * 6, row, point, (zeta - first) / second, one, one, one, none, None, one)
        return GivenSource(problem, MP(DIGITS), BareReals(K.bits))

    def _made_rates(self, motion: Any) -> Any:
        """The rates along the motion's own direction, with x and y in the units of the torus."""
        (origin, length, lift), direction = self.units, self._direction
        first, second, height = self._affine
        a, b, height = first + second * origin, second * length, height * length**2 * lift
        self._numbers = tuple(map(Column.of, (a, b, height)))
        self._read = [(k, Column.of(size * (length if i == 3 else 1)), i) for k, size, i in self._read]
        element, wide = self.setup.reals.element, self.setup.wide
        along = direction[0] * height / b, (direction[1] - a * direction[0]) * height / b**2
        self.frequencies = self.turns_along(*(element(wide, x) for x in along))
        rates = super()._made_rates(motion)
        rates[6:8], rates[14:] = self.loops.row(self.frequencies), self.loops.row(along)
        self._fastest = max(abs(float(nu)) for nu in self.frequencies)
        self._row = self.loops.row(((1 - origin) / length,))
        return rates


def real_roots(K: LongField, f: poly.Poly, known: Sequence[Real]) -> list[Real]:
    """The roots of f in ascending order; those in ``known`` are taken as exact.

    PrecisionLoss if a root is not real, or if two roots are too close.
    """
    rest = poly.quotient(K, f, poly.from_roots(K, known))
    numbers, slope = working_numbers(RR), poly.derivative(K, rest)
    rough = simple_roots(numbers, [*map(complex, rest)])
    if len(rough) > 1:
        rough = conjugated(numbers, rough)
    if any(x.imag for x in rough):
        raise OtherOvals("branch points are not real")
    found = list(known)
    for x in (K.coerce(e.real) for e in rough):
        for _ in range(MOST_STEPS):
            move = poly.evaluate(K, rest, x) / poly.evaluate(K, slope, x)
            x -= move
            if not abs(move) > K.root_of_eps * abs(x):
                break
        found.append(x)
    found.sort()
    size = max(map(abs, found))
    if not all(y - x > K.root_of_eps * size for x, y in pairwise(found)):
        raise PrecisionLoss(f"two of the branch points {[*map(float, found)]} are not told apart")
    return found


def standard(K: LongField, model: OvalModel, e: Real, kappa: int) -> tuple[Real, Real, Real]:
    """(κ, σ, ν) at a branch point e that carries no lift: κσ² = U, κσν = V, κν² = −W with κ = ±1."""
    whole, v = (*model.u, K.one), tuple(model.v)
    height, slope = kappa * poly.evaluate(K, whole, e), kappa * poly.evaluate(K, v, e)
    if height > SMALL * e**2:
        sigma = K.sqrt(height)
        return kappa, sigma, slope / sigma
    # a point of the pair is at this branch point
    f = poly.scale(K, model.lead, poly.from_roots(K, model.roots))
    square = -kappa * poly.evaluate(K, cofactor(K, f, whole, v), e)
    if square <= 0:
        raise OtherOvals(APART)
    nu = K.sqrt(square)
    return kappa, slope / nu, nu


def without_root(even: OvalModel) -> OvalModel:
    """The motion in X = 1/(E − x), y = y_X/X³, where E is the largest root of a model of even degree."""
    (u0, u1), (v0, v1), (*roots, pole) = even.u, even.v, even.roots
    lead = -even.lead
    for e in roots:
        lead *= pole - e
    # U = (x − E)² + a(x − E) + b, and X³y = (mX − v₁)X² with m = V(E), X² = sX − p on the pair
    a, b, m = u1 + 2 * pole, (pole + u1) * pole + u0, v1 * pole + v0
    s, p = a / b, 1 / b
    v = (-m * s * p + v1 * p, m * (s * s - p) - v1 * s)
    c0, c1 = even.direction
    return OvalModel(lead, (p, -s), v, (pole * c0 - c1, c0), [1 / (pole - e) for e in roots])


def with_root(pole: Any, u: Sequence[Any], v: Sequence[Any]) -> tuple[tuple[Column, Column], tuple[Column, Column]]:
    """The pairs in x = E − 1/X, from pairs in X; E is ``pole``."""
    (p, s), (y, slope) = u, v
    for _ in range(3):
        # divide V by X: 1/X = −(X + s)/p on the pair
        y, slope = slope - s * y / p, -y / p
    a, b = -s / p, 1 / p
    # X = p(x − E) − s there
    slope, y = slope * p, y - slope * s
    return (pole * pole - a * pole + b, a - 2 * pole), (y - slope * pole, slope)
