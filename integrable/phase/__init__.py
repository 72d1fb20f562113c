"""States and their coordinates: bodies, (γ, M), divisors, separated variables; and their Poisson brackets."""
