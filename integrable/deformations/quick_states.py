"""States of the tilde, check and hat pairs in floats, by theta functions on both curves, compiled for double-doubles.

Physical times use the clock of :mod:`integrable.torus.clock` on the torus of both curves. The loss of digits is
measured on every call: H and K of all states are computed in double-doubles, and the state at the largest time is
computed again with more digits. At this time the clock is checked too: its t(τ), and 1/g by its series. If the loss
exceeds the rounding of floats, or if τ is too many periods away, all states are computed with more digits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, partial
from itertools import compress
from math import log
from typing import Any, NamedTuple, TypeVar

import numpy as np

from integrable.deformations.carrier import CurvesCarrier, GammaM, OnCurves
from integrable.deformations.oval import LIBRARY, Pace
from integrable.mumford.elliptic_torus import OvalThetas
from integrable.mumford.recorded import PairField, PointFormulas, flat, shaped
from integrable.series.tape import recorded
from integrable.torus.clock import FIRST_SIZE, TorusClock, resolved_spectrum, turns_in
from integrable.torus.loops import CompiledLoops
from jacobian.element import Real
from jacobian.errors import ArgumentError, PrecisionLoss
from jacobian.fields.multiprecision import Mpf
from jacobian.immutable import made_once
from jacobian.numbers.double_double import double_double_row

# number of periods after which double-doubles may lack digits
MOST_TURNS = 1e6
# largest error of H and K relative to their sizes, and largest decimal exponent of the farthest state's relative error
MOST_LOST, LOST_DIGIT = 1e-20, -20
# largest relative error of 1/g, and of a time from the clock: some rounding units of floats
MOST_OFF = 4e-14
# modes of 1/g below this, relative to its mean, are omitted; larger ones would affect the last bit of τ
NOISE = 1e-17
# upper bound of the body's angular velocity divided by the rate of its faster phase; the ratio is largest for large d
SWIFT = 100
# number of samples of 1/g beyond which the series of integrable.deformations.ovals_clock is cheaper
MOST_SAMPLES = 1 << 14

Made = TypeVar("Made")


class PackedCurves(NamedTuple):
    """A motion in double-doubles.

    ``rates`` are the turns of both phases per unit of τ, ``curves`` the ovals for phases in turns; ``levels`` are
    those of :mod:`integrable.deformations.oval`. ``fixed`` has the constants of the motion that ``formulas`` use.
    ``before`` has H and K of the start, and ``most_lost`` their largest errors.
    """

    rates: np.ndarray
    curves: tuple[OvalThetas, OvalThetas]
    levels: tuple[np.ndarray, np.ndarray]
    formulas: PointFormulas
    fixed: np.ndarray
    before: np.ndarray
    most_lost: np.ndarray

    def at(self, phases: np.ndarray) -> np.ndarray:
        """R₁, R₂, R₃ and z of the point on each curve (:mod:`integrable.deformations.oval`) at N pairs of phases, in
        turns since the start: shape (8, N, 2).
        """
        out = np.empty((8, len(phases) // 2, 2))
        LIBRARY.points(self.curves, self.levels, phases, out.reshape(-1, 2))
        return out

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """The result of :meth:`at` at N values of τ."""
        loops = CompiledLoops()
        loops.phases_at(self.rates, np.ascontiguousarray(tau, dtype=np.float64), phases := loops.room(2 * len(tau)))
        return self.at(phases)


class QuickStates:
    """The :class:`integrable.phase.ways.Way` by compiled loops, for a motion over RR; ``many`` computes it with many
    digits.
    """

    way = "elliptic curves"

    def __init__(self, many: OnCurves) -> None:
        self._many = many
        # both functions return None if numbers such as |M|² exceed the range of floats. _clock also returns None if 1/g
        # needs too many samples or has resonant modes
        self._packed: Callable[[CurvesCarrier], PackedCurves | None] = cache(lambda x: _unless(packed, x))
        self._clock = cache(lambda x: _unless(QuickClock, x.pace, self._packed(x)))

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        carrier = self._many.carrier
        if not carrier.rolls:
            rows = self.at_tau(times)
            return None if rows is None else (rows, times)
        with carrier.field:
            return self._timed(carrier, times) if len(times) else None

    def at_tau(self, tau: np.ndarray) -> np.ndarray | None:
        carrier = self._many.carrier
        with carrier.field:
            if not len(tau) or not carrier.turns(carrier.field.coerce(float(np.abs(tau).max()))) < MOST_TURNS:
                return None
            packed = self._packed(carrier)
            if packed is None:
                return None
            far = int(np.argmax(np.abs(tau)))
            truth = carrier.point(carrier.field.coerce(float(tau[far])))
            return self._quick(carrier, packed, packed.at_tau(tau), far, truth)

    def at_phases(self, phases: np.ndarray) -> np.ndarray | None:
        """γ and M at phases of both curves in turns since the start, (N, 2): shape (N, 6); None if digits lack."""
        carrier, far = self._many.carrier, int(np.argmax(np.abs(phases).max(axis=1)))
        with carrier.field:
            packed = self._packed(carrier)
            if packed is None:
                return None
            turns = zip(map(carrier.field.coerce, phases[far].tolist()), carrier.curves, strict=True)
            truth = carrier.moved([turn * curve.period for turn, curve in turns])
            return self._quick(carrier, packed, packed.at(CompiledLoops().exact(phases.ravel())), far, truth)

    def times(self, tau: np.ndarray) -> np.ndarray | None:
        """Returns None: the physical times at values of τ are computed with many digits."""
        return None

    def _timed(self, carrier: CurvesCarrier, times: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """The result of :meth:`at`, computed by the clock in floats; None if this clock is not accurate enough."""
        far = int(np.argmax(np.abs(times)))
        if not carrier.turns(abs(carrier.most_tau(carrier.field.coerce(float(times[far]))))) < MOST_TURNS:
            return None
        packed = self._packed(carrier)
        clock = packed and self._clock(carrier)
        if packed is None or clock is None or turns_in(times, clock.paces) > clock.clock.most:
            return None
        phases, tau, _ = clock.clock.phases(times)
        turns = [sum(map(carrier.field.coerce, pair)) for pair in phases[2 * far : 2 * far + 2].tolist()]
        truth = carrier.moved([turn * curve.period for turn, curve in zip(turns, carrier.curves, strict=True)])
        rate = carrier.field.sqrt(carrier.system.body.conformal(truth[0]))
        if not clock.holds(turns, rate, tau[far : far + 1], times[far]):
            return None
        rows = self._quick(carrier, packed, packed.at(phases), far, truth)
        return None if rows is None else (rows, tau)

    def _quick(
        self, carrier: CurvesCarrier, packed: PackedCurves, points: np.ndarray, far: int, truth: GammaM
    ) -> np.ndarray | None:
        """γ and M at points of the curves; None if H or K drifts, or if row ``far`` differs from ``truth``."""
        found = packed.formulas.at(packed.fixed, points)
        change = found[:, 6:] - packed.before
        if not (np.abs(change[:, :, 0] + change[:, :, 1]) <= packed.most_lost).all():
            return None
        if carrier.order != [0, 1, 2]:
            places = np.argsort(carrier.order)
            found[:, :6] = found[:, np.concatenate([places, 3 + places])]
            found[:, 3:6] *= carrier.side
        shown = [carrier.field.coerce(high) + carrier.field.coerce(low) for high, low in found[far, :6].tolist()]
        if carrier.difference((shown[:3], shown[3:]), truth) > LOST_DIGIT:
            return None
        return np.ascontiguousarray(found[:, :6, 0])


class QuickClock:
    """The :class:`~integrable.torus.clock.TorusClock` of a motion of a tilde pair with d ≠ 0.

    PrecisionLoss if 1/g needs too many samples, or if a mode is resonant.
    """

    def __init__(self, pace: Pace, packed: PackedCurves) -> None:
        loops = CompiledLoops()
        # the turns of either phase per unit of τ
        turns = packed.rates[:, 0].tolist()
        scale = SWIFT * 2 * np.pi * max(turns)
        given = partial(samples, pace, packed), grid_resolving(pace), MOST_SAMPLES
        self._spectrum = resolved_spectrum(loops, *given, turns, scale, NOISE)
        mean = self._spectrum.values[0]
        row = np.array([*packed.rates, mean, loops.circle[0]])
        self.clock = TorusClock(loops, self._spectrum, row, scale, NOISE / 64)
        self.paces = [nu / float(mean[0]) for nu in turns]

    def holds(self, turns: list[Mpf], rate: Real, tau: np.ndarray, time: float) -> bool:
        """Whether the clock is accurate at ``time``: t(τ) returns this time, and dt/dτ is ``rate``, that of the state.

        ``turns`` are the phases at that time; ``tau`` is an array of the one τ.
        """
        if not abs(float(self.clock.times(tau)[0]) - time) <= MOST_OFF * abs(time):
            return False
        values, (rows, columns), _ = self._spectrum
        half = values[: (rows + 2) * columns, 0].copy().view(complex).reshape(-1, columns)
        first, second = (2j * np.pi * float(x - round(x)) for x in turns)
        ahead, across = np.exp(first * np.arange(rows // 2 + 1)), np.arange(columns)
        ahead[1:-1] *= 2
        across[columns // 2 :] -= columns
        shown = float((ahead @ half @ np.exp(second * across)).real)
        return abs(shown / float(rate) - 1) <= MOST_OFF


def _unless(made: Callable[..., Made], *arguments: object) -> Made | None:
    try:
        return made(*arguments)
    except (ArgumentError, PrecisionLoss):
        return None


def grid_resolving(pace: Pace) -> tuple[int, int]:
    """The numbers of samples in both phases, powers of 2, that resolve 1/g if its modes decay as those of the height z.

    Mode m of z on a curve is of the size nome^m, since the pole of z is at the imaginary half-period.
    """
    modes = (int(log(NOISE) / log(max(float(curve.thetas.nome), NOISE))) for curve in pace.curves)
    first, second = (max(FIRST_SIZE, 1 << (2 * n + 2).bit_length()) for n in modes)
    return first, second


def samples(pace: Pace, packed: PackedCurves, sizes: tuple[int, int], known: np.ndarray | None) -> np.ndarray:
    """1/g at the phases (i/rows, j/columns) since the start, as double-doubles; ``known`` is not used."""
    count, (rows, columns) = max(sizes), sizes
    # the sizes are powers of 2, so that the fractions are exact
    phases = CompiledLoops().exact((np.arange(count)[:, None] / sizes).ravel())
    points, table = packed.at(phases), np.empty((rows * columns, 2))
    numbers = double_double_row((pace.d, *pace.weights))
    LIBRARY.paces(points[3][:rows], points[7][:columns], numbers, table)
    return table.reshape(rows, columns, 2)


def packed(carrier: CurvesCarrier) -> PackedCurves:
    """The data of a motion on two curves (:class:`CurvesCarrier`) in double-doubles.

    ArgumentError for numbers beyond the range of floats, PrecisionLoss near a separatrix.
    """
    system, (first, second) = carrier.inner, carrier.curves
    there = (*map(bool, system.constants),)
    formulas = made_once(("states", type(carrier), type(system), there), lambda: recorded_states(carrier, there))
    levels = double_double_row((*carrier.levels[0], *carrier.levels[1]))
    return PackedCurves(
        double_double_row(carrier.tau_frequencies),
        (first.packed(1), second.packed(1)),
        (levels[:4], levels[4:]),
        formulas,
        formulas.fixed(carrier.field, [*compress(system.constants, there), *flat(carrier.frame)]),
        double_double_row(carrier.before),
        MOST_LOST * np.array([*map(float, carrier.sizes)]),
    )


def recorded_states(carrier: CurvesCarrier, there: Sequence[bool]) -> PointFormulas:
    """The formulas of γ, M, H and K from the points on both curves, for motions of the kind of ``carrier``. ``there``
    says which constants of the system are not 0.
    """
    N, frame, count = PairField(), carrier.frame, sum(there) + len([*flat(carrier.frame)])

    def states(y: Sequence[Real]) -> list[Real]:
        values = iter(y)
        system = carrier.inner._of_constants(N, [next(values) if is_there else 0.0 for is_there in there])
        constants: Any = type(frame)(*shaped(frame, values))
        x = list(values)
        gamma, M = carrier.read(N, system, constants, x[:4], x[4:])
        q = system.scalars(lambda x: x, gamma, M)
        return [*gamma, *M, *system.pair(q, system._terms(lambda x: x))]

    return PointFormulas(recorded(states, count + 8), count)
