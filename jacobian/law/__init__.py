"""Divisor classes: Mumford's pair, from points and back, sampling, conjugate points."""
