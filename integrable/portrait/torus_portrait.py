"""Frequencies, actions and angles of a motion on a torus of any genus (:mod:`integrable.portrait.separated`)."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

from jacobian.element import Real
from jacobian.errors import NotRepresentable
from jacobian.immutable import Immutable

if TYPE_CHECKING:
    from integrable.portrait.separated import SeparatedTorus


class TorusPortrait(Immutable):
    """The global quantities of a motion of any genus, in the field of its system. Get one from ``flow.portrait``.

    ``frequencies`` are turns per unit of time: first of each point of the pair in its oval, in ascending order of
    ovals, then of the angles about an axis. ``actions`` are conjugate to 2π times the phases, so that dH = 2πΣf dJ;
    those of ovals are positive, and so is the frequency of a point that rests. Actions are None for a system that is
    not Hamiltonian in q and p. The state itself may return only after two turns of an oval, because the sign of a lift
    at an end of the oval changes in one turn.
    """

    def __init__(self, flow: Any) -> None:
        self._flow = flow
        signs, actions, *rows = flow._settled_on_torus(_numbers_of)
        self._signs = tuple(1 if x > 0 else -1 for x in signs)
        self.frequencies, self.actions = tuple(x for (x,) in rows), tuple(actions) or None

    @property
    def rotation_number(self) -> Real:
        """The quotient of the first two frequencies."""
        quotient: Real = self.frequencies[0] / self.frequencies[1]
        return quotient

    @property
    def periods(self) -> tuple[Real, ...]:
        """The periods 1/|f| of all frequencies f."""
        return tuple(abs(1 / f) for f in self.frequencies)

    @cached_property
    def angles(self) -> tuple[Real, ...]:
        """The phases θ of the points at the start, in turns modulo 1, 0 at the lower ends of ovals. At time t they are
        θ + ft, with the ``frequencies`` f. NotRepresentable where a point rests.
        """
        found = self._flow._settled_on_torus(_phases_of)
        return tuple((s * x) % 1 for s, (x,) in zip(self._signs, found, strict=False))

    def _repr_html_(self) -> str:
        from jacobian.notebook import named

        return named("what the motion is", [(name, getattr(self, name)) for name in ("frequencies", "actions")])

    def __repr__(self) -> str:
        return f"<TorusPortrait: frequencies {', '.join(f'{float(f):.6g}' for f in self.frequencies)}>"


def _numbers_of(torus: SeparatedTorus) -> list[list[Real]]:
    """[signs, actions, [f₁], …]: the signs make the actions of ovals positive; actions and frequencies have them."""
    actions, one = torus.actions, torus.one
    signs = [one for _ in torus.frequencies]
    for k, (oval, action) in enumerate(zip(torus.ovals, actions or (), strict=False)):
        # the action of a point that rests is 0 up to rounding, so its frequency gives the sign
        if (torus.frequencies[k] if torus.may_rest(oval) else action) < 0:
            signs[k] = -one
    genus, actions = len(torus.ovals), actions or []
    turned = [*map(abs, actions[:genus]), *actions[genus:]]
    return [signs, turned, *([s * x] for s, x in zip(signs, torus.frequencies, strict=True))]


def _phases_of(torus: SeparatedTorus) -> list[list[Real]]:
    if not all(map(torus.moves, torus.ovals)):
        raise NotRepresentable("angles: in this motion a point of the pair rests, which does not know its angle")
    return [[x] for x in torus.phases]
