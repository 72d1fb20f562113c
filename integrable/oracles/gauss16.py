"""Gauss–Legendre of order 16 for balls and tops, compiled, with the round-off measures of Hairer, McLachlan and
Razakarivony (2008): the ordinary integrator with the smallest error on long runs in double precision.

Eight stages, solved by fixed-point iteration until it no longer improves; the weights h·b_i are pairs of floats, so
that the step has no systematic error of its size; γ and M are pairs of floats too (compensated sums). The matrix is
used as μ_ij = a_ij/b_j with μ_ij + μ_ji = 1 exactly, which makes the rounded method keep quadratic integrals (Antoñana,
Makazaga and Murua 2017). Iterations start from the polynomial of the step before. The step is fixed, or adapted to a
tolerance by the last Legendre coefficient of the stages.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable

from integrable.oracles.collocation import gauss_rule
from integrable.oracles.compiled_equations import (
    COMPILED,
    INLINED,
    ball_constants,
    slopes,
    two_product,
    two_sum,
    whole_steps,
)
from integrable.oracles.reference import Solution
from integrable.oracles.stepping import by_sign
from jacobian.errors import PrecisionLoss
from jacobian.numbers.compiler import njit

__all__ = ["gauss16"]

STAGES = 8
MOST_ITERATIONS = 60
FAILED = -1


class _Rule(NamedTuple):
    nodes: np.ndarray
    weights: np.ndarray
    """b_i, shape (8,), and what rounding took from them in ``weights_low``."""
    weights_low: np.ndarray
    ratios: np.ndarray
    """μ_ij, shape (8, 8)."""
    last: np.ndarray
    """The functional that takes the coefficient of the shifted Legendre polynomial P_7 of the stages."""
    inverse: np.ndarray
    """1/Π_{k≠j}(c_j − c_k), for Lagrange's formula."""


@cache
def _rule() -> _Rule:
    rule = gauss_rule(STAGES, 40)
    weights = np.array(rule.weights, dtype=float)
    low = np.array([float(b - float(b)) for b in rule.weights])
    ratios = np.full((STAGES, STAGES), 0.5)
    for i in range(STAGES):
        for j in range(i):
            # below ½ or of either sign: the larger of the two is the rounded one, the other is 1 minus it, exactly
            value = float(rule.matrix[i][j] / rule.weights[j])
            ratios[j, i] = 1 - value
            ratios[i, j] = 1 - ratios[j, i]
    legendre = np.polynomial.legendre.Legendre.basis(STAGES - 1)
    nodes = np.array(rule.nodes, dtype=float)
    last = (2 * STAGES - 1) * weights * legendre(2 * nodes - 1)
    inverse = np.array([float(1 / _product(c - x for x in rule.nodes if x != c)) for c in rule.nodes])
    return _Rule(nodes, weights, low, ratios, last, inverse)


def _product(values: Iterable[Any]) -> Any:
    total = 1
    for value in values:
        total = total * value
    return total


def gauss16(system: Any, state: Any, times: Iterable[float], *, step: float = 0.0, tolerance: float = 0.0) -> Solution:
    """γ and M at ``times`` (any order and sign) with a fixed ``step``, or with steps chosen for a ``tolerance``.

    A time between steps is reached by a shorter step that is not gone on from. PrecisionLoss where the stages do not
    converge.
    """
    wanted = np.array([float(t) for t in times])
    constants, rule = ball_constants(system), _rule()
    start = np.array([float(x) for x in (*state.gamma, *state.M)])
    done = _adaptive if tolerance else _fixed

    def reach(sign: float, distances: np.ndarray) -> tuple[np.ndarray, int]:
        out = np.empty((len(distances), 6))
        cost = done(constants, rule, start, distances, sign, tolerance or step, out)
        if cost == FAILED:
            setting = f"tolerance = {tolerance}" if tolerance else f"step = {step}"
            raise PrecisionLoss(f"{setting}: the stages of the implicit step have not converged; take a smaller one")
        return out, int(cost)

    return by_sign(start, wanted, reach)


@register_jitable(**INLINED)
def _weigh(weights, weights_low, h, high, low):  # type: ignore[no-untyped-def]
    """h·b_i as high + low."""
    for i in range(STAGES):
        high[i], error = two_product(h, weights[i])
        low[i] = error + h * weights_low[i]


@register_jitable(**INLINED)
def _predict(nodes, inverse, ratio, k, guess):  # type: ignore[no-untyped-def]
    """Slopes at the stages of a step ``ratio`` times as long as the last, whose polynomial goes through ``k``; ``k``
    itself where there was no last step, ratio 0.
    """
    if ratio == 0:
        guess[:, :] = k
        return
    for i in range(STAGES):
        x = 1 + ratio * nodes[i]
        whole = 1.0
        for j in range(STAGES):
            whole *= x - nodes[j]
        for n in range(6):
            guess[n, i] = 0.0
        for j in range(STAGES):
            factor = whole / (x - nodes[j]) * inverse[j]
            for n in range(6):
                guess[n, i] += factor * k[n, j]


@register_jitable(fastmath={"contract"}, **INLINED)
def _sums(ratios, terms, base, z):  # type: ignore[no-untyped-def]
    """Z_i = base_i + Σ_j μ_ij L_j; ``ratios`` is transposed, so that the inner loop is over neighbours."""
    for n in range(6):
        for i in range(STAGES):
            z[n, i] = base[n, i]
        for j in range(STAGES):
            factor = terms[n, j]
            for i in range(STAGES):
                z[n, i] += ratios[j, i] * factor


@register_jitable(**INLINED)
def _low_part(transposed, low, k, rest, work):  # type: ignore[no-untyped-def]
    """Into the last of ``work`` what the low parts of the weights add to the stages: without it the stages and their
    sum would use different weights, and the quadratic integrals would drift steadily.
    """
    terms, points, base = work[1], work[2], work[3]
    for n in range(6):
        for i in range(STAGES):
            points[n, i] = rest[n]
            terms[n, i] = low[i] * k[n, i]
    _sums(transposed, terms, points, base)


@register_jitable(**INLINED)
def _add(terms, low, k, y, rest):  # type: ignore[no-untyped-def]
    """The sum of the terms, and what the low weights add to it, to the compensated state (y, rest), in place."""
    for n in range(6):
        total, error = two_sum(rest[n], terms[n, 0])
        error += low[0] * k[n, 0]
        for i in range(1, STAGES):
            total, part = two_sum(total, terms[n, i])
            error += part + low[i] * k[n, i]
        y[n], part = two_sum(y[n], total)
        rest[n] = part + error


@register_jitable(**INLINED)
def _step(constants, transposed, high, low, y, rest, k, work):  # type: ignore[no-untyped-def]
    """One step of the compensated state (y, rest), in place; ``k`` holds guesses of the slopes and then the slopes.

    Returns the number of iterations, or FAILED.
    """
    z, terms, points, base = work[0], work[1], work[2], work[3]
    smallest, stalls = np.inf, 0
    _low_part(transposed, low, k, rest, work)
    for n in range(6):
        for i in range(STAGES):
            terms[n, i] = high[i] * k[n, i]
    _sums(transposed, terms, base, z)
    for iteration in range(MOST_ITERATIONS):
        for n in range(6):
            for i in range(STAGES):
                points[n, i] = y[n] + z[n, i]
        slopes(constants, points, k)
        for n in range(6):
            for i in range(STAGES):
                terms[n, i] = high[i] * k[n, i]
                points[n, i] = z[n, i]
        _sums(transposed, terms, base, z)
        change, size = 0.0, 0.0
        for n in range(6):
            for i in range(STAGES):
                change = max(change, abs(z[n, i] - points[n, i]))
                size = max(size, abs(z[n, i]))
        # on the way to the solution the change may rise for once; at the level of rounding it goes up and down
        stalls += change >= smallest
        smallest = min(smallest, change)
        if change == 0 or (change < 1e-14 * size and stalls > 0) or (change < 1e-9 * size and stalls > 3):
            break
        if not change < 1e100 or iteration == MOST_ITERATIONS - 1:
            return FAILED
    _add(terms, low, k, y, rest)
    return iteration + 1


@register_jitable(**INLINED)
def _begun(constants, ratios, start):  # type: ignore[no-untyped-def]
    """The ratios as :func:`_sums` takes them, room, the slopes at the start for every stage, room for two more sets of
    slopes, and the compensated state.
    """
    work, k = np.empty((4, 6, STAGES)), np.empty((6, STAGES))
    points = work[2]
    for n in range(6):
        for i in range(STAGES):
            points[n, i] = start[n]
    slopes(constants, points, k)
    return np.ascontiguousarray(ratios.T), work, k, np.empty_like(k), np.empty_like(k), start.copy(), np.zeros(6)


@njit(**COMPILED)
def _fixed(constants, rule, start, times, sign, step, out):  # type: ignore[no-untyped-def]
    """Whole steps, and one shorter step for each time; the number of right-hand sides, or FAILED."""
    nodes, weights, weights_low, ratios, _, inverse = rule
    transposed, work, k, guess, part_k, y, rest = _begun(constants, ratios, start)
    high, low, part_high, part_low = np.empty(STAGES), np.empty(STAGES), np.empty(STAGES), np.empty(STAGES)
    _weigh(weights, weights_low, sign * step, high, low)
    done, cost = 0.0, 0
    for t in range(len(times)):
        count, remainder = whole_steps(times[t], step)
        while done < count:
            if done > 0:
                _predict(nodes, inverse, 1.0, k, guess)
                k[:, :] = guess
            passes = _step(constants, transposed, high, low, y, rest, k, work)
            if passes == FAILED:
                return FAILED
            cost += passes * STAGES
            done += 1
        out[t] = y
        if remainder > 0:
            part, part_rest = y.copy(), rest.copy()
            _weigh(weights, weights_low, sign * remainder, part_high, part_low)
            _predict(nodes, inverse, remainder / step if done > 0 else 0.0, k, part_k)
            passes = _step(constants, transposed, part_high, part_low, part, part_rest, part_k, work)
            if passes == FAILED:
                return FAILED
            cost += passes * STAGES
            out[t] = part
    return cost


@register_jitable(**INLINED)
def _tail(last, k, h, y):  # type: ignore[no-untyped-def]
    """(h·|last Legendre coefficient|)², relative to γ and to M: of the size of the error of the step, h^16."""
    found = 0.0
    for base in (0, 3):
        size, tail = 0.0, 0.0
        for n in range(base, base + 3):
            coefficient = 0.0
            for i in range(STAGES):
                coefficient += last[i] * k[n, i]
            tail += coefficient * coefficient
            size += y[n] * y[n]
        if size > 0:
            found = max(found, h * h * tail / size)
    return found


@register_jitable(**INLINED)
def _speed(y, k):  # type: ignore[no-untyped-def]
    """The larger of |γ̇|/|γ| and |Ṁ|/|M|, the slopes being those of the first stage."""
    speed = 0.0
    for base in (0, 3):
        size, rate = 0.0, 0.0
        for n in range(base, base + 3):
            size += y[n] * y[n]
            rate += k[n, 0] * k[n, 0]
        if size > 0:
            speed = max(speed, np.sqrt(rate / size))
    return speed


@njit(**COMPILED)
def _adaptive(constants, rule, start, times, sign, tolerance, out):  # type: ignore[no-untyped-def]
    """As :func:`_fixed`, each step as long as :func:`_tail` allows."""
    nodes, weights, weights_low, ratios, last, inverse = rule
    transposed, work, k, guess, part_k, y, rest = _begun(constants, ratios, start)
    high, low = np.empty(STAGES), np.empty(STAGES)
    out[:, :] = y
    speed = _speed(y, k)
    if speed == 0:
        return 0
    step, length = 0.5 / speed, 0.0
    now, now_low, cost, t = 0.0, 0.0, 0, 0
    while t < len(times):
        next_y, next_rest = y.copy(), rest.copy()
        _predict(nodes, inverse, step / length if length > 0 else 0.0, k, part_k)
        _weigh(weights, weights_low, sign * step, high, low)
        passes = _step(constants, transposed, high, low, next_y, next_rest, part_k, work)
        cost += (MOST_ITERATIONS if passes == FAILED else passes) * STAGES
        error = np.inf if passes == FAILED else _tail(last, part_k, step, y)
        if error > 8 * tolerance:
            step *= 0.5 if passes == FAILED else max(0.2, 0.9 * (tolerance / error) ** 0.0625)
            if step * speed < 1e-12:
                return FAILED
            continue
        # every time within the step, by a shorter one
        while t < len(times) and (times[t] - now) - now_low <= step:
            part, part_rest, remainder = y.copy(), rest.copy(), (times[t] - now) - now_low
            _predict(nodes, inverse, remainder / length if length > 0 else 0.0, k, guess)
            _weigh(weights, weights_low, sign * remainder, high, low)
            passes = _step(constants, transposed, high, low, part, part_rest, guess, work)
            if passes == FAILED:
                return FAILED
            cost += passes * STAGES
            out[t] = part
            t += 1
        y, rest, length = next_y, next_rest, step
        k[:, :] = part_k
        now, error_now = two_sum(now, step)
        now_low += error_now
        step *= min(2.0, max(0.5, 0.9 * (tolerance / max(error, 1e-300)) ** 0.0625))
    return cost
