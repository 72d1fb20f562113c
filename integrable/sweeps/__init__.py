"""Sweeps: motions over a grid of what a scene gives, or of an ensemble, chunk by chunk on any executor, to one file."""
