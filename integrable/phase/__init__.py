"""States and their coordinates: bodies, (γ, M), pairs of divisors, separated variables, brackets."""
