"""The functions of (γ, M) in the Hamiltonians of the deformations, for any numbers with Python's operators."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from jacobian.element import Real
from jacobian.immutable import quick_property


class Scalars:
    """Scalar functions of (γ, M), and the vectors Aγ and AM; each is computed on first use."""

    def __init__(self, a: Sequence[Real], d: Real, gamma: Sequence[Real], M: Sequence[Real]) -> None:
        self.a, self.d, self.gamma, self.M = tuple(a), d, tuple(gamma), tuple(M)

    # the diagonal of A^∨ = e3·A⁻¹, and the elementary symmetric functions of the a_i
    dual = quick_property(lambda q: (q.a[1] * q.a[2], q.a[2] * q.a[0], q.a[0] * q.a[1]))
    e1 = quick_property(lambda q: sum(q.a))
    e2 = quick_property(lambda q: sum(q.dual))
    e3 = quick_property(lambda q: q.a[0] * q.dual[0])
    # γ_i², γ_iM_i, M_i², Aγ and AM
    squares = quick_property(lambda q: componentwise(q.gamma, q.gamma))
    mixed = quick_property(lambda q: componentwise(q.gamma, q.M))
    momenta = quick_property(lambda q: componentwise(q.M, q.M))
    Ag = quick_property(lambda q: componentwise(q.a, q.gamma))
    AM = quick_property(lambda q: componentwise(q.a, q.M))
    # (γ, Aγ), (Aγ, Aγ) and (γ, A^∨γ)
    s = quick_property(lambda q: dot(q.a, q.squares))
    q2 = quick_property(lambda q: dot(componentwise(q.a, q.a), q.squares))
    sigma = quick_property(lambda q: dot(q.dual, q.squares))
    # (M, AM) and (M, M) = H2
    m1 = quick_property(lambda q: dot(q.a, q.momenta))
    m2 = quick_property(lambda q: sum(q.momenta))
    # (γ, AM) and (γ, A^∨M)
    xi = quick_property(lambda q: dot(q.a, q.mixed))
    zeta = quick_property(lambda q: dot(q.dual, q.mixed))
    # (M, γ × Aγ) and (M, γ × A^∨γ)
    eta = quick_property(lambda q: dot(q.M, product(q.gamma, q.Ag)))
    eta_dual = quick_property(lambda q: dot(q.M, product(q.gamma, componentwise(q.dual, q.gamma))))
    # tr A − s and (Aγ, Aγ) − s²
    tau = quick_property(lambda q: q.e1 - q.s)
    t2 = quick_property(lambda q: q.q2 - q.s * q.s)
    # G = g² = 1/(1 − ds), and κ = G(s − d·q2)
    G = quick_property(lambda q: 1 / (1 - q.d * q.s))
    kappa = quick_property(lambda q: q.G * (q.s - q.d * q.q2))
    # (ω, M)
    H1 = quick_property(lambda q: q.m1 + q.d * q.G * q.xi * q.xi)

    # (a_i, a_j, a_k, γ_i²) for each axis
    axes = quick_property(lambda q: [(q.a[i], q.a[i - 2], q.a[i - 1], q.squares[i]) for i in range(3)])


class RateTerms(NamedTuple):
    """The coefficients of a motion without potential: Ω = T + ``Ag``·Aγ, T = ``AM``·AM + ``M``·M; Ṁ = M × Ω + γ × P.

    P = ``pull``·Aγ + ``dual``·A^∨γ + ``Ag``·(AM − ``share``·T).
    """

    AM: Real
    M: Real
    Ag: Real = 0
    pull: Real = 0
    dual: Real = 0
    share: Real = 0

    def omega(self, q: Scalars) -> list[Real]:
        """Ω, for which γ̇ = γ × Ω."""
        return combination((self.AM, q.AM), (self.M, q.M), (self.Ag, q.Ag))

    def rates(self, q: Scalars) -> tuple[list[Real], list[Real]]:
        """(γ̇, Ṁ). They are written in γ_iγ_j, γ_iM_j and M_iM_j, so that their tape has the fewest products."""
        rate, momentum = [], []
        for k in range(3):
            i, j = k - 2, k - 1
            x, y, gap = q.gamma[i] * q.M[j], q.gamma[j] * q.M[i], q.a[j] - q.a[i]
            # the components of γ × T, T as in :class:`RateTerms`, and of γ × Aγ
            turned = self.AM * (q.a[j] * x - q.a[i] * y) + self.M * (x - y)
            bent = gap * (q.gamma[i] * q.gamma[j])
            rate.append(turned + self.Ag * bent)
            own = self.AM * (gap * (q.M[i] * q.M[j])) + (self.pull - q.a[k] * self.dual) * bent
            momentum.append(own + self.Ag * (gap * (x + y) - self.share * turned))
        return rate, momentum


class Potential(NamedTuple):
    """The five parameters of a potential: ``a`` and ``b`` of its polynomial part, and the factors b_i of 1/γ_i²."""

    a: Real
    b: Real
    b1: Real
    b2: Real
    b3: Real

    @property
    def poles(self) -> tuple[Real, Real, Real]:
        """The b_i."""
        return self[2:]


def poles(q: Scalars, potential: Potential, term: Callable[[Real, Real, Real], Real]) -> Real:
    """Σ b_i·term(a_i, a_j, a_k)/γ_i² over the axes with b_i ≠ 0."""
    total, nothing = 0 * q.s, 0 * potential.a
    for b, (a, a2, a3, square) in zip(potential.poles, q.axes, strict=True):
        if b != nothing:
            total = total + b * term(a, a2, a3) / square
    return total


def dot(x: Sequence[Real], y: Sequence[Real]) -> Real:
    """Σ x_i y_i, for three components."""
    (x1, x2, x3), (y1, y2, y3) = x, y
    # the sum begins with 0, as that of sum() does; the order of the constants in recorded formulas depends on it
    return 0 + x1 * y1 + x2 * y2 + x3 * y3


def componentwise(x: Sequence[Real], y: Sequence[Real]) -> tuple[Real, ...]:
    """The vector of all x_i y_i, for three components."""
    (x1, x2, x3), (y1, y2, y3) = x, y
    return x1 * y1, x2 * y2, x3 * y3


def product(x: Sequence[Real], y: Sequence[Real]) -> list[Real]:
    """x × y."""
    return [x[i - 2] * y[i - 1] - x[i - 1] * y[i - 2] for i in range(3)]


def combination(*terms: tuple[Real, Sequence[Real]]) -> list[Real]:
    """The linear combination Σ c·v of pairs (c, v)."""
    return [sum(c * v[i] for c, v in terms) for i in range(3)]
