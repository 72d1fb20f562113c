"""The same curve by other equations, and the invariants of all of them."""
