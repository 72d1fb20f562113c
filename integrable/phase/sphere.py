"""The free motion on the sphere (d = 0), and steps of divisors by parabolas through points of the plane.

The coordinates (u, p) are those of :mod:`integrable.phase.separation` at d = 0, but φ(x) = 4Π(a_i − x) has the opposite
sign. In this module H1 = (M, M) and H2 = −(M, AM). The points (u_k, y_k) with y_k = φ(u_k)p_k lie on y² = f(x) =
φ(x)(H1·x + H2), so V is minus the V of :meth:`System.divisor`. (Tsiganov, "Integrable discretization …", section 4.1.)
"""

from __future__ import annotations

from integrable.phase.separation import Separated, line_through, of_roots
from jacobian import HyperellipticCurve, poly
from jacobian.element import Real
from jacobian.errors import ArgumentError, NotRepresentable, shown
from jacobian.fields.protocol import Field
from jacobian.relatives.conic import Representative

Divisor = tuple[poly.Poly, poly.Poly]


def phi_poly(K: Field, a: tuple[Real, Real, Real]) -> poly.Poly:
    """The coefficients of φ(x) = 4Π(a_i − x), ascending."""
    value: poly.Poly = (poly.integer(K, 4),)
    for e in a:
        value = poly.mul(K, value, (e, K.neg(K.one)))
    return value


def _phi(K: Field, a: tuple[Real, Real, Real], x: Real) -> Real:
    return poly.evaluate(K, phi_poly(K, a), x)


def momentum_line(K: Field, a: tuple[Real, Real, Real], point: Separated) -> poly.Poly:
    """The line through the two points (u_k, φ(u_k)p_k), as two coefficients; NotRepresentable where u1 = u2."""
    return line_through(K, [(x, K.mul(_phi(K, a, x), p)) for x, p in zip(*point, strict=True)])[1]


def sphere_integrals(K: Field, a: tuple[Real, Real, Real], point: Separated) -> tuple[Real, Real]:
    """The integrals (H1, H2) at (u, p), from φ(u_k)p_k² = H1·u_k + H2 for k = 1, 2."""
    h2, h1 = line_through(K, [(x, K.mul(_phi(K, a, x), K.mul(p, p))) for x, p in zip(*point, strict=True)])[1]
    return h1, h2


def conic_sum(K: Field, f: poly.Poly, divisor: Divisor, x0: Real | None, y0: Real) -> Divisor:
    """The divisor (Ũ, Ṽ) = ((P² − f)/U made monic, −P mod Ũ), where P = V + cU and P(x0) = y0. If x0 is None, c = y0.

    (U, V) represents N points of y² = f(x), deg f = 2N (:meth:`jacobian.relatives.conic.Representative.step`). For
    constant y0 the map preserves the bracket {u_i, p_j} = (u_i − x0)δ_ij, where y_k = φ(u_k)p_k. NotRepresentable where
    U(x0) = 0.
    """
    image = Representative(HyperellipticCurve(K, f), *divisor).step(x0, y0)
    return image.u, image.v


def conic(K: Field, a: tuple[Real, Real, Real], point: Separated, x0: Real | None, y0: Real) -> Separated:
    """The image of (u, p) under :func:`conic_sum`; NotASquare where ũ1, ũ2 are not in the field."""
    h1, h2 = sphere_integrals(K, a, point)
    divisor = poly.from_roots(K, point[0]), momentum_line(K, a, point)
    image, v = conic_sum(K, poly.mul(K, phi_poly(K, a), (h2, h1)), divisor, x0, y0)
    return of_roots(K, image, v, lambda x: _phi(K, a, x))


def rho(K: Field, point: Separated) -> Separated:
    """The map ρ: (u, p) ↦ (u, u·p), which takes the canonical bracket to W: {u_i, u_jp_j} = u_iδ_ij."""
    (u1, u2), (p1, p2) = point
    return Separated((u1, u2), (K.mul(u1, p1), K.mul(u2, p2)))


def rho_inverse(K: Field, point: Separated) -> Separated:
    """The inverse map ρ⁻¹: (u, p) ↦ (u, p/u); NotRepresentable at u_k = 0."""
    (u1, u2), (p1, p2) = point
    if K.zero in (u1, u2):
        raise NotRepresentable("u_k = 0: ρ has no inverse there")
    return Separated((u1, u2), (K.div(p1, u1), K.div(p2, u2)))


def hat(K: Field, a: tuple[Real, Real, Real], point: Separated) -> Separated:
    """The hat variables (û, p̂), again canonical: (u, p) mapped by :func:`rho`, by :func:`conic` with x0 = y0 = 0,
    and by :func:`rho_inverse`.

    p̂ = −ℓ(û)/φ(û) with φ(x) = 4Π(a_i − x) and the line ℓ through the points (u_k, φ(u_k)p_k).
    """
    return rho_inverse(K, conic(K, a, rho(K, point), K.zero, K.zero))


def hat_eigenvalues(K: Field, a: tuple[Real, Real, Real], point: Separated) -> tuple[Real, Real]:
    """The numbers ν_k = û_kφ(û_k)p̂_k², φ(x) = 4Π(a_i − x), for the variables (û, p̂) that :func:`hat` finds."""
    first, second = (K.mul(K.mul(x, _phi(K, a, x)), K.mul(p, p)) for x, p in zip(*hat(K, a, point), strict=True))
    return first, second


def metric(K: Field, a: tuple[Real, Real, Real], u: tuple[Real, Real]) -> tuple[Real, Real] | None:
    """The diagonal (ĝ_11, ĝ_22) of the quadratic form ν1 + ν2 = Σ ĝ_kk p_k², ν as in :func:`hat_eigenvalues`;
    ArgumentError where an a_i = 0.
    """
    if K.zero in a:
        raise ArgumentError(f"a = {shown(tuple(a))}: the metric needs a_i ≠ 0")
    u1, u2 = u
    mixed = K.mul(K.mul(u1, u2), K.dot([K.inv(e) for e in a], (K.one,) * 3))
    result = []
    for x, other in ((u1, u2), (u2, u1)):
        size = K.sub(K.add(K.add(x, x), other), mixed)
        result.append(K.div(K.mul(K.mul(_phi(K, a, x), x), size), K.sub(x, other)))
    return result[0], result[1]
