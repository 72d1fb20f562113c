"""The exact flow to many digits: the same additions as for floats, in bare reals, at a precision chosen from inside.

Numbers are computed with 30 digits more than asked for, and with as many more as errors can grow by beside a separatrix
(:func:`lost_digits`). What a motion loses is measured as well on every call, from the integrals of all states and from
the farthest state made again with more digits; where the digits do not suffice all is done again with as many more as
were missing.
"""

from __future__ import annotations

from contextlib import suppress
from math import ceil, inf, log, log10
from typing import TYPE_CHECKING, Any

from integrable.motion.precise_clock import PanelClock
from integrable.moving_point import addition
from integrable.moving_point.problem import vectors
from integrable.moving_point.setup import GUARD_DIGITS, Setup
from integrable.phase.body import energy
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.phase.body import Body, Vector
    from integrable.phase.state import State

# digits by which the second computation of the farthest state is wider, beside those that it may lose
WIDER = 10
# what a motion may be expected to lose of the digits that are there beyond those asked for
EXPECTED = 24
# digits are added in steps, so that few set-ups serve many calls
DIGITS_STEP = 50
# digits that a result keeps beyond those asked for
SPARE = 2
# what a motion may lose, beyond as many digits as are asked for: half a minute of computing on the separatrix
MOST_LOST = 400
# from this many basic steps for each digit on, the torus costs less than stepping there
TORUS_FROM = 100


class PreciseMotion:
    """The flow at one internal precision, in bare reals; times and τ are in the units of the setup.

    ``problem`` is what :class:`~integrable.moving_point.setup.Setup` makes one of more digits from, ``most`` how many
    values of 1/g a time may cost: where that is bounded the torus has been tried.
    """

    def __init__(self, setup: Setup, problem: tuple[Body, Vector, Vector, bool], most: float = inf) -> None:
        self.setup = setup
        self._problem = problem
        self._most = most
        self._clocks: dict[int, PanelClock] = {}
        self._torus: Any = None

    def scaled(self, t: Any) -> Any:
        """A time in the units of the setup."""
        return self.setup.wide.coerce(t) * self.setup.time_scale

    def point(self, tau: Any) -> tuple[Any, ...]:
        """The moving point at τ."""
        setup = self.setup
        sign = -1 if tau < 0 else 1
        with setup.reals:
            cell, x = self._place(abs(setup.reals.number(tau)))
            point = setup.bare.reached(sign, cell)
            if x != 0:
                step = setup.translations.near(sign * x * setup.bare.half_step)
                point = addition.shift(setup.bare.f, setup.bare.axes, point, step)
            return setup.reals.plain_row(point)

    def tau(self, times: list[Any]) -> list[Any]:
        """τ at every physical time, wide."""
        setup = self.setup
        if setup.problem.d == 0:
            return times
        # at the first rate: a heavy ball's τ runs a thousand times faster than t
        rate = abs(addition.rate_at(setup.problem.axes, setup.problem.start))
        torus = self._far([t / rate for t in times])
        if torus:
            return [setup.wide.coerce(t) for t in torus.tau([torus.wide.coerce(t) for t in times])]
        result = [setup.wide.zero] * len(times)
        # the farthest first: where that is too far nothing has been computed yet
        for i in sorted((i for i, t in enumerate(times) if t != 0), key=lambda i: -abs(times[i])):
            sign = -1 if times[i] < 0 else 1
            cell, x = self._clock(sign).place(setup.reals.number(abs(times[i])))
            with setup.reals:
                tau = sign * (2 * cell + x) * setup.bare.half_step
            result[i] = setup.reals.element(setup.wide, tau)
        return result

    def time(self, tau: Any) -> Any:
        """Physical time at τ, wide."""
        setup = self.setup
        if setup.problem.d == 0:
            return tau
        torus = self._far([tau])
        if torus:
            return setup.wide.coerce(torus.time(torus.wide.coerce(tau)))
        sign = -1 if tau < 0 else 1
        with setup.reals:
            place = self._place(abs(setup.reals.number(tau)))
            return setup.reals.element(setup.wide, sign * self._clock(sign).time(*place))

    def _place(self, tau: Any) -> tuple[int, Any]:
        """(whole basic steps, half steps beyond them) of τ ≥ 0."""
        half = self.setup.bare.half_step
        cell = self.setup.reals.nearest(tau / (2 * half))
        return cell, (tau - 2 * cell * half) / half

    def _clock(self, sign: int) -> PanelClock:
        if sign not in self._clocks:
            self._clocks[sign] = PanelClock(self.setup, sign, self._most)
        return self._clocks[sign]

    def _far(self, tau: list[Any]) -> Any:
        """The clock on the torus, where it costs less; None where the torus degenerates."""
        setup = self.setup
        if self._most < inf or max(map(abs, tau), default=0) < TORUS_FROM * setup.digits * setup.step_length:
            return None
        if self._torus is None:
            from integrable.torus.long_clock import MultiprecisionTorusClock

            self._torus = False
            # branch points that are close together cost digits, which look like modes of 1/g
            for make in (lambda: setup, lambda: Setup(*self._problem, digits=2 * (setup.digits - GUARD_DIGITS))):
                with suppress(PrecisionLoss):
                    self._torus = MultiprecisionTorusClock(make(), setup.digits)
                    break
        return self._torus or None


class PreciseFlow:
    """The motion through a state to ``digits`` digits relative to exact inputs, whatever is lost on the way.

    ``most`` is how many values of 1/g a time may cost (:class:`~integrable.motion.precise_clock.PanelClock`).
    """

    def __init__(self, body: Body, state: State, digits: int, setup: Setup | None = None, most: float = inf) -> None:
        self._problem = body, state.gamma, state.M, state.tilted
        self.digits = digits
        self._most = most
        self._motion = PreciseMotion(setup or Setup(*self._problem, digits=digits), self._problem, most)
        self._witness: Setup | None = None
        self._witnessed = 0.0

    def at(self, times: list[Any]) -> tuple[list[Any], list[tuple[Any, ...]]]:
        """(τ, moving points) at physical times: in the user's units and in numbers of MP, with guard digits."""
        return self._good(times, lambda motion, scaled: motion.tau(scaled))

    def at_tau(self, tau: list[Any]) -> list[tuple[Any, ...]]:
        """The moving points at τ."""
        return self._good(tau, lambda _, scaled: scaled)[1]

    def times(self, tau: list[Any]) -> list[Any]:
        """Physical times at τ, in the user's units."""
        motion = self._motion
        return [motion.time(motion.scaled(t)) / motion.setup.time_scale for t in tau]

    def vectors(self, points: list[tuple[Any, ...]]) -> list[tuple[tuple[Any, ...], tuple[Any, ...]]]:
        """(γ, M) of the points that :meth:`at` and :meth:`at_tau` returned."""
        setup = self._motion.setup
        matrix = None if setup.tilt is None else setup.tilt.inverse_matrix()
        return [vectors(point, setup.problem.momentum, matrix) for point in points]

    def _good(self, times: list[Any], flow_times: Any) -> tuple[list[Any], list[tuple[Any, ...]]]:
        while True:
            motion = self._motion
            tau = [motion.scaled(t) for t in times]
            # τ ≥ t for an upright body: what t alone is too far for needs no clock
            if self._widened(tau):
                continue
            tau = flow_times(motion, tau)
            if self._widened(tau):
                continue
            points = [motion.point(t) for t in tau]
            missing = self._missing(tau, points)
            if missing <= 0:
                setup = motion.setup
                return [t / setup.time_scale for t in tau], [setup.reals.elements(setup.wide, row) for row in points]
            self._more_digits(missing + WIDER)

    def _widened(self, tau: list[Any]) -> bool:
        """Whether errors may grow by more digits until then than there were; now there are more."""
        setup = self._motion.setup
        missing = self._lost(tau) - EXPECTED - (setup.digits - GUARD_DIGITS - self.digits)
        if missing > 0:
            self._more_digits(DIGITS_STEP * ceil(missing / DIGITS_STEP))
        return missing > 0

    def _lost(self, tau: list[Any]) -> int:
        return lost_digits(self._motion.setup, max(map(abs, tau), default=0))

    def _more_digits(self, more: int) -> None:
        """Start again with that many more digits."""
        digits = self._motion.setup.digits - GUARD_DIGITS + more
        if digits > 2 * self.digits + MOST_LOST:
            lost = self.digits + MOST_LOST
            raise PrecisionLoss(
                f"the motion loses more than {lost} digits on the way there: it depends too strongly on where it "
                "starts; times nearer to 0 are within reach, and MP fields of more digits allow as many more"
            )
        self._motion = PreciseMotion(Setup(*self._problem, digits=digits), self._problem, self._most)
        self._witness, self._witnessed = None, 0.0

    def _missing(self, tau: list[Any], points: list[Any]) -> int:
        """How many of the digits asked for the points lack, 0 or less for none."""
        motion = self._motion
        wanted = self.digits + SPARE
        worst = max((digits_of(drift(motion.setup, point)) for point in points), default=-wanted)
        missing = worst + wanted
        far = max(range(len(tau)), key=lambda i: abs(tau[i]), default=None)
        if far is None or missing > 0 or abs(tau[far]) <= self._witnessed:
            return missing
        # two computations that have both lost every digit may meet in the same rotation
        wider = motion.setup.digits - GUARD_DIGITS + WIDER + self._lost(tau)
        if self._witness is None or self._witness.digits - GUARD_DIGITS < wider:
            self._witness = Setup(*self._problem, digits=wider)
        again = PreciseMotion(self._witness, self._problem).point(tau[far])
        with self._witness.reals:
            number = self._witness.reals.number
            mine = [number(motion.setup.reals.element(motion.setup.wide, x)) for x in points[far]]
            size = 1 + max(map(abs, again))
            missing = digits_of(max(abs(x - y) for x, y in zip(mine, again, strict=True)) / size) + wanted
        if missing <= 0:
            self._witnessed = abs(tau[far])
        return missing


def lost_digits(setup: Setup, tau: Any) -> int:
    """How many digits an error may grow by until τ (in the units of the setup), from the curve.

    At a double root e of f = (x − e)²h, the unstable rotation, the integral τ = Σ∫dx/y is a logarithm over √h: points
    and translations grow like e^(√h·τ), beside it during one passage, to about 16·(distance to the other roots) /
    (distance of the two roots). All other errors grow like τ.
    """
    K = setup.wide
    roots = sorted(setup.problem.branch_points)
    lead, tau = abs(setup.problem.f[5] or setup.problem.f[4]), abs(K.coerce(tau))
    total = K.context.log(1 + tau)
    # the gaps between the ovals and behind the second: a real point passes them in imaginary time only
    for k in range(1, len(roots) - 1, 2):
        middle, gap = (roots[k] + roots[k + 1]) / 2, roots[k + 1] - roots[k]
        others = [abs(middle - e) for e in (*roots[:k], *roots[k + 2 :])]
        square = lead
        for x in others:
            square *= x
        grown = K.sqrt(square) * tau
        near = min(others)
        # below that the gap is rounding
        if gap > K.eps * 10**8 * near:
            grown = min(grown, K.context.log(1 + 16 * near / gap))
        # translations grow alike: an addition loses the digits of both
        total += 2 * grown
    return ceil(float(total) / log(10))


def drift(setup: Setup, point: Any) -> Any:
    """The relative change of H1 or H2, the larger, at a moving point of bare reals."""
    reals = setup.reals
    with reals:
        alpha = setup.bare.axes[:3]
        sigma, nu = point[4:7], point[7:10]
        square = sum(x * x for x in sigma)
        lean = sum(x * y for x, y in zip(sigma, nu, strict=True)) / square
        w = [y - lean * x for x, y in zip(sigma, nu, strict=True)]
        # M = w × γ, γ = σ/|σ|; everything below is relative to the momentum
        M = [w[i - 2] * sigma[i - 1] - w[i - 1] * sigma[i - 2] for i in range(3)]
        h2 = sum(m * m for m in M) / square
        # g² = |σ|²
        h1 = energy(alpha, reals.number(setup.problem.d), sigma, M) / square
        return max(abs(h2 - 1), abs(h1 / reals.number(setup.problem.ratio) - 1))


def digits_of(x: Any) -> int:
    """The decimal exponent of x ≥ 0, rounded up; very small for 0, large for what is no number."""
    if x == 0:
        return -(10**9)
    if not x < 1e9:
        return 10**9
    size = float(x)
    if size > 1e-290:
        return ceil(log10(size))
    scale = 0
    while x < 1e-290:
        x, scale = x * 1e280, scale - 280
    return scale + ceil(log10(float(x)))
