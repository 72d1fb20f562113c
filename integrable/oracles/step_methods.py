"""Fixed-step methods in plain Python. They compute in floats, or in mpf for a system over MP(digits)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from integrable.oracles.collocation import collocation
from integrable.oracles.discrete_tops import hirota_kimura, moser_veselov
from integrable.oracles.expressions import Kind
from integrable.oracles.method import Built, Given, Method, Started
from integrable.oracles.stepping import Advance, follow

__all__ = ["Collocation", "DiscreteTop"]


@dataclass(frozen=True)
class Collocation(Method):
    """Gauss's collocation method (an implicit Runge–Kutta method) with a given number of stages."""

    stages: int = 1

    def build(self, kind: Kind, setting: Any) -> Built:
        def advance(given: Given) -> Advance:
            coefficients = kind.coefficients_of(given.constants, given.number, given.context)
            rates = kind.right_hand_side(coefficients, given.context)
            return collocation(rates, given.number, getattr(given.context, "dps", 0), self.stages)

        return _in_steps(advance, setting)


@dataclass(frozen=True)
class DiscreteTop(Method):
    """A discretization of the Euler top: "Moser-Veselov" of order 2 or 4, or "Hirota-Kimura"."""

    kinds: tuple[str, ...] = ("top",)

    def build(self, kind: Kind, setting: Any) -> Built:
        def advance(given: Given) -> Advance:
            moments = [given.number(x) for x in given.constants]
            return hirota_kimura(moments) if "Kimura" in self.name else moser_veselov(moments, self.order or 2)

        return _in_steps(advance, setting)


def _in_steps(make: Callable[[Given], Advance], step: Any) -> Built:
    def of_system(given: Given) -> Started:
        advance, h = make(given), given.number(step)

        def started(start: Any) -> Any:
            return lambda times: follow(advance, list(start), [given.number(t) for t in times], h)

        return started

    return of_system
