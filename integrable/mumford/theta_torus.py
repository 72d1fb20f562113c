"""Motions of genus 2 on a real torus whose branch points need not be real, by theta functions.

D = P₁ + P₂ has z = A⁻¹(∫_{r₀}^{P₁} + ∫_{r₀}^{P₂})(dx/y, x dx/y), r₀ a branch point; z is linear in time. On y² = f(x)
of degree 5

    √|U(r_i)| = |f'(r_i)/lead|^¼·|θ[η_i](z)/θ[η_∞](z)|,   V = −∂_{(0,1)}U,

where η_i is the odd characteristic of the branch point r_i (Thomae; Mumford 1984). Exactly one of the 16 η_0 makes all
η_0 + 2(q, p)_i odd, where ∫_{r₀}^{r_i} = Ap + Bq. All of this is real in a basis whose A spans the real periods.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from integrable.moving_point.arithmetic import MOST_TURNS
from integrable.mumford.columns import Column
from integrable.mumford.elliptic_torus import long_numbers
from integrable.mumford.fields import cofactor
from integrable.mumford.motion import Start
from integrable.mumford.theta_series import LIBRARY, theta_sums
from integrable.torus.witness import witnesses
from jacobian import RR, poly
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.periods.paths import image
from jacobian.periods.quadrature import working_numbers
from jacobian.periods.real_basis import (
    NEARLY,
    characteristics,
    coordinates,
    half_integrals,
    ratio,
    real_basis,
    solved,
)  # fmt: skip
from jacobian.periods.roots import conjugated, simple_roots
from jacobian.relatives.extended import Extended, Lift

Row = Any

# bits in which a torus is set up
BITS = 160
# largest number of Newton steps to a root
NEWTON_STEPS = 20
# size of U at a branch point, relative to x², below which σ is not computed from it
SMALL = 1e-20


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
        found = real_basis(half_integrals(Z, roots, lead))
        tau = ratio(found.cycles)
        chars = characteristics(found)
        w = image(Z, roots, lead, found.halves, (*start.u[:2], *start.v))
        ((p1, p2, q1, q2),) = coordinates(found.cycles, tau, [w])
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
        along = solved(found.cycles[:2], (Z.zero, Z.one))
        shifted = [((a + halves[0]) % 2, (b + halves[1]) % 2, c, d) for a, b, c, d in chars]
        self._sums, tops = theta_sums(tau, [shifted[i] for i in (*places, 5)], [x.real for x in along])
        self._places = Column.of(p1), Column.of(p2)
        nu = solved(found.cycles[:2], (Z.coerce(start.direction[0]), Z.coerce(start.direction[1])))
        self._frequencies = [Column.of(x.real) for x in nu]
        self._paces = [float(x.real) for x in nu]
        scales = [Z.coerce(high) + Z.coerce(low) for high, low in tops.tolist()]
        at_start = self._values(np.array([[[x.hi, x.lo] for x in self._places]]))[0]
        f = poly.scale(Z, Z.coerce(lead), poly.from_roots(Z, roots))
        slope = poly.derivative(Z, f)
        self._ends, self._sizes = [Column.of(e) for e in ends], []
        self._over = Column.of(1 / (ends[0] - ends[1]))
        for k, (e, i) in enumerate(zip(ends, places, strict=True)):
            kappa, sigma, nu_e = lifts.get(e) or lift_of(Z, start, e)
            size = Z.sqrt(Z.sqrt(abs(poly.evaluate(Z, slope, roots[i])) / abs(lead))).real
            size = size * (scales[k] / scales[-1] / Z.sqrt(abs(kappa))).real
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
