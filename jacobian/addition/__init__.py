"""Exact addition of reduced triples: Cantor's, explicit formulas, NUCOMP, compiled code, and which one a curve
takes."""
