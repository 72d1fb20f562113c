"""The loops of random access on the torus compiled by numba from :mod:`integrable.torus.walks`: moving points in
double-double numbers, Fourier series in floats.

Arrays of numbers are float arrays with a last axis (hi, lo). Importing this module imports numba; compiled code is kept
on disk beside the source.
"""

from __future__ import annotations

from numba.extending import overload, register_jitable

from integrable.moving_point import compiled
from integrable.torus import clock_loops, states, tables, walks
from integrable.torus import survey as torus_survey
from jacobian.numbers.compiler import njit
from jacobian.numbers.double_double_compiled import JIT, numbers

# the double-double kernels that :mod:`integrable.moving_point.compiled` registers are what these loops call
assert compiled

for _inner in (
    torus_survey.bracket,
    torus_survey.between,
    torus_survey.oval_periods,
    torus_survey.complete,
    torus_survey.slowed,
    torus_survey.mean_slowness,
    torus_survey.reach_of,
    torus_survey.centre_of,
    torus_survey.split_by,
    torus_survey.reduced,
    torus_survey.cells,
    torus_survey.best_chart,
    torus_survey.about_centre,
    tables.direction,
    tables.recentred,
    tables.alike,
    tables.point_in,
    tables.put,
    walks.turn,
    walks.step_over,
    tables.small_translation,
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


_survey = register_jitable(torus_survey.survey)
_directions = register_jitable(tables.directions)
_corners = register_jitable(walks.corners)
_offsets = register_jitable(walks.offsets)
_sampled = register_jitable(walks.sampled)
_states_at_phases = register_jitable(states.states_at_phases)
_states_at_tau = register_jitable(states.states_at_tau)
_states_at_times = register_jitable(clock_loops.states_at_times)
_times_at_tau = register_jitable(clock_loops.times_at_tau)


@njit(**JIT)
def survey(motion, near, points, out):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.survey.survey`."""
    return _survey(numbers(motion), near, points, numbers(out))


@njit(**JIT)
def directions(motion, chart, parts, nodes, passes, series, roots, room, tables, halves):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.tables.directions`."""
    _directions(
        numbers(motion),
        chart,
        numbers(parts),
        nodes,
        passes,
        numbers(series),
        numbers(roots),
        numbers(room),
        numbers(tables),
        numbers(halves),
    )


@njit(**JIT)
def corners(f, axes, unit_axes, start, cells, forward, most, halves, steps, states, ends, known, turns):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.walks.corners`."""
    _corners(
        _six(numbers(f)),
        _eight(numbers(axes)),
        _eight(numbers(unit_axes)),
        numbers(start),
        cells,
        forward,
        most,
        numbers(halves),
        numbers(steps),
        numbers(states),
        numbers(ends),
        numbers(known),
        turns,
    )


@njit(**JIT)
def offsets(f, unit_axes, centres, tables, terms, parts, cells, finer, steps, counts):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.walks.offsets`."""
    _offsets(
        _six(numbers(f)),
        _eight(numbers(unit_axes)),
        centres,
        numbers(tables),
        terms,
        numbers(parts),
        cells,
        finer,
        numbers(steps),
        counts,
    )


@njit(**JIT)
def sampled(f, axes, states, cells, finer, odd, steps, counts, rates, others):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.walks.sampled`."""
    _sampled(
        _six(numbers(f)),
        _eight(numbers(axes)),
        numbers(states),
        cells,
        finer,
        odd,
        numbers(steps),
        counts,
        numbers(rates),
        numbers(others),
    )


@njit(**JIT)
def states_at_phases(rows, sizes, phases, out):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.states.states_at_phases`."""
    _states_at_phases(_torus(rows, sizes), phases, out)


@njit(**JIT)
def states_at_tau(rows, sizes, frequencies, tau, out):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.states.states_at_tau`; ``rows`` are the arrays of ``torus`` in order."""
    _states_at_tau(_torus(rows, sizes), _two(frequencies), tau, out)


@njit(**JIT)
def states_at_times(rows, sizes, pace, clock, modes, loud, times, tau, delays, out, room):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.clock_loops.states_at_times`."""
    p = numbers(pace)
    mean = p[0], p[1], p[2], p[3], p[4]
    _states_at_times(_torus(rows, sizes), mean, clock, modes, numbers(loud), times, tau, delays, out, room)


@njit(**JIT)
def times_at_tau(frequencies, clock, mean, tau, times, room):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus.clock_loops.times_at_tau`."""
    _times_at_tau(_two(frequencies), clock, numbers(mean)[0], tau, times, room)


@register_jitable
def _two(row):  # type: ignore[no-untyped-def]
    pair = numbers(row)
    return pair[0], pair[1]


@register_jitable
def _six(f):  # type: ignore[no-untyped-def]
    return f[0], f[1], f[2], f[3], f[4], f[5]


@register_jitable
def _eight(axes):  # type: ignore[no-untyped-def]
    return axes[0], axes[1], axes[2], axes[3], axes[4], axes[5], axes[6], axes[7]


@register_jitable
def _torus(rows, sizes):  # type: ignore[no-untyped-def]
    f, axes, matrix, states, tables, parts, centres, turns = rows
    matrix, parts = numbers(matrix), numbers(parts)
    return (
        _six(numbers(f)),
        _eight(numbers(axes)),
        (matrix[0], matrix[1], matrix[2], matrix[3]),
        numbers(states),
        numbers(tables),
        (parts[0], parts[1], parts[2], parts[3]),
        centres,
        turns,
        sizes,
    )
