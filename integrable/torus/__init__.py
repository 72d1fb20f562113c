"""States at any time without stepping: the real torus of a motion, tables of its corners, and series of its clock."""
