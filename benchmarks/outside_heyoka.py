"""heyoka as its own users run it, to compare with the report's times: ``python benchmarks/outside_heyoka.py``.

Nothing of ``integrable`` is imported. The equations of the scenes ``euler_top`` and ``neumann`` are written by hand,
with constants as parameters, and each integrator is built once. A start sets state, parameters and time; then states at
101 times up to T are computed. The script prints the median time of a start with its states, in
microseconds, and the last state's first component.
``python -m benchmarks heyoka`` puts the comparator's times beside these.
"""

from __future__ import annotations

from statistics import median
from time import perf_counter
from typing import Any

import heyoka as hy
import numpy as np

HORIZONS = (1, 10, 100, 1000)
OUTPUTS = 101
TOLERANCE = 1e-15
RUNS, SECONDS = 1000, 1.0
Case = tuple[Any, list[float], list[float]]
"""An integrator, its parameters, a start."""


def built(names: str, rates: Any) -> Any:
    """The integrator of variables with these names; ``rates`` makes the equations."""
    variables = hy.make_vars(*names.split())
    system = [*zip(variables, rates(*variables), strict=True)]
    return hy.taylor_adaptive(system, np.zeros(len(variables)), tol=TOLERANCE)


def euler_top() -> Case:
    """γ' = γ × ω and M' = M × ω with ω = M/I, I = (1, 2, 3)."""

    def rates(x: Any, y: Any, z: Any, k: Any, m: Any, n: Any) -> list[Any]:
        p, q, r = hy.par[0] * k, hy.par[1] * m, hy.par[2] * n
        return [y * r - z * q, z * p - x * r, x * q - y * p, m * r - n * q, n * p - k * r, k * q - m * p]

    return built("x y z k m n", rates), [1.0, 1 / 2, 1 / 3], [0.48, 0.6, 0.64, 0.384, 1.28, -1.488]


def neumann() -> Case:
    """q' = p and p' = −a q + (q·aq − p·p) q, |q| = 1, a = (1, 2, 4)."""

    def rates(x: Any, y: Any, z: Any, u: Any, v: Any, w: Any) -> list[Any]:
        a, b, c = hy.par[0], hy.par[1], hy.par[2]
        pull = a * x * x + b * y * y + c * z * z - u * u - v * v - w * w
        return [u, v, w, pull * x - a * x, pull * y - b * y, pull * z - c * z]

    return built("x y z u v w", rates), [1.0, 2.0, 4.0], [1 / 3, 2 / 3, 2 / 3, 0.5, 1.25, -1.5]


CASES = {"euler_top": euler_top, "neumann": neumann}


def once(case: Case, times: list[float]) -> tuple[float, float]:
    """Seconds of a start and its evaluation at ``times``, and the first component at the last of them."""
    integrator, parameters, start = case
    begun = perf_counter()
    integrator.time = 0.0
    integrator.state[:] = start
    integrator.pars[:] = parameters
    found = integrator.propagate_grid(times)[-1]
    return perf_counter() - begun, float(found[-1, 0])


def grid(T: int) -> list[float]:
    """101 equally spaced times from 0 to T: a list, as in scenes and most users' code."""
    return [T * k / (OUTPUTS - 1) for k in range(OUTPUTS)]


def main() -> None:
    """Prints a row for each system and T."""
    print("system     T      µs     x(T)")
    for name, made in CASES.items():
        case = made()
        for T in HORIZONS:
            times, found, begun = grid(T), [once(case, grid(T))], perf_counter()
            while len(found) < RUNS and perf_counter() - begun < SECONDS:
                found.append(once(case, times))
            print(f"{name:10} {T:<6d} {1e6 * median(seconds for seconds, _ in found[1:]):<6.1f} {found[0][1]:.15f}")


if __name__ == "__main__":
    main()
