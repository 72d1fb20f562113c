"""Random starts in doubles that satisfy the constraints of a system exactly."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from integrable.problems.motion import UnitMotion
from jacobian.fields.rational import primitive

__all__ = ["another"]

SPREAD = 0.02
"""The relative change of a start without constraints: so small that bounded motions stay bounded."""
LARGEST = 64
"""With constraints the components of q are integers below this, times a power of two."""


def another(motion: UnitMotion, rng: np.random.Generator) -> list[float]:
    """A random start whose q and p have about the size of q and p at the start of ``motion``."""
    q, p = ([float(x) for x in part] for part in (motion.scene.gamma, motion.scene.M))
    unit = motion.unit
    if unit is None:
        return [x * (1 + SPREAD * rng.uniform(-1, 1)) for x in (*q, *p)]
    raw = [int(x) for x in rng.integers(1, LARGEST, len(q)) * rng.choice((-1, 1), len(q))]
    push = [int(x) for x in rng.integers(1, LARGEST, len(q)) * rng.choice((-1, 1), len(q))]
    if unit.normal or not (motion.scene.classical or motion.along):
        n = primitive(unit.dual(motion.weights, [Fraction(x) for x in raw]))
        push = [n[i - 2] * push[i - 1] - n[i - 1] * push[i - 2] for i in range(3)]
    length = (unit.square(motion.weights, raw) / motion.square) ** -0.5
    return [*_scaled(raw, float(length)), *_scaled(push, _size(p) / (_size(push) or 1.0))]


def _scaled(values: Sequence[int], factor: float) -> list[float]:
    """The integers ``values``, times the power of two closest to ``factor``."""
    return [x * 2.0 ** round(np.log2(factor)) for x in values]


def _size(values: Sequence[float]) -> float:
    return float(np.linalg.norm(np.array(values, dtype=float)))
