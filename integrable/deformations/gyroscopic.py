"""The gyroscopic deformation at d = 0: integrals with terms that are linear in M."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Self

from integrable.deformations.deformation import Deformation
from integrable.deformations.scalars import Potential, Scalars, combination, product
from jacobian import RR
from jacobian.element import Real, Value
from jacobian.fields.protocol import Field
from jacobian.immutable import replaced


class Gyroscopic(Deformation):
    """H = m1 − s·m2 + cη + c²s/4, K = (m2 + c²/4)(−ξ² + cη^∨ + c²σ/4) + m1(cη + c²(2s − tr A)/4), with a_i = 1/I_i.

    The letters are those of :class:`Scalars`; η^∨ is its ``eta_dual``. ``c`` is any constant; c = 0 gives H and −K of
    the tilde pair.
    """

    further = ("c",)

    def __init__(self, inertia: Iterable[Value], c: Value, *, field: Field = RR) -> None:
        self._build(inertia, 0, None, field)
        self.c = field.coerce(c, "c")

    @property
    def arguments(self) -> dict[str, object]:
        return {**super().arguments, "c": self.c}

    def over(self, field: Field) -> Self:
        return replaced(super().over(field), c=field.coerce(self.c, "c"))

    def pair(self, q: Scalars, potential: Potential | None) -> tuple[Real, Real]:
        c = self._constants()(self.c)
        quarter = c * c / 4
        energy = q.m1 - q.s * q.m2 + c * q.eta + quarter * q.s
        first = (q.m2 + quarter) * (c * q.eta_dual - q.xi * q.xi + quarter * q.sigma)
        return energy, first + q.m1 * (c * q.eta + quarter * (2 * q.s - q.e1))

    def motion(self, q: Scalars) -> tuple[list[Real], list[Real]]:
        """(Ω, Ṁ): Ω = AM − sM + (c/2)γ × Aγ, Ṁ = M × Ω + γ × [−m2·Aγ + (c/2)(Aγ × M + A(M × γ)) + (c²/4)Aγ]."""
        c = self._constants()(self.c)
        half = c / 2
        omega = combination((1, q.AM), (-q.s, q.M), (half, product(q.gamma, q.Ag)))
        turned = [a * x for a, x in zip(q.a, product(q.M, q.gamma), strict=True)]
        pull = combination((c * c / 4 - q.m2, q.Ag), (half, product(q.Ag, q.M)), (half, turned))
        return omega, combination((1, product(q.M, omega)), (1, product(q.gamma, pull)))
