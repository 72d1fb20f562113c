"""Orbits of a map: what ``[steps]`` of a scene asks for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from integrable.phase.state import State
from integrable.scene.data import MOST_STEPS
from integrable.steps.guard_digits import MOST_CONDITION, in_wider_numbers
from integrable.steps.step import Step
from jacobian import RR
from jacobian.errors import ArgumentError, shown, whole
from jacobian.immutable import read_only

__all__ = ["Orbit", "orbit"]


@dataclass(frozen=True)
class Orbit:
    """The states after 0, 1, …, N steps: ``steps`` of shape (N + 1,), ``gamma`` and ``M`` of shape (N + 1, 3).

    float64 arrays for floats, object arrays of mpf or of field elements elsewhere.
    """

    states: tuple[State, ...]
    field: Any
    report: Any = None
    """What a scene's run found of it (:class:`integrable.study.orbits.OrbitReport`), or None."""

    @property
    def steps(self) -> np.ndarray:
        return read_only(np.arange(len(self.states)))

    @property
    def times(self) -> np.ndarray:
        """The numbers of the steps."""
        return self.steps

    @property
    def gamma(self) -> np.ndarray:
        return self._array([state.gamma for state in self.states])

    @property
    def M(self) -> np.ndarray:
        return self._array([state.M for state in self.states])

    def _array(self, rows: list[Any]) -> np.ndarray:
        return read_only(np.array(rows, dtype=np.float64 if self.field == RR else object))


def orbit(step: Step, state: State, count: int) -> Orbit:
    """The states after 0, 1, …, ``count`` steps.

    Where the map loses digits (:meth:`Step.condition`) the orbit runs in wider numbers and its states are rounded to
    the field of the map one by one, so that rounding is not fed back into the map.
    """
    if not isinstance(step, Step):
        raise ArgumentError(f"step = {shown(step)}: give a Step, such as system.translation(points)")
    count = whole(
        count, "count", f"give an int ≥ 0, a number of steps, {MOST_STEPS} at most: all states are kept", 0, MOST_STEPS
    )
    if step.condition(state) > MOST_CONDITION:
        return Orbit((state, *in_wider_numbers(step, state, count)), step.system.field)
    states = [state]
    for _ in range(count):
        states.append(step(states[-1]))
    return Orbit(tuple(states), step.system.field)
