"""The real ovals of a curve y² = f(x) in which the points of Mumford's pair turn, and forms on them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

from jacobian import poly
from jacobian.element import FormulaField, Real
from jacobian.errors import NotRepresentable
from jacobian.inexact.long_field import LongField
from jacobian.periods.roots import all_roots, horner

# roots are computed to a relative change of ROUNDED·eps
ROUNDED = 64
# a root counts as real if its imaginary part is below 2^(−bits/REAL): a double root is known to half of the digits only
REAL = 3
# a value of a polynomial below 2^ROUNDED_BITS rounding units of its terms may be rounding
ROUNDED_BITS = 12
DIGITS_A_BIT = math.log10(2)


Halves: TypeAlias = "Sequence[tuple[Any, Any]]"
"""(sin ½φ, cos ½φ) of each point: long numbers, or arrays."""
Roots = tuple[list[Real], list[tuple[Real, Real]]]
"""The real roots, and (real part, imaginary part) of the complex roots with positive imaginary part."""


class Form(NamedTuple):
    """The differential form numerator·dx/(Π(x − pole)·y); at a pole that is a branch point the form must be regular."""

    numerator: poly.Poly
    poles: tuple[Real, ...] = ()

    def coefficient(self, x: Real) -> Real:
        """The quotient numerator/Π(x − pole) at x."""
        value: Real = horner(self.numerator, x)
        for p in self.poles:
            value = value / (x - p)
        return value


class Separation(NamedTuple):
    """The differential forms whose sums over the points of a pair are known, in numbers of one field.

    The sums of the g ``forms`` grow at the ``rates``. The sum of ``action`` is p dq without the terms of angles about
    an axis. The rate of such an angle is the sum of a form plus a constant: ``turns`` are these pairs, and ``momenta``
    the actions of the angles. ``known`` are branch points that are known exactly. Where no sum of forms is the time,
    the rates are per unit of τ, ``slow`` is (e, c) with a branch point e beyond both ovals, and dt/dτ is c/√((e −
    x₁)(e − x₂)).
    """

    forms: Sequence[Form]
    rates: Sequence[Real]
    action: Form | None = None
    turns: Sequence[tuple[Form, Real]] = ()
    momenta: tuple[Real, ...] = ()
    known: tuple[Real, ...] = ()
    slow: tuple[Real, Real] | None = None


class PointOval(NamedTuple):
    """The oval x = middle − radius·cos φ from a to b; f is −lead·(x − a)(b − x)Π((x − re)² + im²) over ``others``.

    ``others`` are (re, im²). A real root has one factor x − re, and im² is None. ``place`` is the number of real roots
    below the oval.
    """

    place: int
    lead: Real
    middle: Real
    radius: Real
    others: tuple[tuple[Real, Real | None], ...]

    def over(self, N: FormulaField) -> PointOval:
        """The oval in the numbers of another field."""
        others = tuple((N.coerce(e), None if s is None else N.coerce(s)) for e, s in self.others)
        return PointOval(self.place, N.coerce(self.lead), N.coerce(self.middle), N.coerce(self.radius), others)

    def weight(self, N: FormulaField, x: Real) -> Real:
        """The value 1/√h at x, with f = (x − a)(b − x)h."""
        h: Real = -self.lead
        for e, square in self.others:
            h *= x - e if square is None else (x - e) * (x - e) + square
        return 1 / N.sqrt(h)

    @property
    def decay(self) -> float:
        """The rate r of decrease, e^(−rn), of the Fourier modes in φ of a function of x that is singular at the other
        branch points.
        """
        middle, radius = float(self.middle), float(self.radius)
        if not radius:
            return math.inf
        roots = [complex(float(e), 0 if s is None else math.sqrt(float(s))) for e, s in self.others]
        # the nearest branch point lies on a Bernstein ellipse, whose semi-axes are radius·cosh r and radius·sinh r
        major = min((abs(e - middle - radius) + abs(e - middle + radius) for e in roots), default=math.inf) / 2
        return math.acosh(max(1.0, major / radius))


class Pole(NamedTuple):
    """The part residue/(x − place) of a coefficient of dφ; its integral over φ is mean·(φ + swing)."""

    place: Real
    residue: Real
    mean: Real
    ratio: Real

    def swing(self, sine: Any, cosine: Any, atan2: Any) -> Any:
        """The continuous branch of 2·atan(ratio·tan ½φ) − φ, from sin ½φ and cos ½φ, long numbers or arrays."""
        # twice the angle from the vector (cos ½φ, sin ½φ) to (cos ½φ, ratio·sin ½φ)
        return 2 * atan2((self.ratio - 1) * sine * cosine, cosine * cosine + self.ratio * sine * sine)


def real_and_complex(N: LongField, a: poly.Poly, known: Sequence[Real] = ()) -> Roots:
    """The real roots of a polynomial in ascending order, and its complex roots with positive imaginary part.

    The roots in ``known`` are taken as exact.
    """
    a = poly.quotient(N, a, poly.from_roots(N, known))
    import gmpy2

    found = all_roots(a, gmpy2.mpc, ROUNDED * N.eps) if len(a) > 1 else []
    least = least_part(N, [*found, *known])
    near = sorted(N.coerce(x.real) for x in found if abs(x.imag) <= least)
    real, pairs = [*known], [(N.coerce(x.real), N.coerce(x.imag)) for x in found if x.imag > least]
    size = max(map(abs, [*near, *known]), default=N.zero)
    while near:
        x = near.pop()
        double = double_root(N, a, (x + near[-1]) / 2, size) if near and x - near[-1] <= least else None
        if double is not None:
            near.pop()
            middle, part = double[0], N.sqrt(max(double[1], N.zero))
        real += [x] if double is None else [middle - part, middle + part]
    return sorted(real), pairs


def double_root(N: LongField, a: poly.Poly, x: Real, size: Real) -> tuple[Real, Real] | None:
    """(c, s) for the two roots c ± √s of a polynomial that nearly meet at x; s = 0 if they meet to the digits of N.

    c is a root of the derivative, and so has all digits. The largest root is of the given ``size``. None if three
    roots nearly meet.
    """
    slope = poly.derivative(N, a)
    bend = poly.derivative(N, slope)
    for _ in range(N.bits.bit_length()):
        curvature = poly.evaluate(N, bend, x)
        if abs(curvature) <= N.root_of_eps * poly.size_at(bend, x):
            return None
        x = x - poly.evaluate(N, slope, x) / curvature
    value = poly.evaluate(N, a, x)
    # the errors of the coefficients are those of products of all roots
    rounded = abs(value) <= N.doubled(N.eps, ROUNDED_BITS) * poly.size_at(a, size)
    return x, N.zero if rounded else -2 * value / curvature


def least_part(N: LongField, roots: Sequence[Real]) -> float:
    """The size up to which an imaginary part of a root, or a distance of two roots, may be rounding."""
    return max(abs(complex(x)) for x in roots) * 2.0 ** -(N.bits // REAL)


def oval_around(lead: Real, roots: Roots, x: Real) -> PointOval:
    """The real oval that contains x, or the nearest one if rounding left x outside."""
    real, pairs = roots
    last = len(real) - 1
    # f > 0 between every second pair of neighbouring real roots
    first = (last - (0 if lead > 0 else 1)) % 2
    # the ranges beyond the least and the largest root have the numbers −1 and ``last``
    ends = [-math.inf, *real, math.inf]
    k = min(range(-first, last + 1, 2), key=lambda k: max(ends[k + 1] - x, x - ends[k + 2], 0), default=-1)
    if not 0 <= k < last:
        raise NotRepresentable("a point of this motion is in no bounded oval: the motion is unbounded")
    below, above = real[k], real[k + 1]
    others: list[tuple[Real, Real | None]] = [(e, None) for e in (*real[:k], *real[k + 2 :])]
    others += [(e, s * s) for e, s in pairs]
    return PointOval(k, lead, (below + above) / 2, (above - below) / 2, tuple(others))


def angle_in(N: LongField, oval: PointOval, x: Real, y: Real) -> Real:
    """The angle φ of a point (x, y) of an oval."""
    import gmpy2

    return gmpy2.atan2(y * oval.weight(N, x), oval.middle - x)
