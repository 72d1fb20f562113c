"""Frequencies, actions and angles of a motion on a torus: of any genus (:mod:`integrable.portrait.separated`), or the
product of two elliptic curves (:mod:`integrable.deformations.carrier`).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, Protocol

from jacobian.element import Real
from jacobian.errors import NotRepresentable
from jacobian.immutable import Immutable
from jacobian.notebook import named


class OvalsTorus(Protocol):
    """A torus on which each point turns in its oval, in long numbers. Frequencies and phases are in turns, in a
    direction of the torus's own; ``signs`` make the actions of ovals positive.
    """

    @property
    def ovals(self) -> Sequence[Any]: ...
    @property
    def frequencies(self) -> list[Real]: ...
    @property
    def phases(self) -> list[Real]: ...
    @property
    def actions(self) -> list[Real] | None: ...
    @property
    def signs(self) -> Sequence[Real]: ...
    def moves(self, oval: Any) -> bool:
        """Whether the point of an oval moves."""


class TorusPortrait(Immutable):
    """The global quantities of a motion on a torus, in the field of its system. Get one from ``flow.portrait``.

    ``frequencies`` are turns per unit of time: first of each point of the pair in its oval, in ascending order of
    ovals, then of the angles about an axis. ``actions`` are conjugate to 2π times the phases, so that dH = 2πΣf dJ;
    those of ovals are positive, and so is the frequency of a point that rests. Actions are None for a system that is
    not Hamiltonian in q and p. The state itself may return only after two turns of an oval, because the sign of a lift
    at an end of the oval changes in one turn.

    The points of a deformation are its separated variables ũ1 < ũ2. The Hamiltonian of its motion in τ is H/2, so with
    the turns ν per unit of τ, d(H/2) = 2πΣν dJ; f = ν at d = 0.
    """

    def __init__(self, flow: Any) -> None:
        self._flow = flow
        signs, actions, *rows = flow._settled_on_torus(_numbers_of)
        self._signs = tuple(1 if x > 0 else -1 for x in signs)
        self.frequencies, self.actions = tuple(x for (x,) in rows), tuple(actions) or None

    @property
    def rotation_number(self) -> Real:
        """The quotient of the first two frequencies."""
        return self.frequencies[0] / self.frequencies[1]

    @property
    def periods(self) -> tuple[Real, ...]:
        """The periods 1/|f| of all frequencies f."""
        return tuple(abs(1 / f) for f in self.frequencies)

    @cached_property
    def angles(self) -> tuple[Real, ...]:
        """The phases θ of the points at the start, in turns modulo 1, 0 at the lower ends of ovals. At time t they are
        θ + ft if t is linear in τ, with the ``frequencies`` f. NotRepresentable where a point rests.
        """
        found = self._flow._settled_on_torus(phases_of)
        # a small negative phase modulo 1 may be rounded to 1
        return tuple((s * x) % 1 % 1 for s, (x, _) in zip(self._signs, found, strict=False))

    def _repr_html_(self) -> str:
        return named("what the motion is", [(name, getattr(self, name)) for name in ("frequencies", "actions")])

    def __repr__(self) -> str:
        return f"<TorusPortrait: frequencies {', '.join(f'{float(f):.6g}' for f in self.frequencies)}>"


def _numbers_of(torus: OvalsTorus) -> list[Sequence[Real]]:
    """The signs, then the actions and each frequency with these signs."""
    signs, genus, actions = torus.signs, len(torus.ovals), torus.actions or []
    turned = [*map(abs, actions[:genus]), *actions[genus:]]
    return [signs, turned, *([s * x] for s, x in zip(signs, torus.frequencies, strict=True))]


def phases_of(torus: OvalsTorus, name: str = "angles") -> list[list[Real]]:
    """The phases of the points at the start; NotRepresentable with the ``name`` of the request where a point rests."""
    if not all(map(torus.moves, torus.ovals)):
        raise NotRepresentable(f"{name}: in this motion a point of the pair rests, which does not know its angle")
    # digits of a phase count from those of a whole turn
    return [[x, 0 * x + 1] for x in torus.phases]
