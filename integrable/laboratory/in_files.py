"""The content of files about motions in the laboratory: quantities with their parts and units, and a description of the
body.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from integrable.files.frame import Column
from integrable.files.quantities import AXES, Quantity, checked, columns, made_of

__all__ = ["about_body", "columns_of", "usual"]

SPACE = ("x", "y", "z")
QUANTITIES = {
    "quaternion": Quantity("component", ("w", *SPACE), "1", "rotation from the axes of the tensor to the laboratory"),
    "omega": Quantity("axis", SPACE, "rad s-1", "angular velocity in the axes of the laboratory"),
    "omega_body": Quantity("axis", AXES, "rad s-1", "angular velocity in the axes of the tensor"),
    "contact": Quantity("direction", SPACE[:2], "m", "point of contact in the laboratory"),
    "centre": Quantity("axis", SPACE, "m", "centre of the ball in the laboratory"),
}
"""The quantities of a run in the laboratory, by the names of the run's attributes."""


def usual(body: Any) -> tuple[str, ...]:
    """The quantities written by default."""
    return ("quaternion", "omega") if body.radius is None else ("quaternion", "omega", "contact")


def about_body(body: Any) -> dict[str, Any]:
    """A description of a motion of this body: numbers, strings and lists of numbers. Its entry "axes" has the principal
    axes, one after the other, in the axes of the tensor.
    """
    given = {"inertia": body.moments, "axes": np.ravel(body.axes.T)}
    given |= {name: x for name, x in (("mass", body.mass), ("radius", body.radius)) if x is not None}
    return made_of(body, given)


def columns_of(dims: tuple[str, ...], run: Any, quantities: Iterable[str] | None) -> dict[str, Column]:
    """Quantities of one run or of many, along ``dims``."""
    names = checked(quantities, QUANTITIES)
    return columns(dims, {name: getattr(run, name) for name in names}, QUANTITIES)
