"""Integrators that share no code with the flow, to check the flow and to compare it with."""
