"""The number of decimal digits of floats."""

FLOAT_DIGITS = 15
"""Those of a float that count: up to so many a scene runs in floats, and a certificate of floats can confirm."""
EPS_DIGITS = 16
"""Those of a float's last bit: what a step loses in floats is counted from here."""
ROUNDED_TO_FLOATS = 17
"""Digits that states are computed to which are then rounded to floats."""
SET_UP_DIGITS = 45
"""Digits of the numbers that a motion in floats is set up in."""
