"""The exact flow in multiprecision: the same additions as for floats, in bare reals, at a precision chosen
automatically.

Numbers have 30 digits more than requested. Next to a separatrix, where errors can grow, they have as many more as the
motion may lose (:func:`integrable.moving_point.losses.lost_digits`). Every call also measures the loss, from the
integrals of all states and from the farthest state, computed again with more digits. If digits are missing, the
computation is repeated with more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil, inf
from typing import TYPE_CHECKING, Any, Self, TypeVar

import numpy as np

from integrable.motion.precise_clock import NEAR_CELLS, NONE, ClockLimits, OneTime, PanelClock
from integrable.moving_point import addition
from integrable.moving_point.losses import NOTHING, digits_of, drift, lost_digits
from integrable.moving_point.problem import vectors
from integrable.moving_point.setup import GUARD_DIGITS, Setup
from integrable.phase.ways import rounded
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.protocol import Field

Found = TypeVar("Found")

if TYPE_CHECKING:
    from typing import TypeAlias

    from integrable.phase.body import Body, Vector
    from integrable.phase.state import State
    from integrable.torus.long_clock import LongClock

    Compute: TypeAlias = "Callable[[Carrier, list[Real]], tuple[Found, int] | None]"

# the second computation of the farthest state has the digits of the first, those that may be lost, and WIDER more
WIDER = 10
# digits that a result keeps in addition to the requested ones
SPARE = 2
# a motion on the separatrix that loses this many digits takes half a minute
MOST_LOST = 400
# from this many basic steps (Setup.step_length) per digit on, the torus costs less than stepping
TORUS_FROM = 20
# the work for the tables of a torus is counted in multiplications. A basic step takes as long as WORK_A_STEP of them
# for each digit. Tables that take up to WORK_WITH_ROOM multiplications fit into memory
WORK_A_STEP, WORK_WITH_ROOM = 20, 1 << 28
# from ALONE_FROM digits on, the first request for a single time is answered without a series of the clock, from a value
# of τ with ROUGH_DIGITS digits
ALONE_FROM, ROUGH_DIGITS = 250, 30


class Carrier:
    """A motion computed with a fixed number of digits; :class:`ManyDigits` replaces it by a wider one if digits are
    missing. Times and τ are wide numbers in the carrier's units.

    ``digits`` is the number of digits of its results, without guard digits.
    """

    digits: int
    field: Any
    """The field of the wide numbers."""
    rolls: bool
    """Whether τ differs from t: the carrier then has a clock."""
    momentum: Real = 1
    """The unit of M for a body at rest."""
    witness: Self | None = None
    """A carrier with more digits, which has computed the farthest point of this carrier again."""
    witnessed: Real = 0
    """The largest |τ| whose point the witness has computed again."""

    def scaled(self, t: Real) -> Real:
        """A time in the user's units, converted to those of the carrier."""
        return self.field.coerce(t)

    def unscaled(self, t: Real) -> Real:
        """A time in the carrier's units, converted to those of the user."""
        return t

    def lost(self, tau: Real) -> int:
        """The number of digits by which an error may grow from the start to τ ≥ 0."""
        raise NotImplementedError

    def most_tau(self, t: Real) -> Real:
        """An estimate of τ at a physical time t ≥ 0, to estimate the loss of digits before a clock exists."""
        return t

    def tau(self, times: list[Real], digits: int) -> list[Real]:
        """The values of τ at physical times, to ``digits`` digits."""
        return times

    def tau_alone(self, time: Real, digits: int) -> Real:
        """τ at a single physical time."""
        return self.tau([time], digits)[0]

    def times(self, tau: list[Real], digits: int) -> list[Real]:
        """The physical times t(τ) at values of τ, to ``digits`` digits."""
        return tau

    def clock_missing(self, tau: Real, digits: int) -> int:
        """The number of digits that the clock at τ lacks for an accuracy of ``digits``; at most 0 if it lacks none."""
        return -digits

    def point(self, tau: Real) -> Any:
        """The moving point at τ."""
        raise NotImplementedError

    def points(self, tau: list[Real]) -> list[Any]:
        """The moving points at values of τ."""
        return [self.point(t) for t in tau]

    def vectors(self, point: Any) -> tuple[Vector[Real], Vector[Real]]:
        """The pair (γ, M) of a moving point. By default the point is this pair."""
        gamma, M = point
        return gamma, M

    def drift(self, points: list[Any]) -> int:
        """The decimal exponent of the largest relative change of the integrals between the start and the points."""
        raise NotImplementedError

    def gap(self, point: Any, truth: Self, tau: Real) -> int:
        """The decimal exponent of the relative difference between a point at τ and the point of ``truth``, a carrier
        with more digits.
        """
        return truth.difference(self.vectors(point), truth.vectors(truth.points([tau])[0]))

    def difference(self, found: Sequence[Sequence[Real]], truth: Sequence[Sequence[Real]]) -> int:
        """The decimal exponent of the relative difference of (γ, M) from ``truth``. Where the true M is 0, the
        difference of M is taken in units of ``momentum``.
        """
        worst = -NOTHING
        for vector, right, unit in zip(found, truth, (1, self.momentum), strict=True):
            gap = max(abs(self.field.coerce(x) - y) for x, y in zip(vector, right, strict=True))
            worst = max(worst, digits_of(gap / (max(map(abs, right)) or unit)))
        return worst


class ManyDigits:
    """The states for exact inputs, to ``digits`` digits; the motion may lose ``digits`` + ``most_lost`` digits."""

    expected = 24
    """The number of a carrier's guard digits that may be lost."""
    step = 50
    """The number of digits added at a time, so that few set-ups serve many calls."""
    most_lost = MOST_LOST
    """The number of digits that a motion may lose, beyond the number requested."""

    def __init__(self, digits: int, carrier: Carrier) -> None:
        self.digits = digits
        # the carrier in use, the first carrier, which has the fewest digits, and the carrier with the most digits
        self.carrier = self._first = self._finest = carrier
        # the nearest time, in units of the user, for which the digits of the first carrier did not suffice
        self._too_far: Real = inf

    def carrier_of(self, digits: int) -> Carrier:
        """A :class:`Carrier` of the motion whose results have ``digits`` digits."""
        raise NotImplementedError

    def at(self, times: list[Real]) -> tuple[list[Real], list[Any]]:
        """(τ, moving points) at physical times: τ in the user's units, with guard digits."""
        tau, points = self.settled(times, self._at)
        return [self.carrier.unscaled(t) for t in tau], points

    def at_tau(self, tau: list[Real]) -> list[Any]:
        """The moving points at τ."""
        return self.settled(tau, self._points)[1]

    def times(self, tau: list[Real]) -> list[Real]:
        """Physical times at τ, in the user's units."""
        return [self.carrier.unscaled(t) for t in self.settled(tau, self._times)]

    def vectors(self, points: list[Any]) -> list[tuple[Vector[Real], Vector[Real]]]:
        """(γ, M) of the points that :meth:`at` and :meth:`at_tau` returned."""
        return [self.carrier.vectors(point) for point in points]

    def settled(self, times: list[Real], compute: Compute[Found]) -> Found:
        """The result of ``compute``, which is called with more and more digits until none is missing.

        ``compute`` is given the carrier and ``times`` in its units. ``compute`` returns the result and the number of
        missing digits, or None if :meth:`enough` has replaced the carrier. A call starts with the first carrier again,
        unless its digits are known not to suffice. So near times are as fast after a far time as before.
        """
        before, far = self.carrier, farthest(times)
        self.carrier = self._first if far < self._too_far else self._finest
        try:
            while True:
                result = compute(self.carrier, [self.carrier.scaled(t) for t in times])
                if result is None:
                    continue
                found, missing = result
                if missing <= 0:
                    return found
                if times:
                    self._too_far = min(self._too_far, far)
                # if no digit is right, the number of missing digits is unknown
                self.add_digits(min(missing, self.carrier.digits) + WIDER)
        except KeyboardInterrupt:
            self.carrier = before
            raise

    def add_digits(self, more: int) -> None:
        """Replaces the carrier by one with at least ``more`` more digits; PrecisionLoss if too many were lost."""
        digits = self.carrier.digits + more
        if digits > 2 * self.digits + self.most_lost:
            lost = digits - self.digits
            raise PrecisionLoss(
                f"the motion loses more than {self.digits + self.most_lost} digits on the way there, {lost} or more; "
                f"times nearer to 0 are within reach, and MP fields of at least {lost - self.most_lost} digits allow "
                "as many"
            )
        if self._finest.digits < digits:
            self._finest = self.carrier_of(digits)
        self.carrier = self._finest

    def enough(self, tau: Real) -> int | None:
        """The number of digits by which errors may grow until τ; None if the carrier had too few and was replaced."""
        lost = self.carrier.lost(tau)
        missing = lost - self.expected - (self.carrier.digits - self.digits)
        if missing <= 0:
            return lost
        self.add_digits(self.step * ceil(missing / self.step))
        return None

    def _at(self, carrier: Carrier, times: list[Real]) -> tuple[tuple[list[Real], list[Any]], int] | None:
        if not (carrier.rolls and times):
            return self._points(carrier, times)
        # a time that is too far is refused before a clock is made
        lost = self.enough(carrier.most_tau(farthest(times)))
        if lost is None:
            return None
        wanted = self.digits + SPARE + lost
        if len(times) == 1:
            tau = [carrier.tau_alone(times[0], wanted)]
        else:
            # the farthest time shows whether the digits suffice
            if self.enough(abs(carrier.tau([max(times, key=abs)], wanted)[0])) is None:
                return None
            tau = carrier.tau(times, wanted)
        found = self._points(carrier, tau)
        if found is None or found[1] > 0:
            return found
        return found[0], carrier.clock_missing(max(tau, key=abs), self.digits + SPARE)

    def _points(self, carrier: Carrier, tau: list[Real]) -> tuple[tuple[list[Real], list[Any]], int] | None:
        if self.enough(farthest(tau)) is None:
            return None
        points = carrier.points(tau)
        return (tau, points), self._missing(carrier, tau, points)

    def _times(self, carrier: Carrier, tau: list[Real]) -> tuple[list[Real], int] | None:
        lost = self.enough(farthest(tau))
        if lost is None:
            return None
        times = carrier.times(tau, self.digits + SPARE + lost)
        return times, carrier.clock_missing(max(tau, key=abs), self.digits + SPARE) if tau else 0

    def _missing(self, carrier: Carrier, tau: list[Real], points: list[Any]) -> int:
        """The number of requested digits that the points lack; at most 0 if they lack none."""
        wanted = self.digits + SPARE
        missing = carrier.drift(points) + wanted
        far = max(range(len(tau)), key=lambda i: abs(tau[i]), default=None)
        if far is None or missing > 0 or abs(tau[far]) <= carrier.witnessed:
            return missing
        # next to a separatrix a computation and its witness may both lose every digit and end in the same rotation, so
        # the witness has extra digits
        wider = carrier.digits + WIDER + carrier.lost(abs(tau[far]))
        if carrier.witness is None or carrier.witness.digits < wider:
            carrier.witness = self.carrier_of(wider)
        missing = carrier.gap(points[far], carrier.witness, tau[far]) + wanted
        if missing <= 0:
            carrier.witnessed = abs(tau[far])
        return missing


def farthest(times: list[Real]) -> Real:
    """The largest absolute value of the times; 0 if there are none."""
    return max(map(abs, times), default=0)


class RoundedRows:
    """The :class:`integrable.phase.ways.Way` to states that ``many`` computes, rounded to a field: RR or MP(digits)."""

    def __init__(self, field: Field, many: ManyDigits, way: str) -> None:
        self.field, self.many, self.way = field, many, way

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        tau, points = self.many.at(times.tolist())
        return self.rows(points), rounded(self.field, tau)

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        return self.rows(self.many.at_tau(tau.tolist()))

    def times(self, tau: np.ndarray) -> np.ndarray:
        return rounded(self.field, self.many.times(tau.tolist()))

    def rows(self, points: list[Any]) -> np.ndarray:
        """γ and M of moving points, shape (N, 6)."""
        return rounded(self.field, [(*gamma, *M) for gamma, M in self.many.vectors(points)]).reshape(-1, 6)


class BodyCarrier(Carrier):
    """The motion of a body at one internal precision, in bare reals and in the units of ``setup``.

    ``limits`` bound the cost of the clock; finite limits mean that the torus has failed in floats, and no torus is
    tried.
    """

    def __init__(self, setup: Setup, limits: ClockLimits = NONE) -> None:
        self.setup = setup
        self.digits, self.field = setup.digits - GUARD_DIGITS, setup.wide
        self.rolls = setup.problem.d != 0
        self._limits = limits
        self._clocks: dict[int, PanelClock] = {}
        self._torus: LongClock | None = None
        self._least_work = 0.0
        self._alone = False

    def scaled(self, t: Real) -> Real:
        return self.setup.wide.coerce(t) * self.setup.time_scale

    def unscaled(self, t: Real) -> Real:
        return t / self.setup.time_scale

    def lost(self, tau: Real) -> int:
        return lost_digits(self.setup, tau)

    def point(self, tau: Real) -> tuple[Real, ...]:
        setup = self.setup
        sign = -1 if tau < 0 else 1
        with setup.reals:
            cell, x = self._place(abs(setup.reals.number(tau)))
            point = setup.reached(sign, cell)
            if x != 0:
                step = setup.translations.near(sign * x * setup.bare.half_step)
                point = addition.shift(setup.bare.f, setup.bare.axes, point, step)
            return point

    def vectors(self, point: Sequence[Real]) -> tuple[Vector[Real], Vector[Real]]:
        setup, bare = self.setup, self.setup.bare
        with setup.reals as reals:
            gamma, M = vectors(point, bare.momentum, bare.matrix)
        return reals.elements(setup.wide, gamma), reals.elements(setup.wide, M)

    def drift(self, points: list[Sequence[Real]]) -> int:
        return max((digits_of(drift(self.setup, point)) for point in points), default=-NOTHING)

    def tau(self, times: list[Real], digits: int = 0) -> list[Real]:
        """The values of τ at physical times, to the digits of the set-up."""
        setup = self.setup
        # for large m r² τ may run a thousand times faster than t, so τ is estimated from the initial rate
        rate = abs(addition.rate_at(setup.problem.axes, setup.problem.start))
        torus = self._far([t / rate for t in times])
        if torus:
            return [setup.wide.coerce(t) for t in torus.tau([torus.wide.coerce(t) for t in times])]
        result = [setup.wide.zero] * len(times)
        # the farthest time comes first, so that a time out of reach is refused before others are computed
        for i in sorted((i for i, t in enumerate(times) if t != 0), key=lambda i: -abs(times[i])):
            sign = -1 if times[i] < 0 else 1
            cell, x = self._clock(sign).place(setup.reals.number(abs(times[i])))
            with setup.reals:
                tau = sign * (2 * cell + x) * setup.bare.half_step
            result[i] = setup.reals.element(setup.wide, tau)
        return result

    def tau_alone(self, time: Real, digits: int) -> Real:
        near = 0 < abs(float(self.unscaled(time))) <= NEAR_CELLS * self.setup.step_time
        # for a single time, a series of the clock costs more than this method
        if near and self.digits >= ALONE_FROM and not self._alone and not self._clocks and self._limits == NONE:
            self._alone = True
            found = self._one_time(time)
            if found is not None:
                return found
        return super().tau_alone(time, digits)

    def _one_time(self, time: Real) -> Real | None:
        """τ at a physical time by :class:`~integrable.motion.precise_clock.OneTime`; None where it does not apply."""
        setup, sign = self.setup, -1 if time < 0 else 1
        rough = BodyCarrier(setup.finer(ROUGH_DIGITS))
        (found,) = rough.tau([rough.scaled(self.unscaled(time))])
        start = self.scaled(rough.unscaled(found))
        with setup.reals as reals:
            t, near = (abs(reals.number(x)) for x in (time, start))
            tau = OneTime(setup, sign).tau(t, near, self.point)
            return None if tau is None else reals.element(setup.wide, sign * tau)

    def times(self, tau: list[Real], digits: int) -> list[Real]:
        setup, torus = self.setup, self._far(tau)
        if torus:
            return [setup.wide.coerce(t) for t in torus.times([torus.wide.coerce(t) for t in tau])]
        found = []
        for sign, t in ((-1 if t < 0 else 1, t) for t in tau):
            with setup.reals as reals:
                time = self._clock(sign).time(*self._place(abs(reals.number(t))))
                found.append(reals.element(setup.wide, sign * time))
        return found

    def _place(self, tau: Real) -> tuple[int, Real]:
        """Splits τ ≥ 0 into (n, x): the nearest number n of basic steps, and the rest x in half steps."""
        half = self.setup.bare.half_step
        cell = self.setup.reals.nearest(tau / (2 * half))
        return cell, (tau - 2 * cell * half) / half

    def _clock(self, sign: int) -> PanelClock:
        if sign not in self._clocks:
            self._clocks[sign] = PanelClock(self.setup, sign, self._limits)
        return self._clocks[sign]

    def _far(self, tau: list[Real]) -> LongClock | None:
        """The clock on the torus; None where panels cost less, or where the torus degenerates."""
        setup = self.setup
        steps = float(farthest(tau) / setup.step_length)
        if self._limits.most < inf or steps < TORUS_FROM * setup.digits:
            return None
        work = min(WORK_A_STEP * setup.digits * steps, WORK_WITH_ROOM)
        if self._torus is None and work >= self._least_work:
            # for each decimal digit of τ before the point, the phases lose one digit after the point
            whole = setup.wide.exponent(farthest(tau)) * 3 // 10
            self._torus = self._made_torus(work, setup.digits + SPARE - whole)
        return self._torus

    def _made_torus(self, work: float, digits: int) -> LongClock | None:
        """The clock on the torus to this many digits after the point, if its tables need at most ``work``
        multiplications; otherwise None, and the work needed is recorded.
        """
        from integrable.torus.long_clock import LongClock
        from integrable.torus.oval_modes import TooManyModes, modes_of_rate

        setup, self._least_work = self.setup, inf
        digits = min(digits, setup.digits)
        # if branch points are close, digits are lost and errors look like modes of 1/g; a set-up with twice the digits
        # is then tried
        for make in (lambda: setup, lambda: setup.finer(2 * setup.digits)):
            try:
                made = make()
                modes = modes_of_rate(made, digits, most_work=work, mean_digits=setup.digits)
                return LongClock(modes, digits, made.wide)
            except TooManyModes as error:
                self._least_work = error.work
                return None
            except PrecisionLoss:
                continue
        return None


class PreciseFlow(ManyDigits):
    """The motion of a body through a state to ``digits`` digits; ``limits`` are those of its clock."""

    carrier: BodyCarrier
    _first: BodyCarrier

    def __init__(
        self, body: Body, state: State, digits: int, setup: Setup | None = None, limits: ClockLimits = NONE
    ) -> None:
        self._limits = limits
        # a limited clock belongs to a motion that loses digits in floats: extra digits now cost less than another
        # set-up later
        more = self.expected if limits.most < inf else 0
        setup = setup or Setup(body, *state.vectors, state.tilted, digits + more)
        super().__init__(digits, BodyCarrier(setup, limits))

    def carrier_of(self, digits: int) -> BodyCarrier:
        return BodyCarrier(self._first.setup.finer(digits), self._limits)
