"""The hat map: Tsiganov's canonical change of variables (u, p) ↦ (û, p̂), on states."""

from __future__ import annotations

from collections.abc import Sequence

from integrable.phase import coordinates
from integrable.phase.body import square_root
from integrable.phase.space import PhaseSpace
from integrable.phase.state import State
from integrable.steps.step import Step, checked_signs
from jacobian.element import Element
from jacobian.errors import ArgumentError, NotRepresentable
from jacobian.relatives.signed import reflected


class HatMap(Step):
    """The map (û, p̂) = ρ⁻¹ ∘ (conic step through (0, 0)) ∘ ρ at d = 0, with ρ: (u, p) ↦ (u, up). It gives γ̂ = ±Aw/|Aw|
    and M̂ = Aw × A⁻¹γ.

    Here w = γ × M. Let y = V(x) be the line through the points (u_k, y_k) of the divisor, and φ(x) = 4Π(a_i − x). For
    suitable h1 and h2 the polynomial x²V² − φ·(h1x + h2) has the roots u_k and û_k, and V̂ = −V. Pairs are mapped by
    :func:`jacobian.relatives.signed.reflected` with the roots 2|Aw|/a_i.

    The map preserves the bracket, but not H1 and H2. It is :class:`integrable.steps.moves.Keyless`
    followed by the lift of A (:mod:`integrable.phase.isometry`). :func:`integrable.phase.sphere.hat` is the map in the
    coordinates (u, p). ``signs`` are the signs of the γ̂_i.
    """

    def __init__(self, system: PhaseSpace, signs: Sequence[int] | None = None) -> None:
        if system.body.rolls:
            raise ArgumentError(f"d = {system.d}: the hat map is one of the sphere, d = 0")
        self.system = system
        self.signs = checked_signs(signs, 3, "signs")

    def __repr__(self) -> str:
        return f"<hat map on {self.system!r}>"

    def __call__(self, state: State[Element]) -> State[Element]:
        """The image of a state; NotASquare where |Aw| is not in the field, NotRepresentable where it is 0."""
        system, K = self.system, self.system.field
        pairs = coordinates.upright_pairs(system.body, system._checked(state))
        turned = [K.mul(a, y) for a, (_, y) in zip(system.a, pairs, strict=True)]
        length = square_root(K, K.dot(turned, turned), "|2Aw|²")
        if length == K.zero:
            raise NotRepresentable(f"|Aw|² = 0 over {K.name}: γ has no image")
        roots = [K.div(length if sign > 0 else K.neg(length), a) for a, sign in zip(system.a, self.signs, strict=True)]
        return coordinates.from_pairs(system.body, reflected(K, pairs, roots))
