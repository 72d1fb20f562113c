"""Motions of genus 2 on a real torus whose branch points need not be real, by theta functions.

D = P₁ + P₂ has z = A⁻¹(∫_{r₀}^{P₁} + ∫_{r₀}^{P₂})(dx/y, x dx/y), r₀ a branch point; z is linear in time. On y² = f(x)
of degree 5

    √|U(r_i)| = |f'(r_i)/lead|^¼·|θ[η_i](z)/θ[η_∞](z)|,   V = −∂_{(0,1)}U,

where η_i is the odd characteristic of the branch point r_i (Thomae; Mumford 1984). Exactly one of the 16 η_0 makes all
η_0 + 2(q, p)_i odd, where ∫_{r₀}^{r_i} = Ap + Bq. All of this is real in a basis whose A spans the real periods.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from integrable.moving_point.arithmetic import MOST_TURNS
from integrable.mumford.columns import Column
from integrable.mumford.elliptic_torus import circle, double_double_row, half_turn, inverse_factorials, long_numbers
from integrable.mumford.fields import cofactor
from integrable.mumford.motion import Start
from integrable.torus.witness import witnesses
from jacobian import RR, poly
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.native.kinds import INT, INTS, WIDES, TupleKind, record
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL
from jacobian.numbers.abreast import abreast
from jacobian.periods.quadrature import working_numbers
from jacobian.periods.real_basis import (
    NEARLY,
    Whole,
    characteristics,
    coordinates,
    half_integrals,
    image,
    ratio,
    real_basis,
    solved,
)  # fmt: skip
from jacobian.periods.roots import conjugated, simple_roots
from jacobian.relatives.extended import Extended, Lift

Row = Any

# bits in which a torus is set up
BITS = 160
# largest number of harmonics of a series; beyond it, branch points nearly meet
MOST_HARMONICS = 40
# truncation error of a series relative to its largest term: e^(−π·DEPTH)
DEPTH = 26.0
# largest number of Newton steps to a root
NEWTON_STEPS = 20
# size of U at a branch point, relative to x², below which σ is not computed from it
SMALL = 1e-20


class ThetaSums(NamedTuple):
    """The weights of the theta series of all classes (characteristics).

    ``table`` has the shape ``sizes`` = (classes, rows, columns). An entry is four numbers: w₊ + w₋, w₊ − w₋ and the
    same for the derivative along a direction. Rows are a = e₁, e₁ + 2, …, columns b = e₂, e₂ + 2, …; ``shifts`` are e₁
    and e₂ of each class. ``kinds`` is 1 for a class that is odd in φ, else 0. ``inverse`` is that of
    :func:`integrable.mumford.elliptic_torus.circle`.
    """

    table: Row
    sizes: tuple[int, int, int]
    shifts: Row
    kinds: Row
    inverse: Row


def theta_lifts(sums: ThetaSums, phases: Row, out: Row) -> None:
    """Writes, for each pair of phases in turns, θ_∞ and for every other class σ = θ/θ_∞ and ν = −2∂σ."""
    classes = sums.sizes[0]
    width = 2 * classes - 1
    for i in abreast(0, len(phases) // 2):
        c1, s1 = circle(phases[2 * i] / 2, sums.inverse)
        c2, s2 = circle(phases[2 * i + 1] / 2, sums.inverse)
        last, slope = theta(sums, classes - 1, (c1, s1), (c2, s2))
        over = 1 / last
        lean = slope * over
        out[width * i] = last
        for k in range(classes - 1):
            value, rate = theta(sums, k, (c1, s1), (c2, s2))
            sigma = value * over
            out[width * i + 2 * k + 1] = sigma
            out[width * i + 2 * k + 2] = 2 * (sigma * lean - rate * over)


def theta(sums: ThetaSums, k: int, first: tuple[Real, Real], second: tuple[Real, Real]) -> tuple[Real, Real]:
    """θ of class k and its derivative, from (cosine, sine) of πφ₁ and of πφ₂."""
    (c1, s1), (c2, s2), table = first, second, sums.table
    _, rows, columns = sums.sizes
    zero = 0 * c1
    # harmonics advance by twice the angles, and begin at 0 or at one angle
    ca, sa, cs, ss = c1 * c1 - s1 * s1, 2 * c1 * s1, c2 * c2 - s2 * s2, 2 * c2 * s2
    a, b, start, other = 1 + zero, zero, 1 + zero, zero
    if sums.shifts[2 * k] > 0:
        a, b = c1, s1
    if sums.shifts[2 * k + 1] > 0:
        start, other = c2, s2
    value, rate, odd = zero, zero, sums.kinds[k] > 0
    place = 4 * k * rows * columns
    for _ in range(rows):
        p, q, dp, dq, c, s = zero, zero, zero, zero, start, other
        for _ in range(columns):
            p, q = p + table[place] * c, q + table[place + 1] * s
            dp, dq = dp + table[place + 2] * c, dq + table[place + 3] * s
            c, s = c * cs - s * ss, c * ss + s * cs
            place += 4
        if odd:
            value, rate = value + (b * p + a * q), rate + (a * dp - b * dq)
        else:
            value, rate = value + (a * p - b * q), rate + (b * dp + a * dq)
        a, b = a * ca - b * sa, a * sa + b * ca
    return value, rate


_SUMS = record(ThetaSums, WIDES, TupleKind((INT, INT, INT)), INTS, INTS, WIDES)
LIBRARY = Library("theta", {"theta_lifts": (theta_lifts, (_SUMS, WIDES, WIDES))}, SPECIAL)


class ThetaTorus:
    """D of a :class:`Start` of genus 2 in double-doubles, at any times.

    ``place(K)`` returns the start in the numbers of K. PrecisionLoss if branch points nearly meet, if fewer than two
    are real, and for data other than lifts on a model of odd degree.
    """

    def __init__(self, place: Callable[[Any], Start]) -> None:
        with long_numbers(BITS) as N:
            start = place(N)
            lifts = {kind.e: data for kind, data in zip(start.kinds, start.data, strict=True) if isinstance(kind, Lift)}
            if len(start.v) != 2 or len(start.f) != 6 or len(lifts) != len(start.kinds):
                raise PrecisionLoss("a motion of genus 2 without lifts but at branch points is needed")
            roots = complex_roots(N, start.f, list(lifts))
            with LongField(BITS, complex=True) as Z:
                self._make(Z, start, [Z.coerce(e) for e in roots], lifts)

    @property
    def witnesses(self) -> np.ndarray:
        """Times more than one period of each phase from the start, in both directions, for a comparison."""
        return witnesses(self._paces)

    def reaches(self, times: np.ndarray) -> bool:
        """Whether double-doubles resolve the fraction of a turn at all of these times."""
        return float(np.abs(times).max(initial=0)) * max(map(abs, self._paces)) <= MOST_TURNS

    def at(self, times: np.ndarray) -> Extended:
        """The pairs with their data at N times, as columns of N numbers."""
        phases = [Column(times) * nu + place for nu, place in zip(self._frequencies, self._places, strict=True)]
        out = np.ascontiguousarray(
            self._values(np.stack([np.stack([x.hi, x.lo], axis=-1) for x in phases], axis=1)).transpose(1, 2, 0)
        )
        data = [
            (kappa, size * Column(*out[2 * k + 1]), size * Column(*out[2 * k + 2]))
            for k, (kappa, size) in enumerate(self._sizes)
        ]
        # interpolate U and V from their values at two branch points
        (e, first), (other, second) = list(zip(self._ends, data, strict=True))[:2]
        u, v = (
            [kappa * sigma * x[n] for kappa, sigma, x in ((d[0], d[1], d) for d in (first, second))] for n in (1, 2)
        )
        rise = (u[0] - u[1]) * self._over - (e + other)
        slope = (v[0] - v[1]) * self._over
        return Extended(
            (u[0] - e * (e + rise), rise, Column(1.0)), (v[0] - slope * e, slope), tuple(data[: self._read])
        )

    def _values(self, phases: np.ndarray) -> np.ndarray:
        """The values of :func:`theta_lifts`, shape (N, width, 2), at phases of shape (N, 2, 2)."""
        width = 2 * self._sums.sizes[0] - 1
        out = np.empty((width * len(phases), 2))
        LIBRARY.theta_lifts(self._sums, np.ascontiguousarray(phases).reshape(-1, 2), out)
        return out.reshape(-1, width, 2)

    def _make(self, Z: LongField, start: Start, roots: list[Any], lifts: dict[Any, Any]) -> None:
        lead = start.f[-1]
        found = real_basis(Z, half_integrals(Z, roots, lead))
        tau = ratio(Z, found.cycles)
        chars = characteristics(Z, found)
        w = image(Z, roots, lead, found.halves, (*start.u[:2], *start.v))
        p1, p2, q1, q2 = coordinates(Z, found.cycles, w)
        halves = [round(2 * float(q)) for q in (q1, q2)]
        if max(abs(float(2 * q - n)) for q, n in zip((q1, q2), halves, strict=True)) > NEARLY:
            raise PrecisionLoss("the pair is on no real torus")
        others = sorted(
            (e.real for e in roots if e.imag == 0 and e.real not in lifts), key=lambda e: -abs(e - next(iter(lifts), 0))
        )
        self._read = len(lifts)
        ends = [*lifts, *others][: max(2, len(lifts))]
        if len(ends) < 2:
            raise PrecisionLoss("fewer than two branch points are real")
        places = [next(i for i, e in enumerate(roots) if e.real == end and e.imag == 0) for end in ends]
        along = solved(Z, found.cycles[:2], (Z.zero, Z.one))
        shifted = [((a + halves[0]) % 2, (b + halves[1]) % 2, c, d) for a, b, c, d in chars]
        self._sums, scales = theta_sums(tau, [shifted[i] for i in (*places, 5)], [x.real for x in along])
        self._places = Column.of(p1), Column.of(p2)
        nu = solved(Z, found.cycles[:2], (Z.coerce(start.direction[0]), Z.coerce(start.direction[1])))
        self._frequencies = [Column.of(x.real) for x in nu]
        self._paces = [float(x.real) for x in nu]
        at_start = self._values(np.array([[[x.hi, x.lo] for x in self._places]]))[0]
        f = poly.scale(Z, Z.coerce(lead), poly.from_roots(Z, roots))
        slope = poly.derivative(Z, f)
        self._ends, self._sizes = [Column.of(e) for e in ends], []
        self._over = Column.of(1 / (ends[0] - ends[1]))
        for k, (e, i) in enumerate(zip(ends, places, strict=True)):
            kappa, sigma, nu_e = lifts.get(e) or lift_of(Z, start, e)
            size = Z.sqrt(Z.sqrt(abs(poly.evaluate(Z, slope, roots[i])) / abs(lead))).real
            size = size * scales[k] / scales[-1] / Z.sqrt(abs(kappa)).real
            own, rate = (float(x) for x in at_start[2 * k + 1 : 2 * k + 3, 0])
            # if σ vanishes, ν carries the sign
            if own * sigma + rate * nu_e * SMALL < 0:
                size = -size
            self._sizes.append((Column.of(kappa), Column.of(size)))


def lift_of(Z: LongField, start: Start, e: Any) -> tuple[Any, Any, Any]:
    """(κ, σ, ν) at a real branch point e that carries no lift: κσ² = U, κσν = V, κν² = −W, κ = ±1."""
    whole = (*start.u[:2], start.u[0] ** 0)
    height, slope = poly.evaluate(Z, whole, e).real, poly.evaluate(Z, start.v, e).real
    if abs(height) > SMALL * (1 + e**2):
        kappa = 1 if height > 0 else -1
        sigma = Z.sqrt(abs(height)).real
        return kappa, sigma, kappa * slope / sigma
    square = -poly.evaluate(Z, cofactor(Z, start.f, whole, start.v), e).real
    kappa = 1 if square > 0 else -1
    nu = Z.sqrt(abs(square)).real
    return kappa, kappa * slope / nu, nu


def complex_roots(N: LongField, f: poly.Poly, known: Sequence[Any]) -> list[Any]:
    """The roots of f sorted by real part, with conjugate roots adjacent; ``known`` are some of the real ones.

    PrecisionLoss if floats do not separate two roots.
    """
    rest = poly.quotient(N, f, poly.from_roots(N, known))
    numbers, slope = working_numbers(RR), poly.derivative(N, rest)
    rough = simple_roots(numbers, [*map(complex, rest)])
    if len(rough) > 1:
        rough = conjugated(numbers, rough)
    found = [*map(complex, known)]
    for x in rough:
        if min((abs(x - y) for y in found), default=1) <= 1e-9 * max(1e-300, *map(abs, (*found, x))):
            raise PrecisionLoss("two branch points are not told apart")
        found.append(x)
    polished: list[Any] = list(known)
    with LongField(BITS, complex=True) as Z:
        for z in rough:
            x = Z.coerce(z)
            for _ in range(NEWTON_STEPS):
                move = poly.evaluate(Z, rest, x) / poly.evaluate(Z, slope, x)
                x -= move
                if not abs(move) > N.root_of_eps * abs(x):
                    break
            # only one root of a conjugate pair is kept; its conjugate is added below, so that they match exactly
            polished.append(x.real if z.imag == 0 else x)
        pairs = [x for x in polished if x.imag > 0]
        real = [x for x in polished if x.imag == 0]
        return sorted([*real, *pairs, *(x.conjugate() for x in pairs)], key=lambda x: (float(x.real), float(x.imag)))


class Lattice(NamedTuple):
    """The data of a theta series: ``y`` is Im τ, ``halves`` is 2Re τ, a matrix of integers.

    ``counts`` are the numbers of values of both summation indices; ``along`` is a direction in z.
    """

    y: list[list[Any]]
    halves: list[list[int]]
    counts: tuple[int, int]
    along: Sequence[Any]


def theta_sums(
    tau: Sequence[Sequence[Any]], chars: Sequence[Whole], along: Sequence[Any]
) -> tuple[ThetaSums, list[Any]]:
    """The weights of the characteristics ``chars``, and for each class the number by which its sums are divided.

    Derivatives are ``along`` a direction in z.
    """
    y = [[x.imag for x in row] for row in tau]
    area = float(y[0][0] * y[1][1] - y[0][1] ** 2)
    widest = [2 * (DEPTH * float(y[1 - k][1 - k]) / area) ** 0.5 for k in (0, 1)]
    if max(widest) > 2 * MOST_HARMONICS:
        raise PrecisionLoss("theta functions of this motion have too many terms: branch points nearly meet")
    counts = int(widest[0]) // 2 + 2, int(widest[1]) // 2 + 2
    lattice = Lattice(y, [[round(2 * float(x.real)) for x in row] for row in tau], counts, along)
    weights, scales = zip(*(weights_of(lattice, char) for char in chars), strict=True)
    kinds = np.array([(e1 * d1 + e2 * d2) % 2 for e1, e2, d1, d2 in chars], dtype=np.int64)
    shifts = np.array([x for e1, e2, *_ in chars for x in (e1, e2)], dtype=np.int64)
    table = double_double_row([x for row in weights for x in row])
    return ThetaSums(table, (len(chars), *counts), shifts, kinds, inverse_factorials()), list(scales)


def weights_of(lattice: Lattice, char: Whole) -> tuple[list[Any], Any]:
    """The weights of one class divided by the largest term of its series, and this term."""
    import gmpy2

    (e1, e2, d1, d2), (y, halves, (rows, columns), along), pi = char, lattice, half_turn()
    firsts, seconds = range(e1, e1 + 2 * rows, 2), range(e2, e2 + 2 * columns, 2)

    def term(a: int, m: int) -> tuple[Any, int]:
        # the phase from Re τ, in sixteenths of a turn
        turned = a * a * halves[0][0] + 2 * a * m * halves[0][1] + m * m * halves[1][1]
        return (a * a * y[0][0] + 2 * a * m * y[0][1] + m * m * y[1][1]) / 4, turned

    least, phase = min(
        (term(a, m) for a in firsts for b in seconds for m in (b, -b) if a or m >= 0), key=lambda found: found[0]
    )
    table = []
    for a, b in product(firsts, seconds):
        pair: list[tuple[Any, Any]] = []
        for m in (b, -b):
            if (a == 0 and m < 0) or (m == 0 and pair):
                pair.append((0 * least, 0 * least))
                continue
            size, turned = term(a, m)
            if (turned - phase) % 8:
                raise PrecisionLoss("theta functions of this motion are not real")
            # the terms of n and −n are combined
            w = gmpy2.exp(-pi * (size - least)) * (2 if (a, m) != (0, 0) else 1)
            if ((turned - phase) % 16 != 0) != ((a * d1 + m * d2) % 4 in (1, 2)):
                w = -w
            rate = pi * (a * along[0] + m * along[1]) * w
            pair.append((w, rate if (e1 * d1 + e2 * d2) % 2 else -rate))
        (w, rate), (other, slower) = pair
        table += [w + other, w - other, rate + slower, rate - slower]
    return table, gmpy2.exp(-pi * least)
