"""States: points of the phase space."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Generic, overload

from integrable.phase.body import Vector
from jacobian.element import Element
from jacobian.errors import ArgumentError, FieldError, shown, written
from jacobian.immutable import Immutable, at_once

if TYPE_CHECKING:
    import numpy as np

MOST_BITS = 14_000
"""The largest number of bits that is written in decimals: Python refuses ints above 4300 digits, about 14,280 bits."""


class _Part:
    """γ or M as the user sees it: a read-only array over RR and MP, as in a trajectory. Over exact fields it is a
    tuple, because sums and products by numpy would not be reduced to the field.
    """

    def __init__(self, place: int) -> None:
        self._place = place

    @overload
    def __get__(self, state: None, owner: type) -> _Part: ...
    @overload
    def __get__(self, state: State[float], owner: type) -> np.ndarray[tuple[int], np.dtype[np.float64]]: ...
    @overload
    def __get__(self, state: State[Element], owner: type) -> Vector[Element]: ...
    def __get__(self, state: Any, owner: type) -> Any:
        if state is None:
            return self
        vector = state.vectors[self._place]
        real = isinstance(vector[0], float)
        if not (real or hasattr(vector[0], "_mpf_")):
            return vector
        import numpy as np

        array = np.array(vector, dtype=np.float64 if real else object)
        array.setflags(write=False)
        return array


# this is a dataclass only so that dataclasses.replace takes a state; its usual methods are written out
@dataclass(init=False, repr=False, eq=False)
class State(Immutable, Generic[Element]):
    """A state (γ, M): the unit vertical γ and the angular momentum M about the contact point, both in the body frame.

    ``system.state(gamma, M)`` makes and checks a state. ``gamma`` and ``M`` are read-only arrays of shape (3,) over RR
    and MP, and tuples over an exact field. ``vectors`` is the pair (γ, M) of tuples over every field, and ``row``
    has the six numbers.

    Over an exact field with d ≠ 0 the state has the root ``g`` of g², whose sign distinguishes the divisor D from −D;
    over the reals g > 0 is understood and ``g`` is None. If ``tilted``, the product (γ, M) may differ from 0; divisors,
    steps and the flow then use :mod:`integrable.phase.upright`.
    """

    gamma: _Part = _Part(0)
    M: _Part = _Part(1)
    g: Element | None = None
    tilted: bool = False
    vectors: tuple[Vector[Element], Vector[Element]] = field(init=False)

    @at_once
    def __init__(
        self, gamma: Vector[Element], M: Vector[Element], g: Element | None = None, tilted: bool = False
    ) -> None:
        if type(gamma) is not tuple or type(M) is not tuple:
            gamma, M = _numbers(gamma), _numbers(M)
        vars(self).update(vectors=(gamma, M), g=g, tilted=tilted)

    @property
    def row(self) -> tuple[Element, ...]:
        """The six numbers γ1, γ2, γ3, M1, M2, M3."""
        gamma, M = self.vectors
        return *gamma, *M

    def __repr__(self) -> str:
        gamma, M = map(_text, self.vectors)
        return f"State(gamma={gamma}, M={M}, g={_text(self.g)}, tilted={self.tilted})"

    def _repr_html_(self) -> str:
        from jacobian.notebook import named

        facts: list[tuple[str, object]] = list(zip("γM", self.vectors, strict=True))
        return named("state", facts if self.g is None else [*facts, ("g", self.g)])


def state_of_row(row: Iterable[Any], tilted: bool = False) -> State:
    """The unchecked state with the six numbers γ1, γ2, γ3, M1, M2, M3."""
    x1, x2, x3, m1, m2, m3 = row
    return State((x1, x2, x3), (m1, m2, m3), tilted=tilted)


def _numbers(vector: Any) -> Any:
    """A vector as a hashable tuple; the elements of an array such as ``state.gamma`` become Python's own numbers."""
    return tuple(vector.tolist() if hasattr(vector, "tolist") else vector)


def _text(value: object) -> str:
    """The ``repr`` of a number or vector, also of fractions too long for Python to write (4300 digits)."""
    if isinstance(value, tuple):
        return f"({', '.join(map(_text, value))})"
    long = isinstance(value, Fraction) and max(value.numerator.bit_length(), value.denominator.bit_length()) > MOST_BITS
    return written(value) if long else repr(value)


def onto_constraints(system: Any, state: State) -> State:
    """The state over ``system.field``, projected onto the constraints so that they hold to all digits of the field.

    γ is divided by its length, so (γ, γ) = 1. Unless the state is tilted, M loses its component along γ, so (γ, M) = 0.
    Any distance from the constraints would be multiplied by the condition number of a step.
    """
    K = system.field
    gamma, M = (tuple(map(K.coerce, v)) for v in state.vectors)
    size = K.sqrt(K.dot(gamma, gamma))
    gamma = tuple([x / size for x in gamma])
    tilt = K.zero if state.tilted else K.dot(gamma, M)
    return state_of_row((*gamma, *(y - tilt * x for x, y in zip(gamma, M, strict=True))), state.tilted)


def rotation_axis(state: State) -> int | None:
    """The axis i if M is exactly along it and γ_i is exactly 0; None if there is none."""
    x, m = state.vectors
    if m.count(0) != 2:
        return None
    return next((i for i in range(3) if m[i] != 0 and m[i - 1] == m[i - 2] == x[i] == 0), None)


def check_state(system: Any, state: object) -> State:
    """``state`` unchanged. Raises ArgumentError, with a hint on how to make a state, if the argument is not a State,
    and FieldError if its numbers are of another field.
    """
    if not isinstance(state, State):
        raise ArgumentError(f"state = {shown(state)}: give a State, made by {type(system).__name__}.state(gamma, M)")
    field, first = system.body.field, state.vectors[0][0]
    if field.exact and (isinstance(first, (float, complex)) or hasattr(first, "_mpf_")):
        raise FieldError(f"state = {shown(state)}: its numbers are not of {field.name}, the field of {shown(system)}")
    return state
