"""Motions, and trajectories: the states of a motion at given times, with quantities that are computed on request."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from integrable.files.exported import Exported
from integrable.motion.refusals import Rows, common_reasons, kept_rows, refused_rows
from integrable.moving_point.setup import Setup
from integrable.phase.run import Run
from integrable.phase.state import State
from integrable.phase.ways import InOrder, Way, times_in
from jacobian import RR
from jacobian.element import Numbers, Real
from jacobian.errors import ArgumentError, NotRepresentable, PrecisionLoss, flag, shown
from jacobian.immutable import Immutable, at_once, read_only, replaced

if TYPE_CHECKING:
    from integrable.files.frame import Frame
    from integrable.motion.precise import RoundedRows
    from integrable.torus.access import TorusFlow

Times = np.ndarray[tuple[int], np.dtype[Any]]
"""Shape (N,)."""
VectorArray = np.ndarray[tuple[int, int], np.dtype[Any]]
"""Shape (N, 3), unless stated otherwise."""
Matrices = np.ndarray[tuple[int, int, int], np.dtype[Any]]
"""Shape (N, 3, 3)."""


NO_ROWS = np.empty(0, dtype=np.intp)
WAYS = {
    "closed form": "elliptic or elementary functions of a body with equal moments",
    "short run": "additions from the start on, with interpolation between them, in floats",
    "torus": "theta functions on the motion's torus, in floats",
    "multiprecision": "additions to as many digits as needed, over MP(digits) or rounded to floats",
    "elliptic curves": "an addition on each of the two curves of a deformation, to as many digits as needed",
    "integrated": "the equations of motion, by Taylor series",
    "steps": "a map applied again and again",
}
"""The values of :attr:`Trajectory.way` and their meaning."""


class Motion(Immutable):
    """The motion of ``system`` through ``state``, over RR or MP(digits): base of the flows of bodies
    (:class:`integrable.motion.flow.Flow`) and of deformations (:mod:`integrable.deformations.deformed_flow`), which
    list the ways to the states (:class:`integrable.phase.ways.Way`).
    """

    system: Any
    state: State
    method: ClassVar[str] = "divisor flow"
    """The name of the method, for tables."""

    @at_once
    def __init__(self, system: Any, state: State) -> None:
        vars(self).update(system=system, state=state)

    def at(self, times: Numbers, *, strict: bool = True) -> Trajectory:
        """The states at physical times t, in any order, of any sign and size: a Trajectory of shape (N,).

        If a row cannot be computed, the call raises PrecisionLoss or Infeasible. With ``strict=False`` the other rows
        are kept; see :attr:`Trajectory.status` and :attr:`Trajectory.reasons`.
        """
        return self._run(times_in(self.system.field, times, "times"), flag(strict, "strict"), physical=True)

    def at_tau(self, tau: Numbers, *, strict: bool = True) -> Trajectory:
        """The states at values of the flow's own time τ, dτ = g dt (τ = t at d = 0); ``strict`` as for :meth:`at`."""
        return self._run(times_in(self.system.field, tau, "tau"), flag(strict, "strict"), physical=False)

    def physical_time(self, tau: Numbers) -> Times:
        """t(τ) = ∫_0^τ dτ/g for an array of τ."""
        given = times_in(self.system.field, tau, "tau")
        if not self.system.body.rolls:
            return given
        return InOrder(self._ways).first(lambda way: way.times(given))

    def _repr_html_(self) -> str:
        from jacobian.notebook import named

        return named(
            f"motion by {self.method}",
            [("system", self.system), *zip(("γ(0)", "M(0)"), self.state.vectors, strict=True)],
        )

    # --- for subclasses

    def _ways(self) -> Iterator[Way]:
        """The ways to the states in the order in which they are tried; the last one reaches all times or raises."""
        raise NotImplementedError

    def _prepare(self) -> None:
        """Creates the first way, so that its set-up can be timed separately."""
        next(self._ways())

    def _off(self, rows: np.ndarray, way: str) -> tuple[np.ndarray, str]:
        """(indices of the rows whose states are off the motion, what is wrong with the first of these rows)."""
        return NO_ROWS, ""

    def _contact_points(self, run: Trajectory) -> np.ndarray:
        """Raises NotRepresentable, because the system does not roll on a plane."""
        raise NotRepresentable(f"{self.system!r} is no body that rolls on a plane: it has no point of contact")

    def _kept(self, way: InOrder, given: np.ndarray, physical: bool, nan: Real) -> Rows:
        """The rows that ``way`` computes; rows that it refuses are set to ``nan``."""
        return kept_rows(lambda times: _computed(way, times, physical), given, nan)

    def _run(self, given: np.ndarray, strict: bool, physical: bool) -> Trajectory:
        way = InOrder(self._ways)
        times = given if physical or not self.system.body.rolls else None
        if strict:
            rows, tau = _computed(way, given, physical)
            off, why = self._off(rows, way.way)
            if len(off):
                raise PrecisionLoss(f"row {off[0]}: {why}")
            return Trajectory(self, times, tau, rows, way.way)
        nan = np.nan if self.system.field is RR else self.system.field.context.nan
        found = self._kept(way, given, physical, nan)
        had = np.arange(len(given)) if found.status is None else np.flatnonzero(found.status == 0)
        off, why = self._off(found.rows[had], way.way)
        found = refused_rows(found, dict.fromkeys(had[off].tolist(), why), nan)
        return Trajectory(
            self, times, found.tau if physical else given, found.rows, way.way, found.status, found.reasons
        )


def _computed(way: InOrder, values: np.ndarray, physical: bool) -> tuple[np.ndarray, np.ndarray]:
    if physical:
        return way.first(lambda way: way.at(values))
    return way.first(lambda way: way.at_tau(values)), values


class BodyMotion(Motion):
    """The attributes of a body's motion that give contact points: base of :class:`integrable.motion.flow.Flow`."""

    @cached_property
    def setup(self) -> Setup:
        """The data computed once for the motion, before its first state."""
        return Setup(self.system.body, *self.state.vectors, self.state.tilted)

    contact_on_torus: Any
    """The contact point as a series on the torus, or None where there is none."""
    _precise: RoundedRows
    _torus: TorusFlow | None


class Trajectory(Run[State], Exported):
    """States of a motion at given times; every quantity is computed on first use.

    ``run[k]`` is the State of a row, NotRepresentable if the row was refused; a slice or an array of indices or
    booleans gives a Trajectory.

    ``times`` has shape (N,), vectors (N, 3); floats give float64 arrays, multiprecision object arrays of mpf. ``tau``
    is the time of the flow, dτ = g dt. ``way`` names the method that computed the rows, by one of the names in
    :data:`WAYS`. ``reasons``: see :attr:`status`. ``report`` is the report of a scene's run, or None; ``error`` and
    ``digits`` are set by ``flow.certify``, otherwise None. Arrays are read-only; a ``.copy()`` is not.
    """

    flow: Any
    reasons: tuple[str, ...]
    report: Any
    _tau: np.ndarray
    # None if no row was refused
    _status: np.ndarray | None
    _arrays = *Run._arrays, "_tau", "_status"

    @at_once
    def __init__(
        self,
        flow: Any,
        times: np.ndarray | None,
        tau: np.ndarray,
        rows: np.ndarray,
        way: str,
        status: np.ndarray | None = None,
        reasons: tuple[str, ...] = ("",),
    ) -> None:
        if status is not None and not status.any():
            status = None
        # these arrays are never the user's own, so they can be set read-only
        for array in (times, tau, rows, status):
            if array is not None:
                array.setflags(write=False)
        # _rows are γ and M side by side, shape (N, 6)
        vars(self).update(
            flow=flow, _times=times, _tau=tau, _rows=rows, way=way, _status=status, reasons=reasons, report=None,
            error=None, digits=None,
        )  # fmt: skip

    def _one(self, row: int) -> State:
        if self._status is not None and self._status[row]:
            raise NotRepresentable(f"row {row} was refused: {self.reasons[self._status[row]]}")
        values = self._rows[row].tolist()
        return replaced(self.flow.state, vectors=(tuple(values[:3]), tuple(values[3:])))

    def concatenated(self, *others: Trajectory) -> Trajectory:
        """A Trajectory of the rows of this one and of ``others``, all of the same motion. Its ``way`` lists the ways of
        all rows.
        """
        every = (self, *others)
        for other in others:
            if not isinstance(other, Trajectory) or type(other.flow) is not type(self.flow):
                raise ArgumentError(f"others: {shown(other)} given; Trajectories of the same motion are needed")
            if other.system != self.system or other.flow.state != self.flow.state:
                raise ArgumentError(f"others: {other!r} given; the same system and the same start are needed")
        numbers, reasons = common_reasons([run.reasons for run in every])
        status = np.concatenate([mine[run.status] for mine, run in zip(numbers, every, strict=True)])
        times = None if all(run.given_in_tau for run in every) else np.concatenate([run.times for run in every])
        tau, rows = (np.concatenate([getattr(run, name) for run in every]) for name in ("tau", "_rows"))
        way = ", ".join(dict.fromkeys(word for run in every for word in run.way.split(", ")))
        return Trajectory(self.flow, times, tau, rows, way, status, reasons)

    def _frame(self, quantities: Iterable[str]) -> Frame:
        from integrable.files.quantities import trajectory_frame

        return trajectory_frame(self, quantities)

    def _some(self, places: np.ndarray) -> Self:
        found = replaced(super()._some(places), report=None)
        had = found._status is None or found._status.any()
        return found if had else replaced(found, _status=None, reasons=("",))

    def _value(self) -> tuple[object, ...]:
        if self._status is None:
            return super()._value()
        # refused rows are left out of the comparison, since NaN is not equal to itself
        asked = self._tau if self._times is None else self._times
        return *self.kept._value(), tuple(asked.tolist()), tuple(self._status.tolist()), self.reasons

    def __repr__(self) -> str:
        refused = "" if self._status is None else f", {np.count_nonzero(self._status)} of them refused"
        return f"<Trajectory of {len(self)} states of {self.system!r}{refused}>"

    def _repr_html_(self) -> str:
        from jacobian.notebook import table

        first, name = (self._tau, "τ") if self._times is None else (self._times, "t")
        rows = list(zip(first.tolist(), *self._rows.T.tolist(), strict=True))
        return table(f"{self!r}, {self.way}", [name, "γ1", "γ2", "γ3", "M1", "M2", "M3"], rows)

    @property
    def system(self) -> Any:
        """The system that moves."""
        return self.flow.system

    @property
    def status(self) -> Times:
        """The status of each row, shape (N,): 0 if it was computed; with ``strict=False`` n > 0 if it was refused for
        the reason ``reasons[n]``.

        γ and M of refused rows are NaN; quantities computed from them are refused (NotRepresentable): use :attr:`kept`.
        """
        return read_only(np.zeros(len(self), dtype=np.intp)) if self._status is None else self._status

    @property
    def kept(self) -> Self:
        """A Trajectory of the rows with status 0."""
        if self._status is None:
            return self
        return self._some(np.flatnonzero(self._status == 0))

    @cached_property
    def times(self) -> Times:
        """Physical times t, shape (N,); those of refused rows are NaN where only τ was given."""
        if self._times is not None:
            return self._times
        if self._status is None:
            return read_only(self.flow.physical_time(self.tau))
        times = np.full(len(self), self._rows[self._status > 0][0, 0], self.tau.dtype)
        times[self._status == 0] = self.kept.times
        return read_only(times)

    @property
    def tau(self) -> Times:
        """Values of the flow's own time τ, shape (N,)."""
        return self._tau

    @property
    def given_in_tau(self) -> bool:
        """Whether the states were requested at values of τ."""
        return self._times is None

    @property
    def gamma(self) -> VectorArray:
        """The vertical γ in the body frame, shape (N, 3)."""
        return self.q

    @property
    def M(self) -> VectorArray:
        """The angular momentum M in the body frame, about the contact point (top: centre of mass), shape (N, 3)."""
        return self.p

    @cached_property
    def omega(self) -> VectorArray:
        """The angular velocity ω in the body frame, γ̇ = γ × ω, shape (N, 3); ½∂H/∂M for a deformation."""
        self._check_kept("omega")
        return read_only(self.system._omega_along(self.gamma, self.M))

    @cached_property
    def attitude(self) -> Matrices:
        """Rotation matrices from the body frame to space, shape (N, 3, 3). Rows are the axes of space in the body
        frame: z = γ is vertical, and x points along the horizontal part of M, which is fixed in space
        (:mod:`integrable.phase.attitude`). NotRepresentable for a deformation, whose M is not fixed in space.
        """
        self._check_kept("attitude")
        return read_only(self.system._attitude_along(self.gamma, self.M))

    @cached_property
    def quaternion(self) -> VectorArray:
        """The rotations of :attr:`attitude` as unit quaternions (w, x, y, z) with w ≥ 0, shape (N, 4)."""
        from integrable.phase import attitude

        return read_only(attitude.quaternions(self.attitude))

    @cached_property
    def contact(self) -> VectorArray:
        """(x, y) of the point where the ball touches the plane, in the axes of :attr:`attitude`, shape (N, 2).

        It is (0, 0) at t = 0. The unit is that of the ball's radius, or the radius itself if d alone was given.
        NotRepresentable for a body that does not roll (:mod:`integrable.motion.contact`).
        """
        self._check_kept("contact")
        return read_only(self.flow._contact_points(self))

    @cached_property
    def integrals(self) -> Any:
        """The system's integrals along the run, each of shape (N,): C1, C2, H1, H2 of a body
        (:class:`integrable.phase.body.Integrals`), C1, C2, H, K of a deformation.
        """
        self._check_kept("integrals")
        values = self.system._integrals_along(self.gamma, self.M)
        return type(values)(*map(read_only, values))

    def _check_kept(self, name: str) -> None:
        """Raises NotRepresentable if rows were refused, because their NaN would pass comparisons silently."""
        if self.system.field.exact:
            raise NotRepresentable(f"{name}: along a run over RR or MP(digits), not over {self.system.field.name}")
        if self._status is not None:
            refused = np.flatnonzero(self._status)
            raise NotRepresentable(
                f"{name}: {len(refused)} of {len(self)} rows were refused, the first of them row {refused[0]}: "
                f"{self.reasons[self._status[refused[0]]]}; take .kept.{name}, of the other rows"
            )
