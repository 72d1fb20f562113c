"""The Euler top: a rigid body that turns about a fixed point without torque (Euler 1758), with γ fixed in space."""

from __future__ import annotations

from collections.abc import Iterable

from integrable.phase.body import REALS, Body, say_unphysical
from integrable.phase.state import State
from integrable.systems.system import System
from jacobian import Field
from jacobian.element import Coordinate, Value
from jacobian.immutable import at_once


class EulerTop(System[Coordinate]):
    """The Chaplygin ball's equations at d = 0: γ̇ = γ×ω, Ṁ = M×ω, ω_i = M_i/I_i. Inertia in kg·m²."""

    @at_once
    def __init__(self, inertia: Iterable[Value], *, field: Field[Coordinate] = REALS) -> None:
        body = Body.make(inertia, 0, field)
        say_unphysical(body.inertia, field)
        vars(self).update(body=body)

    @classmethod
    def t_handle(cls) -> tuple[EulerTop[Coordinate], State[Coordinate]]:
        """A T-handle and a state in which it spins nearly about its middle axis, so that it turns over periodically:
        the scene ``t_handle``.

        >>> top, state = EulerTop.t_handle()
        >>> top.flow(state).at([0.0, 20.0]).M[:, 1].round(6)
        array([ 1.5     , -1.500035])
        """
        top = cls((0.5, 1.5, 1.75))
        return top, top.state((1 / 3, 2 / 3, 2 / 3), (0.015625, 1.5, 0.03125), tilted=True)
