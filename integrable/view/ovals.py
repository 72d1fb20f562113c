"""The two points of a motion's divisor on the ovals of its curve, and the angles of the torus that follow from them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from integrable.phase import coordinates
from integrable.phase.state import State
from integrable.portrait.ovals import Level
from integrable.portrait.section import sums_over_ovals
from jacobian.errors import NotRepresentable, PrecisionLoss

__all__ = ["Ovals", "ovals"]

OUTLINE = 128
"""The number of points of an oval's outline."""
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
    low, between, high = sorted(map(float, body.a))
    level = Level((low, between, high), (0, 1, 2), h1 / h2, float(body.d), h2**0.5, 1.0)
    ends = np.array(level.ends, dtype=float)
    if high - low < SHORT * high or min(np.diff(ends)) < SHORT * (high - low):
        raise NotRepresentable("the ovals of this motion's curve have shrunk or met: it has no torus of two angles")
    u, y = _points(body, states, ends)
    sums, rates = sums_over_ovals(level)
    # each row is for both ovals: x = middle − half·cos φ, y = half·√q·sin φ with φ = 0 at the outer end
    outer, inner = ends[[0, 3]], ends[[1, 2]]
    middle, half = (outer + inner) / 2, (inner - outer) / 2

    def height(x: np.ndarray) -> np.ndarray:
        """half·√q at abscissas in both ovals, shape (N, 2)."""
        gaps = (x - inner[::-1]) * (x - outer[::-1])
        return half * np.sqrt(np.abs(4 * h2 * (1 - level.d * x) * gaps))

    phi = np.unwrap(np.arctan2(y / height(u), (middle - u) / half), axis=0)
    # angles are counted from the lower ends of the ovals
    angles = sums.phases_at(phi) + np.array([0, 0.5])
    turn = np.linspace(0, 2 * np.pi, OUTLINE + 1)[:, None]
    x = middle - half * np.cos(turn)
    first, second = zip(x.T, (height(x) * np.sin(turn)).T, strict=True)
    return Ovals(u, y, angles, rates, (first, second))


def _points(body: Any, states: list[State], ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
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
