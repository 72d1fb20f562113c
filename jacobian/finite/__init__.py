"""Questions about a finite Jacobian: its order, structure, logarithms, pairings, and fast multiples."""
