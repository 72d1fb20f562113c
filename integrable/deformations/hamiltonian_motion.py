"""Portraits, certificates, enclosures, events and sensitivities of the motions of deformations."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

from integrable.motion.trajectory import Motion, Trajectory
from integrable.phase.state import onto_constraints, state_of_row
from integrable.phase.ways import rounded
from integrable.portrait.state_flow import StateFlow, largest_rate
from jacobian import RR, Field
from jacobian.element import Real
from jacobian.errors import NotRepresentable
from jacobian.inexact.long_field import LongField

if TYPE_CHECKING:
    import numpy as np

    from integrable.mumford.motion import Vectors
    from integrable.phase.enclosure import Enclosure
    from integrable.portrait.differences import Inputs
    from integrable.portrait.section import Section
    from integrable.portrait.spectrum import Spectrum
    from integrable.portrait.torus_portrait import TorusPortrait

# further digits of the frequencies, so that after section.MOST_CROSSINGS turns a time has all its digits
FAR_DIGITS = 8


class HamiltonianMotion(Motion, StateFlow[Trajectory]):
    """The base class of the motions of deformations, on elliptic curves or by integration."""

    _vectors, _unit = ("γ", "M"), 1

    def _enclosed(self, times: list[Real], digits: int, in_tau: bool) -> Enclosure:
        from integrable.deformations.enclosed import enclosed_states

        return enclosed_states(self.system, self.state, times, digits, in_tau)

    @cached_property
    def portrait(self) -> TorusPortrait:
        """The motion as a whole: frequencies, actions and angles of the separated variables ũ1 < ũ2, each of which
        turns in an oval (:mod:`integrable.portrait.torus_portrait`).

        NotRepresentable for an integrated motion, PrecisionLoss next to a separatrix.
        """
        from integrable.portrait.torus_portrait import TorusPortrait

        return TorusPortrait(self)

    def spectrum(self) -> Spectrum:
        """The spectral lines of γ, M and Ω = ½∂H/∂M of a motion in repelling poles, in floats
        (:mod:`integrable.portrait.spectrum`).

        NotRepresentable for any other motion and over MP(digits). PrecisionLoss if a grid on the torus would be too
        fine: poles weak compared with M² let the ovals of ũ1 and ũ2 come close. Without a potential
        these share an end: the torus has a point at which M is infinite, and the lines do not decay.
        """
        _ = self.portrait
        raise NotRepresentable(
            f"spectrum: without a potential the motions of {self.system!r} come near a point of their torus at which M "
            "is infinite, so their lines do not decay"
        )

    def section(self, count: int, oval: int = 0, end: str = "lower") -> Section:
        """The next ``count`` states with ũ1 (``oval`` 0) or ũ2 (1) at the "lower" or the "upper" end of its oval.

        Without a potential a component of γ × M vanishes there. NotRepresentable if ũ_k rests; other errors are those
        of :attr:`portrait`. (:mod:`integrable.portrait.section`)
        """
        from integrable.portrait.section import Section, end_of_oval, turned
        from integrable.portrait.torus_portrait import phases_of

        oval, half = end_of_oval(oval, end, 2)

        def read(torus: Any) -> list[list[Real]]:
            rows = torus.tau_frequencies, torus.phases
            return [[s * x for s, x in zip(torus.signs, row, strict=True)] for row in rows]

        # a point rests to the digits of the field, and may move to more digits
        self._settled(lambda torus: phases_of(torus, "section"))
        motion: Any = self._settled(read, FAR_DIGITS)
        with LongField(motion[0][0].precision):
            tau, theta, rotation = turned(count, oval, half, motion)
        return Section(self.at_tau(rounded(self.system.field, tau)), theta, rotation)

    def _settled_on_torus(self, read: Callable[[Any], Vectors]) -> list[list[Real]]:
        """The result of ``read`` for the torus of the motion, to the digits of the field."""
        return [rounded(self.system.field, row).tolist() for row in self._settled(read)]

    def _settled(self, read: Callable[[Any], Vectors], more: int = 0) -> Vectors:
        """The result of ``read`` for the torus of the motion, in long numbers with ``more`` digits than the field."""
        raise NotRepresentable(
            f"portrait, spectrum, section, secular: this motion of {self.system!r} is integrated: no torus is known"
        )

    @property
    def _numbers(self) -> tuple[Real, ...]:
        return *self.state.row, *self.system.constants

    def _through(self, numbers: Iterable[Real], field: Field) -> Self:
        values = [*map(field.coerce, numbers)]
        system = self.system._of_constants(field, values[6:])
        return type(self)(system, onto_constraints(system, state_of_row(values[:6])))

    def _inputs(self) -> tuple[Inputs, tuple[str, ...]]:
        from integrable.portrait.differences import Inputs
        from integrable.portrait.sensitivity import COLUMNS

        system, M = self.system, float(max(map(abs, self.state.vectors[1])))
        # a body at rest gives no unit of M; the fastest rate that the potential causes gives one
        M = M or (self._fastest or 1.0) / float(max(system.a)) ** system.degree
        terms = () if system.potential is None else ("a", "b", "b1", "b2", "b3")
        # a constant that is 0 is no input: other values would add a term to the equations
        sizes = (1, 1, 1, M, M, M, *map(abs, system.constants))
        names = zip((*COLUMNS, *terms, *system.further), sizes, strict=True)
        return Inputs(self._numbers, sizes), tuple(name for name, size in names if size)

    # γ is a unit vector, and M is orthogonal to it
    _dimensions = 6, 4

    def _secular(self, times: np.ndarray) -> np.ndarray:
        if self.system.body.rolls:
            raise NotRepresentable(f"secular: phases of {self.system!r} are not linear in t, as d ≠ 0; take matrix")
        return super()._secular(times)

    @property
    def _fastest(self) -> float:
        floats = self._through(self._numbers, RR)
        return largest_rate([floats.system.linearized(floats.state)])
