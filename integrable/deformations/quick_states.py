"""States of the tilde, check and hat pairs in floats, by theta functions on both curves, compiled for double-doubles.

Physical times use the clock of :mod:`integrable.torus.clock` on the torus of both curves. The loss is measured on
every call: by H and K of all states in double-doubles, by a computation of the farthest state with more digits, by the
time that the clock returns there, and by 1/g there. If the loss exceeds the rounding of floats, or if τ is too many
periods away, the states are computed with more digits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import log
from typing import NamedTuple, TypeVar

import numpy as np

from integrable.deformations.carrier import CurvesCarrier, OnCurves
from integrable.deformations.oval import Pace
from integrable.deformations.oval_loops import LIBRARY, Frame, Track
from integrable.mumford.columns import Column
from integrable.mumford.elliptic_torus import terms_of
from integrable.torus.clock import FIRST_SIZE, RateSpectrum, TorusClock, resolved_spectrum
from integrable.torus.long_clock import RESONANT
from integrable.torus.loops import CompiledLoops
from integrable.torus.series import in_resonance
from integrable.torus.theta_series import inverse_factorials
from jacobian.element import Real
from jacobian.errors import ArgumentError, PrecisionLoss
from jacobian.fields.multiprecision import Mpf
from jacobian.numbers.double_double import double_double_row

# number of periods after which double-doubles may lack digits
MOST_TURNS = 1e6
# largest error of H and K, relative to their sizes, and of the farthest state
MOST_LOST = 1e-20
# largest relative error of 1/g, and of a time from the clock: some rounding units of floats
MOST_OFF = 4e-14
# modes of 1/g below this, relative to its mean, are omitted; larger ones would affect the last bit of τ
NOISE = 4e-18
# largest ratio of a body's rotation rate, where d is large, to the rate of its phases
SWIFT = 100
# number of samples of 1/g beyond which the series of integrable.deformations.ovals_clock is cheaper
MOST_SAMPLES = 1 << 14

Made = TypeVar("Made")


class PackedCurves(NamedTuple):
    """The arguments of :func:`integrable.deformations.oval_loops.states` for a motion, in double-doubles.

    ``rates`` are the turns of either phase per unit of τ.
    """

    tracks: tuple[Track, Track]
    frame: Frame
    rates: tuple[Column, Column]


class QuickStates:
    """The :class:`integrable.phase.ways.Way` by compiled loops, for a motion over RR; ``many`` computes it with many
    digits.
    """

    way = "elliptic curves"

    def __init__(self, many: OnCurves) -> None:
        self._many = many
        self._packed: dict[CurvesCarrier, PackedCurves | None] = {}
        self._clocks: dict[CurvesCarrier, QuickClock | None] = {}

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,)."""
        carrier = self._many.carrier
        if not carrier.rolls:
            rows = self.at_tau(times)
            return None if rows is None else (rows, times)
        with carrier.field:
            return self._timed(carrier, times) if len(times) else None

    def at_tau(self, tau: np.ndarray) -> np.ndarray | None:
        """γ and M at values of τ, shape (N, 6)."""
        carrier = self._many.carrier
        with carrier.field:
            if not len(tau) or not carrier.turns(carrier.field.coerce(float(np.abs(tau).max()))) < MOST_TURNS:
                return None
            packed = self._compiled(carrier)
            if packed is None:
                return None
            phases = _pairs(*(Column(tau) * rate for rate in packed.rates))
            far = int(np.argmax(np.abs(tau)))
            return self._quick(carrier, packed, phases, far, carrier.point(carrier.field.coerce(float(tau[far]))))

    def times(self, tau: np.ndarray) -> np.ndarray | None:
        """Returns None: the physical times at values of τ are computed with many digits."""
        return None

    def _timed(self, carrier: CurvesCarrier, times: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """The result of :meth:`at`, computed by the clock in floats; None if this clock is not accurate enough."""
        far = int(np.argmax(np.abs(times)))
        if not carrier.turns(abs(carrier.most_tau(carrier.field.coerce(float(times[far]))))) < MOST_TURNS:
            return None
        packed = self._compiled(carrier)
        if packed is None:
            return None
        if carrier not in self._clocks:
            # 1/g may need too many samples, or have resonant modes
            self._clocks[carrier] = _unless(QuickClock, carrier.pace, packed)
        clock = self._clocks[carrier]
        if clock is None:
            return None
        phases, tau = clock.clock.phases(times)
        turns = [sum(map(carrier.field.coerce, pair)) for pair in phases[2 * far : 2 * far + 2].tolist()]
        moved = [turn * curve.period for turn, curve in zip(turns, carrier.curves, strict=True)]
        if not clock.holds(moved, turns, tau[far : far + 1], times[far]):
            return None
        rows = self._quick(carrier, packed, phases, far, carrier.moved(moved))
        return None if rows is None else (rows, tau)

    def _compiled(self, carrier: CurvesCarrier) -> PackedCurves | None:
        """The arguments of the compiled loops for a carrier, cached."""
        if carrier not in self._packed:
            # numbers such as |M|² may exceed the range of floats
            self._packed[carrier] = _unless(packed, carrier)
        return self._packed[carrier]

    def _quick(
        self,
        carrier: CurvesCarrier,
        packed: PackedCurves,
        phases: np.ndarray,
        far: int,
        truth: tuple[Sequence[Real], Sequence[Real]],
    ) -> np.ndarray | None:
        """γ and M at phases since the start; None if H or K drifts, or if row ``far`` differs from ``truth``."""
        count = len(phases) // 2
        out, rest, room = np.empty(6 * count), np.empty(6 * count), np.empty((6 * count, 2))
        lost = LIBRARY.states(*packed.tracks, packed.frame, phases, (out, rest, room))
        if not lost <= MOST_LOST:
            return None
        places = np.argsort(carrier.order)
        columns = np.concatenate([places, 3 + places])
        rows: np.ndarray = out.reshape(-1, 6)[:, columns]
        left = rest.reshape(-1, 6)[far, columns]
        for part, true in zip((slice(3), slice(3, 6)), truth, strict=True):
            size = max(map(abs, true))
            for high, low, x in zip(rows[far, part].tolist(), left[part].tolist(), true, strict=True):
                if not abs(carrier.field.coerce(high) + carrier.field.coerce(low) - x) <= MOST_LOST * size:
                    return None
        return rows


class QuickClock:
    """The :class:`~integrable.torus.clock.TorusClock` of a motion of a tilde pair with d ≠ 0.

    PrecisionLoss if 1/g needs too many samples, or if a mode is resonant.
    """

    def __init__(self, pace: Pace, packed: PackedCurves) -> None:
        loops, self._true_pace = CompiledLoops(), pace
        turns = [float(rate.hi) for rate in packed.rates]
        scale = SWIFT * 2 * np.pi * max(turns)
        given = partial(samples, pace, packed), grid_resolving(pace), MOST_SAMPLES
        self._spectrum = resolved_spectrum(loops, *given, turns, scale, NOISE)
        check_no_resonance(self._spectrum, turns)
        mean = Column(*self._spectrum.values[0])
        row = np.array([*((x.hi, x.lo) for x in (*packed.rates, mean)), loops.circle[0]])
        self.clock = TorusClock(loops, self._spectrum, row, scale, NOISE / 64)

    def holds(self, moved: list[Real], turns: list[Mpf], tau: np.ndarray, time: float) -> bool:
        """Whether the clock is accurate at ``time``: t(τ) returns this time, and dt/dτ agrees with that of the curves.

        ``turns`` are the phases at that time, and ``moved`` the times on the curves.
        """
        if not abs(float(self.clock.times(tau)[0]) - time) <= MOST_OFF * abs(time):
            return False
        values, (rows, columns), _ = self._spectrum
        half = values[:, 0].reshape(-1, 2)[: (rows // 2 + 1) * columns].reshape(-1, columns, 2) @ np.array([1, 1j])
        first, second = (2j * np.pi * float(x - round(x)) for x in turns)
        ahead, across = np.arange(rows // 2 + 1), np.fft.fftfreq(columns, 1 / columns)
        weights = np.where(ahead % (rows // 2) == 0, 1, 2) * np.exp(first * ahead)
        shown = float((weights @ half @ np.exp(second * across)).real)
        return abs(shown / float(self._true_pace.at(moved)) - 1) <= MOST_OFF


def _unless(made: Callable[..., Made], *arguments: object) -> Made | None:
    """``made``(``arguments``), or None if it raises ArgumentError or PrecisionLoss."""
    try:
        return made(*arguments)
    except (ArgumentError, PrecisionLoss):
        return None


def grid_resolving(pace: Pace) -> tuple[int, int]:
    """The numbers of samples in both phases, powers of 2, that resolve 1/g if its modes decay as those of z: mode m as
    nome^m, since the pole of z is at the imaginary half-period.
    """
    modes = (int(log(NOISE) / log(max(float(curve.nome), NOISE))) for curve in pace.curves)
    first, second = (max(FIRST_SIZE, 1 << (2 * n + 4).bit_length()) for n in modes)
    return first, second


def check_no_resonance(spectrum: RateSpectrum, turns: list[float]) -> None:
    """Raises PrecisionLoss for a mode nearly in resonance: floats would lose digits of its large oscillation."""
    values, (rows, columns), _ = spectrum
    modes = np.hypot(*values[:, 0].reshape(-1, 2)[: (rows // 2 + 1) * columns].T).reshape(-1, columns)
    first = np.arange(rows // 2 + 1)[:, None] * turns[0]
    second = np.fft.fftfreq(columns, 1 / columns)[None, :] * turns[1]
    close = np.abs(first + second) < RESONANT * (np.abs(first) + np.abs(second))
    for k, m in np.argwhere(close & (modes > NOISE * modes[0, 0])).tolist():
        raise in_resonance(k, m)


def samples(pace: Pace, packed: PackedCurves, sizes: tuple[int, int], known: np.ndarray | None) -> np.ndarray:
    """1/g at the phases (i/rows, j/columns) since the start, as double-doubles; ``known`` is not used."""
    rows, columns = sizes
    table, room = np.empty((rows * columns, 2)), np.empty((6 * (rows + columns), 2))
    # the sizes are powers of 2, so that the fractions are exact
    places = tuple(np.repeat(np.stack([np.arange(n) / n, np.zeros(n)], axis=1), 2, axis=0) for n in sizes)
    LIBRARY.paces(*packed.tracks, double_double_row((pace.d, *pace.weights)), places, table, room)
    return table.reshape(rows, columns, 2)


def packed(carrier: CurvesCarrier) -> PackedCurves:
    """The data of a carrier in double-doubles.

    ArgumentError for numbers beyond the range of floats, PrecisionLoss near a separatrix.
    """
    frame, rates = carrier.frame, [Column.of(carrier.speed / curve.period) for curve in carrier.curves]
    numbers, back = double_double_row(frame.numbers), double_double_row(frame.back)
    energy, second = map(float, frame.sizes)
    tracks = []
    for track, curve in zip(carrier.tracks, carrier.curves, strict=True):
        # a row of the table has four coefficients
        table = track.table[: 4 * terms_of(curve.nome)]
        tracks.append(Track(double_double_row(track.numbers), double_double_row(table), inverse_factorials()))
    return PackedCurves(
        (tracks[0], tracks[1]), frame._replace(numbers=numbers, back=back, sizes=(energy, second)), (rates[0], rates[1])
    )


def _pairs(first: Column, second: Column) -> np.ndarray:
    """Two columns of phases as rows of double-doubles, one pair after the other."""
    both = np.stack([np.stack([x.hi, x.lo], axis=-1) for x in (first, second)], axis=1)
    return both.reshape(-1, 2)
