"""Motions of genus 2 on a real torus, by theta functions.

With the period matrices A and B, D = P₁ + P₂ has z = A⁻¹(∫_{r₀}^{P₁} + ∫_{r₀}^{P₂})(dx/y, x dx/y), r₀ a branch point; z
is linear in time. The square roots of |U| at branch points are quotients of odd theta functions of z
(:mod:`integrable.torus.pair_loops`). If ∫_{r₀}^{r_i} = Ap + Bq, the characteristic of the branch point r_i is
η_0 + 2(q, p), and exactly one of the 16 η_0 makes all of them odd. All of this is real in a basis whose A spans the
real periods. Models of degree 6 with real roots are first transformed by x ↦ 1/(E − x), where E is the largest root.

If each bounded oval has one of the points, periods and phases are computed in double-doubles as for the ball,
otherwise by quadrature (:mod:`jacobian.periods.paths`). The mean of dt/dτ is a determinant of elliptic integrals or
follows from θ_∞, the theta function of ∞; t is this mean times τ plus a Fourier series.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from itertools import pairwise
from math import frexp, pi, prod
from typing import NamedTuple

import numpy as np

from integrable.moving_point.addition import Row
from integrable.moving_point.arithmetic import MOST_TURNS
from integrable.mumford.branch_points import SMALL, PairModel, all_real, lift_of, long_roots, opened, without_root
from integrable.mumford.columns import Column
from integrable.mumford.motion import BITS_OF_TORUS, Start
from integrable.torus.clock import (
    MOST_SAMPLES,
    FarTimes,
    TorusClock,
    check_turns,
    first_grid,
    resolved_spectrum,
    samples_of,
)  # fmt: skip
from integrable.torus.lifts import AROUND, CHECKED, CLOSED, SMALLEST, Limits, RateSums, Torus
from integrable.torus.loops import CompiledLoops, in_basis, shortest, theta_sums
from integrable.torus.pair_loops import LIBRARY, PAIRS, PairTorus
from integrable.torus.theta_series import half_turn, long_numbers
from integrable.torus.theta_setup import CLASSES, FOUND, IMAGINARY, MEAN, rule_of_phases
from jacobian import poly
from jacobian.element import Complex, Real
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.native.library import Packed
from jacobian.numbers.double_double import double_double_row
from jacobian.periods.paths import image
from jacobian.periods.real_basis import (
    NEARLY,
    Whole,
    characteristics,
    coordinates,
    half_integrals,
    ratio,
    real_basis,
    solved,
)  # fmt: skip
from jacobian.relatives.extended import Extended, Lift, SecondKind

# the gap of a model is the least distance of neighbouring branch points, relative to their distance from the origin.
# Periods are computed in double-doubles if it is larger than CLOSE, or if t is not linear in τ. If it is
# smaller than CLOSEST, pairs on a model of even degree may lose digits
CLOSE, CLOSEST = 2.0**-10, 2.0**-16
# phases in double-doubles keep enough digits up to MOST_TURNS turns, or up to MOST_TURNS·CLOSE_TURNS·gap if this is
# less
CLOSE_TURNS = 16
# the mean of dt/dτ comes from second derivatives of theta functions, which need further terms, smaller than the others
# by up to e^(−π·FURTHER)
FURTHER = 4.0
# Newton's method for the phases of the start ends if the lifts there differ from the given ones by less than ENOUGH. At
# CHECKED points the derivatives of the lifts along the torus are compared with the equations of motion
# (:func:`integrable.torus.pair_loops.lifts_strayed`). The difference must be at most OBEYED at all but AMPLIFIED
# points, and at most ROUGHLY at these: an error of 1e-23 of some lifts grows to 4e-11 in a narrow peak of another lift
ENOUGH, OBEYED, AMPLIFIED, ROUGHLY = 1e-31, 1e-15, 4, 1e-10
# the time at which the state is compared with another method, in turns of the faster phase
WITNESS = 0.3

# the lift (κ, σ, ν) at each branch point e: κσ² = U(e), κσν = V(e)
Lifts = dict[Complex, tuple[Real, Real, Real]]


class Rate(NamedTuple):
    """dt/dτ of a motion: ``factor``·|U(e)|^(``power``/2), where e is a branch point beyond both ovals.

    ``power`` is 2 or −1.
    """

    e: Complex
    power: int
    factor: Complex


class ScaledModel(NamedTuple):
    """A model in the abscissa ξ, x = e + ``length``·ξ with a root e or e = 0, and y = ``height``·η. Length and height
    are powers of two up to sign, so that no scaling is rounded.

    ``roots`` are those of the model in x, in the same order. ``gap`` is the least distance between neighbouring roots,
    relative to their distance from ξ = 0. ``inside`` is whether one point of the pair is in the oval from root 0 to 1
    and one in that from root 2 to 3.
    """

    model: PairModel
    roots: list[Complex]
    length: float
    height: float
    gap: float
    inside: bool


class PairBasis(NamedTuple):
    """The data of theta functions of a motion, in double-doubles.

    ``shape`` is that of :func:`integrable.torus.theta_series.theta_weights`, ``real`` are 2Re τ₁₁, 2Re τ₁₂ and 2Re τ₂₂,
    ``chars`` the characteristics of the roots and of infinity. ``places`` are the phases at the start in turns,
    ``frequencies`` their turns per unit of the flow's own time. If both points are in bounded ovals, ``beyond`` are the
    turns of the phases per unit of time along the direction (1, e₅) with the largest root e₅, and ``slowness`` is the
    mean of |U(e₅)|^(−½).
    """

    shape: Row
    real: tuple[int, int, int]
    chars: list[Whole]
    places: Row
    frequencies: Row
    beyond: Row
    slowness: Row


class ThetaTorus(FarTimes):
    """The divisor D of a motion of genus 2 at any times, in double-doubles.

    ``place(K)`` returns the :class:`Start` over K, ``rate(K)`` the :class:`Rate` of a motion whose time is not linear
    in τ. The only datum of the second kind that is allowed is the time t with dt/dτ = |U(0)|. PrecisionLoss for data
    other than lifts and this time, if branch points nearly meet, or if fewer than two are real. It is also raised if
    the pairs of the torus are not those of the motion, and for lifts on a model of even degree. On such a model, or if
    t is not linear in τ, each oval must have one point of the pair.
    """

    def __init__(self, place: Callable[[LongField], Start], rate: Callable[[LongField], Rate] | None = None) -> None:
        with long_numbers(BITS_OF_TORUS) as N:
            start = place(N)
            lifts = {kind.e: data for kind, data in zip(start.kinds, start.data, strict=True) if isinstance(kind, Lift)}
            others = [kind for kind in start.kinds if not isinstance(kind, Lift)]
            if len(start.v) != 2 or not all(isinstance(kind, SecondKind) for kind in others):
                raise PrecisionLoss("a motion of genus 2 without lifts but at branch points is needed")
            if others and (start.direction[1] or start.f[0]):
                raise PrecisionLoss("a datum of the second kind that is not the time")
            timed = Rate(N.zero, 2, N.one) if others else rate and rate(N)
            known = [*lifts, *([timed.e] if timed else [])]
            model = PairModel(start.f[-1], start.u[:2], start.v, start.direction, long_roots(N, start.f, known))
            self._pole: list[Complex] = []
            if len(model.roots) == 6:
                if lifts or not all_real(model.roots):
                    raise PrecisionLoss("lifts or complex branch points on a model of even degree")
                self._pole, model = [model.roots[-1]], without_root(model)
            before, model = model.roots, opened(N, model, lifts)
            self._smallest = 0.0 if model.roots == before else SMALLEST
            if len(model.roots) != 5:
                raise PrecisionLoss(f"{len(model.roots)} branch points, and five are needed")
            self._kinds, self._first, self._pace = start.kinds, start.data, Column.of(start.direction[0])
            self._clock: TorusClock | None = None
            self._make(N, model, lifts, timed)

    def _make(self, N: LongField, model: PairModel, lifts: Lifts, timed: Rate | None) -> None:
        """Sets up the torus in double-doubles, or in long numbers where these do not suffice."""
        found = scaled_model(N, model) if all_real(model.roots) else None
        self._doubtful = bool(self._pole) and not (found and found.gap > CLOSEST)
        if found and found.inside and (timed or found.gap > CLOSE):
            self.most = MOST_TURNS * min(1, CLOSE_TURNS * found.gap)
            try:
                return self._placed(N, found, oval_basis(found.model), lifts, timed)
            except PrecisionLoss:
                if timed:
                    raise
        if timed:
            raise PrecisionLoss(
                "a time that is not linear in τ, and not one point in each oval, or close branch points"
            )
        self.most = MOST_TURNS
        with LongField(BITS_OF_TORUS, complex=True) as Z:
            whole = ScaledModel(model, list(model.roots), 1.0, 1.0, 0.0, False)
            return self._placed(Z, whole, theta_basis(Z, model), lifts, None)

    def _placed(self, N: LongField, found: ScaledModel, basis: PairBasis, lifts: Lifts, timed: Rate | None) -> None:
        """Sets up the theta functions in a known basis; PrecisionLoss if their pairs are not those of the motion."""
        loops, model, places = CompiledLoops(), found.model, ends_of(found.roots, lifts)
        self._count, row, places = len(lifts), loops.row, places + ([4] if timed else [])
        ends = [end_of(N, found, k, lifts) for k in places]
        self._kappas = [Column.of(end.kappa) for end in ends[: self._count]]
        chars = [basis.chars[k] for k in (*places, 5)]
        sums, tops = theta_sums(loops, basis.shape, basis.real, chars, FURTHER if timed else 0)
        f = poly.scale(N, model.lead, poly.from_roots(N, model.roots))
        units = abs(found.length), found.height / abs(found.length)
        torus = Torus(sums, basis.places, row(end.slope for end in ends))
        self._torus = PairTorus(
            torus, basis.frequencies, row(1.0 if end.kappa > 0 else -1.0 for end in ends), *(real_row(x) for x in (
                [model.roots[k] for k in places], f, model.direction,
                [x for end in ends[: self._count] for x in end.sizes], units,
                [found.roots[k] for k in places[:2]], self._pole)),
        )  # fmt: skip
        self._packed = Packed(self._torus, PAIRS)
        limits = Limits(ENOUGH if found.inside else CLOSED, loops.nudge, self._smallest)
        room, target = loops.room(2 * (AROUND + 1) * CHECKED * len(places)), row(x for end in ends for x in end.target)
        closure = loops.met(torus, tops, target, limits, room)
        LIBRARY.strayed(self._packed, room, gaps := np.empty(CHECKED))
        if not (closure <= CLOSED and gaps.max() <= ROUGHLY and np.sort(gaps)[-1 - AMPLIFIED] <= OBEYED):
            raise PrecisionLoss("the pairs on the torus of this motion are not its own")
        self.paces = basis.frequencies[:, 0].tolist()
        if timed:
            self._clock = self._made_clock(N, basis, timed, found.length)
            self.most = min(self.most, self._clock.most)

    @property
    def witnesses(self) -> np.ndarray:
        """The times at which states are compared with another method: one, because the derivatives of the lifts have
        been checked all over the torus, or more where pairs may lose digits.
        """
        return super().witnesses if self._doubtful else np.array([WITNESS / max(map(abs, self.paces))])

    def at(self, times: np.ndarray) -> Extended:
        """The pairs with their data at N times, as columns of N numbers."""
        check_turns(times, self.paces, self.most)
        count, loops = len(times), CompiledLoops()
        if self._clock is None:
            phases = loops.room(2 * count)
            loops.phases_at(self._torus.frequencies, np.ascontiguousarray(times, dtype=np.float64), phases)
        else:
            phases = self._clock.phases(times)[0]
        out = np.empty((count * (2 * self._count + 4), 2))
        LIBRARY.pairs_at(self._packed, phases, loops.room(2 * count * max(self._count, 2)), out)
        columns = [Column(hi, lo) for hi, lo in np.ascontiguousarray(out.reshape(-1, count, 2).transpose(0, 2, 1))]
        read = zip(self._kappas, columns[::2], columns[1::2], strict=False)
        data = tuple(
            next(read) if isinstance(kind, Lift) else Column.of(first) - self._pace * Column(times)
            for kind, first in zip(self._kinds, self._first, strict=True)
        )
        u0, u1, v0, v1 = columns[-4:]
        return Extended((u0, u1, Column(1.0)), (v0, v1), data)

    def _made_clock(self, N: LongField, basis: PairBasis, timed: Rate, length: float) -> TorusClock:
        loops, torus, k = CompiledLoops(), self._torus.torus, len(self._torus.ends) - 1
        scale = timed.factor * abs(length) ** timed.power
        if timed.power == 2:
            LIBRARY.mean_square(self._packed, k, basis.shape[3:], basis.beyond, room := loops.room(2 * k + 2))
        mean = scale * sum(map(N.coerce, (room[0] if timed.power == 2 else basis.slowness).tolist()))
        # |U(e)| = (``slope``·θ_e/θ_∞)² with the ``slope`` of the :class:`End` at e
        up, down = (1, 0) if timed.power == 2 else (0, 1)
        rate = RateSums(k, 2, timed.power < 0, False, loops.row((up, down, down, up, 0, 0, scale)))
        pace = 2 * pi * max(map(abs, self.paces))
        sizes = first_grid(loops.noise, shortest(basis.shape[:3, 0].tolist()))
        samples = partial(samples_of, loops, torus, rate, (False, False))
        spectrum = resolved_spectrum(loops, samples, sizes, MOST_SAMPLES, self.paces, pace, loops.noise)
        self.paces = [x / float(mean) for x in self.paces]
        rates = np.concatenate([basis.frequencies, loops.row((mean,)), loops.circle[:1]])
        return TorusClock(loops, spectrum, rates, pace, loops.noise / 64)


def ends_of(roots: Sequence[Complex], lifts: Lifts) -> list[int]:
    """The indices in ``roots`` of the branch points with lifts, in the order of ``lifts``. If there are fewer than two
    lifts, real branch points without lifts are added to make two.
    """
    real, first = [k for k, e in enumerate(roots) if not e.imag], next(iter(lifts), 0)
    rest = sorted((k for k in real if roots[k] not in lifts), key=lambda k: -abs(roots[k] - first))
    found = [*(roots.index(e) for e in lifts), *rest][: max(2, len(lifts))]
    if len(found) < 2:
        raise PrecisionLoss("fewer than two branch points are real")
    return found


class End(NamedTuple):
    """A branch point e at which theta functions are needed, with the lift (κ, σ, ν) there at the start.

    ``kappa`` is κ, ``slope`` is |f'(e)/ℓ|^¼, ``target`` is (σ, ν) in the units of a model, and ``sizes`` are the
    factors that convert σ and ν from these units.
    """

    kappa: Real
    slope: Real
    target: tuple[Real, Real]
    sizes: tuple[Real, Real]


def end_of(N: LongField, found: ScaledModel, k: int, lifts: Lifts) -> End:
    """The :class:`End` of root number k, with the lift of the motion if it has one there."""
    model, own = found.model, lifts.get(found.roots[k])
    kappa, sigma, nu = own or lift_of(N, model, model.roots[k])
    size = N.sqrt(abs(kappa)).real / abs(found.length if own else 1.0)
    high = size * (found.length**2 / found.height if own else 1.0)
    slope = prod((model.roots[k] - e for i, e in enumerate(model.roots) if i != k), start=N.one)
    return End(kappa, N.sqrt(N.sqrt(abs(slope))).real, (sigma * size, nu * high), (1 / size, 1 / high))


def real_row(values: Iterable[Complex | Real]) -> Row:
    """The real parts of numbers as double-doubles, shape (N, 2)."""
    return double_double_row(getattr(x, "real", x) for x in values).reshape(-1, 2)


def scaled_model(N: LongField, model: PairModel) -> ScaledModel:
    """The :class:`ScaledModel` of a model with real roots. It has ℓ > 0, and its origin keeps the most digits of the
    distances between roots.
    """
    side = 1 if model.lead > 0 else -1
    points = [side * x for x in model.roots[::side]]
    gap, origin = max(((least_gap(points, x), x) for x in (N.zero, *points)), key=lambda found: found[0])
    length = side * 2.0 ** frexp(float(points[-1] - points[0]))[1]
    height = 2.0 ** (frexp(float(abs(model.lead) * abs(length) ** 5))[1] // 2)
    (u0, u1), (v0, v1), (c0, c1), o = model.u, model.v, model.direction, side * origin
    u0, u1 = (u0 + (u1 + o) * o) / length**2, (u1 + 2 * o) / length
    roots = [(x - origin) / abs(length) for x in points]
    own = PairModel(
        model.lead * length**5 / height**2, (u0, u1), ((v0 + v1 * o) / height, v1 * length / height),
        (c0 * height / length, (c1 - o * c0) * height / length**2), roots,
    )  # fmt: skip
    heights = (sign * ((e + u1) * e + u0) for sign, e in zip((1, -1, -1, 1), roots, strict=False))
    inside = all(x >= -SMALL for x in heights)
    return ScaledModel(own, list(model.roots[::side]), length, height, gap, inside)


def least_gap(points: Sequence[Real], origin: Real) -> float:
    """The least distance between neighbouring points, relative to their distance from the origin."""
    far = [float(x - origin) for x in points]
    return min(float(y - x) / max(abs(a), abs(b)) for (x, a), (y, b) in pairwise(zip(points, far, strict=True)))


def oval_basis(model: PairModel) -> PairBasis:
    """The data of theta functions of a motion in two bounded ovals, in double-doubles."""
    loops = CompiledLoops()
    given = loops.row([*model.roots, model.lead, half_turn(), *model.u, *model.v, *model.direction])
    motion, found, out = loops.room(12), loops.room(FOUND), loops.room(6)
    m1, n1, m2, n2 = LIBRARY.oval_data(given, rule_of_phases(), loops.short, loops.room(4), motion, found, out)
    if not (np.isfinite(found).all() and np.isfinite(out).all()):
        raise PrecisionLoss("the periods of this motion are beyond the range of floats")
    chars = in_basis(CLASSES, ((m1, n1), (m2, n2)))
    shape = found[IMAGINARY:MEAN]
    return PairBasis(shape, (0, 0, 0), chars, out[:2], out[2:4], out[4:], found[MEAN])


def theta_basis(Z: LongField, model: PairModel) -> PairBasis:
    """The data of theta functions of a motion, from long numbers; PrecisionLoss if the motion is on no real torus."""
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
    entries = tau[0][0], tau[0][1], tau[1][1]
    r11, r12, r22 = (round(2 * float(x.real)) for x in entries)
    shape, none = real_row([*(x.imag for x in entries), *along]), real_row([])
    return PairBasis(shape, (r11, r12, r22), chars, real_row([p1, p2]), real_row(nu), none, none)
