"""Decimal digits of floats, and of the computations whose results are rounded to floats."""

from __future__ import annotations

from typing import Any

from jacobian import RR
from jacobian.errors import ArgumentError

FLOAT_DIGITS = 15
"""Significant digits of a float: the most that a scene computed in floats may request, and the most that a certificate
in floats can confirm.
"""
EPS_DIGITS = 16
"""The digits of a float, rounded up; a step needs these and the digits that it loses."""
ROUNDED_TO_FLOATS = 17
"""The number of correct digits of states before they are rounded to floats."""
SET_UP_DIGITS = 45
"""The working digits of the set-up of a motion in floats."""


def long_digits(K: Any) -> int:
    """The digits of long numbers needed for results in K; ArgumentError except for RR and MP(digits)."""
    if K.exact or K.complex:
        raise ArgumentError(f"field = {K.name}: a motion runs over RR or MP(digits)")
    return ROUNDED_TO_FLOATS if K is RR else int(K.dps)
