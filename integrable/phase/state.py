"""Points of the phase space."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from integrable.phase.body import Vector


@dataclass(frozen=True)
class State:
    """(γ, M): γ the unit vertical and M the angular momentum about the contact point, both in the body frame.

    ``system.state(gamma, M)`` makes one and checks it. Over an exact field with d ≠ 0 the state carries the root ``g``
    of g², whose sign tells D from −D; over the reals g > 0 is understood and ``g`` is None. ``tilted``: (γ, M) may
    differ from 0, and divisors, steps and the flow go through :mod:`integrable.phase.upright`.
    """

    gamma: Vector
    M: Vector
    g: Any = None
    tilted: bool = False


def constrained(system: Any, gamma: Iterable[Any], M: Iterable[Any], *, tilted: bool = False) -> State:
    """The state of γ and M that meet |γ| = 1 and, unless ``tilted``, (γ, M) = 0 to rounding: made to meet them exactly.

    ``gamma`` and ``M`` are numbers of the field of ``system``; γ is divided by its length, M loses its part along γ.
    """
    K = system.field
    gamma, M = list(gamma), list(M)
    length = K.sqrt(K.dot(gamma, gamma))
    gamma = [x / length for x in gamma]
    if not tilted:
        tilt = K.dot(gamma, M)
        M = [m - tilt * x for m, x in zip(M, gamma, strict=True)]
    # deformations know no tilted states
    state: State = system.state(gamma, M, **({"tilted": True} if tilted else {}))
    return state
