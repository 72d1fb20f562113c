"""The two points of a motion's divisor on the ovals of its curve, and the angles of the torus that follow from them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from integrable.phase import coordinates
from integrable.phase.state import State
from jacobian.errors import NotRepresentable, PrecisionLoss

__all__ = ["Ovals", "ovals"]

SAMPLES = 4096
"""The number of points of an oval for integrals along it: enough, as the functions are smooth and periodic."""
SHORT = 1e-7
"""Ovals and gaps shorter than this fraction of the interval of all branch points are lost in the rounding of floats."""


class Ovals(NamedTuple):
    """The points of N states: ``u`` and ``y``, shape (N, 2), are the coordinates of the points on the two ovals.

    ``angles``, shape (N, 2), are the position of the sum of both points on the torus, in turns, not reduced. ``rates``,
    shape (2,), are the rates of the angles, in turns per unit of τ. ``outlines`` has a closed line (x, y) for each
    oval.
    """

    u: np.ndarray
    y: np.ndarray
    angles: np.ndarray
    rates: np.ndarray
    outlines: tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


class Oval:
    """One oval a ≤ x ≤ b of y² = f(x), x = middle − half·cos φ: dx/y = dφ/√q with f = (x − a)(b − x)q."""

    def __init__(self, a: float, b: float, others: list[float], scale: float, d: float) -> None:
        self.middle, self.half = (a + b) / 2, (b - a) / 2
        self._others, self._scale, self._d = others, scale, d
        phi = 2 * np.pi * np.arange(SAMPLES + 1) / SAMPLES
        x = self.x(phi)
        density = 1 / np.sqrt(self.q(x))
        self._phi = phi
        self._integrals = [_antiderivative(density * x**j) for j in (0, 1)]
        self.periods = np.array([whole[-1] for whole in self._integrals])

    def x(self, phi: np.ndarray) -> np.ndarray:
        return self.middle - self.half * np.cos(phi)

    def q(self, x: np.ndarray) -> np.ndarray:
        first, second = self._others
        return np.abs(self._scale * (1 - self._d * x) * (x - first) * (x - second))

    def outline(self) -> tuple[np.ndarray, np.ndarray]:
        phi = self._phi[:: SAMPLES // 128]
        return self.x(phi), self.half * np.sin(phi) * np.sqrt(self.q(self.x(phi)))

    def phi(self, u: np.ndarray, y: np.ndarray) -> np.ndarray:
        """The angle φ of points (u, y) of the oval, made continuous along the points."""
        sine = y / np.sqrt(self.q(u)) / self.half
        return np.unwrap(np.arctan2(sine, (self.middle - u) / self.half))

    def integrals(self, phi: np.ndarray) -> np.ndarray:
        """The integrals of dx/y and x dx/y along the oval from φ = 0 to ``phi``, shape (N, 2)."""
        turns, rest = np.divmod(phi, 2 * np.pi)
        parts = [np.interp(rest, self._phi, whole) for whole in self._integrals]
        return np.stack(parts, axis=1) + turns[:, None] * self.periods


def _antiderivative(values: np.ndarray) -> np.ndarray:
    """The integral from 0 to φ of a smooth function of period 2π, by its Fourier series.

    ``values`` are at equally spaced φ, both ends of the period included.
    """
    count = len(values) - 1
    modes = np.fft.rfft(values[:-1])
    phi = 2 * np.pi * np.arange(count + 1) / count
    orders = np.arange(1, len(modes))
    swing = np.zeros(len(modes), dtype=complex)
    swing[1:] = modes[1:] / (1j * orders)
    periodic = np.fft.irfft(swing, count)
    periodic = np.append(periodic, periodic[0])
    return phi * modes[0].real / count + periodic - periodic[0]


def ovals(system: Any, states: list[State]) -> Ovals:
    """The points of the divisors of ``states`` of one motion.

    The angles are continuous if between two states no point goes half round its oval. Otherwise they are right up to
    whole turns. Raises NotRepresentable where an oval has shrunk to a point (equal moments, a rotation about an axis)
    or the two ovals have met, and PrecisionLoss if the points meet within rounding.
    """
    if states[0].tilted:
        system, _, change = system.upright(states[0])
        states = [change.apply(state) for state in states]
    body = system.body
    h1, h2 = (float(x) for x in system.integrals(states[0])[2:])
    low, middle, high = sorted(map(float, body.a))
    turning = h1 / h2
    ends = (low, min(turning, middle), max(turning, middle), high)
    if high - low < SHORT * high or min(np.diff(ends)) < SHORT * (high - low):
        raise NotRepresentable("the ovals of this motion's curve have shrunk or met: it has no torus of two angles")
    scale, d = 4 * h2, float(body.d)
    pair = (
        Oval(ends[0], ends[1], [ends[2], ends[3]], scale, d),
        Oval(ends[2], ends[3], [ends[0], ends[1]], scale, d),
    )
    u, y = _points(body, states, ends)
    integrals = sum(oval.integrals(oval.phi(u[:, k], y[:, k])) for k, oval in enumerate(pair))
    periods = np.stack([oval.periods for oval in pair], axis=1)
    angles = np.linalg.solve(periods, np.asarray(integrals).T).T
    # Σ∫dx/y is τ, and Σ∫x dx/y is constant
    rates = np.linalg.solve(periods, [1.0, 0.0])
    return Ovals(u, y, angles, rates, (pair[0].outline(), pair[1].outline()))


def _points(body: Any, states: list[State], ends: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    """The roots of U of each state, each moved into its oval, and the values of V there; both of shape (N, 2)."""
    rows = [coordinates.to_mumford(body, coordinates.to_pairs(body, state)) for state in states]
    U, V = (np.array(part, dtype=float) for part in zip(*rows, strict=True))
    square = U[:, 1] ** 2 - 4 * U[:, 0]
    if (square < 0).any():
        raise PrecisionLoss("the two points of the divisor meet within rounding")
    larger = (np.sqrt(square) - U[:, 1]) / 2
    u = np.stack([U[:, 0] / larger, larger], axis=1)
    u = np.clip(u, ends[::2], ends[1::2])
    return u, V[:, :1] + V[:, 1:2] * u
