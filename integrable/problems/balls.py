"""The solution of a problem in ball arithmetic: midpoints and proven radii."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from integrable.phase.state import State
from integrable.problems.motion import Rows, UnitMotion
from jacobian.errors import ArgumentError
from jacobian.numbers.long_reals import BallReals

__all__ = ["enclosed"]

MORE = 20
"""Extra digits of midpoints: they then hold a double exactly, and their rounding is added to the radius."""


def enclosed(motion: UnitMotion, times: Sequence[float], digits: int) -> tuple[Rows, Rows]:
    """Rows of midpoints and rows of radii, as mpmath numbers; ``digits`` are relative to the sizes of q and p.

    Raises ArgumentError where |q| ≠ 1 and p or t scale with |q|, since the scaled start and times are then not exact.
    """
    scene, square = motion.scene, motion.square
    system = motion.system(digits + MORE)
    K, unit = system.field, motion.unit
    if square != 1 and unit is not None and (unit.p or unit.time):
        raise ArgumentError(
            f"proven = True: the start of {scene.name} has a length 1 + {float(square - 1) / 2:.1e}, and balls take "
            "length 1 only there; ask for an estimated radius"
        )
    q, p = (tuple(K.coerce(float(x)) for x in part) for part in (scene.gamma, scene.M))
    flow = system.motion_through(State(q, p, tilted=motion.tilted))
    found = flow.enclosure([K.coerce(t) for t in times], digits + 1)
    halves = (found.q, found.p) if scene.classical else (found.gamma, found.M)
    rows, radii = [], []
    with BallReals(K.context.prec) as reals:
        size = (reals.number(square.numerator) / reals.number(square.denominator)).sqrt()
        for first, second in zip(*halves, strict=True):
            balls = [*(x * size for x in first), *second] if square != 1 else [*first, *second]
            rows.append([_middle(K.context, x) for x in balls])
            radii.append([_radius(K.context, *pair) for pair in zip(balls, rows[-1], strict=True)])
    return rows, radii


def _middle(context: Any, x: Any) -> Any:
    """The midpoint of a ball, rounded."""
    mantissa, exponent = x.mid().man_exp()
    return context.ldexp(context.mpf(int(mantissa)), int(exponent))


def _radius(context: Any, ball: Any, middle: Any) -> Any:
    """An upper bound of the distance between any number in the ball and the ball's rounded midpoint."""
    mantissa, exponent = ball.rad().man_exp()
    return context.ldexp(context.mpf(int(mantissa)), int(exponent)) + 4 * abs(middle) * context.eps
