"""The loops of random access on the torus compiled from :mod:`integrable.torus.walks` and other modules of this room:
moving points in double-double numbers, Fourier series in floats.

Arrays of numbers are float arrays with a last axis (hi, lo).
"""

from __future__ import annotations

from integrable.moving_point.compiled import SPECIAL
from integrable.torus import clock_loops, clock_modes, lattice, states, survey, tables, walks, witness
from integrable.torus.clock_loops import Clock, ClockSeries
from integrable.torus.clock_modes import Cutoffs, Tables
from integrable.torus.lattice import Chart
from integrable.torus.states import Torus
from integrable.torus.tables import SmallSteps, TableRoom
from integrable.torus.walks import Curve, Fine, Walk
from integrable.torus.witness import Line
from jacobian.native.kinds import BOOL, FLOAT, FLOATS, INT, INTS, WIDES, ArrayKind, TupleKind, record
from jacobian.native.library import Library

_FLAGS, _INTS, _FLOATS = TupleKind((BOOL, BOOL)), TupleKind((INT, INT)), TupleKind((FLOAT, FLOAT))
_SIGNS = TupleKind((FLOAT,) * 6)
_CURVE = record(Curve, WIDES, WIDES, WIDES)
_SMALL = record(SmallSteps, WIDES, _FLOATS, WIDES, INT, WIDES)
_SERIES = record(ClockSeries, INTS, FLOATS, INT, INT, _FLOATS, FLOAT, FLOAT, FLOAT)
KINDS: dict[type[tuple[object, ...]], TupleKind] = {
    kind.named: kind
    for kind in (
        _CURVE,
        _SMALL,
        record(Chart, _FLOATS, _FLOATS, TupleKind((_INTS, _INTS)), _INTS),
        record(TableRoom, WIDES, WIDES, WIDES, WIDES),
        record(Line, _CURVE, WIDES, WIDES, WIDES, _FLOATS, BOOL),
        record(Walk, _INTS, INT, INT, _SIGNS, WIDES, WIDES),
        record(Fine, _INTS, _INTS, _FLAGS, WIDES, INTS, _INTS, WIDES),
        record(Torus, _CURVE, WIDES, WIDES, _SMALL, _SIGNS, _INTS),
        record(Tables, FLOATS, INTS, FLOATS, INTS, FLOATS, FLOATS, INTS, INTS),
        record(Clock, _INTS, _SERIES, _SERIES, _SERIES, INTS, WIDES, WIDES),
    )
}
"""The compiled type of each NamedTuple of arrays."""


_TORUS, _CLOCK, _WALK, _FINE = KINDS[Torus], KINDS[Clock], KINDS[Walk], KINDS[Fine]
_PANELS, _ROWS = ArrayKind(FLOAT, 3), ArrayKind(FLOAT, 2)
LIBRARY = Library(
    "torus",
    {
        "begun": (lattice.begun_rows, (WIDES, BOOL, WIDES, WIDES, WIDES)),
        "reached": (witness.reached, (KINDS[Line], FLOATS, KINDS[TableRoom], WIDES, FLOATS)),
        "departure": (witness.departure, (_TORUS, KINDS[Line], FLOATS, KINDS[TableRoom], WIDES, FLOATS)),
        "seam": (witness.seam, (_TORUS, FLOATS)),
        "rates": (survey.surveyed_rates, (WIDES, WIDES, WIDES, _FLOATS, _INTS, WIDES)),
        "about_centre": (survey.about_centre, (WIDES, FLOAT, FLOAT, WIDES)),
        "survey": (survey.survey, (WIDES, FLOAT, FLOATS, WIDES)),
        "directions": (
            tables.directions,
            (WIDES, KINDS[Chart], WIDES, FLOATS, INT, KINDS[TableRoom], WIDES, WIDES),
        ),
        "corners": (walks.corners, (_CURVE, WIDES, _WALK, WIDES, WIDES, WIDES)),
        "gridded": (walks.gridded, (_CURVE, _SMALL, WIDES, _FINE, WIDES, WIDES)),
        "sampled": (walks.sampled, (_CURVE, WIDES, _FINE, WIDES, WIDES)),
        "states_at_phases": (states.states_at_phases, (_TORUS, FLOATS, FLOATS)),
        "states_at_tau": (states.states_at_tau, (_TORUS, WIDES, FLOATS, FLOATS)),
        "states_at_times": (
            clock_loops.states_at_times,
            (_TORUS, _CLOCK, FLOATS, TupleKind((FLOATS, FLOATS, FLOATS)), TupleKind((FLOATS, WIDES, INTS))),
        ),
        "phases_at_times": (clock_loops.phases_at_times, (_CLOCK, FLOATS, WIDES, FLOATS, FLOATS)),
        "times_at_tau": (clock_loops.times_at_tau, (_CLOCK, FLOATS, FLOATS, FLOATS)),
        "spectrum": (clock_modes.spectrum_of_samples, (WIDES, _INTS, _FLOATS, WIDES, TupleKind((WIDES,) * 3), FLOATS)),
        "clock_series": (
            clock_modes.clock_series,
            (WIDES, _INTS, WIDES, record(Cutoffs, *(FLOAT,) * 5), KINDS[Tables], WIDES),
        ),
        "panel_values": (clock_loops.panel_values, (FLOATS, FLOATS, _PANELS, FLOATS, _ROWS, _ROWS)),
    },
    SPECIAL,
    fast=(clock_loops.swing_and_rate,),
)
