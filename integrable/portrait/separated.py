"""Motions in separated coordinates, of any genus: each point of the pair turns in an oval of its own.

On y² = f(x) the k-th point moves between real branch points a and b. With x = ½(a + b) − ½(b − a)cos φ_k and f = (x −
a)(b − x)h, dx/y is dφ_k/√h, also at the ends. So an integral along the motion is a sum of functions of one angle each,
a mean rate times φ_k plus a sine series. g such sums are known linear functions of time. They determine the phases
θ_k, which are linear in time, and the frequencies; the mean of p dq over an oval is an action.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, NamedTuple

from jacobian import MP, poly
from jacobian.errors import NotRepresentable, PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.linear import pivoted
from jacobian.numbers.long_reals import BareReals
from jacobian.periods.quadrature import working_numbers
from jacobian.periods.roots import simple_roots

# most nodes of an oval; beyond it, branch points nearly meet
MOST_NODES = 1 << 12
# a root counts as real if its imaginary part is below 2^(−bits/REAL): a double root has half of the digits
REAL = 3
# distance from a branch point, relative to the largest, below which a pole is one
NEAR = 1e-9
# nodes beyond those that the digits need; digits of π beyond them
SPARE_NODES, DIGITS_BEYOND = 8, 5
# ratio of digits to bits
DIGITS_A_BIT = math.log10(2)


class Form(NamedTuple):
    """The differential form numerator·dx/(Π(x − pole)·y); poles at branch points must be regular."""

    numerator: poly.Poly
    poles: tuple[Any, ...] = ()

    def coefficient(self, N: Any, x: Any) -> Any:
        """numerator/Π(x − pole)."""
        value = poly.evaluate(N, self.numerator, x)
        for p in self.poles:
            value = value / (x - p)
        return value


class Separation(NamedTuple):
    """What the sums of forms over a pair are, in numbers of one field.

    Those of the g ``forms`` grow with the ``rates``. The one of ``action`` is p dq without the further angles. A
    further angle grows by its form in ``turns``, and by the constant rate next to it; its action is in ``momenta``.
    Where time is no such sum, the rates are per unit of τ, and dt/dτ is the product of ``factor(x)`` over two points.
    """

    forms: Sequence[Form]
    rates: Sequence[Any]
    action: Form | None = None
    turns: Sequence[tuple[Form, Any]] = ()
    momenta: tuple[Any, ...] = ()
    factor: Callable[[Any], Any] | None = None


class PointOval(NamedTuple):
    """The oval x = middle − radius·cos φ; f is −lead·(x − a)(b − x)Π((x − re)² + im²) over ``others`` (re, im²).

    A real root has one factor x − re, and im² is None.
    """

    lead: Any
    middle: Any
    radius: Any
    others: tuple[tuple[Any, Any], ...]

    def weight(self, N: LongField, x: Any) -> Any:
        """1/√h."""
        h = -self.lead
        for e, square in self.others:
            h *= x - e if square is None else (x - e) ** 2 + square
        return 1 / N.sqrt(h)

    def decay(self, points: Sequence[complex]) -> float:
        """The rate at which the modes of a function of φ decrease, singular at ``points`` and other branch points."""
        roots = [complex(float(e), 0 if s is None else math.sqrt(float(s))) for e, s in self.others]
        middle, radius, rate = float(self.middle), float(self.radius), math.inf
        for e in (*roots, *points):
            z = abs(e - middle - radius) + abs(e - middle + radius)
            # Bernstein's ellipse through e
            rate = min(rate, math.acosh(max(1.0, z / (2 * radius))) if radius else math.inf)
        return rate


class SeparatedTorus:
    """The ovals of a motion and integrals over them, in the numbers of a LongField that is entered.

    ``spectral`` is the curve f and the pair u, v of the start. NotRepresentable if its points are not one in each
    of g bounded real ovals, PrecisionLoss if branch points nearly meet.
    """

    def __init__(self, N: LongField, spectral: Sequence[poly.Poly], separation: Separation) -> None:
        f, u, v = spectral
        self._field, self.separation = N, separation
        curve, points = real_and_complex(N, f), real_and_complex(N, u)[0]
        if len(points) < len(u) - 1:
            raise NotRepresentable("the points of this motion are complex: they turn in no ovals")
        self.ovals = [_around(f[-1], curve, x) for x in points]
        if len({oval.middle for oval in self.ovals}) < len(points):
            raise NotRepresentable("two points of this motion share an oval: it has no separate turns")
        self.start = [_angle(N, oval, x, poly.evaluate(N, v, x)) for oval, x in zip(self.ovals, points, strict=True)]
        self._known = [complex(x) for x in curve[0]]
        self._pi = N.coerce(MP(DIGITS_BEYOND + math.ceil(N.bits * DIGITS_A_BIT)).context.pi)

    @property
    def one(self) -> Any:
        """The number 1."""
        return self._field.one

    @cached_property
    def _values(self) -> list[list[list[Any]]]:
        """The coefficients of dφ of the forms and of the further angles, at the nodes of each oval."""
        forms = [*self.separation.forms, *(form for form, _ in self.separation.turns)]
        return [self._sampled(oval, forms) for oval in self.ovals]

    def _sampled(
        self, oval: PointOval, forms: Sequence[Form], factor: Callable[[Any], Any] | None = None
    ) -> list[list[Any]]:
        """The coefficients of dφ, times ``factor``, at φ = π(k + ½)/n."""
        import gmpy2

        N = self._field
        poles = [complex(p) for form in forms for p in form.poles]
        size = max(map(abs, (*poles, *self._known)), default=1.0)
        apart = [p for p in poles if min(abs(p - e) for e in self._known) > NEAR * size]
        wanted = N.bits * math.log(2) / max(oval.decay(apart), 1e-9) + SPARE_NODES
        if wanted > MOST_NODES:
            raise PrecisionLoss("branch points nearly meet: the motion is too near to a separatrix")
        count = math.ceil(wanted)
        rows: list[list[Any]] = [[] for _ in forms]
        for k in range(count):
            x = oval.middle - oval.radius * gmpy2.cos(self._pi * (2 * k + 1) / (2 * count))
            weight = oval.weight(N, x) * (factor(x) if factor else N.one)
            for row, form in zip(rows, forms, strict=True):
                row.append(weight * form.coefficient(N, x))
        return rows

    @cached_property
    def means(self) -> list[list[Any]]:
        """For each oval, the means over φ of what :attr:`_values` has."""
        return [[sum(row) / len(row) for row in rows] for rows in self._values]

    def phase_of(self, sums: Sequence[Any]) -> list[Any]:
        """The phases in turns, one for each oval, where the forms have these sums."""
        N, genus = self._field, len(self.ovals)
        rows = [[2 * self._pi * means[j] for means in self.means] + [N.coerce(sums[j])] for j in range(genus)]
        found = pivoted(rows)
        if found is None:
            raise PrecisionLoss("the periods of the motion are not independent")
        return found

    @cached_property
    def _waves(self) -> list[list[list[Any]]]:
        """For each oval and form, 2w_n/n for n = 1, 2, …, where w_n are the modes of its coefficient of dφ."""
        import gmpy2

        found = []
        for rows in self._values:
            count = len(rows[0])
            cosines = [gmpy2.cos(self._pi * k / (2 * count)) for k in range(4 * count)]
            turned = [[cosines[n * (2 * k + 1) % (4 * count)] for k in range(count)] for n in range(1, count)]
            found.append([[2 * self._field.dot(row, c) / (n * count) for n, c in enumerate(turned, 1)] for row in rows])
        return found

    def _sums(self, angles: Sequence[Any]) -> list[Any]:
        """The sums over the points of the integrals of all forms from the lower ends to these angles."""
        import gmpy2

        found = [self._field.zero] * len(self.means[0])
        for phi, means, waves in zip(angles, self.means, self._waves, strict=True):
            sine, twice = gmpy2.sin(phi), 2 * gmpy2.cos(phi)
            for j, (mean, row) in enumerate(zip(means, waves, strict=True)):
                # Clenshaw's recurrence for a sine series
                last, now = self._field.zero, self._field.zero
                for c in reversed(row):
                    last, now = now, c + twice * now - last
                found[j] += mean * phi + sine * now
        return found

    @cached_property
    def phases(self) -> list[Any]:
        """The phases of the start, in turns: one for each oval, 0 at its lower end."""
        return self.phase_of(self._sums(self.start))

    @cached_property
    def frequencies(self) -> list[Any]:
        """Turns per unit of time: of each point in its oval, upwards where y > 0, then of the further angles."""
        found = self.phase_of(self.separation.rates)
        if self.separation.factor is not None:
            found = [nu / self._slowness(self.separation.factor) for nu in found]
        genus = len(found)
        for j, (_, rate) in enumerate(self.separation.turns, genus):
            turned = sum((nu * means[j] for nu, means in zip(found[:genus], self.means, strict=True)), self._field.zero)
            found.append(rate / (2 * self._pi) + turned)
        return found

    def _slowness(self, factor: Callable[[Any], Any]) -> Any:
        """The mean of the product of ``factor`` over two points: a quotient of determinants of integrals."""
        slowed = [self._sampled(oval, self.separation.forms, factor) for oval in self.ovals]
        areas = []
        for table in [[sum(row) / len(row) for row in rows] for rows in slowed], self.means:
            (a, b), (c, d) = table
            areas.append(a * d - b * c)
        return areas[0] / areas[1]

    @cached_property
    def actions(self) -> list[Any] | None:
        """(1/2π)∮p dq along the same cycles; None if the system has no action form."""
        form = self.separation.action
        if form is None:
            return None
        samples = (self._sampled(oval, [form])[0] for oval in self.ovals)
        return [*(sum(row) / len(row) for row in samples), *self.separation.momenta]


def real_and_complex(N: LongField, a: poly.Poly) -> tuple[list[Any], list[Any]]:
    """The real roots of a polynomial in ascending order, and its complex ones of positive imaginary part."""
    K = MP(math.ceil(N.bits * DIGITS_A_BIT))
    numbers, convert = working_numbers(K), BareReals(N.bits).element
    found = simple_roots(numbers, [numbers.real(convert(K, c)) for c in a])
    size, least = max(map(abs, found)), numbers.context.mpf(2) ** -(N.bits // REAL)
    real = sorted(N.coerce(x.real) for x in found if abs(x.imag) <= least * size)
    return real, [(N.coerce(x.real), N.coerce(x.imag)) for x in found if x.imag > least * size]


def _around(lead: Any, roots: tuple[list[Any], list[Any]], x: Any) -> PointOval:
    """The oval of real points that holds x, or is next to it where rounding left it outside."""
    real, pairs = roots
    last = len(real) - 1
    # f > 0 between every second pair of neighbours
    first = (last - (0 if lead > 0 else 1)) % 2
    places = range(first, last, 2)
    if not places:
        raise NotRepresentable("a point of this motion is in no bounded oval: the motion is unbounded")
    k = min(places, key=lambda k: max(real[k] - x, x - real[k + 1], 0))
    below, above = real[k], real[k + 1]
    others = [(e, None) for e in (*real[:k], *real[k + 2 :])] + [(e, s * s) for e, s in pairs]
    return PointOval(lead, (below + above) / 2, (above - below) / 2, tuple(others))


def _angle(N: LongField, oval: PointOval, x: Any, y: Any) -> Any:
    """φ of a point of an oval."""
    import gmpy2

    return gmpy2.atan2(y * oval.weight(N, x), oval.middle - x)
