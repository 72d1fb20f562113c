"""States of a motion on a Jacobian of any genus at any time, to the requested digits.

Every row (the vectors that describe the motion at one time) is computed in long numbers at two precisions 64 bits
apart. It is returned if both results agree in every requested digit; otherwise the precision is raised. So the loss in
additions, about a bit per doubling and some tens of bits per unit of genus, is measured rather than assumed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, NamedTuple

from integrable.mumford.fields import cofactor, elementary, multiplier, rates
from integrable.mumford.translations import GroupTranslations, part_at
from jacobian import poly
from jacobian.element import Real
from jacobian.errors import PrecisionLoss, shown
from jacobian.inexact.long_field import LongField
from jacobian.relatives.extended import Extended, ExtendedGroup, Kind, Lift, PointLift

# a motion is computed at two precisions, APART bits apart; the initial allowance for lost bits is OF_START, plus
# OF_GENUS times the genus, plus OF_DOUBLING for each doubling of the time
APART, OF_GENUS, OF_DOUBLING, OF_START = 64, 48, 3, 64
MOST_BITS = 4000
# precision in bits of the set-up of tori for states in floats, at which recorded formulas compute the starts
BITS_OF_TORUS = 160
# a pair is at rest if its rates, relative to their terms, are at most STILL·eps
STILL = 2.0**16
# the inversion of a clock takes at most MOST_STEPS steps. It ends after a step below h·√eps/SMALL, with the h of
# :mod:`integrable.mumford.translations`: as convergence is quadratic, the next step would be below h·eps
MOST_STEPS, SMALL = 200, 256


class Start(NamedTuple):
    """The start of a motion: f, the pair (u, v) at τ = 0, and the direction of τ.

    ``kinds`` are the data that the pair carries (:class:`Lift`, for example), ``data`` the value of each at τ = 0.
    ``further`` are the directions of any other times on which the pair depends.
    """

    f: poly.Poly
    u: poly.Poly
    v: poly.Poly
    direction: Sequence[Real]
    kinds: Sequence[Kind] = ()
    data: tuple[Any, ...] = ()
    further: Sequence[Sequence[Real]] = ()


Vectors = Sequence[Sequence[Real]]
Read = Callable[[LongField, Extended], Vectors]
TimeAt = Callable[[LongField, Extended], tuple[Real, Real]]
"""A function that returns (t, dt/dτ) at a divisor."""


class Placed:
    """A motion computed over one field: its divisor D at any τ."""

    _kind: type[GroupTranslations] = GroupTranslations

    def __init__(self, field: Any, place: Callable[[LongField], Start]) -> None:
        self.field, self._place = field, place
        start = place(field)
        self.start = Extended(start.u, start.v, start.data)
        self.group = ExtendedGroup(field, start.f, start.kinds)
        self._directions = (start.direction, *start.further)
        self._translations: dict[int, GroupTranslations] = {}
        # the times ``further`` of the last call of :meth:`at`, and D at them and τ = 0: many calls differ only in τ
        self._carried: tuple[tuple[Real, ...], Extended] = ((), self.start)

    def translations(self, which: int = 0) -> GroupTranslations:
        """The translations along direction number ``which``."""
        if which not in self._translations:
            self._translations[which] = self._kind(self.group, self._directions[which], self._ends)
        return self._translations[which]

    @cached_property
    def _ends(self) -> list[Real]:
        """The branch points e such that the pair has a lift at e and a point at e. Where e is a double root of f, this
        point stays at e.
        """
        K, (u, v, _) = self.field, self.start
        lifts = (kind.e for kind in self.group.kinds if isinstance(kind, Lift))
        return [e for e in lifts if max(part_at(K, u, e), part_at(K, v, e)) <= STILL * K.eps**0.5]

    def at(self, tau: Real, further: tuple[Real, ...] = ()) -> Extended:
        """D at the time τ along the first direction and the times ``further`` along the others."""
        if self.rests:
            return self._resting(tau)
        kept, D = self._carried
        if kept != further:
            D = self.start
            for which, time in enumerate(further, 1):
                D = D if time == 0 else self.translations(which).carried(D, time)
            self._carried = further, D
        return D if tau == 0 else self.translations().carried(D, tau)

    def after(self, D: Extended, tau: Real, step: Real) -> Extended:
        """D(τ + step), from D = D(τ)."""
        return self._resting(tau + step) if self.rests else self.translations().carried(D, step)

    def _resting(self, tau: Real) -> Extended:
        """D(τ) of a pair at rest. Only a lift at a point (x, y), y ≠ 0, changes: σ'/σ = ½n(x)y/U(x), with the n of
        :func:`integrable.mumford.fields.multiplier`.
        """
        K, (u, _, data) = self.field, self.start
        n, turned = multiplier(K, u, self._directions[0]), []
        for kind, datum in zip(self.group.kinds, data, strict=True):
            if isinstance(kind, PointLift):
                kappa, sigma, bar = datum
                slope = poly.evaluate(K, n, kind.x) / poly.evaluate(K, u, kind.x)
                turn = elementary(K, "exp", slope * kind.y * tau / 2)
                datum = (kappa, sigma * turn, bar / turn)
            turned.append(datum)
        return self.start._replace(data=tuple(turned))

    @cached_property
    def rests(self) -> bool:
        """Whether the pair is at rest: each point is at a double point of the curve, and T(τ) cannot be added.

        PrecisionLoss if the pair is so close to rest that more bits are needed to decide this, or to compute its
        motion.
        """
        K, moved = self.field, self._moved
        # eps is 0 over a field of balls, where a comparison with 0 is a proof
        if K.eps == 0:
            return moved <= 0
        still = moved <= STILL * K.eps
        if still:
            with LongField(MOST_BITS, K.complex) as L:
                still = Placed(L, self._place)._moved <= STILL * L.eps
        # a sum of divisors with a point at a distance below √eps from a double point of the curve loses that distance
        if not still and moved * moved <= STILL * K.eps:
            raise PrecisionLoss("the state is too near to one at rest: use more digits")
        return still

    @cached_property
    def _moved(self) -> Real:
        """The size of the rates of the pair, relative to the size of their terms."""
        K, (u, v, _), direction = self.field, self.start, self._directions[0]
        w = cofactor(K, self.group.f, u, v)
        size = max(abs(c) for c in (*u, *v, *w)) * max(abs(c) for c in direction)
        moved = rates(K, self.group.f, u, v, direction)
        return max(abs(c) for a in moved for c in a) / size


class MumfordMotion:
    """A motion given by ``place``, a function that returns its :class:`Start` over a field."""

    def __init__(self, place: Callable[[LongField], Start], genus: int, complex: bool = False) -> None:
        self._place = place
        self._complex = complex
        self._genus = genus
        self._placed: dict[int, Placed] = {}
        # t and τ of the last row
        self._reached: tuple[Any, Any] = (None, None)
        # the number of bits, beyond those requested, that has sufficed for all rows so far
        self._extra = OF_START + OF_GENUS * genus

    def row(
        self,
        time: Real,
        read: Read,
        digits: int,
        clock: TimeAt | None = None,
        further: tuple[Real, ...] = (),
        lost: int = 0,
    ) -> Vectors:
        """``read(field, D)`` at a time, as long numbers with ``digits`` correct digits relative to each vector's size.

        ``clock(field, D)`` returns (t, dt/dτ) at D; without it τ is the time. ``further`` are the times along further
        directions. ``lost`` is the number of bits that the motion is known to lose. PrecisionLoss if no precision
        suffices.
        """
        times = (time, *further)
        wanted, size = _bits(digits), max(0, *(math.frexp(float(abs(t)))[1] for t in times))
        extra = self._extra
        while wanted + lost + extra < MOST_BITS:
            bits = wanted + lost + extra + OF_DOUBLING * size
            try:
                rough, fine = (self._read(b, times, read, clock) for b in (bits, bits + APART))
                if _agree(rough, fine, wanted):
                    self._extra = extra
                    return fine
            except (PrecisionLoss, ZeroDivisionError):
                pass
            extra *= 2
        raise PrecisionLoss(
            f"time = {shown(times if further else time)}: the additions lose more than {MOST_BITS} bits; "
            "the motion is on a separatrix or passes a special position"
        )

    def tau_at(self, time: Real, digits: int, clock: TimeAt | None) -> Real:
        """The τ of a time t, found as in :meth:`row`."""
        return self.row(time, lambda K, D: ((self._reached[1],),), digits, clock)[0][0]

    def _read(self, bits: int, times: tuple[Real, ...], read: Read, clock: TimeAt | None) -> Vectors:
        # ``bits`` is rounded up to a multiple of APART, so that the motion is set up at few precisions
        bits = -(-bits // APART) * APART
        with LongField(bits, self._complex) as K:
            if bits not in self._placed:
                self._placed[bits] = Placed(K, self._place)
            placed = self._placed[bits]
            target, *further = map(K.coerce, times)
            if clock is None:
                return read(K, placed.at(target, tuple(further)))
            time, tau = self._reached
            # the guess for τ is the last τ times t/(the last t)
            near = K.coerce(tau) * (target / K.coerce(time)) if time else None
            tau, D = _at_clock(placed, target, clock, near)
            self._reached = times[0], tau
            return read(K, D)


def settled_digits(read: Callable[[LongField], Vectors], digits: int) -> Vectors:
    """The result of ``read`` in long numbers, with ``digits`` correct digits relative to each vector's size.

    The precision is raised until 64 more bits do not change these digits. PrecisionLoss if no precision suffices.
    """
    wanted, extra = _bits(digits), OF_START
    while extra < MOST_BITS:
        rough, fine = (_in_bits(read, bits) for bits in (wanted + extra, wanted + extra + APART))
        if _agree(rough, fine, wanted):
            return fine
        extra *= 2
    raise PrecisionLoss(
        f"no precision up to {MOST_BITS} bits settles this map: the state is at a special position of it"
    )


def _bits(digits: int) -> int:
    return math.ceil(digits * math.log2(10)) + 2


def _in_bits(read: Callable[[LongField], Vectors], bits: int) -> Vectors:
    with LongField(bits) as K:
        return read(K)


def _agree(rough: Vectors, fine: Vectors, wanted: int) -> bool:
    """Whether each vector of ``rough`` agrees with that of ``fine`` in its first ``wanted`` bits."""
    for a, b in zip(rough, fine, strict=True):
        scale = max([abs(x) for x in b], default=0)
        # an infinite scale would make any two vectors agree
        if not scale < math.inf or not all(abs(x - y) * 2**wanted <= scale for x, y in zip(a, b, strict=True)):
            return False
    return True


def _at_clock(placed: Placed, target: Real, clock: TimeAt, near: Real | None) -> tuple[Real, Extended]:
    """(τ, D) at which the clock shows ``target``.

    The search starts at the guess ``near``, or at 0 with the rate there, and continues by Newton's method. Once the
    target is bracketed, each step uses the cubic through the nearest points on either side.
    """
    K, unit, D = placed.field, placed.translations().unit, placed.start
    start, rate = clock(K, D)
    tau, now, low, high, flat = K.zero, start, None, None, K.one / 4
    # |target − t| of the steps so far: convergence is slow if two steps do not reduce it to a quarter
    rests = [math.inf, math.inf]
    for n in range(MOST_STEPS):
        rest = target - now
        if rest == 0:
            return tau, D
        slow = 4 * abs(rest) > rests[-2]
        low, high = ((tau, now, rate), high) if rest > 0 else (low, (tau, now, rate))
        mean = (now - start) / tau if tau else rate
        if near is not None:
            step, near = near - tau, None
        elif n < 2:
            step = rest / mean
        elif low and high:
            # steps by the cubic alone may alternate between both sides forever; bisection ends slow convergence
            step = (low[0] + high[0]) / 2 - tau if slow else _between(low, high, target) - tau
        else:
            # where dt/dτ is small, Newton's step is too long. So the rate is taken as at least ``flat`` times the mean
            # rate; ``flat`` decreases if steps are then too short
            flat = flat / 16 if slow else flat
            step = rest / max(rate, mean * flat)
        if low and high and not low[0] < tau + step < high[0]:
            step = (low[0] + high[0]) / 2 - tau
        # the first step, which is long, starts at τ = 0; a later one starts from D and loses few bits
        D = placed.after(D, tau, step) if n else placed.at(step)
        tau += step
        if abs(step) < unit * K.eps**0.5 / SMALL:
            return tau, D
        now, rate = clock(K, D)
        rests.append(abs(rest))
    raise PrecisionLoss("the clock was not inverted: use more digits")


def _between(low: tuple[Real, ...], high: tuple[Real, ...], target: Real) -> Real:
    """τ at the time ``target``, by Hermite's cubic for τ(t) through two points (τ, t, dt/dτ)."""
    (first, begin, rate), (last, end, other) = low, high
    length = end - begin
    s = (target - begin) / length
    bend = length * s * (1 - s) * ((1 - s) / rate - s / other)
    return first + (last - first) * s * s * (3 - 2 * s) + bend
