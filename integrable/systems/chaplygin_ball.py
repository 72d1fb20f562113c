"""The Chaplygin ball: a balanced ball of any inertia that rolls on a plane without slipping (Chaplygin 1903)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from integrable.phase.body import Body
from integrable.systems.system import System
from jacobian import RR
from jacobian.errors import ArgumentError, shown
from jacobian.immutable import at_once


class ChaplyginBall(System):
    """A ball of principal moments ``inertia``, rolling, with d = m r².

    Give ``d`` in the unit of the moments (kg·m²), or ``mass`` (kg) and ``radius`` (m). The motion is γ̇ = γ×ω, Ṁ = M×ω
    with ω = A M + d·g²(γ, A M) A γ, A = diag 1/(I_i + d), g⁻² = 1 − d(γ, Aγ).
    """

    @at_once
    def __init__(
        self, inertia: Sequence[Any], d: Any = None, *, mass: Any = None, radius: Any = None, field: Any = RR
    ) -> None:
        if (d is None) == (mass is None and radius is None):
            raise ArgumentError(
                f"d = {shown(d)}, mass = {shown(mass)}, radius = {shown(radius)}: give either d or both mass and radius"
            )
        length = None if radius is None else field.coerce(radius, "radius")
        if d is None:
            d = _rolling_offset(field, mass, radius)
        vars(self).update(radius=length, body=Body.make(inertia, d, field))


def _rolling_offset(field: Any, mass: Any, radius: Any) -> Any:
    if mass is None or radius is None:
        missing = "mass" if mass is None else "radius"
        raise ArgumentError(f"{missing} is missing: d = mass·radius² needs both")
    m, r = field.coerce(mass, "mass"), field.coerce(radius, "radius")
    for name, value in (("mass", m), ("radius", r)):
        if field.characteristic == 0 and value < 0:
            raise ArgumentError(f"{name} = {value} is negative: give {name} ≥ 0")
    return field.mul(m, field.mul(r, r))
