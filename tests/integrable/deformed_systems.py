"""The deformations that the tests run over: every system with and without potential, over any field."""

from __future__ import annotations

from functools import partial
from math import sqrt
from random import Random
from typing import Any

from integrable.deformations.gyroscopic import Gyroscopic
from integrable.deformations.isometric import Check, Hat
from integrable.deformations.tilde import Tilde
from integrable.phase.jets import JetField
from integrable.phase.state import State

POTENTIAL = (3, 5, 2, 4, 6)
SYSTEMS = {
    "tilde": lambda K: Tilde((1, 2, 4), field=K),
    "tilde, d": lambda K: Tilde((1, 2, 4), 1, field=K),
    "tilde, potential": lambda K: Tilde((1, 2, 4), potential=POTENTIAL, field=K),
    "tilde, d, potential": lambda K: Tilde((1, 2, 4), 1, potential=POTENTIAL, field=K),
    "check": lambda K: Check((1, 2, 4), field=K),
    "check, potential": lambda K: Check((1, 2, 4), potential=POTENTIAL, field=K),
    "hat": lambda K: Hat((1, 2, 4), field=K),
    "hat, potential": lambda K: Hat((1, 2, 4), potential=POTENTIAL, field=K),
    "gyroscopic": lambda K: Gyroscopic((1, 2, 4), 3, field=K),
}


class OverJets:
    """The scalars of a state as jets in (γ, M): they give the derivatives of any formula in these scalars."""

    def __init__(self, system: Any, state: Any, d: Any = None) -> None:
        self.system, self.state, self.field = system, state, system.field
        self.jets = JetField(self.field, 6)
        wrap = self.jets.constant
        point = self.jets.variables((*state.gamma, *state.M))
        self.q = system.scalars(wrap, point[:3], point[3:])
        self.terms = system._terms(wrap)
        system_constants = JetField(self.field, 6).constant
        self.constant = system_constants

    def pair(self) -> Any:
        """(H, K) as jets."""
        # constants are jets during this call only
        vars(self.system)["_constants"] = lambda: self.constant
        try:
            return self.system.pair(self.q, self.terms)
        finally:
            del vars(self.system)["_constants"]

    def field_of(self, F: Any) -> tuple[Any, ...]:
        """{(γ, M), F}."""
        return tuple(self.field.dot(row, F.slopes) for row in self.system.poisson(self.state))

    def bracket(self, F: Any, G: Any) -> Any:
        """{F, G}."""
        return self.field.dot(F.slopes, self.field_of(G))


KINDS = ("tilde", "tilde, d", "check", "hat", "poles")


def random_deformation(kind: str, rng: Random, mild: bool = False) -> tuple[Any, State]:
    """A system over RR of one of the ``KINDS``, with a flow, and a state of it; the moments are within a factor of 300,
    or of 4 if ``mild``.
    """
    width = 0.6 if mild else 2.5
    inertia = [10 ** rng.uniform(-width / 2, width / 2) for _ in range(3)]
    gamma = [rng.gauss(0, 1) for _ in range(3)]
    length = sqrt(sum(x * x for x in gamma))
    gamma = [x / length for x in gamma]
    y = [rng.gauss(0, 1) for _ in range(3)]
    M = [gamma[i - 2] * y[i - 1] - gamma[i - 1] * y[i - 2] for i in range(3)]
    d = 10 ** rng.uniform(-2, 1)
    poles = (0.0, 0.0, *(10 ** rng.uniform(-2, 0) for _ in range(3)))
    system: Any = {
        "tilde": partial(Tilde),
        "tilde, d": partial(Tilde, d=d),
        "check": partial(Check),
        "hat": partial(Hat),
        "poles": partial(Tilde, potential=poles),
    }[kind](inertia)
    state = system.state(gamma, M)
    return system, state
