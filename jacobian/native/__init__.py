"""A small compiler for numeric Python loops. It knows the few statements and kinds of numbers that they need."""
