"""Exact addition of reduced triples by Cantor's algorithm, explicit formulas, NUCOMP or compiled code, and the choice
between them."""
