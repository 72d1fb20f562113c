"""Physical time along a motion of a tilde pair at d ≠ 0 in many digits, t = ∫dτ/g: the modes of 1/g on the torus of
its two ovals.

g² = Σ weight_k(1 + dz_k) (:class:`integrable.deformations.oval.Pace`), where z_k on curve k is an even and periodic
function of the phase θ_k = 2π(τ + since_k)/T_k, with the period T_k. So 1/g = Σ c_mn cos mθ1 cos nθ2.
"""

from __future__ import annotations

from math import inf, isqrt, log, log2, pi

import gmpy2
import numpy as np

from integrable.deformations.oval import Pace
from integrable.torus.long_clock import LongClock, phases
from integrable.torus.oval_modes import Modes
from integrable.torus.series import SPARE_BITS, circle_of, fourier, powers
from jacobian import MP
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.numbers.long_reals import BallReals, BareReals

# the largest number of modes at USUAL_DIGITS digits, about a second of set-up; with more digits it is smaller
MOST_MODES, USUAL_DIGITS = 1 << 16, 60
# number of modes added to the number that their decay suggests
MARGIN = 6
GUARD_BITS = 30


class OvalsClock(LongClock):
    """t(τ) and τ(t) of a motion with dt/dτ = ``pace``, to ``digits`` digits relative to the longer period of its
    curves. PrecisionLoss if 1/g needs too many modes.
    """

    def __init__(self, pace: Pace, digits: int) -> None:
        field = MP(int(pace.field.bits / log2(10)))
        self._modes = modes_of_pace(pace, digits, field)
        super().__init__(self._modes, digits, field, field.coerce(pace.period))

    def defect(self, tau: Real, rate: Real) -> Real:
        """The relative difference between ``rate`` and the series of 1/g at τ."""
        import flint

        with BallReals(self.wide.context.prec) as balls:
            # the modes with −m are the conjugates of those with m and are not stored: the sum is twice the real part of
            # the stored rows, that of m = 0 being halved
            rows = [[c / 2 for c in self._modes.rows[0]], *self._modes.rows[1:]]
            turns = phases(self.wide.coerce(tau) / self._scale, self.frequencies, self.wide)
            angles = (2 * balls.number(x) for x in turns)
            one, two = (flint.acb(x.cos_pi(), x.sin_pi()) for x in angles)
            waves = flint.acb_mat([powers(one**0, one, len(rows))]) * flint.acb_mat(rows)
            across = powers(two ** -(len(rows[0]) // 2), two, len(rows[0]))
            total = sum((x * y for x, y in zip(waves.entries(), across, strict=True)), flint.acb(0))
            found = balls.element(self.wide, 2 * total.real)
        return abs(found / self.wide.coerce(rate) - 1)


def modes_of_pace(pace: Pace, digits: int, field: MultiprecisionField) -> Modes:
    """The Fourier modes of 1/g down to 10^(−digits) of its mean; phases are turns on both curves since the start.

    The unit of τ is the shorter period.
    """
    bits, sizes = field.context.prec + GUARD_BITS, series_sizes(pace, digits)
    while True:
        if sizes[0] * sizes[1] * max(digits, USUAL_DIGITS) > MOST_MODES * USUAL_DIGITS:
            raise PrecisionLoss(
                f"times: 1/g takes a series of {sizes[0]} × {sizes[1]} modes for {digits} digits; fewer digits, times "
                "nearer to 0, or at_tau (the flow's own time) are within reach"
            )
        table = cosines(pace, sizes, bits)
        loud = abs(table) > table[0, 0] // 10**digits
        # if the last modes are not small, the table is too small
        ends = loud[-1 - sizes[0] // 16 :].any(), loud[:, -1 - sizes[1] // 16 :].any()
        if not any(ends):
            rows, columns = (int(np.flatnonzero(loud.any(axis=1 - k))[-1]) + MARGIN for k in range(2))
            return _from_start(pace, table[:rows, :columns], field, bits)
        rows, columns = (smooth(n + n // 4 + 1) if more else n for n, more in zip(sizes, ends, strict=True))
        sizes = rows, columns


def mean_of_pace(pace: Pace, digits: int) -> Real:
    """The mean of 1/g over the torus, to ``digits``.

    Its mean over one phase is (π/2K)∫dφ/√((1 − k²sin²φ)(P cos²φ + Q sin²φ)) from 0 to π/2, a quotient of two
    arithmetic-geometric means. The other phase is the one whose modes decay faster.
    """
    N, sizes = pace.field, series_sizes(pace, digits)
    k = 0 if sizes[0] < sizes[1] else 1
    # the mean of samples at n intervals of half a period contains the modes of order 2n, 4n, …
    curve, other, n = pace.curves[k], pace.curves[1 - k], (sizes[k] + 1) // 2
    low, high = (pace.weights[1 - k] * (1 + pace.d * z) for z in pace.levels[1 - k][:2])
    ratio, total = N.sqrt(other.above / other.breadth), N.zero
    for j in range(n + 1):
        share = pace.share(k, curve.at(j * N.one / (2 * n)))
        value = other.thetas.mean / gmpy2.agm(N.sqrt(share + high), ratio * N.sqrt(share + low))
        total += value if 0 < j < n else value / 2
    return total / n


def series_sizes(pace: Pace, digits: int) -> tuple[int, int]:
    """The numbers of modes of 1/g = Σ c_mn cos mθ1 cos nθ2 in both phases.

    The c_mn decay as e^(−m·strip) if 1/g has no singularity at |Im θ1| < strip, and likewise in n. With the heights
    z_k of :class:`integrable.deformations.oval.Pace`, singularities are the pole of z_k at the imaginary half-period of
    curve k, and the zeros of g² = Σ weight_k(1 + dz_k), where z_k < 0.

    The abscissa on curve k is Z = μ_k·z_k with μ1 > 0 > μ2. On the second curve a zero of g² has a Z above all branch
    points, and is as far from the real axis as the pole. On the first curve its Z is below them, and it is nearer.
    """
    d, (one, two), (below, beside) = pace.d, pace.curves, pace.levels
    share = pace.weights[1] / pace.weights[0]
    zero = -(1 + share * (1 + d * min(beside[:2]))) / d
    # an oval that is a point has modes of order 0 alone
    strips = [inf, inf]
    if one.swing:
        strips[0] = 2 * pi * float(one.time_below((below[0] - zero) / below[3]) / one.period)
    if two.swing:
        strips[1] = -float(gmpy2.log(two.thetas.nome))
    rows, columns = (smooth(int(digits * log(10) / x) + MARGIN) for x in strips)
    return rows, columns


def smooth(count: int) -> int:
    """The smallest number ≥ ``count`` that is 5, 6, 7 or 8 times a power of 2."""
    power = 1 << max(0, (count - 1).bit_length() - 3)
    return -(-count // power) * power


def cosines(pace: Pace, sizes: tuple[int, int], bits: int) -> np.ndarray:
    """The c_mn of 1/g = Σ c_mn cos mθ1 cos nθ2, with m and n up to ``sizes``, as integers in units of 2^−bits."""
    parts = []
    for k, (curve, n) in enumerate(zip(pace.curves, sizes, strict=True)):
        squares = (pace.share(k, curve.at(j * pace.field.one / (2 * n))) for j in range(n + 1))
        parts.append([int(pace.field.doubled(x, bits)) for x in squares])
    one = 1 << (3 * bits)
    values = np.array([[isqrt(one // (x + y)) for y in parts[1]] for x in parts[0]], dtype=object)
    for n in sizes:
        values = _transformed(values, n, bits).T
    return values


def _transformed(values: np.ndarray, count: int, bits: int) -> np.ndarray:
    """The c_k with Σ_k c_k cos(πjk/n) = values_j, j, k = 0 … n = ``count``, along the first axis."""
    # transforms of even real columns are real, so one complex transform computes two of them
    width = (values.shape[1] + 1) // 2
    halves = (
        values[:, :width],
        np.concatenate([values[:, width:], 0 * values[:, : 2 * width - values.shape[1]]], axis=1),
    )
    real, imaginary = (np.concatenate([x, x[-2:0:-1]]) for x in halves)
    with (reals := BareReals(bits + SPARE_BITS)):
        found = fourier(real + imaginary * reals.i, circle_of(2 * count))[: count + 1]
    parts = [np.frompyfunc(part, 1, 1)(found) for part in (lambda z: int(z.real), lambda z: int(z.imag))]
    result: np.ndarray = np.concatenate(parts, axis=1)[:, : values.shape[1]] // count
    result[[0, -1]] = result[[0, -1]] // 2
    return result


def _from_start(pace: Pace, table: np.ndarray, field: MultiprecisionField, bits: int) -> Modes:
    """The Fourier modes, in phases from the start, of the cosine series with the coefficients ``table``."""
    import flint

    rows, columns = table.shape
    starts = [field.coerce(curve.phase) for curve in pace.curves]
    with BallReals(bits) as balls:
        unit = flint.arb(2) ** -bits
        angles = (2 * balls.number(x) for x in starts)
        one, two = (flint.acb(x.cos_pi(), x.sin_pi()) for x in angles)
        across, found = powers(flint.acb(1), two, columns), []
        for k, (x, row) in enumerate(zip(powers(flint.acb(1), one, rows), table.tolist(), strict=True)):
            c = x * unit / (2 if k else 1)
            # the two modes of cos mθ1 cos nθ2 with +m are stored; the two with −m are their conjugates
            first, *rest = (c * y for y in row)
            ahead = [c * y / 2 for c, y in zip(rest, across[1:], strict=True)]
            back = [c * y.conjugate() / 2 for c, y in zip(rest, across[1:], strict=True)]
            found.append([*back[::-1], first, *ahead])
    shortest = pace.period
    nu = [field.coerce(shortest / curve.period) for curve in pace.curves]
    return Modes(found, (1, 1), (nu[0], nu[1]), field.binary(table[0, 0], -bits))
