"""The set-up of a flow, computed once per state in extended precision and rounded once."""

from __future__ import annotations

from functools import cached_property
from math import ceil, log10

import numpy as np

from integrable.moving_point.addition import opposite, rate_at, shift
from integrable.moving_point.problem import Problem
from integrable.moving_point.translations import Translations
from integrable.phase.body import Body, Vector
from integrable.phase.precisions import EPS_DIGITS, SET_UP_DIGITS
from integrable.phase.state import State, onto_constraints
from integrable.phase.upright import ChaplyginTransformation
from jacobian import MP, RR
from jacobian.element import Real
from jacobian.errors import ArgumentError
from jacobian.fields.multiprecision import Mpf, MultiprecisionField
from jacobian.numbers.long_reals import BareReals

GUARD_DIGITS = 10
WIDER = 20
GUARD_BITS = 10
# number of intermediate moving points that are cached
MOST_PASSED = 4096


class Setup:
    """One motion as a :class:`Problem` in three kinds of numbers, and its translations.

    ``floats`` has floats, ``problem`` numbers of the MP field ``wide``, and ``bare`` numbers of ``reals``, for long
    loops. The argument ``digits`` sets the number of digits independently of the body's field. The numbers of the body
    and of the state are taken as exact. The attribute ``digits`` includes guard digits.
    """

    def __init__(self, body: Body, gamma: Vector, M: Vector, tilted: bool = False, digits: int | None = None) -> None:
        field = body.field
        own = field.dps if isinstance(field, MultiprecisionField) and not field.complex else None
        if own is None and field is not RR:
            raise ArgumentError(f"field = {field.name}: a flow runs over RR or MP(digits)")
        self._wanted = own if digits is None else digits
        self.digits = EPS_DIGITS if self._wanted is None else self._wanted + GUARD_DIGITS
        self.body = body
        self._gamma, self._M, self._tilted = gamma, M, tilted
        self._passed: dict[int, tuple[Real, ...]] = {}
        # the results of integrable.motion.precise_clock.digits_a_node, for this motion with any number of digits
        self.decays: dict[tuple[int, int], float] = {}

    def finer(self, digits: int) -> Setup:
        """The same motion with another number of digits, guard digits excluded."""
        found = Setup(self.body, self._gamma, self._M, self._tilted, digits)
        found.decays = self.decays
        return found

    @cached_property
    def wide(self) -> MultiprecisionField:
        """The field of the wide numbers, in which results are returned."""
        if self._wanted is None:
            return MP(SET_UP_DIGITS + digits_of_closeness(self.body))
        return MP(self.digits + WIDER)

    @cached_property
    def reals(self) -> BareReals:
        """The bare reals in which loops compute with more digits than floats have."""
        return BareReals(self.wide.context.prec + GUARD_BITS)

    @cached_property
    def bare(self) -> Problem:
        """The motion in bare reals."""
        return Problem.of(self.reals, (*self.body.inertia, self.body.d, *self._gamma, *self._M), self._tilted)

    @cached_property
    def problem(self) -> Problem:
        """The motion in numbers of the wide field."""
        return self.bare.over(lambda x: self.reals.element(self.wide, x))

    @property
    def floats_given(self) -> tuple[np.ndarray, bool] | None:
        """(moments, d, γ and M in one array; whether the state is tilted), or None if any of these is not a float. A
        body in the laboratory (:mod:`integrable.laboratory`) has more digits even if it is given in floats.
        """
        given = (*self.body.inertia, self.body.d, *self._gamma, *self._M)
        return (np.array(given), self._tilted) if all(isinstance(x, float) for x in given) else None

    @cached_property
    def tilt(self) -> ChaplyginTransformation | None:
        """The transformation of a tilted state to (γ, M) = 0, in the wide field."""
        if not self._tilted:
            return None
        body = Body.make(self.body.inertia, self.body.d, self.wide)
        state = onto_constraints(body, State(self._gamma, self._M, tilted=True))
        return ChaplyginTransformation.of(body, *state.vectors)

    @cached_property
    def time_scale(self) -> Mpf:
        """One unit of the user's τ in the flow's own units, in the wide field."""
        return self.reals.element(self.wide, self.bare.time_scale)

    @cached_property
    def step_length(self) -> Mpf:
        """A basic step in the flow's own time, in the wide field. The points of the translation by half a step lie at
        about REACH times the distance from x = 0 to the nearest branch point.
        """
        return 2 * self.reals.element(self.wide, self.bare.half_step)

    @cached_property
    def floats(self) -> Problem:
        """The motion in floats."""
        return self.bare.over(float)

    @cached_property
    def translations(self) -> Translations:
        """The translations T(eps), for eps of any size."""
        problem = self.bare
        return Translations(self.reals, problem.f, problem.axes, problem.half_step)

    def reached(self, sign: int, steps: int) -> tuple[Real, ...]:
        """The moving point after sign·``steps`` basic steps, in bare reals. The number of additions is about log2 of
        ``steps``.

        Intermediate points are cached, because points one step apart share all additions but the last.
        """
        translations, point, done, level = self.translations, self.bare.start, 0, 0
        if len(self._passed) > MOST_PASSED:
            self._passed.clear()
        while translations.level(level)[0] <= steps:
            level += 1
        while done < steps:
            count, step = translations.level(level)
            if done + count > steps:
                level -= 1
                continue
            done += count
            known = self._passed.get(sign * done)
            if known is None:
                with self.reals:
                    known = shift(self.bare.f, self.bare.axes, point, step if sign > 0 else opposite(step))
                self._passed[sign * done] = known
            point = known
        return point

    @cached_property
    def step_time(self) -> float:
        """The duration of a basic step at the start, in the user's units of physical time.

        Power series about a state converge over about one step, for any moments. The step is thus the time scale on
        which states vary.
        """
        problem = self.problem
        return abs(float(self.step_length * rate_at(problem.axes, problem.start) / self.time_scale))


def digits_of_closeness(body: Body) -> int:
    """The number of extra digits that a divisor needs if all moments are nearly equal, or tiny compared with d. U then
    vanishes like the square of the relative differences of the I_i + d, V like the third power.
    """
    most, least = max(body.inertia), min(body.inertia)
    return 0 if most == least else ceil(3 * log10((most + body.d) / (most - least)))
