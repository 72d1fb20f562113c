"""States at any time without stepping: the real torus of a motion, its theta functions, and series of its clock."""
