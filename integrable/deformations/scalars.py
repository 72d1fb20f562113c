"""The functions of (γ, M) of which the Hamiltonians of the deformations are composed, for numbers with operators."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import NamedTuple

from jacobian.element import Real


class Scalars:
    """Scalar functions of (γ, M), and the vectors Aγ and AM; each is computed on first use."""

    def __init__(self, a: Sequence[Real], d: Real, gamma: Sequence[Real], M: Sequence[Real]) -> None:
        self.a, self.d, self.gamma, self.M = tuple(a), d, tuple(gamma), tuple(M)
        a1, a2, a3 = self.a
        self.e1, self.e2, self.e3 = a1 + a2 + a3, a1 * a2 + a2 * a3 + a3 * a1, a1 * a2 * a3
        self.dual = (a2 * a3, a3 * a1, a1 * a2)

    # γ_i², Aγ and AM
    squares = cached_property(lambda q: componentwise(q.gamma, q.gamma))
    Ag = cached_property(lambda q: componentwise(q.a, q.gamma))
    AM = cached_property(lambda q: componentwise(q.a, q.M))
    # (γ, Aγ), (Aγ, Aγ) and (γ, A^∨γ), where A^∨ = e3·A⁻¹ has the diagonal ``dual``
    s = cached_property(lambda q: dot(q.a, q.squares))
    q2 = cached_property(lambda q: dot(componentwise(q.a, q.a), q.squares))
    sigma = cached_property(lambda q: dot(q.dual, q.squares))
    # (M, AM) and (M, M) = H2
    m1 = cached_property(lambda q: dot(q.AM, q.M))
    m2 = cached_property(lambda q: dot(q.M, q.M))
    # (γ, AM) and (γ, A^∨M)
    xi = cached_property(lambda q: dot(q.AM, q.gamma))
    zeta = cached_property(lambda q: dot(componentwise(q.dual, q.gamma), q.M))
    # (M, γ × Aγ) and (M, γ × A^∨γ)
    eta = cached_property(lambda q: dot(q.M, product(q.gamma, q.Ag)))
    eta_dual = cached_property(lambda q: dot(q.M, product(q.gamma, componentwise(q.dual, q.gamma))))
    # tr A − s and (Aγ, Aγ) − s²
    tau = cached_property(lambda q: q.e1 - q.s)
    t2 = cached_property(lambda q: q.q2 - q.s * q.s)
    # G = g² = 1/(1 − ds), and κ = G(s − d·q2)
    G = cached_property(lambda q: 1 / (1 - q.d * q.s))
    kappa = cached_property(lambda q: q.G * (q.s - q.d * q.q2))
    # (ω, M)
    H1 = cached_property(lambda q: q.m1 + q.d * q.G * q.xi * q.xi)

    def axes(self) -> list[tuple[Real, Real, Real, Real]]:
        """(a_i, a_j, a_k, γ_i²) for each axis."""
        return [(self.a[i], self.a[i - 2], self.a[i - 1], self.squares[i]) for i in range(3)]


class Potential(NamedTuple):
    """The five parameters of a potential: ``a`` and ``b`` of its polynomial part, ``poles`` the factors of 1/γ_i²."""

    a: Real
    b: Real
    poles: tuple[Real, Real, Real]


def poles(q: Scalars, potential: Potential, term: Callable[[Real, Real, Real], Real]) -> Real:
    """Σ b_i·term(a_i, a_j, a_k)/γ_i² over the axes with b_i ≠ 0."""
    total = 0 * q.s
    for b, (a, a2, a3, square) in zip(potential.poles, q.axes(), strict=True):
        if b != 0 * potential.a:
            total = total + b * term(a, a2, a3) / square
    return total


def dot(x: Sequence[Real], y: Sequence[Real]) -> Real:
    """Σ x_i y_i."""
    return sum(a * b for a, b in zip(x, y, strict=True))


def componentwise(x: Sequence[Real], y: Sequence[Real]) -> tuple[Real, ...]:
    """The vector of all x_i y_i."""
    return tuple(a * b for a, b in zip(x, y, strict=True))


def product(x: Sequence[Real], y: Sequence[Real]) -> list[Real]:
    """x × y."""
    return [x[i - 2] * y[i - 1] - x[i - 1] * y[i - 2] for i in range(3)]


def combination(*terms: tuple[Real, Sequence[Real]]) -> list[Real]:
    """The linear combination Σ c·v of pairs (c, v)."""
    return [sum(c * v[i] for c, v in terms) for i in range(3)]
