"""Separating coordinates (γ, M) ↔ (u, p) ↔ (q, p_q) for (γ, M) = 0, with u and p canonical: {u_i, p_j} = δ_ij.

Tsiganov's coordinates u1, u2 are the roots of U, sphero-conical coordinates at d = 0. Their momenta are
p_k = V(u_k)/φ(u_k) with φ(x) = 4(dx − 1)(a1 − x)(a2 − x)(a3 − x). Chaplygin's own coordinates of 1903 are q = d·u/(1 −
d·u), the roots of Σ γ_i²/(x − d/I_i). They do not exist at d = 0.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from typing import Any, Generic, NamedTuple

from integrable.phase import coordinates
from integrable.phase.body import Body
from integrable.phase.state import State
from jacobian import poly
from jacobian.element import Element, Real
from jacobian.errors import ArgumentError, NotASquare, NotRepresentable, written
from jacobian.fields.protocol import Field
from jacobian.fields.quadratic import quadratic_roots

Two = tuple[Element, Element]


class Separated(NamedTuple, Generic[Element]):
    """Two coordinates and their conjugate momenta."""

    u: Two[Element]
    p: Two[Element]


def phi(body: Body, x: Real) -> Real:
    """φ(x) = 4(dx − 1)(a1 − x)(a2 − x)(a3 − x)."""
    K = body.field
    value = K.mul(poly.integer(K, 4), K.sub(K.mul(body.d, x), K.one))
    for a in body.a:
        value = K.mul(value, K.sub(a, x))
    return value


def to_separated(body: Body, state: State) -> Separated:
    """The coordinates (u, p) of a state: u1 < u2 over the reals, over other fields in the order in which the field
    returns the roots.

    NotASquare where u1, u2 are not in the field; NotRepresentable where u1 = u2 or a γ_i vanishes (some u_k = a_i,
    whose momentum is infinite). The divisor and the pairs of :mod:`integrable.phase.coordinates` are regular in all
    these cases.
    """
    u, v = coordinates.to_mumford(body, coordinates.to_pairs(body, state))
    return of_mumford(body, u, v)


def of_mumford(body: Body, u: poly.Poly, v: poly.Poly) -> Separated:
    """The coordinates (u, p) of a divisor (U, V) of weight two; errors as in :func:`to_separated`."""
    return of_roots(body.field, u, v, lambda x: phi(body, x))


def of_roots(K: Field, u: poly.Poly, v: poly.Poly, phi: Callable[[Real], Real]) -> Separated:
    """The roots u_k of ``u`` with the momenta v(u_k)/φ(u_k); raises what :func:`to_separated` raises."""
    first, second = _roots(K, u)
    p = []
    for x in (first, second):
        scale = phi(x)
        if scale == K.zero:
            raise NotRepresentable(f"u = {x} is a branch point: its momentum p = y/φ(u) does not exist there")
        p.append(K.div(poly.evaluate(K, v, x), scale))
    return Separated((first, second), (p[0], p[1]))


def _roots(K: Any, u: poly.Poly) -> Two:
    if not K.exact:
        square = u[1] * u[1]
        discriminant = square - 4 * u[0]
        if discriminant <= 16 * K.eps * (square + 4 * abs(u[0])):
            raise NotRepresentable("u1 = u2 to rounding: their momenta do not exist; use the divisor")
    roots = quadratic_roots(K, u[1], K.neg(u[0]))
    if len(roots) == 1:
        raise NotRepresentable(f"u1 = u2 = {roots[0]}: their momenta do not exist; use the divisor")
    if not roots:
        raise NotASquare(f"u = {poly.text(K, u)} has no roots in {K.name}: u1 and u2 are conjugate; use the divisor")
    return (min(roots), max(roots)) if not K.exact else (roots[0], roots[1])


def separated_to_mumford(body: Body, point: Separated) -> tuple[poly.Poly, poly.Poly]:
    """The divisor (U, V) of (u, p): U has the roots u_k, and V(u_k) = φ(u_k)p_k. NotRepresentable where u1 = u2."""
    K = body.field
    u, v = line_through(K, [(x, K.mul(phi(body, x), p)) for x, p in zip(*point, strict=True)])
    return u, poly.trim(K, v) if K.exact else v


def integrals(body: Body, point: Separated) -> Two:
    """The integrals (H1, H2) at (u, p): the solution of φ(u_k)p_k² = H1 − u_k H2 for k = 1, 2."""
    K = body.field
    h1, slope = line_through(K, [(x, K.mul(phi(body, x), K.mul(p, p))) for x, p in zip(*point, strict=True)])[1]
    return h1, K.neg(slope)


def line_through(K: Field, points: Sequence[tuple[Real, Real]]) -> tuple[poly.Poly, poly.Poly]:
    """Mumford's pair of two points (u_k, y_k), by :func:`poly.through`; NotRepresentable where u1 = u2."""
    (u1, _), (u2, _) = points
    if u1 == u2:
        raise NotRepresentable(f"u1 = u2 = {written(u1)}: (u, p) are no coordinates there; use the divisor")
    return poly.through(K, points)


def from_separated(body: Body, point: Separated, like: State | None = None) -> State:
    """The state with coordinates (u, p). Eight states have these coordinates. The signs of ``like``, by default those
    of the field's roots, select one.

    NotASquare where a γ_i² or g² has no root in the field (over the reals: u outside of its oval), NotRepresentable
    where u1 = u2 or moments coincide.
    """
    u, v = separated_to_mumford(body, point)
    f = body.polynomial(*integrals(body, point))
    model = None if like is None else coordinates.to_pairs(body, like)
    return coordinates.from_pairs(body, coordinates.pairs_of(body, f, u, v, model))


def to_chaplygin(body: Body, point: Separated) -> Separated:
    """Chaplygin's (q, p_q) of (u, p): q = d·u/(1 − d·u), p_q = p·∂u/∂q, again canonical; ArgumentError at d = 0."""
    K = body.field
    _check_rolling(body)
    q, p = [], []
    for x, momentum in zip(*point, strict=True):
        rest = K.sub(K.one, K.mul(body.d, x))
        if rest == K.zero:
            raise NotRepresentable(f"u = {x} = 1/d: q is infinite")
        q.append(K.div(K.mul(body.d, x), rest))
        p.append(K.div(K.mul(momentum, K.mul(rest, rest)), body.d))
    return Separated((q[0], q[1]), (p[0], p[1]))


def from_chaplygin(body: Body, point: Separated) -> Separated:
    """The coordinates (u, p) of Chaplygin's (q, p_q): u = q/(d(q + 1)); ArgumentError at d = 0."""
    K = body.field
    _check_rolling(body)
    u, p = [], []
    for x, momentum in zip(*point, strict=True):
        rest = K.add(K.one, x)
        if rest == K.zero:
            raise NotRepresentable(f"q = {x}: u is infinite")
        u.append(K.div(x, K.mul(body.d, rest)))
        p.append(K.mul(momentum, K.mul(body.d, K.mul(rest, rest))))
    return Separated((u[0], u[1]), (p[0], p[1]))


def _check_rolling(body: Body) -> None:
    if not body.rolls:
        raise ArgumentError("d = 0: Chaplygin's q need d ≠ 0; use (u, p), which stay finite")


def lifts(body: Body, state: State) -> tuple[State, ...]:
    """The eight states (s_iγ_i, s_js_kM_i), s_i = ±1, with the same divisor and (u, p), starting with ``state``."""
    K, result = body.field, []
    for s in product((1, -1), repeat=3):
        signs = *s, s[1] * s[2], s[2] * s[0], s[0] * s[1]
        x, y, z, m1, m2, m3 = (v if sign > 0 else K.neg(v) for v, sign in zip(state.row, signs, strict=True))
        result.append(State((x, y, z), (m1, m2, m3), state.g))
    return tuple(result)
