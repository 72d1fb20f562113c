"""Many motions at once, of many bodies and states of one kind of system; single flows have the same results."""
