"""The flow in floats for few turns: short runs of one call each, which need no torus.

A run does its own set-up, so that a fresh flow has nothing to wait for (:mod:`integrable.moving_point.short` says how).
Compiled it costs some tens of microseconds and a few for every panel; the same source is interpreted, some hundred
times slower, where loading compiled code would take longer. What it is not sure of is left to the next way.
"""

from __future__ import annotations

import sys
from functools import cache
from math import cos, pi
from typing import TYPE_CHECKING

import numpy as np

from integrable.moving_point import short
from integrable.moving_point.short_rows import CLOCK, NODES, PHYSICAL, Request, Rule, new_room
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.long_reals import BareReals

if TYPE_CHECKING:
    from collections.abc import Callable

    from integrable.motion.trajectory import Way
    from integrable.phase.space import PhaseSpace
    from integrable.phase.state import State

# microseconds, compiled: a panel, and what a run takes before its first; a time off a torus that is there, off panels
# between ascending ones, and before that the torus itself (python -m benchmarks short)
PANEL_COST, START_COST = 5.0, 100.0
TORUS_COST, DENSE_COST, TORUS_SET_UP = 8.0, 0.3, 5000.0
DENSE_FROM = 5000
# panels at most, whose errors grow like their number; times at most
MOST_PANELS, MOST_TIMES = 400, 20_000
# interpreted: panels of one run, those of a flow before it loads numba, and times from which on loading it pays
INTERPRETED_PANELS, BEFORE_NUMBA, INTERPRETED_TIMES = 64, 500, 500
# bits of the wide numbers, and steps of Newton from floats to them, where nothing is compiled
BITS, PASSES = 160, 2

Found = tuple[np.ndarray, np.ndarray]


class ShortRuns:
    """γ and M at a few turns' times from one state, in the user's units; None where another way has to be taken.

    ``kernel`` as for :class:`integrable.motion.flow.Flow`: "auto" interprets few near times as long as nothing has
    loaded numba, which takes longer. ``torus``: whether there is one already.
    """

    def __init__(self, system: PhaseSpace, state: State, kernel: str = "auto") -> None:
        d = system.d if system.body.rolls else 0.0
        self._given = np.array([*system.inertia, d, *state.gamma, *state.M], dtype=np.float64)
        self._tilted, self._rolls, self._kernel = state.tilted, bool(system.body.rolls), kernel
        # panels of this flow: a torus, or loading numba, would have been paid for by as many
        self._compiled_panels = self._interpreted_panels = 0

    def at(self, times: np.ndarray, torus: bool = False) -> Found | None:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,)."""
        return self._run(times, torus, self._rolls, False)

    def at_tau(self, tau: np.ndarray, torus: bool = False) -> np.ndarray | None:
        """γ and M at values of τ, shape (N, 6)."""
        found = self._run(tau, torus, False, False)
        return None if found is None else found[0]

    def times(self, tau: np.ndarray, torus: bool = False) -> np.ndarray | None:
        """Physical times at values of τ."""
        found = self._run(tau, torus, False, True)
        return None if found is None else found[1]

    def _run(self, times: np.ndarray, torus: bool, physical: bool, clock: bool) -> Found | None:
        """The states, and τ at ``physical`` times or, if the ``clock`` is asked for, physical times at τ."""
        if len(times) > MOST_TIMES:
            return None
        order, status = np.argsort(times, kind="stable"), short.FAR
        if self._without_numba(len(times)):
            status, unit, out, other = self._interpreted(times, order, physical, clock)
        if status == short.FAR and self._kernel != "python" and not interpreted():
            most = self._most(len(times), torus)
            if most > 0:
                status, unit, out, other = self._compiled(times, order, physical, clock, most)
        if status:
            return None
        rows = out.reshape(-1, 6)
        if not times.all():
            rows[times == 0] = self._start()
        # without a clock there is nothing in ``other``
        return rows, other / unit if physical or clock else times

    def _start(self) -> np.ndarray:
        """The state itself, on its constraints: no interpolant's error is there."""
        gamma, M = self._given[4:7].astype(np.longdouble), self._given[7:].astype(np.longdouble)
        gamma /= np.sqrt(gamma @ gamma)
        return np.concatenate([gamma, M if self._tilted else M - (gamma @ M) * gamma]).astype(float)

    def _without_numba(self, count: int) -> bool:
        if count >= INTERPRETED_TIMES:
            return False
        if self._kernel == "python" or ("numba" in sys.modules and interpreted()):
            return True
        return "numba" not in sys.modules and self._interpreted_panels < BEFORE_NUMBA

    def _most(self, count: int, torus: bool) -> int:
        """So many panels cost less than another way to the states."""
        cost = count * (TORUS_COST if count < DENSE_FROM else DENSE_COST)
        if not torus:
            cost += max(0.0, TORUS_SET_UP - PANEL_COST * self._compiled_panels)
        return min(MOST_PANELS, int((cost - START_COST) / PANEL_COST))

    def _compiled(
        self, times: np.ndarray, order: np.ndarray, physical: bool, clock: bool, most: int
    ) -> tuple[int, float, np.ndarray, np.ndarray]:
        from integrable.moving_point.short_compiled import short_run

        out, other = np.empty(6 * len(times)), np.empty(len(times))
        status, unit, panels = short_run(
            self._given, self._tilted, rule(), physical, clock, most, times, order, out, other
        )
        self._compiled_panels += panels
        return status, unit, out, other

    def _interpreted(
        self, times: np.ndarray, order: np.ndarray, physical: bool, clock: bool
    ) -> tuple[int, float, np.ndarray, np.ndarray]:
        reals, count = BareReals(BITS), len(times)
        request = Request(
            physical, clock, INTERPRETED_PANELS, times.tolist(), order.tolist(), [0.0] * count, [0.0] * count,
            [0.0] * (6 * count), [0.0] * count,
        )  # fmt: skip
        with reals:
            room = new_room(lambda n: [reals.number(0)] * n, lambda n: [0.0] * n, [1, 0, PASSES, 0])
            try:
                status = short.short_run(room, _listed(), request, reals.row(self._given.tolist()), self._tilted)
            except (ArithmeticError, ValueError, TypeError):
                # compiled these are infinities, not-a-numbers, and roots of negative numbers
                status = short.LOST
        self._interpreted_panels += room.made[3]
        return status, room.numbers[CLOCK if physical else PHYSICAL], np.array(request.out), np.array(request.other)


class ShortFirst:
    """The :class:`integrable.motion.trajectory.Way` of one call: a short run, or what ``other`` gives."""

    def __init__(self, runs: ShortRuns, torus: bool, other: Callable[[], Way]) -> None:
        self._runs, self._torus, self._other = runs, torus, other
        self.way = "short run"

    def at(self, times: np.ndarray) -> Found:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,)."""
        return self._runs.at(times, self._torus) or self._far().at(times)

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ, shape (N, 6)."""
        found = self._runs.at_tau(tau, self._torus)
        return self._far().at_tau(tau) if found is None else found

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        found = self._runs.times(tau, self._torus)
        return self._far().times(tau) if found is None else found

    def _far(self) -> Way:
        other = self._other()
        self.way = other.way
        return other


@cache
def rule() -> Rule:
    """The Chebyshev nodes of a panel and what goes with them."""
    count = NODES
    k = np.arange(count)
    # whole turns are taken off while the angles are integers
    cosines = np.array([cos(pi / (2 * count) * m) for m in range(4 * count)])
    matrix = 2 / count * cosines[np.outer(k, 2 * count - (2 * k + 1)) % (4 * count)]
    matrix[0] /= 2
    nodes = -cosines[2 * k + 1]
    nodes = (nodes - nodes[::-1]) / 2
    weights = (-1.0) ** k * cosines[(count - (2 * k + 1)) % (4 * count)]
    ends = np.concatenate([(-1.0) ** k @ matrix, np.ones(count) @ matrix])
    return Rule(nodes, matrix.ravel(), weights, ends)


@cache
def _listed() -> Rule:
    """The same as lists, which interpreted loops read faster."""
    return Rule(*(part.tolist() for part in rule()))
