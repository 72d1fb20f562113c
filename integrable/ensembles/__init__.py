"""Many motions at once, of many bodies and states of one kind of system; the flows of single members have the same
results.
"""
