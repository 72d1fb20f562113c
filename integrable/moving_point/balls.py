"""Ball arithmetic for flows (python-flint's arb; Johansson 2017): numbers that carry an error bound.

Every formula of :mod:`integrable.moving_point.addition` holds exactly for exact points of the curve, in each branch of
the code, and so do compositions and reduction steps of pairs of any genus. They therefore map balls around such points
to balls around the result, whichever branch a comparison of balls takes. Division by a ball that contains 0 gives an
unbounded result; :func:`integrable.phase.enclosure.is_bounded` detects it. This module also bounds the truncation
errors of the series of translations, by a majorant of their recurrence.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from operator import methodcaller
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from integrable.moving_point.addition import carried
from integrable.moving_point.translations import Expansion, Translations
from integrable.phase.enclosure import MOST_TRIALS
from jacobian.errors import PrecisionLoss
from jacobian.fields.inexact import InexactField
from jacobian.numbers.long_reals import BallReals

if TYPE_CHECKING:
    from flint import acb, arb

Values = TypeVar("Values")

MOST_BOXES = 6
# Σ_{i = 0 … k} (k + 1)²/((i + 1)²(k − i + 1)²) is less than this for all k: it is at most 4Σ1/i² = 2π²/3
CONVOLVED = 6.6
LARGEST_RADIUS = 4.0
# bits of bounds on complex discs and of majorants, which need few
BOUND_BITS = 64
# the series of a translation is summed at a shorter time, and the result is doubled; for every HALVED_ONCE_MORE bits of
# precision there is one further halving and doubling. A doubling widens balls by about 14 bits
HALVED_ONCE_MORE = 300


class Balls(InexactField["arb | acb"]):
    """The field of balls of ``bits`` bits, real or complex, in place of long numbers; enter it with ``with``. Given
    numbers are taken as exact.
    """

    name = "balls"
    context = SimpleNamespace(exp=methodcaller("exp"), log=methodcaller("log"))

    def __init__(self, bits: int, complex: bool = False) -> None:
        from flint import acb

        self.bits, self.complex, self.reals = bits, complex, BallReals(bits)
        self._acb = acb
        self.zero, self.one = self.coerce(0), self.coerce(1)
        # a ball counts as 0 only if it is proven to be 0
        self.eps = abs(self.zero)

    def __enter__(self) -> Balls:
        self.reals.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self.reals.__exit__(*error)

    def coerce(self, value: Any, argument: str = "value") -> arb | acb:
        """The ball of radius 0 around a number; a ball is returned unchanged."""
        if not self.complex:
            return self.reals.number(value)
        if isinstance(value, self._acb):
            return value
        return self._acb(self.reals.number(value.real), self.reals.number(value.imag))

    def sqrt(self, x: arb | acb) -> arb | acb:
        return x.sqrt()

    def nearest(self, x: arb | acb) -> int:
        """The integer nearest to the real part of the midpoint of x."""
        return self.reals.nearest(x.real)

    def balls(self, values: Values) -> Values:
        """Returns ``values`` unchanged: they are balls already."""
        return values

    def from_ball(self, x: Values) -> Values:
        """Returns the ball ``x`` unchanged."""
        return x


def around(x: arb | acb, radius: arb) -> arb | acb:
    """A ball, real or complex like x, that contains x widened by an upper bound of ``radius``."""
    from flint import acb, arb

    wide = arb(0, radius.abs_upper())
    return acb(x.real + wide, x.imag + wide) if isinstance(x, acb) else x + wide


def picard_box(
    velocity: Callable[[Sequence[acb]], Sequence[acb]], point: Sequence[arb], sizes: Sequence[arb], radius: float
) -> tuple[list[acb], list[arb]] | None:
    """(box, reach) of the solution of ẋ = ``velocity``(x) from a point, by Picard's theorem. For complex
    |t| ≤ ``radius`` the solution stays in the box of complex balls and moves by at most ``reach``. None if no box is
    found.

    ``sizes`` are the radii of the initial box. The velocity is assumed analytic where it is finite.
    """
    from flint import acb, arb

    for _ in range(MOST_BOXES):
        box = [acb(x + arb(0, s), arb(0, s)) for x, s in zip(point, sizes, strict=True)]
        reach = [radius * x.abs_upper() for x in velocity(box)]
        if all(a <= b for a, b in zip(reach, sizes, strict=True)):
            return box, reach
        sizes = [max(s, 1.05 * x) for x, s in zip(reach, sizes, strict=True)]
    return None


class BallTranslations(Translations):
    """Enclosures of the translations T(eps) of a motion; ``f``, ``axes`` and ``half_step`` are balls."""

    few = inf

    def __init__(self, reals: BallReals, f: Sequence[arb], axes: Sequence[arb], half_step: arb) -> None:
        super().__init__(reals, f, axes, half_step)
        # most enclosures need a single translation, for which a halving costs less than further orders
        self._halvings += reals.bits // HALVED_ONCE_MORE

    def _estimated_radius(self) -> float:
        # the majorant exists for smaller radii only, and needs fewer orders the smaller the radius is: 10 to 25 here
        return min(super()._estimated_radius() / 3, LARGEST_RADIUS)

    def _ends(self, rows: Expansion, square: arb, radius: float) -> bool:
        """Whether the remainders of the series are bounded."""
        self._ratio = ((self.half_step * radius) ** -2).abs_upper()
        if not self._ratio * square < 1:
            raise PrecisionLoss("a translation could not be enclosed at this precision: use more digits")
        with self.reals.at(BOUND_BITS):
            self._sizes = majorant(self.f, rows, self._ratio)
        return bool(self._sizes)

    def _summed(self, rows: Expansion, terms: int, eps: arb) -> tuple[arb, ...]:
        # the bound of the remainder holds after all known orders, so all of them are summed
        return super()._summed(rows, len(rows.u0), eps)

    def _whole(self, sums: Sequence[arb], terms: int, square: arb) -> tuple[arb, ...]:
        part = (self._ratio * square).abs_upper()
        rest = part**terms / ((1 - part) * (terms + 1) ** 2)
        return tuple(around(x, rest * size) for x, size in zip(sums, self._sizes, strict=True))

    def sum(self, first: tuple[arb, ...], second: tuple[arb, ...]) -> tuple[arb, ...]:
        return carried(self.f, self.axes, first, second)


class Sizes(NamedTuple):
    """Bounds of the coefficients x_k of a series: ``head`` is Σ|x_k|/ratio^k over the first half of the known orders,
    and |x_k| ≤ ``tail``·ratio^k/(k + 1)² for all later ones.
    """

    head: arb
    tail: arb

    def times(self, other: Sizes) -> arb:
        """The ``tail`` of the product with another series, for orders k beyond the known ones. If the order of one
        factor is in the first half of the known ones, that of the other is i ≥ k/2, so 1/(i + 1)² ≤ 4/(k + 1)².
        """
        return 4 * (self.head * other.tail + other.head * self.tail) + CONVOLVED * self.tail * other.tail

    def up_to(self, tail: arb) -> Sizes:
        """These bounds, with a ``tail`` at least as large as the given one."""
        return Sizes(self.head, max(self.tail, tail.abs_upper()))


def majorant(f: Sequence[arb], rows: Expansion, ratio: arb) -> tuple[arb, ...]:
    """The tails (:class:`Sizes`) of the series u0, u1, v0 and v1; () if the known orders do not prove them.

    The tails are chosen so that they hold for the known orders k < n. If the recurrences of
    :func:`integrable.moving_point.translations.expand_orders` prove them for k = n, they do so for all later k, because
    their divisors grow.
    """
    n, powers = len(rows.u0), [ratio**-k for k in range(len(rows.u0))]

    def known(row: Sequence[arb], begin: int = 0) -> Sizes:
        scaled = [abs(x) * power for x, power in zip(row, powers, strict=True)]
        tail = max((scaled[k] * (k + 1) ** 2).abs_upper() for k in range(n // 2, n))
        return Sizes(sum(scaled[begin : n // 2], 0 * ratio).abs_upper(), tail)

    u0, u1, v0, s0, less = map(known, (rows.u0, rows.u1, rows.v0, rows.s0, rows.less))
    v1, f4, f5 = known(rows.v1, 1), abs(f[4]), abs(f[5])
    # ``later`` is the factor from a bound of order n − 1 to a bound of order n
    later = (n + 1) ** 2 / (n * n * ratio)
    for _ in range(MOST_TRIALS):
        s0 = s0.up_to(f5 * (u1.times(u1) + 2 * u0.tail) + f4 * u1.tail)
        rest, own = u1.times(s0) + f4 * u0.tail, v1.times(v1)
        less = less.up_to(rest + ratio * (4 * v1.tail + own))
        bounds = u0, u1, v0, v1
        proven = (
            (v1.times(u0) + later * u1.times(v0)) / (2 * n - 2),
            later * v0.tail / (2 * n),
            (u1.times(less) + u0.times(s0)) * (n + 1) / (2 * n * (2 * n + 3)),
            (later * (rest + f4 * u0.tail + 2 * f5 * u0.times(u1)) + own) / (4 * n + 2),
        )
        if all(new <= bound.tail for new, bound in zip(proven, bounds, strict=True)):
            return tuple(bound.tail for bound in bounds)
        u0, u1, v0, v1 = (bound.up_to(1.25 * new) for new, bound in zip(proven, bounds, strict=True))
    return ()
