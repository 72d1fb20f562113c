"""From a start to the states at physical times, near and far, in floats or to any number of digits, with proven
bounds.
"""
