"""Motions on the Jacobian of y² = f(x) in any genus: vector fields, maps, and states at any time."""
