"""Physical time along a tilde flow at d ≠ 0, t = ∫dτ/g, at any τ, by a Fourier series on the torus of two ovals.

g² = Σ|λ_k|(1 + dz_k)/Σ|λ_k| depends only on z_k(θ_k), which are even and periodic in the phases θ_k = 2π(τ +
since_k)/T_k. With 1/g = Σ c_mn cos mθ1 cos nθ2, t(τ) is a mean rate times τ plus a sum of sines, and τ(t) is found by
Newton's method. If mΩ1 + nΩ2 almost vanishes (a resonance), the mode is integrated as one that grows with τ, which
avoids small divisors. Coefficients are integers in units of 2^−bits, so that numpy can multiply matrices of them.
"""

from __future__ import annotations

from math import ceil, isqrt, log
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.deformations.oval import SeparatedOval

GUARD_BITS = 30
MOST_MODES = 1 << 16
"""Largest number of modes at USUAL_BITS bits, about a second of set-up; at more bits it is reduced in proportion."""
USUAL_BITS = 256
# number of modes beyond that which their decay suggests
MARGIN = 6
# size up to which transforms are computed as direct sums
SHORT = 8
# a mode is resonant if |mΩ1 + nΩ2| is 2^RESONANT times smaller than its terms
RESONANT = 10
ROUNDS = 200
ROUGH_ROUNDS = 20


class OnTwoCurves(Protocol):
    """The interface of a motion on two curves that its clock uses."""

    system: Any
    curves: list[SeparatedOval]
    mu: list[Any]

    def z(self, k: int, r: Any) -> Any:
        """z at the roots R_i on curve k."""

    @property
    def field(self) -> Any:
        """The wide numbers of the motion."""

    @property
    def weights(self) -> tuple[Any, Any]:
        """The weights of 1 + dz_k in g²."""

    def pace(self, first: Any, second: Any) -> Any:
        """dt/dτ = 1/g, from z on both curves."""


class SeparatedClock:
    """t(τ) and τ(t) of one motion, to ``digits`` digits relative to its longer period.

    PrecisionLoss if 1/g needs too many modes.
    """

    def __init__(self, motion: OnTwoCurves, digits: int) -> None:
        self.digits = digits
        self._motion = motion
        K = motion.field
        curves = motion.curves
        self._since = [curve.since for curve in curves]
        self._periods = [curve.period for curve in curves]
        # time is measured in radians of the faster phase
        self._unit = 2 * K.context.pi / min(self._periods)
        self._slow = [min(self._periods) / period for period in self._periods]
        least, most = extremes(motion)
        spread = max(self._periods) / min(self._periods) / least
        self._bits = ceil(3.33 * digits) + GUARD_BITS + ceil(float(K.context.log(spread, 2)))
        self._noise = K.coerce(10) ** -digits
        sizes = self._possible(*series_sizes(motion, digits))
        while True:
            table = self._transformed(*sizes)
            sizes, before = self._possible(*grown(table, int(self._noise * abs(table[0, 0])))), sizes
            if sizes == before:
                break
        self._keep(table)
        # allow for rounding
        self._least, self._most = least * (1 - 1e-9), most * (1 + 1e-9)
        self._origin = self._exact(self._phases(K.zero))[0]

    # --- τ(t)

    def tau(self, t: Any) -> Any:
        """τ at a physical time t of either sign."""
        if t == 0:
            return t
        K = self._motion.field
        t = t * self._unit
        # bounds of τ from those of dt/dτ = 1/g
        bounds = low, high = sorted((t / self._most, t / self._least))
        x = t / self._mean
        rough = True
        for k in range(ROUNDS):
            phases = self._phases(x)
            rate = self._rate(phases)
            miss = self._mean * x + self._slowly(x) - t
            miss += K.coerce(self._swing(phases)) if rough else self._exact(phases)[0] - self._origin
            if miss > 0:
                high = min(high, x)
            else:
                low = max(low, x)
            step = miss / K.coerce(rate)
            x = x - step
            inside, small = low <= x <= high, self._noise * (1 + abs(x))
            if not inside:
                x = (low + high) / 2
            if rough:
                if k >= ROUGH_ROUNDS or (inside and abs(step) <= 1e-7):
                    # floats may have chosen the wrong side of the bracket
                    rough, (low, high) = False, bounds
            # the rate has the accuracy of a float, and changes by less than the step
            elif (inside and abs(step) * 1e-6 <= small) or high - low <= small:
                return x / self._unit
        raise PrecisionLoss(f"times: the flow's own time at t = {float(t / self._unit):g} has not converged")

    def time(self, tau: Any) -> Any:
        """The physical time at τ."""
        x = tau * self._unit
        swing = self._exact(self._phases(x))[0] - self._origin
        return (self._mean * x + self._slowly(x) + swing) / self._unit

    def defect(self, tau: Any, rate: Any) -> Any:
        """The relative difference between 1/g by the series at τ and ``rate``."""
        _, found = self._exact(self._phases(tau * self._unit))
        return abs(found / rate - 1)

    # --- the series

    def _phases(self, x: Any) -> list[Any]:
        """θ_k in turns, between −1/2 and 1/2, at a scaled τ."""
        tau = x / self._unit
        turns = [(tau + since) / period for since, period in zip(self._since, self._periods, strict=True)]
        return [n - self._motion.field.context.nint(n) for n in turns]

    def _rate(self, phases: list[Any]) -> float:
        """1/g in floats."""
        (c1, _), (c2, _) = (_turns(float(x), n) for x, n in zip(phases, self._shape, strict=True))
        return float(c1 @ self._float_rate @ c2)

    def _swing(self, phases: list[Any]) -> float:
        """The sum of sines minus its value at the start, in floats."""
        (c1, s1), (c2, s2) = (_turns(float(x), n) for x, n in zip(phases, self._shape, strict=True))
        return float(s1 @ self._float_even @ c2 + c1 @ self._float_odd @ s2) - float(self._origin)

    def _exact(self, phases: list[Any]) -> tuple[Any, Any]:
        """(the sum of sines, 1/g) in wide numbers."""
        (c1, s1), (c2, s2) = (self._circle(x, n) for x, n in zip(phases, self._shape, strict=True))
        unit = self._motion.field.context.ldexp(1, -3 * self._bits)
        swing = s1 @ (self._even @ c2) + c1 @ (self._odd @ s2)
        return swing * unit, (c1 @ (self._table @ c2)) * unit

    def _circle(self, turns: Any, count: int) -> tuple[np.ndarray, np.ndarray]:
        """cos and sin of 0, θ, 2θ, … as integers in units of 2^−bits; θ is given in turns."""
        context, bits = self._motion.field.context, self._bits
        with context.workprec(bits + GUARD_BITS):
            c, s = (int(context.ldexp(f(2 * turns), bits + GUARD_BITS)) for f in (context.cospi, context.sinpi))
        x, y = 1 << (bits + GUARD_BITS), 0
        cosines, sines = [], []
        for _ in range(count):
            cosines.append(x >> GUARD_BITS)
            sines.append(y >> GUARD_BITS)
            x, y = (x * c - y * s) >> (bits + GUARD_BITS), (x * s + y * c) >> (bits + GUARD_BITS)
        return np.array(cosines, dtype=object), np.array(sines, dtype=object)

    def _slowly(self, x: Any) -> Any:
        """The contribution of the resonant modes to t at a scaled τ."""
        context = self._motion.field.context
        total = x * 0
        for value, speed, phase in self._resonant:
            half = speed * x / 2
            total += value * context.cos(phase + half) * (x * context.sin(half) / half if half else x)
        return total

    # --- set-up

    def _possible(self, rows: int, columns: int) -> tuple[int, int]:
        if rows * columns * max(self._bits, USUAL_BITS) > MOST_MODES * USUAL_BITS:
            raise self._too_many(rows, columns)
        return rows, columns

    def _too_many(self, rows: int, columns: int) -> PrecisionLoss:
        return PrecisionLoss(
            f"times: 1/g takes a series of {rows} × {columns} modes for {self.digits} digits; fewer digits, times "
            "nearer to 0, or at_tau (the flow's own time) are within reach"
        )

    def _transformed(self, rows: int, columns: int) -> np.ndarray:
        """c_mn as integers in units of 2^−bits, shape (rows + 1, columns + 1)."""
        motion, bits = self._motion, self._bits
        parts = []
        for k, (curve, weight, n) in enumerate(zip(motion.curves, motion.weights, (rows, columns), strict=True)):
            heights = [motion.z(k, curve.at(j * motion.field.one / (2 * n))) for j in range(n + 1)]
            parts.append([int(motion.field.context.ldexp(weight * (1 + motion.system.d * z), bits)) for z in heights])
        one = 1 << (3 * bits)
        values = np.array([[isqrt(one // (x + y)) for y in parts[1]] for x in parts[0]], dtype=object)
        for n in (rows, columns):
            values = self._cosines(values, n).T
        return values

    def _cosines(self, values: np.ndarray, count: int) -> np.ndarray:
        """The c_k with Σ_k c_k cos(πjk/n) = values_j, j, k = 0 … n, along the first axis."""
        # transforms of even real columns are real, so one complex transform computes two of them
        width = (values.shape[1] + 1) // 2
        real, imaginary = values[:, :width], values[:, width:]
        if imaginary.shape[1] < width:
            imaginary = np.concatenate([imaginary, 0 * values[:, :1]], axis=1)
        circle = self._circle(self._motion.field.one / (2 * count), 2 * count)
        real, imaginary = (np.concatenate([x, x[-2:0:-1]]) for x in (real, imaginary))
        parts = _fourier(real, imaginary, circle, self._bits)
        result: np.ndarray = np.concatenate([x[: count + 1] for x in parts], axis=1)[:, : values.shape[1]] // count
        result[[0, -1]] = result[[0, -1]] // 2
        return result

    def _keep(self, table: np.ndarray) -> None:
        """Stores the tables of the sums: the amplitudes c/(mΩ1 + nΩ2) of the sines, and the resonant modes."""
        motion, bits = self._motion, self._bits
        context = motion.field.context
        self._mean = motion.field.coerce(int(table[0, 0])) * context.ldexp(1, -bits)
        least = int(self._noise * abs(table[0, 0])) >> 4
        loud = abs(table) > least
        rows, columns = (int(np.flatnonzero(loud.any(axis=1 - k))[-1]) + 1 for k in range(2))
        table = table[:rows, :columns]
        self._shape, self._table = (rows, columns), table
        even = np.full((rows, columns), 0, dtype=object)
        odd = even.copy()
        first, second = (int(context.ldexp(x, 2 * bits)) for x in self._slow)
        self._resonant = []
        for m in range(rows):
            for n in range(columns):
                value = int(table[m, n])
                if (m, n) == (0, 0) or abs(value) <= least:
                    continue
                # cos mθ1 cos nθ2 is the mean of cos(mθ1 + nθ2) and cos(mθ1 − nθ2)
                for sign in (1, -1) if m and n else (1,):
                    share = value // 2 if m and n else value
                    speed = m * first + sign * n * second
                    if abs(speed) << RESONANT < m * first + n * second:
                        self._resonant.append(self._mode(share, m, sign * n))
                        continue
                    swing = (share << (2 * bits)) // speed
                    even[m, n] += swing
                    odd[m, n] += sign * swing
        self._even, self._odd = even, odd
        self._float_rate, self._float_even, self._float_odd = (_floats(x, bits) for x in (table, even, odd))

    def _mode(self, value: int, m: int, n: int) -> tuple[Any, Any, Any]:
        """(coefficient, angular frequency in scaled τ, phase at τ = 0) of a mode."""
        context = self._motion.field.context
        speed = m * self._slow[0] + n * self._slow[1]
        turns = [since / period for since, period in zip(self._since, self._periods, strict=True)]
        phase = 2 * context.pi * (m * turns[0] + n * turns[1])
        return self._motion.field.coerce(value) * context.ldexp(1, -self._bits), speed, phase


def _floats(table: np.ndarray, bits: int) -> np.ndarray:
    """Integers in units of 2^−bits as floats."""
    # drop the bits that would exceed the range of floats
    dropped = max(0, bits - 200)
    result: np.ndarray = (table >> dropped).astype(float) * 0.5 ** (bits - dropped)
    return result


def _turns(turns: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """cos and sin of 0, θ, 2θ, … in floats; θ is given in turns."""
    angles = 2 * np.pi * turns * np.arange(count)
    return np.cos(angles), np.sin(angles)


def extremes(motion: OnTwoCurves) -> tuple[Any, Any]:
    """(smallest, largest) value of 1/g on the torus."""
    ends = [[c.e[i] / mu for i in (c.low, c.middle)] for c, mu in zip(motion.curves, motion.mu, strict=True)]
    return motion.pace(*map(max, ends)), motion.pace(*map(min, ends))


def series_sizes(motion: OnTwoCurves, digits: int) -> tuple[int, int]:
    """The number of modes in either phase: c_mn decay as e^(−m·strip) if 1/g has no singularity in the strip.

    z has a pole at the imaginary half-period of either curve. g² vanishes where Σ|λ_k|(1 + dz_k) does. On the second
    curve, where z < 0, that is as far from the real axis as the pole; on the first curve it is nearer.
    """
    d = motion.system.d
    one, two = motion.curves
    share = motion.weights[1] / motion.weights[0]
    least = min(two.e[i] / motion.mu[1] for i in (two.low, two.middle))
    zero = -(1 + share * (1 + d * least)) / d
    heights = one.imaginary_half(zero * motion.mu[0]), two.imaginary_half(None)
    turn = 2 * motion.field.context.pi
    strips = [turn * x / curve.period for x, curve in zip(heights, motion.curves, strict=True)]
    rows, columns = (int(digits * log(10) / float(x)) + MARGIN for x in strips)
    return _smooth(rows), _smooth(columns)


def grown(table: np.ndarray, noise: Any) -> tuple[int, int]:
    """The size of a table if its last modes are noise, otherwise a larger size."""
    rows, columns = (n - 1 for n in table.shape)
    if abs(table[-1 - rows // 16 :]).max() > noise:
        rows = _smooth(rows + rows // 4 + 1)
    if abs(table[:, -1 - columns // 16 :]).max() > noise:
        columns = _smooth(columns + columns // 4 + 1)
    return rows, columns


def _smooth(count: int) -> int:
    """The smallest number ≥ ``count`` that is 5, 6, 7 or 8 times a power of 2."""
    power = 1 << max(0, (count - 1).bit_length() - 3)
    return -(-count // power) * power


def _fourier(real: np.ndarray, imaginary: np.ndarray, circle: Any, bits: int) -> tuple[np.ndarray, np.ndarray]:
    """The transform Σ x_j e^(−2πijk/n) along the first axis of arrays of integers (Cooley & Tukey 1965).

    ``circle`` holds, in units of 2^−bits, the cosines and sines of a full turn divided into a multiple of n parts.
    """
    cosines, sines = circle
    n, stride = len(real), len(cosines) // len(real)
    if n % 2 or n <= SHORT:
        k = np.arange(n)
        turns = np.outer(k, k) % n * stride
        c, s = cosines[turns], sines[turns]
        return (c @ real + s @ imaginary) >> bits, (c @ imaginary - s @ real) >> bits
    even, odd = (_fourier(real[i::2], imaginary[i::2], circle, bits) for i in range(2))
    c, s = (x[: n // 2 * stride : stride, None] for x in circle)
    x, y = (c * odd[0] + s * odd[1]) >> bits, (c * odd[1] - s * odd[0]) >> bits
    return np.concatenate([even[0] + x, even[0] - x]), np.concatenate([even[1] + y, even[1] - y])
