"""Short runs compiled by numba from :mod:`integrable.moving_point.short`, wide numbers being double-doubles: one entry.

Importing this module imports numba; compiled code is kept on disk beside the source.
"""

from __future__ import annotations

import numpy as np
from numba import njit as plain_njit
from numba.extending import overload, register_jitable

from integrable.moving_point import compiled, short, short_reading, short_rows, short_start, short_steps
from jacobian.inexact.compiled import JIT
from jacobian.numbers import double_double_compiled as double_double
from jacobian.numbers.compiler import njit
from jacobian.numbers.double_double_compiled import numbers

# the kernels that it registers are what these loops call
assert compiled

for _inner in (
    short_start.transformation,
    short_start.curve,
    short_start.made_upright,
    short_start.moving_start,
    short_rows.curve_of,
    short_rows.axes_of,
    short_rows.unit_axes,
    short.centre_of,
    short_steps.node_steps,
    short_steps.node_values,
    short_steps.gamma_and_w,
    short_start.growth,
    short.too_far,
    short.both_ways,
    short.one_way,
    short.panel,
    short.piece,
    short.fill_wide_nodes,
    short.tails,
    short.two_ends,
    short.stepless,
    short_reading.read_off,
    short_reading.antiderivative,
    short_reading.place_of,
    short_reading.clenshaw,
    short_reading.interpolated,
    short_reading.state,
    short_reading.drift,
    short_reading.invariants,
):
    register_jitable(_inner)

# in a library of their own: an optimizer that contracts sums would take the error terms for zero
_set_up, _scaled, _panel_steps, _doubled, _moved, _wide_node_steps, _wide_values = (
    plain_njit(**double_double.JIT)(function)
    for function in (
        short_start.set_up,
        short_start.scaled,
        short_steps.panel_steps,
        short_steps.doubled,
        short_steps.moved,
        short_steps.wide_node_steps,
        short_steps.wide_values,
    )
)


@overload(short_start.set_up)
def _to_set_up(given, tilted, wide, points, known, point):  # type: ignore[no-untyped-def]
    return lambda given, tilted, wide, points, known, point: _set_up(
        numbers(given), tilted, numbers(wide), numbers(points), known, point
    )


@overload(short_start.scaled)
def _to_scaled(times, wide, unit, high, low):  # type: ignore[no-untyped-def]
    return lambda times, wide, unit, high, low: _scaled(times, numbers(wide), unit, high, low)


@overload(short_steps.panel_steps)
def _to_panel_steps(wide, h, series, roots, passes, steps):  # type: ignore[no-untyped-def]
    return lambda wide, h, series, roots, passes, steps: _panel_steps(
        numbers(wide), h, numbers(series), numbers(roots), passes, numbers(steps)
    )


@overload(short_steps.doubled)
def _to_doubled(wide, steps, place):  # type: ignore[no-untyped-def]
    return lambda wide, steps, place: _doubled(numbers(wide), numbers(steps), place)


@overload(short_steps.moved)
def _to_moved(wide, points, origin, steps, place, sign, target, point):  # type: ignore[no-untyped-def]
    return lambda wide, points, origin, steps, place, sign, target, point: _moved(
        numbers(wide), numbers(points), origin, numbers(steps), place, sign, target, point
    )


@overload(short_steps.wide_node_steps)
def _to_wide_node_steps(wide, h, nodes, series, roots, passes, out):  # type: ignore[no-untyped-def]
    return lambda wide, h, nodes, series, roots, passes, out: _wide_node_steps(
        numbers(wide), h, nodes, numbers(series), numbers(roots), passes, numbers(out)
    )


@overload(short_steps.wide_values)
def _to_wide_values(wide, points, origin, steps, place, mirrored, values, rates):  # type: ignore[no-untyped-def]
    return lambda wide, points, origin, steps, place, mirrored, values, rates: _wide_values(
        numbers(wide), numbers(points), origin, numbers(steps), place, mirrored, values, rates
    )


_short_run = register_jitable(short.short_run)
_new_room = register_jitable(short_rows.new_room)
_Request, _CLOCK, _PHYSICAL = short_rows.Request, short_rows.CLOCK, short_rows.PHYSICAL


@register_jitable
def _wide(count):  # type: ignore[no-untyped-def]
    return np.zeros((count, 2))


@register_jitable
def _floats(count):  # type: ignore[no-untyped-def]
    return np.zeros(count)


@njit(**JIT)
def short_runs(given, tilted, rule, physical, clock, most, drift, times, order, out, other, status, panels):  # type: ignore[no-untyped-def]
    """:func:`integrable.moving_point.short.short_run` for every row of ``given``, of shape (K, 10): into ``out`` and
    ``other``, (K, 6N) and (K, N), ``status`` and what the runs have cost in panels, (K,). ``times`` and ``order`` have
    a row for each, or one for all.
    """
    count = times.shape[1]
    for member in range(len(given)):
        at = member % len(times)
        wide = _wide(given.shape[1])
        for i in range(given.shape[1]):
            wide[i, 0] = given[member, i]
        room = _new_room(_wide, _floats, np.array([1, 0, 1, 0]))
        request = _Request(
            physical, clock, most, drift, times[at], order[at], _floats(count), _floats(count), out[member],
            other[member],
        )  # fmt: skip
        status[member] = _short_run(room, rule, request, wide, tilted)
        panels[member] = room.made[3]
        # without a clock there is nothing in ``other``
        if physical or clock:
            unit = room.numbers[_CLOCK if physical else _PHYSICAL]
            for i in range(count):
                other[member, i] /= unit
