"""Gauss–Legendre of order 16, compiled for a kind of system. Of the integrators in doubles of
:mod:`integrable.oracles.methods` it has the smallest error on long runs.

The code reduces rounding errors as Hairer, McLachlan and Razakarivony (2008) do. The equations of the eight
stages are solved by fixed-point iteration, which ends when it no longer improves. The weights h·b_i are pairs of
floats, so the step has no systematic rounding error; γ and M are pairs of floats too (compensated sums).

The coefficients a_ij are used as μ_ij = a_ij/b_j with μ_ij + μ_ji = 1 exactly, so the rounded method preserves
quadratic integrals (Antoñana, Makazaga and Murua 2017). The iteration of a step starts from slopes that are
extrapolated by the polynomial through the slopes of the previous step. The step is fixed, or adapted to a
tolerance by the last Legendre coefficient of the stages.
"""

from __future__ import annotations

from functools import cache
from math import prod
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable

from integrable.oracles.collocation import gauss_rule
from integrable.oracles.compiler import njit
from integrable.oracles.exact_floats import COMPILED, INLINED, two_product, two_sum, whole_steps

__all__ = ["FAILED", "adaptive", "fixed", "rule"]

STAGES = 8
MOST_ITERATIONS = 60
FAILED = -1


class Rule(NamedTuple):
    """Gauss's rule of eight stages in floats; ``nodes`` are the c_i, shape (8,)."""

    nodes: np.ndarray
    weights: np.ndarray
    """b_i, shape (8,), with their rounding errors in ``weights_low``."""
    weights_low: np.ndarray
    ratios: np.ndarray
    """μ_ij, shape (8, 8)."""
    last: np.ndarray
    """Weights that give, from the slopes of the stages, their coefficient of the shifted Legendre polynomial P_7."""
    inverse: np.ndarray
    """1/Π_{k≠j}(c_j − c_k), for Lagrange's formula."""


@cache
def rule() -> Rule:
    """Gauss's rule in the form that the compiled loops use."""
    exact = gauss_rule(STAGES, 40)
    weights = np.array(exact.weights, dtype=float)
    low = np.array([float(b - float(b)) for b in exact.weights])
    ratios = np.full((STAGES, STAGES), 0.5)
    for i in range(STAGES):
        for j in range(i):
            # the larger of μ_ij and μ_ji is rounded, and the other is exactly 1 minus it
            value = float(exact.matrix[i][j] / exact.weights[j])
            ratios[j, i] = 1 - value
            ratios[i, j] = 1 - ratios[j, i]
    legendre = np.polynomial.legendre.Legendre.basis(STAGES - 1)
    nodes = np.array(exact.nodes, dtype=float)
    last = (2 * STAGES - 1) * weights * legendre(2 * nodes - 1)
    inverse = np.array([float(1 / prod(c - x for x in exact.nodes if x != c)) for c in exact.nodes])
    return Rule(nodes, weights, low, ratios, last, inverse)


@register_jitable(**INLINED)
def _weigh(weights, weights_low, h, high, low):  # type: ignore[no-untyped-def]
    """Writes h·b_i, i = 1 … 8, as the sums of floats high_i + low_i."""
    for i in range(STAGES):
        high[i], error = two_product(h, weights[i])
        low[i] = error + h * weights_low[i]


@register_jitable(**INLINED)
def _write(y, out, first, last):  # type: ignore[no-untyped-def]
    """Writes the state y into the rows of ``out`` from ``first`` to ``last`` − 1, number by number.

    For an assignment of slices numba would also compile the message of a possible error. This takes as long as
    compiling the method itself.
    """
    for t in range(first, last):
        for n in range(len(y)):
            out[t, n] = y[n]


@register_jitable(**INLINED)
def _predict(nodes, inverse, ratio, k, guess):  # type: ignore[no-untyped-def]
    """Writes guesses of the slopes at the stages of a step ``ratio`` times as long as the previous one.

    They extrapolate the polynomial through the previous slopes ``k``. Ratio 0 means no previous step, and gives ``k``.
    """
    if ratio == 0:
        for n in range(len(k)):
            for i in range(STAGES):
                guess[n, i] = k[n, i]
        return
    for i in range(STAGES):
        x = 1 + ratio * nodes[i]
        whole = 1.0
        for j in range(STAGES):
            whole *= x - nodes[j]
        for n in range(len(k)):
            guess[n, i] = 0.0
        for j in range(STAGES):
            factor = whole / (x - nodes[j]) * inverse[j]
            for n in range(len(k)):
                guess[n, i] += factor * k[n, j]


@register_jitable(fastmath={"contract"}, **INLINED)
def _sums(ratios, terms, base, z):  # type: ignore[no-untyped-def]
    """Writes Z_i = base_i + Σ_j μ_ij L_j into ``z``, where the L_j are ``terms``.

    ``ratios`` is transposed, so that the inner loop reads adjacent memory.
    """
    for n in range(len(z)):
        for i in range(STAGES):
            z[n, i] = base[n, i]
        for j in range(STAGES):
            factor = terms[n, j]
            for i in range(STAGES):
                z[n, i] += ratios[j, i] * factor


@register_jitable(**INLINED)
def _low_part(transposed, low, k, rest, work):  # type: ignore[no-untyped-def]
    """Writes the contribution of the weights' low parts to the stages into the last array of ``work``.

    Without it the stages and their sum would use different weights, and the quadratic integrals would drift steadily.
    """
    terms, points, base = work[1], work[2], work[3]
    for n in range(len(k)):
        for i in range(STAGES):
            points[n, i] = rest[n]
            terms[n, i] = low[i] * k[n, i]
    _sums(transposed, terms, points, base)


@register_jitable(**INLINED)
def _add(terms, low, k, y, rest):  # type: ignore[no-untyped-def]
    """Adds the sum of ``terms`` and Σ_i low_i k_i, the contribution of the weights' low parts, to the compensated state
    (y, rest), in place.
    """
    for n in range(len(k)):
        total, error = two_sum(rest[n], terms[n, 0])
        error += low[0] * k[n, 0]
        for i in range(1, STAGES):
            total, part = two_sum(total, terms[n, i])
            error += part + low[i] * k[n, i]
        y[n], part = two_sum(y[n], total)
        rest[n] = part + error


@register_jitable(**INLINED)
def _tail(weights, k, h, y):  # type: ignore[no-untyped-def]
    """The larger of (h·|c|)²/|γ|² and (h·|c|)²/|M|², where c is the sum of the slopes ``k`` of γ or of M at the stages
    with these ``weights``. If they give the last Legendre coefficient, this is an estimate of the step's error, of
    order h^16.
    """
    found = 0.0
    half = len(y) // 2
    for base in (0, half):
        size, tail = 0.0, 0.0
        for n in range(base, base + half):
            coefficient = 0.0
            for i in range(STAGES):
                coefficient += weights[i] * k[n, i]
            tail += coefficient * coefficient
            size += y[n] * y[n]
        if size > 0:
            found = max(found, h * h * tail / size)
    return found


def slopes(c, y, out):  # type: ignore[no-untyped-def]
    """Writes ẏ of each column of y into ``out``. A stub: each kind's generated code defines its own ``slopes``."""
    raise NotImplementedError


# the text below the next line is copied into the generated module of a kind of system, which defines ``slopes``
# --- copied into the module of each kind, with its slopes


@register_jitable(**INLINED)
def _step(constants, transposed, weights, state, k, work):  # type: ignore[no-untyped-def]
    """One step of the compensated ``state`` (y, rest), in place; ``k`` holds guesses of the slopes and then the slopes.

    Returns the number of iterations, or FAILED.
    """
    (high, low), (y, rest) = weights, state
    z, terms, points, base = work[0], work[1], work[2], work[3]
    smallest, stalls = np.inf, 0
    _low_part(transposed, low, k, rest, work)
    for n in range(len(k)):
        for i in range(STAGES):
            terms[n, i] = high[i] * k[n, i]
    _sums(transposed, terms, base, z)
    for iteration in range(MOST_ITERATIONS):
        for n in range(len(k)):
            for i in range(STAGES):
                points[n, i] = y[n] + z[n, i]
        slopes(constants, points, k)
        for n in range(len(k)):
            for i in range(STAGES):
                terms[n, i] = high[i] * k[n, i]
                points[n, i] = z[n, i]
        _sums(transposed, terms, base, z)
        change, size = 0.0, 0.0
        for n in range(len(k)):
            for i in range(STAGES):
                change = max(change, abs(z[n, i] - points[n, i]))
                size = max(size, abs(z[n, i]))
        # before convergence the change may rise once; at rounding level it fluctuates
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
    """What a run begins with: the ratios for :func:`_sums`, work arrays, the start's slopes for every stage, arrays for
    two more sets of slopes, and the compensated state.
    """
    work, k = np.empty((4, len(start), STAGES)), np.empty((len(start), STAGES))
    points = work[2]
    for n in range(len(k)):
        for i in range(STAGES):
            points[n, i] = start[n]
    slopes(constants, points, k)
    return (
        np.ascontiguousarray(ratios.T),
        work,
        k,
        np.empty_like(k),
        np.empty_like(k),
        start.copy(),
        np.zeros(len(start)),
    )


@register_jitable(**INLINED)
def _stepped(constants, transposed, rule, h, ratio, before, k, work):  # type: ignore[no-untyped-def]
    """One step of length h from the y, rest and slopes ``before`` it, which :func:`_predict` extrapolates by ``ratio``.

    Returns the number of iterations, or FAILED, and the new y and rest; ``k`` holds the new slopes.
    """
    (nodes, weights, weights_low, _, _, inverse), (y, rest, slopes_before) = rule, before
    high, low, y, rest = np.empty(STAGES), np.empty(STAGES), y.copy(), rest.copy()
    _weigh(weights, weights_low, h, high, low)
    _predict(nodes, inverse, ratio, slopes_before, k)
    return _step(constants, transposed, (high, low), (y, rest), k, work), y, rest


@njit(**COMPILED)
def fixed(constants, rule, start, times, setting, out):  # type: ignore[no-untyped-def]
    """Integrates in steps of one length, with an extra shorter step to each time of ``times``.

    Returns the number of evaluations of the right-hand side, or FAILED.
    """
    (sign, step), (nodes, weights, weights_low, ratios, _, inverse) = setting, rule
    transposed, work, k, guess, part_k, y, rest = _begun(constants, ratios, start)
    high, low = np.empty(STAGES), np.empty(STAGES)
    _weigh(weights, weights_low, sign * step, high, low)
    done, cost = 0.0, 0
    for t in range(len(times)):
        count, remainder = whole_steps(times[t], step)
        while done < count:
            if done > 0:
                _predict(nodes, inverse, 1.0, k, guess)
                k, guess = guess, k
            passes = _step(constants, transposed, (high, low), (y, rest), k, work)
            if passes == FAILED:
                return FAILED
            cost += passes * STAGES
            done += 1
        _write(y, out, t, t + 1)
        if remainder > 0:
            ratio, before = remainder / step if done > 0 else 0.0, (y, rest, k)
            passes, part, _ = _stepped(constants, transposed, rule, sign * remainder, ratio, before, part_k, work)
            if passes == FAILED:
                return FAILED
            cost += passes * STAGES
            _write(part, out, t, t + 1)
    return cost


@njit(**COMPILED)
def adaptive(constants, rule, start, times, setting, out):  # type: ignore[no-untyped-def]
    """Integrates like :func:`fixed`, with each step as long as :func:`_tail` allows."""
    (sign, tolerance), (_, _, _, ratios, last, _) = setting, rule
    transposed, work, k, guess, part_k, y, rest = _begun(constants, ratios, start)
    _write(y, out, 0, len(times))
    first = np.zeros(STAGES)
    first[0] = 1.0
    # the larger of |γ̇|/|γ| and |Ṁ|/|M|: at the start the slopes of all stages are equal
    speed = np.sqrt(_tail(first, k, 1.0, y))
    if speed == 0:
        return 0
    step, length = 0.5 / speed, 0.0
    now, now_low, cost, t = 0.0, 0.0, 0, 0
    while t < len(times):
        ratio, before = step / length if length > 0 else 0.0, (y, rest, k)
        passes, next_y, next_rest = _stepped(constants, transposed, rule, sign * step, ratio, before, part_k, work)
        cost += (MOST_ITERATIONS if passes == FAILED else passes) * STAGES
        error = np.inf if passes == FAILED else _tail(last, part_k, step, y)
        if error > 8 * tolerance:
            step *= 0.5 if passes == FAILED else max(0.2, 0.9 * (tolerance / error) ** 0.0625)
            if step * speed < 1e-12:
                return FAILED
            continue
        # each requested time within the step is reached by a shorter step
        while t < len(times) and (times[t] - now) - now_low <= step:
            remainder = (times[t] - now) - now_low
            ratio = remainder / length if length > 0 else 0.0
            passes, part, _ = _stepped(constants, transposed, rule, sign * remainder, ratio, before, guess, work)
            if passes == FAILED:
                return FAILED
            cost += passes * STAGES
            _write(part, out, t, t + 1)
            t += 1
        y, rest, length = next_y, next_rest, step
        k, part_k = part_k, k
        now, error_now = two_sum(now, step)
        now_low += error_now
        step *= min(2.0, max(0.5, 0.9 * (tolerance / max(error, 1e-300)) ** 0.0625))
    return cost
