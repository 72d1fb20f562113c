"""Other equations of a curve: isomorphisms, isogenies, special models, and invariants."""
