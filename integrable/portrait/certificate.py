"""The number of digits to which every state of a run agrees with a second run, computed with more digits."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import floor, inf
from typing import Any

import numpy as np

from integrable.moving_point.losses import digits_of
from integrable.phase.precisions import FLOAT_DIGITS
from integrable.phase.run import Run
from integrable.phase.ways import rounded
from jacobian import MP, RR
from jacobian.element import Real
from jacobian.errors import PrecisionLoss, whole, written
from jacobian.fields.machine import RealField
from jacobian.fields.multiprecision import MultiprecisionField

Pairs = Iterable[tuple[np.ndarray | Sequence[Real], np.ndarray | Sequence[Real]]]
"""Both vectors of the states at several times: γ and M, or q and p."""
Finer = Callable[[list[Real], MultiprecisionField], Pairs]
"""A function that returns the states at given times to the digits of a field."""

# the second run has WIDER more digits than the first, and at least LEAST
WIDER = 15
LEAST = 30
# by default all digits of MP(digits) but the last SLACK must agree, and all digits of floats but the last FLOAT_SLACK
SLACK = 1
FLOAT_SLACK = 3


def agreement(
    field: RealField | MultiprecisionField, run: Run[Any], finer: Finer, digits: int | None, unit: Real | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """The errors of the states of a ``run``, and how many digits of each agree with ``finer``.

    An error is relative to the largest component of each vector, or to ``unit`` for the first vector. PrecisionLoss if
    fewer than ``digits`` agree. The default of ``digits`` is 12 over RR, and one digit less than the field has over MP.
    """
    own = FLOAT_DIGITS if isinstance(field, RealField) else field.dps
    wanted = own - (FLOAT_SLACK if field is RR else SLACK) if digits is None else digits
    wanted = whole(wanted, "digits", f"{field.name} has 1 to {own} digits that can agree; give an int", 1, own)
    times, states = run.times, zip(run.q, run.p, strict=True)
    more = max(own + WIDER, LEAST)
    K = MP(more)
    # the first run has rounded the given times, and the second run must use the same times
    truth = finer([K.coerce(t) for t in times], K)
    errors = [
        max(_off(K, *first, unit), _off(K, *second))
        for first, second in (zip(*x, strict=True) for x in zip(states, truth, strict=True))
    ]
    agree = [min(more, floor(-digits_of(e))) for e in errors]
    for i, agreeing in enumerate(agree):
        if agreeing < wanted:
            raise PrecisionLoss(
                f"times[{i}] = {written(times[i])}: computed with {own} and with {more} digits the states agree to "
                f"{agreeing} digits, not to {wanted}; use more digits"
            )
    return rounded(RR if field is RR else K, errors), np.array(agree, dtype=int)


def _off(K: MultiprecisionField, found: Iterable[Real], true: Iterable[Real], unit: Real | None = None) -> Real:
    """The largest error of a component of ``found``, relative to ``unit`` or to the largest component of ``true``."""
    apart = max(abs(K.coerce(x) - y) for x, y in zip(found, true, strict=True))
    size = max(map(abs, true)) if unit is None else unit
    return apart / size if size else apart and inf
