"""Motions in closed form: tops and upright balls with two equal moments, bodies with three.

Only one or two angles grow with the time; they are reduced modulo 2π in 40 digits (tops, three equal moments) or in
long doubles (balls). Nothing of :mod:`integrable` is imported.
"""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np

from tests.fuzz.case import Undecided
from tests.fuzz.distributions import Motion

EPS = 2.0**-52
PI = 4 * np.arctan(np.longdouble(1))
MOST_NODES = 2**16


class Closed:
    """The result of an oracle: ``rows`` (N, 6) of γ and M/|M| at times, and ``floor`` (N,), the errors caused by one
    unit in the last place of every input.
    """

    def __init__(self, start: Motion, digits: int = 40) -> None:
        self.context = c = mpmath.MPContext()
        c.dps = digits
        self.start = start
        gamma, M = ([c.mpf(x) for x in v] for v in (start.gamma, start.M))
        size = c.sqrt(c.fdot(gamma, gamma))
        gamma = [x / size for x in gamma]
        if not start.tilted:
            height = c.fdot(gamma, M)
            M = [m - height * x for m, x in zip(M, gamma, strict=True)]
        self.gamma, self.M, self.length = gamma, M, c.sqrt(c.fdot(M, M))
        self.vectors = [gamma, [m / self.length for m in M]]

    def turned(self, axis: list[Any], v: list[Any], angle: Any) -> list[Any]:
        """v turned about a unit vector."""
        c, cosine, sine = self.context, *self.context.cos_sin(angle)
        along = c.fdot(axis, v) * (1 - cosine)
        return [cosine * x + sine * y + along * z for x, y, z in zip(v, cross(axis, v), axis, strict=True)]

    def wide_rows(self, times: Any) -> list[list[Any]]:
        raise NotImplementedError

    def rates(self) -> Any:
        """The sum of the rates at which the angles grow."""
        raise NotImplementedError

    def rows(self, times: Any) -> np.ndarray:
        return np.array(self.wide_rows(times), dtype=float)

    def floor(self, times: Any) -> np.ndarray:
        """Every rate is a product and quotient of inputs: its rounding is an angle of eps·rate·t."""
        rate = float(self.rates())
        return np.array([EPS * (4 + 2 * rate * abs(float(t))) for t in times])


class SymmetricTop(Closed):
    """Two equal moments, d = 0: with moments (I1, I, I) and λ = M1(1/I1 − 1/I), γ(t) = R(e1, −λt)·R(M, −|M|t/I)γ(0) and
    M(t) = R(e1, −λt)M(0), because γ̇ = γ×ω, Ṁ = M×ω with ω = M/I + λe1 (Euler 1758)."""

    def __init__(self, start: Motion, digits: int = 40) -> None:
        super().__init__(start, digits)
        c, k = self.context, odd_axis(start.inertia)
        first, other = c.mpf(start.inertia[k]), c.mpf(start.inertia[k - 1])
        self.axis = [c.mpf(i == k) for i in range(3)]
        self.spin, self.turn = self.M[k] * (1 / first - 1 / other), self.length / other
        self._rates = abs(self.M[k]) / first + abs(self.M[k]) / other + self.turn

    def rates(self) -> Any:
        return self._rates

    def wide_rows(self, times: Any) -> list[list[Any]]:
        c, (gamma, M) = self.context, self.vectors
        found = []
        for t in map(c.mpf, times):
            x = self.turned(M, gamma, -self.turn * t)
            found.append([y for v in (x, M) for y in self.turned(self.axis, v, -self.spin * t)])
        return found


class EqualMoments(Closed):
    """Three equal moments, any d: ω = aM + d·a²g²(γ, M)γ is constant, and γ and M turn about it."""

    def __init__(self, start: Motion, digits: int = 40) -> None:
        super().__init__(start, digits)
        c = self.context
        d = c.mpf(start.d)
        a, share = 1 / (c.mpf(start.inertia[0]) + d), c.mpf(start.inertia[0]) / (c.mpf(start.inertia[0]) + d)
        spin = d * a * a * c.fdot(self.gamma, self.M) / share
        self.omega = [a * m + spin * x for m, x in zip(self.M, self.gamma, strict=True)]
        self.rate = c.sqrt(c.fdot(self.omega, self.omega))

    def rates(self) -> Any:
        return 2 * self.rate

    def wide_rows(self, times: Any) -> list[list[Any]]:
        axis = [x / self.rate for x in self.omega]
        return [
            [y for v in self.vectors for y in self.turned(axis, v, -self.rate * t)]
            for t in map(self.context.mpf, times)
        ]


class SymmetricBall:
    """Two equal moments, d > 0, (γ, M) = 0: moments (I1, I, I), a1 = 1/(I1 + d), a = 1/(I + d).

    d log M1/dγ1 = ½ d log q/dγ1 with q = g⁻² = q0 − q1γ1², q0 = 1 − da, q1 = d(a1 − a): M1 = K√q. With N = (γ×M)_1,
    γ̇1 = aN and N² = H2 − K²q0 − (H2 − K²q1)γ1²: γ1 is a harmonic oscillation. The direction of (γ2, γ3) turns at
    −ω1 + γ1(γ2ω2 + γ3ω3)/(1 − γ1²), that of (M2, M3) at −ω1 + M1(M2ω2 + M3ω3)/(H2 − M1²), functions of γ1² with rapidly
    converging Fourier series in the oscillation's phase. Of the two, the one that stays away from its pole is used.
    """

    def __init__(self, start: Motion) -> None:
        self.start = start

    def rows(self, times: Any) -> np.ndarray:
        return self._rows(self.start.inertia, self.start.d, self.start.gamma, self.start.M, times).astype(float)

    def floor(self, times: Any) -> np.ndarray:
        """The largest effect of three random relative changes of all inputs by 2^-50, scaled to changes of 2^-52."""
        s, wild = self.start, np.random.default_rng(0)
        base, worst = self._rows(s.inertia, s.d, s.gamma, s.M, times), np.zeros(len(times))
        for _ in range(3):
            f = 1 + 2.0**-50 * wild.choice([-1, 1], 10)
            k = odd_axis(s.inertia)
            f[(k + 1) % 3] = f[(k + 2) % 3]
            moved = self._rows(s.inertia * f[:3], s.d * f[3], s.gamma * f[4:7], s.M * f[7:], times)
            worst = np.maximum(worst, abs(moved - base).max(axis=1).astype(float))
        return worst / 4 + 4 * EPS

    def _rows(self, inertia: Any, d: Any, gamma: Any, M: Any, times: Any) -> np.ndarray:
        k = odd_axis(self.start.inertia)
        wide = [np.roll(np.array(v, dtype=np.longdouble), -k) for v in (inertia, gamma, M)]
        found = _ball_rows(*wide, np.longdouble(d), np.array(times, dtype=np.longdouble))
        return np.hstack([np.roll(found[:, :3], k, axis=1), np.roll(found[:, 3:], k, axis=1)])


def _ball_rows(inertia: Any, gamma: Any, M: Any, d: Any, times: Any) -> np.ndarray:
    gamma = gamma / np.sqrt(gamma @ gamma)
    M = M - (gamma @ M) * gamma
    unit = np.sqrt(M @ M)
    M, times = M / unit, times * unit
    first, a = 1 / (inertia[0] + d), 1 / (inertia[1] + d)
    # 1 − da, a − a1 and d(a1 − a) as products, so that nothing cancels
    q0, gap = inertia[1] * a, (inertia[0] - inertia[1]) * first * a
    q1 = -d * gap
    K = M[0] / np.sqrt(q0 - q1 * gamma[0] ** 2)
    omega = a * np.sqrt(1 - K * K * q1)
    cosine, sine = gamma[0], a * (gamma[1] * M[2] - gamma[2] * M[1]) / omega
    size, origin = np.hypot(cosine, sine), np.arctan2(cosine, sine)

    def at(phase: Any) -> tuple[Any, ...]:
        """γ1, M1, N and dn at phases, γ1 = size·sin."""
        x = size * np.sin(phase)
        q = q0 - q1 * x * x
        m = K * np.sqrt(q)
        return x, m, size * np.cos(phase) * omega / a, q1 * x * m / q

    def rate_of_gamma(phase: Any) -> Any:
        x, m, _, dn = at(phase)
        return -first * m + gap * dn * x - a * x * x * m / (1 - x * x)

    def rate_of_M(phase: Any) -> Any:
        x, m, _, dn = at(phase)
        return gap * m - dn * x * (first + a * m * m / (1 - m * m))

    shown = np.linspace(0, np.pi / 2, 65)
    x, m, *_ = at(shown.astype(np.longdouble))
    by_gamma = (1 - x * x).min() > (1 - m * m).min()
    vector, rate = (gamma, rate_of_gamma) if by_gamma else (M, rate_of_M)
    phases = origin + omega * times
    angle = np.arctan2(vector[2], vector[1]) + _integral(rate, origin, omega * times) / omega
    x, m, N, _ = at(phases)
    across = np.sqrt(1 - (x * x if by_gamma else m * m))
    u, v = across * np.cos(angle), across * np.sin(angle)
    other = _partner(u, v, -x * m, N if by_gamma else -N)
    pair = ((u, v), other) if by_gamma else (other, (u, v))
    return np.stack([x, *pair[0], m, *pair[1]], axis=1)


def _partner(u: Any, v: Any, product: Any, area: Any) -> tuple[Any, Any]:
    """The plane vector with the given scalar product and area with (u, v)."""
    square = u * u + v * v
    return (product * u - area * v) / square, (product * v + area * u) / square


def _integral(rate: Any, origin: Any, lengths: Any) -> Any:
    """∫ of an even function of period π from the phase ``origin`` over each of ``lengths``, by its Fourier series from
    equidistant values.
    """
    nodes = 32
    while nodes <= MOST_NODES:
        values = rate(PI * np.arange(nodes, dtype=np.longdouble) / nodes)
        series = np.fft.rfft(values).real / nodes
        if abs(series[-4:]).max() <= 1e-17 * abs(series).max():
            break
        nodes *= 2
    else:
        raise Undecided("a Fourier series has not ended")
    k = np.flatnonzero(abs(series) > 1e-20 * abs(series).max())
    k = k[k > 0].astype(np.longdouble)
    # differences of sines as products: short lengths keep all their digits
    half = np.multiply.outer(lengths, k)
    waves = 2 * np.sin(half) * np.cos(half + 2 * k * origin)
    return series[0] * lengths + waves @ (series[k.astype(int)] / k)


def odd_axis(inertia: Any) -> int:
    """The axis whose moment differs from the two equal ones."""
    return next((k for k in range(3) if inertia[k - 1] == inertia[k - 2] != inertia[k]), 0)


def cross(x: Any, y: Any) -> list[Any]:
    return [x[i - 2] * y[i - 1] - x[i - 1] * y[i - 2] for i in range(3)]
