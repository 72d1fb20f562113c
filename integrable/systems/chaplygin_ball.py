"""The Chaplygin ball: a balanced ball of any inertia that rolls on a plane without slipping (Chaplygin 1903)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from integrable.phase.body import REALS, Body, check_body_field, say_unphysical
from integrable.phase.state import State
from integrable.systems.system import System
from jacobian import Field
from jacobian.element import Coordinate, Element, Value
from jacobian.errors import ArgumentError, shown, written
from jacobian.immutable import at_once


class ChaplyginBall(System[Coordinate]):
    """A rolling ball with the principal moments ``inertia`` and d = m r².

    Give ``d`` in the unit of the moments (kg·m²), or ``mass`` (kg) and ``radius`` (m); a ``radius`` given with ``d`` is
    only the unit of lengths. The motion is γ̇ = γ×ω, Ṁ = M×ω with ω = A M + d·g²(γ, A M) A γ, A = diag 1/(I_i + d), g⁻²
    = 1 − d(γ, Aγ).
    """

    @at_once
    def __init__(
        self,
        inertia: Iterable[Value],
        d: Value | None = None,
        *,
        mass: Value | None = None,
        radius: Value | None = None,
        field: Field[Coordinate] = REALS,
    ) -> None:
        check_body_field(field)
        if (d is None) == (mass is None) and (d is not None or radius is None):
            raise ArgumentError(
                f"d = {shown(d)}, mass = {shown(mass)}, radius = {shown(radius)}: give either d or both mass and radius"
            )
        length = None if radius is None else _not_negative(field, radius, "radius")
        offset: Any = _rolling_offset(field, mass, radius) if d is None else d
        body = Body.make(inertia, offset, field)
        say_unphysical(body.inertia, field)
        vars(self).update(radius=length, body=body)

    @classmethod
    def _of(cls, body: Body[Coordinate]) -> ChaplyginBall[Coordinate]:
        """The ball with the parameters of ``body``, made without the warning for moments that no rigid body has: the
        Hamiltonians of deformations are defined for such moments too.
        """
        made = object.__new__(cls)
        vars(made).update(radius=None, body=body)
        return made

    @classmethod
    def example(cls) -> tuple[ChaplyginBall[Coordinate], State[Coordinate]]:
        """A ball of moments (1, 2, 3) with d = 0.7, and a state of it: the scene ``chaplygin``.

        >>> ball, state = ChaplyginBall.example()
        >>> ball.flow(state).at([1000.0]).gamma.round(6)
        array([[-0.887809,  0.353736, -0.294391]])
        """
        ball = cls((1, 2, 3), 0.7)
        return ball, ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))

    @property
    def arguments(self) -> dict[str, object]:
        unit = {} if self.radius is None else {"radius": self.radius}
        return {"inertia": self.inertia, "d": self.d, **unit}


def _rolling_offset(field: Field[Element], mass: Value | None, radius: Value | None) -> Element:
    if mass is None or radius is None:
        missing = "mass" if mass is None else "radius"
        raise ArgumentError(f"{missing} is missing: d = mass·radius² needs both")
    m, r = _not_negative(field, mass, "mass"), _not_negative(field, radius, "radius")
    return field.mul(m, field.mul(r, r))


def _not_negative(field: Field, value: Value, name: str) -> Any:
    found = field.coerce(value, name)
    if field.characteristic == 0 and found < 0:
        raise ArgumentError(f"{name} = {written(found)} is negative: give {name} ≥ 0")
    return found
