"""Random cases of every kind against oracles that share no code with the packages: ``python -m tests.fuzz --help``.

docs/fuzz.md describes the cases, the oracles and the findings.
"""
