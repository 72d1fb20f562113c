"""Runs described as TOML: reading them, their motions and orbits, and the files, tables and bars of a run."""
