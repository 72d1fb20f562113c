"""Motions of :mod:`integrable.mumford.bodies` on a compact real torus at the compiled speed of the ball: its corners,
its clock and its states, along another direction.

The real torus with a clock (:mod:`integrable.mumford.real_torus`) has these motions too, but knows the mean rate of a
clock only as a sum over a grid, in double-double numbers, and so leaves times beyond 2²⁶ turns to additions. That of a
body is a determinant of elliptic integrals, as the ball's is, and serves floats up to 2⁵⁰ turns.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from integrable.moving_point.bare_problem import BareProblem
from integrable.mumford.rate_clock import Unit
from integrable.torus.access import MOST_TURNS, TorusFlow
from integrable.torus.corners import Corners
from integrable.torus.loops import CompiledLoops
from integrable.torus.witness import TURNS
from jacobian.numbers.long_reals import BareReals


class Setup(NamedTuple):
    """What the torus takes of a :class:`integrable.moving_point.setup.Setup`."""

    bare_problem: BareProblem
    wide: Any
    reals: BareReals
    time_scale: Any
    step_length: Any
    floats_given: None = None


class BodyTorus(TorusFlow):
    """γ and M at any times of a motion given in its :class:`~integrable.mumford.rate_clock.Unit` over ``wide``.

    PrecisionLoss where there is no such torus.
    """

    def __init__(self, wide: Any, unit: Unit) -> None:
        self._direction, (u0, u1, *_) = unit.direction, unit.start
        reals = BareReals(wide.context.prec)
        one, none, scale = wide.one, wide.zero, abs(unit.direction[0])
        slowness = wide.sqrt((1 + u1 + u0) / wide.dot(unit.start[4:7], unit.start[4:7]))
        axes, start = reals.row((*unit.alphas, *unit.kappas, one, none)), reals.row(unit.start)
        zeta, d, scale_, half, momentum, slow = reals.row((unit.zeta, one, scale, none, unit.momentum, slowness))
        problem = BareProblem((half,) * 6, axes, start, zeta, d, scale_, momentum, half, None, slow)
        super().__init__(Setup(problem, wide, reals, scale, one), CompiledLoops())  # type: ignore[arg-type]

    def _made_rates(self, pi: Any) -> Any:
        K, (origin, length, lift) = self.setup.wide, self.units
        first, second = self._direction
        origin, rates = self.setup.reals.element(K, origin), super()._made_rates(pi)
        nu = self.turns_along(first * length * lift, (second - origin * first) * lift)
        (mean,) = self.loops.wide(rates[9:10], K)
        rates[4:12] = self.loops.row((*(x / mean for x in nu), *nu, 1 / mean, mean, *nu))
        return rates

    @property
    def witnesses(self) -> np.ndarray:
        """Times at which every sign that a period changes has been changed, in both directions."""
        paces = self._of_rates(4, 6)
        farthest = MOST_TURNS / 8 / max(map(abs, paces))
        return np.clip([turns / pace for pace in paces for turns in TURNS], -farthest, farthest)

    def reaches(self, times: np.ndarray) -> bool:
        """Whether double-double numbers hold the fractions of all turns."""
        turns: float = np.abs(times).max(initial=0) * max(map(abs, self._of_rates(4, 6)))
        return turns <= MOST_TURNS

    def _check_walk(self) -> None:
        # held against additions by the flow
        Corners._check_walk(self)
