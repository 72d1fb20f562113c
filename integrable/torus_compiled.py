"""The loops of random access on the torus compiled by numba from :mod:`integrable.torus_kernel`: moving points in
double-double numbers, Fourier series in floats.

Arrays of numbers are float arrays with a last axis (hi, lo). Importing this module imports numba; compiled code is kept
on disk beside the source.
"""

from __future__ import annotations

from numba import njit
from numba.extending import overload, register_jitable

from integrable import flow_compiled, torus_kernel
from jacobian.double_double_compiled import JIT, numbers

# the double-double kernels that :mod:`integrable.flow_compiled` registers are what these loops call
assert flow_compiled

for _inner in (
    torus_kernel.small_translation,
    torus_kernel.walked,
    torus_kernel.whole_turns,
    torus_kernel.state_at,
    torus_kernel.turned,
    torus_kernel.delay,
):
    register_jitable(_inner)

_FLOATS = {"cache": True, "nogil": True, "error_model": "numpy", "fastmath": True}
_swing_and_rate = njit(**_FLOATS)(torus_kernel.swing_and_rate)
panel_values = njit(**{**_FLOATS, "fastmath": {"contract"}})(torus_kernel.panel_values)


@overload(torus_kernel.swing_and_rate)
def _overloaded(series, a, b, room):  # type: ignore[no-untyped-def]  # numba compares the bare signatures
    return lambda series, a, b, room: _swing_and_rate(series, a, b, room)


_direction = register_jitable(torus_kernel.direction)
_translation_by = register_jitable(torus_kernel.translation_by)
_fill = register_jitable(torus_kernel.fill)
_states_at_phases = register_jitable(torus_kernel.states_at_phases)
_states_at_tau = register_jitable(torus_kernel.states_at_tau)
_states_at_times = register_jitable(torus_kernel.states_at_times)
_times_at_tau = register_jitable(torus_kernel.times_at_tau)


@njit(**JIT)
def direction(series, roots, constants, axes, nodes, passes, slopes, table):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus_kernel.direction`, ``constants`` = (f0, reach)."""
    pair = numbers(constants)
    _direction(
        numbers(series), numbers(roots), pair[0], numbers(axes), pair[1], nodes, passes, numbers(slopes), numbers(table)
    )


@njit(**JIT)
def translation_by(f, axes, centres, tables, terms, parts, by, out):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus_kernel.translation_by`, ``by`` = (a, b)."""
    pair = numbers(by)
    _translation_by(
        numbers(f),
        numbers(axes),
        centres,
        numbers(tables),
        terms,
        numbers(parts),
        pair[0],
        pair[1],
        numbers(out),
    )


@njit(**JIT)
def fill(f, axes, start, down, across, sizes, every, states, rates, others, ends):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus_kernel.fill`."""
    _fill(
        numbers(f),
        numbers(axes),
        numbers(start),
        numbers(down),
        numbers(across),
        sizes,
        every,
        numbers(states),
        numbers(rates),
        numbers(others),
        numbers(ends),
    )


@njit(**JIT)
def states_at_phases(rows, sizes, phases, out):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus_kernel.states_at_phases`."""
    _states_at_phases(_torus(rows, sizes), phases, out)


@njit(**JIT)
def states_at_tau(rows, sizes, frequencies, tau, out):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus_kernel.states_at_tau`; ``rows`` are the arrays of ``torus`` in order."""
    _states_at_tau(_torus(rows, sizes), _two(frequencies), tau, out)


@njit(**JIT)
def states_at_times(rows, sizes, pace, clock, times, tau, delays, out, room):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus_kernel.states_at_times`."""
    p = numbers(pace)
    _states_at_times(_torus(rows, sizes), (p[0], p[1], p[2], p[3], p[4]), clock, times, tau, delays, out, room)


@njit(**JIT)
def times_at_tau(frequencies, clock, mean, tau, times, room):  # type: ignore[no-untyped-def]
    """:func:`integrable.torus_kernel.times_at_tau`."""
    _times_at_tau(_two(frequencies), clock, numbers(mean)[0], tau, times, room)


@register_jitable
def _two(row):  # type: ignore[no-untyped-def]
    pair = numbers(row)
    return pair[0], pair[1]


@register_jitable
def _torus(rows, sizes):  # type: ignore[no-untyped-def]
    f, axes, matrix, states, tables, parts, centres, turns = rows
    f, axes, matrix, parts = numbers(f), numbers(axes), numbers(matrix), numbers(parts)
    return (
        (f[0], f[1], f[2], f[3], f[4], f[5]),
        (axes[0], axes[1], axes[2], axes[3], axes[4], axes[5], axes[6], axes[7]),
        (matrix[0], matrix[1], matrix[2], matrix[3]),
        numbers(states),
        numbers(tables),
        (parts[0], parts[1], parts[2], parts[3]),
        centres,
        turns,
        sizes,
    )
