"""The branch points of a curve in long numbers, and models of a motion of genus 2 with a branch point at infinity."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import pairwise
from math import prod
from typing import NamedTuple

import numpy as np

from integrable.mumford.fields import cofactor
from jacobian import RR, poly
from jacobian.element import Complex, Real
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.periods.quadrature import working_numbers
from jacobian.periods.roots import conjugated, simple_roots

# Newton's method takes at most NEWTON_STEPS steps to a root in long numbers; floats do not separate two roots whose
# distance is at most CLOSE times the largest root
NEWTON_STEPS, CLOSE = 20, 1e-9
# an oval that is a point becomes an interval of OPENED times the largest branch point
OPENED = 2.0**-130
# |U(e)| at most SMALL·(1 + e²) counts as 0 at a branch point e
SMALL = 1e-20
APART = "the points of the pair are not one in each oval"


def long_roots(N: LongField, f: poly.Poly, known: Sequence[Complex]) -> list[Complex]:
    """The roots of f sorted by real part, with conjugate roots adjacent; ``known`` are real roots, given exactly.

    Real roots are real numbers. PrecisionLoss if floats do not separate two roots that are not known.
    """
    rest = poly.quotient(N, f, poly.from_roots(N, known))
    slope, floats = poly.derivative(N, rest), np.array([*map(float, rest)])
    if not (np.isfinite(floats).all() and floats[-1]):
        raise PrecisionLoss("the curve of this motion has coefficients beyond the range of floats")
    eigenvalues = np.roots(floats[::-1])
    if not eigenvalues.imag.any():
        found = [*known, *(polished(N, rest, slope, N.coerce(x)) for x in eigenvalues.real.tolist())]
        # if a root was found twice, the sum of the roots is wrong
        if not abs(sum(found) + f[-2] / f[-1]) > N.root_of_eps * max(map(abs, found)):
            check_apart(known, found[len(known) :])
            return sorted(found)
    numbers = working_numbers(RR)
    rough = simple_roots(numbers, [*map(complex, rest)])
    if len(rough) > 1:
        rough = conjugated(numbers, rough)
    check_apart(known, rough)
    found = list(known)
    with LongField(N.bits, complex=True) as Z:
        # only one root of a conjugate pair is polished, so that the two match exactly
        for z in (x for x in rough if x.imag >= 0):
            x = polished(Z, rest, slope, Z.coerce(z))
            found += [x, x.conjugate()] if z.imag else [x.real]
    return sorted(found, key=lambda x: (x.real, x.imag))


def check_apart(known: Sequence[Complex], found: Sequence[Complex]) -> None:
    """Raises PrecisionLoss if two of the found roots nearly coincide, relative to the largest of all roots."""
    rough = [*map(complex, found)]
    size = max(map(abs, [*map(complex, known), *rough]))
    if any(abs(x - y) <= CLOSE * size for i, x in enumerate(rough) for y in rough[:i]):
        raise PrecisionLoss("two branch points are not told apart")


def coincident(N: LongField, points: Sequence[Complex]) -> list[int]:
    """The indices k for which branch points k and k + 1 are too close to be distinguished."""
    size = max(map(abs, points))
    return [k for k, (x, y) in enumerate(pairwise(points)) if not abs(x - y) > N.root_of_eps * size]


def opened(N: LongField, model: PairModel, known: Collection[Complex]) -> PairModel:
    """The model of degree 5 in which bounded ovals that are points become intervals, too short to change any float.

    An end of such an oval that is not ``known`` is moved. PrecisionLoss if other branch points coincide.
    """
    roots, first = list(model.roots), 0 if model.lead > 0 else 1
    size = max(map(abs, roots))
    for k in coincident(N, roots):
        if not all_real(roots) or k not in (first, first + 2):
            raise PrecisionLoss(f"two of the branch points {[*map(complex, roots)]} are not told apart")
        if roots[k] in known:
            roots[k + 1] = roots[k] + OPENED * size
        else:
            roots[k] = roots[k + 1] - OPENED * size
    return model._replace(roots=roots)


def polished(Z: LongField, f: poly.Poly, slope: poly.Poly, x: Complex) -> Complex:
    """The root of f near x by Newton's method; ``slope`` is f'."""
    for _ in range(NEWTON_STEPS):
        move = poly.evaluate(Z, f, x) / poly.evaluate(Z, slope, x)
        x -= move
        if not abs(move) > Z.root_of_eps * abs(x):
            break
    return x


def all_real(points: Sequence[Complex]) -> bool:
    return not any(x.imag for x in points)


class PairModel(NamedTuple):
    """A curve (leading coefficient and roots), a pair on it (u₀, u₁ and v₀, v₁), and the direction.

    The roots ascend by their real parts.
    """

    lead: Complex
    u: tuple[Complex, ...]
    v: tuple[Complex, ...]
    direction: Sequence[Real]
    roots: Sequence[Complex]


def lift_of(Z: LongField, model: PairModel, e: Real) -> tuple[Real, Real, Real]:
    """(κ, σ, ν), κ = ±1, at a real branch point e where the motion has no lift, so that the sign of σ is arbitrary.

    κσ² = U, κσν = V and κν² = −W at e, where W = (f − V²)/U.
    """
    whole = (*model.u, model.u[0] ** 0)
    height, slope = poly.evaluate(Z, whole, e).real, poly.evaluate(Z, model.v, e).real
    if abs(height) > SMALL * (1 + e**2):
        kappa = 1 if height > 0 else -1
        sigma = Z.sqrt(abs(height)).real
        return kappa, sigma, kappa * slope / sigma
    f = poly.scale(Z, Z.coerce(model.lead), poly.from_roots(Z, [*map(Z.coerce, model.roots)]))
    square = -poly.evaluate(Z, cofactor(Z, f, whole, model.v), e).real
    kappa = 1 if square > 0 else -1
    nu = Z.sqrt(abs(square)).real
    return kappa, kappa * slope / nu, nu


def without_root(even: PairModel) -> PairModel:
    """The motion in X = 1/(E − x), y = y_X/X³, where E is the largest root of a model of even degree."""
    (u0, u1), (v0, v1), (*roots, pole) = even.u, even.v, even.roots
    lead = prod((pole - e for e in roots), start=-even.lead)
    # with U = (x − E)² + a(x − E) + b and m = V(E) the points of the pair have X² = sX − p and X³y = (mX − v₁)X²
    a, b, m = u1 + 2 * pole, (pole + u1) * pole + u0, v1 * pole + v0
    s, p = a / b, 1 / b
    v = (-m * s * p + v1 * p, m * (s * s - p) - v1 * s)
    c0, c1 = even.direction
    moved = [1 / (pole - e) for e in roots]
    # a point may pass the largest root unless each bounded oval contains one of the points
    ends = [(x - s) * x + p for x in moved[1:]]
    if lead > 0 or any(sign * height < -SMALL * p for sign, height in zip((1, -1, -1, 1), ends, strict=True)):
        raise PrecisionLoss(APART)
    return PairModel(lead, (p, -s), v, (pole * c0 - c1, c0), moved)
