"""A page about a curve over QQ: invariants, points, torsion, periods, endomorphisms."""
