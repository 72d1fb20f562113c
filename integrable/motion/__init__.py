"""Motions through a given state: the states at any physical times, in floats, to many digits, or with proven bounds."""
