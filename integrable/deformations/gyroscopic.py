"""The gyroscopic deformation at d = 0: integrals with terms that are linear in M."""

from __future__ import annotations

from collections.abc import Iterable

from integrable.deformations.deformation import Deformation
from integrable.deformations.scalars import Potential, RateTerms, Scalars, combination, product
from jacobian import RR
from jacobian.element import Real, Value
from jacobian.fields.protocol import Field
from jacobian.immutable import at_once


class Gyroscopic(Deformation):
    """H = m1 − s·m2 + cη + c²s/4, K = (m2 + c²/4)(−ξ² + cη^∨ + c²σ/4) + m1(cη + c²(2s − tr A)/4), with a_i = 1/I_i.

    The letters are those of :class:`Scalars`; η^∨ is its ``eta_dual``. ``c`` is any constant; c = 0 gives H and −K of
    the tilde pair.
    """

    c: Real
    further = ("c",)

    @at_once
    def __init__(self, inertia: Iterable[Value], c: Value, *, field: Field = RR) -> None:
        self._build(inertia, 0, None, field)
        vars(self).update(c=field.coerce(c, "c"))

    @property
    def arguments(self) -> dict[str, object]:
        return {**super().arguments, "c": self.c}

    def pair(self, q: Scalars, potential: Potential | None) -> tuple[Real, Real]:
        c = self._constants()(self.c)
        quarter = c * c / 4
        energy = q.m1 - q.s * q.m2 + c * q.eta + quarter * q.s
        first = (q.m2 + quarter) * (c * q.eta_dual - q.xi * q.xi + quarter * q.sigma)
        return energy, first + q.m1 * (c * q.eta + quarter * (2 * q.s - q.e1))

    def motion(self, q: Scalars) -> RateTerms:
        """Ω = AM − sM + (c/2)γ × Aγ, Ṁ = M × Ω + γ × [−m2·Aγ + (c/2)(Aγ × M + A(M × γ)) + (c²/4)Aγ].

        Letters are those of :class:`Scalars`. The terms with c/2 are added by :meth:`omega_at` and :meth:`rates_at`.
        """
        c = self._constants()(self.c)
        return RateTerms(1, -q.s, 0, c * c / 4 - q.m2)

    def omega_at(self, q: Scalars) -> list[Real]:
        return combination((1, super().omega_at(q)), (self._constants()(self.c) / 2, product(q.gamma, q.Ag)))

    def rates_at(self, q: Scalars) -> tuple[list[Real], list[Real]]:
        half, size, tilt = self._constants()(self.c) / 2, sum(q.squares), sum(q.mixed)
        rate, momentum = super().rates_at(q)
        # γ × (γ × Aγ) = sγ − (γ, γ)Aγ, and M × (γ × Aγ) + γ × (Aγ × M + A(M × γ)) = 2(ξγ − sM) + (tr A − A)N with
        # N = (γ, γ)M − (γ, M)γ
        turn = combination((q.s, q.gamma), (-size, q.Ag))
        lean = combination((size, q.M), (-tilt, q.gamma))
        pull = combination((2 * q.xi, q.gamma), (-2 * q.s, q.M))
        for k in range(3):
            rate[k] = rate[k] + half * turn[k]
            momentum[k] = momentum[k] + half * (pull[k] + (q.e1 - q.a[k]) * lean[k])
        return rate, momentum
