"""Derivatives of states by differences of whole motions in more digits: over MP(digits), and for floats without a
torus.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, log10

import numpy as np

from integrable.phase.body import Body, cross
from integrable.phase.state import State
from jacobian import MP
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.progress import Progress

FlowMap = Callable[[Body, State], np.ndarray]
"""A function of a body and a state that returns γ and M at the times, shape (N, 6)."""

# GUARD digits are added to those lost to the step and the derivatives; at most ATTEMPTS attempts are made if
# derivatives are larger than expected
GUARD, ATTEMPTS = 8, 6
# number of motions: two for each of nine directions; a top needs three for the direction of d
MOTIONS = 18
# weights of the three values of a one-sided quotient of second order
ONE_SIDED = (-3, 4, -1)


def differences(motion: FlowMap, body: Body, state: State, digits: int, size: float) -> np.ndarray:
    """The derivatives ∂(γ, M)/∂(γ(0), M(0), I, d), (N, 6, 10), in mpf to ``digits``; ``size`` estimates the largest.

    They are central differences with a step small enough for that many digits. PrecisionLoss where the derivatives are
    much larger than expected.
    """
    for _ in range(ATTEMPTS):
        large = max(0, ceil(log10(size)))
        step = digits // 2 + 1 + large
        K = MP(digits + step + large + GUARD)
        found = _quotients(motion, body, state, K, K.coerce(10) ** -step)
        largest = float(abs(found).max())
        if largest <= 10 * size:
            return found
        size = largest
    raise PrecisionLoss(f"sensitivity: derivatives of {size:.0e} and more next to a separatrix; ask for earlier times")


def _quotients(motion: FlowMap, body: Body, state: State, K: MultiprecisionField, step: Real) -> np.ndarray:
    numbers = _numbers(body, state, K)
    gamma, M = numbers[:3], numbers[3:6]
    progress = Progress(f"sensitivity, by differences of motions in {K.dps} digits", MOTIONS)

    def rows(shift: np.ndarray) -> np.ndarray:
        found = motion(*_inputs(numbers + shift, K))
        progress.add(1)
        return found

    scales = np.array([1] * 3 + [K.sqrt(M @ M)] * 3 + [min(body.inertia) + body.d] * 4, dtype=object)
    columns = []
    for k, direction in enumerate(_directions(K, gamma)):
        shift = step * scales[direction != 0][0] * direction
        size = 2 * step * scales[direction != 0][0]
        if k == 8 and not body.rolls:
            # this quotient is one-sided, since there is no body with d < 0
            values = (rows(n * shift) for n in range(3))
            columns.append(sum(w * x for w, x in zip(ONE_SIDED, values, strict=True)) / size)
        else:
            columns.append((rows(shift) - rows(-shift)) / size)
    first, second = (v[:3] for v in _directions(K, gamma)[:2])
    tangents = [columns[0] * first[i] + columns[1] * second[i] for i in range(3)]
    return np.stack([*tangents, *columns[2:]], axis=2)


def inputs_over(K: MultiprecisionField, body: Body, state: State) -> tuple[Body, State]:
    """A body and a state in a field of more digits."""
    return _inputs(_numbers(body, state, K), K)


def _numbers(body: Body, state: State, K: MultiprecisionField) -> np.ndarray:
    """The ten numbers γ (normalized), M, I and d, in K."""
    found = np.array([K.coerce(x) for x in (*state.row, *body.inertia, body.d)], dtype=object)
    found[:3] /= K.sqrt(found[:3] @ found[:3])
    return found


def _inputs(numbers: np.ndarray, K: MultiprecisionField) -> tuple[Body, State]:
    g1, g2, g3 = numbers[:3] / K.sqrt(numbers[:3] @ numbers[:3])
    m1, m2, m3, i1, i2, i3, d = numbers[3:]
    return Body.make((i1, i2, i3), d, K), State((g1, g2, g3), (m1, m2, m3), tilted=True)


def _directions(K: MultiprecisionField, gamma: np.ndarray) -> list[np.ndarray]:
    """Nine directions of ten numbers each: two unit vectors orthogonal to γ, then unit vectors of M, I and d."""
    axis = min(range(3), key=lambda i: abs(gamma[i]))
    unit = [K.one * (i == axis) for i in range(3)]
    first = np.array(cross(K, tuple(gamma), (unit[0], unit[1], unit[2])), dtype=object)
    first = first / K.sqrt(first @ first)
    second = np.array(cross(K, tuple(gamma), tuple(first)), dtype=object)
    rest = [K.zero] * 7
    found = [np.array([*v, *rest], dtype=object) for v in (first, second)]
    return found + [np.array([K.one * (i == k) for i in range(10)], dtype=object) for k in range(3, 10)]
