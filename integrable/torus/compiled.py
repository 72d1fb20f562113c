"""The loops of random access on the torus compiled from :mod:`integrable.torus.walks` and its neighbours: moving points
in double-double numbers, Fourier series in floats.

Arrays of numbers are float arrays with a last axis (hi, lo).
"""

from __future__ import annotations

from typing import Any

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

Row = Any

_FLAGS, _INTS, _FLOATS = TupleKind((BOOL, BOOL)), TupleKind((INT, INT)), TupleKind((FLOAT, FLOAT))
_SIGNS = TupleKind((FLOAT,) * 6)
_CURVE = record(Curve, WIDES, WIDES, WIDES)
_SMALL = record(SmallSteps, WIDES, _FLOATS, WIDES, INT, WIDES)
_SERIES = record(ClockSeries, INTS, FLOATS, INT, INT, _FLOATS, FLOAT, FLOAT, FLOAT)
KINDS: dict[Any, TupleKind] = {
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


# --- entries: they convert rows of numbers to the tuples that the loops take


def _corners(curve: Curve, start: Row, walk: Walk, states: Row, ends: Row, known: Row) -> float:
    """:func:`integrable.torus.walks.corners`."""
    return walks_corners(numbered(curve), start, walk, states, ends, known)


def _gridded(curve: Curve, small: SmallSteps, states: Row, fine: Fine, rates: Row, others: Row) -> None:
    """:func:`integrable.torus.walks.gridded`."""
    walks_gridded(numbered(curve), small_numbered(small), states, fine, rates, others)


def _sampled(curve: Curve, states: Row, fine: Fine, rates: Row, others: Row) -> None:
    """:func:`integrable.torus.walks.sampled`."""
    walks_sampled(numbered(curve), states, fine, rates, others)


def _states_at_phases(torus: Torus, phases: Row, out: Row) -> None:
    """:func:`integrable.torus.states.states_at_phases`."""
    at_phases(torus_numbered(torus), phases, out)


def _states_at_tau(torus: Torus, frequencies: Row, tau: Row, out: Row) -> None:
    """:func:`integrable.torus.states.states_at_tau`."""
    at_tau(torus_numbered(torus), frequencies, tau, out)


def _reached(line: Line, times: Row, room: TableRoom, points: Row, out: Row) -> None:
    """:func:`integrable.torus.witness.reached`."""
    numbers = Line(numbered(line.curve), line.start, line.motion, line.rates, line.centres, line.far)
    torus_reached(numbers, times, room, points, out)


def _departure(torus: Torus, line: Line, times: Row, room: TableRoom, points: Row, out: Row) -> float:
    """:func:`integrable.torus.witness.departure`."""
    numbers = Line(numbered(line.curve), line.start, line.motion, line.rates, line.centres, line.far)
    return torus_departure(torus_numbered(torus), numbers, times, room, points, out)


def _seam(torus: Torus, out: Row) -> float:
    """:func:`integrable.torus.witness.seam`."""
    return torus_seam(torus_numbered(torus), out)


def _points_at_phases(torus: Torus, root_beyond: Row, phases: Row, out: Row) -> None:
    """:func:`integrable.torus.states.points_at_phases`."""
    points_at(torus_numbered(torus), root_beyond, phases, out)


def _states_at_times(torus: Torus, clock: Clock, times: Row, found: Row, room: Row) -> None:
    """:func:`integrable.torus.clock_loops.states_at_times`."""
    at_times(torus_numbered(torus), clock_numbered(clock), times, found, room)


def _phases_at_times(clock: Clock, times: Row, phases: Row, delays: Row, room: Row) -> None:
    """:func:`integrable.torus.clock_loops.phases_at_times`."""
    phases_at(clock_numbered(clock), times, phases, delays, room)


def _times_at_tau(clock: Clock, tau: Row, times: Row, room: Row) -> None:
    """:func:`integrable.torus.clock_loops.times_at_tau`."""
    times_at(clock_numbered(clock), tau, times, room)


def numbered(curve: Curve) -> Curve:
    """With tuples for rows."""
    return Curve(six(curve.f), eight(curve.axes), eight(curve.unit_axes))


def small_numbered(small: SmallSteps) -> SmallSteps:
    """With tuples for rows."""
    return SmallSteps(eight(small.axes), small.centres, small.tables, small.terms, four(small.parts))


def torus_numbered(torus: Torus) -> Torus:
    """With tuples for rows."""
    small = small_numbered(torus.small)
    return Torus(numbered(torus.curve), four(torus.matrix), torus.states, small, torus.turns, torus.cells)


def clock_numbered(clock: Clock) -> Clock:
    """With tuples for rows."""
    return Clock(clock.doubled, clock.rough, clock.series, clock.quiet, clock.modes, clock.loud, six(clock.pace))


def four(row: Row) -> Any:
    """The first numbers of a row."""
    return row[0], row[1], row[2], row[3]


def six(row: Row) -> Any:
    """The first numbers of a row."""
    return row[0], row[1], row[2], row[3], row[4], row[5]


def eight(row: Row) -> Any:
    """The first numbers of a row."""
    return row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7]


walks_corners, walks_gridded, walks_sampled = walks.corners, walks.gridded, walks.sampled
at_phases, at_tau = states.states_at_phases, states.states_at_tau
points_at, torus_reached = states.points_at_phases, witness.reached
torus_departure, torus_seam = witness.departure, witness.seam
at_times, times_at = clock_loops.states_at_times, clock_loops.times_at_tau
phases_at = clock_loops.phases_at_times

_TORUS, _CLOCK, _WALK, _FINE = KINDS[Torus], KINDS[Clock], KINDS[Walk], KINDS[Fine]
_PANELS, _ROWS = ArrayKind(FLOAT, 3), ArrayKind(FLOAT, 2)
LIBRARY = Library(
    "torus",
    {
        "begun": (lattice.begun_rows, (WIDES, BOOL, WIDES, WIDES, FLOATS, WIDES)),
        "reached": (_reached, (KINDS[Line], FLOATS, KINDS[TableRoom], WIDES, FLOATS)),
        "departure": (_departure, (_TORUS, KINDS[Line], FLOATS, KINDS[TableRoom], WIDES, FLOATS)),
        "seam": (_seam, (_TORUS, FLOATS)),
        "rates": (survey.surveyed_rates, (WIDES, WIDES, WIDES, _FLOATS, _INTS, WIDES)),
        "about_centre": (survey.about_centre, (WIDES, FLOAT, FLOAT, WIDES)),
        "survey": (survey.survey, (WIDES, FLOAT, FLOATS, WIDES)),
        "mean_height": (survey.mean_height, (WIDES, WIDES, WIDES)),
        "directions": (
            tables.directions,
            (WIDES, KINDS[Chart], WIDES, FLOATS, INT, KINDS[TableRoom], WIDES, WIDES),
        ),
        "corners": (_corners, (_CURVE, WIDES, _WALK, WIDES, WIDES, WIDES)),
        "gridded": (_gridded, (_CURVE, _SMALL, WIDES, _FINE, WIDES, WIDES)),
        "sampled": (_sampled, (_CURVE, WIDES, _FINE, WIDES, WIDES)),
        "states_at_phases": (_states_at_phases, (_TORUS, FLOATS, FLOATS)),
        "states_at_tau": (_states_at_tau, (_TORUS, WIDES, FLOATS, FLOATS)),
        "points_at_phases": (_points_at_phases, (_TORUS, WIDES, WIDES, WIDES)),
        "states_at_times": (
            _states_at_times,
            (_TORUS, _CLOCK, FLOATS, TupleKind((FLOATS, FLOATS, FLOATS)), TupleKind((FLOATS, WIDES, INTS))),
        ),
        "phases_at_times": (_phases_at_times, (_CLOCK, FLOATS, WIDES, FLOATS, FLOATS)),
        "times_at_tau": (_times_at_tau, (_CLOCK, FLOATS, FLOATS, FLOATS)),
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
