"""Loops for states at physical times on a torus: the clock's series, and panels. They run on bare reals, compiled or
interpreted.
"""

from __future__ import annotations

from math import cos, pi, sin
from typing import NamedTuple

from integrable.moving_point.addition import Real, Row
from integrable.torus.states import BodyStates, states_at, whole_turns
from integrable.torus.theta_series import circle

# Newton's method with the slope at its first point multiplies an error by about the length of the first step, in turns.
# It ends when the product of the lengths of the first and of the last step is at most LAST_STEPS
LAST_STEPS = 1e-18


class ClockSeries(NamedTuple):
    """A real Fourier series S on the torus that vanishes at the start, and dS/dτ. Its modes are pairs (k, m).

    ``lines`` has three numbers for each k = 0, 1, …: its first m, counted from ``least``, and where its coefficients
    begin and end. For k > 0 coefficients are doubled, to account for −k. ``parts`` are the real parts of all
    coefficients of S, then the imaginary parts, then both for dS/dτ. ``least`` is the least m, ``width`` the number of
    m, ``bound`` a bound of |S|. S is ``origin`` plus the modes. ``mean`` is the mean rate of τ + S, 1 up to rounding.
    """

    lines: Row
    parts: Row
    least: int
    width: int
    frequencies: tuple[float, float]
    bound: float
    origin: float
    mean: float


class Clock(NamedTuple):
    """The relation between t and τ on one motion: t = (τ + S)·(mean dt/dτ), with S of :class:`ClockSeries`.

    ``doubled`` are the periods of 1/g, in turns of the phases. Of the modes of S, the series ``rough`` has the larger
    ones, ``series`` all, and ``quiet`` all but the largest. The pairs (k, m) of the largest are ``modes``; ``loud`` has
    a constant, and the real and imaginary parts of their coefficients. ``pace`` has mean rates: the turns of each phase
    per unit of t, then per unit of τ, then dτ/dt and dt/dτ. ``inverse`` is the result
    of :func:`integrable.torus.theta_series.circle_numbers`.
    """

    doubled: tuple[int, int]
    rough: ClockSeries
    series: ClockSeries
    quiet: ClockSeries
    modes: Row
    loud: Row
    pace: Row
    inverse: Row


def states_at_times(
    body: BodyStates, clock: Clock, times: Row, found: tuple[Row, Row, Row], room: tuple[Row, Row]
) -> None:
    """Writes three arrays for physical times t into ``found``: τ; τ − t·(mean dτ/dt); γ and M, six floats for each t.

    ``room`` is memory for powers, and for two phases at each time.
    """
    (tau, delays, out), (powers, phases) = found, room
    phases_at_times(clock, times, (phases, tau, delays), powers)
    states_at(body, phases, out)


def phases_at_times(clock: Clock, times: Row, found: tuple[Row, Row, Row], room: Row) -> None:
    """Writes into ``found`` the phases at physical times t (in turns, modulo 2, one pair after the other), τ, and
    τ − t·(mean dτ/dt).
    """
    phases, tau, delays = found
    for i in range(len(times)):
        first, second, x = phases_at_time(clock, times[i], room)
        phases[2 * i], phases[2 * i + 1] = first, second
        tau[i], delays[i] = float(clock.pace[4] * times[i] + x), float(x)


def phases_at_time(clock: Clock, time: Real, room: Row) -> tuple[Real, Real, Real]:
    """Both phases at a physical time t, in turns, modulo 2, and x = τ − t·(mean dτ/dt).

    With S of :class:`ClockSeries`, x solves x + S = 0 at the phases (a + ν₁x, b + ν₂x), where (a, b) are the phases at
    the mean value of τ. x is found first with the larger modes of S, then with all modes in floats, and corrected where
    floats are not enough.
    """
    pace = clock.pace
    pace1, pace2, nu1, nu2 = pace[0], pace[1], pace[2], pace[3]
    (double1, double2), modes = clock.doubled, clock.modes
    first, turn1 = whole_turns(pace1 * time)
    second, turn2 = whole_turns(pace2 * time)
    a, b = (float(first) + turn1 % double1) / double1, (float(second) + turn2 % double2) / double2
    start, _ = solved(clock.rough, a, b, 0.0, 1e-5, room)
    start, rate = solved(clock.series, a, b, start, 1e-9, room)
    x = 0 * nu1 + start
    if len(modes) > 0:
        # near a resonance a few modes are so large that their rounding in floats changes x by a large part of a turn
        first_size = 0.0
        for _ in range(8):
            p, q = (first + turn1 % double1 + nu1 * x) / double1, (second + turn2 % double2 + nu2 * x) / double2
            rest, _ = swing_and_rate(clock.quiet, float(p), float(q), room)
            step = (loud_swing(clock, p, q) + x + rest) / rate
            x -= step
            size = abs(float(step)) * (abs(float(nu1)) + abs(float(nu2)))
            first_size = max(first_size, size)
            if first_size * size <= LAST_STEPS:
                break
    first, more1 = whole_turns(first + nu1 * x)
    second, more2 = whole_turns(second + nu2 * x)
    return first + (turn1 + more1) % 2, second + (turn2 + more2) % 2, x


def times_at_tau(clock: Clock, tau: Row, times: Row, room: Row) -> None:
    """Writes the physical times at the times ``tau`` of the flow."""
    (double1, double2), nu1, nu2, mean = clock.doubled, clock.pace[2], clock.pace[3], clock.pace[5]
    for i in range(len(tau)):
        first, turn1 = whole_turns(nu1 * tau[i])
        second, turn2 = whole_turns(nu2 * tau[i])
        a, b = (first + turn1 % double1) / double1, (second + turn2 % double2) / double2
        swing, _ = swing_and_rate(clock.quiet, float(a), float(b), room)
        times[i] = float(mean * (loud_swing(clock, a, b) + tau[i] + swing))


def loud_swing(clock: Clock, a: Real, b: Real) -> Real:
    """The constant and the largest modes of the series S of a :class:`Clock`, summed at the phases (a, b)."""
    modes, loud = clock.modes, clock.loud
    total = loud[0]
    for n in range(len(modes) // 2):
        c, s = circle(modes[2 * n] * a + modes[2 * n + 1] * b, clock.inverse)
        total += loud[1 + 2 * n] * c - loud[2 + 2 * n] * s
    return total


def solved(series: ClockSeries, a: float, b: float, x: float, near: float, room: Row) -> tuple[float, float]:
    """The x with x + S = 0 at the phases (a + ν₁x, b + ν₂x), and the slope of x + S; S is the sum of ``series``.

    Newton's method starts from the given ``x``. The error of the result is about the bound of S times the square of
    ``near``. x + S increases with x. Where 1/g is small a Newton step may leave the bracket of the zero; then the
    bracket is halved.
    """
    (nu1, nu2), bound = series.frequencies, series.bound
    # near a resonance |S| may be many turns, but x + S varies on the scale of one turn
    turn = 1 / (abs(nu1) + abs(nu2))
    low, high, rate = -bound, bound, 1.0
    for _ in range(100):
        rest, rate = swing_and_rate(series, a + nu1 * x, b + nu2 * x, room)
        rest += x
        if rest > 0:
            high = x
        else:
            low = x
        step = rest / rate
        if not low <= x - step <= high:
            step = x - 0.5 * (low + high)
        x -= step
        if abs(step) <= near * min(bound, turn):
            break
    return x, rate


def swing_and_rate(series: ClockSeries, a: float, b: float, room: Row) -> tuple[float, float]:
    """(S, ``mean`` + dS/dτ) of a :class:`ClockSeries` at the phases (a, b) in turns. ``room`` holds two floats for each
    m.
    """
    lines, count, least, swing, rate = series.lines, series.width, series.least, series.origin, series.mean
    total = len(series.parts) // 4
    real, imaginary = series.parts[:total], series.parts[total : 2 * total]
    slope_real, slope_imaginary = series.parts[2 * total : 3 * total], series.parts[3 * total :]
    x, y = cos(2 * pi * b), sin(2 * pi * b)
    p, q = cos(2 * pi * b * least), sin(2 * pi * b * least)
    for m in range(count):
        room[m] = p
        room[count + m] = q
        p, q = p * x - q * y, p * y + q * x
    x, y = cos(2 * pi * a), sin(2 * pi * a)
    p, q = 1.0, 0.0
    for k in range(len(lines) // 3):
        first, begin, end = lines[3 * k], lines[3 * k + 1], lines[3 * k + 2]
        s, t, u, v = 0.0, 0.0, 0.0, 0.0
        for m in range(end - begin):
            c, d = room[first + m], room[count + first + m]
            n = begin + m
            s += real[n] * c - imaginary[n] * d
            t += real[n] * d + imaginary[n] * c
            u += slope_real[n] * c - slope_imaginary[n] * d
            v += slope_real[n] * d + slope_imaginary[n] * c
        swing += s * p - t * q
        rate += u * p - v * q
        p, q = p * x - q * y, p * y + q * x
    return swing, rate


def panel_values(middles: Row, halves: Row, coefficients: Row, times: Row, room: Row, out: Row) -> None:
    """Writes the values of Chebyshev series at ``times`` to ``out``. Panel p has the middle middles[p], the half-length
    halves[p] and the coefficients[p, k, column].

    Clenshaw's recurrence runs over all columns at once, in the two rows of ``room``. The panel of the previous time is
    tried first.
    """
    panels, terms, width = coefficients.shape
    p = 0
    for i in range(len(times)):
        t = times[i]
        if abs(t - middles[p]) > halves[p]:
            low, high = 0, panels
            while high - low > 1:
                middle = (low + high) // 2
                if t < middles[middle] - halves[middle]:
                    high = middle
                else:
                    low = middle
            p = low
        x = 2 * (t - middles[p]) / halves[p]
        for c in range(width):
            room[0, c] = room[1, c] = 0.0
        for k in range(terms - 1, 0, -1):
            for c in range(width):
                value = coefficients[p, k, c] + x * room[0, c] - room[1, c]
                room[1, c] = room[0, c]
                room[0, c] = value
        for c in range(width):
            out[i, c] = coefficients[p, 0, c] + 0.5 * x * room[0, c] - room[1, c]
