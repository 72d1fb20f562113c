"""Taylor series of motions from formulas: tapes, recurrences, and compiled walks of any equations in floats."""
