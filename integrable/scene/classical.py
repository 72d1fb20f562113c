"""Systems of :mod:`integrable.classical` with the interface of bodies, for scenes, studies and integrators.

In this interface the names ``gamma`` and ``M`` stand for q and p.
"""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from integrable.mumford.flow import Path, Point
from integrable.mumford.system import MumfordSystem
from integrable.phase.enclosure import Enclosure
from integrable.phase.state import State
from integrable.portrait.differences import Inputs
from jacobian.element import Number, Numbers, Real, Value
from jacobian.fields.protocol import Field

__all__ = ["ClassicalMotion", "ClassicalRun", "ClassicalSystem"]


class ClassicalRun(Path):
    """States at ``times``, ``q`` and ``p`` of shape (N, n); ``report`` is the report of a scene's run, or None."""

    report: Any = None
    tau = None
    gamma, M = Path.q, Path.p


class ClassicalSystem:
    """A :class:`MumfordSystem` with states in the form of a body's: ``gamma`` is q, and ``M`` is p."""

    def __init__(self, system: MumfordSystem) -> None:
        self.system, self.field = system, system.field

    def __repr__(self) -> str:
        return repr(self.system)

    @property
    def discretized(self) -> bool:
        """Whether an exact discretization of the system is implemented."""
        return hasattr(self.system, "discrete")

    def state(self, q: Iterable[Value], p: Iterable[Value]) -> State:
        """The state with these q and p."""
        return _state(self.system.state(q, p))

    def motion_through(self, state: State) -> ClassicalMotion:
        """The motion that starts at ``state``; its ``at(times)`` returns the states, as the flow of a body does."""
        return ClassicalMotion(self, state)

    def integrals(self, state: State) -> Any:
        """The integrals by name. Each is a number or a tuple of numbers."""
        found = self.system.integrals(_point(state))
        return namedtuple("Integrals", [name.replace(" ", "_") for name in found])(*found.values())

    def rates_in(self, numbers: Field, y: Sequence[Any]) -> list[Any]:
        """(q', p') at y = (q, p). The components may be of any type that overloads the operators, such
        as symbolic expressions.
        """
        size = len(y) // 2
        rate = self.system._vector_field(numbers, Point(tuple(y[:size]), tuple(y[size:])))
        return [*rate.q, *rate.p]

    def step(self, state: State, time: Number) -> State:
        """The state after one step of the system's discretization; the step advances time by about ``time``."""
        return _state(self.system.discrete(_point(state), time))  # type: ignore[attr-defined]

    def onto_constraints(self, state: State) -> State:
        """The state, corrected so that it satisfies its constraints to all digits of the field."""
        return _state(self.system._constrained(self.field, self.system._inside(self.field, _point(state))))


class ClassicalMotion:
    """The motion of one state: ``at(times)`` returns the states at times."""

    def __init__(self, system: ClassicalSystem, state: State) -> None:
        self.system, self.state = system, state
        self._flow = system.system.flow(_point(state))

    _unit = None

    def _inputs(self) -> tuple[Inputs, tuple[str, ...]]:
        return self._flow._inputs()

    def _with(self, numbers: Iterable[Real], field: Field) -> ClassicalMotion:
        """The motion over ``field`` with these numbers, the first of :class:`Inputs`, on the constraints."""
        flow: Any = self._flow._with(numbers, field)
        system = ClassicalSystem(flow.system)
        return ClassicalMotion(system, system.onto_constraints(_state(flow.start)))

    def _states(self, times: Numbers) -> tuple[np.ndarray, np.ndarray]:
        return self._flow._states(times)

    def _prepare(self) -> None:
        """Does nothing: the method depends on the times, so its set-up is part of :meth:`at`."""

    def at(self, times: Numbers) -> ClassicalRun:
        """The states at the given times."""
        found = self._flow.at(times)
        return ClassicalRun(found.times, found._rows, found.way)

    def enclosure(self, times: Numbers, digits: int | None = None) -> Enclosure:
        """Proven bounds of the states at times, from the system's flow."""
        return self._flow.enclosure(times, digits)


def _point(state: State) -> Point:
    return Point(*state.vectors)


def _state(point: Point) -> State:
    return State(point.q, point.p)
