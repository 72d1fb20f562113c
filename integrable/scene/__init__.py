"""Runs described in TOML files: readers, motions and orbits, and the files, tables and progress bars of a run."""
