"""A finite Jacobian as a group: its order, structure, logarithms, pairings, and fast multiples."""
