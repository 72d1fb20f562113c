"""Integrators that share no code with the flow, to check it and compare it with."""
