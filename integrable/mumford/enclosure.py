"""States of motions of any genus with proven bounds, by additions in balls (:mod:`integrable.mumford.balls`).

The constants of a system, a start and the times count as exact; a start is projected onto its constraints. A state at
any time takes a few additions, so a far time costs little more than bits. If the motion carries its clock, as a
geodesic carries its length, the interval Newton method finds τ at a time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import ceil, frexp
from typing import Any

from integrable.moving_point.balls import time_after
from integrable.mumford.balls import Balls
from integrable.mumford.motion import Placed, Start
from integrable.mumford.translations import GroupTranslations, reference
from integrable.phase.enclosure import EnclosedPath, Row, ball_digits, exact_times, rounded_up, widest
from jacobian import poly
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.relatives.extended import Extended

# initial allowance for lost bits: per genus, and per genus and doubling
OF_GENUS, OF_DOUBLING = 160, 20
SPARE = 64
MOST_BITS, MOST_ATTEMPTS = 2**15, 8
# guard digits of the first guess of τ
GUARD = 6
# largest imaginary part that rounding may leave of a real root, relative to the largest root of f
REAL = 1e-9

Found = tuple[Any, Any]
"""A result computed in balls, and its radius."""


class EnclosedTranslations(GroupTranslations):
    """The translations T(τ) of a motion, computed in balls."""

    def _reference(self) -> tuple[list[Real], list[Real]]:
        # points in different ovals, because balls widen more for points far from all branch points
        K, group = self.field, self.group
        xs = [] if K.complex else list(map(K.coerce, middles_of_ovals(group.f)))[: group.genus + 1]
        ys = [K.sqrt(poly.evaluate(K, group.f, x)) for x in xs]
        more, roots = reference(group)
        return [*xs, *more][: group.genus + 1], [*ys, *roots][: group.genus + 1]

    def _on_curve(self, D: Extended) -> Extended:
        # divisors stay as they are: a better midpoint would not narrow a ball
        return D


def middles_of_ovals(f: poly.Poly) -> list[float]:
    """The midpoints of the bounded intervals where f > 0, between real roots computed in floats."""
    import numpy as np

    size = max(abs(c) for c in f)
    scaled = [float(c / size) for c in f[::-1]]
    found = np.roots(scaled)
    ends = np.sort(found[abs(found.imag) <= REAL * abs(found).max(initial=0)].real)
    return [float(x) for x in (ends[1:] + ends[:-1]) / 2 if np.polyval(scaled, x) > 0]


class EnclosedPlace(Placed):
    """A motion whose divisors are computed in balls."""

    _kind = EnclosedTranslations


class Precisions:
    """A motion in balls, with as many bits as results need.

    ``place`` is that of :class:`integrable.mumford.motion.Placed`.
    """

    def __init__(self, place: Callable[[Any], Start], genus: int, digits: int, complex: bool = False) -> None:
        self._place, self._complex, self._genus, self._digits = place, complex, genus, digits
        self._needed = ceil(3.33 * (digits + 2))
        self._kept: tuple[int, EnclosedPlace | None] = (0, None)

    def narrow(self, read: Callable[[EnclosedPlace], Found], farthest: float) -> tuple[Any, float]:
        """The result of ``read`` with a radius of at most 10^(−digits), and that radius.

        ``farthest`` is the absolute value of the largest requested time. PrecisionLoss if no precision suffices.
        """
        doublings = OF_DOUBLING * max(0, frexp(farthest)[1])
        bits = max(self._kept[0], self._needed + SPARE + self._genus * (OF_GENUS + doublings))
        for _ in range(MOST_ATTEMPTS):
            if bits > MOST_BITS:
                break
            with Balls(bits, self._complex) as K:
                found, radius = self._read(K, read)
                if radius * K.coerce(10).real ** self._digits < 1:
                    return found, rounded_up(radius)
            lost = self._lost(bits, radius)
            bits = max(bits * 5 // 4, self._needed + SPARE + lost) if lost else bits * 3 // 2
        raise PrecisionLoss(
            f"no balls of radius 1e-{self._digits} were found with {min(bits, MOST_BITS)} bits: the motion passes a "
            "special position, or the time is too far; ask for fewer digits, or a nearer time"
        )

    def _read(self, K: Balls, read: Callable[[EnclosedPlace], Found]) -> Found:
        """The result of ``read``; its radius is NaN if no bounds were found."""
        try:
            bits, place = self._kept
            if bits != K.bits or place is None:
                place = EnclosedPlace(K, self._place)
                self._kept = K.bits, place
            return read(place)
        except (PrecisionLoss, ZeroDivisionError):
            return None, K.coerce(0).real / 0

    @staticmethod
    def _lost(bits: int, radius: Any) -> int:
        """The number of bits that the balls have lost; 0 if they have no bounds."""
        if not radius.is_finite():
            return 0
        mantissa, exponent = radius.mid().man_exp()
        return max(0, bits + int(exponent) + int(mantissa).bit_length())


def enclosed_path(flow: Any, times: Sequence[Any], digits: int | None, in_tau: bool = False) -> EnclosedPath:
    """Enclosures of the states of a ``MumfordFlow`` at times, or with ``in_tau`` at values of τ.

    ``times`` are elements of its field.
    """
    system = flow.system
    wanted = ball_digits(system.field, digits)
    precisions = Precisions(flow._place, flow._genus, wanted, system.complex_data)
    clocked = system.clocked and not in_tau
    rows: list[Row] = []
    for time in times:
        guess = flow.tau_near(time, wanted + GUARD) if clocked else None
        farthest = abs(float(time if guess is None else guess))
        read = partial(_state, flow, time, guess)
        (tau, q, p), radius = precisions.narrow(read, farthest)
        rows.append((tau, q, p, radius))
    return EnclosedPath(None if in_tau and system.clocked else exact_times(list(times)), rows, system.size)


def _state(flow: Any, time: Any, guess: Any, place: EnclosedPlace) -> Found:
    """The enclosure (τ, q, p) of a state, and its radius."""
    K, system = place.field, flow.system
    when, start = K.coerce(time), flow._inner(K)
    tau = when if guess is None else _tau(flow, place, when, guess)
    state = system._back(K, start, place.at(tau), when)
    vectors = [(now, _size(before, now)) for before, now in zip(start, state, strict=True)]
    return (tau.real, *state), widest(*vectors)


def _size(before: Sequence[Any], now: Sequence[Any]) -> Any:
    """A lower bound of the largest entry of a vector at the start and now; 1 if all entries are exactly 0."""
    size = max(abs(x).abs_lower() for x in (*before, *now))
    return size if size > 0 else 1


def _tau(flow: Any, place: EnclosedPlace, time: Any, guess: Any) -> Any:
    """An enclosure of the τ that belongs to a time, for a motion that carries its clock."""
    K, clock = place.field, flow.system._clock
    if time == 0:
        return time
    (tau,) = LongField(K.bits).balls([guess])
    return time_after(tau, time - clock(K, place.at(tau))[0], lambda around: clock(K, place.at(around))[1])
