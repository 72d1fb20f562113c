"""The translations T(τ) of a motion with constant direction on a Jacobian of any genus, and their addition.

D(τ + δ) = D(τ) + E(δ) − E for any divisor E of the curve, where E(δ) is the result of moving E along the direction for
the time δ. The reference divisor E has real points away from the branch points. For a short time h, E(h) is computed
from series (:mod:`integrable.mumford.series`). While 2^k h is small, T(2^k h) has points near infinity and is stored as
E_k − E, where E_{k+1} = 2E_k − E. Once it is in general position, T(2^k h) itself is stored. The remainder r of τ
beyond a multiple of h contributes E(r) − E.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from integrable.mumford.fields import elementary
from integrable.mumford.series import PointMotion, through
from jacobian import poly
from jacobian.element import Arithmetic, Real
from jacobian.errors import ArgumentError, PrecisionLoss
from jacobian.relatives.extended import Extended, ExtendedGroup, Lift, PointLift, SecondKind, ThirdKind, scaled

# h is about 2^−PART of the time in which a point of the reference divisor E leaves the disc of its series: each
# term of a series gains at least PART − 1 bits. T(2^k h) is in general position from about k = FRACTION on
PART, FRACTION = 6, 8
# let R be the largest root of the U of E. A translation (U, V) is in general position under two conditions. The roots
# of U are at most NEAR·R in size. At |x| = R the sum of |terms of V| is at most NEAR times √(sum of |terms of f|).
# V is large if the translation nearly contains a point P and its image under y ↦ −y. In genus 4, T(τ) along (1, 0, …)
# for a short τ nearly contains two such pairs of points near x = 0. Sums with such a T lose hundreds of bits
NEAR = 4


class GroupTranslations:
    """The translations T(τ) along ``direction`` on the curve of ``group``.

    All methods must be called inside a ``with`` block of the field of ``group``. If a pair contains a
    branch point that has a lift, ``ends`` includes it. A point of a pair that is a double point of the curve must stay.

    On a model of even degree and odd genus, the sum of two divisors of degree g reduces to one of degree g + 1, which
    its class does not determine. There a point P₀ is added with one divisor, and subtracted with the other.
    """

    _drifts = True
    """Whether rounding moves sums off the curve."""

    def __init__(self, group: ExtendedGroup, direction: Sequence[Real], ends: Sequence[Real] = ()) -> None:
        self.group, self._ends = group, ends
        self.field: Any = group.field
        xs, ys = self._reference()
        g = group.genus
        pair, point = through(self.field, xs[:g], ys[:g]), through(self.field, xs[g:], ys[g:])
        points = [kind.x for kind in group.kinds if isinstance(kind, PointLift)]
        order = self.field.bits // (PART - 1) + 8
        self._series = PointMotion(self.field, group.f, (xs[:g], ys[:g]), direction, points, order)
        self.unit = self.field.coerce(2.0 ** (math.frexp(self._series.reach)[1] - 1 - PART))
        self._start = pair[0]
        zero = self.field.zero
        # ``_with`` holds P₀ if every sum needs it, else nothing; adding ``_back`` subtracts E, and P₀ if it is held
        between = [] if group.odd or group.genus % 2 == 0 else [self._placed(*point, zero, point[0])]
        self._with = tuple(between)
        self._back = tuple(map(group.negate, (self._placed(*pair, zero, pair[0]), *between)))
        self._doubles: dict[int, Extended] = {}
        self._singles: dict[int, Extended | None] = {}
        self._size = group.size_of_x(pair[0])
        self._height = poly.size_at(group.f, self._size)
        # the first k for which :meth:`_check_growth` has not checked T(2^k h)
        self._unseen = FRACTION

    def _reference(self) -> tuple[list[Real], list[Real]]:
        """The abscissas and ordinates of the points of E, then P₀; points of a motion on real ovals stay away."""
        return reference(self.group)

    def carried(self, D: Extended, tau: Real) -> Extended:
        """The divisor D + T(τ), τ ≠ 0."""
        # r = τ − count·h is in [h/2, 3h/2), so that E(r) is not too close to E
        count = self.field.nearest(tau / self.unit) - 1
        place, k = count, 0
        while place:
            # non-adjacent form (Reitwiesner 1960): only a third of the digits are nonzero
            digit = 2 - place % 4 if place % 2 else 0
            if digit:
                D = self.added(D, k, digit)
            place, k = (place - digit) // 2, k + 1
        return self._moved(D, self._near(tau - count * self.unit))

    def added(self, D: Extended, k: int, digit: int) -> Extended:
        """The divisor D + T(2^k h) or D − T(2^k h), by the sign of ``digit``."""
        group = self.group
        if digit < 0:
            return group.negate(self.added(group.negate(D), k, 1))
        S = self._single(k)
        if self._ends:
            self._check_growth(k)
        return self._moved(D, self._double(k)) if S is None else self._with_single(D, S)

    def _check_growth(self, k: int) -> None:
        """Raises PrecisionLoss if adding T(2^k h) may move a point of a pair away from a double point e of the curve.

        A sum of divisors keeps the point at e only up to √eps. Each later sum multiplies this deviation by about
        1/U(e), with the U of T, and all of them together by at most (1/U(e))^(4/3).
        """
        K = self.field
        for j in range(self._unseen, k + 1):
            u = (self._singles[j] or self._doubles[j]).u
            if any(part_at(K, u, e) <= K.eps**0.25 for e in self._ends):
                raise PrecisionLoss("rounding grows beside a double point of the curve: use more digits")
            self._unseen = j + 1

    def _moved(self, D: Extended, E: Extended) -> Extended:
        """D + T, where ``E`` is the reference divisor plus T."""
        return self._corrected(self.group.add(self.group.add(D, E, *self._with), *self._back))

    def _with_single(self, D: Extended, S: Extended) -> Extended:
        """D + S, where S is a result of :meth:`_single`."""
        # on models of odd degree, sums in general position do not drift off the curve, but their lifts do
        return self._corrected(self.group.add(D, S, *self._with), only_lifts=self.group.odd)

    def _corrected(self, D: Extended, only_lifts: bool = False) -> Extended:
        """D moved back onto the curve; with ``only_lifts``, D with its lifts computed again from U and V.

        Where degree and genus are odd, the additions that gave D divided κ by ℓ², ℓ being the leading coefficient of
        f. There each lift (κ, σ, ν) becomes (κℓ², σ/ℓ, ν/ℓ), so that κ is the same at every time.
        """
        group = self.group
        if self._drifts:
            D = group.with_true_lifts(D) if only_lifts else group.retracted(D)
        if not (group.odd and group.genus % 2):
            return D
        c = 1 / group.f[-1]
        data = [
            scaled(group.field, x, c) if isinstance(kind, (Lift, PointLift)) else x
            for kind, x in zip(group.kinds, D.data, strict=True)
        ]
        return D._replace(data=tuple(data))

    def _double(self, k: int) -> Extended:
        """E_k = E + T(2^k h)."""
        # entries are assigned by index, because other threads may compute the same ones
        for j in range(len(self._doubles), k + 1):
            E = self._doubles.get(j - 1)
            self._doubles[j] = self._near(self.unit) if E is None else self._moved(E, E)
        return self._doubles[k]

    def _single(self, k: int) -> Extended | None:
        """T(2^k h), minus P₀ if there is one; None while T(2^k h) is not in general position: its sums lose bits."""
        for j in range(FRACTION + len(self._singles), k + 1):
            S = self._singles.get(j - 1)
            if S is not None:
                S = self._with_single(S, S)
            elif not self._is_general(S := self.group.add(self._double(j), *self._back)):
                S = None
            self._singles[j] = S
        return self._singles.get(k)

    def _is_general(self, D: Extended) -> bool:
        flat = poly.size_at(D.v, self._size) ** 2 < NEAR**2 * self._height
        return bool(self.group.size_of_x(D.u) < NEAR * self._size and flat)

    def _near(self, time: Real) -> Extended:
        """E(time), the reference divisor E moved for a short time, with its data."""
        u, v, omega, thirds = self._series.at(time)
        return self._placed(u, v, omega, self._start, thirds)

    def _placed(
        self, u: poly.Poly, v: poly.Poly, omega: Real, start: poly.Poly, thirds: Sequence[Real] = ()
    ) -> Extended:
        """The pair (u, v) with its data, continued from a reference divisor with U = ``start``, whose lifts have σ = 1.

        ``omega`` and ``thirds`` are the integrals of :meth:`integrable.mumford.series.PointMotion.at` from this divisor
        to (u, v).
        """
        K, data, integrals = self.field, [], iter(thirds)
        for kind in self.group.kinds:
            if isinstance(kind, Lift):
                value, first = (poly.evaluate(K, a, kind.e) for a in (u, start))
                data.append(kind.of(self.group, u, v, K.sqrt(value / first)))
            elif isinstance(kind, PointLift):
                # σ'/σ = ½(U(x)' + n(x)y)/U(x), ' = d/dτ, n the multiplier (mumford.fields); for σ̄ −y replaces y
                value, first = (poly.evaluate(K, a, kind.x) for a in (u, start))
                root, turn = K.sqrt(value / first), elementary(K, "exp", kind.y * next(integrals, K.zero) / 2)
                data.append((-first if len(u) % 2 == 0 else first, root * turn, root / turn))
            elif isinstance(kind, SecondKind):
                data.append(omega)
            else:
                assert isinstance(kind, ThirdKind)
                data.append(elementary(K, "exp", kind.r * omega))
        return Extended(u, v, tuple(data))


def part_at(K: Arithmetic, a: poly.Poly, e: Real) -> Real:
    """|a(e)| relative to the sum of the absolute values of its terms; 0 for the zero polynomial."""
    size = poly.size_at(a, e)
    return abs(poly.evaluate(K, a, e)) / size if size > 0 else abs(K.zero)


def reference(group: ExtendedGroup) -> tuple[list[Real], list[Real]]:
    """The abscissas x and the ordinates y of g + 1 points far from each other and from the branch points.

    They are real points outside the circle that contains the roots of f, on the side where f > 0. Over complex numbers
    they are points around that circle.
    """
    K, f, g = group.field, group.f, group.genus
    lead, degree = f[-1], len(f) - 1
    centre = -f[-2] / (degree * lead)
    shifted = poly.shift(K, f, centre)
    # Fujiwara's bound (1916) on the distance of the roots from the centre
    sizes = [float(abs(c / lead) ** (K.one.real / (degree - i))) for i, c in enumerate(shifted[:-1])]
    reach = 2.0 ** math.frexp(2 * max(sizes) or 1.0)[1]
    if K.complex:
        turns = [complex(math.cos(t), math.sin(t)) for t in (2 * math.pi * j / (g + 1) + 0.5 for j in range(g + 1))]
        xs = [centre + K.coerce(reach * turn) for turn in turns]
    else:
        side = 1 if lead > 0 else -1
        if not group.odd and side < 0:
            raise ArgumentError("f < 0 near infinity on a model of even degree: give the motion over CC or MP complex")
        xs = [centre + K.coerce(side * reach * (1 + j / g)) for j in range(g + 1)]
    return xs, [K.sqrt(poly.evaluate(K, f, x)) for x in xs]
