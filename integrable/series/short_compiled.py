"""The loops of :mod:`integrable.series.short` compiled, wide numbers being double-doubles."""

from __future__ import annotations

from integrable.series.short import Room, Steps, Way, walked_twice
from jacobian.native.kinds import FLOAT, FLOATS, INT, INTS, WIDES, TupleKind, record
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL

WAY = record(Way, TupleKind((INTS, INTS, INTS, INTS)), INT, FLOAT, WIDES, WIDES)
STEPS, ROOM = record(Steps, INT, INT, FLOAT), record(Room, WIDES, WIDES, FLOATS, WIDES)
LIBRARY = Library(
    "short_series",
    {"walked_twice": (walked_twice, (WAY, STEPS, STEPS, ROOM, FLOATS, WIDES, WIDES))},
    SPECIAL,
)
