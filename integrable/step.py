"""What every map of states is: it is called on a state, moves to another field, and composes with ``@``."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

from jacobian.errors import ArgumentError

if TYPE_CHECKING:
    from integrable.state import State


class Step:
    """A map of the states of one system: ``step(state)``; ``second @ first`` is the composition."""

    system: Any

    def __call__(self, state: State) -> State:
        """The image of a state."""
        raise NotImplementedError

    def over(self, system: Any) -> Step:
        """The same map on the same system over another field, such as jets over its own."""
        moved = copy.copy(self)
        moved.system = system
        return moved

    def wider(self, system: Any) -> Step:
        """The same map over a field of more digits, its own numbers taken for what they stand for, such as 1/d."""
        return self.over(system)

    def condition(self, state: State) -> float:
        """By how much rounding in the arithmetic of a step may grow; digits are added where it is large."""
        return 1.0

    def __matmul__(self, first: Any) -> Composition:
        if not isinstance(first, Step):
            return NotImplemented
        return Composition(self, first)


class Composition(Step):
    """``second`` after ``first``: it preserves what both preserve, and the factors of their brackets multiply."""

    def __init__(self, second: Step, first: Step) -> None:
        if second.system != first.system:
            raise ArgumentError(f"steps of two systems do not compose: {second.system!r} and {first.system!r}")
        self.system = first.system
        self.second = second
        self.first = first

    def __repr__(self) -> str:
        return f"{self.second!r} @ {self.first!r}"

    def __call__(self, state: State) -> State:
        return self.second(self.first(state))

    def over(self, system: Any) -> Composition:
        return Composition(self.second.over(system), self.first.over(system))

    def wider(self, system: Any) -> Composition:
        return Composition(self.second.wider(system), self.first.wider(system))

    def condition(self, state: State) -> float:
        return max(self.second.condition(state), self.first.condition(state))

    def __neg__(self) -> Composition:
        """The inverse, where both have one."""
        return Composition(-self.first, -self.second)  # type: ignore[operator]
