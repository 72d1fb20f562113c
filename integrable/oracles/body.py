"""Bodies and states as integrators need them, the equations of ball and top, and the result of a run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

__all__ = ["Body", "Solution", "Start", "body_equations", "cross", "is_body"]


class Body(Protocol):
    """A body for an integrator: three moments of inertia and d = m r² (0 for the Euler top)."""

    @property
    def inertia(self) -> Sequence[Any]: ...
    @property
    def d(self) -> Any: ...


class Start(Protocol):
    """A state for an integrator: γ and M, three components each."""

    @property
    def gamma(self) -> Sequence[Any]: ...
    @property
    def M(self) -> Sequence[Any]: ...


class Solution(NamedTuple):
    """γ and M, one row per requested time in the order requested, and the number of evaluations."""

    gamma: np.ndarray
    M: np.ndarray
    evaluations: int
    """The number of evaluated right-hand sides; of expansions for Taylor series, of steps for heyoka's, of states for
    closed forms.
    """


def is_body(system: Any) -> bool:
    """Whether a system is a ball or a top: it then has ``inertia`` and ``d``."""
    return hasattr(system, "inertia") and hasattr(system, "d")


def cross(x: Sequence[Any], y: Sequence[Any]) -> list[Any]:
    """x × y, in the numbers of the components, which may be arrays."""
    return [x[i - 2] * y[i - 1] - x[i - 1] * y[i - 2] for i in range(3)]


def body_equations(inertia: Sequence[Any], d: Any) -> Callable[[Sequence[Any]], list[Any]]:
    """The ball's six equations as a function y ↦ ẏ of y = (γ1, γ2, γ3, M1, M2, M3).

    The function computes in the number type of ``inertia`` and ``d``.
    """
    i1, i2, i3 = inertia
    a1, a2, a3 = 1 / (i1 + d), 1 / (i2 + d), 1 / (i3 + d)
    q1, q2, q3 = i1 * a1, i2 * a2, i3 * a3

    def rates(y: Sequence[Any]) -> list[Any]:
        x1, x2, x3, m1, m2, m3 = y
        k1, k2, k3 = a1 * m1, a2 * m2, a3 * m3
        dn = d * (x1 * k1 + x2 * k2 + x3 * k3) / (q1 * x1 * x1 + q2 * x2 * x2 + q3 * x3 * x3)
        w1, w2, w3 = k1 + dn * a1 * x1, k2 + dn * a2 * x2, k3 + dn * a3 * x3
        return [
            x2 * w3 - x3 * w2,
            x3 * w1 - x1 * w3,
            x1 * w2 - x2 * w1,
            m2 * w3 - m3 * w2,
            m3 * w1 - m1 * w3,
            m1 * w2 - m2 * w1,
        ]  # fmt: skip

    return rates
