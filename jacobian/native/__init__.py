"""A small compiler for numeric Python loops: the few statements and kinds of numbers that loops on bare reals need."""
