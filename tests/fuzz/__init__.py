"""Random cases of every kind against oracles that share no code with the packages: ``python -m tests.fuzz --help``.

docs/fuzz.md says what is tried, against what, and what the runs found.
"""
