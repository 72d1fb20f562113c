"""The interface of a map of states: it is called on a state, changes to another field, and composes with ``@``."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from numbers import Real
from typing import TYPE_CHECKING, Any, Self

from jacobian.element import Element, Value
from jacobian.errors import ArgumentError, Infeasible, entries, shown, whole, written
from jacobian.fields.inexact import InexactField
from jacobian.fields.protocol import Field
from jacobian.immutable import Immutable, replaced

if TYPE_CHECKING:
    from integrable.phase.state import State


Abscissa = Value | complex | Callable[[Any, Any], Any]
"""A number, or a function of H1 and H2."""
MOST_MULTIPLE = 10**100
"""The largest multiple over RR and MP. Its computation takes some seconds, in numbers of about 500 digits."""


class Step(Immutable):
    """A map of states of one system, called as ``step(state)``; ``second @ first`` is the composition."""

    system: Any
    guarded = False
    """Whether the caller computes with guard digits and checks the result itself."""

    def __call__(self, state: State[Element]) -> State[Element]:
        """The image of a state."""
        raise NotImplementedError

    def plain(self, state: State) -> State:
        """The image computed in the numbers of the field, without a check of the loss of digits."""
        raise NotImplementedError

    def over(self, system: Any) -> Self:
        """The same map on the same system over another field, such as jets (:mod:`integrable.phase.jets`)."""
        return replaced(self, system=system)

    def wider(self, system: Any) -> Self:
        """The same map over a field of more digits, where numbers such as 1/d are recomputed."""
        return replaced(self.over(system), guarded=True)

    def condition(self, state: State) -> float:
        """The possible amplification of rounding errors in a step. Guard digits are added where it is large."""
        return 1.0

    def __matmul__(self, first: Step) -> Composition:
        if not isinstance(first, Step):
            return NotImplemented
        return Composition(self, first)


class Composition(Step):
    """``second`` after ``first``. It preserves what both preserve. If they multiply the bracket by factors, it
    multiplies the bracket by the product of these factors.
    """

    def __init__(self, second: Step, first: Step) -> None:
        if second.system != first.system:
            raise ArgumentError(f"steps of two systems do not compose: {second.system!r} and {first.system!r}")
        self.system = first.system
        self.second = second
        self.first = first

    def __repr__(self) -> str:
        return f"{self.second!r} @ {self.first!r}"

    def __call__(self, state: State[Element]) -> State[Element]:
        return self.second(self.first(state))

    def over(self, system: Any) -> Self:
        return type(self)(self.second.over(system), self.first.over(system))

    def wider(self, system: Any) -> Self:
        return type(self)(self.second.wider(system), self.first.wider(system))

    def condition(self, state: State) -> float:
        return max(self.second.condition(state), self.first.condition(state))

    def __neg__(self) -> Composition:
        """The inverse, if both steps have one."""
        return Composition(-self.first, -self.second)  # type: ignore[operator]


def checked_signs(values: Iterable[int] | None, count: int, argument: str) -> tuple[int, ...]:
    """A tuple of ``count`` signs, all 1 for None. ArgumentError names ``argument`` if the values are not signs."""
    if values is None:
        return (1,) * count
    wanted = f"a sequence of {count} signs, each 1 or -1"
    given = entries(values, argument, wanted)
    if len(given) != count or not all(isinstance(x, Real) and x in (1, -1) for x in given):
        raise ArgumentError(f"{argument} = {shown(given)}: {wanted} is needed")
    return tuple(given)


def check_doublings(K: Field, m: int, argument: str) -> None:
    """Raises Infeasible if a multiple needs too many doublings in numbers that lose digits at each doubling."""
    if isinstance(K, InexactField) and abs(m) > MOST_MULTIPLE:
        raise Infeasible(
            f"{argument} = {written(m)}: over {K.name} digits are lost at every doubling; multiples up to 1e100 are "
            "within reach, over an exact field all are"
        )


def checked_multiple(m: object) -> int:
    """``m`` as an int. ArgumentError if it is 0 or not an integer."""
    value = whole(m, "multiple", "a multiple of a step is an int")
    if value == 0:
        raise ArgumentError("multiple = 0: the identity map needs no step")
    return value
