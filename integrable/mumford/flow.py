"""The motion of one state of a system on a Jacobian of any genus, by the fastest method for the given times.

In floats, states near the start are computed by Taylor series (:mod:`integrable.series.kinds`), and far ones on the
torus if the motion has one. All others are computed by additions in long numbers (:mod:`integrable.mumford.motion`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from math import ceil, log2
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, Self

import numpy as np

from integrable.mumford.columns import Column, Columns
from integrable.mumford.motion import BITS_OF_TORUS, MOST_BITS, MumfordMotion, Start, Vectors, settled_digits
from integrable.phase.precisions import ROUNDED_TO_FLOATS, long_digits
from integrable.phase.run import ROUNDED, Run
from integrable.phase.ways import Cost, StatesReached, filled, times_in
from integrable.portrait.state_flow import StateFlow, largest_rate
from jacobian import RR, Field
from jacobian.element import Element, FormulaField, Numbers, Real
from jacobian.errors import FieldError, NotRepresentable, PrecisionLoss
from jacobian.immutable import Immutable, at_once, quick_property
from jacobian.inexact.long_field import LongField
from jacobian.numbers.compiler import interpreted
from jacobian.relatives.extended import Extended, Lift

if TYPE_CHECKING:
    Arrays = Sequence[np.ndarray]

    from integrable.mumford.elliptic_torus import EllipticTorus
    from integrable.mumford.phase_torus import PhaseTorus
    from integrable.mumford.theta_torus import ThetaTorus
    from integrable.phase.enclosure import Enclosure
    from integrable.portrait.differences import Inputs
    from integrable.portrait.oval_pairs import LiftedPairs
    from integrable.portrait.section import Section
    from integrable.portrait.sensitivity import Sensitivity
    from integrable.portrait.separated import SeparatedTorus
    from integrable.portrait.spectrum import Spectrum
    from integrable.portrait.torus_portrait import TorusPortrait
    from integrable.series.kinds import Near

# largest relative difference allowed between states on a torus and states by another method
RIGHT = 1e-12
# BY_ADDITIONS is the cost of states by additions, and ON_TORUS that of states on a torus, for each genus. In genus > 3
# the cost of a torus grows as the square of the genus. In genus 3 it is 5 to 24 ms (python -m benchmarks mumford); less
# is stated here, because series may take three times as long as estimated. Instead of additions, Taylor series are
# tried up to a cost of LONGEST microseconds (python -m benchmarks near, real_torus)
BY_ADDITIONS, LONGEST = Cost(6000, 1500), 150_000
ON_TORUS = {1: Cost(300, 3), 2: Cost(400, 1), 3: Cost(4000, 3)}
# the costs on a torus if t is not linear in τ, which takes longer in genus 2
ON_CLOCK = ON_TORUS | {2: Cost(750, 2)}
# the values of Path.way
SERIES, TORUS, ADDITIONS = "series", "torus", "additions"


class Point(NamedTuple, Generic[Element]):
    """A state: positions ``q``, and momenta or velocities ``p``."""

    q: tuple[Element, ...]
    p: tuple[Element, ...]


class Path(Run[Point[Any]]):
    """States at ``times``: ``q`` and ``p`` are arrays of shape (N, n), of floats or of numbers of MP(digits).

    ``way`` is the method that computed them: "series", "torus", "additions", or several of these. ``estimate`` is an
    estimate of the largest error relative to the largest component of q, or of p, at the same time. ``error`` and
    ``digits`` are set by :meth:`MumfordFlow.certify`, else None.
    """

    @at_once
    def __init__(self, times: np.ndarray, rows: np.ndarray, way: str = ADDITIONS, estimate: float = ROUNDED) -> None:
        """``rows`` are q and p side by side, shape (N, 2n)."""
        # these arrays are never the user's own, so they can be set read-only
        times.setflags(write=False)
        rows.setflags(write=False)
        vars(self).update(_times=times, _rows=rows, way=way, estimate=estimate, error=None, digits=None)

    def _one(self, row: int) -> Point:
        return Point(*map(tuple, self._rows[row].reshape(2, -1).tolist()))


class MumfordFlow(StateFlow[Path], Immutable):
    """The motion of one state, returned by ``system.flow(state)``; ``at(times)`` evaluates it."""

    _cost = BY_ADDITIONS

    system: Any
    digits: int
    start: Point
    tolerance: float | None

    @at_once
    def __init__(self, system: Any, state: Point, tolerance: float | None = None) -> None:
        digits = ROUNDED_TO_FLOATS if system.field is RR else long_digits(system.field)
        vars(self).update(digits=digits, system=system, start=state, tolerance=tolerance)

    @quick_property
    def _genus(self) -> int:
        return self.system._genus() or len(self.system.spectral(self.start).v)

    @property
    def _clock(self) -> Callable[[FormulaField, Extended], tuple[Real, Real]] | None:
        return self.system._clock if self.system.clocked else None

    @cached_property
    def _motion(self) -> MumfordMotion:
        return MumfordMotion(self._place, self._genus, self.system.complex_data)

    def _inner(self, N: FormulaField) -> Point:
        inner: Point = self.system._constrained(N, self.system._inside(N, self.start))
        return inner

    def _place(self, N: LongField) -> Start:
        if self._recorded is not None and N.bits == BITS_OF_TORUS and not N.complex:
            return self._recorded[1]
        start: Start = self.system._start(N, self._inner(N))
        return start

    @cached_property
    def _recorded(self) -> tuple[Vectors, Start, np.ndarray] | None:
        """The start of the motion by recorded formulas, in the long numbers of a torus: (q, p), the :class:`Start`, and
        the result of :meth:`integrable.mumford.recorded.PointFormulas.fixed`, which all states share.

        None over a field other than RR, if no code is compiled, if data are complex, or if the formulas of the system
        cannot be recorded.
        """
        formulas = self.system._formulas if self._in_floats and not self.system.complex_data else None
        if formulas is None:
            return None
        with LongField(BITS_OF_TORUS) as N:
            (q, p), start = formulas.start(N, self._numbers)
            return (q, p), start, formulas.back.fixed(N, (*q, *p, *self._numbers[2 * len(q) :]))

    def at(self, times: Numbers) -> Path:
        """The states at the given times: one number or a sequence of numbers, in any order, of any sign and size.

        Floats are accurate to their last bits, numbers of MP(digits) to their digits; see
        :meth:`integrable.mumford.motion.MumfordMotion.row`. In floats, states near the start are computed by Taylor
        series (:mod:`integrable.series.kinds`). Farther states are computed on the real torus, or by additions if there
        is none. Repeated calls return the same bits, whatever was requested before. ArgumentError for times that are
        not numbers.
        """
        given = times_in(self.system.field, times, "times")
        return self._after(self._near(given), given)

    def _after(self, near: Near | None, given: np.ndarray) -> Path:
        """The states at the given times. Those in ``near`` have been computed by Taylor series already."""
        if near is not None and near.places is None:
            way, states, error = SERIES, near.states, near.error
        else:
            ways = (lambda times: self._completed(near, times), self._on_moving_axes, self._on_torus, self._far)
            way, states, _, error = filled(ways, given)
        return Path(given, states.reshape(len(given), 2 * self.system.size), way, max(error, ROUNDED))

    def _budget(self, count: int) -> float:
        """The microseconds for the set-up and ``count`` states: on the torus or, if there is none, by additions."""
        if self._of_a_torus:
            cost = (ON_CLOCK if self.system.clocked else ON_TORUS)[min(self._genus, 3)]
            return cost.of(count) * max(1.0, self._genus / 3) ** 2
        return self._cost_of_additions(count)

    def _cost_of_additions(self, count: int) -> float:
        return min(self._cost.of(count), LONGEST)

    def _near(self, times: np.ndarray) -> Near | None:
        """The states by Taylor series, in floats: at all ``times`` that series reach at a cost below
        :meth:`_budget`. None over a field other than RR, or if the formulas of the system cannot be recorded.
        """
        kind = None if times.dtype.hasobject else self.system._kind
        return kind and kind.walked(self._walk_given, times, self._budget(len(times)), self.tolerance)

    def _completed(self, near: Near | None, times: np.ndarray) -> StatesReached | None:
        """The states in ``near`` and, if there is no torus, those at further ``times`` that Taylor series with the
        finest steps reach at the cost of additions. None if ``near`` is None.
        """
        if near is None:
            return None
        kind, count = self.system._kind, len(times)
        if near.lacks(count) and self._torus is None:
            near = kind.finished(near, self._walk_given, times, self._cost_of_additions(count))
        return StatesReached(SERIES, near.states, near.places, near.error)

    @property
    def _walk_given(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        return self.system._walk_constants, (*self.start.q, *self.start.p)

    @cached_property
    def _of_moving_axes(self) -> tuple[MumfordFlow, list[int]] | None:
        found = self.system._of_moving_axes(self.start)
        if found is None:
            return None
        system, state, axes = found
        return type(self)(system, state, self.tolerance), axes

    def _on_moving_axes(self, times: np.ndarray) -> StatesReached | None:
        """The states of a motion in a coordinate plane, from the system with the axes of the plane alone. In the whole
        system its pairs have points at double points of the curve.
        """
        if self._of_moving_axes is None:
            return None
        flow, axes = self._of_moving_axes
        path = flow.at(times)
        states = np.full((len(times), 2, self.system.size), self.system.field.zero, dtype=path.q.dtype)
        states[:, :, axes] = np.stack([path.q, path.p], axis=1)
        return StatesReached(path.way, states, None, path.estimate)

    def _on_torus(self, times: np.ndarray) -> StatesReached | None:
        torus = self._torus if len(times) else None
        try:
            return StatesReached(TORUS, self._read(torus, times)) if torus and torus.reaches(times) else None
        except PrecisionLoss:
            # points were not found at these times
            return None

    def _by_additions(self, times: np.ndarray) -> StatesReached:
        return self._by_rows(times, self._row, self._long_way)

    def _far(self, times: np.ndarray) -> StatesReached:
        """The states by additions; by sums over the ovals if additions fail, as for all pairs of a lattice with
        q_{−i} = −q_i and p_{−i} = −p_i.
        """
        try:
            return self._by_additions(times)
        except PrecisionLoss:
            if self._genus <= 2 or self.system.clocked or not self._confirmed_in_floats:
                raise
            return self._by_rows(times, self._summed, TORUS)

    @cached_property
    def _confirmed_in_floats(self) -> bool:
        """Whether the motion in floats has a torus, whose states have been compared with another method."""
        try:
            floats: Any = self._over(RR)
        except FieldError:
            return False
        return floats._torus is not None

    def _by_rows(self, times: np.ndarray, row: Callable[[Real], Vectors], way: str) -> StatesReached:
        K, places = self.system.field, self._places(times.tolist())
        states = [[[element(K, x) for x in part] for part in row(place)] for place in places]
        found = np.array(states, dtype=float if K is RR else object).reshape(len(times), 2, self.system.size)
        return StatesReached(way, found)

    _long_way = ADDITIONS
    """The value of ``way`` for states that :meth:`_by_additions` computes."""

    def _row(self, time: Real) -> Vectors:
        """The state at a time, in long numbers."""
        return self._motion.row(
            time, lambda N, D: self.system._back(N, self._inner(N), D, N.coerce(time)), self.digits, self._clock
        )

    def _summed(self, time: Real) -> Vectors:
        """The state at a time, in long numbers, by sums over the ovals."""
        return settled_digits(lambda N: self._summed_in(N, time), self.digits)

    def _summed_in(self, N: LongField, time: Real) -> Point:
        import gmpy2

        if N.bits not in self._tori:
            separated = self._separated(N)
            self._tori[N.bits] = separated, self._pairs_on(N, separated)
        torus, pairs = self._tori[N.bits]
        angles, turned = torus.angles_at(N.coerce(time))
        D = pairs.at(N, [gmpy2.sin_cos(phi / 2) for phi in angles], [gmpy2.sin_cos(x)[::-1] for x in turned])
        state: Point = self.system._back(N, self._inner(N), D, N.coerce(time))
        return state

    @cached_property
    def _tori(self) -> dict[int, tuple[SeparatedTorus, LiftedPairs]]:
        """For each number of bits in use, the ovals and the pairs of points in them."""
        return {}

    @property
    def _in_floats(self) -> bool:
        return bool(self.system.field is RR and not interpreted())

    def _enclosed(self, times: list[Real], digits: int, in_tau: bool) -> Enclosure:
        from integrable.mumford.enclosure import enclosed_path

        return enclosed_path(self, times, digits, in_tau)

    @cached_property
    def portrait(self) -> TorusPortrait:
        """The motion as a whole: frequencies, actions and angles (:mod:`integrable.portrait.torus_portrait`).

        NotRepresentable if the points of the pair do not turn in g real ovals, PrecisionLoss next to a separatrix.
        """
        from integrable.portrait.torus_portrait import TorusPortrait

        return TorusPortrait(self)

    def _settled_on_torus(self, read: Callable[[SeparatedTorus], Vectors]) -> list[list[Real]]:
        """The result of ``read`` for the torus of the motion, to the digits of the field."""
        found = settled_digits(lambda N: read(self._separated(N)), self.digits + self._digits_of_ovals)
        return [[element(self.system.field, x) for x in row] for row in found]

    @cached_property
    def _digits_of_ovals(self) -> int:
        """The number of digits that tell the narrowest oval from a point; 0 if all ovals are points or wide."""
        from integrable.portrait.point_ovals import double_root

        with LongField(BITS_OF_TORUS) as N:
            torus = self._separated(N)
            points, size = [oval.middle for oval in torus.ovals if not oval.radius], torus.size
        if not points:
            return 0
        with LongField(MOST_BITS) as N:
            f = self.system._spectral(N, self._inner(N))[0]
            found = [double_root(N, f, N.coerce(x), N.coerce(size)) for x in points]
            narrow = [N.exponent(x[1] / (size * size)) for x in found if x and x[1]]
            return max([ceil(-e / log2(10)) for e in narrow if e is not None], default=0)

    def _separated(self, N: LongField) -> SeparatedTorus:
        from integrable.portrait.separated import SeparatedTorus

        inner = self._inner(N)
        return SeparatedTorus(N, self.system._spectral(N, inner), self.system._separation(N, inner))

    def spectrum(self) -> Spectrum:
        """The spectral lines of q and p (:mod:`integrable.portrait.spectrum`), in floats.

        The uniform motion of a centre of mass is subtracted. NotRepresentable over a field other than RR, or if the
        points of the pair do not turn in g real ovals. PrecisionLoss if a grid on the torus would be too fine.
        """
        from integrable.portrait.spectrum import lines_of, torus_states

        with LongField(BITS_OF_TORUS) as N:
            torus = self._separated_in_floats(N, "spectrum")
            frequencies = [*map(float, self.portrait.frequencies)]
            return lines_of(torus_states(torus, self._ends(N), self._reader_on(N, torus), frequencies))

    def section(self, count: int, oval: int = 0, end: str = "lower") -> Section:
        """The next ``count`` states with a point of the pair at the "lower" or the "upper" end of its oval, in floats.

        ``oval`` is the number of the oval, from 0 in ascending order. If the end is a branch point a_i at which q_i is
        a lift, q_i = 0 there. The errors are those of :meth:`spectrum`. (:mod:`integrable.portrait.section`)
        """
        from integrable.portrait.section import Section, crossings

        with LongField(BITS_OF_TORUS) as N:
            times, theta, rotation = crossings(self._separated_in_floats(N, "section"), count, oval, end)
        return Section(self.at(times), theta, rotation)

    def _inputs(self) -> tuple[Inputs, tuple[str, ...]]:
        from integrable.portrait.differences import Inputs

        (q, p), constants, rate = self.start, self.system._varied, self._fastest or 1.0
        n, size = len(q), float(max(*map(abs, q), *(abs(x) / rate for x in p))) or 1.0
        names = (f"{part}{i}" for part in "qp" for i in range(n))
        sizes = (*[size] * n, *[size * rate] * n, *constants.values())
        return Inputs(self._numbers, sizes), (*names, *(name for name, change in constants.items() if change))

    def _by_variations(self, run: Path) -> Sensitivity | None:
        from integrable.mumford.variations import near_sensitivity

        return near_sensitivity(self, run.times.copy(), LONGEST) if self._in_floats else None

    @property
    def _numbers(self) -> tuple[Real, ...]:
        return *self.start.q, *self.start.p, *self.system.constants, *self.system.parameters

    @property
    def _dimensions(self) -> tuple[int, int]:
        constraints = sum(" = " in name for name in self.system._constraint_names)
        return 2 * self.system.size, 2 * self.system.size - constraints

    @property
    def _fastest(self) -> float:
        floats = self._through(self._numbers, RR)
        return largest_rate([floats.system.linearized(floats.start)])

    def _through(self, numbers: Iterable[Real], field: Field) -> Self:
        n, given = self.system.size, tuple(map(field.coerce, numbers))
        return type(self)(self.system._of(field, given[2 * n :]), Point(given[:n], given[n : 2 * n]))

    def _separated_in_floats(self, N: LongField, name: str) -> SeparatedTorus:
        """:meth:`_separated` of a flow over RR; NotRepresentable over another field, with ``name`` in the message."""
        K = self.system.field
        if K is not RR:
            raise NotRepresentable(f"{name}: it is computed in floats, this flow is over {K.name}")
        return self._separated(N)

    def _ends(self, N: LongField) -> list[Real]:
        """The branch points at which the state has lifts."""
        return [kind.e for kind in self._place(N).kinds if isinstance(kind, Lift)]

    def _reader_on(self, N: LongField, torus: SeparatedTorus) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
        """The function ``read`` of a :class:`~integrable.mumford.phase_torus.PhaseTorus` for states, (N, 2, n)."""
        from integrable.mumford.phase_torus import in_pairs
        from integrable.portrait.oval_pairs import numbers_of

        pairs, genus = self._pairs_on(N, torus), len(torus.ovals)
        if self._recorded is None or torus.separation.turns:
            return lambda points, times: self._back_at(
                pairs.at(Columns(), in_pairs(points[: 2 * genus]), in_pairs(points[2 * genus :])), times
            )
        formulas, (q, p) = self.system._formulas.on_ovals(pairs), self._recorded[0]
        fixed = formulas.fixed(N, (*q, *p, *self._numbers[2 * len(q) :], *numbers_of(pairs)))
        return lambda points, times: formulas.states(fixed, [*points], times)

    def _pairs_on(self, N: LongField, torus: SeparatedTorus) -> LiftedPairs:
        """The pairs of points in their ovals, each lift with the sign that continues that of the start.

        Data that are no lifts are taken to be the time t, which formulas of states do not use.
        """
        from integrable.portrait.oval_pairs import LiftedPairs

        start, pairs = self._place(N), torus.pairs(self._ends(N))
        here = iter(pairs.at(N, torus.halves)[2])
        lifts: list[tuple[Real, Real, int] | None] = []
        for kind, datum in zip(start.kinds, start.data, strict=True):
            if isinstance(kind, Lift):
                (kappa, sigma, nu), (own, slope) = datum, next(here)
                scale, side = 1 / N.sqrt(abs(kappa)), 1 if kappa > 0 else -1
                ahead = scale * own * sigma + side * scale * slope * nu >= 0
                lifts.append((kappa, scale if ahead else -scale, side))
            else:
                lifts.append(None)
        return LiftedPairs(pairs, tuple(lifts))

    def _places(self, times: list[Real]) -> list[Real]:
        """The arguments with which :meth:`_row` finds the states at ``times``: the times themselves, unless a subclass
        converts them to values of τ.
        """
        return times

    @property
    def _of_a_torus(self) -> bool:
        """Whether motions of this system have a torus in floats; in genus 1 only if t is linear in τ."""
        system = self.system
        return not system.complex_data and (not system.clocked or self._genus >= 2)

    @cached_property
    def _torus(self) -> EllipticTorus | PhaseTorus | ThetaTorus | None:
        """The torus, which gives states in floats; None if there is none or its states are wrong."""
        if not (self._of_a_torus and self._in_floats):
            return None
        try:
            torus = self._made_torus()
            return torus if self._confirmed(torus) else None
        except (NotRepresentable, PrecisionLoss, ZeroDivisionError):
            return None

    def _made_torus(self) -> EllipticTorus | PhaseTorus | ThetaTorus:
        if self._genus == 1:
            from integrable.mumford.elliptic_torus import EllipticTorus

            return EllipticTorus(self._place)
        if self._genus > 2:
            return self._made_phase_torus()
        from integrable.mumford.theta_torus import ThetaTorus

        return ThetaTorus(self._place)

    def _made_phase_torus(self) -> PhaseTorus:
        from integrable.mumford.phase_torus import PhaseTorus

        with LongField(BITS_OF_TORUS) as N:
            separated = self._separated(N)
            return PhaseTorus(separated, self._reader_on(N, separated))

    def _confirmed(self, torus: Any) -> bool:
        """Whether the states of a torus agree with those by Taylor series of the equations of motion, signs included.

        Where series do not reach or lose digits, the comparison is with additions in long numbers.
        """
        times = torus.witnesses
        true = filled((self._walked, self._by_additions), times).states
        with np.errstate(invalid="ignore"):
            # a wrong pair may belong to no state of the system, and then gives NaN
            gaps = np.abs(self._read(torus, times) - true).max(axis=2)
        return bool((gaps <= RIGHT * np.abs(true).max(axis=2)).all())

    def _walked(self, times: np.ndarray) -> StatesReached | None:
        """The states by Taylor series, at all ``times`` that series reach at a lower cost than additions."""
        kind, given, most = self.system._kind, self._walk_given, self._cost_of_additions(len(times))
        if kind is None:
            return None
        near = kind.finished(kind.walked(given, times, most), given, times, most)
        return StatesReached(SERIES, near.states, near.places)

    def _read(self, torus: Any, times: np.ndarray) -> np.ndarray:
        """The states that a torus gives at the N ``times``, shape (N, 2, n)."""
        found = torus.at(times)
        return found if isinstance(found, np.ndarray) else self._back_at(found, times)

    def _back_at(self, D: Extended, times: np.ndarray) -> np.ndarray:
        """The states of N pairs, each at its own time, shape (N, 2, n)."""
        if self._recorded is not None:
            states: np.ndarray = self.system._formulas.states(self._recorded[2], D, times)
            return states
        N = Columns()
        columns = self.system._back(N, self._inner(N), D, Column(times))
        # a coordinate that does not depend on the angles is a single number, and is made an array
        return np.stack([np.stack([x.hi + 0 * times for x in part], axis=1) for part in columns], axis=1)


def element(K: object, x: Real) -> Any:
    """A long number as an element of RR or MP(digits)."""
    from jacobian.numbers.long_reals import BareReals

    if K is RR:
        return float(x)
    return BareReals(64).element(K, x)
