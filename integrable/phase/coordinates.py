"""Phase space ↔ regular coordinates ↔ Mumford divisor at (γ, M) = 0, without roots except g = √g².

*Pairs*, one for every axis: (γ̂_i, n̂_i) = (Γ_i, n_i)/r_i = (gγ_i, 2w_i + λγ̂_i) with w = γ×M, λ = 2gd(Aγ, w), r_i² = 1
− d·a_i. They are regular where a γ_i vanishes and where moments coincide. The divisor is

    U = Σ r_i²γ̂_i²(x − a_j)(x − a_k),      V = Σ r_i²γ̂_i n̂_i(x − a_j)(x − a_k),      U | f − V²,

so that (γ̂_i, n̂_i) is the pair of :mod:`jacobian.relatives.signed` at the branch point a_i, with κ_i = r_i²(a_i −
a_j)(a_i − a_k); the pair at 1/d is (g, λg) with κ = Π r_i²/d². (Tsiganov, "Integrable discretization and deformation of
the nonholonomic Chaplygin ball", section 2.1, put into coordinates without square roots.)
"""

from __future__ import annotations

from typing import Any

from integrable.phase.body import Body, Vector, cross, square_root
from integrable.phase.state import State
from jacobian import poly
from jacobian.errors import ArgumentError, NotRepresentable
from jacobian.relatives.signed import Pair


def branch_points(body: Body) -> tuple[Any, ...]:
    """The roots of f at which pairs are kept: a1, a2, a3, and over exact fields with d ≠ 0 also 1/d, whose pair gives g
    rationally.
    """
    return (*body.a, body.field.inv(body.d)) if body.rolls and body.field.exact else body.a


def kappas(body: Body) -> tuple[Any, ...]:
    """κ at every branch point of :func:`branch_points`."""
    K = body.field
    values = [K.mul(r, c) for r, c in zip(body.contact, body.differences, strict=True)]
    if len(branch_points(body)) == 4:
        product = K.mul(K.mul(body.contact[0], body.contact[1]), body.contact[2])
        values.append(K.div(product, K.mul(body.d, body.d)))
    return tuple(values)


def root_of_g(body: Body, gamma: Vector) -> Any:
    """g = √(1 − d(γ, Aγ))⁻¹, the field's own choice of root; NotASquare when there is none."""
    return square_root(body.field, body.field.inv(body.conformal(gamma)), "g²")


def to_pairs(body: Body, state: State) -> tuple[Pair, ...]:
    """The pairs at :func:`branch_points` of a state; NotASquare when g = √g² is not in the field."""
    if state.tilted:
        raise ArgumentError("state: (γ, M) may differ from 0 here; take the state of system.upright(state)")
    K, gamma, M = body.field, state.gamma, state.M
    w = cross(K, gamma, M)
    two = K.add(K.one, K.one)
    if not body.rolls:
        return tuple((x, K.mul(two, y)) for x, y in zip(gamma, w, strict=True))
    g = root_of_g(body, gamma) if state.g is None else state.g
    tilt = K.dot([K.mul(a, x) for a, x in zip(body.a, gamma, strict=True)], w)
    lean = K.mul(K.mul(two, K.mul(g, body.d)), tilt)
    sigma = [K.mul(g, x) for x in gamma]
    pairs = [(x, K.add(K.mul(two, y), K.mul(lean, x))) for x, y in zip(sigma, w, strict=True)]
    if len(branch_points(body)) == 4:
        pairs.append((g, K.mul(lean, g)))
    return tuple(pairs)


def from_pairs(body: Body, pairs: tuple[Pair, ...]) -> State:
    """The state of the pairs; g is taken from the pair at 1/d where there is one, else it is the positive root of
    Σγ̂_i².
    """
    K = body.field
    sigma, nu = (tuple(column) for column in zip(*pairs[:3], strict=True))
    half = K.inv(K.add(K.one, K.one))
    if not body.rolls and K.exact:
        return State(sigma, cross(K, tuple(K.mul(half, y) for y in nu), sigma))
    square = K.dot(sigma, sigma)
    g = pairs[3][0] if len(pairs) == 4 else K.sqrt(square)
    lean = K.div(K.dot(sigma, nu), square)
    gamma = tuple(K.div(x, g) for x in sigma)
    w = tuple(K.mul(half, K.sub(y, K.mul(lean, x))) for x, y in zip(sigma, nu, strict=True))
    return State(gamma, cross(K, w, gamma), g if len(pairs) == 4 else None)


def to_mumford(body: Body, pairs: tuple[Pair, ...]) -> tuple[poly.Poly, poly.Poly]:
    """(U, V): U monic of degree 2, V of degree at most 1. Exact: V trimmed; inexact: of length 2."""
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


def pairs_of(body: Body, f: poly.Poly, u: poly.Poly, v: poly.Poly, like: tuple[Pair, ...]) -> tuple[Pair, ...]:
    """The pairs of a divisor; of the two signs on every axis the one on the side of ``like``.

    NotASquare where a γ̂_i² has no root in the field, NotRepresentable where moments coincide: (U, V) does not know how
    γ turns then.
    """
    K = body.field
    cofactor = poly.quotient(K, poly.sub(K, f, poly.mul(K, v, v)), u)
    pairs = []
    for e, kappa, model in zip(branch_points(body), kappas(body), like, strict=True):
        if kappa == K.zero:
            raise NotRepresentable(
                "two moments of inertia are equal: a divisor does not determine γ; step on states instead"
            )
        square = K.div(poly.evaluate(K, u, e), kappa)
        product = K.div(poly.evaluate(K, v, e), kappa)
        other = K.neg(K.div(poly.evaluate(K, cofactor, e), kappa))
        pairs.append(root_pair(K, square, product, other, model))
    return tuple(pairs)


def root_pair(K: Any, square: Any, product: Any, other: Any, model: Pair) -> Pair:
    """(σ, ν) with σ² = square, σν = product, ν² = other, on the side of ``model``."""
    if (square == K.zero) if K.exact else (abs(square) < abs(other)):
        nu = square_root(K, other, "n̂²")
        pair = (K.div(product, nu), nu)
    else:
        sigma = square_root(K, square, "γ̂²")
        pair = (sigma, K.div(product, sigma))
    opposite = (K.neg(pair[0]), K.neg(pair[1]))
    if K.exact:
        return opposite if opposite == model else pair
    return opposite if pair[0] * model[0] + pair[1] * model[1] < 0 else pair
