"""The heights z and the rate 1/g on the two curves of a deformation; loops are compiled for double-doubles.

On each curve Z = scale·z + shift, and ``levels`` are z at e₁, e₂ and e₃, and 1/scale. R₁, R₂ and R₃ are the square
roots of |Z − e_i| with the signs of :class:`integrable.mumford.elliptic_torus.EllipticOval`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from integrable.mumford.elliptic_torus import OVAL, EllipticOval, OvalThetas, oval_points
from jacobian.element import Real
from jacobian.inexact.long_field import LongField
from jacobian.native.kinds import WIDES, TupleKind
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL
from jacobian.numbers.abreast import abreast
from jacobian.numbers.roots import root

Row = Any


def height(levels: Sequence[Real], r: tuple[Real, Real, Real]) -> Real:
    """The height z of the point with the square roots ``r`` = (R₁, R₂, R₃), computed from the smallest of them. The
    R_i and the ``levels`` of a curve are those of the module's docstring.
    """
    if abs(r[0]) <= abs(r[1]) and abs(r[0]) <= abs(r[2]):
        return levels[0] + r[0] * r[0] * levels[3]
    if abs(r[1]) <= abs(r[2]):
        return levels[1] - r[1] * r[1] * levels[3]
    return levels[2] - r[2] * r[2] * levels[3]


class Pace(NamedTuple):
    """The rate dt/dτ = 1/g of a tilde pair, g² = Σ weight_k(1 + dz_k), on the torus of two ovals.

    Both ``weights`` are positive, with the sum 1; ``levels`` give the heights z_k (:func:`height`).
    """

    field: LongField
    d: Real
    curves: Sequence[EllipticOval]
    levels: Sequence[Sequence[Real]]
    weights: Sequence[Real]

    @property
    def period(self) -> Real:
        """The shorter period of the two curves."""
        return min(curve.period for curve in self.curves)

    def share(self, k: int, r: tuple[Real, Real, Real]) -> Real:
        """weight_k(1 + dz_k), the term of g² from the point of curve k = 0 or 1 with the square roots ``r``."""
        return self.weights[k] * (1 + self.d * height(self.levels[k], r))

    def at(self, times: Sequence[Real]) -> Real:
        """1/g after the points of the two curves have moved for these times."""
        one, two = (self.share(k, self.curves[k].moved(time)) for k, time in enumerate(times))
        return 1 / self.field.sqrt(abs(one + two))


def points(curves: tuple[OvalThetas, OvalThetas], levels: tuple[Row, Row], phases: Row, out: Row) -> None:
    """Writes all R₁, all R₂, all R₃ and all z on the first curve, then those on the second, at N pairs of phases."""
    count = len(phases) // 2
    put_points(curves[0], levels[0], phases, 0, out[: 4 * count])
    put_points(curves[1], levels[1], phases, 1, out[4 * count :])


def put_points(curve: OvalThetas, levels: Row, phases: Row, k: int, out: Row) -> None:
    """Writes all R₁, R₂, R₃ and z on one curve; ``k`` is the place, 0 or 1, of its phase in each pair."""
    count = len(out) // 4
    oval_points(curve, phases, (k, 2), out[: 3 * count])
    for n in range(count):
        out[3 * count + n] = height(levels, (out[n], out[count + n], out[2 * count + n]))


def paces(first: Row, second: Row, numbers: Row, table: Row) -> None:
    """Writes 1/g to ``table``. Its rows belong to the heights z_1 (:func:`height`) in ``first``, of points of the first
    curve, its columns to the z_2 in ``second``. Replaces each z_k by weight_k(1 + dz_k), its share of g². ``numbers``
    are d and the weights.
    """
    columns = len(second)
    for i in abreast(0, len(first)):
        first[i] = numbers[1] * (1 + numbers[0] * first[i])
    for j in abreast(0, columns):
        second[j] = numbers[2] * (1 + numbers[0] * second[j])
    for i in range(len(first)):
        for j in abreast(0, columns):
            table[i * columns + j] = 1 / root(first[i] + second[j])


LIBRARY = Library(
    "deformations",
    {
        "points": (points, (TupleKind((OVAL, OVAL)), TupleKind((WIDES, WIDES)), WIDES, WIDES)),
        "paces": (paces, (WIDES, WIDES, WIDES, WIDES)),
    },
    SPECIAL,
)
