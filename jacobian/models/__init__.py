"""The same curve by other equations, and what all its equations have in common."""
