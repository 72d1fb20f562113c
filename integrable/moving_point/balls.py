"""Ball arithmetic for flows (python-flint's arb; Johansson 2017): numbers that carry an error bound.

Every formula of :mod:`integrable.moving_point.addition` holds exactly for exact points of the curve, in each branch of
the code. It therefore maps balls around such points to balls around the result, whichever branch a comparison of balls
takes. Division by a ball that contains 0 gives an unbounded result; :func:`integrable.phase.enclosure.is_bounded`
detects it. Truncation errors are bounded here: those of power series by Cauchy's estimate, that of Newton's iteration
by Krawczyk's test (1969).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from integrable.moving_point.addition import abel_slopes, abel_sums, carried, conjugate_points
from integrable.moving_point.translations import Translations, series_of
from jacobian.errors import PrecisionLoss
from jacobian.fields.inexact import InexactField

if TYPE_CHECKING:
    from flint import acb, arb

    from integrable.moving_point.problem import Problem
    from jacobian.numbers.long_reals import BallReals


MOST_TRIALS = 12
MOST_BOXES = 6


class BallField(InexactField["arb"]):
    """Real balls as a field, at the precision of flint's context. Given numbers are taken as exact."""

    name = "balls"

    def __init__(self, reals: BallReals) -> None:
        self.reals = reals
        self.zero, self.one = reals.number(0), reals.number(1)
        self.eps = self.one * 2.0**-50

    def coerce(self, value: object, argument: str = "value") -> arb:
        """The ball of radius 0 around a number; balls are returned unchanged."""
        return self.reals.number(value)

    def sqrt(self, x: arb) -> arb:
        """√x."""
        return x.sqrt()


def around(middle: arb, radius: arb) -> arb:
    """A ball that contains all numbers within ``radius`` of the ball ``middle``."""
    from flint import arb

    return middle + arb(0, radius.abs_upper())


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


def time_after(tau: arb, rest: arb, rate: Callable[[arb], arb]) -> arb:
    """A ball that contains the τ at which a clock has advanced by ``rest`` since the exact ``tau``, by the interval
    Newton method. ``rate`` gives dt/dτ on a ball of τ and must be provably positive. PrecisionLoss if no ball is found.
    """
    from flint import arb

    width = abs(rest).abs_upper() * 4
    for _ in range(MOST_TRIALS):
        slope = rate(tau + arb(0, width))
        step = rest / slope
        # over this ball t(τ) increases by more than the rest, so that the ball contains the wanted τ
        if slope > 0 and abs(step).abs_upper() < width:
            return tau + step
        width = 4 * abs(step).abs_upper() if step.is_finite() else width / 4
    raise PrecisionLoss("dt/dτ could not be bounded at this precision: use more digits")


class BallTranslations:
    """Enclosures of the translations T(eps) of a motion."""

    def __init__(self, problem: Problem, plain: Translations) -> None:
        self._plain = plain
        one = plain.reals.number(1)
        self.f = problem.f
        self.axes = (*problem.axes[:3], one, one, one, one, 0 * one)
        size = len(plain.series)
        self._series, self._roots = (series_of(problem.f, power, size) for power in (-1, 1))
        # a lower bound of the distance to the nearest branch point
        self._nearest = min(x.abs_lower() for x in problem.branch_points)

    def near(self, eps: arb) -> tuple[arb, ...]:
        """T(eps) for a ball eps that does not contain 0."""
        plain = self._plain
        doublings, term_bits = plain.plan(eps.mid())
        small = eps / 2**doublings
        size = plain.terms(plain.reals.bits, term_bits)
        m, r, tail, reach = self._zero(*plain.centre(small.mid(), term_bits), small, size)
        roots = list(self._roots[:size])
        # the first coefficients include the truncation errors of both sums of :func:`conjugate_points`
        roots[0] = around(roots[0], tail)
        roots[1] = around(roots[1], tail / reach)
        step = conjugate_points(roots, self.f[0], self.axes, small, m, r)
        for _ in range(doublings):
            step = carried(self.f, self.axes, step, step)
        return step

    def _zero(self, m: arb, r: arb, eps: arb, size: int) -> tuple[arb, arb, arb, arb]:
        """(enclosure of m, enclosure of r, the bound of :meth:`_tail`, a bound of |m| + √|r|)."""
        target = self.f[0] * eps * eps / 4
        noise = 2.0 ** (20 - self._plain.reals.bits) + 8 * (eps.rad() / eps).abs_upper()
        radii = [abs(x).abs_upper() * noise for x in (m, r)]
        for _ in range(MOST_TRIALS):
            box = [around(x, radius) for x, radius in zip((m, r), radii, strict=True)]
            reach = (abs(box[0]) + abs(box[1]).sqrt()).abs_upper()
            tail = self._tail(reach, size)
            value = self._system(m, r, target, size, tail, reach)[:2]
            *slope, phi = self._system(box[0], box[1], target, size, tail, reach)[2:]
            new = _krawczyk(value, slope, (m, r), [y - x for x, y in zip((m, r), box, strict=True)])
            if phi > 0 and all(y.contains_interior(x) for x, y in zip(new, box, strict=True)):
                return new[0], new[1], tail, reach
            radii = [3 * abs(y - x).abs_upper() + 2 * radius for x, y, radius in zip((m, r), new, radii, strict=True)]
        raise PrecisionLoss("a translation could not be enclosed at this precision: use more digits")

    def _system(self, m: arb, r: arb, target: arb, size: int, tail: arb, reach: arb) -> tuple[arb, ...]:
        """(r·phi² − target, psi, the derivatives of the first and of the second with respect to m and r, phi).

        Let |m| + √|r| ≤ R, and let the coefficients of the series satisfy |c_k| ≤ (k+1)(k+2)/2·nearest^(−k). The sums
        of the terms omitted from phi, psi, ∂phi/∂m, ∂phi/∂r, ∂psi/∂m and ∂psi/∂r are then at most ``tail`` times 1, R,
        1/R, 1/R², 1 and 1/R.
        """
        series = self._series[:size]
        sums = *abel_sums(series, m, r), *abel_slopes(series, m, r)
        weights = (1, reach, 1 / reach, 1 / (reach * reach), 1, 1 / reach)
        phi, psi, phi_m, phi_r, psi_m, psi_r = (around(x, tail * w) for x, w in zip(sums, weights, strict=True))
        return (
            r * phi * phi - target,
            psi,
            2 * r * phi * phi_m,
            phi * phi + 2 * r * phi * phi_r,
            psi_m,
            psi_r,
            phi,
        )

    def _tail(self, reach: arb, size: int) -> arb:
        """An upper bound of Σ_{k ≥ size} (k+1)⁴(reach/nearest)^k."""
        q = (reach / self._nearest).abs_upper()
        ratio = q * (size + 2) ** 4 / (size + 1) ** 4
        if not ratio < 1:
            raise PrecisionLoss("a translation could not be enclosed: its series was not seen to converge")
        return (q**size * (size + 1) ** 4 / (1 - ratio)).abs_upper()


def _krawczyk(value: Sequence[arb], slope: Sequence[arb], point: Sequence[arb], apart: Sequence[arb]) -> list[arb]:
    """x − Y·F(x) + (1 − Y·J)(box − x) for x = ``point``: ``value`` is F(x), ``slope`` the derivative J of F on the box,
    ``apart`` is box − x, and Y an approximate inverse of J. If the result lies inside the box, the box contains exactly
    one zero of F, and the result contains it.
    """
    a, b, c, d = (x.mid() for x in slope)
    det = a * d - b * c
    rows = [[(x / det).mid() for x in row] for row in ((d, -b), (-c, a))]
    new = []
    for i, (p, q) in enumerate(rows):
        rest = [-(p * slope[k] + q * slope[2 + k]) for k in range(2)]
        rest[i] += 1
        new.append(point[i] - (p * value[0] + q * value[1]) + rest[0] * apart[0] + rest[1] * apart[1])
    return new
