"""Many motions at once: one system, many bodies and states, with the results of single flows."""
