"""A motion in the laboratory and its results at given times."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, overload

import numpy as np

from integrable.files.exported import Exported
from integrable.laboratory.ways import numbers
from integrable.phase import attitude
from jacobian import RR
from jacobian.element import File, Numbers, Real
from jacobian.errors import ArgumentError, NotRepresentable, chosen, one_or_more, several, shown, whole
from jacobian.immutable import Immutable, read_only, replaced

if TYPE_CHECKING:
    from collections.abc import Iterator

    from scipy.spatial.transform import Rotation

    from integrable.files.frame import Frame
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


class LaboratoryRun(Exported):
    """Orientations, angular velocities and points of contact at ``times``, shape (N,), in s; computed on first use.

    The arrays are of float64 over RR, and of mpf objects over MP(digits); all are read-only. ``run[k]`` is an
    :class:`Instant`; a slice, an array of indices or a Boolean mask gives the run at some of the times.
    """

    def __init__(self, motion: LaboratoryMotion, times: np.ndarray) -> None:
        self.motion, self.times = motion, times

    def __len__(self) -> int:
        return len(self.times)

    @overload
    def __getitem__(self, which: int | np.integer) -> Instant: ...

    @overload
    def __getitem__(self, which: slice | Sequence[int] | np.ndarray) -> LaboratoryRun: ...

    def __getitem__(self, which: object) -> Instant | LaboratoryRun:
        if not several(which):
            row = whole(which, "row", f"the rows are 0 … {len(self) - 1}", -len(self), len(self) - 1)
            contact = None if self.motion._contact is None else self.contact[row]
            return Instant(self.times[row], self.matrices[row], self.omega[row], contact)
        places = np.arange(len(self))[chosen(which, len(self))]
        found = {"_found": tuple(part[places] for part in self._found)} if "_found" in vars(self) else {}
        return replaced(self, times=self.times[places], **found)

    def __iter__(self) -> Iterator[Instant]:
        return map(self.__getitem__, range(len(self)))

    def concatenated(self, *others: LaboratoryRun) -> LaboratoryRun:
        """The run at these times and then at the times of the ``others``, which must be runs of the same motion."""
        for other in others:
            if not isinstance(other, LaboratoryRun) or other.motion != self.motion:
                raise ArgumentError(f"others: {shown(other)} given; runs of the same motion are needed")
        every = (self, *others)
        return replaced(
            self,
            times=np.concatenate([run.times for run in every]),
            _found=tuple(np.concatenate(parts) for parts in zip(*(run._found for run in every), strict=True)),
        )

    @property
    def _usual(self) -> tuple[str, ...]:
        from integrable.laboratory.in_files import usual

        return usual(self.motion.body)

    def _frame(self, quantities: Iterable[str]) -> Frame:
        from integrable.files.frame import Column, Frame
        from integrable.laboratory.in_files import about_body, columns_of

        time = Column(("time",), self.times, "s", "physical time t")
        return Frame(("time",), {"time": time}, columns_of(("time",), self, quantities), about_body(self.motion.body))

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
    def _found(self) -> tuple[np.ndarray, np.ndarray]:
        matrices, omega = self.motion._way.at(self.times)
        body = self.motion.body
        axes, field = body._principal.axes, body.field
        # usually the principal axes are the axes of the tensor, and no product is needed
        if (axes == np.eye(3)).all():
            return numbers(field, matrices), numbers(field, omega)
        axes = numbers(field, axes)
        return numbers(field, matrices) @ axes.T, numbers(field, omega) @ axes.T

    @cached_property
    def matrices(self) -> np.ndarray:
        """Rotations from the axes of the tensor to the laboratory, shape (N, 3, 3)."""
        return read_only(self._found[0])

    @property
    def orientation(self) -> Rotation:
        """The ``matrices`` as one Rotation of SciPy (the extra ``app``), in floats."""
        from integrable.extras import needed

        needed("scipy", "orientation, a Rotation,")
        from scipy.spatial.transform import Rotation

        return Rotation.from_matrix(self.matrices.astype(float))

    @cached_property
    def quaternion(self) -> np.ndarray:
        """The ``matrices`` as unit quaternions (w, x, y, z), shape (N, 4).

        The first has w ≥ 0; each later one has the sign that brings it closer to the previous one.
        """
        return read_only(going_on(attitude.quaternions(self.matrices)))

    @cached_property
    def omega(self) -> np.ndarray:
        """The angular velocity in the axes of the laboratory, shape (N, 3), in rad/s."""
        return read_only(np.einsum("nij,nj->ni", *self._found))

    @property
    def omega_body(self) -> np.ndarray:
        """The angular velocity in the axes of the tensor, shape (N, 3), in rad/s."""
        return read_only(self._found[1])

    @cached_property
    def contact(self) -> np.ndarray:
        """(x, y) of the point of contact in the laboratory, shape (N, 2), in m; NotRepresentable for a free body."""
        motion = self.motion
        if motion._contact is None:
            raise NotRepresentable(f"{shown(motion.body)} does not roll: it has no point of contact")
        field = motion.body.field
        path = numbers(field, motion._way.contact(self.times))
        return read_only(path + numbers(field, np.array(motion._contact, dtype=object)))

    @cached_property
    def centre(self) -> np.ndarray:
        """(x, y, z) of the centre of the ball, shape (N, 3), in m."""
        height = np.full((len(self), 1), self.motion.body.radius)
        return read_only(np.hstack([self.contact, height]))


def going_on(quaternions: np.ndarray) -> np.ndarray:
    """The given quaternions, shape (…, N, 4), with signs such that each quaternion is close to the previous one."""
    steps = np.sum(quaternions[..., 1:, :] * quaternions[..., :-1, :], axis=-1)
    turned = np.where(steps >= 0, 1, -1)
    signs = np.cumprod(np.concatenate([np.ones_like(quaternions[..., :1, 0], dtype=int), turned], axis=-1), axis=-1)
    return quaternions * signs[..., None]
