"""heyoka's Taylor integrator (Biscani and Izzo 2021) as its users run it: built once for a kind and a tolerance, the
constants being its parameters ``par[i]``; a start sets state, parameters and time.

heyoka compiles when the integrator is built, and caches on disk (HEYOKA_CACHE_DIR). It is an optional dependency, ``pip
install 'jacobian-integrable[peers]'``, imported on first use.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from integrable.oracles.body import Solution
from integrable.oracles.expressions import Kind, evaluated
from integrable.oracles.method import Built, Given, Method, Run, Started
from integrable.oracles.stepping import by_sign

__all__ = ["Heyoka", "equations"]


@dataclass(frozen=True)
class Heyoka(Method):
    """In doubles, or ``extended`` to long doubles. Results come as float64; inputs of more than 15 digits are rounded
    to long doubles. A run raises RuntimeError where heyoka stops; ``evaluations`` counts steps.
    """

    def build(self, kind: Kind, setting: Any) -> Built:
        import heyoka

        number: Callable[[Any], Any] = _long_double if self.guard else float
        real: Any = np.longdouble if self.guard else float
        system = equations(kind, number)
        options = {"tol": number(setting), "fp_type": real, "time": number(0)}
        integrator = heyoka.taylor_adaptive(system, np.zeros(kind.size, real), **options)

        def of_system(given: Given) -> Started:
            coefficients = kind.coefficients_of(given.constants, number)
            return lambda start: _started(integrator, coefficients, [number(x) for x in start], number)

        return of_system


def equations(kind: Kind, number: Callable[[Any], Any] = float) -> list[tuple[Any, Any]]:
    """(variable, rate) for every component, in heyoka's expressions."""
    import heyoka

    variables = heyoka.make_vars(*(f"y{i}" for i in range(kind.size)))
    parameters = [heyoka.par[i] for i in range(len(kind.used))]
    constant = lambda x: heyoka.expression(number(x))  # noqa: E731
    values = evaluated(kind.rates, variables, parameters, constant, heyoka)
    return [(x, values[i]) for x, i in zip(variables, kind.results, strict=True)]


def _started(integrator: Any, coefficients: Sequence[Any], start: Sequence[Any], number: Callable[[Any], Any]) -> Run:
    """A start of a shared integrator."""
    import heyoka

    first = np.array(start, dtype=integrator.state.dtype)

    def propagated(grid: np.ndarray) -> tuple[np.ndarray, int]:
        """States at times of one sign in their order, from 0 on."""
        integrator.time = number(0)
        integrator.state[:] = first
        integrator.pars[:] = coefficients
        if len(grid) == 2:
            outcome, *_, count, _, _ = integrator.propagate_until(grid[1])
            values = np.array([first, integrator.state])
        else:
            outcome, *_, count, _, values = integrator.propagate_grid(grid)
        if outcome != heyoka.taylor_outcome.time_limit:
            raise RuntimeError(f"heyoka stopped at t = {integrator.time}: {outcome}")
        return values, int(count)

    def reach(sign: float, distances: np.ndarray) -> tuple[np.ndarray, int]:
        grid, back = np.unique(distances, return_inverse=True)
        values, count = propagated(np.concatenate([[number(0)], sign * grid]))
        return values[1:][back], count

    half = len(first) // 2

    def run(times: Iterable[Any]) -> Solution:
        wanted = np.array([*times], dtype=float) if number is float else np.array([number(t) for t in times])
        if len(wanted) > 1 and wanted[0] == 0 and (wanted[1:] > wanted[:-1]).all():  # what heyoka itself takes
            values, count = propagated(wanted)
            return Solution(values[:, :half].astype(float), values[:, half:].astype(float), count)
        return by_sign(first, wanted, reach)

    return run


def _long_double(x: Any) -> Any:
    """A float or a number of more digits as a long double."""
    high = float(x)
    return np.longdouble(high) + np.longdouble(float(x - high))
