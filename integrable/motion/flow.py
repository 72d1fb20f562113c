"""The exact flow: time is addition on the Jacobian.

The divisor D(τ) of a motion obeys D(τ + δ) = D(τ) + T(δ), where the translation T(δ) depends on the curve only (Abel
quadratures; Tsiganov 2017, section 3). On a compact torus the state at any τ, or at any physical time t = ∫dτ/g, is
found from six short series (:mod:`integrable.torus.access`). Within a few turns of the start, a walk by Taylor series
(:mod:`integrable.motion.near`) or a short run (:mod:`integrable.motion.short`) computes the states without a torus.
Where floats or the torus do not suffice, and in multiprecision, states are computed with as many digits as they need
(:mod:`integrable.motion.precise`).
"""

from __future__ import annotations

import os
from functools import cached_property
from math import hypot
from typing import TYPE_CHECKING

import numpy as np

from integrable.motion.domain import check_domain
from integrable.motion.near import NearWalk
from integrable.motion.short import ShortRuns
from integrable.motion.trajectory import BodyMotion, Trajectory
from integrable.phase.body import Body, symmetry_axis
from integrable.phase.precisions import ROUNDED_TO_FLOATS
from integrable.phase.space import PhaseSpace
from integrable.phase.state import State, onto_constraints, rotation_axis, state_of_row
from integrable.phase.upright import leaning
from integrable.phase.ways import Cost, Way
from integrable.portrait.state_flow import StateFlow
from jacobian import RR
from jacobian.element import Number, Real
from jacobian.errors import ArgumentError, PrecisionLoss, one_of
from jacobian.immutable import at_once, quick_property, replaced
from jacobian.numbers.compiler import interpreted

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from integrable.motion.contact import PreciseContact
    from integrable.motion.precise import PreciseFlow, RoundedRows
    from integrable.phase.enclosure import Enclosure
    from integrable.portrait.certificate import Pairs
    from integrable.portrait.differences import Inputs
    from integrable.portrait.portrait import Portrait
    from integrable.portrait.section import BodySection
    from integrable.portrait.sensitivity import Sensitivity, TorusVariations
    from integrable.portrait.spectrum import Spectrum
    from integrable.torus.access import TorusFlow
    from integrable.torus.integrals import TorusIntegral
    from jacobian.fields.multiprecision import MultiprecisionField
    from jacobian.fields.protocol import Field

KERNELS = ("auto", "python", "compiled")
CHOOSE = f"choose one of {', '.join(map(repr, KERNELS))}"
# a state is refused if H1 or H2 differs from its value at the start by more than the fraction DRIFT; CHUNK states are
# compared at a time
DRIFT = 1e-9
CHUNK = 8192
# up to this many states plain floats are faster than arrays
FEW = 16
# without a torus in floats, t(τ) is integrated along the motion, from at most MOST_RATES values of 1/g; they take up
# to a second
MOST_RATES = 16_000
# with CLOCK_DIGITS digits of the clock, states in floats are accurate up to the farthest times that MOST_RATES values
# reach
CLOCK_DIGITS = 24
# A walk by Taylor series is tried first if it is short and cheap. Its cost is in microseconds, in the unit of
# integrable.series.steps.step_cost. Its length |M||t|/(I + d), with the least moment I, is in radians. A ball's walk
# takes as long as its short run at about 10 radians, a top's as long as its torus at about 200. Up to 300 the bound on
# the cost decides (python -m benchmarks near, short)
WALK_OF_BALL, WALK_OF_TOP = (Cost(30, 0), 10.0), (Cost(120, 0.3), 300.0)
# basic steps (Setup.step_time) per panel of a search for events, so few that the nodes of a panel resolve γ and M
PANEL_STEPS = 6


class Flow(BodyMotion, StateFlow[Trajectory]):
    """The motion through one state. Get one from ``system.flow(state)``.

    The ``kernel`` "python" is the readable loop, "compiled" the same source compiled (floats only), and "auto" chooses
    by the amount of work. With NUMBA_DISABLE_JIT=1 every loop is the readable one. Set-up is done once, when needed;
    :meth:`at` and :meth:`at_tau` may be called any number of times. The same times give the same states, to the last
    bit, whatever was computed before. With ``kernel="compiled"`` there are no walks and no short runs, which is faster
    if a flow is called many times, each time for a single t of several hundred.
    """

    kernel: str

    @at_once
    def __init__(self, system: PhaseSpace, state: State, kernel: str = "auto") -> None:
        field = system.body.field
        if type(kernel) is not str or kernel not in KERNELS:
            kernel = one_of(kernel, "kernel", KERNELS, CHOOSE)
        if kernel == "compiled" and field is not RR:
            raise ArgumentError(f"kernel = 'compiled' with field = {field.name}: compiled loops exist for RR only")
        vars(self).update(system=system, state=state, kernel=kernel)
        # refused bodies and states are reported here, before any time is given
        if field is RR:
            check_domain(system, state)
        else:
            _ = self.setup
        if state.tilted:
            # this raises if M ∥ γ in the precision of the state
            leaning(field, *state.vectors)

    @cached_property
    def portrait(self) -> Portrait:
        """The motion as a whole: region, frequencies, mean rates, drift, actions and angles."""
        from integrable.portrait.portrait import Portrait

        return Portrait(self.system, self.state, self.setup)

    def stream(self, path: str | os.PathLike[str], start: Number, end: Number, count: int) -> None:
        """Writes the states at ``count`` equally spaced times from start to end to ``path``, a .npy file of float64
        rows (t, γ1, γ2, γ3, M1, M2, M3), in bounded memory: shape (count, 7), read with ``numpy.load``.

        The file appears when it is complete. Floats only (ArgumentError); other errors are those of :meth:`at`.
        """
        from integrable.motion.stream import stream

        stream(self, path, start, end, count)

    def _enclosed(self, times: list[Real], digits: int, in_tau: bool) -> Enclosure:
        from integrable.motion.enclosure import enclosure

        return enclosure(self.system.body, self.state, times, digits, in_tau)

    def section(self, count: int, axis: str = "largest") -> BodySection:
        """The next ``count`` crossings of a Poincaré section, in closed form. On the section γ is orthogonal to the
        axis of the "largest" or the "least" moment. For a tilted state, γ̃ of Chaplygin's transformation takes the
        place of γ. (:mod:`integrable.portrait.section`)
        """
        from integrable.portrait.section import body_section

        return body_section(self, count, axis)

    def spectrum(self) -> Spectrum:
        """The spectral lines of γ, M and ω with their complex amplitudes, accurate to rounding
        (:mod:`integrable.portrait.spectrum`). Floats only; NotRepresentable for a motion that is not on a torus of
        dimension two.
        """
        from integrable.portrait.spectrum import body_states, lines_of

        return lines_of(body_states(self))

    def residual_growth(self, counts: Iterable[int]) -> list[tuple[int, Real]]:
        """The pairs (n, residual) for each n in ``counts``: |f − V² mod U| relative to |f| after n additions of one
        basic step (:attr:`Setup.step_length`).
        """
        from integrable.motion.residual import residual_growth

        return residual_growth(self.setup, counts, self.kernel)

    _vectors, _unit = ("γ", "M"), 1

    @property
    def _numbers(self) -> tuple[Real, ...]:
        body = self.system.body
        return *self.state.row, *body.inertia, body.d

    def _through(self, numbers: Iterable[Real], field: Field, tilted: bool = True) -> Flow:
        values = [*map(field.coerce, numbers)]
        system = replaced(self.system, body=Body.make(values[6:9], values[9], field))
        # a plain Flow, because a subclass may need further arguments
        return Flow(system, onto_constraints(system, state_of_row(values[:6], tilted)))

    def _with(self, numbers: Iterable[Real], field: Field) -> Flow:
        return self._through(numbers, field, self.state.tilted)

    def _inputs(self) -> tuple[Inputs, tuple[str, ...]]:
        from integrable.portrait.differences import Inputs
        from integrable.portrait.sensitivity import COLUMNS

        body, M = self.system.body, max(map(abs, self.state.vectors[1]))
        sizes = (1, 1, 1, M, M, M, *[min(body.inertia) + body.d] * 4)
        # if d, the input with the index 9, is 0, its derivative is one-sided: there is no body with d < 0
        return Inputs(self._numbers, sizes, () if body.rolls else (9,)), COLUMNS

    @property
    def _fastest(self) -> float:
        return float(max(map(abs, self.system.omega(self.state))))

    def _panel(self, first: float, last: float) -> float:
        return PANEL_STEPS * self.setup.step_time

    def _finer(self, times: list[Real], K: MultiprecisionField) -> Pairs:
        from integrable.motion.certificate import finer

        return finer(self, times, K)

    def _by_variations(self, run: Trajectory) -> Sensitivity | None:
        return self._variations.resolved(self, run) if self._variations else None

    def _secular(self, times: np.ndarray) -> np.ndarray:
        from integrable.portrait.growth import growth_of_body

        return growth_of_body(self, times)

    @cached_property
    def _variations(self) -> TorusVariations | None:
        """The equations of variation on the torus; None over MP(digits), for a closed form, without compiled loops, or
        if floats do not suffice.
        """
        if self.system.field is not RR or self._closed or not (self._torus and self._torus.compiled):
            return None
        from integrable.portrait.sensitivity import TorusVariations

        try:
            return TorusVariations(self._torus, self.system.body)
        except PrecisionLoss:
            return None

    def _ways(self) -> Iterator[Way]:
        floats, turns = self.system.body.field is RR, rotation_axis(self.state) is not None
        # closed forms are faster than short runs for rotations, and for equal moments where nothing is compiled
        if floats and self.kernel != "compiled" and not turns and (not self._equal or self._compiled):
            if self._compiled:
                yield self._walk
            yield self._near
        yield self._closed or (self._torus if floats else None) or self._precise

    @quick_property
    def _walk(self) -> NearWalk:
        body = self.system.body
        cost, radians = WALK_OF_BALL if body.rolls else WALK_OF_TOP
        slowest = (min(body.inertia) + body.d) / hypot(*self.state.vectors[1])
        return NearWalk(self, cost, farthest=radians * slowest)

    @quick_property
    def _near(self) -> ShortRuns:
        return ShortRuns(self.system, self.state, self.kernel)

    @property
    def _compiled(self) -> bool:
        return self.kernel != "python" and not interpreted()

    @cached_property
    def _precise(self) -> RoundedRows:  # type: ignore[override]
        """The method that computes the states to as many digits as needed."""
        from integrable.motion.precise import RoundedRows

        return RoundedRows(self.system.field, self._many, "multiprecision")

    @cached_property
    def _many(self) -> PreciseFlow:
        from integrable.motion.precise import PreciseFlow
        from integrable.motion.precise_clock import ClockLimits

        field, body = self.system.field, self.system.body
        if field is not RR:
            return PreciseFlow(body, self.state, field.dps, self.setup)
        return PreciseFlow(body, self.state, ROUNDED_TO_FLOATS, limits=ClockLimits(MOST_RATES, CLOCK_DIGITS))

    @cached_property
    def _closed(self) -> Way | None:
        """The closed form of a body with equal moments, or of a rotation about a principal axis."""
        if not self._equal and rotation_axis(self.state) is None:
            return None
        from integrable.motion.precise import RoundedRows
        from integrable.motion.symmetric import SymmetricFlow
        from integrable.motion.symmetric_precise import PreciseClosedForm

        field = self.system.field
        if field is RR:
            return SymmetricFlow(self.system, self.state)
        return RoundedRows(field, PreciseClosedForm(self.system, self.state, field.dps), SymmetricFlow.way)

    @property
    def _equal(self) -> bool:
        return symmetry_axis(self.system.body.inertia) is not None

    @cached_property
    def _torus(self) -> TorusFlow | None:  # type: ignore[override]
        """The torus of the motion; None if it is not compact, or if it loses too many digits."""
        from integrable.torus.access import TorusFlow
        from integrable.torus.loops import CompiledLoops, ReadableLoops

        try:
            return TorusFlow(self.setup, CompiledLoops() if self._compiled else ReadableLoops(self.setup))
        except PrecisionLoss:
            return None

    @cached_property
    def contact_on_torus(self) -> TorusIntegral | PreciseContact | None:
        """The contact point as a series on the torus, or None where there is none; cached for later runs."""
        from integrable.motion.contact import on_torus

        return on_torus(self)

    def _contact_points(self, run: Trajectory) -> np.ndarray:
        from integrable.motion.contact import positions

        return positions(run)

    @cached_property
    def _level(self) -> tuple[Real, Real]:
        h1, h2 = self.system.body.energies(*self.state.vectors)
        return h1, h2

    def _off(self, rows: np.ndarray, way: str) -> tuple[np.ndarray, str]:
        """Overrides :meth:`Motion._off`: a row is off the motion if its H1 or H2 differs from that of the start.

        Near a separatrix, and for bodies that need more digits, an addition can lose every digit. Its result is then
        off the level set.
        """
        if way in (ShortRuns.way, NearWalk.way) or rows.dtype == object:
            # short runs and the precise flow have compared the integrals already, and walks have compared the states
            return super()._off(rows, way)
        drift = integrals_drift(self, rows)
        # a NaN in any row makes the maximum NaN and the comparison false
        if drift.max(initial=0) <= DRIFT:
            return super()._off(rows, way)
        with np.errstate(invalid="ignore"):
            wrong = np.flatnonzero(~(drift <= DRIFT))
        return wrong, (
            f"H1 and H2 are off by {float(drift[wrong[0]]):.1e} of their size: the motion there is beyond "
            f"{self.system.field.name}; use more digits"
        )


def integrals_drift(flow: Flow, rows: np.ndarray) -> np.ndarray:
    """The larger of the relative changes of H1 and H2 since the start, at every state: shape (N,)."""
    (h1, h2), energies = flow._level, flow.system.body.energies
    if len(rows) <= FEW:
        found = [energies(row[:3], row[3:]) for row in rows.tolist()]
        # H1 is NaN if any entry of its row is, and max keeps a NaN that comes first
        return np.array([max(abs(k1 / h1 - 1), abs(k2 / h2 - 1)) for k1, k2 in found])
    if len(rows) > CHUNK:
        return np.concatenate([integrals_drift(flow, rows[i : i + CHUNK]) for i in range(0, len(rows), CHUNK)])
    found1, found2 = energies(rows[:, :3].T, rows[:, 3:].T)
    drift: np.ndarray = np.maximum(abs(found2 / h2 - 1), abs(found1 / h1 - 1))
    return drift
