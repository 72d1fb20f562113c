"""The loops of :mod:`integrable.series.short` compiled, wide numbers being double-doubles."""

from __future__ import annotations

from integrable.series.short import Room, Steps, Way, walked_twice
from jacobian.native.kinds import FLOAT, FLOATS, INT, INTS, TWIN_FLOATS, TWIN_WIDES, WIDES, TupleKind, record
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL

WAY = record(Way, TupleKind((INTS, INTS, INTS, INTS)), INT, FLOAT, TWIN_WIDES)
STEPS = record(Steps, INT, INT, FLOAT, FLOAT, FLOAT)
ROOM = record(Room, TWIN_WIDES, TWIN_WIDES, TWIN_FLOATS, TWIN_WIDES, TWIN_WIDES, FLOATS, FLOATS, WIDES, FLOATS)
LIBRARY = Library(
    "short_series",
    {"walked_twice": (walked_twice, (WAY, STEPS, ROOM, FLOATS, FLOATS, FLOATS))},
    SPECIAL,
)
