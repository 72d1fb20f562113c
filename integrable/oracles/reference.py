"""Independent oracles: the equations of motion integrated as ordinary differential equations.

    γ̇ = γ×ω,   Ṁ = M×ω,   ω = A M + d n A γ,   n = g²(γ, A M),   g⁻² = Σ I_k a_k γ_k²   (at |γ| = 1)

with A = diag 1/(I_k + d). Nothing of :mod:`jacobian` is used here, so agreement with the divisor flow is agreement of
two unrelated computations. :func:`dop853` is the integrator that most users of SciPy would choose. :func:`integrated`
runs any of SciPy's integrators on any equations. :func:`taylor` is a Taylor-series integrator of any number of digits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial, reduce
from typing import Any

import numpy as np

from integrable.extras import needed
from integrable.oracles.body import Body, Solution, Start, body_equations, is_body
from integrable.oracles.method import problem_of
from integrable.oracles.stepping import by_sign
from jacobian.errors import ArgumentError

__all__ = [
    "Body",
    "Solution",
    "Start",
    "body_equations",
    "dop853",
    "equations",
    "integrated",
    "is_body",
    "odefun",
    "right_hand_side",
    "taylor",
]


def equations(system: Any, state: Any) -> Callable[[Sequence[Any]], list[Any]]:
    """The function y ↦ ẏ of any system of this package, in the system's number type; y is as long as ``state``."""
    kind, given, _ = problem_of(system, state)
    return kind.right_hand_side(kind.coefficients_of(given.constants, given.number, given.context), given.context)


def right_hand_side(inertia: Sequence[float], d: float) -> Callable[[float, Any], list[float]]:
    """The ball's six equations as ``f(t, y)`` for SciPy, in plain floats."""
    rates = body_equations([float(moment) for moment in inertia], float(d))
    return lambda _time, y: rates(y.tolist())


def dop853(body: Any, state: Any, times: Iterable[float], *, rtol: float, atol: float) -> Solution:
    """The motion in double precision by SciPy's DOP853 (Hairer, Nørsett & Wanner 1993), started at time 0.

    Times may be in any order and of either sign. ``rtol`` and ``atol`` are passed to SciPy unchanged. Raises
    RuntimeError with SciPy's message if the integrator fails.
    """
    kind, given, start = problem_of(body, state)
    rates = kind.right_hand_side(kind.coefficients_of(given.constants))
    first = [float(x) for x in start]
    return integrated(lambda _, y: rates(y.tolist()), first, times, method="DOP853", rtol=rtol, atol=atol)


def integrated(
    rates: Callable[[float, Any], Any], start: Sequence[float], times: Iterable[float], *, method: str, rtol: float,
    atol: Any,
) -> Solution:  # fmt: skip
    """The solution of ẏ = ``rates``(t, y) from ``start`` at time 0, by a ``method`` of SciPy's ``solve_ivp``.

    ``atol`` may hold one number per component. Times and exceptions are as for :func:`dop853`.
    """
    needed("scipy", f"SciPy's {method}")
    from scipy.integrate import solve_ivp

    def reach(sign: int, distances: np.ndarray) -> tuple[np.ndarray, int]:
        knots, back = np.unique(distances, return_inverse=True)
        span = (0.0, sign * knots[-1])
        solution = solve_ivp(rates, span, start, method=method, t_eval=sign * knots, rtol=rtol, atol=atol)
        if not solution.success:
            raise RuntimeError(
                f"{method} stopped at t = {solution.t[-1] if len(solution.t) else 0.0}: {solution.message}"
            )
        return solution.y.T[back], int(solution.nfev)

    return by_sign(np.array(start), np.array([float(time) for time in times]), reach)


def taylor(body: Body, state: Start, times: Iterable[Any], *, digits: int) -> Solution:
    """The motion by Taylor series in multiprecision, started at time 0: arrays of mpf, dtype object.

    The order follows from ``digits`` and each step from the size of the last two coefficients (Jorba & Zou
    2005), so that a step neglects about 10^-(digits+5). Over short times the error is about 10^-digits.
    ``body`` and ``state`` may hold mpf, decimal strings, fractions or floats; floats are taken as exact.
    Work grows as (number of steps) · digits². A step is about a fifth of the distance to the nearest singularity
    in complex time. Times may be in any order and of either sign.
    """
    context = _context(digits, 12)
    series = _Series(context, [_number(context, x) for x in body.inertia], _number(context, body.d), digits)
    return _solved(context, state, times, series.reach)


def odefun(body: Body, state: Start, times: Iterable[Any], *, digits: int) -> Solution:
    """The motion by :func:`mpmath.odefun` at ``digits`` digits, as a user of mpmath would run it: arrays of mpf.

    ``evaluations`` counts evaluations of the right-hand side. Because ``odefun`` differentiates numerically, it
    evaluates the right-hand side with several times as many digits.
    """
    context = _context(digits, 0)
    rates = body_equations([_number(context, x) for x in body.inertia], _number(context, body.d))

    def reach(start: list[Any], sign: int, distances: np.ndarray) -> tuple[list[Any], int]:
        evaluations = 0

        def reversible(_time: Any, y: Any) -> list[Any]:
            nonlocal evaluations
            evaluations += 1
            # odefun only integrates forwards: for negative times the equations are reversed
            return [sign * x for x in rates(y)]

        solution = context.odefun(reversible, context.zero, start)
        return [list(solution(distance)) for distance in distances], evaluations

    return _solved(context, state, times, reach)


def _context(digits: int, guard: int) -> Any:
    if digits < 1:
        raise ArgumentError(f"digits: {digits} given; a positive number of decimal digits is needed")
    import mpmath

    context = mpmath.MPContext()
    context.dps = digits + guard
    return context


def _solved(context: Any, state: Start, times: Iterable[Any], reach: Callable[..., tuple[Any, int]]) -> Solution:
    """γ and M at ``times``, in mpf. ``reach`` is called as :meth:`_Series.reach` is."""
    start = [_number(context, x) for x in (*state.gamma, *state.M)]
    wanted = np.array([_number(context, time) for time in times], dtype=object)
    return by_sign(np.array(start, dtype=object), wanted, partial(reach, start))


def _number(context: Any, value: Any) -> Any:
    """``value`` as an mpf of ``context``. It may be a string (also "1/3"), a fraction or another context's mpf."""
    if isinstance(value, str) and "/" in value:
        above, below = value.split("/")
        return context.mpf(above) / context.mpf(below)
    if hasattr(value, "numerator") and not isinstance(value, int):
        return context.mpf(int(value.numerator)) / context.mpf(int(value.denominator))
    return context.mpf(value)


class _Series:
    """Taylor series of the motion at a state, and the steps taken with them."""

    def __init__(self, context: Any, inertia: list[Any], d: Any, digits: int) -> None:
        self.context, self.d = context, d
        self.a = [1 / (moment + d) for moment in inertia]
        self.q = [moment * a for moment, a in zip(inertia, self.a, strict=True)]
        self.tolerance = context.mpf(10) ** -(digits + 5)
        self.order = int(1.16 * (digits + 5)) + 4  # ½ ln(1/tolerance), Jorba & Zou's optimal order

    def reach(self, y: list[Any], sign: int, distances: np.ndarray) -> tuple[list[Any], int]:
        """The states at ascending ``distances`` from time 0, where the state is ``y``, towards times of this ``sign``;
        and the number of expansions.
        """
        now, rows, expansions, count = self.context.zero, list[Any](), 0, len(distances)
        while len(rows) < count:
            series = self.expand(y)
            expansions += 1
            step = self.step(series)
            while len(rows) < count and distances[len(rows)] <= now + step:
                rows.append(self.evaluate(series, sign * (distances[len(rows)] - now)))
            if len(rows) < count:
                y = self.evaluate(series, sign * step)
                now += step
        return rows, expansions

    def expand(self, y: list[Any]) -> list[list[Any]]:
        """Taylor coefficients of the six components at y, orders 0 to ``self.order``."""
        dot, a, d = self.context.fdot, self.a, self.d
        x, m = [[value] for value in y[:3]], [[value] for value in y[3:]]
        w: list[list[Any]] = [[], [], []]
        above: list[Any] = []  # (γ, AM)
        below: list[Any] = []  # g⁻² = Σ I a γ²
        ratio: list[Any] = []  # n = (γ, AM)/g⁻²
        for k in range(self.order):
            rx = [c[::-1] for c in x]
            above.append(sum(a[i] * dot(m[i], rx[i]) for i in range(3)))
            below.append(sum(self.q[i] * dot(x[i], rx[i]) for i in range(3)))
            ratio.append((above[k] - (dot(ratio, below[:0:-1]) if k else 0)) / below[0])
            for i in range(3):
                w[i].append(a[i] * (m[i][k] + d * dot(ratio, rx[i])))
            rw = [c[::-1] for c in w]
            for vector in (x, m):
                rate = [
                    dot(vector[i - 2], rw[i - 1]) - dot(vector[i - 1], rw[i - 2]) for i in range(3)
                ]  # (i−2, i−1) is the cyclic pair (j, k) that follows i
                for i in range(3):
                    vector[i].append(rate[i] / (k + 1))
        return x + m

    def step(self, series: list[list[Any]]) -> Any:
        """The step at which the last terms fall below the tolerance, relative to γ and to M."""
        bounds = []
        for vector in (series[:3], series[3:]):
            scale = max(abs(c[0]) for c in vector)
            for k in (self.order - 1, self.order):
                size = max(abs(c[k]) for c in vector)
                if size:
                    bounds.append((self.tolerance * scale / size) ** (self.context.one / k))
        return min(bounds, default=self.context.inf)

    def evaluate(self, series: list[list[Any]], time: Any) -> list[Any]:
        """The six components a ``time`` after the centre of the expansion."""
        return [reduce(lambda value, c: value * time + c, reversed(component)) for component in series]
