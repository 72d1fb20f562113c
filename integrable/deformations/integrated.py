"""The motion of any deformation by integration of its equations in any precision, for systems without a known flow."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np

from integrable.deformations.carrier import GUARD_DIGITS, widened
from integrable.deformations.hamiltonian import Hamiltonian
from integrable.deformations.hamiltonian_motion import HamiltonianMotion
from integrable.motion.near import Integration, NearWalk, right_hand_sides
from integrable.motion.refusals import Rows, refused_rows
from integrable.motion.trajectory import Trajectory
from integrable.moving_point.losses import digits_of
from integrable.mumford.taylor import integrate
from integrable.phase.jets import Jet, JetField
from integrable.phase.precisions import long_digits
from integrable.phase.state import State, onto_constraints, state_of_row
from integrable.phase.ways import Cost, InOrder, Way, rounded
from integrable.portrait.differences import Inputs
from integrable.portrait.sensitivity import Sensitivity
from integrable.series.steps import INTEGRATED
from integrable.series.tape import recorded
from jacobian import MP
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.immutable import at_once

__all__ = ["IntegratedMotion"]

# a step has STEP_DIGITS guard digits; all steps together may lose LOST_DIGITS digits of H and K
STEP_DIGITS = 2
LOST_DIGITS = 3
# a step of derivatives has VARIED_DIGITS guard digits, which all steps together may lose
VARIED_DIGITS = 6
# time is not rescaled if the fastest rate is from 2^−USUAL to 2^USUAL, which saves one product per rate
USUAL = 10
# the sizes of H and K are found from this relative change of coordinates, which changes K even at a double zero of K
PART = 1.2345e-4
# microseconds, in the unit of integrable.series.steps.step_cost, of a walk that replaces this integration
BY_STEPS = Cost(150_000, 0)


class IntegratedMotion(HamiltonianMotion):
    """The motion of a deformation through a state, by Taylor series of ``system.vector_field``, over RR or MP(digits).

    Everything is computed with guard digits, in double-doubles for floats. Each step is accurate to the last digit, and
    results are rounded once. The work grows with the time: Infeasible if it would take more than about a second in
    floats, or half a minute in MP(digits). PrecisionLoss if the motion ends in finite time at an attracting pole, or
    if H and K are not preserved to the requested digits.
    """

    method = "integrated"

    @at_once
    def __init__(self, system: Hamiltonian, state: State) -> None:
        super().__init__(system, state)
        # this raises ArgumentError for fields other than RR or MP(digits)
        long_digits(system.field)

    @cached_property
    def _equations(self) -> IntegratedStates:
        return IntegratedStates(self.system, self.state)

    def _ways(self) -> Iterator[Way]:
        yield NearWalk(self, BY_STEPS, INTEGRATED)
        yield self._equations

    def _kept(self, way: InOrder, given: np.ndarray, physical: bool, nan: Real) -> Rows:
        way.way = self.method
        found = NearWalk(self, BY_STEPS, INTEGRATED).run(given, physical)
        # rows that the integration reached before a refused time are kept
        return self._equations.kept(given, physical, nan) if found is None else Rows(*found)

    def _by_variations(self, run: Trajectory) -> Sensitivity:
        inputs, names = self._inputs()
        matrix = rounded(self.system.field, self._equations.derivatives(run.times, inputs))
        return Sensitivity(run.times, matrix, None, self.method, self, names)


class IntegratedStates(Integration):
    """The states of an IntegratedMotion, rounded to the field of ``system``, and their τ or t if d ≠ 0."""

    def __init__(self, system: Hamiltonian, state: State) -> None:
        self._field, self._asked = system.field, long_digits(system.field)
        self._system, self._state = widened(system, state, MP(self._asked + GUARD_DIGITS))

    def run(self, given: np.ndarray, physical: bool) -> tuple[np.ndarray, np.ndarray]:
        found = self.kept(given, physical, 0.0, strict=True)
        return found.rows, found.tau

    def kept(self, given: np.ndarray, physical: bool, nan: Real, strict: bool = False) -> Rows:
        """The rows at the times ``given``; their attribute ``tau`` is τ. Unless ``physical``, ``given`` are values of
        τ, and ``tau`` holds t. Refused rows are filled with ``nan``; if ``strict``, an error is raised instead.
        """
        refused: dict[int, str] = {}
        found = self._integrated(given, physical, None if strict else refused)
        had = [i for i in range(len(found)) if i not in refused]
        for i, missing in zip(had, self._missing([found[i][:6] for i in had]), strict=True):
            if missing > 0:
                refused[i] = (
                    f"times: H and K of the motion as integrated are {missing} digits short; times nearer to 0 are "
                    "within reach, or an MP field of more digits"
                )
                if strict:
                    raise PrecisionLoss(refused[i])
        rows = rounded(self._field, [row[:6] for row in found]).reshape(-1, 6)
        tau = rounded(self._field, [row[6] for row in found]) if self._system.body.rolls else given
        return refused_rows(Rows(rows, tau), refused, nan)

    def _integrated(self, given: np.ndarray, physical: bool, refused: dict[int, str] | None) -> list[list[Real]]:
        system, state, digits = self._system, self._state, self._asked + STEP_DIGITS
        wide = system.field
        start = [*state.row, *([wide.zero] if system.body.rolls else [])]
        rates, exponent = right_hand_sides(system, physical), self._exponent
        times = [wide.context.ldexp(wide.coerce(x), exponent) for x in given.tolist()]
        unit = wide.context.ldexp(wide.one, -exponent)
        slowed = (lambda y: [unit * x for x in rates(y)]) if exponent else rates
        return integrate(wide, recorded(slowed, len(start)), start, times, digits, refused, float(unit))

    def derivatives(self, given: np.ndarray, inputs: Inputs) -> np.ndarray:
        """The derivatives of (γ, M) at physical times with respect to the inputs, in mpf, (N, 6, inputs).

        PrecisionLoss if the derivatives, applied to (γ̇, Ṁ) at the start, do not give (γ̇, Ṁ) at these times.
        """
        times = [0, *given.tolist()]
        columns = [self._varied(times, inputs.numbers, k) for k, size in enumerate(inputs.sizes) if size]
        (_, first), *found = (np.split(rows, 2) for rows in np.stack(columns, axis=2))
        begin = np.array(self._system.vector_field(self._state).row)
        # ``first``, the matrix at time 0, is the derivative of the projection onto the constraints. On tangent vectors
        # it is the identity up to the error e of the state's constraints. The next line solves first·x = begin up to e²
        begin = begin + (begin - first[:, :6] @ begin)
        for time, (rows, matrix) in zip(given, found, strict=True):
            rates = np.array(self._system.vector_field(state_of_row(rows[:, 0].tolist())).row)
            gap = max(abs(matrix[:, :6] @ begin - rates)) / max(abs(matrix[:, :6] * begin).ravel())
            missing = digits_of(gap) + self._asked
            if missing > 0:
                raise PrecisionLoss(
                    f"times: the derivatives at {time} are {missing} digits short; times nearer to 0 are within reach, "
                    "or an MP field of more digits"
                )
        return np.array([matrix for _, matrix in found]).reshape(len(found), 6, len(columns))

    def _varied(self, given: Sequence[Real], numbers: Sequence[Real], k: int) -> np.ndarray:
        """The states at physical times and their derivatives with respect to number ``k`` of the inputs, (N, 12)."""
        wide, exponent = self._system.field, self._exponent
        jets = JetField(wide, 1)
        y = [Jet(jets, wide.coerce(x), (wide.one if i == k else wide.zero,)) for i, x in enumerate(numbers)]
        system = self._system._of_constants(jets, y[6:])
        start = onto_constraints(system, state_of_row(y[:6])).row
        unit = wide.context.ldexp(wide.one, -exponent)

        def rates(y: Sequence[Real]) -> list[Real]:
            state = state_of_row(Jet(jets, x, (slope,)) for x, slope in zip(y[:6], y[6:], strict=True))
            found = system._rates(state).row
            return [unit * x for x in (*(jet.value for jet in found), *(jet.slopes[0] for jet in found))]

        begin = [*(jet.value for jet in start), *(jet.slopes[0] for jet in start)]
        times = [wide.context.ldexp(wide.coerce(x), exponent) for x in given]
        tape = recorded(rates, len(begin))
        return np.array(integrate(wide, tape, begin, times, self._asked + VARIED_DIGITS, None, float(unit)))

    @property
    def _exponent(self) -> int:
        """The exponent of the unit of time, 2^−exponent, in which the equations are integrated.

        In one such unit of time γ moves by about 1; the exponent is 0 if γ moves by 2^−USUAL to 2^USUAL in a unit of t.
        Without this unit the coefficients of order 20 and more, powers of the rate, could exceed the range of floats.
        """
        context, rate = self._system.field.context, self._system.vector_field(self._state)
        # for a body at rest γ̈ is of the size of Ṁ divided by a moment
        turn, change = rate.vectors
        pull = max(abs(a * m) for a, m in zip(self._system.a, change, strict=True))
        fastest = max(*map(abs, turn), context.sqrt(pull))
        exponent = int(context.mag(fastest)) if fastest else 0
        return exponent if abs(exponent) > USUAL else 0

    def _missing(self, rows: list[list[Real]]) -> list[int]:
        """For each row, the number of digits that H and K lack; LOST_DIGITS fewer than requested are enough."""
        wanted = self._asked - LOST_DIGITS
        (before, *moved), found = (
            [self._system.integrals(state_of_row(y))[2:] for y in points] for points in (self._nearby, rows)
        )
        # the error of F = H or K is measured relative to |F| + Σ|ΔF/part|, with the changes ΔF at nearby states
        part = self._system.field.coerce(PART)
        sizes = [abs(F) + sum(abs(row[k] - F) for row in moved) / part for k, F in enumerate(before)]
        pairs = [zip(row, before, sizes, strict=True) for row in found]
        return [max(digits_of(abs(x - y) / size) for x, y, size in pair) + wanted for pair in pairs]

    @cached_property
    def _nearby(self) -> list[list[Real]]:
        """The start, and six points with one coordinate moved by PART of the largest component of γ, or of M."""
        vectors, part = self._state.vectors, self._system.field.coerce(PART)
        units, values = [part * max(map(abs, v)) for v in vectors], [x for v in vectors for x in v]
        return [values, *([*values[:i], values[i] + units[i // 3], *values[i + 1 :]] for i in range(6))]
