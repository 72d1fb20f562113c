"""Physical time by stepping, in floats: the clock of a flow near its start.

t = ∫dτ/g along the additions of basic steps: Gauss–Legendre nodes around every step, whose values are a Legendre series
for 1/g.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from integrable.moving_point import addition
from integrable.moving_point.legendre import legendre_rule
from integrable.moving_point.setup import Setup, View
from integrable.phase.precisions import EPS_DIGITS
from jacobian import RR
from jacobian.errors import ArgumentError, PrecisionLoss

FIRST_STEPS = 64
MOST_STEPS = 50_000_000
NODE_COUNTS = (8, 12, 16, 20, 24, 28, 32, 40, 48, 64, 80, 96, 128, 160, 200, 256, 320, 400)


class Clock:
    """Physical time at the basic steps of a flow, in one direction, grown as far as it is asked for."""

    def __init__(self, setup: Setup, sign: int) -> None:
        self._setup = setup
        self._floats = setup.floats
        self._sign = sign
        self.high = np.array([0.0])
        self.low = np.array([0.0])
        self._carry: list[Any] | None = None
        self._stack: list[list[Any]] = []
        self._ends: list[int] = []
        self._rule: Quadrature | None = None

    def extend(self, until: Any) -> None:
        """Make the steps reach beyond the (scaled) time ``until``."""
        self.extend_to_step(FIRST_STEPS)
        while self.high[-1] <= until:
            # the mean rate is known by now to a few per cent
            known = len(self.high) - 1
            missing = float((until - self.high[-1]) / self.high[-1]) * known
            self.extend_to_step(known + int(1.02 * missing) + 2)

    def extend_to_step(self, last: int) -> None:
        """Make the steps reach ``last``."""
        count = last + 1 - len(self.high)
        if count <= 0:
            return
        if last > MOST_STEPS:
            raise ArgumentError(
                f"times: {last} basic steps are more than the {MOST_STEPS} that a clock in memory is made for"
            )
        rule, floats = self.rule, self._floats
        counts, table = floats.table(self._sign, last)
        self._start(rule, counts)
        high, low = np.empty(count, dtype=self.high.dtype), np.empty(count, dtype=self.low.dtype)
        addition.wind(
            floats.f,
            floats.axes,
            counts,
            table,
            rule.nodes,
            rule.left,
            rule.right,
            len(self.high),
            self._stack,
            self._ends,
            self._carry,
            high,
            low,
        )
        self.high, self.low = np.concatenate([self.high, high]), np.concatenate([self.low, low])

    def _start(self, rule: Quadrature, counts: list[int]) -> None:
        floats = self._floats
        if self._carry is None:
            values = [0.0] * len(rule.nodes)
            addition.rates(floats.f, floats.axes, floats.start, rule.nodes, values)
            half = sum(w * x for w, x in zip(rule.right, values, strict=True))
            self._carry = [0 * half, 0 * half, half]
        # a level is added before the steps reach its count: its place is still zero
        for count in counts[len(self._stack) :]:
            self._stack.append(list(floats.start))
            self._ends.append(count)

    @property
    def rule(self) -> Quadrature:
        """The quadrature whose Legendre series has converged on steps spread over the motion."""
        if self._rule is None:
            floats = self._floats
            levels = floats.table(self._sign, 512)
            samples = [addition.reach(floats.f, floats.axes, floats.start, *levels, j) for j in range(0, 512, 61)]
            # an easy body needs about 0.8 nodes a digit
            least, most = 0.7 * EPS_DIGITS, 6 * EPS_DIGITS
            for count in (n for n in NODE_COUNTS if least <= n <= most):
                rule = Quadrature(self._setup, count, self._sign)
                if max(_tail(floats, rule, point) for point in samples) < 4 * RR.eps:
                    break
            else:
                raise PrecisionLoss(
                    f"1/g is not resolved by {most} nodes a step: the moments or d differ too much for this clock"
                )
            self._rule = rule
        return self._rule

    def states(self, high: list[Any], low: list[Any]) -> tuple[np.ndarray, np.ndarray]:
        """(moving points, flow time in half steps) at (scaled) times inside the reach of the clock."""
        floats, rule = self._floats, self.rule
        steps = [int(s) for s in np.searchsorted(self.high, np.array(high), side="right") - 1]
        rests = [(t - self.high[s]) + (r - self.low[s]) for t, r, s in zip(high, low, steps, strict=True)]
        nexts = [(t - self.high[s + 1]) + (r - self.low[s + 1]) for t, r, s in zip(high, low, steps, strict=True)]
        state_at_time = partial(
            addition.state_at_time,
            floats.f,
            floats.axes,
            floats.start,
            *floats.table(self._sign, max(steps) + 1),
            rule.nodes,
            rule.legendre,
            floats.series,
            floats.roots,
            floats.half_step,
            floats.passes,
            self._sign,
        )
        found = [state_at_time(*place) for place in zip(steps, _plain(rests), _plain(nexts), strict=True)]
        return np.array([point for point, _ in found], float), np.array([offset for _, offset in found], float)

    def time(self, step: int, offset: Any) -> Any:
        """The (scaled) time ``offset`` half steps beyond a basic step."""
        floats, rule = self._floats, self.rule
        point = addition.reach(floats.f, floats.axes, floats.start, *floats.table(self._sign, step), step)
        angle, _ = addition.integrate_series(_series(floats, rule, point), offset)
        return self.high[step] + (self.low[step] + floats.half_step * angle)


class Quadrature:
    """Nodes of one basic step as translations, weights of its halves, the matrix from values to a Legendre series."""

    def __init__(self, setup: Setup, count: int, sign: int) -> None:
        half = setup.problem.half_step
        x, rows, right = legendre_rule(setup.wide, count)
        outer = [setup.floats.near(sign * half * node) for node in x[: (count + 1) // 2]]
        # the nodes are symmetric about 0, and T(−eps) = −T(eps)
        self.nodes = outer + [addition.opposite(step) for step in outer[: count // 2][::-1]]
        self.right = [float(half * c) for c in right]
        self.left = self.right[::-1]
        self.legendre = [[float(c) for c in row] for row in rows]


def _series(floats: View, rule: Quadrature, point: Any) -> list[Any]:
    """Legendre coefficients of 1/g over the step around a moving point."""
    values = [0.0] * len(rule.nodes)
    addition.rates(floats.f, floats.axes, point, rule.nodes, values)
    return [sum(c * x for c, x in zip(row, values, strict=True)) for row in rule.legendre]


def _tail(floats: View, rule: Quadrature, point: Any) -> Any:
    """The size of the last Legendre coefficients of 1/g beside the first, an estimate of the truncation error."""
    coefficients = _series(floats, rule, point)
    return max(abs(c) for c in coefficients[-2:]) / abs(coefficients[0])


def _plain(values: list[Any]) -> list[Any]:
    """float for np.float64, which is slow in interpreted loops; mpf unchanged."""
    return [float(x) if isinstance(x, np.floating) else x for x in values]
