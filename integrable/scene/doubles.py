"""The inputs of a study: a scene with all numbers rounded to doubles, so that every method computes the same motion.

A method with 40 digits and a method in doubles read the same decimal fractions as slightly different numbers. That
difference would count as an error of the method in doubles, so all numbers are rounded to doubles first. The rounded
numbers satisfy |γ| = 1 and (γ, M) = 0 only to rounding. For runs with more digits both constraints are restored, as
the flow restores them. Methods in doubles receive the doubles themselves.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from fractions import Fraction
from typing import Any

from integrable.phase.precisions import FLOAT_DIGITS
from integrable.phase.state import State, onto_constraints
from integrable.scene.data import Scene

__all__ = ["SceneInDoubles", "in_doubles"]


@dataclass(frozen=True)
class SceneInDoubles(Scene):
    """A scene whose numbers are all doubles, as exact fractions; made by :func:`in_doubles`."""

    def start(self, digits: int) -> tuple[Any, Any]:
        """The system and its state at time 0. Above 15 digits |γ| = 1 and (γ, M) = 0 are restored."""
        if digits <= FLOAT_DIGITS:
            return super().start(digits)
        system, number = self.body(digits), self._numbers(digits)
        gamma, M = (tuple(map(number, vector)) for vector in (self.gamma, self.M))
        if self.classical:
            return system, system.onto_constraints(State(gamma, M))
        return system, onto_constraints(system, State(gamma, M, tilted=self.tilted))


def in_doubles(scene: Scene) -> Scene:
    """The scene with body, start, times and the arguments of its maps rounded to doubles.

    An orbit over a finite field is exact and stays unchanged.
    """
    if scene.finite_field or isinstance(scene, SceneInDoubles):
        return scene
    rounded: dict[str, Any] = {one.name: _rounded(getattr(scene, one.name)) for one in fields(scene)}
    if scene.mass is not None:
        # d is m r² as the ball computes it in doubles
        rounded |= {"d": Fraction(scene.body(FLOAT_DIGITS).d), "mass": None, "radius": None}
    rounded["times"] = replace(scene.times, given=_rounded(scene.times.given))
    if scene.steps is not None:
        maps = (replace(one, arguments=_rounded(one.arguments)) for one in scene.steps.maps)
        rounded["steps"] = replace(scene.steps, maps=tuple(maps))
    return SceneInDoubles(**rounded)


def _rounded(value: Any) -> Any:
    """A fraction rounded to the nearest double, still as a fraction, also inside tuples. Other values are unchanged."""
    if isinstance(value, Fraction):
        return Fraction(float(value))
    return tuple(map(_rounded, value)) if isinstance(value, tuple) else value
