"""The loops of random access on the torus compiled by numba from :mod:`integrable.torus.walks` and its neighbours:
moving points in double-double numbers, Fourier series in floats.

Arrays of numbers are float arrays with a last axis (hi, lo). Importing this module imports numba; compiled code is kept
on disk beside the source.
"""

from __future__ import annotations

from numba.extending import overload, register_jitable

from integrable.moving_point import compiled
from integrable.phase import coordinates
from integrable.torus import clock_loops, lattice, states, survey, tables, walks
from jacobian.numbers.compiler import njit
from jacobian.numbers.double_double_compiled import JIT, numbers

# the additions in double-doubles that :mod:`integrable.moving_point.compiled` registers are what these loops call
assert compiled

for _inner in (
    survey.apart,
    survey.richelot,
    survey.bracket,
    survey.between,
    survey.oval_periods,
    survey.complete,
    survey.slowed,
    survey.mean_slowness,
    survey.reach_of,
    survey.centre_of,
    survey.split_by,
    survey.reduced,
    survey.cells,
    survey.best_chart,
    survey.about_centre,
    tables.near_centre,
    tables.direction,
    tables.to_powers,
    tables.recentred,
    tables.alike,
    tables.small_translation,
    walks.turn,
    walks.step_over,
    walks.place_of,
    walks.moved,
    walks.with_signs,
    walks.rates_beside,
    coordinates.directions_of,
    states.whole_turns,
    states.state_at,
    states.turned,
    clock_loops.delay,
    clock_loops.loud_swing,
    clock_loops.on_circle,
):
    register_jitable(_inner)

_FLOATS = {"nogil": True, "error_model": "numpy", "fastmath": True}
_swing_and_rate = njit(**_FLOATS)(clock_loops.swing_and_rate)
panel_values = njit(**{**_FLOATS, "fastmath": {"contract"}})(clock_loops.panel_values)


@overload(clock_loops.swing_and_rate)
def _overloaded(series, a, b, room):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    return lambda series, a, b, room: _swing_and_rate(series, a, b, room)


_survey = register_jitable(survey.survey)
_directions = register_jitable(tables.directions)
_corners = register_jitable(walks.corners)
_offsets = register_jitable(walks.offsets)
_sampled = register_jitable(walks.sampled)
_states_at_phases = register_jitable(states.states_at_phases)
_states_at_tau = register_jitable(states.states_at_tau)
_states_at_times = register_jitable(clock_loops.states_at_times)
_times_at_tau = register_jitable(clock_loops.times_at_tau)


@njit(**JIT)
def surveyed(motion, near, points, out):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.survey.survey`."""
    return _survey(numbers(motion), near, points, numbers(out))


@njit(**JIT)
def directions(motion, chart, parts, nodes, passes, room, tables, halves):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.tables.directions`."""
    centres, reaches, basis, cells = chart
    series, roots, rest = room
    numbered = Room(numbers(series), numbers(roots), numbers(rest))
    about = Chart(centres, reaches, basis, cells)
    _directions(numbers(motion), about, numbers(parts), nodes, passes, numbered, numbers(tables), numbers(halves))


@njit(**JIT)
def corners(curve, start, walk, states, ends, known):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.walks.corners`."""
    cells, forward, most, turns, halves, steps = walk
    numbered = Walk(cells, forward, most, turns, numbers(halves), numbers(steps))
    _corners(_curve(curve), numbers(start), numbered, numbers(states), numbers(ends), numbers(known))


@njit(**JIT)
def offsets(curve, small, fine):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.walks.offsets`."""
    _offsets(_curve(curve), _small(small), _fine(fine))


@njit(**JIT)
def sampled(curve, states, fine, rates, others):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.walks.sampled`."""
    _sampled(_curve(curve), numbers(states), _fine(fine), numbers(rates), numbers(others))


@njit(**JIT)
def states_at_phases(torus, phases, out):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.states.states_at_phases`."""
    _states_at_phases(_torus(torus), phases, out)


@njit(**JIT)
def states_at_tau(torus, frequencies, tau, out):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.states.states_at_tau`."""
    _states_at_tau(_torus(torus), numbers(frequencies), tau, out)


@njit(**JIT)
def states_at_times(torus, clock, times, tau, delays, out, room):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.clock_loops.states_at_times`."""
    _states_at_times(_torus(torus), _clock(clock), times, tau, delays, out, room)


@njit(**JIT)
def times_at_tau(clock, tau, times, room):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.clock_loops.times_at_tau`."""
    _times_at_tau(_clock(clock), tau, times, room)


# --- arrays of floats as numbers, and tuples as NamedTuples: a call is 30 µs faster where it is given plain tuples

Room, SmallSteps = tables.Room, tables.SmallSteps
Curve, Walk, Fine = walks.Curve, walks.Walk, walks.Fine
Torus, Clock, Series, Chart = states.Torus, clock_loops.Clock, clock_loops.Series, lattice.Chart


@register_jitable
def _four(row):  # type: ignore[no-untyped-def]
    return row[0], row[1], row[2], row[3]


@register_jitable
def _six(row):  # type: ignore[no-untyped-def]
    return row[0], row[1], row[2], row[3], row[4], row[5]


@register_jitable
def _eight(row):  # type: ignore[no-untyped-def]
    return row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7]


@register_jitable
def _curve(curve):  # type: ignore[no-untyped-def]
    f, axes, unit_axes = curve
    return Curve(_six(numbers(f)), _eight(numbers(axes)), _eight(numbers(unit_axes)))


@register_jitable
def _small(small):  # type: ignore[no-untyped-def]
    axes, centres, tables, terms, parts = small
    return SmallSteps(_eight(numbers(axes)), centres, numbers(tables), terms, _four(numbers(parts)))


@register_jitable
def _fine(fine):  # type: ignore[no-untyped-def]
    cells, finer, odd, steps, counts = fine
    return Fine(cells, finer, odd, numbers(steps), counts)


@register_jitable
def _torus(torus):  # type: ignore[no-untyped-def]
    curve, matrix, states, small, turns, cells = torus
    return Torus(_curve(curve), _four(numbers(matrix)), numbers(states), _small(small), turns, cells)


@register_jitable
def _series(series):  # type: ignore[no-untyped-def]
    lines, real, imaginary, slope_real, slope_imaginary, least, width, frequencies, bound, origin, mean = series
    return Series(lines, real, imaginary, slope_real, slope_imaginary, least, width, frequencies, bound, origin, mean)


@register_jitable
def _clock(clock):  # type: ignore[no-untyped-def]
    doubled, rough, series, quiet, modes, loud, pace = clock
    parts = _series(rough), _series(series), _series(quiet)
    return Clock(doubled, parts[0], parts[1], parts[2], modes, numbers(loud), _six(numbers(pace)))
