"""Integrators that share no code with the flow: what it is checked against and compared with."""
