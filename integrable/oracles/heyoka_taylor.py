"""heyoka's Taylor integrator (Biscani and Izzo 2021), run as its users run it.

It is built once for a kind and a tolerance, with the system's constants as parameters ``par[i]``. A start sets the
state, the parameters and the time. heyoka compiles when the integrator is built, and caches on disk
(HEYOKA_CACHE_DIR). heyoka is optional, ``pip install 'jacobian-integrable[peers]'``, and is imported on first use.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from integrable.oracles.body import Solution
from integrable.oracles.expressions import Kind
from integrable.oracles.method import Built, Given, Method, Run, Started
from integrable.oracles.stepping import by_sign

__all__ = ["Heyoka", "equations"]


@dataclass(frozen=True)
class Heyoka(Method):
    """heyoka in doubles, or in long doubles if ``guard`` is not 0.

    Results are float64. Inputs of more than 15 digits are rounded to long doubles. A run raises RuntimeError where
    heyoka stops; ``evaluations`` counts steps.
    """

    def build(self, kind: Kind, setting: Any) -> Built:
        import heyoka

        number: Callable[[Any], Any] = _long_double if self.guard else float
        real: Any = np.longdouble if self.guard else float
        # compact_mode is off: code of this mode evaluates 1.3 to 2.4 times more slowly, and is built 1.3 to 1.8 times
        # faster (euler_top, neumann and garnier to T = 1 … 1000: python -m benchmarks heyoka)
        options = {"tol": number(setting), "fp_type": real, "time": number(0)}
        integrator = heyoka.taylor_adaptive(equations(kind), np.zeros(kind.size, real), **options)
        # the integrator, its arrays of state and parameters, and what heyoka returns for a run that reached its end
        shared = integrator, integrator.state, integrator.pars, heyoka.taylor_outcome.time_limit

        def of_system(given: Given) -> Started:
            coefficients = np.array(kind.coefficients_of(given.constants, number, np), real)
            # np.array converts to floats itself, but not to long doubles without loss
            exact = (lambda start: start) if number is float else (lambda start: [number(x) for x in start])
            return lambda start: _started(shared, coefficients, np.array(exact(start), real), number)

        return of_system


def equations(kind: Kind) -> list[tuple[Any, Any]]:
    """The pair (variable, rate) of every component, as heyoka expressions."""
    import heyoka

    variables = heyoka.make_vars(*(f"y{i}" for i in range(kind.size)))
    rates = kind.right_hand_side([heyoka.par[i] for i in range(len(kind.used))], heyoka)
    return list(zip(variables, rates(variables), strict=True))


def _started(shared: tuple[Any, ...], coefficients: np.ndarray, first: np.ndarray, number: Callable[[Any], Any]) -> Run:
    """A run from the start ``first``, by the integrator in ``shared``, which serves all systems of a kind."""
    integrator, state, parameters, done = shared
    zero = number(0)

    def propagated(times: Any) -> tuple[np.ndarray, int]:
        """States at one time, or at the times of a grid that begins at 0, and the number of steps."""
        integrator.time = zero
        state[:] = first
        parameters[:] = coefficients
        if len(times) == 1:
            outcome, *_, count, _, _ = integrator.propagate_until(times[0])
            values = state[np.newaxis].astype(float)
        else:
            outcome, *_, count, _, values = integrator.propagate_grid(times)
        if outcome != done:
            raise RuntimeError(f"heyoka stopped at t = {integrator.time}: {outcome}")
        return np.asarray(values, float), count

    return _of_any_times(propagated, first, number)


def _of_any_times(
    propagated: Callable[[Any], tuple[np.ndarray, int]], first: np.ndarray, number: Callable[[Any], Any]
) -> Run:
    """A run for times of any order and sign; ``propagated`` takes a single time or a grid that begins at 0."""
    half, zero = len(first) // 2, number(0)

    def reach(sign: int, distances: np.ndarray) -> tuple[np.ndarray, int]:
        grid, back = np.unique(distances, return_inverse=True)
        if len(grid) == 1:
            values, count = propagated(sign * grid)
            return values[back], count
        values, count = propagated(np.concatenate([[zero], sign * grid]))
        return values[1:][back], count

    def run(times: Iterable[Any]) -> Solution:
        # heyoka reads a list of floats faster than an array, so such a list is passed on as it is
        wanted: Any = [*times]
        if wanted and (number is not float or not isinstance(wanted[-1], float)):
            wanted = [number(t) for t in wanted]
        if number is float and (len(wanted) == 1 or (wanted and not wanted[0] and wanted == sorted(wanted))):
            try:
                values, count = propagated(wanted)
                return Solution(values[:, :half], values[:, half:], count)
            except (ValueError, TypeError):  # heyoka refuses repeated times and mixed types
                pass
        return by_sign(first, np.array(wanted, dtype=first.dtype), reach)

    return run


def _long_double(x: Any) -> Any:
    high = float(x)
    return np.longdouble(high) + np.longdouble(float(x - high))
