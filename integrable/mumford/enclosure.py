"""States of motions of any genus with proven bounds, by additions in balls (:mod:`integrable.moving_point.balls`).

The constants of a system, a start and the times count as exact; a start is projected onto its constraints. A state at
any time takes a few additions, so a far time needs little more than additional bits. If t is not linear in τ but
computed with the pair, as for geodesics, the interval Newton method finds τ at a time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import frexp
from typing import TYPE_CHECKING, Any

from integrable.moving_point.balls import Balls, time_after
from integrable.mumford.motion import Placed, Start
from integrable.mumford.translations import GroupTranslations, reference
from integrable.phase.enclosure import Enclosure, Precisions, exact_times, widest
from jacobian import poly
from jacobian.element import Real
from jacobian.inexact.long_field import LongField
from jacobian.relatives.extended import Extended

if TYPE_CHECKING:
    from flint import acb, arb

    from integrable.phase.enclosure import Row

    Vectors = tuple[arb, Sequence[arb], Sequence[arb]]

# the initial allowance for lost bits is OF_GENUS times the genus, plus OF_DOUBLING times the genus for each doubling of
# the time
OF_GENUS, OF_DOUBLING = 160, 20
# guard digits of the first guess of τ
GUARD = 6
# largest imaginary part that rounding may leave of a real root, relative to the largest root of f
REAL = 1e-9


class EnclosedTranslations(GroupTranslations):
    """The translations T(τ) of a motion, computed in balls."""

    def _reference(self) -> tuple[list[Real], list[Real]]:
        # points in the middle of ovals come first, because balls widen more for points far from all branch points
        K, group = self.field, self.group
        xs = [] if K.complex else list(map(K.coerce, middles_of_ovals(group.f)))[: group.genus + 1]
        ys = [K.sqrt(poly.evaluate(K, group.f, x)) for x in xs]
        more, roots = reference(group)
        return [*xs, *more][: group.genus + 1], [*ys, *roots][: group.genus + 1]

    def _on_curve(self, D: Extended) -> Extended:
        # divisors stay as they are: a better midpoint would not narrow a ball
        return D

    def _with_true_lifts(self, D: Extended) -> Extended:
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


def places(place: Callable[[Any], Start], digits: int, complex: bool = False) -> Precisions[EnclosedPlace]:
    """A motion in balls at any precision; ``place`` is that of :class:`integrable.mumford.motion.Placed`."""
    return Precisions(lambda bits: EnclosedPlace(Balls(bits, complex), place), digits)


def lost_bits(genus: int, farthest: float) -> int:
    """A guess of the number of bits that balls lose until the time ``farthest`` ≥ 0."""
    return genus * (OF_GENUS + OF_DOUBLING * max(0, frexp(farthest)[1]))


def enclosed_path(flow: Any, times: Sequence[Real], digits: int, in_tau: bool) -> Enclosure:
    """Enclosures of the states of a ``MumfordFlow`` at times, or with ``in_tau`` at values of τ.

    ``times`` are elements of the flow's field.
    """
    system = flow.system
    motion = places(flow._place, digits, system.complex_data)
    clocked = system.clocked and not in_tau
    rows: list[Row] = []
    for time in times:
        guess = flow.tau_near(time, digits + GUARD) if clocked else None
        farthest = abs(float(time if guess is None else guess))
        (tau, q, p), radius = motion.narrow(partial(_state, flow, time, guess), lost_bits(flow._genus, farthest))
        rows.append((tau, q, p, radius))
    return Enclosure(None if in_tau and system.clocked else exact_times(list(times)), rows, system.size)


def _state(flow: Any, time: Real, guess: Real | None, place: EnclosedPlace) -> tuple[Vectors, arb]:
    """The enclosure (τ, q, p) of a state, and its radius."""
    K, system = place.field, flow.system
    when, start = K.coerce(time), flow._inner(K)
    tau = when if guess is None else _tau(flow, place, when, guess)
    state = system._back(K, start, place.at(tau), when)
    vectors = [(now, _size(before, now)) for before, now in zip(start, state, strict=True)]
    return (tau.real, *state), widest(*vectors)


def _size(before: Sequence[arb], now: Sequence[arb]) -> Real:
    """A lower bound of the largest entry of a vector at the start and now; 1 if none is proven different from 0."""
    size = max(abs(x).abs_lower() for x in (*before, *now))
    return size if size > 0 else 1


def _tau(flow: Any, place: EnclosedPlace, time: arb | acb, guess: Real) -> arb | acb:
    """An enclosure of the τ that belongs to a time, for a motion with t among the data of its pairs."""
    K, clock = place.field, flow.system._clock
    if time == 0:
        return time
    (tau,) = LongField(K.bits).balls([guess])
    return time_after(tau, time - clock(K, place.at(tau))[0], lambda around: clock(K, place.at(around))[1])
