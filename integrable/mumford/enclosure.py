"""States of motions of any genus with proven bounds, by additions in balls (:mod:`integrable.moving_point.balls`).

The constants of a system, a start and the times count as exact; a start is projected onto its constraints. A state at
any time takes a few additions, so a far time needs little more than additional bits. For some systems, such as
geodesics, t is not linear in τ but one of the ``data`` of a pair (:class:`jacobian.relatives.extended.Extended`). The
interval Newton method then finds τ at a time.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import frexp
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.moving_point.balls import Balls
from integrable.mumford.motion import Placed
from integrable.mumford.translations import GroupTranslations, reference
from integrable.phase.enclosure import Enclosure, Precisions, enclosed, exact_times, widest
from jacobian import poly
from jacobian.element import Real

if TYPE_CHECKING:
    from flint import acb, arb

    from integrable.phase.enclosure import Vectors

# the initial allowance for lost bits is OF_GENUS times the genus, plus OF_DOUBLING times the genus for each doubling of
# the time
OF_GENUS, OF_DOUBLING = 160, 20
# guard digits of the first guess of τ
GUARD = 6
# a root of f, computed in floats, counts as real if its imaginary part is below REAL times the largest root
REAL = 1e-9


class EnclosedTranslations(GroupTranslations):
    # results are not moved back onto the curve: midpoints nearer to the curve would not narrow the balls
    _drifts = False

    def _reference(self) -> tuple[list[Real], list[Real]]:
        # points in the middle of ovals come first, because balls widen more for points far from all branch points
        K, group = self.field, self.group
        xs = [] if K.complex else list(map(K.coerce, middles_of_ovals(group.f)))[: group.genus + 1]
        ys = [K.sqrt(poly.evaluate(K, group.f, x)) for x in xs]
        more, roots = reference(group)
        return [*xs, *more][: group.genus + 1], [*ys, *roots][: group.genus + 1]


def middles_of_ovals(f: poly.Poly) -> list[float]:
    """The midpoints of the bounded intervals where f > 0, between real roots computed in floats."""
    size = max(abs(c) for c in f)
    scaled = [float(c / size) for c in f[::-1]]
    found = np.roots(scaled)
    ends = np.sort(found[abs(found.imag) <= REAL * abs(found).max(initial=0)].real)
    return [float(x) for x in (ends[1:] + ends[:-1]) / 2 if np.polyval(scaled, x) > 0]


class EnclosedPlace(Placed):
    """A motion whose divisors are computed in balls."""

    _kind = EnclosedTranslations


def lost_bits(genus: int, *times: Real) -> int:
    """A guess of the number of bits that balls lose until the farthest of the times."""
    return genus * (OF_GENUS + OF_DOUBLING * max(0, *(frexp(float(t))[1] for t in times)))


def enclosed_path(flow: Any, times: Sequence[Real], digits: int, in_tau: bool) -> Enclosure:
    """Enclosures of the states of a ``MumfordFlow`` at times, or with ``in_tau`` at values of τ.

    ``times`` are elements of the flow's field.
    """
    system = flow.system
    clocked = system.clocked and not in_tau
    guesses = [flow._motion.tau_at(time, digits + GUARD, flow._clock) for time in times] if clocked else None
    motions = Precisions(partial(PlaceOfFlow, flow), digits)
    rows = enclosed(motions, times, guesses, partial(lost_bits, flow._genus))
    return Enclosure(None if in_tau and system.clocked else exact_times(times), rows, system.size)


class PlaceOfFlow(EnclosedPlace):
    """The motion of a ``MumfordFlow`` in balls, for :func:`integrable.phase.enclosure.enclosed`."""

    def __init__(self, flow: Any, bits: int) -> None:
        self._flow, self._system = flow, flow.system
        super().__init__(Balls(bits, self._system.complex_data), flow._place)

    def scaled(self, time: Real) -> arb | acb:
        return self.field.coerce(time)

    def clock(self, tau: arb | acb) -> arb | acb:
        return self._system._clock(self.field, self.at(tau))[0]

    def rate(self, tau: arb | acb) -> arb | acb:
        return self._system._clock(self.field, self.at(tau))[1]

    def state(self, tau: arb | acb, time: Real) -> tuple[Vectors, arb]:
        start = self._flow._inner(self.field)
        state = self._system._back(self.field, start, self.at(tau), self.scaled(time))
        vectors = [(now, _size(before, now)) for before, now in zip(start, state, strict=True)]
        return (tau.real, *state), widest(*vectors)


def _size(before: Sequence[arb], now: Sequence[arb]) -> Real:
    """A lower bound of the largest |entry| of ``before`` and ``now``; 1 if no entry is proven different from 0."""
    size = max(abs(x).abs_lower() for x in (*before, *now))
    return size if size > 0 else 1
