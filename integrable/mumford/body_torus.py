"""Motions of :mod:`integrable.mumford.bodies` on a compact real torus at the compiled speed of the ball: its corners,
its clock and its states, along another direction."""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from integrable.moving_point.bare_problem import BareProblem
from integrable.mumford.rate_clock import Unit
from integrable.torus.access import MOST_TURNS, TorusFlow
from integrable.torus.corners import Corners
from integrable.torus.loops import CompiledLoops
from jacobian.numbers.long_reals import BareReals


class Setup(NamedTuple):
    """What the torus takes of a :class:`integrable.moving_point.setup.Setup`."""

    bare_problem: BareProblem
    wide: Any
    reals: BareReals
    time_scale: Any
    step_length: Any


class BodyTorus(TorusFlow):
    """γ and M at any times of a motion given in its :class:`~integrable.mumford.rate_clock.Unit` over ``wide``.

    PrecisionLoss where there is no such torus.
    """

    def __init__(self, wide: Any, unit: Unit) -> None:
        self._direction = unit.direction
        reals = BareReals(wide.context.prec)
        one, none, scale = wide.one, wide.zero, abs(unit.direction[0])
        axes, start = reals.row((*unit.alphas, *unit.kappas, one, none)), reals.row(unit.start)
        zeta, single, nothing, momentum = reals.row((unit.zeta, one, none, unit.momentum))
        problem = BareProblem((), axes, start, zeta, single, reals.number(scale), momentum, nothing, None)
        super().__init__(Setup(problem, wide, reals, scale, one), CompiledLoops())  # type: ignore[arg-type]

    @cached_property
    def frequencies(self) -> tuple[Any, Any]:
        """Turns of either phase in a unit of τ, wide."""
        K, (origin, length, lift) = self.setup.wide, self.units
        first, second = self._direction
        return self.turns_along(first * length * lift, (second - self.setup.reals.element(K, origin) * first) * lift)

    @property
    def witnesses(self) -> np.ndarray:
        """Times at which every sign that a period changes has been changed, in both directions."""
        assert self.clock
        paces = [float(pace) for pace in self.clock.pace]
        farthest = MOST_TURNS / 8 / max(map(abs, paces))
        return np.clip([turns / pace for pace in paces for turns in (1.23, -1.38)], -farthest, farthest)

    def _check_walk(self) -> None:
        # held against additions by the flow
        Corners._check_walk(self)
