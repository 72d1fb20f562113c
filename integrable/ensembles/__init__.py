"""Many motions at once, of many bodies and states of one kind of system; the flow of each member has the same
results.
"""
