"""The loops of random access on the torus compiled from :mod:`integrable.torus.states` and other modules of this room:
theta functions in double-double numbers, Fourier series in floats.

Arrays of numbers are float arrays with a last axis (hi, lo).
"""

from __future__ import annotations

from integrable.moving_point.compiled import SPECIAL
from integrable.torus import clock_loops, clock_modes, lattice, states, theta_series, theta_setup
from integrable.torus.clock_loops import Clock, ClockSeries
from integrable.torus.clock_modes import Cutoffs, Tables
from integrable.torus.states import Torus
from integrable.torus.theta_series import ThetaSums
from integrable.torus.theta_setup import Limits
from jacobian.native.kinds import BOOL, FLOAT, FLOATS, INT, INTS, WIDES, ArrayKind, TupleKind, record
from jacobian.native.library import Library

_INTS, _FLOATS, _THREE = TupleKind((INT, INT)), TupleKind((FLOAT, FLOAT)), TupleKind((INT, INT, INT))
_SERIES = record(ClockSeries, INTS, FLOATS, INT, INT, _FLOATS, FLOAT, FLOAT, FLOAT)
SUMS = record(ThetaSums, WIDES, _THREE, INTS, INTS, WIDES)
KINDS: dict[type[tuple[object, ...]], TupleKind] = {
    kind.named: kind
    for kind in (
        record(Torus, SUMS, WIDES),
        record(Tables, FLOATS, INTS, FLOATS, INTS, FLOATS, FLOATS, INTS, INTS),
        record(Clock, _INTS, _SERIES, _SERIES, _SERIES, INTS, WIDES, WIDES),
    )
}
"""The compiled type of each NamedTuple of arrays."""


_TORUS, _CLOCK = KINDS[Torus], KINDS[Clock]
_PANELS, _ROWS = ArrayKind(FLOAT, 3), ArrayKind(FLOAT, 2)
LIBRARY = Library(
    "torus",
    {
        "begun": (lattice.begun_rows, (WIDES, BOOL, WIDES, WIDES, WIDES)),
        "periods": (theta_setup.torus_periods, (WIDES, FLOAT, WIDES, WIDES)),
        "rates": (theta_setup.surveyed_rates, (WIDES, WIDES, WIDES, _FLOATS, _INTS, WIDES)),
        "placed": (
            theta_setup.placed,
            (_TORUS, WIDES, WIDES, WIDES, WIDES, FLOATS, record(Limits, FLOAT, FLOAT, FLOAT), WIDES),
        ),
        "theta_weights": (
            theta_series.theta_weights,
            (WIDES, _THREE, _INTS, FLOAT, SUMS, WIDES),
        ),
        "gridded": (states.gridded, (_TORUS, _INTS, _INTS, WIDES, WIDES, WIDES)),
        "strayed": (states.strayed, (_TORUS, WIDES, WIDES, FLOATS)),
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
