"""Classes T(τ) of a motion with constant direction on a Jacobian of any genus, and adding them.

D(τ + δ) = D(τ) + E(δ) − E for every divisor E of the curve. E lies where the curve is real and away from its branch
points, and E(h) comes from series (:mod:`integrable.mumford.series`). T(2^k h) is stored as E_k − E, E_{k+1} = 2E_k −
E, while it is small and has points near infinity; later T(2^k h) itself is stored. The remainder r of τ beyond a
multiple of h contributes E(r) − E.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from integrable.mumford.fields import exponential
from integrable.mumford.series import PointMotion, through
from jacobian import poly
from jacobian.errors import ArgumentError, PrecisionLoss
from jacobian.relatives.extended import Extended, ExtendedGroup, Lift, PointLift, SecondKind, ThirdKind

# h is about 2^−FRACTION of the reach of the series, so each coefficient gains that many bits
FRACTION = 8
# the points of T count as not far away within this factor of those of E
NEAR = 4

Pair = tuple[poly.Poly, poly.Poly]


class GroupTranslations:
    """T(τ) along ``direction`` on the curve of ``group``, a group over a :class:`LongField` that has been entered.

    On a model of even degree and odd genus two divisors of degree g leave one of degree g + 1, which its class does not
    determine: there a point P₀ is added with the one, and taken away with the other. ``ends``: of lifts, where the
    pairs that are moved lie in double points of the curve.
    """

    _fraction = FRACTION

    def __init__(self, group: ExtendedGroup, direction: Sequence[Any], ends: Sequence[Any] = ()) -> None:
        self.group, self._ends = group, ends
        self.field: Any = group.field
        xs, ys = self._reference()
        g = group.genus
        pair, point = through(self.field, xs[:g], ys[:g]), through(self.field, xs[g:], ys[g:])
        points = [kind.x for kind in group.kinds if isinstance(kind, PointLift)]
        self._series = self._expanded((xs[:g], ys[:g]), pair, direction, points)
        self._start = pair[0]
        zero = self.field.zero
        # what is added with every divisor, and what is subtracted
        between = [] if group.odd or group.genus % 2 == 0 else [self._placed(*point, zero, point[0])]
        self._with = tuple(between)
        self._back = tuple(map(group.negate, (self._placed(*pair, zero, pair[0]), *between)))
        self._doubles: dict[int, Extended] = {}
        self._singles: dict[int, Extended | None] = {}
        self._size = group.size_of_x(pair[0])
        # the first k for which the growth of T(2^k h) has not been checked
        self._unseen = self._fraction

    def _reference(self) -> tuple[list[Any], list[Any]]:
        """The points of E and P₀, which points of a motion on real ovals do not come near to."""
        return reference(self.group)

    def _expanded(self, points: Any, pair: Pair, direction: Sequence[Any], others: Sequence[Any]) -> Any:
        """E(τ) near E, given as (xs, ys) and as a pair, with the third-kind integrals of ``others``: what has ``at(τ)``
        as a :class:`~integrable.mumford.series.PointMotion` has. Sets the ``unit`` h.
        """
        order = self.field.bits // (FRACTION - 1) + 8
        found = PointMotion(self.field, self.group.f, points, direction, others, order)
        self.unit = self.field.coerce(2.0 ** (math.frexp(found.reach)[1] - 1 - FRACTION))
        return found

    def carried(self, D: Extended, tau: Any) -> Extended:
        """D + T(τ)."""
        if tau == 0:
            return D
        # r = τ − count·h in [h/2, 3h/2): E(r) is not too near to E
        count = self._count(tau)
        place, k = count, 0
        while place:
            # non-adjacent form (Reitwiesner 1960): a third of the digits are not 0
            digit = 2 - place % 4 if place % 2 else 0
            if digit:
                D = self.added(D, k, digit)
            place, k = (place - digit) // 2, k + 1
        return self._moved(D, self._near(tau - count * self.unit))

    def _count(self, tau: Any) -> int:
        return self.field.nearest(tau / self.unit) - 1

    def added(self, D: Extended, k: int, digit: int) -> Extended:
        """D ± T(2^k h)."""
        group = self.group
        if digit < 0:
            return group.negate(self.added(group.negate(D), k, 1))
        S = self._single(k)
        if self._ends:
            self._check_growth(k)
        return self._moved(D, self._double(k)) if S is None else self._with_single(D, S)

    def _check_growth(self, k: int) -> None:
        """PrecisionLoss if T(2^k h) may move a pair away from a double point e in which it lies and should stay.

        Sums keep it there to √eps, in all precisions alike. Along a motion that leaves the neighbourhood this grows as
        1/U(e) of T does, up to 4/3 powers of it for all T together.
        """
        K = self.field
        for j in range(self._unseen, k + 1):
            u = (self._singles[j] or self._doubles[j]).u
            if any(part_at(K, u, e) <= K.eps**0.25 for e in self._ends):
                raise PrecisionLoss("rounding grows beside a double point of the curve: use more digits")
            self._unseen = j + 1

    @property
    def reference(self) -> Extended:
        """E."""
        return self._near(self.field.zero)

    def from_reference(self, D: Extended) -> Extended:
        """D − E, less P₀ where there is one."""
        return self.group.add(D, *self._back)

    def _moved(self, D: Extended, E: Extended) -> Extended:
        """D + E minus the reference."""
        return self._settled(self._on_curve(self.group.add(self.group.add(D, E, *self._with), *self._back)))

    def _with_single(self, D: Extended, S: Extended) -> Extended:
        """D + S, with S from :meth:`_single`."""
        total = self.group.add(D, S, *self._with)
        # in general position sums on models of odd degree do not drift off the curve
        return self._settled(total if self.group.odd else self._on_curve(total))

    def _settled(self, D: Extended) -> Extended:
        """D with the original κ of its lifts: two sums in odd genus have divided it by ℓ²."""
        group = self.group
        if not (group.odd and group.genus % 2):
            return D
        c = 1 / group.f[-1]
        data = [
            kind.scaled(group, x, c) if isinstance(kind, (Lift, PointLift)) else x
            for kind, x in zip(group.kinds, D.data, strict=True)
        ]
        return D._replace(data=tuple(data))

    def _on_curve(self, D: Extended) -> Extended:
        return self.group.retracted(D)

    def _double(self, k: int) -> Extended:
        """E_k = E + T(2^k h)."""
        # indexed, since other threads may append the same
        for j in range(len(self._doubles), k + 1):
            E = self._doubles.get(j - 1)
            self._doubles[j] = self._near(self.unit) if E is None else self._moved(E, E)
        return self._doubles[k]

    def _single(self, k: int) -> Extended | None:
        """T(2^k h), less P₀ where there is one; None while it has points near infinity: doubling loses much there."""
        for j in range(self._fraction + len(self._singles), k + 1):
            S = self._singles.get(j - 1)
            if S is not None:
                S = self._with_single(S, S)
            elif not self._is_general(S := self.from_reference(self._double(j))):
                S = None
            self._singles[j] = S
        return self._singles.get(k)

    def _is_general(self, D: Extended) -> bool:
        return bool(self.group.size_of_x(D.u) < NEAR * self._size)

    def _near(self, time: Any) -> Extended:
        """E(time)."""
        u, v, omega, thirds = self._series.at(time)
        return self._placed(u, v, omega, self._start, thirds)

    def _placed(self, u: poly.Poly, v: poly.Poly, omega: Any, start: poly.Poly, thirds: Sequence[Any] = ()) -> Extended:
        """A pair with its data, each continued from the pair with the U of ``start``, where lifts are 1."""
        K, data, integrals = self.field, [], iter(thirds)
        for kind in self.group.kinds:
            if isinstance(kind, Lift):
                value, first = (poly.evaluate(K, a, kind.e) for a in (u, start))
                data.append(kind.of(self.group, u, v, K.sqrt(value / first)))
            elif isinstance(kind, PointLift):
                # σ'/σ = ½U'(x)/U(x) + ½n(x)y/U(x), and with −y for σ̄
                value, first = (poly.evaluate(K, a, kind.x) for a in (u, start))
                root, turn = K.sqrt(value / first), exponential(K, kind.y * next(integrals, K.zero) / 2)
                data.append((-first if len(u) % 2 == 0 else first, root * turn, root / turn))
            elif isinstance(kind, SecondKind):
                data.append(omega)
            else:
                assert isinstance(kind, ThirdKind)
                data.append(exponential(K, kind.r * omega))
        return Extended(u, v, tuple(data))


def part_at(K: Any, a: poly.Poly, e: Any) -> Any:
    """|a(e)| relative to the terms that it is a sum of; 0 for the polynomial 0."""
    size = sum(abs(c) * abs(e) ** i for i, c in enumerate(a))
    return abs(poly.evaluate(K, a, e)) / size if size > 0 else abs(K.zero)


def reference(group: ExtendedGroup) -> tuple[list[Any], list[Any]]:
    """The x and the y of g + 1 points apart from each other and from the branch points: real points outside the circle
    that holds the roots of f, on the side where f > 0, or, over complex numbers, points around that circle.
    """
    K, f, g = group.field, group.f, group.genus
    lead, degree = f[-1], len(f) - 1
    centre = -f[-2] / (degree * lead)
    shifted = poly.shift(K, f, centre)
    # Fujiwara's bound (1916) of the distance of the roots from the centre
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
