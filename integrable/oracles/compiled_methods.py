"""Two methods that are compiled for every kind of system: Gauss–Legendre of order 16, and Taylor series."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import ceil, log
from typing import Any

import numpy as np

from integrable.oracles.expressions import Kind
from integrable.oracles.method import Built, Given, Method, Run, Started
from integrable.oracles.stepping import by_sign
from jacobian.errors import ArgumentError, PrecisionLoss

__all__ = ["CompiledTaylor", "Gauss16"]


@dataclass(frozen=True)
class Gauss16(Method):
    """Gauss–Legendre of order 16, with a fixed step or steps chosen for a tolerance.

    A time between two steps is reached by an extra, shorter step. Raises PrecisionLoss if the stages do not
    converge. ``evaluations`` counts evaluations of the right-hand side.
    """

    def build(self, kind: Kind, setting: Any) -> Built:
        from integrable.oracles import gauss16
        from integrable.oracles.generated import compiled

        rule, value = gauss16.rule(), float(setting)
        march = compiled(kind).fixed if self.parameter == "step" else compiled(kind).adaptive
        said = f"{self.parameter} = {value}: the stages of the implicit step have not converged; take a smaller one"

        def run(c: np.ndarray, start: np.ndarray, sign: float, distances: np.ndarray, out: np.ndarray) -> int:
            return march(c, rule, start, distances, (sign, value), out)

        return _built(kind, run, lambda: PrecisionLoss(said))


@dataclass(frozen=True)
class CompiledTaylor(Method):
    """Taylor series with a variable step, of order ½ ln(1/tolerance) + 1.

    The terms neglected in a step are about ``tolerance`` relative to γ and to M, or to q and to p. ``evaluations``
    counts expansions. Raises ArgumentError unless 0 < tolerance < 1, and RuntimeError where a step becomes 0, at a
    pole.
    """

    def build(self, kind: Kind, setting: Any) -> Built:
        from integrable.oracles.generated import compiled

        tolerance = float(setting)
        if not 0 < tolerance < 1:
            raise ArgumentError(f"tolerance = {tolerance}: give a number between 0 and 1")
        order, march = max(4, ceil(-log(tolerance) / 2 + 1)), compiled(kind).taylor
        said = "the steps of the Taylor series have become 0: there is a pole on the way"

        def run(c: np.ndarray, start: np.ndarray, sign: float, distances: np.ndarray, out: np.ndarray) -> int:
            return march(c, start, distances, (sign, tolerance, order), out)

        return _built(kind, run, lambda: RuntimeError(said))


def _built(kind: Kind, run: Callable[..., int], failure: Callable[[], Exception]) -> Built:
    """The result of :meth:`integrable.oracles.method.Method.build` for a loop ``run``, which it compiles or loads.

    ``run`` writes the states into its last argument and returns its cost, or a negative number if it fails.
    """
    run(np.ones(len(kind.used)), np.ones(kind.size), 1.0, np.empty(0), np.empty((0, kind.size)))

    def of_system(given: Given) -> Started:
        coefficients = np.array(kind.coefficients_of(given.constants), dtype=float)

        def started(start: Sequence[Any]) -> Run:
            first = np.array([float(x) for x in start])

            def reach(sign: int, distances: np.ndarray) -> tuple[np.ndarray, int]:
                out = np.empty((len(distances), kind.size))
                cost = run(coefficients, first, float(sign), distances, out)
                if cost < 0:
                    raise failure()
                return out, int(cost)

            return lambda times: by_sign(first, np.array([*times], dtype=float), reach)

        return started

    return of_system
