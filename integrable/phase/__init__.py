"""The states of a body as (γ, M), as divisors and in separated variables, and their Poisson structures."""
