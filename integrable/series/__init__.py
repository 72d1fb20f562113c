"""Taylor series of motions from formulas: tapes, recurrences, and short runs of any equations in floats."""
