"""Any time at once: the real torus of a motion, its tables and walks, and series of its clock."""
