"""A motion in the laboratory and its results at given times."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from integrable.extras import needed
from integrable.files.exported import Exported
from integrable.files.frame import Column, Frame
from integrable.laboratory.in_files import about_body, columns_of, usual
from integrable.laboratory.ways import numbers
from integrable.phase import attitude
from integrable.phase.run import Items
from jacobian import RR
from jacobian.element import File, Numbers, Real
from jacobian.errors import ArgumentError, NotRepresentable, one_or_more, shown
from jacobian.immutable import Immutable, read_only

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

    from integrable.laboratory.fit import OrientationFit
    from integrable.portrait.portrait import Portrait


class LaboratoryMotion(Immutable):
    """The motion of a ``body`` from its start. Get one from ``body.motion(...)``.

    ``flow`` is the :class:`integrable.motion.flow.Flow` that gives the motion, or None where ω is constant. For a ball
    with vertical M it is the flow of the free body that turns as the ball does.
    """

    def __init__(self, body: Any, start: np.ndarray, spin: np.ndarray, contact: Any) -> None:
        """``start`` is the matrix from principal axes to the laboratory, ``spin`` is ω along these axes, both in wide
        numbers.
        """
        self.body, self._start, self._spin, self._contact = body, start, spin, contact
        # the flow is made here, so that a refusal is raised at once
        self.flow = self._way.flow

    @cached_property
    def _way(self) -> Any:
        return self.body._way(self._start, self._spin)

    def _value(self) -> tuple[object, ...]:
        return self.body, tuple(self._start.ravel().tolist()), tuple(self._spin.tolist()), self._contact

    def at(self, times: Numbers) -> LaboratoryRun:
        """The motion at times in s, in any order, of any sign and size, shape (N,).

        PrecisionLoss if floats do not suffice at one of the times.
        """
        field = self.body.field
        items = [field.coerce(t, f"times[{i}]") for i, t in enumerate(one_or_more(times, "times"))]
        return LaboratoryRun(self, np.array(items, dtype=float if field is RR else object))

    @property
    def portrait(self) -> Portrait:
        """Frequencies and mean rates of :attr:`flow`; NotRepresentable where ω is constant."""
        if self.flow is None:
            raise NotRepresentable("portrait: ω is constant here, there is no flow")
        portrait: Portrait = self.flow.portrait
        return portrait

    def fitted(self, times: Numbers, orientations: Iterable[object]) -> OrientationFit:
        """The motion of a free body nearest to orientations measured at ``times``, found from this motion as the guess.
        Its start and the ratios of its moments are fitted, not its axes (SciPy; :mod:`integrable.laboratory.fit`).

        ``orientations`` are matrices, shape (N, 3, 3), or a Rotation of SciPy with N entries. The guess must be less
        than half a turn off at every time.
        """
        from integrable.laboratory.fit import fitted

        return fitted(self, times, orientations)

    def __repr__(self) -> str:
        return f"<motion of {self.body!r}>"


class Instant(NamedTuple):
    """A motion in the laboratory at one ``time``: ``matrix`` (3, 3) from the axes of the tensor to the laboratory,
    ``omega`` (3,) in the axes of the laboratory, ``contact`` (2,), None for a free body.
    """

    time: Real
    matrix: np.ndarray
    omega: np.ndarray
    contact: np.ndarray | None


class Orientations(Exported):
    """Orientations and angular velocities of a ``_body`` at N times: of one motion, or of K motions together, whose
    arrays have a first dimension of length K.
    """

    _rows: np.ndarray
    """The nine entries of each orientation, and ω in the axes of the tensor, side by side: shape (…, N, 12)."""

    @property
    def _body(self) -> Any:
        """The body that moves."""
        raise NotImplementedError

    def _path(self) -> np.ndarray:
        """The points of contact of a ball."""
        raise NotImplementedError

    @property
    def _usual(self) -> tuple[str, ...]:
        return usual(self._body)

    @property
    def matrices(self) -> np.ndarray:
        """Rotations from the axes of the tensor to the laboratory, shape (…, N, 3, 3)."""
        return self._rows[..., :9].reshape(*self._rows.shape[:-1], 3, 3)

    @property
    def orientation(self) -> Rotation:
        """The ``matrices`` as one Rotation of SciPy (the extra ``app``), in floats; of several motions, one after the
        other.
        """
        needed("scipy", "orientation, a Rotation,")
        from scipy.spatial.transform import Rotation

        return Rotation.from_matrix(self.matrices.reshape(-1, 3, 3).astype(float))

    @cached_property
    def quaternion(self) -> np.ndarray:
        """The ``matrices`` as unit quaternions (w, x, y, z), shape (…, N, 4).

        The first of a motion has w ≥ 0; each later one has the sign that brings it closer to the previous one.
        """
        found = attitude.quaternions(self.matrices.reshape(-1, 3, 3))
        return read_only(going_on(found.reshape(*self._rows.shape[:-1], 4)))

    @cached_property
    def omega(self) -> np.ndarray:
        """The angular velocity in the axes of the laboratory, shape (…, N, 3), in rad/s."""
        flat = self._rows.reshape(-1, 12)
        found = np.einsum("nij,nj->ni", flat[:, :9].reshape(-1, 3, 3), flat[:, 9:])
        return read_only(found.reshape(*self._rows.shape[:-1], 3))

    @property
    def omega_body(self) -> np.ndarray:
        """The angular velocity in the axes of the tensor, shape (…, N, 3), in rad/s."""
        return self._rows[..., 9:]

    @cached_property
    def contact(self) -> np.ndarray:
        """(x, y) of the points of contact in the laboratory, shape (…, N, 2), in m; NotRepresentable for a free
        body.
        """
        if self._body.radius is None:
            raise NotRepresentable(f"{shown(self._body)} does not roll: it has no point of contact")
        return read_only(self._path())

    @cached_property
    def centre(self) -> np.ndarray:
        """(x, y, z) of the centres of the balls, shape (…, N, 3), in m."""
        return read_only(np.concatenate([self.contact, self._body.radius + 0 * self.contact[..., :1]], axis=-1))


class LaboratoryRun(Orientations, Items[Instant]):
    """Orientations, angular velocities and points of contact at ``times``, shape (N,), in s; computed on first use.

    The arrays are of float64 over RR, and of mpf objects over MP(digits); all are read-only. ``run[k]`` is an
    :class:`Instant`; a slice, an array of indices or a Boolean mask gives the run at some of the times.
    """

    _arrays = "times", "_rows"

    def __init__(self, motion: LaboratoryMotion, times: np.ndarray) -> None:
        self.motion, self.times = motion, times

    @property
    def _body(self) -> Any:
        return self.motion.body

    def _one(self, row: int) -> Instant:
        contact = None if self.motion._contact is None else self.contact[row]
        return Instant(self.times[row], self.matrices[row], self.omega[row], contact)

    def concatenated(self, *others: LaboratoryRun) -> LaboratoryRun:
        """The run at these times and then at the times of the ``others``, which must be runs of the same motion."""
        for other in others:
            if not isinstance(other, LaboratoryRun) or other.motion != self.motion:
                raise ArgumentError(f"others: {shown(other)} given; runs of the same motion are needed")
        return self._joined(others)

    def _frame(self, quantities: Iterable[str]) -> Frame:
        time = Column(("time",), self.times, "s", "physical time t")
        return Frame(("time",), {"time": time}, columns_of(("time",), self, quantities), about_body(self._body))

    def animate(self, path: File, fps: int = 25) -> None:
        """Write a moving picture of the run, a frame for each time, to ``path``, a .gif or (with ffmpeg) .mp4.

        It shows the body as it turns with ω, γ on its sphere in the axes of the tensor, and the path of a ball's point
        of contact. Needs the extra ``app``; the file appears when it is complete.
        """
        from integrable.laboratory.animation import animate

        animate(self, path, fps)

    def _repr_html_(self) -> str:
        from jacobian.notebook import table

        heads = ["t, s", "q0", "q1", "q2", "q3", "ω1, rad/s", "ω2", "ω3"]
        parts = [self.times[:, None], self.quaternion, self.omega]
        if self.motion._contact is not None:
            heads, parts = [*heads, "x, m", "y"], [*parts, self.contact]
        return table(repr(self), heads, np.hstack(parts).tolist())

    def __repr__(self) -> str:
        return f"<{len(self)} times of {self.motion!r}>"

    @cached_property
    def _rows(self) -> np.ndarray:  # type: ignore[override]
        matrices, omega = self.motion._way.at(self.times)
        axes, field = self._body._principal.axes, self._body.field
        matrices, omega = numbers(field, matrices), numbers(field, omega)
        # usually the principal axes are the axes of the tensor, and no product is needed
        if not (axes == np.eye(3)).all():
            axes = numbers(field, axes)
            matrices, omega = matrices @ axes.T, omega @ axes.T
        return read_only(np.hstack([matrices.reshape(-1, 9), omega]))

    def _path(self) -> np.ndarray:
        motion, field = self.motion, self._body.field
        origin = numbers(field, np.array(motion._contact, dtype=object))
        path: np.ndarray = numbers(field, motion._way.contact(self.times)) + origin
        return path


def going_on(quaternions: np.ndarray) -> np.ndarray:
    """The given quaternions, shape (…, N, 4), with signs such that each quaternion is close to the previous one."""
    steps = np.sum(quaternions[..., 1:, :] * quaternions[..., :-1, :], axis=-1)
    turned = np.where(steps >= 0, 1, -1)
    signs = np.cumprod(np.concatenate([np.ones_like(quaternions[..., :1, 0], dtype=int), turned], axis=-1), axis=-1)
    return quaternions * signs[..., None]
