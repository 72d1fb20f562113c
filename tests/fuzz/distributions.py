"""Random numbers, vectors, bodies and times over many decades.

Only products, sums and square roots of random bits are used: IEEE arithmetic gives the same floats on every machine.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ldexp, sqrt
from random import Random
from typing import Any

Vector = tuple[float, float, float]


def magnitude(rng: Random, low: int, high: int) -> float:
    """A number between 2^low and 2^high with a uniform exponent."""
    return ldexp(1 + rng.random(), rng.randrange(low, high))


def unit(rng: Random) -> Vector:
    """A unit vector, uniform on the sphere."""
    while True:
        x, y, z = (2 * rng.random() - 1 for _ in range(3))
        square = x * x + y * y + z * z
        if 0.01 < square <= 1:
            return normal((x, y, z))


def normal(v: Any) -> Vector:
    """v divided by its length."""
    size = sqrt(sum(x * x for x in v))
    x, y, z = (c / size for c in v)
    return x, y, z


def cross(x: Any, y: Any) -> Vector:
    return x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]


def dot(x: Any, y: Any) -> float:
    return float(sum(a * b for a, b in zip(x, y, strict=True)))


@dataclass(frozen=True)
class Motion:
    """A body and a start, all floats; ``tilted``: (γ, M) is not 0."""

    inertia: Vector
    d: float
    gamma: Vector
    M: Vector
    tilted: bool

    @property
    def speed(self) -> float:
        """|M| max a: roughly the turns per unit of time."""
        return sqrt(dot(self.M, self.M)) / (min(self.inertia) + self.d)

    @property
    def setup(self) -> str:
        """The lines that make ``system`` and ``state``."""
        name, d = ("ChaplyginBall", f", {self.d}") if self.d else ("EulerTop", "")
        tilted = ", tilted=True" if self.tilted else ""
        return (
            "import numpy as np\n"
            f"from integrable import {name}\n"
            f"system = {name}({self.inertia}{d})\n"
            f"state = system.state({self.gamma}, {self.M}{tilted})\n"
        )


def shuffled(rng: Random, values: Any) -> Vector:
    x, y, z = rng.sample(list(values), 3)
    return x, y, z


def general_moments(rng: Random) -> Vector:
    """Three moments within one binary order, or within ten or twenty-four of each other."""
    spread = rng.choice((1, 1, 2, 10, 24))
    scale = magnitude(rng, -20, 20)
    x, y, z = (scale * magnitude(rng, -spread, spread) for _ in range(3))
    return x, y, z


def symmetric_moments(rng: Random) -> Vector:
    """Two exactly equal moments, oblate or prolate."""
    x, y, _ = general_moments(rng)
    return shuffled(rng, (x, y, y))


def close_moments(rng: Random) -> Vector:
    """Two or three moments with relative differences of 2^-52 … 2^-10."""
    x, y, _ = general_moments(rng)
    third = y * (1 + ldexp(1 + rng.random(), rng.randrange(-52, -10)))
    if rng.random() < 0.3:
        x = y * (1 + ldexp(1 + rng.random(), rng.randrange(-52, -10)))
    return shuffled(rng, (x, y, third))


def equal_moments(rng: Random) -> Vector:
    x = magnitude(rng, -20, 20)
    return x, x, x


def rolling(rng: Random, inertia: Vector) -> float:
    """d of the size of the moments or, one time in three, tiny or huge relative to them."""
    return max(inertia) * magnitude(rng, *rng.choice(((-3, 3), (-3, 3), (-6, 6), (-30, -6), (6, 30))))


def gamma(rng: Random) -> Vector:
    """Unit vectors, one in five on a coordinate plane or an axis."""
    x = list(unit(rng))
    choice = rng.random()
    if choice < 0.15:
        x[rng.randrange(3)] = 0.0
    elif choice < 0.2:
        kept = rng.randrange(3)
        x = [c if i == kept else 0.0 for i, c in enumerate(x)]
    return normal(x)


def momentum(rng: Random, upward: Vector, tilted: bool) -> Vector:
    """M of size 2^±20: anywhere, on a coordinate plane, or near a rotation about an axis (the separatrix for one)."""
    if rng.random() < 0.25:
        k = rng.randrange(3)
        distance = rng.choice((0.0, ldexp(1, rng.randrange(-50, -2))))
        x, y, z = (float(i == k) + distance * c for i, c in enumerate(unit(rng)))
        direction = normal((x, y, z))
    else:
        direction = gamma(rng)
    size = magnitude(rng, -20, 20)
    if tilted:
        return size * direction[0], size * direction[1], size * direction[2]
    across = _orthogonal(upward, direction)
    return size * across[0], size * across[1], size * across[2]


def _orthogonal(gamma: Vector, v: Vector) -> Vector:
    """The direction of the part of v orthogonal to γ, projected twice because of rounding; of another vector if v is
    almost parallel to γ.
    """
    for _ in range(2):
        height = dot(gamma, v)
        x, y, z = (a - height * b for a, b in zip(v, gamma, strict=True))
        if x * x + y * y + z * z < 1e-6:
            return _orthogonal(gamma, (gamma[1], gamma[2], gamma[0]) if gamma[0] != gamma[1] else (1.0, 0.0, 0.0))
        v = normal((x, y, z))
    return v


def motion(rng: Random, inertia: Vector, *, rolls: bool, tilted: bool) -> Motion:
    upward = gamma(rng)
    if tilted:
        M = momentum(rng, upward, True)
        while dot(cross(upward, M), cross(upward, M)) < 1e-8 * dot(M, M):
            M = momentum(rng, upward, True)
    else:
        M = momentum(rng, upward, False)
    return Motion(inertia, rolling(rng, inertia) if rolls else 0.0, upward, M, tilted)


def times(rng: Random, start: Motion, count: int, low: int = -10, high: int = 17) -> list[float]:
    """Times of either sign, 2^low … 2^high turns long, the numbers of turns log-uniform."""
    return [rng.choice((1, -1)) * magnitude(rng, low, high) / start.speed for _ in range(count)]
