"""Points of the phase space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from integrable.body import Vector


@dataclass(frozen=True)
class State:
    """(γ, M): γ the unit vertical and M the angular momentum about the contact point, both in the body frame.

    ``system.state(gamma, M)`` makes one and checks it. Over an exact field with d ≠ 0 the state carries the root ``g``
    of g², whose sign tells D from −D; over the reals g > 0 is understood and ``g`` is None. ``tilted``: (γ, M) may
    differ from 0, and divisors, steps and the flow go through :mod:`integrable.chaplygin_transformation`.
    """

    gamma: Vector
    M: Vector
    g: Any = None
    tilted: bool = False
