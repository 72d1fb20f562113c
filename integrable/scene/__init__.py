"""Runs described as TOML: read, run, reported, drawn."""
