"""States of Lagrange's top and the spherical pendulum by theta functions: loops over bare reals, compiled unchanged.

Let v = πu/2K, u the argument of sn. The height of the axis z = x₁ + (x₂ − x₁)sn²u is a function of θ₁(v)/θ₄(v). The
horizontal part of the axis is g = Ce^{iRt}θ₂(v − iα)θ₁(v − iβ)/θ₄(v)², with constants C, R, α and β. The zeros of θ₂
and θ₁ are the points of the curve at z = 1 and z = −1 where g vanishes. This formula also holds at the vertical, where
g changes its sign (Whittaker 1904, §§ 55, 73).
"""

from __future__ import annotations

from typing import Any, NamedTuple

from integrable.classical.axial import momentum
from integrable.torus.theta_series import circle
from jacobian.element import Real
from jacobian.native.kinds import BOOL, FLOATS, WIDES, record
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL
from jacobian.numbers.abreast import abreast

Row = Any
Triple = tuple[Real, Real, Real]

# length of a row of ``AxialThetas.table``
SERIES = 8


class AxialThetas(NamedTuple):
    """The constants from which the states of a motion are computed, in the letters of the module's docstring.

    ``numbers`` are, in this order: dv/dt in half turns, R in turns, v at the start in half turns, the two parts of C,
    dv/dt and R in radians, and x₁. Then follow the factor of (θ₁/θ₄)² in z − x₁, the factor of θ₁θ₂θ₃/θ₄³ in z', and
    (jc, L, c) of a top (:mod:`integrable.classical.lagrange`).

    Row n of ``table`` has the coefficients of harmonic 2n + 1 of θ₂(v − iα) and θ₁(v − iβ), two each, and of θ₁ and θ₂,
    then those of harmonic 2n of θ₃ and θ₄. ``inverse`` holds 2π and 1/n!. ``top`` is true if p is M, false if it is the
    velocity.
    """

    numbers: Row
    table: Row
    inverse: Row
    top: bool


def axial_states(motion: AxialThetas, times: Row, out: Row) -> None:
    """Writes q and p at the given times, six floats per time."""
    for i in abreast(0, len(times)):
        (x, y, z), (dx, dy, dz) = axis_at(motion, times[i])
        if motion.top:
            turn, along, c = motion.numbers[10], motion.numbers[11], motion.numbers[12]
            dx, dy, dz = momentum((x, y, z), (dx, dy, dz), (turn, along, c))
        k = 6 * i
        out[k], out[k + 1], out[k + 2] = float(x), float(y), float(z)
        out[k + 3], out[k + 4], out[k + 5] = float(dx), float(dy), float(dz)


def axis_at(motion: AxialThetas, time: Real) -> tuple[Triple, Triple]:
    """The axis and its velocity at a time."""
    numbers, table = motion.numbers, motion.table
    cv, sv = circle((numbers[0] * time + numbers[2]) / 2, motion.inverse)
    zero = 0 * cv
    # ce and se are cos and sin of 2nv, c2 and s2 those of 2v
    ce, se, c2, s2 = 1 + zero, zero, cv * cv - sv * sv, 2 * cv * sv
    upr, upi, dupr, dupi = zero, zero, zero, zero
    low, lowi, dlow, dlowi = zero, zero, zero, zero
    t1, t2, t3, t4, dt4 = zero, zero, zero, zero, zero
    for n in range(len(table) // SERIES):
        k, odd = SERIES * n, 2 * n + 1
        c, s = ce * cv - se * sv, ce * sv + se * cv
        a, b, d, e = table[k] * c, table[k] * s, table[k + 1] * c, table[k + 1] * s
        upr, upi, dupr, dupi = upr + a, upi + e, dupr - odd * b, dupi + odd * d
        a, b, d, e = table[k + 2] * c, table[k + 2] * s, table[k + 3] * c, table[k + 3] * s
        low, lowi, dlow, dlowi = low + d, lowi + b, dlow - odd * e, dlowi + odd * a
        t1, t2 = t1 + table[k + 4] * s, t2 + table[k + 5] * c
        t3, t4, dt4 = t3 + table[k + 6] * ce, t4 + table[k + 7] * ce, dt4 - (2 * n) * (table[k + 7] * se)
        ce, se = ce * c2 - se * s2, ce * s2 + se * c2
    # ``real`` and ``imaginary`` are the parts of G = θ₂(v − iα)θ₁(v − iβ)/θ₄², ``slope`` and ``other`` those of dG/dv
    over = 1 / t4
    square = over * over
    real, imaginary = (upr * low - upi * lowi) * square, (upr * lowi + upi * low) * square
    slope = (dupr * low - dupi * lowi + upr * dlow - upi * dlowi) * square - 2 * dt4 * over * real
    other = (dupr * lowi + dupi * low + upr * dlowi + upi * dlow) * square - 2 * dt4 * over * imaginary
    slope, other = numbers[5] * slope - numbers[6] * imaginary, numbers[5] * other + numbers[6] * real
    c, s = circle(numbers[1] * time, motion.inverse)
    a, b = numbers[3] * c - numbers[4] * s, numbers[3] * s + numbers[4] * c
    z, dz = numbers[7] + numbers[8] * t1 * t1 * square, numbers[9] * t1 * t2 * t3 * over * square
    return (a * real - b * imaginary, a * imaginary + b * real, z), (a * slope - b * other, a * other + b * slope, dz)


LIBRARY = Library(
    "axial",
    {"axial_states": (axial_states, (record(AxialThetas, WIDES, WIDES, WIDES, BOOL), FLOATS, FLOATS))},
    SPECIAL,
)
