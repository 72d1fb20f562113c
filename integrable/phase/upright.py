"""Chaplygin's linear map of states with (γ, M) ≠ 0 to states of another body with (γ̃, M̃) = 0.

    γ̃ = p(γ + kM),  M̃ = s(M − dkH1γ),  d̃ = d(1 + kc),  Ĩ_i = I_i − dkc,     c = (γ, M),
    s = (1 + dk²H1)^(−1/2),  p = ((1 + kc)(1 + dk²H1))^(−1/2),  c·d·H1·k² − (H2 − dH1)k − c = 0.

The a_i = 1/(I_i + d), H1 and the time τ of the flow (dτ = g dt) are the same for both bodies. Over the reals k is the
root with −1 < kc ≤ 0, which depends continuously on c and is 0 at c = 0. At d = 0, γ̃ is the unit vector of γ − (c/H2)M
and M̃ = M. (Chaplygin 1903; tests/integrable/phase/test_identities_tilted.py checks the constants exactly.)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from integrable.phase.body import Body, Integrals, Vector, cross, square_root
from integrable.phase.state import State
from jacobian.element import Real
from jacobian.errors import NotRepresentable
from jacobian.numbers.roots import root


@dataclass(frozen=True)
class ChaplyginTransformation:
    """The change of variables at one value of (c, H1, H2), made by :meth:`of`. :meth:`apply` and :meth:`invert` are
    inverse to each other on all states with these integrals.

    ``body`` is the given body, ``upright`` the one on which (γ̃, M̃) = 0.
    """

    body: Body
    upright: Body
    k: Real
    s: Real
    p: Real
    shift: Real
    """The product d·k·H1."""

    @staticmethod
    def of(body: Body, gamma: Vector, M: Vector) -> ChaplyginTransformation:
        """The transformation at the integrals of (γ, M), |γ| = 1.

        Raises NotRepresentable at M ∥ γ (M = 0 included), NotASquare where k, s or p of the module's
        formulas is not in the field.
        """
        K = body.field
        integrals, square = body.integrals(gamma, M), leaning(K, gamma, M)
        if K.exact:
            k = _exact_root(body, integrals)
            rest = K.add(K.one, K.mul(k, integrals.C2))
        else:
            k, rest, _, _ = transformation(*integrals[1:], square, body.d)
        if rest == K.zero:
            raise parallel(integrals.C2)
        shift = K.mul(body.d, K.mul(k, integrals.H1))
        turn = K.mul(k, integrals.C2)
        stretch = K.add(K.one, K.mul(k, shift))
        if stretch == K.zero:
            raise NotRepresentable(f"1 + dk²H1 = 0 over {K.name}: Chaplygin's transformation has no such body")
        s = K.inv(square_root(K, stretch, "1 + dk²H1"))
        p = K.mul(s, K.inv(square_root(K, rest, "1 + kc")))
        d = K.mul(body.d, rest)
        less = K.mul(body.d, turn)
        moments = tuple(K.sub(moment, less) for moment in body.inertia)
        return ChaplyginTransformation(body, Body.make(moments, d, K), k, s, p, shift)

    def apply(self, state: State) -> State:
        """The upright state (γ̃, M̃); if the state has g, also g̃ = g/(s(1 − dk(γ, ω))) with the attributes s and k."""
        K = self.body.field
        gamma, M = self.apply_vectors(*state.vectors)
        g = None if state.g is None else K.div(state.g, K.mul(self.s, self._slip(*state.vectors)))
        return State(gamma, M, g)

    def apply_vectors(self, gamma: Vector, M: Vector) -> tuple[Vector, Vector]:
        """The vectors γ̃ = p(γ + kM) and M̃ = s(M − dkH1γ)."""
        K = self.body.field
        tilde = tuple(K.mul(self.p, K.add(x, K.mul(self.k, y))) for x, y in zip(gamma, M, strict=True))
        momentum = tuple(K.mul(self.s, K.sub(y, K.mul(self.shift, x))) for x, y in zip(gamma, M, strict=True))
        return (tilde[0], tilde[1], tilde[2]), (momentum[0], momentum[1], momentum[2])

    def invert(self, state: State) -> State:
        """The tilted State (γ, M) of an upright state (γ̃, M̃): γ = s²(γ̃/p − kM̃/s) and M = s²(M̃/s + dkH1·γ̃/p)."""
        K = self.body.field
        a, b, c, d = self.inverse_matrix()
        x1, x2, x3, m1, m2, m3 = (
            K.add(K.mul(first, x), K.mul(second, y))
            for first, second in ((a, b), (c, d))
            for x, y in zip(*state.vectors, strict=True)
        )
        gamma, M = (x1, x2, x3), (m1, m2, m3)
        g = None if state.g is None else K.mul(state.g, K.mul(self.s, self._slip(gamma, M)))
        return State(gamma, M, g, tilted=True)

    def inverse_matrix(self) -> tuple[Real, Real, Real, Real]:
        """The inverse as four numbers (a, b, c, d): γ = aγ̃ + bM̃, M = cγ̃ + dM̃."""
        K = self.body.field
        upright = K.div(K.mul(self.s, self.s), self.p)
        return upright, K.neg(K.mul(self.s, self.k)), K.mul(upright, self.shift), self.s

    def _slip(self, gamma: Vector, M: Vector) -> Real:
        """The factor 1 − dkn of :meth:`apply`, n = (γ, ω)."""
        K = self.body.field
        slip = K.sub(K.one, K.mul(K.mul(self.body.d, self.k), K.dot(gamma, self.body.omega(gamma, M))))
        if K.exact and slip == K.zero:
            raise NotRepresentable(f"1 − dk(γ, ω) = 0 over {K.name}: 1/g̃ vanishes behind this state")
        return slip


def leaning(K: Any, gamma: Vector, M: Vector) -> Real:
    """The square |γ × M|². NotRepresentable at M ∥ γ, M = 0 included, where k = −1/c and Chaplygin's transformation
    does not exist.
    """
    w = cross(K, gamma, M)
    square, size = K.dot(w, w), K.dot(M, M)
    if K.zero == size or not (K.exact or square > (16 * K.eps) ** 2 * size):
        raise parallel(K.dot(gamma, M))
    return square


def _exact_root(body: Body, integrals: Integrals) -> Real:
    """k over an exact field: −2c/((H2 − dH1) + √((H2 − dH1)² + 4c²dH1)), with the other sign of the square root if the
    denominator vanishes.
    """
    K, (_, c, h1, h2) = body.field, integrals
    if not body.rolls:
        return K.neg(K.div(c, h2))
    rolling, two = K.mul(body.d, h1), K.add(K.one, K.one)
    rest, double = K.sub(h2, rolling), K.mul(two, c)
    root = square_root(K, K.add(K.mul(rest, rest), K.mul(K.mul(double, double), rolling)), "(H2 − dH1)² + 4c²dH1")
    total = K.add(rest, root)
    if total == K.zero:
        total = K.sub(rest, root)
    if total == K.zero:
        raise parallel(c)
    return K.neg(K.div(double, total))


def transformation(c: Real, h1: Real, h2: Real, square: Real, d: Real) -> tuple[Real, Real, Real, Real]:
    """(k, 1 + kc, s, dkH1) of Chaplygin's transformation over the reals, from c = (γ, M), H1, H2, ``square`` = |γ × M|²
    and d. The compiler takes this function unchanged.
    """
    if d == 0:
        return -(c / h2), square / h2, 1 + 0 * c, 0 * c
    rolling, double = d * h1, 2 * c
    rest = h2 - rolling
    whole = root(rest * rest + double * double * rolling)
    # a sum in which digits would cancel is computed as a quotient: whole + rest = 4c²dH1/(whole − rest), and
    # total·(1 + kc) = whole + below = 4c²|γ × M|²/(whole − below)
    total = rest + whole if rest > 0 else double * double * rolling / (whole - rest)
    k = -(double / total)
    below = rest - double * c
    left = 1 + k * c if below > 0 else double * double * square / ((whole - below) * total)
    rise = k * rolling
    return k, left, 1 / root(1 + k * rise), rise


def parallel(c: Real) -> NotRepresentable:
    return NotRepresentable(
        f"M is parallel to gamma, (γ, M) = {c}: there is no body with (γ̃, M̃) = 0 behind this motion; γ moves as the "
        "momentum of the free top of moments I_i + d instead (Ṁ = M × AM for g²M, g constant)"
    )
