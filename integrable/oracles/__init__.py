"""Integrators that share no code with the flow, for checks of the flow and for comparisons with it."""
