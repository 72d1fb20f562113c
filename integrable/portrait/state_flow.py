"""Certificates, enclosures, events and sensitivities, by the same code for bodies and for systems of any genus."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

import numpy as np

from integrable.phase.enclosure import ball_digits
from integrable.phase.ways import times_in
from jacobian.errors import PrecisionLoss
from jacobian.immutable import replaced

if TYPE_CHECKING:
    from integrable.phase.enclosure import Enclosure
    from integrable.phase.run import Run
    from integrable.portrait.certificate import Pairs
    from integrable.portrait.differences import Inputs
    from integrable.portrait.events import Condition
    from integrable.portrait.sensitivity import Sensitivity
    from jacobian.element import Number, Numbers, Real
    from jacobian.fields.multiprecision import MultiprecisionField
    from jacobian.fields.protocol import Field

    AnyRun = TypeVar("AnyRun", bound=Run[Any])
else:
    AnyRun = TypeVar("AnyRun")


# a panel of a search for events lasts PANEL_TURN divided by the fastest of the rates at PROBES times, so that its nodes
# resolve both vectors and their products
PANEL_TURN, PROBES = 6.0, 8


class StateFlow(Generic[AnyRun]):
    """The motion of one state; the base of :class:`integrable.motion.flow.Flow`, of the motions of deformations and of
    :class:`integrable.mumford.flow.MumfordFlow`. A state consists of two vectors: γ and M, or q and p.
    """

    system: Any
    _vectors: ClassVar[tuple[str, str]] = ("q", "p")
    """The names of both vectors, for messages."""
    _unit: ClassVar[int | None] = None
    """The number to which errors of the first vector are relative; None if they are relative to its largest component.
    """

    def __repr__(self) -> str:
        return f"<motion of {self.system!r}>"

    def at(self, times: Numbers) -> AnyRun:
        """The states at times."""
        raise NotImplementedError

    def certify(self, times: Numbers, digits: int | None = None) -> AnyRun:
        """The states of :meth:`at`, each compared with that of a run with 15 more digits; for RR, with 30 digits.

        The result has ``error`` and ``digits``, the number of decimal digits that agree, both of shape (N,). The error
        of a state is the larger one of the errors of its two vectors. Errors of M, q and p are relative to the largest
        component of the vector. The inputs count as exact, except that states are projected onto their constraints.
        PrecisionLoss where fewer than ``digits`` agree: by default 12 over RR, one less than the field's own over MP.
        ``certify`` compares two computations; ``enclosure`` has proven bounds.
        """
        from integrable.portrait.certificate import agreement

        run = self.at(times)
        error, agreeing = agreement(self.system.field, run, self._finer, digits, self._unit)
        return replaced(run, error=error, digits=agreeing)

    def enclosure(self, times: Numbers, digits: int | None = None) -> Enclosure:
        """Proven bounds of the states at times: balls of radius at most 10^(−digits) that contain them.

        The radius of γ is relative to 1, that of M to |M| at the start, that of q or p to its largest component at the
        start or at that time. The inputs count as exact, except that states are projected onto their constraints.
        ``digits`` defaults to those of the field, 15 for RR. For a ball or a deformation the cost grows with the time;
        otherwise a far time costs only more bits. PrecisionLoss if no such balls are found; ArgumentError if the clock
        has no bounds; Infeasible for a deformation after 4,000 steps. (:mod:`integrable.motion.enclosure`,
        :mod:`integrable.deformations.enclosed`, :mod:`integrable.mumford.enclosure`)
        """
        K = self.system.field
        return self._enclosed(times_in(K, times, "times").tolist(), ball_digits(K, digits), in_tau=False)

    def enclosure_at_tau(self, tau: Numbers, digits: int | None = None) -> Enclosure:
        """:meth:`enclosure` at values of the flow's own time τ, by a few additions for any τ.

        ``times`` of the result is None if t is not linear in τ.
        """
        K = self.system.field
        return self._enclosed(times_in(K, tau, "tau").tolist(), ball_digits(K, digits), in_tau=True)

    def events(self, condition: Condition, start: Number, end: Number, direction: int = 0) -> AnyRun:
        """The states between two times at which ``condition`` changes sign, in order of time.

        ``condition`` takes both vectors, each of shape (N, n), and returns N numbers that depend smoothly on them:
        ``lambda q, p: q[:, 0]`` finds q_0 = 0, ``lambda gamma, M: gamma[:, 2]`` finds γ₃ = 0. ``direction`` 1 selects
        zeros at which the condition rises, −1 those at which it falls. Zeros without a change of sign may be missed.
        ArgumentError if ``end`` is not after ``start`` or values have another shape, PrecisionLoss for a condition that
        is not smooth, or if floats do not resolve the time; Infeasible for a search of more than ten million panels.
        (:mod:`integrable.portrait.events`)
        """
        from integrable.portrait.events import event_times

        return self.at(event_times(self, condition, start, end, direction))

    def sensitivity(self, times: Numbers) -> Sensitivity:
        """The derivatives of the states at the given times with respect to the start and to the constants and
        parameters of the system. All digits of the field are correct, relative to the largest element.

        ``matrix`` of the result has shape (N, 2n, 2n + m) for m constants; ``columns`` names the inputs. The start
        varies within its constraints. On the torus of a body the secular and periodic parts are separate. For a
        deformation without curves, or with d ≠ 0 where feasible, the equations of variation are integrated, and for a
        system of any genus over RR at times near the start. Otherwise derivatives are difference quotients of motions
        in more digits, two for each input, which take seconds over MP(digits) and next to a separatrix.

        A constant that is 0, so that a term of the equations is absent, has no column: a barrier l_i of a Hénon–Heiles
        system; d, c and the terms of the potential of a deformation. PrecisionLoss if derivatives are much larger than
        expected, as at far times next to a separatrix. (:mod:`integrable.portrait.sensitivity`)
        """
        from integrable.portrait.sensitivity import by_differences

        run = self.at(times)
        found = self._by_variations(run)
        return by_differences(self, run.times) if found is None else found

    # --- for subclasses

    def _enclosed(self, times: list[Real], digits: int, in_tau: bool) -> Enclosure:
        raise NotImplementedError

    def _states(self, times: Numbers) -> tuple[np.ndarray, np.ndarray]:
        run = self.at(times)
        return run.q, run.p

    def _finer(self, times: list[Real], K: MultiprecisionField) -> Pairs:
        """The states at times to the digits of K."""
        return zip(*self._over(K)._states(times), strict=True)

    def _over(self, field: Field) -> StateFlow[AnyRun]:
        """The same motion over another field, to which its numbers are converted."""
        return self if field == self.system.field else self._with(self._numbers, field)

    def _with(self, numbers: Iterable[Real], field: Field) -> StateFlow[AnyRun]:
        """:meth:`_through`, but the changed start obeys the constraints of this one: (γ, M) = 0 unless it is tilted."""
        return self._through(numbers, field)

    @property
    def _numbers(self) -> tuple[Real, ...]:
        """The numbers on which the motion depends: first those of its start."""
        raise NotImplementedError

    def _through(self, numbers: Iterable[Real], field: Field) -> StateFlow[AnyRun]:
        """The motion over ``field`` with these :attr:`_numbers`."""
        raise NotImplementedError

    def _inputs(self) -> tuple[Inputs, tuple[str, ...]]:
        """The :class:`Inputs` of the motion, and the names of those that have derivatives."""
        raise NotImplementedError

    def _by_variations(self, run: AnyRun) -> Sensitivity | None:
        """The sensitivity at the times of a run from the equations of variation; None if they are not used."""
        return None

    def _secular(self, times: np.ndarray) -> np.ndarray:
        """The part of the derivatives that grows in proportion to time, at the given times."""
        from integrable.portrait.growth import growth_on_torus

        return growth_on_torus(self, times)

    @property
    def _dimensions(self) -> tuple[int, int]:
        """The number of coordinates of a state, and how many of them are free of constraints."""
        raise NotImplementedError

    @property
    def _fastest(self) -> float:
        """The approximate fastest rate at which the state changes."""
        raise NotImplementedError

    def _panel(self, first: float, last: float) -> float:
        """The length of a panel of a search for events in an interval of time, so short that its nodes resolve the
        motion; for a flow over RR.
        """
        states = self.at(np.linspace(first, last, PROBES))
        fastest = largest_rate([self.system.linearized(state) for state in states])
        return float(min(last - first, PANEL_TURN / fastest)) if fastest else last - first


def largest_rate(matrices: Sequence[np.ndarray]) -> float:
    """The largest modulus of the eigenvalues of all matrices. PrecisionLoss if they are beyond the range of floats."""
    if not np.isfinite(matrices).all():
        raise PrecisionLoss("the rates of this motion are beyond the range of floats; use other units")
    return float(np.abs(np.linalg.eigvals(matrices)).max())
