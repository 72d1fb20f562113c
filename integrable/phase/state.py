"""States: points of the phase space."""

from __future__ import annotations

from dataclasses import dataclass, fields
from fractions import Fraction
from typing import Any, Generic

from integrable.phase.body import Vector
from jacobian.element import Element
from jacobian.errors import written

MOST_BITS = 14_000
"""The largest number of bits that is written in decimals: Python refuses ints above 4300 digits, about 14,280 bits."""


@dataclass(frozen=True)
class State(Generic[Element]):
    """A state (γ, M): the unit vertical γ and the angular momentum M about the contact point, both in the body frame.

    ``system.state(gamma, M)`` makes one and checks it. Over an exact field with d ≠ 0 the state carries the root ``g``
    of g², whose sign distinguishes the divisor D from −D; over the reals g > 0 is understood and ``g`` is None.
    ``tilted``: (γ, M) may differ from 0; divisors, steps and the flow then use :mod:`integrable.phase.upright`.
    """

    gamma: Vector[Element]
    M: Vector[Element]
    g: Element | None = None
    tilted: bool = False

    def __repr__(self) -> str:
        return f"State({', '.join(f'{x.name}={_text(getattr(self, x.name))}' for x in fields(self))})"

    def _repr_html_(self) -> str:
        from jacobian.notebook import named

        facts = [("γ", self.gamma), ("M", self.M)]
        return named("state", facts if self.g is None else [*facts, ("g", self.g)])


def _text(value: Any) -> str:
    """The ``repr`` of a number or vector, also of fractions too long for Python to write (4300 digits)."""
    if isinstance(value, tuple):
        return f"({', '.join(map(_text, value))})"
    long = isinstance(value, Fraction) and max(value.numerator.bit_length(), value.denominator.bit_length()) > MOST_BITS
    return written(value) if long else repr(value)


def onto_constraints(system: Any, state: State) -> State:
    """The state over ``system.field``, projected onto the constraints so that they hold to all digits of the field.

    γ is divided by its length, so (γ, γ) = 1. Unless the state is tilted, M loses its component along γ, so
    (γ, M) = 0. Otherwise a step would multiply the distance of the divisor from its curve by the step's condition.
    """
    K = system.field
    gamma, M = (tuple(map(K.coerce, v)) for v in (state.gamma, state.M))
    size = K.sqrt(K.dot(gamma, gamma))
    g1, g2, g3 = (x / size for x in gamma)
    tilt = K.zero if state.tilted else K.dot((g1, g2, g3), M)
    m1, m2, m3 = (y - tilt * x for x, y in zip((g1, g2, g3), M, strict=True))
    return State((g1, g2, g3), (m1, m2, m3), tilted=state.tilted)


def rotation_axis(state: State) -> int | None:
    """The axis i along which M lies, if γ_i = 0, both without any rounding; else None."""
    x, m = state.gamma, state.M
    if m.count(0) != 2:
        return None
    return next((i for i in range(3) if m[i] != 0 and m[i - 1] == m[i - 2] == x[i] == 0), None)
