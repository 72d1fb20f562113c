"""heyoka's Taylor integrator (Biscani and Izzo 2021) in double or extended precision, on balls and tops and on
systems that give their equations in any numbers, here heyoka's expressions.

heyoka compiles the equations when the integrator is built: that belongs to the set-up. It is an optional dependency,
``pip install 'jacobian-integrable[peers]'``, imported on first use.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from integrable.oracles.reference import Solution, body_equations, is_body
from integrable.oracles.stepping import by_sign

__all__ = ["heyoka_run"]


def heyoka_run(
    system: Any, state: Any, tolerance: float, *, extended: bool = False
) -> Callable[[Iterable[Any]], Solution]:
    """times ↦ Solution by an integrator built here; ``extended``: in long double. ``evaluations`` counts steps.

    Extended results come as float64 too, γ and M rounded at the end; inputs of more than 15 digits are taken to all
    that a long double holds. The run raises RuntimeError where heyoka stops.
    """
    import heyoka

    number: Any = _long_double if extended else float
    kind: Any = np.longdouble if extended else float
    start = np.array([number(x) for x in (*state.gamma, *state.M)], dtype=kind)
    variables = heyoka.make_vars(*(f"y{i}" for i in range(len(start))))
    if is_body(system):
        rates = body_equations([number(x) for x in system.inertia], number(system.d))(variables)
    else:
        rates = system.rates_in(_Expressions(heyoka, number), variables)
    integrator = heyoka.taylor_adaptive(
        list(zip(variables, rates, strict=True)), start, tol=number(tolerance), fp_type=kind, time=number(0)
    )

    def reach(sign: float, distances: np.ndarray) -> tuple[np.ndarray, int]:
        grid, back = np.unique(distances, return_inverse=True)
        integrator.time = number(0)
        integrator.state[:] = start
        outcome, *_, count, _, values = integrator.propagate_grid(np.concatenate([[number(0)], sign * grid]))
        if outcome != heyoka.taylor_outcome.time_limit:
            raise RuntimeError(f"heyoka stopped at t = {integrator.time}: {outcome}")
        return values[1:][back], int(count)

    return lambda times: by_sign(start, np.array([number(t) for t in times], dtype=kind), reach)


class _Expressions:
    """heyoka's expressions as the numbers of a system's formulas."""

    exact = False

    def __init__(self, heyoka: Any, number: Callable[[Any], Any]) -> None:
        self.context, self._number = heyoka, number
        self.zero, self.one = number(0), number(1)

    def coerce(self, x: Any) -> Any:
        """A number as a constant, an expression as it is."""
        return x if isinstance(x, self.context.expression) else self._number(x)

    def sub(self, x: Any, y: Any) -> Any:
        """x − y."""
        return x - y

    def mul(self, x: Any, y: Any) -> Any:
        """x·y."""
        return x * y

    def dot(self, xs: Iterable[Any], ys: Iterable[Any]) -> Any:
        """Σ x_i y_i."""
        return sum((x * y for x, y in zip(xs, ys, strict=True)), self.zero)


def _long_double(x: Any) -> Any:
    """A float or a number of more digits as a long double."""
    high = float(x)
    return np.longdouble(high) + np.longdouble(float(x - high))
