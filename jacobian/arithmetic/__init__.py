"""A curve over QQ at all primes up to a bound: its L-polynomials, their statistics, and its endomorphisms."""
