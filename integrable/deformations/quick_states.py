"""States of the tilde, check and hat pairs in floats: the additions compiled for double-double numbers.

What they have lost is measured on every call, by H and K of all states in double-doubles and by the farthest state of a
carrier of more digits; where that is more than floats show, or τ is too many periods away, that carrier computes them.
So is the clock at d ≠ 0: by the farthest time, and by 1/g of that carrier.
"""

from __future__ import annotations

from math import frexp
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.deformations.oval_loops import LIBRARY, Frame, Modes, Track, Waves
from integrable.deformations.separated_clock import extremes, grown, series_sizes
from integrable.moving_point.newton import step_inside
from jacobian import RR
from jacobian.errors import ArgumentError
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.double_double import exact_product, split

if TYPE_CHECKING:
    from integrable.motion.precise import RoundedRows

# periods after which double-doubles may lack digits
MOST_TURNS = 1e6
# what H and K, relative to their sizes, and the farthest state may be off by
MOST_LOST = 1e-20
# what 1/g may be off by: a part of a physical time
MOST_OFF = 1e-18
# the digits of 1/g, how often a series that lacks them grows, and beyond what the tables of another way are cheaper
DIGITS, GROWTHS, MOST_WORK = 24, 4, 1 << 25
# modes of 1/g, over its mean, that τ does not show
MODES = 1e-22
# where Newton's steps in floats end, and when they are given up
CLOSE, ROUNDS = 1e-13, 60


class QuickStates:
    """The :class:`integrable.motion.trajectory.Way` of a motion over RR; ``rows`` is that of its carrier."""

    def __init__(self, rows: RoundedRows) -> None:
        self._rows, self.way = rows, rows.way
        self._packed: tuple[Any, Any] = (None, None)
        self._clock: tuple[Any, Any] = (None, None)

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,)."""
        if not self._rows.many.carrier.rolls:
            return self.at_tau(times), times
        if interpreted() or not len(times):
            return self._rows.at(times)
        carrier: Any = self._rows.many.carrier
        with carrier.precision:
            tau = self._tau(times)
            rows = None if tau is None else self._quick(tau)
        return self._rows.at(times) if tau is None or rows is None else (rows, tau[:, 0])

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ, shape (N, 6)."""
        if interpreted() or not len(tau):
            return self._rows.at_tau(tau)
        carrier: Any = self._rows.many.carrier
        with carrier.precision:
            found = self._quick(np.stack([tau, 0 * tau], axis=-1))
        return self._rows.at_tau(tau) if found is None else found

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        return self._rows.times(tau)

    def _tau(self, times: np.ndarray) -> np.ndarray | None:
        """τ at physical times as double-doubles, shape (N, 2)."""
        carrier: Any = self._rows.many.carrier
        far = carrier.field.coerce(float(times[np.argmax(np.abs(times))]))
        if not carrier.turns(abs(carrier.most_tau(far))) < MOST_TURNS:
            return None
        packed = self._compiled(carrier)
        if packed is None:
            return None
        # one for all times
        if self._clock[0] is not carrier:
            self._clock = carrier, QuickClock.of(carrier, packed[:2])
        clock: QuickClock | None = self._clock[1]
        found = None if clock is None else clock.tau(times)
        if clock is None or found is None:
            return None
        n = int(np.argmax(np.abs(times)))
        return found if clock.holds(found[n : n + 1], times[n : n + 1]) else None

    def _compiled(self, carrier: Any) -> Any:
        """What :func:`packed` makes of a carrier, once."""
        if self._packed[0] is not carrier:
            try:
                self._packed = carrier, packed(carrier)
            except ArgumentError:
                # numbers like |M|² beyond the range of floats
                self._packed = carrier, None
        return self._packed[1]

    def _quick(self, tau: np.ndarray) -> np.ndarray | None:
        carrier: Any = self._rows.many.carrier
        far = int(np.argmax(np.abs(tau[:, 0])))
        if not carrier.turns(carrier.field.coerce(float(tau[far, 0]))) < MOST_TURNS:
            return None
        compiled = self._compiled(carrier)
        if compiled is None:
            return None
        *tracks, frame, order = compiled
        out, rest = np.empty(6 * len(tau)), np.empty(6 * len(tau))
        if not LIBRARY.states(*tracks, frame, tau, out, rest) <= MOST_LOST:
            return None
        places = np.argsort(order)
        columns = np.concatenate([places, 3 + places])
        rows: np.ndarray = out.reshape(-1, 6)[:, columns]
        left = rest.reshape(-1, 6)[far, columns]
        truth = carrier.point(sum(map(carrier.field.coerce, tau[far].tolist())))
        for part, true in zip((slice(3), slice(3, 6)), truth, strict=True):
            size = max(map(abs, true))
            for high, low, x in zip(rows[far, part].tolist(), left[part].tolist(), true, strict=True):
                if not abs(carrier.field.coerce(high) + carrier.field.coerce(low) - x) <= MOST_LOST * size:
                    return None
        return rows


class QuickClock:
    """τ(t) by a series like that of :class:`integrable.deformations.separated_clock.SeparatedClock`, made and summed in
    double-doubles: Newton in floats, and a last step. What 1/g is there is compared with the curves of the carrier.
    """

    @classmethod
    def of(cls, carrier: Any, tracks: tuple[Track, Track]) -> QuickClock | None:
        """That of a carrier; None where the series is long, or modes are resonant."""
        sizes: tuple[int, ...] = series_sizes(carrier, DIGITS)
        for _ in range(GROWTHS):
            rows, columns = sizes
            if rows * columns * (rows + columns) > MOST_WORK:
                break
            modes = expanded(carrier, tracks, rows, columns)
            table = modes.table[:, 0].reshape(rows + 1, columns + 1)
            if not np.isfinite(table).all():
                break
            sizes = grown(table, 10.0**-DIGITS * table[0, 0])
            if sizes == (rows, columns):
                return cls._of_modes(carrier, modes)
        return None

    @classmethod
    def _of_modes(cls, carrier: Any, modes: Modes) -> QuickClock | None:
        mean, (rows, columns) = modes.table[0].copy(), (modes.rows + 1, modes.columns + 1)
        K, periods = carrier.field, [curve.period for curve in carrier.curves]
        # time is counted in the faster one's radians
        unit = 2 * K.context.pi / min(periods)
        speeds = _wide([min(periods) / period for period in periods])
        even, odd = np.empty_like(modes.table), np.empty_like(modes.table)
        least = 10.0**-DIGITS * mean[0] / 16
        if not LIBRARY.integrate(modes, speeds, least, even, odd):
            return None
        tables = [x.reshape(rows, columns, 2) for x in (even, odd, modes.table)]
        # modes below do not change double-doubles' first 20 digits
        loud = np.max([np.abs(x[..., 0]) for x in tables], axis=0) > MODES * mean[0]
        rows, columns = (int(np.flatnonzero(loud.any(axis=1 - k))[-1]) + 1 for k in range(2))
        numbers = [K.zero, K.zero, 2 * K.context.pi]
        for curve, period in zip(carrier.curves, periods, strict=True):
            numbers += [1 / (unit * period), curve.since_low() / period]
        wide = _wide(numbers)
        wide[0] = mean
        return cls(carrier, unit, wide, [np.ascontiguousarray(x[:rows, :columns]) for x in tables])

    def __init__(self, carrier: Any, unit: Any, numbers: np.ndarray, tables: list[np.ndarray]) -> None:
        self._carrier, self._unit, self._inverse = carrier, _wide([unit])[0], _wide([1 / unit])[0]
        self._even, self._odd, self._rates = (x[..., 0] for x in tables)
        even, odd, self._rates_wide = (x.reshape(-1, 2) for x in tables)
        columns = tables[0].shape[1]
        self._waves = Waves(numbers, even, odd, columns, np.zeros((2 * columns, 2)))
        # dt/dτ = 1/g lies between these
        self._bounds = [float(x) / numbers[0, 0] for x in extremes(carrier)]
        start = np.zeros((1, 2))
        LIBRARY.misses(self._waves, start, start, numbers[1:2])

    def tau(self, times: np.ndarray) -> np.ndarray | None:
        """τ as double-doubles, shape (N, 2); None where floats do not converge."""
        t = _times(times, self._unit)
        mean, origin = self._waves.numbers[:2, 0].tolist()
        goal = t[:, 0]
        low, high = np.sort([goal / (mean * bound) for bound in self._bounds], axis=0)
        x = goal / mean
        for _ in range(ROUNDS):
            swing, rate = self._swing(x)
            miss = mean * x + swing - origin - goal
            following, low, high = step_inside(x, miss, rate, low, high)
            steps, x = np.abs(following - x), following
            if (steps <= CLOSE * (1 + np.abs(x))).all():
                break
        else:
            return None
        tau = np.stack([x, 0 * x], axis=-1)
        left = np.empty_like(tau)
        LIBRARY.misses(self._waves, tau, t, left)
        tau[:, 1] = -left[:, 0] / self._swing(x)[1]
        return _product(tau, self._inverse)

    def holds(self, tau: np.ndarray, times: np.ndarray) -> bool:
        """Whether the clock shows a time at τ, shapes (1,) and (1, 2), and 1/g is there and at the start what the
        curves say.
        """
        x, t, left = _product(tau, self._unit), _times(times, self._unit), np.empty_like(tau)
        LIBRARY.misses(self._waves, x, t, left)
        if not abs(left[0, 0]) <= MOST_LOST * (2 * np.pi + abs(t[0, 0])):
            return False
        both = np.concatenate([0 * x, x])
        found = np.empty_like(both)
        LIBRARY.paces(self._waves, self._rates_wide, both, found)
        K, curves = self._carrier.field, self._carrier.curves
        for place, pair in zip((0 * tau, tau), found.tolist(), strict=True):
            wide = sum(map(K.coerce, place[0].tolist()))
            rate = self._carrier.pace(*(curve.height(curve.moved(wide)) for curve in curves))
            if not abs(sum(map(K.coerce, pair)) / rate - 1) <= MOST_OFF:
                return False
        return True

    def _swing(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The sum of sines, and 1/g."""
        _, _, _, a1, b1, a2, b2 = self._waves.numbers[:, 0].tolist()
        first, second = (
            2j * np.pi * np.outer(turns - np.rint(turns), np.arange(size))
            for turns, size in zip((a1 * x + b1, a2 * x + b2), self._even.shape, strict=True)
        )
        one, other = np.exp(first), np.exp(second)
        swing = ((one.imag @ self._even) * other.real + (one.real @ self._odd) * other.imag).sum(axis=1)
        return swing, ((one.real @ self._rates) * other.real).sum(axis=1)


def expanded(carrier: Any, tracks: tuple[Track, Track], rows: int, columns: int) -> Modes:
    """The modes of 1/g."""
    K = carrier.field
    numbers = [carrier.system.d, *carrier.weights, *(curve.mu for curve in carrier.curves)]
    for count in (rows, columns):
        numbers += [K.context.cospi(K.one / count), K.context.sinpi(K.one / count)]
    table, room = (np.empty((size, 2)) for size in ((rows + 1) * (columns + 1), 3 * (rows + columns)))
    modes = Modes(_wide(numbers), rows, columns, table, room)
    LIBRARY.expand(*tracks, modes)
    return modes


def _times(x: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Floats times a double-double."""
    return _product(np.stack([x, 0 * x], axis=-1), scale)


def _product(x: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Double-doubles times one (Dekker 1971)."""
    a, b = scale.tolist()
    high, low = exact_product(x[:, 0], a)
    low = low + x[:, 0] * b + x[:, 1] * a
    total = high + low
    return np.stack([total, low - (total - high)], axis=-1)


def quick_way(rows: RoundedRows) -> RoundedRows | QuickStates:
    """The way to states over the field of ``rows``."""
    return QuickStates(rows) if rows.field == RR else rows


def packed(carrier: Any) -> tuple[Track, Track, Frame, list[int]]:
    """What :func:`integrable.deformations.oval_loops.states` takes, and which axis is which there."""
    lifted = hasattr(carrier, "tilde")
    tilde, one_to_one = carrier.tilde if lifted else carrier, (carrier.field.one,) * 3
    back, speed = (carrier.back, carrier.speed) if lifted else (one_to_one, carrier.field.one)
    body, (one, two) = tilde.system.body, tilde.curves
    order = sorted(range(3), key=lambda i: body.inertia[i])
    odd = order in ([0, 2, 1], [1, 0, 2], [2, 1, 0])
    weights = [s * w for s, w in zip(tilde.signs, tilde.roots_of_weights, strict=True)]
    lean = [r / (w * c) for r, w, c in zip(body.contact, weights, body.differences, strict=True)]
    columns = [[row[i] for i in order] for row in (weights, body.contact, lean, body.a)]
    numbers = [
        *(x for column in columns for x in column),
        body.d,
        one.mu,
        two.mu,
        *tilde.lambdas,
        speed,
        -1 if odd else 1,
        tilde.side,
    ]
    frame = Frame(
        _wide(numbers),
        _wide([back[i] for i in order]),
        lifted,
        (float(tilde.sizes[0]), float(tilde.sizes[1])),
    )
    return _track(one), _track(two), frame, order


def _track(curve: Any) -> Track:
    order = (curve.low, curve.middle, curve.high)
    numbers = [curve.period, curve.height_of_oval, curve.breadth, curve.above]
    for row in (curve.centred, curve.e, curve.start):
        numbers += [row[i] for i in order]
    _, exponent = frexp(max(abs(float(x)) for x in curve.centred))
    ldexp = curve.field.context.ldexp
    series = [ldexp(c, -exponent * n) for n, c in enumerate(curve.series, 2)]
    return Track(_wide(numbers), _wide(series), 2.0**exponent)


def _wide(values: Any) -> np.ndarray:
    return np.array([split(x) for x in values])
