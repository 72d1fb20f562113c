"""Mumford's pairs from points in their ovals: U, V, lifts at branch points, and the data of a motion."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from integrable.portrait.point_ovals import Halves, PointOval
from jacobian import poly
from jacobian.element import FormulaField, Real
from jacobian.relatives.extended import Extended


class OvalPairs(NamedTuple):
    """The pair with a point in each of the ``ovals``. It has lifts at ``ends``: the index among the real branch points
    in ascending order, and the branch point.
    """

    ovals: tuple[PointOval, ...]
    ends: tuple[tuple[int, Real], ...]

    def at(self, N: FormulaField, halves: Halves) -> tuple[poly.Poly, poly.Poly, Halves]:
        """(U, V, [(σ, V(e)/σ) at each of the ``ends``]), where σ² = |U(e)|, in the numbers of N.

        ``halves`` are (sin ½φ, cos ½φ) of each point. If a point turns at e, σ has the sign of its sin ½φ (e is the
        lower end of its oval) or of its cos ½φ (the upper end). No formula divides by a quantity that vanishes at e.
        """
        ovals = [oval.over(N) for oval in self.ovals]
        points = [o.middle - o.radius * (c * c - s * s) for o, (s, c) in zip(ovals, halves, strict=True)]
        # y = 2·radius·sin ½φ·cos ½φ·pace
        paces = [1 / o.weight(N, x) for o, x in zip(ovals, points, strict=True)]
        apart = [[x - z for j, z in enumerate(points) if j != i] for i, x in enumerate(points)]
        shares = [p / math.prod(row, start=N.one) for p, row in zip(paces, apart, strict=True)]
        u: poly.Poly = poly.from_roots(N, points)
        v = [N.zero] * len(points)
        for i, (oval, share, (s, c)) in enumerate(zip(ovals, shares, halves, strict=True)):
            rest, height = poly.from_roots(N, [*points[:i], *points[i + 1 :]]), 2 * oval.radius * share * s * c
            v = [x + height * y for x, y in zip(v, rest, strict=True)]
        return u, tuple(v), [self._lift_at(N, e, ovals, points, halves, shares) for e in self.ends]

    def _lift_at(
        self,
        N: FormulaField,
        end: tuple[int, Real],
        ovals: Sequence[PointOval],
        points: Sequence[Real],
        halves: Halves,
        shares: Sequence[Real],
    ) -> tuple[Real, Real]:
        """The pair (σ, V(e)/σ) at a branch point e; ``shares`` are y/(r·sin φ·Π(x − other points)), with the radius r
        of the oval.
        """
        place, e = end[0], N.coerce(end[1])
        own, root, rest, size = None, N.one, N.one, N.one
        # ``gaps`` has |e − x| for each point x, but a signed √|e − x| for the point that turns at e
        gaps, signs = [], []
        for k, (oval, x, (s, c)) in enumerate(zip(ovals, points, halves, strict=True)):
            signs.append(1 if place > oval.place else -1)
            if place in (oval.place, oval.place + 1):
                own, size = k, N.sqrt(2 * oval.radius)
                root, rest = (s * size, c) if place == oval.place else (c * size, s)
            gaps.append(root if own == k else signs[-1] * (e - x))
        others = [N.sqrt(gap) for k, gap in enumerate(gaps) if k != own]
        far, slope = math.prod(others, start=N.one), N.zero
        for i, (share, (s, c)) in enumerate(zip(shares, halves, strict=True)):
            value = size * share * rest if i == own else 2 * ovals[i].radius * share * s * c
            for k, (gap, sign) in enumerate(zip(gaps, signs, strict=True)):
                value = value if k == i else value * gap * sign
            slope = slope + value
        return root * far, slope / far


class LiftedPairs(NamedTuple):
    """The pairs of a motion. ``lifts`` has for each datum that is a lift (κ, factor of σ, sign of ν/σ), which continue
    the lift of the start; None for a datum that is the time t.
    """

    pairs: OvalPairs
    lifts: tuple[tuple[Real, Real, int] | None, ...]

    def at(self, K: FormulaField, halves: Halves, turned: Halves = ()) -> Extended:
        """The pair at points with these (sin ½φ, cos ½φ). Its data are its lifts; 0 for the time; and ``turned``, the
        (cos, sin) of each angle about an axis, counted from the start.
        """
        u, v, found = self.pairs.at(K, halves)
        values, data = iter(found), []
        for lift in self.lifts:
            if lift is None:
                data.append(K.zero)
            else:
                (kappa, size, side), (sigma, slope) = lift, next(values)
                size = K.coerce(size)
                data.append((K.coerce(kappa), size * sigma, side * size * slope))
        return Extended(u, v, (*data, *turned))


def numbers_of(parts: Any) -> Iterator[Real]:
    """The numbers in nested tuples; integers and None are no numbers but part of the shape."""
    if isinstance(parts, tuple):
        for x in parts:
            yield from numbers_of(x)
    elif parts is not None and not isinstance(parts, int):
        yield parts


def renewed(parts: Any, values: Iterator[Real]) -> Any:
    """Nested tuples of the same shape with the next ``values`` in place of :func:`numbers_of`."""
    if isinstance(parts, tuple):
        items = [renewed(x, values) for x in parts]
        return type(parts)(*items) if hasattr(parts, "_fields") else tuple(items)
    return parts if parts is None or isinstance(parts, int) else next(values)
