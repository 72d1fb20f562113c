"""Fuzz of the systems of ``integrable.classical``: states in floats at near times, at many, and far away.

Errors are judged as in :mod:`tests.fuzz.flow`, with q and p relative to their largest component. Near states are
compared with an integration, far ones with the flow in 30 digits; the effect of the inputs' last places is found there
from changes below the resolution of floats.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib import import_module
from math import ldexp
from random import Random
from typing import Any

import numpy as np

from integrable.mumford.flow import Point
from jacobian import MP
from jacobian.errors import PrecisionLoss
from tests.fuzz.case import Case, Complaint, Undecided
from tests.fuzz.classical import Integrated, Motion, beside
from tests.fuzz.distributions import dot, general_moments, magnitude, momentum
from tests.fuzz.distributions import gamma as upward
from tests.fuzz.flow import worst_row
from tests.fuzz.integrated import EPS
from tests.fuzz.run import Suite

SECONDS = 3.0
# digits of the oracle of far states, and the size 2^−BITS of the changes of its inputs
DIGITS, BITS = 30, 46


def signed(rng: Random, low: int, high: int) -> float:
    return rng.choice((1, -1)) * magnitude(rng, low, high)


def axes(rng: Random, count: int, scale: float) -> tuple[float, ...]:
    """Different positive numbers: of one size, spread over decades, or some of them close."""
    spread = rng.choice((1, 1, 1, 3, 8))
    found = [scale * magnitude(rng, -spread, spread) for _ in range(count)]
    if count > 1 and rng.random() < 0.2:
        found[0] = found[1] * (1 + ldexp(1 + rng.random(), rng.randrange(-40, -3)))
    return tuple(found)


def direction(rng: Random, size: int) -> list[float]:
    """A unit vector, one in five with zeros."""
    found = [sum(rng.random() for _ in range(6)) - 3 for _ in range(size)]
    if rng.random() < 0.2:
        for i in rng.sample(range(size), rng.randrange(1, size) if size > 1 else 0):
            found[i] = 0.0
    length = dot(found, found) ** 0.5
    return direction(rng, size) if length < 1e-3 else [x / length for x in found]


def across(rng: Random, normal: list[float], speed: float) -> tuple[float, ...]:
    """A vector of about the length ``speed``, orthogonal to ``normal``."""
    v = direction(rng, len(normal))
    for _ in range(3):
        along = dot(normal, v) / dot(normal, normal)
        v = [y - along * x for x, y in zip(normal, v, strict=True)]
    return across(rng, normal, speed) if max(map(abs, v)) < 1e-3 else tuple(speed * y for y in v)


def neumann(rng: Random) -> Motion:
    scale, size = magnitude(rng, -20, 20), rng.choice((2, 3, 3, 3, 4, 5))
    a, q = axes(rng, size, scale), direction(rng, size)
    p = across(rng, q, scale**0.5 * magnitude(rng, -6, 6))
    return Motion("Neumann", "neumann", (a,), tuple(q), p, True, True)


def ellipsoid(rng: Random) -> Motion:
    scale, size = magnitude(rng, -20, 20), rng.choice((2, 3, 3, 3, 4, 5))
    a, u = axes(rng, size, scale), direction(rng, size)
    q = tuple(e**0.5 * x for e, x in zip(a, u, strict=True))
    p = across(rng, [x / e * scale**0.5 for e, x in zip(a, q, strict=True)], magnitude(rng, -10, 10))
    return Motion("Ellipsoid", "ellipsoid", (a,), q, p, True, True)


def garnier(rng: Random) -> Motion:
    scale, size = magnitude(rng, -10, 10), rng.choice((1, 2, 2, 2, 3, 4))
    a, alpha, beta = axes(rng, size, scale), signed(rng, -3, 4), scale * signed(rng, -4, 4)
    reach = scale**0.5 * magnitude(rng, -5, 3)
    q = tuple(reach * x for x in direction(rng, size))
    p = tuple(reach * scale**0.5 * magnitude(rng, -3, 3) * x for x in direction(rng, size))
    return Motion("Garnier", "garnier", (a, alpha, beta), q, p)


def henon_heiles(rng: Random) -> Motion:
    """Mostly bounded: small motions in wells."""
    size = rng.choice((1, 1, 1, 2, 3))
    a, alpha, beta, gamma = axes(rng, size, 1.0), -0.5, -magnitude(rng, -3, 3), 0.0
    if rng.random() < 0.3:
        alpha, gamma = signed(rng, -3, 3), signed(rng, -5, 2)
    reach = magnitude(rng, -8, 1)
    q, p = (tuple(reach * x for x in direction(rng, size + 1)) for _ in range(2))
    return Motion("HenonHeiles", "henon_heiles", (a, alpha, beta, gamma), q, p)


def lagrange(rng: Random) -> Motion:
    j, M = magnitude(rng, -3, 3), direction(rng, 3)
    p = tuple(magnitude(rng, -4, 5) * x for x in M) if rng.random() < 0.1 else tuple(4 * rng.random() * x for x in M)
    return Motion("LagrangeTop", "lagrange", (j,), upward(rng), p, True)


def pendulum(rng: Random) -> Motion:
    q = upward(rng)
    p = across(rng, list(q), rng.choice((magnitude(rng, -6, 5), 2 * rng.random())))
    return Motion("SphericalPendulum", "spherical_pendulum", (), q, p, True, True)


def toda(rng: Random) -> Motion:
    size, reach, push = rng.choice((2, 3, 3, 3, 4, 5, 6)), rng.choice((0.1, 1, 3)), magnitude(rng, -4, 3)
    q, p = (tuple(x * (2 * rng.random() - 1) for _ in range(size)) for x in (reach, push))
    return Motion("TodaLattice", "toda", (size,), q, p)


def veselova(rng: Random) -> Motion:
    inertia, q = general_moments(rng), upward(rng)
    M = momentum(rng, q, False)
    return Motion("Veselova", "veselova", (inertia,), q, M, True, True)


def galaxy(rng: Random) -> Motion:
    """Bound stars of flattened and of elongated galaxies."""
    scale, mass = magnitude(rng, -10, 10), magnitude(rng, -10, 10)
    a, c = axes(rng, 2, scale)
    q = tuple(max(a, c) * magnitude(rng, -6, 3) * x for x in direction(rng, 3))
    # P is at most this, so the speed is below that of escape
    inner = a * c + max(a, c) * dot(q, q) ** 0.5
    escape = (2 * mass) ** 0.5 / (dot(q, q) + a * a + c * c + 2 * inner) ** 0.25
    speed = escape * min(0.95, magnitude(rng, -4, 0))
    return Motion("KuzminKutuzov", "kuzmin_kutuzov", ((a, c), mass), q, tuple(speed * x for x in direction(rng, 3)))


SYSTEMS: dict[str, Callable[[Random], Motion]] = {
    "neumann": neumann,
    "ellipsoid": ellipsoid,
    "garnier": garnier,
    "henon heiles": henon_heiles,
    "galaxy": galaxy,
    "lagrange": lagrange,
    "pendulum": pendulum,
    "toda": toda,
    "veselova": veselova,
}


def times(rng: Random, motion: Motion, count: int, low: int, high: int) -> list[float]:
    return [signed(rng, low, high) / motion.speed for _ in range(count)]


def started(rng: Random, name: str) -> Motion:
    """A motion that is not at rest."""
    while True:
        motion = SYSTEMS[name](rng)
        if 0 < motion.speed < 1e12:
            return motion


def case_of(motion: Motion, wanted: list[float], shown: str, oracle: Any) -> Case:
    return Case(
        motion.setup,
        f"np.hstack([(run := flow.at({shown})).q, run.p])",
        lambda names: judged(names["got"], motion, oracle(motion), wanted),
        limit=SECONDS,
    )


def judged(got: Any, motion: Motion, oracle: Any, wanted: list[float]) -> Complaint | None:
    size = 2 * len(motion.q)
    if got.shape != (len(wanted), size):
        return Complaint(f"shape {got.shape}", f"({len(wanted)}, {size})", "got.shape == expected")
    truth = oracle.rows(wanted)
    worst = worst_row(beside(got - truth, truth), truth, lambda: oracle.floor(wanted))
    if worst is None:
        return None
    i, error, allowed = worst
    row = [float(x) for x in truth[i]]
    sizes = np.repeat([max(map(abs, row[: size // 2])), max(map(abs, row[size // 2 :]))], size // 2).tolist()
    return Complaint(
        f"off by {error:.1e}, allowed {allowed:.1e}, at t = {wanted[i]}",
        f"np.array({row})",
        f"(abs(got[{i}] - expected) <= {allowed:.1e} * np.array({sizes})).all()",
    )


def near(name: str, rng: Random) -> Case:
    motion = started(rng, name)
    wanted = times(rng, motion, 4, -10, 6)
    return case_of(motion, wanted, str(wanted), Integrated)


def many(name: str, rng: Random) -> Case:
    """Enough times for tables, a torus or one run over all of them."""
    motion = started(rng, name)
    first, last = sorted(times(rng, motion, 2, -3, 6))
    wanted = np.linspace(first, last, 120).tolist()
    return case_of(motion, wanted, f"np.linspace({first}, {last}, 120)", Integrated)


class Precise:
    """``rows`` and ``floor`` as in :class:`Integrated`, by the flow over MP(30)."""

    def __init__(self, motion: Motion) -> None:
        self.motion = motion

    def rows(self, wanted: list[float]) -> np.ndarray:
        return self._rows(wanted, lambda x: x)

    def floor(self, wanted: list[float]) -> np.ndarray:
        base, worst, wild = self.rows(wanted), np.zeros(len(wanted)), Random(0)
        for _ in range(2):
            moved = self._rows(wanted, lambda x: x * (1 + wild.choice((-1, 1)) * ldexp(1, -BITS)))
            worst = np.maximum(worst, beside(moved - base, base))
        return np.ldexp(worst, BITS - 52) + 4 * EPS

    def _rows(self, wanted: list[float], changed: Callable[[Any], Any]) -> np.ndarray:
        K, motion = MP(DIGITS), self.motion

        def inside(x: Any) -> Any:
            if isinstance(x, tuple):
                return tuple(map(inside, x))
            return changed(K.coerce(x)) if isinstance(x, float) else x

        system = getattr(import_module(f"integrable.classical.{motion.module}"), motion.name)
        made = system(*map(inside, motion.arguments), field=K)
        # constraints that doubles meet only to rounding
        state = made._constrained(K, Point(inside(motion.q), inside(motion.p)))
        try:
            found = made.flow(state).at(wanted)
        except PrecisionLoss as error:
            raise Undecided("refused in many digits, too") from error
        return np.array(np.hstack([found.q, found.p]), dtype=float)


def far(name: str, rng: Random) -> Case:
    motion = started(rng, name)
    wanted = times(rng, motion, 3, 8, 24)
    return case_of(motion, wanted, str(wanted), Precise)


KINDS = {
    f"{word} {name}".strip(): partial(make, name)
    for word, make in (("", near), ("many", many), ("far", far))
    for name in SYSTEMS
}
WARM = """
import numpy as np
from integrable.classical.neumann import Neumann
for size in (3, 4):
    system = Neumann(range(1, size + 1))
    flow = system.flow(system.state((0.6, 0.8, *(size - 2) * (0,)), (0.4, -0.3, *(size - 2) * (1,))))
    flow.at(1.0), flow.at(np.linspace(0, 100, 120))
"""
SUITE = Suite("systems", KINDS, dict.fromkeys(SYSTEMS, 3), {"": WARM})
