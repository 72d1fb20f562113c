"""Methods for a motion in the laboratory: orientations of the principal axes, angular velocities, contact points.

At times of shape (N,) ``at`` gives the rotations from principal axes to the laboratory, (N, 3, 3), and ω along the
principal axes, (N, 3). ``contact`` gives the path of the point of contact from the start, (N, 2).
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.laboratory.tensor import cross
from integrable.motion.flow import Flow
from integrable.motion.symmetric import SymmetricFlow
from integrable.moving_point.arithmetic import LONG
from integrable.moving_point.setup import Setup
from integrable.phase.body import Body
from jacobian import RR
from jacobian.element import Real
from jacobian.fields.protocol import Field
from jacobian.immutable import replaced

if TYPE_CHECKING:
    from integrable.phase.state import State
    from integrable.phase.ways import Way


class WideFlow(Flow):
    """A flow whose torus or closed form is set up from numbers with more digits than its field has.

    Diagonalising a tensor and computing M from ω in floats would add rounding errors, whose effect grows with time.
    """

    def __init__(self, system: Any, state: State, wide_body: Body, wide_state: State) -> None:
        # the wide body and state are set first, since the base class may request the set-up
        self._wide_body, self._wide_state = wide_body, wide_state
        super().__init__(system, state)

    @cached_property
    def setup(self) -> Setup:
        """The set-up of the motion, made from the wide body and state."""
        body, state = self._wide_body, self._wide_state
        if self.system.field is not RR:
            return Setup(body, *state.vectors, state.tilted, self.system.field.dps)
        return Setup(Body(body.inertia, body.d, RR), *state.vectors, state.tilted)

    @cached_property
    def _closed(self) -> Way | None:
        if self.system.field is not RR or not self._equal:
            return super()._closed
        return SymmetricFlow(replaced(self.system, body=self._wide_body), self._wide_state)


class Uniform:
    """A motion with constant ω: rotation about a principal axis, any rotation of a body with three equal moments, or
    rest.
    """

    flow = None

    def __init__(self, field: Field, start: np.ndarray, omega: np.ndarray, radius: Real | None) -> None:
        """``start`` is the matrix from principal axes to the laboratory at time 0, ``omega`` is ω along these axes,
        both in wide numbers.
        """
        self._field, self._start, self._body = field, start, omega
        self._wide = omega[0].context
        self._space = start @ omega
        self._rate = self._wide.sqrt(omega @ omega)
        x, y, _ = self._space
        self._velocity = None if radius is None else np.array([radius * y, -radius * x])

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The rotations from principal axes to the laboratory, and ω along these axes."""
        field, start = self._field, self._start
        axis = self._space / self._rate if self._rate else self._space
        across = np.stack([cross(axis, column) for column in start.T], axis=1)
        along = np.outer(axis, axis @ start)
        c, s = (x[:, None, None] for x in self._circle(times))
        start, across, along, omega = (numbers(field, x) for x in (start, across, along, self._body))
        return c * (start - along) + s * across + along, np.broadcast_to(omega, (len(times), 3))

    def _circle(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Cosine and sine of the angle of rotation at ``times``."""
        wide = self._wide
        if self._field is not RR:
            angles = [self._rate * t for t in times]
            c, s = (np.array([f(x) for x in angles], dtype=object) for f in (wide.cos, wide.sin))
            return numbers(self._field, c), numbers(self._field, s)
        _, turns = LONG.turns_of(times, self._rate / (2 * wide.pi), wide.zero)
        angles = 2 * LONG.pi * turns
        return np.cos(angles).astype(float), np.sin(angles).astype(float)

    def contact(self, times: np.ndarray) -> np.ndarray:
        """The straight path of the point of contact."""
        return np.outer(times, numbers(self._field, self._velocity))


class Along:
    """A motion that a flow gives: γ and M are fixed in space, and their directions in the laboratory are known."""

    def __init__(self, flow: WideFlow, frame: np.ndarray) -> None:
        """``frame`` is the matrix, in wide numbers, from the axes of :attr:`Trajectory.attitude` to the laboratory."""
        self.flow, self._field = flow, flow.system.field
        self._frame = numbers(self._field, frame)

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The rotations from principal axes to the laboratory, and ω along these axes."""
        run = self.flow.at(times)
        return self._frame @ run.attitude, run.omega

    def contact(self, times: np.ndarray) -> Any:
        """The path of the flow, rotated into the laboratory."""
        return self.flow.at(times).contact @ self._frame[:2, :2].T


def numbers(field: Field, values: Any) -> np.ndarray:
    """The values as an array of numbers of ``field``."""
    return np.asarray(values).astype(float) if field is RR else np.frompyfunc(field.coerce, 1, 1)(values)
