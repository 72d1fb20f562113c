"""Ball arithmetic for flows (python-flint's arb; Johansson 2017): numbers that carry an error bound.

Every formula of :mod:`integrable.moving_point.addition` holds exactly for exact points of the curve, in each branch of
the code. It therefore maps balls around such points to balls around the result, whichever branch a comparison of balls
takes. Division by a ball that contains 0 gives an unbounded result; :func:`integrable.phase.enclosure.is_bounded`
detects it. Truncation errors are bounded here: those of power series by Cauchy's estimate, that of Newton's iteration
by Krawczyk's test (1969).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import frexp, isqrt, log2
from typing import TYPE_CHECKING, Any

from integrable.moving_point.addition import Real, Row, carried
from integrable.moving_point.translations import REACH, Translations
from jacobian.errors import PrecisionLoss
from jacobian.fields.inexact import InexactField
from jacobian.numbers.long_reals import BallReals, BareReals
from jacobian.numbers.roots import root

if TYPE_CHECKING:
    from integrable.moving_point.problem import Problem


# bits gained per term of the series at half a step, where the two points are at most 1.4·REACH away from 0. Each
# halving of eps gains another bit
TERM_BITS = -log2(1.4 * REACH)
MOST_TRIALS = 12
MOST_BOXES = 6


class BallField(InexactField):
    """Real balls as a field, at the precision of flint's context. Given numbers are taken as exact."""

    name = "balls"

    def __init__(self, reals: Any) -> None:
        self._reals = reals
        self.zero, self.one = reals.number(0), reals.number(1)
        self.eps = self.one * 2.0**-50

    def coerce(self, value: Any, argument: str = "value") -> Any:
        """The ball of radius 0 around a number; balls are returned unchanged."""
        return self._reals.number(value)

    def sqrt(self, x: Any) -> Any:
        """√x."""
        return x.sqrt()

    def dot(self, xs: Sequence[Any], ys: Sequence[Any]) -> Any:
        """Σ x_i y_i."""
        return sum((x * y for x, y in zip(xs, ys, strict=True)), self.zero)


def around(middle: Any, radius: Any) -> Any:
    """A ball that contains all numbers within ``radius`` of the ball ``middle``."""
    from flint import arb

    return middle + arb(0, radius.abs_upper())


def picard_box(
    velocity: Callable[[Sequence[Any]], Sequence[Any]], point: Sequence[Any], sizes: Sequence[Any], radius: float
) -> tuple[list[Any], list[Any]] | None:
    """(box, reach) of the solution of ẋ = ``velocity``(x) from a point, by Picard's theorem. For complex
    |t| ≤ ``radius`` the solution stays in the box of complex balls and moves by at most ``reach``. None if no box is
    found.

    ``sizes``: the radii of the initial box. The velocity is assumed analytic where it is finite.
    """
    from flint import acb, arb

    for _ in range(MOST_BOXES):
        box = [acb(x + arb(0, s), arb(0, s)) for x, s in zip(point, sizes, strict=True)]
        reach = [radius * x.abs_upper() for x in velocity(box)]
        if all(a <= b for a, b in zip(reach, sizes, strict=True)):
            return box, reach
        sizes = [max(s, 1.05 * x) for x, s in zip(reach, sizes, strict=True)]
    return None


def time_after(tau: Any, rest: Any, rate: Callable[[Any], Any]) -> Any:
    """A ball that contains the τ at which a clock has advanced by ``rest`` since the exact ``tau``, by the interval
    Newton method. ``rate`` gives dt/dτ on a ball of τ and must be provably positive. PrecisionLoss if no ball is found.
    """
    from flint import arb

    width = abs(rest).abs_upper() * 4
    for _ in range(MOST_TRIALS):
        slope = rate(tau + arb(0, width))
        step = rest / slope
        # t(τ) increases, and by more than the rest over this ball
        if slope > 0 and abs(step).abs_upper() < width:
            return tau + step
        width = 4 * abs(step).abs_upper() if step.is_finite() else width / 4
    raise PrecisionLoss("dt/dτ could not be bounded at this precision: use more digits")


class BallTranslations:
    """T(eps) of a motion, enclosed."""

    def __init__(self, problem: Problem, balls: BallReals) -> None:
        self._balls, reals = balls, BareReals(balls.bits + 16)
        *f, half_step, a1, a2, a3 = balls.rounded((*problem.f, problem.half_step, *problem.axes[:3]), reals)
        self._plain = Translations(reals, f, (a1, a2, a3), half_step)
        one = balls.number(1)
        self.f = problem.f
        self.axes = (*problem.axes[:3], one, one, one, one, 0 * one)
        # a halving costs an addition and saves terms; this number is near the optimum
        self._halvings = isqrt(balls.bits // 25)
        size = int(balls.bits / (TERM_BITS + self._halvings)) + 6
        self._series, self._roots = (series_of(problem.f, power, size) for power in (-1, 1))
        # a lower bound of the distance to the nearest branch point
        self._nearest = min(x.abs_lower() for x in problem.branch_points)

    def near(self, eps: Any) -> tuple[Any, ...]:
        """T(eps) for a ball eps that does not contain 0."""
        plain, balls = self._plain, self._balls
        (middle,) = balls.rounded([eps], plain.reals)
        # the number of halvings of eps, and the number of terms that its integrals need after them
        exponent = frexp(float(max(abs(middle) / plain.half_step, 2.0**-500)))[1]
        doublings = max(0, exponent + self._halvings)
        size = self.terms(TERM_BITS + doublings - exponent)
        small = eps / 2**doublings
        with plain.reals:
            u0, u1 = plain.near(middle / 2**doublings)[:2]
            m, r = balls.row((-u1 / 2, u1 * u1 / 4 - u0))
        m, r, tail, reach = self._zero(m, r, small, size)
        roots = list(self._roots[:size])
        # truncation errors: of (m+√r)^k + (m−√r)^k in the even sum and of S_k in the odd one
        roots[0] = around(roots[0], tail)
        roots[1] = around(roots[1], tail / reach)
        step = conjugate_points(roots, self.f[0], self.axes, small, m, r)
        for _ in range(doublings):
            step = carried(self.f, self.axes, step, step)
        return step

    def terms(self, term_bits: float) -> int:
        """The number of terms of the integrals that give all bits, if each gains ``term_bits``."""
        return min(len(self._series), int(self._balls.bits / term_bits) + 6)

    def _zero(self, m: Any, r: Any, eps: Any, size: int) -> tuple[Any, Any, Any, Any]:
        """Enclosures of m and r; a bound of Σ(k+1)⁴q^k over the omitted terms; a bound of |m| + √|r|."""
        target = self.f[0] * eps * eps / 4
        noise = 2.0 ** (20 - self._balls.bits) + 8 * (eps.rad() / eps).abs_upper()
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

    def _system(self, m: Any, r: Any, target: Any, size: int, tail: Any, reach: Any) -> tuple[Any, ...]:
        """r·phi² − target, psi, the derivatives by m and r of the first, then of the second, and phi.

        Let |m| + √|r| ≤ R and |c_k| ≤ (k+1)(k+2)/2·nearest^(−k). The sums of the terms omitted from phi, psi, ∂phi/∂m,
        ∂phi/∂r, ∂psi/∂m and ∂psi/∂r are then at most ``tail`` times 1, R, 1/R, 1/R², 1 and 1/R.
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

    def _tail(self, reach: Any, size: int) -> Any:
        """An upper bound of Σ_{k ≥ size} (k+1)⁴(reach/nearest)^k."""
        q = (reach / self._nearest).abs_upper()
        ratio = q * (size + 2) ** 4 / (size + 1) ** 4
        if not ratio < 1:
            raise PrecisionLoss("a translation could not be enclosed: its series was not seen to converge")
        return (q**size * (size + 1) ** 4 / (1 - ratio)).abs_upper()


def series_of(f: Row, power: int, size: int) -> list[Any]:
    """The first coefficients of (f/f0)^(power/2) about 0, by the recurrence from its logarithmic derivative. f has six
    coefficients, ascending.
    """
    ratios = [c / f[0] for c in f[1:]]
    out = [f[0] / f[0]]
    for k in range(1, size):
        terms = ((i * (power + 2) - 2 * k) * c * out[k - i] for i, c in enumerate(ratios[:k], 1))
        out.append(sum(terms, 0 * f[0]) / (2 * k))
    return out


def abel_sums(series: Row, m: Real, r: Real) -> tuple[Real, Real]:
    """phi, psi with 2√r·phi = y0·Σ∫dx/y and 2√r·psi = y0·Σ∫x dx/y for the points at m ± √r."""
    phi, psi = 0 * r, 0 * r
    c = m * m - r
    # S_j = ((m+√r)^j − (m−√r)^j)/(2√r), by S_{j+1} = 2m·S_j − c·S_{j−1}
    s0, s1 = 0 * r, 1 + 0 * r
    for k in range(len(series)):
        s2 = 2 * m * s1 - c * s0
        phi += series[k] / (k + 1) * s1
        psi += series[k] / (k + 2) * s2
        s0, s1 = s1, s2
    return phi, psi


def abel_slopes(series: Row, m: Real, r: Real) -> tuple[Real, Real, Real, Real]:
    """The derivatives of :func:`abel_sums`: of phi with respect to m and r, then of psi."""
    phi_m, phi_r, psi_m, psi_r = 0 * r, 0 * r, 0 * r, 0 * r
    c = m * m - r
    # S_j and its derivatives
    s0, s1, d0, d1, e0, e1 = 0 * r, 1 + 0 * r, 0 * r, 0 * r, 0 * r, 0 * r
    for k in range(len(series)):
        s2 = 2 * m * s1 - c * s0
        d2 = 2 * s1 + 2 * m * d1 - 2 * m * s0 - c * d0
        e2 = 2 * m * e1 + s0 - c * e0
        weight = series[k] / (k + 1)
        phi_m += weight * d1
        phi_r += weight * e1
        weight = series[k] / (k + 2)
        psi_m += weight * d2
        psi_r += weight * e2
        s0, s1, d0, d1, e0, e1 = s1, s2, d1, d2, e1, e2
    return phi_m, phi_r, psi_m, psi_r


def conjugate_points(roots: Row, f0: Real, axes: Row, eps: Real, m: Real, r: Real) -> Row:
    """The translation whose divisor has points at m ± √r, as a moving point with κ = 1."""
    # ±√(f/f0) at the two points: half their sum over √r, and half their difference
    c = m * m - r
    s0, s1, c0, c1 = 0 * r, 1 + 0 * r, 2 + 0 * r, 2 * m
    even, odd = 0 * r, 0 * r
    for k in range(len(roots)):
        even += roots[k] * c0
        odd += roots[k] * s0
        s0, s1, c0, c1 = s1, 2 * m * s1 - c * s0, c1, 2 * m * c1 - c * c0
    phi = root(f0 * eps * eps / (4 * r))
    t1 = phi / eps * even
    t0 = 2 * r * phi / eps * odd - t1 * m
    x1, x2, x3 = axes[0] - m, axes[1] - m, axes[2] - m
    r1, r2, r3 = root(x1 * x1 - r), root(x2 * x2 - r), root(x3 * x3 - r)
    return (c, -2 * m, t0, t1, r1, r2, r3, (t0 + t1 * axes[0]) / r1, (t0 + t1 * axes[1]) / r2, (t0 + t1 * axes[2]) / r3)


def _krawczyk(value: Any, slope: Any, point: Any, apart: Any) -> list[Any]:
    """x − Y·F(x) + (1 − Y·J)(box − x), where Y is an approximate inverse of J. If it lies inside the box, the box
    contains exactly one zero of F, and this set contains that zero.
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
