"""Motions: the states of a start at any physical times, in floats, to many digits, or with proven bounds."""
