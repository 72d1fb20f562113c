"""Numbers of decimal digits: those of floats, and those used to compute results that are rounded to floats."""

FLOAT_DIGITS = 15
"""Significant digits of a float. A scene that asks for at most this many runs in floats, and a certificate in floats
can confirm at most this many."""
EPS_DIGITS = 16
"""The digits of a float's last bit: the loss of a step in floats is counted from there."""
ROUNDED_TO_FLOATS = 17
"""Digits to which states are computed that are then rounded to floats."""
SET_UP_DIGITS = 45
"""Digits of the numbers in which the set-up of a motion in floats is computed."""
