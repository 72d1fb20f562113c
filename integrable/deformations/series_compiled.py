"""The loops of :mod:`integrable.deformations.series`, compiled for double-doubles."""

from __future__ import annotations

from integrable.deformations import series
from jacobian.native.kinds import BOOL, FLOAT, FLOATS, INT, INTS, WIDES, TupleKind, record
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL

_TAPE, _ROOM = TupleKind((INTS, INTS, INTS, INTS)), record(series.SeriesRoom, WIDES, WIDES, WIDES, FLOATS)
LIBRARY = Library(
    "taylor_series",
    {
        "evaluated": (series.evaluated, (_TAPE, WIDES, WIDES, WIDES, WIDES)),
        "march": (series.march_along, (_TAPE, INT, FLOAT, FLOAT, BOOL, _ROOM, WIDES, WIDES)),
    },
    SPECIAL,
)
