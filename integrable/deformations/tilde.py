"""The tilde pair of integrals, made with the ball's map that adds a divisor of order 2, and its potentials."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from integrable.deformations.deformation import Deformation
from integrable.deformations.scalars import Potential, RateTerms, Scalars, poles
from jacobian import RR
from jacobian.element import Real, Value
from jacobian.fields.protocol import Field
from jacobian.immutable import at_once, quick_property


class Tilde(Deformation):
    """H = λ1 + λ2, K = −λ1λ2, λ_k = H1 − ũ_kH2; ũ_k are the abscissas of the image under :meth:`System.torsion`.

    H = m1 − s·m2 + 2dGξ² and K = Gξ²(H2 − dH1), d ≥ 0, in the letters of :class:`Scalars`. ``potential`` = (a, b, b_1,
    b_2, b_3) adds as + b(s³ − tr A·s²) + Σb_i(a_j + a_k − 2s)/γ_i² at d = 0. At d ≠ 0 it adds aG + b(G³ − TG²) +
    Σb_i(a_j + a_k − 2κ)/(Gγ_i²), T = Σ1/(1 − da_i). (Tsiganov, tH1 and tK1, with docs/errata.md, items 17 to 21.)
    """

    has_curves = True

    @at_once
    def __init__(
        self, inertia: Iterable[Value], d: Value = 0, *, potential: Sequence[Value] | None = None, field: Field = RR
    ) -> None:
        self._build(inertia, d, potential, field)

    @quick_property
    def repels(self) -> bool:
        if self.potential is None or self.body.rolls or self.field.characteristic:
            return False
        zero = self.field.zero
        return self.potential.a == self.potential.b == zero and bool(min(self.potential.poles) > zero)

    def pair(self, q: Scalars, potential: Potential | None) -> tuple[Real, Real]:
        square = q.xi * q.xi
        energy = q.m1 - q.s * q.m2 + 2 * q.d * q.G * square
        if potential is None:
            return energy, q.G * square * (q.m2 - q.d * q.H1)
        energy = energy + self.potential_energy(q, potential)
        second = _rolling(q, potential) if self.body.rolls else _free(q, potential)
        return energy, second

    def potential_energy(self, q: Scalars, potential: Potential) -> Real:
        energy: Real
        a, b, *_ = potential
        if not self.body.rolls:
            terms = poles(q, potential, lambda _, a2, a3: a2 + a3 - 2 * q.s)
            energy = a * q.s + b * (q.s - q.e1) * q.s * q.s + terms
            return energy
        trace = sum(1 / (1 - q.d * x) for x in q.a)
        terms = poles(q, potential, lambda _, a2, a3: (a2 + a3 - 2 * q.kappa) / q.G)
        energy = a * q.G + b * (q.G - trace) * q.G * q.G + terms
        return energy

    def motion(self, q: Scalars) -> RateTerms:
        """Ω = AM − sM + 2dGξAγ, Ṁ = M × Ω + γ × [dGξ(AM + sM) − m2·Aγ], in the letters of :class:`Scalars`."""
        spin: Real = 2 * (q.d * q.G * q.xi) if self.body.rolls else 0
        return RateTerms(1, -q.s, spin, -q.m2, share=self._constants()(self.field.one) / 2)


def _free(q: Scalars, potential: Potential) -> Any:
    """The integral K with a potential at d = 0."""
    a, b, *_ = potential
    first = q.m2 - a - b * (q.s * q.s - q.e1 * q.s - q.sigma) + poles(q, potential, lambda *_: 1)
    return first * (q.xi * q.xi - poles(q, potential, lambda _, a2, a3: (q.s - a2) * (q.s - a3)))


def _rolling(q: Scalars, potential: Potential) -> Any:
    """The integral K with a potential at d ≠ 0."""
    (a, b, *_), d, G = potential, q.d, q.G
    inverse = [1 / (1 - d * x) for x in q.a]
    trace, whole = sum(inverse), inverse[0] * inverse[1] * inverse[2]
    first = poles(q, potential, lambda _, a2, a3: (a2 + a3 - q.kappa) / G)
    second = poles(q, potential, lambda *_: 1 / G)
    rest = poles(q, potential, lambda _, a2, a3: (q.kappa - a2) * (q.kappa - a3) / G)
    depth = a + b * (G * G - trace * G - (1 - d * q.kappa) * whole)

    def well(a1: Real, a2: Real, a3: Real) -> Any:
        pair = 1 / (1 - d * a2) + 1 / (1 - d * a3)
        return a + b * (G * G - G * pair - pair / (1 - d * a1))

    square = q.xi * q.xi
    return (
        (q.m2 + second) * (G * square - d * G * q.t2 * q.H1 - rest)
        + d * G * q.eta * q.eta * (q.H1 + first)
        - d * G * G * square * depth
        - d * G * q.t2 * poles(q, potential, well)
    )
