"""States with proven bounds: the results of enclosures, and functions shared by all motions."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from integrable.phase.precisions import FLOAT_DIGITS
from jacobian import RR
from jacobian.element import Real
from jacobian.errors import whole
from jacobian.fields.multiprecision import MOST_DIGITS
from jacobian.immutable import Record
from jacobian.numbers.long_reals import BallReals

Row = tuple[Any, Sequence[Any], Sequence[Any], float]
"""One row: τ, the two vectors of a state, and the largest radius."""


class BallRows(Record):
    """States at ``times`` as balls (``flint.arb``): the base class for bodies and for systems of any genus.

    ``tau`` and ``times`` have shape (N,). ``radius``, shape (N,), is the largest radius in each row, relative to the
    size of its vector, as a float rounded up and at least 2.2e-308.
    """

    _names: ClassVar[tuple[str, str]]
    """The names of the two vectors of a state; each has ``size`` numbers."""

    def __init__(self, times: Any, rows: Sequence[Row], size: int = 3) -> None:
        self.size = size
        self.times = None if times is None else _array(times)
        self.tau = _array([row[0] for row in rows])
        for k, name in enumerate(self._names, 1):
            setattr(self, name, np.array([row[k] for row in rows], dtype=object).reshape(len(rows), size))
        self.radius = np.array([row[3] for row in rows], dtype=float)

    def __len__(self) -> int:
        return len(self.tau)

    def _value(self) -> tuple[object, ...]:
        # flint's balls are equal only if they are points, and cannot be pickled
        columns = (self.times, self.tau, *(getattr(self, name) for name in self._names))
        balls = (None if a is None else tuple(map(_ends, a.ravel())) for a in columns)
        return (self.size, *balls, tuple(self.radius.tolist()))

    def __reduce__(self) -> tuple[object, ...]:
        return _rebuilt, (type(self), *self._value())


class Enclosure(BallRows):
    """Balls that contain the motion of a body: ``gamma`` and ``M`` of shape (N, 3).

    ``times`` is None where τ was given and d ≠ 0; radii of M are relative to |M|.
    """

    _names = ("gamma", "M")
    gamma: np.ndarray
    M: np.ndarray


class EnclosedPath(BallRows):
    """Balls that contain the motion of a system of any genus: ``q`` and ``p`` of shape (N, n).

    Radii are relative to the largest number of q, or of p, at the start or at that time.
    """

    _names = ("q", "p")
    q: np.ndarray
    p: np.ndarray


def ball_digits(field: Any, digits: int | None) -> int:
    """``digits``, checked, or the default number of digits of balls: that of the field, 15 for RR."""
    if digits is None:
        return FLOAT_DIGITS if field == RR else int(field.dps)
    return whole(digits, "digits", f"the balls' digits are an int ≥ 1, {MOST_DIGITS} at most", 1, MOST_DIGITS)


def exact_times(times: Sequence[Real]) -> list[Real]:
    """The given times as balls of radius 0."""
    return list(BallReals(64).row(float(t) if isinstance(t, float) else t for t in times))


def is_bounded(values: Sequence[Any]) -> bool:
    """Whether every ball has a finite radius."""
    return all(x.is_finite() for x in values)


def widest(*vectors: tuple[Sequence[Real], Real]) -> Real:
    """An upper bound of the largest radius of the balls in (vector, size) pairs, each relative to its size. NaN if a
    radius is not finite.
    """
    from flint import arb

    found = [x / size for vector, size in vectors for x in vector]
    return max(x.rad() for x in found).abs_upper() if is_bounded(found) else arb("nan")


def rounded_up(radius: Real) -> float:
    """The radius rounded up to a float."""
    return max(float(radius) * (1 + 2.0**-50), sys.float_info.min)


def _ends(ball: Any) -> tuple[Any, ...]:
    """The midpoint and the radius of a ball, each as mantissa and exponent."""
    return tuple(tuple(map(int, x.man_exp())) for x in (ball.mid(), ball.rad()))


def _ball(flint: Any, middle: Any, radius: Any) -> Any:
    """The ball with the midpoint and radius of :func:`_ends`. flint rounds every given radius up to 30 bits."""
    mantissa, exponent = radius
    shift = 30 - mantissa.bit_length()
    for less in (1, 0):
        ball = flint.arb(middle, flint.arb(((mantissa << shift) - less, exponent - shift))) if mantissa else None
        if ball is not None and ball.rad() == flint.arb(radius):
            return ball
    return flint.arb(middle, flint.arb(radius))


def _rebuilt(kind: Any, size: int, times: Any, tau: Any, first: Any, second: Any, radius: Any) -> Any:
    import flint

    def balls(values: Any) -> list[Any]:
        with BallReals(64).at(max((m.bit_length() for (m, _), _ in values), default=1) + 64):
            return [_ball(flint, *value) for value in values]

    vectors = (zip(*[iter(balls(values))] * size, strict=True) for values in (first, second))
    rows = list(zip(balls(tau), *vectors, radius, strict=True))
    return kind(None if times is None else balls(times), rows, size)


def _array(values: list[Any]) -> np.ndarray:
    result = np.empty(len(values), dtype=object)
    result[:] = values
    return result
