"""Orbits of a map, for the ``[steps]`` of a scene."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Self

import numpy as np

from integrable.motion.trajectory import Times, Trajectory, VectorArray
from integrable.phase.state import State
from integrable.scene.data import MOST_STEPS
from integrable.steps.guard_digits import MOST_CONDITION, in_wider_numbers
from integrable.steps.step import Step
from jacobian import RR
from jacobian.errors import ArgumentError, NotRepresentable, shown, whole
from jacobian.immutable import read_only, replaced

__all__ = ["Orbit", "orbit"]


class Orbit(Trajectory):
    """The ``states`` after 0, 1, …, N steps of a map, ``gamma`` and ``M`` of shape (N + 1, 3), of float64 or objects.

    ``times`` are the step numbers; ``report`` is the report of a scene's run
    (:class:`integrable.study.orbits.OrbitReport`), or None.
    """

    def __init__(self, step: Step, states: tuple[State, ...]) -> None:
        rows = [state.row for state in states]
        steps = np.arange(len(states))
        super().__init__(step, steps, steps, np.array(rows, dtype=_kind(step.system)), "steps")
        self.states = states

    def concatenated(self, *others: Trajectory) -> Trajectory:
        """Raises NotRepresentable: orbits cannot be concatenated, because each step starts from the previous one."""
        raise NotRepresentable(f"concatenated: {self!r} is an orbit, whose steps follow one another")

    def _one(self, row: int) -> State:
        return self.states[row]

    def _some(self, places: np.ndarray) -> Self:
        return replaced(super()._some(places), states=tuple(self.states[i] for i in places.tolist()))

    @property
    def steps(self) -> Times:
        """The step numbers, shape (N + 1,)."""
        return self.times

    @property
    def tau(self) -> Times:
        """Raises NotRepresentable: a map has no flow time τ."""
        raise NotRepresentable(f"tau: {self.flow!r} is a map, whose steps have no time")

    @property
    def contact(self) -> VectorArray:
        """Raises NotRepresentable: the body does not roll between the states of a map."""
        raise NotRepresentable(f"contact: {self.flow!r} is a map, between whose states nothing rolls")

    @cached_property
    def integrals(self) -> Any:
        """The system's integrals of every state, each of shape (N + 1,)."""
        found = [self.system.integrals(state) for state in self.states]
        return type(found[0])(*(read_only(np.array(x, dtype=_kind(self.system))) for x in zip(*found, strict=True)))


def _kind(system: Any) -> Any:
    return np.float64 if system.field is RR else object


def orbit(step: Step, state: State, count: int) -> Orbit:
    """The states after 0, 1, …, ``count`` steps.

    Where the map loses digits (:meth:`Step.condition`), the orbit is computed at a higher precision. Its
    states are rounded to the map's field at the end, so that rounding does not feed back into the map.
    """
    if not isinstance(step, Step):
        raise ArgumentError(f"step = {shown(step)}: give a Step, such as system.translation(points)")
    count = whole(
        count, "count", f"give an int ≥ 0, a number of steps, {MOST_STEPS} at most: all states are kept", 0, MOST_STEPS
    )
    if step.condition(state) > MOST_CONDITION:
        return Orbit(step, (state, *in_wider_numbers(step, state, count)))
    states = [state]
    for _ in range(count):
        states.append(step(states[-1]))
    return Orbit(step, tuple(states))
