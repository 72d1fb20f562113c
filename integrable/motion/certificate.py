"""A run beside the same run at more digits: how many digits of every state agree."""

from __future__ import annotations

from math import floor
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.motion.precise import PreciseFlow
from integrable.motion.symmetric_precise import PreciseClosedForm
from integrable.motion.trajectory import Motion
from integrable.moving_point.losses import digits_of
from integrable.phase.equal_moments import symmetry_axis
from integrable.phase.precisions import FLOAT_DIGITS
from jacobian import MP, RR
from jacobian.errors import PrecisionLoss, whole
from jacobian.immutable import replaced

if TYPE_CHECKING:
    from integrable.motion.trajectory import Trajectory

# digits by which the second run is wider, and its least number of digits
WIDER = 15
LEAST = 30
# digits that agree unless more are asked for: all but the last few bits
SLACK = 1
FLOAT_SLACK = 3


def certified(flow: Motion, times: Any, digits: int | None) -> Trajectory:
    """The states at physical times, with ``error`` and ``digits``: see :meth:`integrable.motion.flow.Flow.certify`."""
    field = flow.system.field
    own = FLOAT_DIGITS if field == RR else field.dps
    wanted = own - (FLOAT_SLACK if field == RR else SLACK) if digits is None else digits
    wanted = whole(wanted, "digits", f"{field.name} has 1 to {own} digits that can agree; give an int", 1, own)
    run = flow.at(times)
    more = max(own + WIDER, LEAST)
    K = MP(more)
    # the times of the run, not those given: they are the same numbers
    finer = _vectors(flow, [K.coerce(t) for t in run.times], K)
    errors = []
    for gamma, M, (true_gamma, true_M) in zip(run.gamma, run.M, finer, strict=True):
        size = max(map(abs, true_M))
        near = max(abs(K.coerce(x) - y) for x, y in zip(gamma, true_gamma, strict=True))
        far = max(abs(K.coerce(x) - y) for x, y in zip(M, true_M, strict=True)) / size
        errors.append(max(near, far))
    agree = [min(more, floor(-digits_of(e))) for e in errors]
    for i, agreeing in enumerate(agree):
        if agreeing < wanted:
            raise PrecisionLoss(
                f"times[{i}] = {run.times[i]}: computed with {own} and with {more} digits the states agree to "
                f"{agreeing} digits, not to {wanted}; use more digits"
            )
    error = np.array(errors, dtype=float) if field == RR else np.array([K.coerce(e) for e in errors], dtype=object)
    return replaced(run, error=error, digits=np.array(agree, dtype=int))


def _vectors(flow: Motion, times: list[Any], K: Any) -> list[tuple[Any, Any]]:
    """γ and M at physical times in the wide field K."""
    body, state = flow.system.body, flow.state
    if body.rolls and state.tilted and symmetry_axis(flow.system.inertia) is not None:
        # there the clock of many digits has no torus, and would count steps
        rows, _ = PreciseClosedForm(flow.system, state, field=K).at(np.array(times, dtype=object))
        return [(row[:3], row[3:]) for row in rows]
    finer = PreciseFlow(body, state, K.dps)
    return finer.vectors(finer.at(times)[1])
