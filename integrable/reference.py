"""The oracles by the name they are documented under: :mod:`integrable.oracles.reference`."""

from integrable.oracles.reference import (
    Body,
    Solution,
    Start,
    body_equations,
    dop853,
    equations,
    is_body,
    odefun,
    right_hand_side,
    scipy_solution,
    taylor,
)

__all__ = [
    "Body",
    "Solution",
    "Start",
    "body_equations",
    "dop853",
    "equations",
    "is_body",
    "odefun",
    "right_hand_side",
    "scipy_solution",
    "taylor",
]
