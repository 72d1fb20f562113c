"""The loops of random access on the torus, compiled from :mod:`integrable.torus.states` and other modules of this room.
They use double-doubles for theta functions, and floats for most modes of Fourier series.

Arrays of double-doubles are float arrays with a last axis (hi, lo).
"""

from __future__ import annotations

from typing import Any

from integrable.moving_point.compiled import SPECIAL
from integrable.torus import clock_loops, clock_modes, lattice, lifts, states, theta_series, theta_setup
from integrable.torus.clock_loops import Clock, ClockRoom, ClockSeries
from integrable.torus.clock_modes import Cutoffs, Tables
from integrable.torus.lifts import Limits, RateSums, Torus
from integrable.torus.states import BodyStates
from integrable.torus.theta_series import ThetaSums
from jacobian.native.kinds import BOOL, FLOAT, FLOATS, INT, INTS, WIDES, ArrayKind, TupleKind, record
from jacobian.native.library import Library

_INTS, _FLOATS, _THREE = TupleKind((INT, INT)), TupleKind((FLOAT, FLOAT)), TupleKind((INT, INT, INT))
_SERIES = record(ClockSeries, INTS, FLOATS, INT, _FLOATS, FLOAT, FLOAT, FLOAT)
SUMS = record(ThetaSums, WIDES, _THREE, INTS, INTS, WIDES)
TORUS = record(Torus, SUMS, WIDES, WIDES)
KINDS: dict[type[tuple[object, ...]], TupleKind] = {
    kind.named: kind
    for kind in (
        TORUS,
        record(BodyStates, TORUS, WIDES),
        record(RateSums, INT, INT, BOOL, BOOL, WIDES),
        record(Tables, FLOATS, INTS, FLOATS, INTS, FLOATS, FLOATS, INTS, INTS),
        record(Clock, _INTS, _SERIES, _SERIES, _SERIES, INTS, WIDES, WIDES, WIDES, FLOATS),
    )
}
"""The compiled type of each NamedTuple of arrays."""


_BODY, _RATE, _CLOCK, _LIMITS = KINDS[BodyStates], KINDS[RateSums], KINDS[Clock], record(Limits, FLOAT, FLOAT, FLOAT)
_ROOM = record(ClockRoom, *(FLOATS,) * 5, WIDES)
_PANELS, _ROWS, _PHASES = ArrayKind(FLOAT, 3), ArrayKind(FLOAT, 2), TupleKind((WIDES, FLOATS, FLOATS))
LOOPS: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "begun": (lattice.begun_rows, (WIDES, BOOL, WIDES, WIDES, WIDES)),
    "periods": (theta_setup.torus_periods, (WIDES, FLOAT, WIDES, WIDES)),
    "rates": (theta_setup.surveyed_rates, (*(WIDES,) * 4, _FLOATS, *(WIDES,) * 3)),
    "placed": (theta_setup.placed, (TORUS, WIDES, WIDES, WIDES, WIDES, FLOATS, _LIMITS, WIDES)),
    "met": (lifts.met, (TORUS, WIDES, WIDES, _LIMITS, WIDES)),
    "theta_weights": (theta_series.theta_weights, (WIDES, _THREE, _INTS, FLOAT, SUMS, WIDES)),
    "circle_points": (theta_series.circle_points, (FLOATS, WIDES, WIDES, WIDES)),
    "gridded": (lifts.gridded, (TORUS, _RATE, _INTS, _INTS, WIDES, WIDES, WIDES)),
    "strayed": (states.strayed, (_BODY, WIDES, WIDES, WIDES, FLOATS)),
    "states_at_phases": (states.states_at, (_BODY, WIDES, FLOATS)),
    "phases_at": (states.phases_at, (WIDES, FLOATS, WIDES)),
    "phases_at_times": (clock_loops.phases_at_times, (_CLOCK, FLOATS, _PHASES, _ROOM)),
    "times_at_tau": (clock_loops.times_at_tau, (_CLOCK, FLOATS, FLOATS)),
    "spectrum": (clock_modes.spectrum_of_samples, (WIDES, _INTS, _FLOATS, WIDES, TupleKind((WIDES,) * 3), FLOATS)),
    "clock_series": (
        clock_modes.clock_series,
        (WIDES, _INTS, TupleKind((WIDES, _INTS)), record(Cutoffs, *(FLOAT,) * 5), KINDS[Tables], WIDES, WIDES),
    ),
    "panel_values": (clock_loops.panel_values, (FLOATS, FLOATS, _PANELS, FLOATS, _ROWS, _ROWS)),
}
"""The loops by name, with the compiled types of their arguments."""
LIBRARY = Library("torus", LOOPS, SPECIAL, fast=(clock_loops.swing_and_rate,))
