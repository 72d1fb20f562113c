"""Sums that a field's own digits do not decide: computed with more digits, several times, and compared.

The summands are moved onto the curve, within their last bits, and are then taken as exact. Three passes compute the
sum. The first takes these summands, the second moves them by some hundred units of the last working bit, the third by a
few units of the last bit *of the field*. The second and third pass repeat the decisions of the first: which
quantities are zero, and which column is the largest. The second pass shows the error of the working precision, the
third the effect of the field's own rounding of the summands.

At first only a quantity that vanishes at every precision counts as zero. If the sum is then known to all but its last
digits, it is returned. Otherwise a point of the sum may be at infinity, or points of the summands may be opposite, up
to rounding. A quantity then counts as zero if a change of the summands by a unit in the last place changes it by
about its own size. It counts as not zero if it is far larger than the effect of rounding. In between, PrecisionLoss is
raised.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from random import Random
from typing import Any, NamedTuple

from jacobian.errors import PrecisionLoss
from jacobian.inexact.dense import Coefficients, index_of_largest
from jacobian.inexact.digits import Digits, MoreDigits, on_curve, places
from jacobian.inexact.stacked import Pair, Total

# a quantity counts as zero up to this multiple of its change by a unit in the last place of the summands
ZERO = 16
# ROUNDED: error, in units of the last place, of summands that are sums themselves. A quantity is nonzero if it exceeds
# the effect of such errors by the factor NONZERO where it decides a degree, DISTINCT where it decides if points
# are opposite
ROUNDED, NONZERO, DISTINCT = 4, 4096, 64
# the largest allowed relative change of a sum by rounding: UNKNOWN, or CLEAR if only exact zeros counted as zero
CLEAR, UNKNOWN = 2.0**-12, 2.0**-4
# a number is resolved if it exceeds its error at the working precision by this factor
RESOLVED = 2**16
# number of random roundings of the summands that are tried where a degree depends on rounding
WAYS = 4

LOST = "rounding of the summands decides the degree of their sum; use more digits"

Law = Callable[[Any, Coefficients, Sequence[Pair]], tuple[Total, Any]]


class Question(NamedTuple):
    """A number that a :class:`Pass` compared with zero.

    ``of_degree``: whether the answer decides a degree; otherwise it decides whether points are opposite.
    """

    value: Any
    of_degree: bool


class Pass:
    """The ``field`` argument of one pass of :func:`jacobian.inexact.stacked.compose`.

    A pass records its questions, their answers, and the result. ``like``: an earlier pass whose choices of columns
    are repeated.
    """

    def __init__(self, digits: Digits, answer: Callable[[int, Any], bool], like: Pass | None = None) -> None:
        self.zero, self.one, self.eps = digits.zero, digits.one, digits.eps
        self._answer, self._like = answer, like
        self.questions: list[Question] = []
        self.answers: list[bool] = []
        self.columns: list[int] = []
        self.total = Total([], [], [], 0)
        self.rest: Any = 0

    def is_zero(self, x: Any, scale: Any, of_degree: bool = True) -> bool:
        """Whether this pass counts x as zero. The question and the answer are recorded."""
        self.answers.append(self._answer(len(self.questions), x))
        self.questions.append(Question(x, of_degree))
        return self.answers[-1]

    def largest(self, sizes: Sequence[Any]) -> int:
        """The index of the largest size, or the index that the earlier pass ``like`` found at this step."""
        largest = self._like.columns[len(self.columns)] if self._like else index_of_largest(sizes)
        self.columns.append(largest)
        return largest

    @property
    def coefficients(self) -> list[Any]:
        """All numbers of the sum that the pass computed: the coefficients of u, v and p, and q."""
        u, v, p, q, _ = self.total
        return [*u[:-1], *v, *p, q]


class Passes:
    """The passes that compute one sum of pairs (u, v), to be used inside ``with digits:``.

    The pairs belong to y² + 2·half·y = curve − half², and are moved to Y² = curve with Y = y + half. ``even``: whether
    the points have similar sizes, and the coefficients of the curve too. ``law(field, curve, pairs)``
    returns a sum and the largest remainder of its divisions.
    """

    def __init__(
        self, digits: Digits, law: Law, curve: Coefficients, half: Coefficients, pairs: Sequence[Pair], even: bool
    ) -> None:
        self._digits, self._law, self._curve, self._half, self._pairs = digits, law, curve, half, pairs
        self._even, self._rng = even, Random(0)

    def sum(self, least: float) -> Total:
        """The sum of the pairs. ``least``: the absolute value of the smallest abscissa of the summands.

        PrecisionLoss where rounding of the summands decides a degree; MoreDigits where this precision does not resolve
        the sum.
        """
        units = self._digits.own_eps
        first = [self._on_curve(pair) for pair in self._pairs]
        others = (
            [self._jogged(pair, 256 * self._digits.eps) for pair in first],
            self._moved(ROUNDED * units, units if self._even else 0),
        )
        compared = self._compared(first, others, {})
        if not compared.clear(least):
            ways = [self._moved(units, 0) for _ in range(WAYS)]
            forced: dict[int, bool] = {}
            while (k := compared.wrong_answer([self._like(compared.first, way) for way in ways])) is not None:
                forced[k] = not compared.first.answers[k]
                compared = self._compared(first, others, forced)
            compared.check(least)
        total = compared.sum()
        if len(total.u) == 1 or compared.first.rest <= self._digits.floor:
            return total
        # terms that counted as zero were dropped, which moved the sum off the curve within its accuracy
        u, v = on_curve(self._digits, self._curve, [], (total.u, total.v), self._even)
        return total._replace(u=u, v=v)

    def _compared(self, first: list[Pair], others: Sequence[list[Pair]], forced: dict[int, bool]) -> Compared:
        run = self._run(Pass(self._digits, lambda k, x: forced.get(k, bool(abs(x) <= self._digits.floor))), first)
        return Compared(self._digits, run, *(self._like(run, pairs) for pairs in others))

    def _like(self, first: Pass, pairs: list[Pair]) -> Pass:
        return self._run(Pass(self._digits, lambda k, _: first.answers[k], first), pairs)

    def _run(self, field: Pass, pairs: list[Pair]) -> Pass:
        field.total, field.rest = self._law(field, self._curve, pairs)
        return field

    def _moved(self, part: Any, floor: Any) -> list[Pair]:
        """The summands with every coefficient changed at random by about ``part`` of its size, moved onto the curve.

        The size of a coefficient is its absolute value, but at least ``floor`` times the size in :func:`places`.
        """
        known = self._digits.own_eps**2
        return [self._on_curve(self._jogged(pair, part, floor), known) for pair in self._pairs]

    def _on_curve(self, pair: Pair, known: Any = None) -> Pair:
        return on_curve(self._digits, self._curve, self._half, pair, self._even, known)

    def _jogged(self, pair: Pair, part: Any, floor: Any = 0) -> Pair:
        u, v = pair
        least = [floor * size for size in places(self._curve, u)] if floor else [0] * (2 * len(u) - 2)
        moved = [
            c + part * max(abs(c), low) * (self._rng.choice((1, -1)) * self._rng.uniform(0.5, 1))
            for c, low in zip([*u[:-1], *v], least, strict=True)
        ]
        return [*moved[: len(u) - 1], u[-1]], moved[len(u) - 1 :]


class Compared(NamedTuple):
    """Three passes that compute one sum and count the same quantities as zero, from different summands.

    ``first``: the summands themselves; ``near``: the summands moved in the last working bits; ``rounded``: the summands
    moved as far as the field's rounding moves a sum.
    """

    digits: Digits
    first: Pass
    near: Pass
    rounded: Pass

    def wrong_answer(self, ways: Sequence[Pass]) -> int | None:
        """The index of the first question whose answer the random roundings ``ways`` contradict, or None."""
        for k, ((x, of_degree), answer) in enumerate(zip(self.first.questions, self.first.answers, strict=True)):
            size, rounding = abs(x), abs(x - self.near.questions[k].value)
            noise = max(abs(x - way.questions[k].value) for way in ways)
            if self.digits.floor < size < RESOLVED * rounding and noise < ZERO * rounding:
                raise MoreDigits
            zero = size <= max(ZERO * noise, ZERO * rounding, self.digits.floor)
            doubt = abs(x - self.rounded.questions[k].value)
            if not zero and not size >= (NONZERO if of_degree else DISTINCT) * doubt:
                raise PrecisionLoss(LOST)
            if zero != answer:
                return k
        return None

    def clear(self, least: float) -> bool:
        """Whether the sum is known to all but its last digits, and every number that counted as nonzero exceeds its
        error by the factor RESOLVED.
        """
        asked = zip(self.first.questions, self.near.questions, self.first.answers, strict=True)
        return (
            all(zero or abs(x) >= RESOLVED * abs(x - y) for (x, _), (y, _), zero in asked)
            and self.first.rest <= self.digits.floor
            and self._resolved()
            and self._known(CLEAR, least, (self.first.total.u[:-1], self.first.total.v))
        )

    def check(self, least: float) -> None:
        """Raises PrecisionLoss if rounding of the summands leaves the points of the sum unknown, MoreDigits if the
        working precision does.
        """
        asked = zip(self.first.questions, self.first.answers, strict=True)
        dropped = max((abs(x) for (x, _), zero in asked if zero), default=0)
        if (self.first.rest > self.digits.floor >= dropped) or not self._resolved():
            raise MoreDigits
        if not (self.first.rest <= CLEAR and self._known(UNKNOWN, least, (self.first.total.u[:-1],))):
            raise PrecisionLoss(LOST)

    def sum(self) -> Total:
        """The first pass's sum, in which numbers that vanish at every precision are replaced by exact zeros."""
        floor = self.digits.floor
        pairs = zip(self.first.coefficients, self.near.coefficients, strict=True)
        values = iter([0 * x if abs(x) <= floor and 2 * abs(x - y) > abs(x) else x for x, y in pairs])
        u, v, p, _, lean = self.first.total
        found = [*(next(values) for _ in u[:-1]), u[-1]], [next(values) for _ in v], [next(values) for _ in p]
        return Total(*found, next(values), lean)

    def _resolved(self) -> bool:
        """Whether the working error of every number of the sum is below the field's last bits, or below the effect of
        the summands' rounding.
        """
        own, floor = self.digits.own_eps / 8, self.digits.floor
        numbers = zip(*(run.coefficients for run in (self.first, self.near, self.rounded)), strict=True)
        return all(abs(x) <= floor or abs(x - y) <= own * abs(x) or 8 * abs(x - y) <= abs(x - z) for x, y, z in numbers)

    def _known(self, part: float, least: float, polynomials: Sequence[Coefficients]) -> bool:
        """Whether rounding changes each polynomial by at most ``part`` of its size at |x| = radius.

        The radius is that of the largest point of the sum, or ``least`` if that is larger.
        """
        u, moved = self.first.total.u, iter(self.rounded.coefficients)
        m = len(u) - 1
        radius = max([least, *(abs(c) ** (1 / (m - i)) for i, c in enumerate(u[:-1]))])
        for k, polynomial in enumerate(polynomials):
            sizes = [abs(c) * radius**i for i, c in enumerate(polynomial)]
            size = max(sizes, default=0) if k else radius**m
            if not all(abs(c - next(moved)) * radius**i <= part * size for i, c in enumerate(polynomial)):
                return False
        return True
