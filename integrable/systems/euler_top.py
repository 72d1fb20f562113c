"""The Euler top: a rigid body that turns about a fixed point without torque (Euler 1758), with γ fixed in space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from integrable.phase.body import Body
from integrable.systems.system import System
from jacobian import RR
from jacobian.immutable import at_once


class EulerTop(System):
    """The Chaplygin ball's equations at d = 0: γ̇ = γ×ω, Ṁ = M×ω, ω_i = M_i/I_i. Inertia in kg·m²."""

    @at_once
    def __init__(self, inertia: Sequence[Any], *, field: Any = RR) -> None:
        vars(self).update(body=Body.make(inertia, 0, field))
