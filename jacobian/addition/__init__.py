"""Exact addition of reduced triples, and the choice of its method: Cantor's algorithm, explicit formulas, NUCOMP or
compiled code."""
