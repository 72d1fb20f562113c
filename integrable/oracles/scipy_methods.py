"""SciPy's integrators as methods. The right-hand side is in Python, as most users write it, or compiled."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from integrable.oracles.expressions import Kind
from integrable.oracles.method import Built, Given, Method, Run, Started
from integrable.oracles.reference import integrated

__all__ = ["SciPy"]


@dataclass(frozen=True)
class SciPy(Method):
    """SciPy's ``solve_ivp``. The tolerance is relative to 1 in the state's first half, and to |M| in the second."""

    solver: str = "DOP853"

    def build(self, kind: Kind, setting: Any) -> Built:
        import scipy.integrate  # noqa: F401  # imported once a machine, and not by a start

        code = None
        if self.compiled:
            from integrable.oracles.generated import compiled

            code = compiled(kind).right_hand_side
            code(0.0, np.ones(kind.size), np.ones(len(kind.used)))

        def of_system(given: Given) -> Started:
            coefficients = kind.coefficients_of(given.constants)
            if code is not None:
                array = np.array(coefficients, dtype=float)
                rates: Callable[[float, Any], Any] = lambda t, y: code(t, y, array)  # noqa: E731
            else:
                field = kind.right_hand_side(coefficients)
                rates = lambda _time, y: field(y.tolist())  # noqa: E731
            return lambda start: self._started(rates, [float(x) for x in start], float(setting))

        return of_system

    def _started(self, rates: Callable[[float, Any], Any], start: Sequence[float], relative: float) -> Run:
        half = len(start) // 2
        size = sum(m * m for m in start[half:]) ** 0.5 or 1.0
        absolute = [relative] * half + [relative * size] * half
        return lambda times: integrated(rates, start, times, method=self.solver, rtol=relative, atol=absolute)
