"""Many motions of one kind of system, with different bodies or starts, computed together. The states are those of
each member's own flow, up to the errors that the classes state.
"""
