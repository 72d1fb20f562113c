"""Time shifts: the time-1 maps whose Hamiltonian is a function of the integrals, by addition of one translation."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, log10
from typing import Any

from integrable.moving_point.addition import Row, shift
from integrable.moving_point.problem import vectors
from integrable.moving_point.setup import Setup, digits_of_closeness
from integrable.moving_point.translations import REACH, Translations
from integrable.phase.jets import JetField
from integrable.phase.precisions import EPS_DIGITS
from integrable.phase.space import PhaseSpace
from integrable.phase.state import State, state_of_row
from integrable.steps.moves import Move
from jacobian import Divisor, Jacobian, poly
from jacobian.element import Element, Real
from jacobian.errors import ArgumentError, Infeasible, PrecisionLoss, shown

# digits in addition to those of the field, so that a w (:class:`Shift`) of moderate size needs no second set-up
SPARE = 8
FARTHEST = 1e100
"""The largest |w|, in units of the flow's own time. Even then a call takes only milliseconds."""


class Shift(Move):
    """The time-1 map of the Hamiltonian F(H1, H2) for the bracket of :meth:`System.poisson`, in the flow's own time τ.

    F is written with Python's operators: ``lambda h1, h2: h1 * h2``; its derivatives come from
    :mod:`integrable.phase.jets`. F = H1/2 is the motion over τ = 1. The map adds T(w), the translation with (Σ∫dx/y,
    Σ∫x dx/y) = w = (2∂F/∂H1, −2∂F/∂H2). It preserves the bracket and commutes with the motion in τ and with every other
    shift.

    The map runs over RR and MP only. The inputs are taken as exact, and all digits of the image are correct for any w.
    For a tilted state F is taken at the integrals of :meth:`System.upright`.
    """

    def __init__(self, system: PhaseSpace, F: Callable[..., Real]) -> None:
        if system.field.exact:
            raise ArgumentError(f"field = {system.field.name}: a time shift runs over RR or MP(digits)")
        if not callable(F):
            raise ArgumentError(f"F = {shown(F)}: give a function of H1 and H2, such as lambda h1, h2: h1 / 2")
        self.system = system
        self.F = F

    def __repr__(self) -> str:
        return f"<time shift on {self.system!r}>"

    def __neg__(self) -> Shift:
        return Shift(self.system, lambda h1, h2: -self.F(h1, h2))

    def plain(self, state: State) -> State:
        """The image of a state, rounded once."""
        K, state = self.system.field, self.system._checked(state)
        if not any(state.vectors[1]):
            return state
        setup, step = self._translation(state)
        if step is None:
            return state
        point = self._finite(setup, shift, setup.bare.f, setup.bare.axes, setup.bare.start, step)
        gamma, M = vectors(point, setup.problem.momentum, setup.problem.matrix)
        return state_of_row(map(K.coerce, (*gamma, *M)), state.tilted)

    def condition(self, state: State) -> float:
        """The constant 1, because :meth:`plain` chooses its own digits."""
        return 1.0

    def divisor(self, state: State[Element]) -> Divisor[Element]:
        """The divisor T(w) on the curve of a state, or of its upright body if it is tilted."""
        system, (setup, step) = self.system, self._translation(self.system._checked(state))
        if state.tilted:
            system, state, _ = system.upright(state)
        group: Jacobian = system.group(*system.integrals(state)[2:])
        if step is None:
            return group.zero()
        u0, u1, v0, v1 = self._finite(setup, lambda row: row, step)[:4]
        # the set-up's coordinates are x' = x/X and y' = y/(2X²|M|) with X = ``top``
        top, size = _top(setup), _top(setup) * setup.problem.time_scale
        K = system.field
        u = (K.coerce(u0 * top * top), K.coerce(u1 * top), K.one)
        return group.from_mumford(u, (K.coerce(v0 * size), K.coerce(v1 * size / top)))

    def _translation(self, state: State) -> tuple[Setup, Row | None]:
        """The set-up of the motion through a state, with enough digits for |w|, and T(w) in the bare reals of the
        set-up. T(w) is None for w = 0.
        """
        body = self.system.body
        least = (self.system.field.dps or EPS_DIGITS) + digits_of_closeness(body)
        digits = least + SPARE
        while True:
            setup = Setup(body, *state.vectors, state.tilted, digits)
            first, second = self._integrals(setup)
            size = abs(first) + abs(second)
            if not size <= FARTHEST:
                raise Infeasible(f"{self!r}: |w| = {float(size):.1e} in units of the flow, {FARTHEST:g} at most")
            needed = least + ceil(2 * log10(1 + size))
            if needed <= digits:
                return setup, sum_of(setup, first, second) if size else None
            digits = needed + SPARE

    def _integrals(self, setup: Setup) -> tuple[Real, Real]:
        """w (:class:`Shift`) in the coordinates x/X and y/(2X²|M|) of the set-up, where X is the largest a_i."""
        problem, wide = setup.problem, setup.wide
        h2 = problem.momentum * problem.momentum
        jets = JetField(wide, 2)
        slopes = jets.coerce(self.F(*jets.variables((problem.ratio * h2 * _top(setup), h2)))).slopes
        if not all(map(wide.context.isfinite, slopes)):
            raise PrecisionLoss(f"{self!r}: the derivatives of F are not finite at H1, H2 of the state")
        return 2 * slopes[0] * problem.time_scale, -2 * slopes[1] * problem.time_scale / _top(setup)

    def _finite(self, setup: Setup, function: Any, *rows: Row) -> tuple[Real, ...]:
        """The values of ``function`` at rows of bare reals, as wide numbers. PrecisionLoss if one is not finite."""
        with setup.reals:
            found = setup.reals.elements(setup.wide, function(*rows))
        if not all(map(setup.wide.context.isfinite, found)):
            raise PrecisionLoss(f"{self!r}: the sum has a special position; shift by another time")
        return found


def sum_of(setup: Setup, first: Any, second: Any) -> Row:
    """The translation T with (Σ∫dx/y, Σ∫x dx/y) = (first, second) in bare reals, as the sum T₀(first + second) +
    T₋₁(−second).

    T₀(ε) is :meth:`Translations.near`, with Σ∫x dx/y = 0. T₋₁(ε), with Σ∫(x + 1)dx/y = 0, is the same series about
    x = −1, which like 0 lies left of all branch points.
    """
    terms, total = [], first + second
    if total:
        terms.append(setup.translations.near(total))
    if second:
        problem, wide = setup.problem, setup.wide
        f = poly.shift(wide, problem.f, -wide.one)
        axes = tuple(x + 1 for x in problem.axes[:3])
        half_step = 2 * REACH * min(*axes, problem.ratio + 1) / wide.sqrt(-f[0])
        u0, u1, v0, v1, *pairs = Translations(setup.reals, f, axes, half_step).near(-second)
        with setup.reals:
            terms.append((u0 + u1 + 1, u1 + 2, v0 + v1, v1, *pairs))
    return terms[0] if len(terms) == 1 else setup.translations.sum(*terms)


def _top(setup: Setup) -> Any:
    """X, the largest a_i, which is the unit of x."""
    return setup.problem.time_scale / (2 * setup.problem.momentum)
