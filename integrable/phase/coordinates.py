"""Maps between states with (γ, M) = 0, regular coordinates and Mumford divisors, without roots except g = √g².

The *pair* of axis i is (γ̂_i, n̂_i) = (gγ_i, 2w_i + λγ̂_i) with w = γ×M and λ = 2gd(Aγ, w). Pairs are regular where a
γ_i vanishes and where moments coincide. With r_i² = 1 − d·a_i the divisor on y² = f(x) is

    U = Σ r_i²γ̂_i²(x − a_j)(x − a_k),      V = Σ r_i²γ̂_i n̂_i(x − a_j)(x − a_k),      U | f − V²,

so that (γ̂_i, n̂_i) is the pair of :mod:`jacobian.relatives.signed` at the branch point a_i: U(a_i) = κ_iγ̂_i² with κ_i
= r_i²(a_i − a_j)(a_i − a_k). The pair at 1/d is (g, λg), with κ = Π r_i²/d². (After Tsiganov, "Integrable
discretization and deformation of the nonholonomic Chaplygin ball", section 2.1, whose coordinates have square roots.)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from integrable.phase.body import Body, Vector, cross, square_root
from integrable.phase.state import State
from jacobian import poly
from jacobian.element import Element, Real
from jacobian.errors import ArgumentError, CurveMismatch, NotRepresentable
from jacobian.numbers.roots import root
from jacobian.relatives.signed import Pair, sheared

if TYPE_CHECKING:
    from jacobian import Divisor


def branch_points(body: Body) -> tuple[Real, ...]:
    """The roots of f at which a state has a pair (σ, ν) (:func:`kappas`): a1, a2, a3, and over exact fields with d ≠ 0
    also 1/d, whose pair gives g rationally.
    """
    return (*body.a, body.field.inv(body.d)) if body.rolls and body.field.exact else body.a


def kappas(body: Body) -> tuple[Real, ...]:
    """The factors κ in U(e) = κσ² for the pairs (σ, ν) at all points e of :func:`branch_points`."""
    K = body.field
    values = [K.mul(r, c) for r, c in zip(body.contact, body.differences, strict=True)]
    if len(branch_points(body)) == 4:
        product = K.mul(K.mul(body.contact[0], body.contact[1]), body.contact[2])
        values.append(K.div(product, K.mul(body.d, body.d)))
    return tuple(values)


def root_of_g(body: Body[Element], gamma: Vector[Element]) -> Element:
    """g = √(1 − d(γ, Aγ))⁻¹, the root that the field returns; NotASquare when there is none."""
    return square_root(body.field, body.field.inv(body.conformal(gamma)), "g²")


def g_of(body: Body, state: State) -> Real:
    """The root g of g² that belongs to a state."""
    return root_of_g(body, state.vectors[0]) if state.g is None else state.g


def upright_pairs(body: Body, state: State) -> tuple[Pair, ...]:
    """The pairs (gγ_i, 2w_i) at a1, a2, a3, where w = γ × M. They are the pairs of (U, P), where P = V − λU with the
    λ for which P(1/d) = 0; at d = 0, P = V.

    NotASquare when g = √g² is not in the field.
    """
    if state.tilted:
        raise ArgumentError("state: (γ, M) may differ from 0 here; take the state of system.upright(state)")
    K, (sigma, M) = body.field, state.vectors
    w = cross(K, sigma, M)
    if body.rolls:
        g = g_of(body, state)
        sigma = (K.mul(g, sigma[0]), K.mul(g, sigma[1]), K.mul(g, sigma[2]))
    return tuple((x, K.add(y, y)) for x, y in zip(sigma, w, strict=True))


def to_pairs(body: Body, state: State) -> tuple[Pair, ...]:
    """The pairs of a state at :func:`branch_points`; NotASquare when g = √g² is not in the field."""
    K, pairs = body.field, upright_pairs(body, state)
    if not body.rolls:
        return pairs
    lean = K.mul(body.d, K.dot([K.mul(a, x) for a, (x, _) in zip(body.a, pairs, strict=True)], [y for _, y in pairs]))
    pairs = sheared(K, pairs, lean)
    if K.exact:
        g = g_of(body, state)
        return (*pairs, (g, K.mul(lean, g)))
    return pairs


def from_pairs(body: Body, pairs: tuple[Pair, ...]) -> State:
    """The state with the given pairs; g comes from the pair at 1/d if there is one, else it is the positive root of
    Σγ̂_i². NotRepresentable where g vanishes, over a finite field.
    """
    K = body.field
    sigma, nu = (tuple(column) for column in zip(*pairs[:3], strict=True))
    half = K.inv(K.add(K.one, K.one))
    if not body.rolls and K.exact:
        return State(sigma, cross(K, tuple(K.mul(half, y) for y in nu), sigma))
    square = K.dot(sigma, sigma)
    g = pairs[3][0] if len(pairs) == 4 else K.sqrt(square)
    if K.exact and g == K.zero:
        raise NotRepresentable(f"g = 0 over {K.name}: the divisor contains the branch point 1/d, and no state has it")
    lean = K.div(K.dot(sigma, nu), square)
    gamma = tuple(K.div(x, g) for x in sigma)
    w = tuple(K.mul(half, K.sub(y, K.mul(lean, x))) for x, y in zip(sigma, nu, strict=True))
    return State(gamma, cross(K, w, gamma), g if len(pairs) == 4 else None)


def directions_of(point: tuple[Real, ...]) -> tuple[tuple[Real, Real, Real], tuple[Real, Real, Real]]:
    """γ and M/|M| of a moving point whose last six numbers are σ = γ̂ and ν = n̂/(2|M|). This is :func:`from_pairs` for
    bare reals: floats, mpf, balls, or double-doubles when compiled.
    """
    (x, y, z), (w1, w2, w3) = gamma_and_w(point)
    return (x, y, z), (w2 * z - w3 * y, w3 * x - w1 * z, w1 * y - w2 * x)


def gamma_and_w(point: tuple[Real, ...]) -> tuple[tuple[Real, Real, Real], tuple[Real, Real, Real]]:
    """γ and w = γ × M/|M| of a moving point as in :func:`directions_of`. w is ν without its part along σ, which may be
    large if a moment is small compared with d.
    """
    s1, s2, s3, n1, n2, n3 = point[4], point[5], point[6], point[7], point[8], point[9]
    scale = 1 / root(s1 * s1 + s2 * s2 + s3 * s3)
    x, y, z = s1 * scale, s2 * scale, s3 * scale
    lean = x * n1 + y * n2 + z * n3
    return (x, y, z), (n1 - lean * x, n2 - lean * y, n3 - lean * z)


def to_mumford(body: Body, pairs: tuple[Pair, ...]) -> tuple[poly.Poly, poly.Poly]:
    """Mumford's (U, V) of pairs: U is monic of degree 2; V has degree ≤ 1, and over inexact fields always two
    coefficients.
    """
    K = body.field
    u0, u1, v0, v1 = (K.zero,) * 4
    for i, (r, (x, y)) in enumerate(zip(body.contact, pairs, strict=False)):
        first, second = body.a[(i + 1) % 3], body.a[(i + 2) % 3]
        product, total = K.mul(first, second), K.neg(K.add(first, second))
        size, slope = K.mul(r, K.mul(x, x)), K.mul(r, K.mul(x, y))
        u0, u1 = K.add(u0, K.mul(size, product)), K.add(u1, K.mul(size, total))
        v0, v1 = K.add(v0, K.mul(slope, product)), K.add(v1, K.mul(slope, total))
    v = (v0, v1)
    return (u0, u1, K.one), poly.trim(K, v) if K.exact else v


def pairs_of(
    body: Body, f: poly.Poly, u: poly.Poly, v: poly.Poly, like: tuple[Pair, ...] | None = None
) -> tuple[Pair, ...]:
    """The pairs (γ̂_i, n̂_i) of a divisor, each with the sign that brings it closer to the pair of ``like``.

    Without ``like`` the sign is that of the field's own root of γ̂², or of n̂² where γ̂ = 0: over the reals γ_i > 0.
    NotASquare where a γ̂_i² has no root in the field, NotRepresentable where moments coincide: (U, V) does not
    determine γ then.
    """
    K = body.field
    cofactor = poly.quotient(K, poly.sub(K, f, poly.mul(K, v, v)), u)
    pairs = []
    points = branch_points(body)
    for e, kappa, model in zip(points, kappas(body), like or (None,) * len(points), strict=True):
        if kappa == K.zero:
            raise NotRepresentable(
                "two moments of inertia are equal: a divisor does not determine γ; step on states instead"
            )
        square = K.div(poly.evaluate(K, u, e), kappa)
        product = K.div(poly.evaluate(K, v, e), kappa)
        other = K.neg(K.div(poly.evaluate(K, cofactor, e), kappa))
        pairs.append(root_pair(K, square, product, other, model))
    return tuple(pairs)


def integrals_of(body: Body, D: Divisor) -> tuple[Real, Real]:
    """(H1, H2) of a divisor's curve y² = 4(1 − dx)Π(a_i − x)(x·H2 − H1).

    CurveMismatch if the curve has another form. Over an inexact field half of the digits of its coefficients must agree
    with this form.
    """
    K: Any = body.field
    curve = D.jacobian.curve
    if curve.field == K and not curve.h:
        # the lowest coefficient of f is −4a1a2a3·H1, the highest −4H2 or 4dH2
        f, (lower, upper) = curve.f, (body.polynomial(K.one, K.zero), body.polynomial(K.zero, K.one))
        if len(f) == len(upper):
            h1, h2 = K.div(f[0], lower[0]), K.div(f[-1], upper[-1])
            allowed = 0 if K.exact else K.eps**0.5 * max(map(abs, f))
            pairs = zip(f, body.polynomial(h1, h2), strict=True)
            if all(x == y if K.exact else abs(x - y) <= allowed for x, y in pairs):
                return h1, h2
    raise CurveMismatch(f"D = {D!r} is on {curve!r}, which is no curve of this system: give one as divisor(state) does")


def root_pair(K: Any, square: Real, product: Real, other: Real, model: Pair | None = None) -> Pair:
    """(σ, ν) with σ² = square, σν = product and ν² = other. Of ±(σ, ν) the one closer to ``model`` is returned; without
    a model the sign is chosen as in :func:`pairs_of`.
    """
    if square == other == K.zero:
        # σ = ν = 0: M is along the axis and γ orthogonal to it, at a double point of the curve
        return K.zero, K.zero
    if (square == K.zero) if K.exact else (abs(square) < abs(other)):
        nu = square_root(K, other, "n̂²")
        pair = (K.div(product, nu), nu)
    else:
        sigma = square_root(K, square, "γ̂²")
        pair = (sigma, K.div(product, sigma))
    opposite = (K.neg(pair[0]), K.neg(pair[1]))
    if model is None:
        # a σ of rounding size does not decide the sign
        return opposite if not K.exact and pair[0] < -64 * K.eps * abs(pair[1]) else pair
    if K.exact:
        return opposite if opposite == model else pair
    return opposite if pair[0] * model[0] + pair[1] * model[1] < 0 else pair
