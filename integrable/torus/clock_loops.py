"""Loops for states at physical times on a torus: the clock's series, and panels. They run on bare reals, compiled or
interpreted.
"""

from __future__ import annotations

from math import floor
from typing import NamedTuple

from integrable.moving_point.addition import Real, Row
from integrable.torus.states import whole_turns
from integrable.torus.theta_series import circle
from jacobian.numbers.abreast import abreast

# Newton's method with the slope at one point multiplies an error by about the distance of this point from the solution,
# in turns. It ends when the product of this distance and of the last step is at most LAST_ERROR
LAST_ERROR, MOST_STEPS, MOST_CORRECTIONS = 1e-18, 100, 8
# the relative length of the last Newton step with the larger modes of S, and with all modes
ROUGHLY, EXACT = 1e-5, 1e-9


class ClockSeries(NamedTuple):
    """A real Fourier series S on the torus that vanishes at the start, and dS/dτ. Its modes are pairs (k, m).

    ``lines`` has three numbers for each k = 0, 1, …: its first m, counted from ``least``, and where its coefficients
    begin and end. For k > 0 coefficients are doubled, to account for −k. ``parts`` are the real parts of all
    coefficients of S, then the imaginary parts, then both for dS/dτ. ``least`` is the least m, ``bound`` a bound of
    |S|. S is ``origin`` plus the modes. ``mean`` is the mean rate of τ + S, 1 up to rounding.
    """

    lines: Row
    parts: Row
    least: int
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
    of :func:`integrable.torus.theta_series.circle_numbers`, ``circle`` that in floats.
    """

    doubled: tuple[int, int]
    rough: ClockSeries
    series: ClockSeries
    quiet: ClockSeries
    modes: Row
    loud: Row
    pace: Row
    inverse: Row
    circle: Row


class ClockRoom(NamedTuple):
    """The memory of :func:`phases_at_times`, with one number for each time in each array.

    x is between ``lows`` and ``highs``. ``rates`` are slopes of x + S, and ``steps`` the distances from the point of
    that slope to x. ``errors`` are estimated errors, in turns. ``offsets`` are the x in full precision.
    """

    lows: Row
    highs: Row
    rates: Row
    steps: Row
    errors: Row
    offsets: Row


def phases_at_times(clock: Clock, times: Row, found: tuple[Row, Row, Row], room: ClockRoom) -> None:
    """Writes into ``found`` the phases at physical times t (in turns, modulo 2, one pair after the other), τ, and
    x = τ − t·(mean dτ/dt).

    With S of :class:`ClockSeries`, x solves x + S = 0 at the phases (a + ν₁x, b + ν₂x), where (a, b) are the phases at
    the mean value of τ. x is found first with the larger modes of S, then with all modes in floats, and corrected where
    floats are not enough.
    """
    (phases, tau, delays), pace, offsets = found, clock.pace, room.offsets
    pace1, pace2, nu1, nu2, mean = pace[0], pace[1], pace[2], pace[3], pace[4]
    for i in abreast(0, len(times)):
        first, turn1 = whole_turns(pace1 * times[i])
        second, turn2 = whole_turns(pace2 * times[i])
        phases[2 * i], phases[2 * i + 1] = first + turn1 % 2, second + turn2 % 2
        delays[i] = 0 * times[i]
    solve(clock.rough, clock, phases, delays, ROUGHLY, room)
    solve(clock.series, clock, phases, delays, EXACT, room)
    for i in abreast(0, len(times)):
        offsets[i], room.errors[i] = delays[i] + 0 * nu1, 0 * delays[i] + 1
    if len(clock.modes) > 0:
        correct(clock, phases, room)
    for i in abreast(0, len(times)):
        first, turn1 = whole_turns(phases[2 * i] + nu1 * offsets[i])
        second, turn2 = whole_turns(phases[2 * i + 1] + nu2 * offsets[i])
        phases[2 * i], phases[2 * i + 1] = first + turn1 % 2, second + turn2 % 2
        tau[i], delays[i] = float(mean * times[i] + offsets[i]), float(offsets[i])


def solve(series: ClockSeries, clock: Clock, phases: Row, found: Row, near: float, room: ClockRoom) -> None:
    """Replaces each x in ``found`` by the solution of x + S = 0, where S is the sum of ``series``.

    Newton's method ends after a step of ``near`` times the bound of S, or times a turn if that is shorter. The error
    is about the square of this. x + S increases with x. Where 1/g is small a Newton step may leave the bracket of the
    zero; then the bracket is halved.
    """
    (double1, double2), (nu1, nu2), bound = clock.doubled, series.frequencies, series.bound
    # near a resonance |S| may be many turns, but x + S varies on the scale of one turn
    near = near * min(bound, 1 / (abs(nu1) + abs(nu2)))
    lows, highs, rates, steps, _, _ = room
    for i in abreast(0, len(found)):
        zero = 0 * found[i]
        lows[i], highs[i], rates[i], steps[i] = zero - bound, zero + bound, zero + 1, zero + 2 * near
    for _ in range(MOST_STEPS):
        for i in abreast(0, len(found)):
            x, low, high, rate, step = found[i], lows[i], highs[i], rates[i], steps[i]
            if step > near:
                a, b = float(centred(phases[2 * i] / double1)), float(centred(phases[2 * i + 1] / double2))
                rest, rate = swing_and_rate(series, a + nu1 * x, b + nu2 * x, clock.circle)
                rest += x
                if rest > 0:
                    high = x
                else:
                    low = x
                step = rest / rate
                step = step if low <= x - step <= high else x - 0.5 * (low + high)
                x, step = x - step, abs(step)
            found[i], lows[i], highs[i], rates[i], steps[i] = x, low, high, rate, step
        if greatest(steps) <= near:
            break


def correct(clock: Clock, phases: Row, room: ClockRoom) -> None:
    """Corrects the ``offsets`` by Newton's method with constant slopes, and with the largest modes in full precision.

    Near a resonance a few modes are so large that their rounding in floats changes x by a large part of a turn.
    """
    nu1, nu2, (double1, double2) = clock.pace[2], clock.pace[3], clock.doubled
    offsets, steps, errors, turns = room.offsets, room.steps, room.errors, abs(float(nu1)) + abs(float(nu2))
    for _ in range(MOST_CORRECTIONS):
        for i in abreast(0, len(errors)):
            x, reach, error = offsets[i], steps[i], errors[i]
            # a solved x is left as it is, so that a state does not depend on the other times
            if error > LAST_ERROR:
                p, q = centred((phases[2 * i] + nu1 * x) / double1), centred((phases[2 * i + 1] + nu2 * x) / double2)
                rest, _ = swing_and_rate(clock.quiet, float(p), float(q), clock.circle)
                step = (loud_swing(clock, p, q) + x + rest) / room.rates[i]
                x -= step
                size = abs(float(step))
                reach = max(reach, size)
                error = reach * size * turns * turns
            offsets[i], steps[i], errors[i] = x, reach, error
        if greatest(errors) <= LAST_ERROR:
            break


def centred(turns: Real) -> Real:
    """A phase in turns, reduced to −½ … ½: multiples of it in floats then have the least errors."""
    return turns - floor(float(turns) + 0.5)


def greatest(values: Row) -> float:
    """The greatest of some numbers, at least 0."""
    found = 0.0
    for value in values:
        found = max(found, value)
    return found


def times_at_tau(clock: Clock, tau: Row, times: Row) -> None:
    """Writes the physical times at the times ``tau`` of the flow."""
    (double1, double2), nu1, nu2, mean = clock.doubled, clock.pace[2], clock.pace[3], clock.pace[5]
    for i in abreast(0, len(tau)):
        first, turn1 = whole_turns(nu1 * tau[i])
        second, turn2 = whole_turns(nu2 * tau[i])
        a, b = (first + turn1 % double1) / double1, (second + turn2 % double2) / double2
        swing, _ = swing_and_rate(clock.quiet, float(a), float(b), clock.circle)
        times[i] = float(mean * (loud_swing(clock, a, b) + tau[i] + swing))


def loud_swing(clock: Clock, a: Real, b: Real) -> Real:
    """The constant and the largest modes of the series S of a :class:`Clock`, summed at the phases (a, b)."""
    modes, loud = clock.modes, clock.loud
    total = loud[0] + 0 * a
    for n in range(len(modes) // 2):
        c, s = circle(modes[2 * n] * a + modes[2 * n + 1] * b, clock.inverse)
        total += loud[1 + 2 * n] * c - loud[2 + 2 * n] * s
    return total


def swing_and_rate(series: ClockSeries, a: Real, b: Real, inverse: Row) -> tuple[Real, Real]:
    """(S, ``mean`` + dS/dτ) of a :class:`ClockSeries` at the phases (a, b) in turns, in floats.

    With z = e^{2πib}, the modes of each k are a polynomial in z, which Horner's rule evaluates.
    """
    lines, total = series.lines, len(series.parts) // 4
    real, imaginary = series.parts[:total], series.parts[total : 2 * total]
    slope_real, slope_imaginary = series.parts[2 * total : 3 * total], series.parts[3 * total :]
    swing, rate, place = series.origin + 0 * a, series.mean + 0 * a, 0
    (c, s), (x, y) = circle(a, inverse), circle(b, inverse)
    # p + iq is e^{2πi(ka + mb)}, m = ``least`` + ``place``
    p, q = circle(series.least * b, inverse)
    for k in range(len(lines) // 3):
        first, begin, end = lines[3 * k], lines[3 * k + 1], lines[3 * k + 2]
        if end > begin:
            while place < first:
                p, q, place = p * x - q * y, p * y + q * x, place + 1
            while place > first:
                p, q, place = p * x + q * y, q * x - p * y, place - 1
            t, u, v, w = 0 * a, 0 * a, 0 * a, 0 * a
            for n in range(end - 1, begin - 1, -1):
                t, u = t * x - u * y + real[n], t * y + u * x + imaginary[n]
                v, w = v * x - w * y + slope_real[n], v * y + w * x + slope_imaginary[n]
            swing += t * p - u * q
            rate += v * p - w * q
        p, q = p * c - q * s, p * s + q * c
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
