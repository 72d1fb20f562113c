"""Methods of any number of digits: the closed form of the top, and Taylor series."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from integrable.oracles.expressions import Kind
from integrable.oracles.method import Built, Given, Method, Run, Started
from integrable.oracles.reference import odefun, taylor

__all__ = ["EllipticForm", "ManyDigits"]


class _Body(NamedTuple):
    inertia: tuple[Any, ...]
    d: Any


class _Start(NamedTuple):
    gamma: Sequence[Any]
    M: Sequence[Any]


@dataclass(frozen=True)
class EllipticForm(Method):
    """The closed form of the Euler top as a method: :class:`integrable.oracles.elliptic_top.EllipticTop`."""

    def build(self, kind: Kind, setting: Any) -> Built:
        from integrable.oracles.elliptic_top import EllipticTop

        if int(setting) <= 15:
            import scipy.special  # noqa: F401  # imported here, as part of the cost per machine

        def of_system(given: Given) -> Started:
            return lambda start: EllipticTop(_Body(given.constants, 0), _Start(start[:3], start[3:]), int(setting)).at

        return of_system


@dataclass(frozen=True)
class ManyDigits(Method):
    """A multiprecision integrator of a body: :func:`integrable.oracles.reference.taylor` or mpmath's ``odefun``."""

    def build(self, kind: Kind, setting: Any) -> Built:
        integrate = odefun if "odefun" in self.name else taylor

        def of_system(given: Given) -> Started:
            body = _Body(given.constants[:3], given.constants[3] if kind.name == "ball" else 0)

            def started(start: Sequence[Any]) -> Run:
                state = _Start(start[:3], start[3:])
                return lambda times: integrate(body, state, times, digits=int(setting))

            return started

        return of_system
