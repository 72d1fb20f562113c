"""What is known of a finite Jacobian: its order, structure, logarithms, pairings, and quick multiples."""
