"""The inverse problem of geodesics on an ellipsoid of any dimension: the geodesic from one point to another.

It is solved by a quasi-Newton method on the direct problem of :class:`~integrable.classical.ellipsoid.Ellipsoid`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import acos, sin
from typing import Any

from integrable.classical.ellipsoid import Ellipsoid
from integrable.mumford.flow import Point
from integrable.phase.body import elements
from integrable.phase.precisions import long_digits
from jacobian.element import Real, Value
from jacobian.errors import ArgumentError, PrecisionLoss, shown
from jacobian.linear import pivoted

# the search ends at a residual of LAST rounding units or after MOST steps, each halved at most HALVINGS times
LAST, MOST, HALVINGS = 64, 60, 8
# largest |Σx_i²/a_i − 1| of a point x that is projected onto the ellipsoid
OFF = 1e-6


def joining(ellipsoid: Ellipsoid, first: Iterable[Value], last: Iterable[Value]) -> Point:
    """The state at the point ``first`` that reaches ``last`` at time 1, over RR or MP(digits). |p| is the length of the
    geodesic.

    The search starts in the direction of the chord and finds the shortest geodesic, unless the points are nearly
    opposite. Points near the ellipsoid, |Σx_i²/a_i − 1| ≤ 1e-6, are projected onto it radially. PrecisionLoss if no
    geodesic is found; ArgumentError for a point farther off, or for the same point twice.
    """
    if not isinstance(ellipsoid, Ellipsoid):
        raise ArgumentError(f"ellipsoid = {shown(ellipsoid)}: an Ellipsoid is needed")
    K = ellipsoid.field
    long_digits(K)
    q, target = (_on(ellipsoid, x, name) for name, x in (("first", first), ("last", last)))
    chord = [y - x for x, y in zip(q, target, strict=True)]
    if not any(chord):
        raise ArgumentError(f"last = {shown(last)}: another point than first is needed")
    basis, landing = (_tangents(ellipsoid, x, chord) for x in (q, target))

    # ``missed`` vanishes at both points where the normal line at the target meets the ellipsoid; (end, facing) is the
    # scalar product of the normals at ``end`` and at the target, which is negative at the wrong point
    facing = [x / e / e for x, e in zip(target, ellipsoid.constants, strict=True)]

    def velocity(w: Sequence[Real]) -> tuple[Real, ...]:
        return tuple(K.dot(w, column) for column in zip(*basis, strict=True))

    def missed(w: Sequence[Real]) -> list[Real]:
        (end,) = ellipsoid.flow(ellipsoid._constrained(K, Point(q, velocity(w)))).at([K.one]).q
        if K.dot(end, facing) <= 0:
            raise PrecisionLoss("no geodesic was found: the search has come to the other side of the ellipsoid")
        gap = [x - y for x, y in zip(end, target, strict=True)]
        return [K.dot(e, gap) for e in landing]

    # the first guess is along ``basis[0]``, the chord's projection to the tangent space; its length is that of the arc
    # from q to the target on the circle with this tangent
    along, length = float(K.dot(chord, basis[0])), float(K.sqrt(K.dot(chord, chord)))
    angle = acos(min(1.0, along / length))
    arc = length * angle / sin(angle) if angle else length
    guess = [K.coerce(arc), *[K.zero] * (len(basis) - 1)]
    found = _root(K, missed, guess, max(abs(x) for x in target))
    return ellipsoid._constrained(K, Point(q, velocity(found)))


def _on(ellipsoid: Ellipsoid, x: Iterable[Value], name: str) -> tuple[Real, ...]:
    K, wanted = ellipsoid.field, f"{ellipsoid.size} numbers, a point of the ellipsoid,"
    q = elements(K, x, name, ellipsoid.size, wanted)
    if abs(K.dot(ellipsoid._normal(K, q), q) - 1) > OFF:
        raise ArgumentError(f"{name} = {shown(x)}: {wanted} is needed")
    return ellipsoid._constrained(K, Point(q, q)).q


def _tangents(ellipsoid: Ellipsoid, q: Sequence[Real], chord: Sequence[Real]) -> list[list[Real]]:
    """An orthonormal basis of the tangent space at q; the chord lies in the span of its first vector and the normal."""
    K, size = ellipsoid.field, ellipsoid.size
    units = [[K.one if i == j else K.zero for j in range(size)] for i in range(size)]
    basis: list[list[Real]] = []
    for given in (ellipsoid._normal(K, q), chord, *units):
        rest = list(given)
        for _ in range(2):
            for e in basis:
                part = K.dot(rest, e)
                rest = [x - part * y for x, y in zip(rest, e, strict=True)]
        length, whole = (K.sqrt(K.dot(x, x)) for x in (rest, given))
        # while the basis is incomplete, the remainder of some unit vector is longer than 1/(2·size)
        if length > whole / (2 * size) and len(basis) < size:
            basis.append([x / length for x in rest])
    return basis[1:]


def _root(K: Any, f: Callable[[Sequence[Real]], list[Real]], x: list[Real], size: Real) -> list[Real]:
    """A zero of n functions of n variables by Broyden's method (1965), which starts from difference quotients."""
    norm, y = lambda v: K.sqrt(K.dot(v, v)), f(x)
    step = K.sqrt(K.eps) * norm(x)
    moved = [f([*x[:j], x[j] + step, *x[j + 1 :]]) for j in range(len(x))]
    slopes = [[(column[i] - y[i]) / step for column in moved] for i in range(len(x))]
    for _ in range(MOST):
        if norm(y) <= LAST * K.eps * size:
            return x
        change = pivoted([[*row, -value] for row, value in zip(slopes, y, strict=True)])
        if change is None:
            break
        for _ in range(HALVINGS):
            new = [a + b for a, b in zip(x, change, strict=True)]
            value = f(new)
            if norm(value) <= norm(y):
                break
            change = [b / 2 for b in change]
        square = K.dot(change, change)
        miss = [b - a - K.dot(row, change) for a, b, row in zip(y, value, slopes, strict=True)]
        slopes = [
            [s + m * c / square for s, c in zip(row, change, strict=True)] for row, m in zip(slopes, miss, strict=True)
        ]
        x, y = new, value
    raise PrecisionLoss(
        f"no geodesic was found: {float(norm(y)):.1e} is missed by; the points may be nearly opposite to each other"
    )
