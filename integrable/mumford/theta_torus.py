"""Motions of genus 2 on a real torus, by theta functions.

With the period matrices A and B, D = P₁ + P₂ has z = A⁻¹(∫_{r₀}^{P₁} + ∫_{r₀}^{P₂})(dx/y, x dx/y), r₀ a branch point; z
is linear in time. On y² = f(x) of degree 5

    √|U(r_i)| = |f'(r_i)/lead|^¼·|θ[η_i](z)/θ[η_∞](z)|,   V = −∂_{(0,1)}U,

where η_i is the odd characteristic of the branch point r_i (Thomae; Mumford 1984). If ∫_{r₀}^{r_i} = Ap + Bq, η_i is
η_0 + 2(q, p), and exactly one of the 16 η_0 makes all η_i odd. All of this is real in a basis whose A spans the real
periods. Models of degree 6 with real roots are first transformed by x ↦ 1/(E − x), where E is the largest root.

For geodesics dt/dτ is |U| at the root x = 0. The mean of dt/dτ is a quotient of determinants of integrals over the
ovals, and t is this mean times τ plus a Fourier series.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import pi
from typing import NamedTuple

import numpy as np

from integrable.moving_point.arithmetic import MOST_TURNS
from integrable.mumford.branch_points import (
    SMALL,
    PairModel,
    all_real,
    lift_of,
    long_roots,
    opened,
    with_root,
    without_root,
)
from integrable.mumford.columns import Column
from integrable.mumford.motion import Start
from integrable.torus.access import TorusClock, resolved_spectrum
from integrable.torus.body_torus import FIRST_SIZE, resolved
from integrable.torus.loops import CompiledLoops
from integrable.torus.theta_series import ThetaSums, half_turn, long_numbers, theta_sums
from integrable.torus.witness import witnesses
from jacobian.element import Complex, Real
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.numbers.double_double import double_double_row
from jacobian.periods.paths import image, moments
from jacobian.periods.real_basis import (
    NEARLY,
    Matrix,
    Whole,
    characteristics,
    coordinates,
    half_integrals,
    ratio,
    real_basis,
    solved,
)  # fmt: skip
from jacobian.relatives.extended import Extended, Lift, SecondKind

# bits in which a torus is set up
BITS = 160
# largest number of samples of a rate; beyond it, branch points nearly meet
MOST_SAMPLES = 1 << 16
# the check by the equations of motion covers a turn of each phase, except of one that is slower by more than this
# factor
SLOW = 8

# (κ, σ, ν) by branch point
Lifts = dict[Complex, tuple[Real, Real, Real]]


class Rate(NamedTuple):
    """dt/dτ of a motion: ``factor``·|U(e)|^(``power``/2), where e is a branch point beyond both ovals.

    ``power`` is 2 or −1.
    """

    e: Complex
    power: int
    factor: Complex


class ThetaTorus:
    """The divisor D of a motion of genus 2 at any times, in double-doubles.

    ``place(K)`` returns the :class:`Start` over K, ``rate(K)`` the :class:`Rate` of a motion whose time is not linear
    in τ. The only datum of the second kind that is allowed is the time t with dt/dτ = |U(0)|. PrecisionLoss for data
    other than lifts and this time, if branch points nearly meet, or if fewer than two are real. On a model of even
    degree it is also raised for lifts, and unless each oval has one point of the pair.
    """

    def __init__(self, place: Callable[[LongField], Start], rate: Callable[[LongField], Rate] | None = None) -> None:
        with long_numbers(BITS) as N:
            start = place(N)
            lifts = {kind.e: data for kind, data in zip(start.kinds, start.data, strict=True) if isinstance(kind, Lift)}
            others = [kind for kind in start.kinds if not isinstance(kind, Lift)]
            if len(start.v) != 2 or not all(isinstance(kind, SecondKind) for kind in others):
                raise PrecisionLoss("a motion of genus 2 without lifts but at branch points is needed")
            model = PairModel(start.f[-1], start.u[:2], start.v, start.direction, long_roots(N, start.f, list(lifts)))
            self._pole = None
            if len(model.roots) == 6:
                if lifts or not all_real(model.roots):
                    raise PrecisionLoss("lifts or complex branch points on a model of even degree")
                self._pole, model = Column.of(model.roots[-1]), without_root(model)
            model = opened(N, model, lifts)
            if len(model.roots) != 5:
                raise PrecisionLoss(f"{len(model.roots)} branch points, and five are needed")
            timed = Rate(N.zero, 2, N.one) if others else rate and rate(N)
            if others and (model.direction[1] or min(map(abs, model.roots)) > SMALL * max(map(abs, model.roots))):
                raise PrecisionLoss("a datum of the second kind that is not the time")
            self._kinds, self._first, self._direction = start.kinds, start.data, Column.of(model.direction[0])
            with LongField(BITS, complex=True) as Z:
                basis = theta_basis(Z, model)
                self._places = basis.places
                self._frequencies = [Column.of(x) for x in basis.frequencies]
                self._paces = [float(x) for x in basis.frequencies]
                self._make_lifts(Z, model, lifts, basis)
                self._clock = None if timed is None else self._made_clock(Z, basis, timed)

    @property
    def witnesses(self) -> np.ndarray:
        """Times more than one period of each phase from the start, in both directions, for a comparison.

        A phase much slower than the other is left out, because the equations of motion cannot be followed through its
        period.
        """
        fastest = max(map(abs, self._paces))
        return witnesses([nu for nu in self._paces if SLOW * abs(nu) >= fastest])

    def reaches(self, times: np.ndarray) -> bool:
        """Whether double-doubles resolve the fraction of a turn at all of these times."""
        return float(np.abs(times).max(initial=0)) * max(map(abs, self._paces)) <= MOST_TURNS

    def at(self, times: np.ndarray) -> Extended:
        """The pairs with their data at N times, as columns of N numbers."""
        if not self.reaches(times):
            turns = float(np.abs(times).max()) * max(map(abs, self._paces))
            raise PrecisionLoss(f"{turns:.1e} turns of a phase are more than double-double numbers hold")
        out = np.ascontiguousarray(sums_at(self._sums, self._phases(times)).transpose(1, 2, 0))
        data = [
            (kappa, size * Column(*out[2 * k + 1]), size * Column(*out[2 * k + 2]))
            for k, (kappa, size) in enumerate(self._sizes)
        ]
        # U and V are interpolated between their values at two branch points
        (e, first), (other, second) = list(zip(self._ends, data, strict=True))[:2]
        u_ends, v_ends = (
            [kappa * sigma * x[n] for kappa, sigma, x in ((d[0], d[1], d) for d in (first, second))] for n in (1, 2)
        )
        rise = (u_ends[0] - u_ends[1]) * self._over - (e + other)
        slope = (v_ends[0] - v_ends[1]) * self._over
        u, v = (u_ends[0] - e * (e + rise), rise), (v_ends[0] - slope * e, slope)
        if self._pole is not None:
            u, v = with_root(self._pole, u, v)
        read = iter(data)
        found = [
            next(read) if isinstance(kind, Lift) else Column.of(first) - self._direction * Column(times)
            for kind, first in zip(self._kinds, self._first, strict=True)
        ]
        return Extended((*u, Column(1.0)), v, tuple(found))

    def _phases(self, times: np.ndarray) -> np.ndarray:
        """Both phases in turns as double-doubles, shape (N, 2, 2)."""
        if self._clock is None:
            turned = [Column(times) * nu for nu in self._frequencies]
        else:
            rows = self._clock.phases(times)[0].reshape(-1, 2, 2)
            turned = [Column(rows[:, k, 0], rows[:, k, 1]) for k in (0, 1)]
        return pairs_of_columns([x + place for x, place in zip(turned, self._places, strict=True)])

    def _make_lifts(
        self,
        Z: LongField,
        model: PairModel,
        lifts: Lifts,
        basis: ThetaBasis,
    ) -> None:
        real = [e for e in model.roots if not e.imag]
        ends = [*lifts, *sorted((e for e in real if e not in lifts), key=lambda e: -abs(e - next(iter(lifts), 0)))]
        ends = ends[: max(2, len(lifts))]
        if len(ends) < 2:
            raise PrecisionLoss("fewer than two branch points are real")
        self._sums, sizes = basis.sums(Z, [model.roots.index(e) for e in ends])
        at_start = sums_at(self._sums, pairs_of_columns([x + Column(np.zeros(1)) for x in self._places]))[0]
        self._ends, self._sizes = [Column.of(e) for e in ends], []
        self._over = Column.of(1 / (ends[0] - ends[1]))
        for k, (e, size) in enumerate(zip(ends, sizes, strict=True)):
            kappa, sigma, nu = lifts.get(e) or lift_of(Z, model, e)
            own, rate = (float(x) for x in at_start[2 * k + 1 : 2 * k + 3, 0])
            # if σ vanishes, ν carries the sign
            sign = -1 if own * sigma + rate * nu * SMALL < 0 else 1
            self._sizes.append((Column.of(kappa), Column.of(sign * size / Z.sqrt(abs(kappa)).real)))

    def _made_clock(self, Z: LongField, basis: ThetaBasis, rate: Rate) -> TorusClock:
        if not all_real(basis.roots):
            raise PrecisionLoss("a time that is not linear in τ, and complex branch points")
        far = min(range(5), key=lambda i: abs(basis.roots[i] - rate.e))
        sums, (size,) = basis.sums(Z, [far])
        samples = partial(rates_on, sums, Column.of(size), self._places, rate)
        mean, (nu1, nu2) = rate.factor * mean_power(Z, basis, far, rate.power), basis.frequencies
        loops, scale = CompiledLoops(), 2 * pi * max(map(abs, self._paces))
        grid = partial(resolved, samples, sizes=(FIRST_SIZE, FIRST_SIZE), most=MOST_SAMPLES)
        spectrum = resolved_spectrum(loops, grid, self._paces, scale, loops.noise)
        rates = (nu1 / mean, nu2 / mean, nu1, nu2, 1 / mean, mean, nu1, nu2, mean, 2 * half_turn())
        self._paces = [float(x / mean) for x in (nu1, nu2)]
        return TorusClock(loops, spectrum, double_double_row(rates), scale, loops.noise / 64)


class ThetaBasis(NamedTuple):
    """The data of theta functions of a motion: the period matrix ``tau``, and the characteristics of the five
    roots and of infinity.

    ``places`` are the phases at the start in turns, ``frequencies`` their turns per unit of the flow's own time,
    ``along`` their turns per unit of time along the direction (0, 1).
    """

    roots: list[Complex]
    lead: Complex
    tau: Matrix
    chars: list[Whole]
    places: tuple[Column, Column]
    frequencies: tuple[Complex, Complex]
    along: tuple[Complex, Complex]

    def sums(self, Z: LongField, places: Sequence[int]) -> tuple[ThetaSums, list[Complex]]:
        """The series of the roots with the indices ``places`` and of infinity, and for each of these roots e the ratio
        of √|U(e)| to the quotient of its series by that of infinity.
        """
        (t11, t12), (_, t22) = self.tau
        loops, real = CompiledLoops(), [round(2 * float(x.real)) for x in (t11, t12, t22)]
        shape = loops.row([*(x.imag for x in (t11, t12, t22)), *self.along])
        sums, tops = theta_sums(loops, shape, real, [self.chars[i] for i in (*places, 5)])
        *scales, last = (Z.coerce(high) + Z.coerce(low) for high, low in tops.tolist())
        sizes = []
        for i, scale in zip(places, scales, strict=True):
            slope = Z.one
            for e in (*self.roots[:i], *self.roots[i + 1 :]):
                slope *= self.roots[i] - e
            sizes.append((Z.sqrt(Z.sqrt(abs(slope))) * scale / last).real)
        return sums, sizes


def theta_basis(Z: LongField, model: PairModel) -> ThetaBasis:
    """The data of theta functions of a motion; PrecisionLoss if it is on no real torus."""
    lead, roots = model.lead, [Z.coerce(e) for e in model.roots]
    found = real_basis(half_integrals(Z, roots, lead))
    tau = ratio(found.cycles)
    w = image(Z, roots, lead, found.halves, (*model.u, *model.v))
    ((p1, p2, q1, q2),) = coordinates(found.cycles, tau, [w])
    m, n = (round(2 * float(q)) for q in (q1, q2))
    if max(abs(float(2 * q1 - m)), abs(float(2 * q2 - n))) > NEARLY:
        raise PrecisionLoss("the pair is on no real torus")
    chars = [((a + m) % 2, (b + n) % 2, c, d) for a, b, c, d in characteristics(found)]
    along = solved(found.cycles[:2], (Z.zero, Z.one))
    nu = solved(found.cycles[:2], (Z.coerce(model.direction[0]), Z.coerce(model.direction[1])))
    places = Column.of(p1), Column.of(p2)
    return ThetaBasis(roots, lead, tau, chars, places, (nu[0].real, nu[1].real), (along[0].real, along[1].real))


def sums_at(sums: ThetaSums, phases: np.ndarray) -> np.ndarray:
    """The values of :func:`integrable.torus.theta_series.theta_lifts`, shape (N, width, 2), at phases (N, 2, 2)."""
    width = 2 * sums.sizes[0] - 1
    out = np.empty((width * len(phases), 2))
    CompiledLoops().theta_lifts(sums, phases.reshape(-1, 2), out)
    return out.reshape(-1, width, 2)


def pairs_of_columns(columns: Sequence[Column]) -> np.ndarray:
    """Two columns of N numbers, as an array of shape (N, 2, 2)."""
    return np.stack([np.stack([x.hi, x.lo], axis=-1) for x in columns], axis=1)


def rates_on(
    sums: ThetaSums, size: Column, places: Sequence[Column], rate: Rate, grid: tuple[int, int], known: np.ndarray | None
) -> np.ndarray:
    """dt/dτ on a grid of the torus, double-doubles of shape (rows, columns, 2); ``sums`` are series at ``rate.e``."""
    rows, columns = (np.arange(n) / n for n in grid)
    phases = [x.ravel() for x in np.meshgrid(rows, columns, indexing="ij")]
    out = sums_at(sums, pairs_of_columns([Column(x) + place for x, place in zip(phases, places, strict=True)]))
    root = size * Column(out[:, 1, 0], out[:, 1, 1])
    factor = Column.of(rate.factor)
    found = factor * root * root if rate.power == 2 else factor * Column(np.sign(root.hi)) / root
    return np.stack([found.hi, found.lo], axis=-1).reshape(*grid, 2)


def mean_power(Z: LongField, basis: ThetaBasis, far: int, power: int) -> Complex:
    """The mean of |(e − x₁)(e − x₂)|^(power/2) over the torus, for points in the two bounded ovals of a real curve.

    The invariant measure is (x₂ − x₁)dx₁dx₂/(y₁y₂), so this is a quotient of determinants; e is root number ``far``.
    """
    roots, lead = basis.roots, basis.lead
    e, weighted = roots[far], []
    sides = (0, 2) if lead > 0 else (1, 3)
    plain = [moments(Z, roots, lead, k) for k in sides]
    for k, (zeroth, first, second) in zip(sides, plain, strict=True):
        if power == 2:
            weighted.append((first - e * zeroth, second - e * first))
        else:
            weighted.append(moments(Z, roots, lead, k, (e,))[:2])
    area, other = (abs(a[0] * b[1] - a[1] * b[0]) for a, b in (plain, weighted))
    return (other / area).real
