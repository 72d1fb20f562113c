"""The loops of :mod:`integrable.deformations.series` compiled for double-double numbers."""

from __future__ import annotations

from integrable.deformations import series
from jacobian.native.kinds import INT, INTS, WIDES
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL

LIBRARY = Library(
    "taylor_series",
    {
        "coefficients": (series.coefficients, (INTS, INTS, INTS, INTS, INT, WIDES)),
        "values_at": (series.values_at, (WIDES, INT, WIDES, WIDES)),
    },
    SPECIAL,
)
