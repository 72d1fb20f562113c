"""Sweeps: many motions, over a grid of a scene's numbers or of an ensemble, written to one file.

The motions are computed in chunks, on any executor.
"""
