"""Sweeps: motions over a grid of a scene's numbers, or of an ensemble, in chunks on any executor, to one file."""
