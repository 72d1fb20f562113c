"""The conditioning of a motion: how rounding of the inputs grows, and the least possible error of any method.

An input known only to its last digit, x(1 + eps), changes the state at time t by eps·|x ∂state/∂x|, for any method.
:func:`conditioning` sums these changes over all inputs: moments of inertia, d, the parameters of a deformation, γ and
M. The changes are computed by differences of the motion itself. The sum times the rounding unit eps of an arithmetic is
the least error that a method in this arithmetic can promise (Higham 2002, section 1.6: forward error ≲ condition ×
backward error).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from integrable.phase.state import State
from jacobian import RR
from jacobian.element import Real
from jacobian.errors import ArgumentError

FLOAT_CHANGE = 1e-7
"""Relative change of an input in floats: about 1e8 times the rounding errors of the state, 1e-15."""
LINEAR = 1e-3
"""If the state changes by more than this, the difference is recomputed with a smaller change of the input."""

StatesAt = Callable[[Any, State, Sequence[Real]], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Conditioning:
    """The largest values over the times of Σ |x ∂γ/∂x| and of Σ |x ∂M/∂x|/|M|, the sums being over the inputs x.

    For a system without a body γ and M stand for q and p. A change of q or of p is then relative to its size
    at the start or at the same time, whichever is larger.
    """

    gamma: float
    M: float
    inputs: dict[str, float] = dataclasses.field(hash=False)
    """The contribution of each input to ``gamma``, at the time at which it is largest."""

    def floor(self, eps: float = 2.0**-52) -> tuple[float, float]:
        """The errors of γ and of M (relative to |M|) that inputs rounded to ``eps`` cause."""
        return eps * self.gamma, eps * self.M


def conditioning(system: Any, state: State, times: Sequence[Real], motion: StatesAt | None = None) -> Conditioning:
    """The conditioning of the states at ``times`` of a motion over RR or MP(digits).

    ``motion(system, state, times)`` returns γ and M, shapes (N, 3); by default the system's own motion. In floats an
    input is changed by 1e-7 of itself, or by less if the motion is very sensitive. In multiprecision it is changed by
    2⁻⁵², so the result holds for doubles even where the motion is not linear in its inputs. Inputs that are 0 are
    exact. Raises the errors of the motion (PrecisionLoss where floats do not suffice: use MP(30)).
    """
    field = system.field
    if field.exact:
        raise ArgumentError(f"field = {field.name}: a conditioning needs a motion over RR or MP(digits)")
    flow, wanted = system.motion_through(state), list(times)
    (numbers, sizes, _), names = flow._inputs()

    def rows(changed: Any) -> Sequence[np.ndarray]:
        return changed._states(wanted) if motion is None else motion(changed.system, changed.state, wanted)

    base = rows(flow._with(numbers, field))
    units = _sizes(flow, base)
    gamma, M, parts = np.zeros(len(wanted)), np.zeros(len(wanted)), {}
    for name, k in zip(names, [k for k, size in enumerate(sizes) if size], strict=True):
        if numbers[k] == 0:
            continue
        change = FLOAT_CHANGE if field is RR else 2.0**-52

        def difference(change: float, k: int = k) -> list[np.ndarray]:
            moved = [*numbers[:k], numbers[k] * (1 + field.coerce(change)), *numbers[k + 1 :]]
            pairs = zip(rows(flow._with(moved, field)), base, units, strict=True)
            return [abs((a - b).astype(float)).max(axis=1) / size for a, b, size in pairs]

        found = difference(change)
        if field is RR and (largest := max(x.max(initial=0) for x in found)) > LINEAR:
            change *= max(LINEAR / 100 / largest, 1e-6)
            found = difference(change)
        gamma += found[0] / change
        M += found[1] / change
        parts[name.replace("gamma", "γ")] = float(found[0].max(initial=0) / change)
    return Conditioning(float(gamma.max(initial=0)), float(M.max(initial=0)), parts)


def _sizes(flow: Any, rows: Sequence[np.ndarray]) -> list[float | np.ndarray]:
    """The sizes of γ and of M, at each time, to which their changes are relative."""
    gamma, M = flow.state.vectors
    size = float(flow.system.field.sqrt(flow.system.field.dot(M, M))) or 1.0
    if flow._unit is not None:
        return [float(flow._unit), size]
    starts = float(max(map(abs, gamma))) or 1.0, size
    return [np.maximum(abs(x).max(axis=1).astype(float), start) for x, start in zip(rows, starts, strict=True)]
