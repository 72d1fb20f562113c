"""Any time at once: the real torus of a motion, tables of its corners, and series of its clock."""
