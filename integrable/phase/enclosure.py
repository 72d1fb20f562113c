"""States with proven bounds (enclosures): the search for the number of bits that they need, and for τ at a time.

Each kind of motion has a class of motions in balls (:class:`InBalls`), from which :func:`enclosed` computes the states.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from functools import partial
from math import ceil
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

import numpy as np

from integrable.phase.precisions import FLOAT_DIGITS
from jacobian import RR
from jacobian.element import Real
from jacobian.errors import PrecisionLoss, whole
from jacobian.fields.multiprecision import MOST_DIGITS
from jacobian.immutable import Record
from jacobian.numbers.long_reals import BallReals

if TYPE_CHECKING:
    from flint import arb

    Vectors = tuple[arb, Sequence[arb], Sequence[arb]]
    """τ and the two vectors of a state."""
    Row = tuple[arb, Sequence[arb], Sequence[arb], float]
    """τ, the two vectors of a state, and the largest radius."""
    Ends = tuple[tuple[int, int], tuple[int, int]]
    Column = Sequence[Ends]
    Sizes = Sequence[float]

MOST_LOST_BITS, MOST_ATTEMPTS = 2**15, 8
# largest number of balls of τ tried by Newton's method
MOST_TRIALS = 12
# bits that results keep beyond the requested digits
SPARE_BITS = 16


class Enclosure(Record):
    """Balls (``flint.arb``) that contain the states of a motion: ``q`` and ``p`` of shape (N, n), for a body also
    called ``gamma`` and ``M``.

    ``tau`` and ``times`` have shape (N,); ``times`` is None where τ was given and t is not linear in τ. ``radius``,
    shape (N,), is the largest radius in each row, as a float rounded up and at least 2.2e-308. It is relative to |γ|
    and |M|; for other systems, to the largest component that q, or p, has at the start or in that row.
    """

    def __init__(self, times: Sequence[arb] | np.ndarray | None, rows: Sequence[Row], size: int = 3) -> None:
        self.times = None if times is None else np.array(times, dtype=object)
        self.tau = np.array([row[0] for row in rows], dtype=object)
        self.q = np.array([x for row in rows for x in row[1]], dtype=object).reshape(len(rows), size)
        self.p = np.array([x for row in rows for x in row[2]], dtype=object).reshape(len(rows), size)
        self.radius = np.array([row[3] for row in rows], dtype=float)

    @property
    def gamma(self) -> np.ndarray:
        """γ of a body, the same array as ``q``."""
        return self.q

    @property
    def M(self) -> np.ndarray:
        """M of a body, the same array as ``p``."""
        return self.p

    def __len__(self) -> int:
        return len(self.tau)

    def __repr__(self) -> str:
        return f"<Enclosure of {len(self)} states, largest radius {self.radius.max(initial=0):.2g}>"

    def _value(self) -> tuple[object, ...]:
        # flint's balls are equal only if they are points, and cannot be pickled
        columns = (self.times, self.tau, self.q, self.p)
        balls = (None if a is None else tuple(map(_ends, a.ravel())) for a in columns)
        return (self.q.shape[1], *balls, tuple(self.radius.tolist()))

    def __reduce__(self) -> tuple[object, ...]:
        return _rebuilt, self._value()


Enclosed = TypeVar("Enclosed")
Found = TypeVar("Found")


class Precisions(Generic[Enclosed]):
    """A motion in balls, with as many bits as its results need; ``made(bits)`` is the motion with a given number of
    bits.
    """

    def __init__(self, made: Callable[[int], Enclosed], digits: int) -> None:
        self._made, self._digits, self._needed = made, digits, ceil(3.33 * (digits + 2))
        self._kept: tuple[int, Enclosed | None] = (0, None)

    def narrow(self, read: Callable[[Enclosed], tuple[Found, arb]], lost: int) -> tuple[Found, float]:
        """The result of ``read`` with a radius of at most 10^(−digits), and that radius; ``read(motion)`` returns both.

        ``lost`` is a guess of the number of bits that balls lose. PrecisionLoss if no precision suffices.
        """
        bits = max(self._kept[0], self._needed + SPARE_BITS + lost)
        for _ in range(MOST_ATTEMPTS):
            if bits > self._needed + MOST_LOST_BITS:
                break
            found = self._read(bits, read)
            if found is not None and found[1] * 10**self._digits < 1:
                return found[0], rounded_up(found[1])
            lost = _lost_bits(bits, found[1]) if found else 0
            bits = max(bits * 5 // 4, self._needed + SPARE_BITS + lost) if lost else bits * 3 // 2
        raise PrecisionLoss(
            f"no balls of radius 1e-{self._digits} were found with up to {MOST_LOST_BITS} spare bits: "
            "the motion passes a special position, or the time is too far; ask for fewer digits, or a nearer time"
        )

    def _read(self, bits: int, read: Callable[[Enclosed], tuple[Found, arb]]) -> tuple[Found, arb] | None:
        """The result of ``read`` and its radius; None if no bounds were found."""
        try:
            with BallReals(bits):
                kept, motion = self._kept
                if kept != bits or motion is None:
                    motion = self._made(bits)
                    self._kept = bits, motion
                return read(motion)
        except (PrecisionLoss, ZeroDivisionError):
            return None


def _lost_bits(bits: int, radius: arb) -> int:
    """The number of bits that balls with this radius have lost; 0 if the radius is infinite."""
    if not radius.is_finite():
        return 0
    mantissa, exponent = radius.mid().man_exp()
    return max(0, bits + int(exponent) + int(mantissa).bit_length())


class InBalls(Protocol):
    """A motion in balls of one precision. ``scaled(time)`` is a time or a value of τ as an exact ball in the unit of
    the motion; ``clock(tau)`` is t at an exact τ ≠ 0, and ``rate(tau)`` is dt/dτ on a ball of τ, in that unit.
    ``state(tau, time)`` is the state at a ball τ, and its largest radius.
    """

    def scaled(self, time: Real) -> Any: ...

    def clock(self, tau: Any) -> Any: ...

    def rate(self, tau: Any) -> Any: ...

    def state(self, tau: Real, time: Real) -> tuple[Vectors, arb]: ...


Moving = TypeVar("Moving", bound=InBalls)


def enclosed(
    motions: Precisions[Moving], times: Sequence[Real], guesses: Sequence[Real] | None, lost: Callable[[Real], int]
) -> list[Row]:
    """τ, state and radius at each of the ``times``: physical times, for which ``guesses`` are approximate values of τ,
    or values of τ if there are no guesses. ``lost(τ)`` is a guess of the number of bits that balls lose until τ.
    """

    def read(motion: Moving, i: int) -> tuple[Vectors, arb]:
        tau = motion.scaled(times[i])
        if guesses is not None and times[i] != 0:
            near = motion.scaled(guesses[i]).mid()
            tau = time_after(near, tau - motion.clock(near), motion.rate)
        return motion.state(tau, times[i])

    places = times if guesses is None else guesses
    rows: dict[int, Row] = {}
    # the farthest time comes first: it may need the most bits, and a motion made with these serves the other times too
    for i in sorted(range(len(times)), key=lambda i: -abs(places[i])):
        vectors, radius = motions.narrow(partial(read, i=i), lost(places[i]))
        rows[i] = (*vectors, radius)
    return [rows[i] for i in range(len(times))]


def time_after(tau: arb, rest: arb, rate: Callable[[arb], arb]) -> arb:
    """A ball that contains the τ at which a clock has advanced by ``rest`` since the exact ``tau``, by the interval
    Newton method. ``rate`` gives dt/dτ on a ball of τ and must be provably positive. PrecisionLoss if no ball is found.
    """
    from flint import arb

    width = abs(rest).abs_upper() * 4
    for _ in range(MOST_TRIALS):
        slope = rate(tau + arb(0, width))
        step = rest / slope
        # over this ball t(τ) increases by more than ``rest``, so that the ball contains the wanted τ
        if slope > 0 and abs(step).abs_upper() < width:
            return tau + step
        width = 4 * abs(step).abs_upper() if step.is_finite() else width / 4
    raise PrecisionLoss("dt/dτ could not be bounded at this precision: use more digits")


def ball_digits(field: Any, digits: int | None) -> int:
    """``digits``, checked, or the default number of digits of balls: that of the field, 15 for RR."""
    if digits is None:
        return FLOAT_DIGITS if field is RR else int(field.dps)
    return whole(digits, "digits", f"the balls' digits are an int ≥ 1, {MOST_DIGITS} at most", 1, MOST_DIGITS)


def exact_times(times: Sequence[Real]) -> list[arb]:
    """The given times as balls of radius 0."""
    return list(BallReals(64).row(float(t) if isinstance(t, float) else t for t in times))


def is_bounded(values: Sequence[arb]) -> bool:
    """Whether every ball has a finite radius."""
    return all(x.is_finite() for x in values)


def widest(*vectors: tuple[Sequence[arb], Real]) -> arb:
    """An upper bound of the largest radius of the balls in (vector, size) pairs, each relative to the size. NaN if a
    radius is not finite.
    """
    from flint import arb

    found = [x / size for vector, size in vectors for x in vector]
    return max(x.rad() for x in found).abs_upper() if is_bounded(found) else arb("nan")


def rounded_up(radius: arb) -> float:
    """The radius rounded up to a float."""
    return max(float(radius) * (1 + 2.0**-50), sys.float_info.min)


def _ends(ball: arb) -> Ends:
    (m, e), (r, k) = ball.mid().man_exp(), ball.rad().man_exp()
    return (int(m), int(e)), (int(r), int(k))


def _ball(ends: Ends) -> arb:
    """The ball with the midpoint and radius of :func:`_ends`. flint rounds a given radius up, to 30 bits, so a radius
    smaller by a unit is tried first.
    """
    from flint import arb

    middle, (mantissa, exponent) = ends
    radius, shift = arb(ends[1]), 30 - mantissa.bit_length()
    for less in (1, 0) if mantissa else ():
        ball = arb(middle, arb(((mantissa << shift) - less, exponent - shift)))
        if ball.rad() == radius:
            return ball
    return arb(middle, radius)


def _rebuilt(size: int, times: Column | None, tau: Column, first: Column, second: Column, radius: Sizes) -> Enclosure:
    def balls(values: Column) -> list[arb]:
        with BallReals(64).at(max((m.bit_length() for (m, _), _ in values), default=1) + 64):
            return list(map(_ball, values))

    vectors = (zip(*[iter(balls(values))] * size, strict=True) for values in (first, second))
    rows = list(zip(balls(tau), *vectors, radius, strict=True))
    return Enclosure(None if times is None else balls(times), rows, size)
