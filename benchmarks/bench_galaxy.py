"""200 random orbits in the galaxy of Kuzmin and Kutuzov, compared with galpy's integrations where galpy is installed.

Each orbit is bound, has 101 times up to T, and starts from a new system. Errors are the largest errors of the last
position, relative to its largest component, against 30 digits, over the first ten orbits. Times are medians of
processor times.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from importlib.util import find_spec
from random import Random
from statistics import median
from typing import Any

import numpy as np

from integrable.classical.kuzmin_kutuzov import KuzminKutuzov
from jacobian import MP

AXES, CHECKED = (1.5, 1.0), 10


def run(smoke: bool) -> list[dict[str, object]]:
    """A row for each length of a run."""
    stars = [_star(Random(n)) for n in range(2 if smoke else 200)]
    return [_row(stars, length) for length in ((10.0,) if smoke else (10.0, 100.0, 1000.0, 1e6))]


def _star(rng: Random) -> tuple[float, ...]:
    """A random star: R, R', Rφ', z, z' and φ, in the order of galpy."""
    R, z, azimuth = rng.uniform(0.5, 2), rng.uniform(-0.5, 0.5), rng.uniform(0, 6)
    return R, rng.uniform(-0.3, 0.3), rng.uniform(0.2, 0.5), z, rng.uniform(-0.3, 0.3), azimuth


def _row(stars: list[tuple[float, ...]], length: float) -> dict[str, object]:
    times = np.linspace(0, length, 101)
    row: dict[str, object] = {"T": length, "orbits": len(stars)}
    # up to T = 10⁶ an integration takes galpy minutes
    for name, method in (("flow", _by_flow), ("galpy dop853", _by_galpy)):
        usable = name == "flow" or (find_spec("galpy") is not None and length <= 1000)
        row[f"{name}, ms"], row[f"{name}, error"] = _measured(method, stars, times) if usable else ("–", "–")
    return row


def _measured(method: Callable[..., np.ndarray], stars: list[tuple[float, ...]], times: np.ndarray) -> tuple[Any, Any]:
    taken, errors = [], []
    for n, star in enumerate(stars):
        start = time.process_time()
        found = method(star, times)
        taken.append(1e3 * (time.process_time() - start))
        if n < CHECKED:
            system = KuzminKutuzov(AXES, field=MP(30))
            true = system.flow(system.state(*_cartesian(star))).at([times[-1]]).q[0].astype(float)
            errors.append(float(np.abs(found[-1] - true).max() / np.abs(true).max()))
    return median(taken), max(errors)


def _cartesian(star: tuple[float, ...]) -> tuple[Any, Any]:
    R, out, about, z, up, azimuth = star
    x, y = np.cos(azimuth), np.sin(azimuth)
    return tuple(map(float, (R * x, R * y, z))), tuple(map(float, (out * x - about * y, out * y + about * x, up)))


def _by_flow(star: tuple[float, ...], times: np.ndarray) -> np.ndarray:
    system = KuzminKutuzov(AXES)
    found: np.ndarray = system.flow(system.state(*_cartesian(star))).at(times).q
    return found


def _by_galpy(star: tuple[float, ...], times: np.ndarray) -> np.ndarray:
    a, c = AXES
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from galpy.orbit import Orbit
        from galpy.potential import KuzminKutuzovStaeckelPotential

        potential = KuzminKutuzovStaeckelPotential(amp=1.0, ac=a / c, Delta=(a * a - c * c) ** 0.5)
        orbit = Orbit(list(star))
        orbit.integrate(times, potential, method="dop853")
        return np.stack([orbit.x(times), orbit.y(times), orbit.z(times)], axis=1)
