"""Loops of Python made machine code: the few statements and kinds of numbers that loops on bare reals consist of."""
