"""States of the tilde, check and hat pairs in floats: the additions compiled for double-double numbers.

What they have lost is measured on every call, by H and K of all states in double-doubles and by the farthest state of a
carrier of more digits; where that is more than floats show, or τ is too many periods away, that carrier computes them.
"""

from __future__ import annotations

from math import frexp
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.deformations.oval_loops import LIBRARY, Frame, Track, Waves
from integrable.motion.precise import SPARE
from integrable.moving_point.newton import step_inside
from jacobian import RR
from jacobian.errors import ArgumentError
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.double_double import exact_product, split

if TYPE_CHECKING:
    from integrable.deformations.separated_clock import Doubles
    from integrable.motion.precise import RoundedRows

# periods after which double-doubles may lack digits
MOST_TURNS = 1e6
# what H and K, relative to their sizes, and the farthest state may be off by
MOST_LOST = 1e-20
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
        many: Any = self._rows.many
        carrier = many.carrier
        far = carrier.field.coerce(float(times[np.argmax(np.abs(times))]))
        if not carrier.turns(abs(carrier.most_tau(far))) < MOST_TURNS:
            return None
        # one for all times
        clock = carrier.clock(many.digits + SPARE + carrier.lost(MOST_TURNS * carrier.period))
        if self._clock[0] is not clock:
            doubles = clock.doubles()
            self._clock = clock, None if doubles is None else QuickClock(doubles)
        quick = self._clock[1]
        found = None if quick is None else quick.tau(times)
        if found is None:
            return None
        n = int(np.argmax(np.abs(times)))
        tau = sum(map(carrier.field.coerce, found[n].tolist()))
        return found if abs(clock.time(tau) - far) <= MOST_LOST * (carrier.period + abs(far)) else None

    def _quick(self, tau: np.ndarray) -> np.ndarray | None:
        carrier: Any = self._rows.many.carrier
        far = int(np.argmax(np.abs(tau[:, 0])))
        if not carrier.turns(carrier.field.coerce(float(tau[far, 0]))) < MOST_TURNS:
            return None
        if self._packed[0] is not carrier:
            try:
                self._packed = carrier, packed(carrier)
            except ArgumentError:
                # numbers like |M|² beyond the range of floats
                self._packed = carrier, None
        if self._packed[1] is None:
            return None
        *tracks, frame, order = self._packed[1]
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
    """τ(t) of a :class:`integrable.deformations.separated_clock.SeparatedClock`: Newton in floats, and a last step from
    double-doubles.
    """

    def __init__(self, clock: Doubles) -> None:
        self._bounds = clock.bounds
        # modes below do not change double-doubles' first 20 digits
        scale = 2.0**-clock.bits
        least = int(MODES * abs(int(clock.rates[0, 0])))
        loud = (abs(clock.even) > least) | (abs(clock.odd) > least) | (abs(clock.rates) > least)
        rows, columns = (int(np.flatnonzero(loud.any(axis=1 - k))[-1]) + 1 for k in range(2))
        even, odd, rates = (x[:rows, :columns] for x in (clock.even, clock.odd, clock.rates))
        wide = _wide([*clock.numbers, clock.unit])
        self._unit, self._inverse = wide[-1], _wide([1 / clock.unit])[0]
        first, second = (_halves(x, clock.bits) for x in (even, odd))
        self._waves = Waves(wide[:-1].copy(), first, second, columns, np.zeros((2 * columns, 2)))
        self._even, self._odd, self._rates = (x.astype(float) * scale for x in (even, odd, rates))

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


def _halves(table: np.ndarray, bits: int) -> np.ndarray:
    """Integers in units of 2^−bits as double-doubles, one after the other."""
    values = table.ravel().tolist()
    high = [float(x) for x in values]
    low = [float(x - int(y)) for x, y in zip(values, high, strict=True)]
    return np.ldexp(np.array([high, low]).T, -bits).copy()


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
