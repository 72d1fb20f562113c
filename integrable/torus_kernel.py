"""The inner loops of random access on the torus, on bare reals: written so that numba can compile them as they stand.

Arrays are flat and moving points are those of :mod:`integrable.flow_kernel`. Numbers are floats in lists, or
double-doubles when compiled (:mod:`integrable.torus_compiled`). An argument ``torus`` is the tuple that
:class:`integrable.torus_flow.TorusFlow` makes: (f, axes, matrix, states, tables, parts, centres, turns, sizes), where

* ``states`` holds the moving points at the corners of the cells, row by row of ten numbers;
* ``tables`` two tables of ``sizes[2]`` terms of :func:`direction`, one for either centre;
* ``parts`` (p, q, r, s): the translation by (a, b) in periods takes the parts pa + qb and ra + sb of both reaches;
* ``turns`` the signs that σ1, σ2, σ3 change by in either period, ``sizes`` (rows, columns, terms);
* ``matrix`` (p, q, r, s): γ = pγ̃ + q·w̃×γ̃, M = rγ̃ + s·w̃×γ̃ from the upright γ̃ and w̃ = γ̃×M̃/|M̃|.
"""

from __future__ import annotations

from math import cos, floor, pi, sin
from typing import Any

from integrable.flow_kernel import carried, moving_point, near_identity, rate_at, shift
from jacobian.genus2_real import root

Real = Any
Row = Any


def direction(
    series: Row, roots: Row, f0: Real, axes: Row, reach: Real, nodes: Row, passes: int, slopes: Row, table: Row
) -> None:
    """Polynomials of T(s) in one direction, |s| ≤ reach, into ``table``: with x = s/reach and z = x², its points are
    c + m ± √r, m = z·p(z), r = z·q(z), and V' = (x − c)·t(z)/x + x·v(z): the coefficients of p, q, t, v one after
    the other, ascending.

    ``axes`` and the series (:func:`integrable.flow_kernel.near_identity`) are taken about the centre c; ``nodes`` are
    values of z, ``slopes`` is room for as many numbers.
    """
    size = len(nodes)
    for n in range(size):
        x = root(nodes[n] + 0 * reach)
        step = near_identity(series, roots, f0, axes, reach * x, passes)
        m = -step[1] / 2
        table[n] = m / nodes[n]
        table[size + n] = (m * m - step[0]) / nodes[n]
        table[2 * size + n] = step[3] * x
        table[3 * size + n] = step[2] / x
    for part in range(4):
        first = part * size
        # divided differences, and Newton's form as powers of z
        for k in range(1, size):
            for n in range(size - 1, k - 1, -1):
                table[first + n] = (table[first + n] - table[first + n - 1]) / (nodes[n] - nodes[n - k])
        for n in range(size):
            slopes[n] = 0 * reach
        for k in range(size - 1, -1, -1):
            for n in range(size - 1, 0, -1):
                slopes[n] = slopes[n - 1] - nodes[k] * slopes[n]
            slopes[0] = table[first + k] - nodes[k] * slopes[0]
        for n in range(size):
            table[first + n] = slopes[n]


def small_translation(axes: Row, centre: float, table: Row, first: int, size: int, x: Real) -> Row:
    """T(x·reach) from the table of :func:`direction` that begins at ``first``, as a moving point with κ = 1."""
    z = x * x
    n = first + size - 1
    m, r, t, v = table[n], table[n + size], table[n + 2 * size], table[n + 3 * size]
    for _ in range(size - 1):
        n -= 1
        m = m * z + table[n]
        r = r * z + table[n + size]
        t = t * z + table[n + 2 * size]
        v = v * z + table[n + 3 * size]
    m, r, t1, t0 = m * z, r * z, t / x, v * x
    a1, a2, a3 = axes[0] - centre, axes[1] - centre, axes[2] - centre
    x1, x2, x3 = a1 - m, a2 - m, a3 - m
    r1, r2, r3 = root(x1 * x1 - r), root(x2 * x2 - r), root(x3 * x3 - r)
    middle = m + centre
    return (
        middle * middle - r,
        -2 * middle,
        t0 - t1 * centre,
        t1,
        r1,
        r2,
        r3,
        (t0 + t1 * a1) / r1,
        (t0 + t1 * a2) / r2,
        (t0 + t1 * a3) / r3,
    )


def translation_by(
    f: Row, axes: Row, centres: Any, tables: Row, terms: int, parts: Row, a: Real, b: Real, out: Row
) -> None:
    """The translation by (a, b) periods, at most half a cell, as moving points with κ = 1: its two parts, then their
    sum, which may lie far out.

    ``axes`` are those of κ = 1.
    """
    x, y = parts[0] * a + parts[1] * b, parts[2] * a + parts[3] * b
    first = small_translation(axes, centres[0], tables, 0, terms, x)
    second = small_translation(axes, centres[1], tables, 4 * terms, terms, y)
    both = carried(f, axes, first, second)
    for c in range(10):
        out[c], out[10 + c], out[20 + c] = first[c], second[c], both[c]


def walked(f: Row, axes: Row, point: Row, steps: Row) -> Row:
    """The moving point after the translations of ``steps``, ten numbers each."""
    for n in range(0, len(steps), 10):
        step = (
            steps[n],
            steps[n + 1],
            steps[n + 2],
            steps[n + 3],
            steps[n + 4],
            steps[n + 5],
            steps[n + 6],
            steps[n + 7],
            steps[n + 8],
            steps[n + 9],
        )
        point = shift(f, axes, point, step)
    return point


def fill(
    f: Row,
    axes: Row,
    start: Row,
    down: Row,
    across: Row,
    sizes: Any,
    every: Any,
    states: Row,
    rates: Row,
    others: Row,
    ends: Row,
) -> None:
    """Walk over a grid of ``sizes`` moving points, ``down`` and ``across`` its translations: every point of a grid
    that is ``every`` times coarser into ``states``, the ends of the first column and row, one period away, into
    ``ends``.

    1/g at all points into ``rates`` and for a tilted body, with an odd number of γ_i turned, into ``others``; neither
    where ``rates`` is empty.
    """
    rows, columns = sizes
    count = 0
    left = moving_point(start)
    for i in range(rows):
        point = left
        for j in range(columns):
            if i % every[0] == 0 and j % every[1] == 0:
                for c in range(10):
                    states[count + c] = point[c]
                count += 10
            if len(rates) > 0:
                rate = rate_at(axes, point)
                rates[i * columns + j] = rate
                if axes[7] != 0:
                    square = point[4] * point[4] + point[5] * point[5] + point[6] * point[6]
                    others[i * columns + j] = 2 * axes[6] / root(square) - rate
            point = walked(f, axes, point, across)
        if i == 0:
            for c in range(10):
                ends[10 + c] = point[c]
        left = walked(f, axes, left, down)
    for c in range(10):
        ends[c] = left[c]


def whole_turns(x: Real) -> tuple[Real, int]:
    """(fraction in [0, 1), whole turns) of x, |x| below 2^52."""
    whole = floor(float(x))
    rest = x - whole
    # the low part of a double-double may lead below 0
    if rest < 0:
        rest, whole = rest + 1, whole - 1
    return rest, whole


def state_at(torus: Any, first: Real, second: Real, turn1: int, turn2: int, out: Row, place: int) -> None:
    """γ and M at the phases (first, second) in [0, 1) after so many whole turns, into out[place … place + 5].

    The nearest corner, and two translations near the identity.
    """
    f, axes, matrix, states, tables, parts, centres, turns, sizes = torus
    rows, columns, terms = sizes
    i, j = floor(float(first) * rows + 0.5), floor(float(second) * columns + 0.5)
    a, b = first - i / rows, second - j / columns
    if i == rows:
        i, turn1 = 0, turn1 + 1
    if j == columns:
        j, turn2 = 0, turn2 + 1
    n = (i * columns + j) * 10
    point = (
        states[n],
        states[n + 1],
        states[n + 2],
        states[n + 3],
        states[n + 4],
        states[n + 5],
        states[n + 6],
        states[n + 7],
        states[n + 8],
        states[n + 9],
    )
    x, y = parts[0] * a + parts[1] * b, parts[2] * a + parts[3] * b
    # the translation has a pole at 0, where it is the identity
    if abs(x) > 1e-30:
        point = carried(f, axes, point, small_translation(axes, centres[0], tables, 0, terms, x))
    if abs(y) > 1e-30:
        point = carried(f, axes, point, small_translation(axes, centres[1], tables, 4 * terms, terms, y))
    s1, s2, s3, n1, n2, n3 = point[4], point[5], point[6], point[7], point[8], point[9]
    if turn1 % 2 != 0:
        s1, s2, s3, n1, n2, n3 = turned(turns[0], turns[1], turns[2], s1, s2, s3, n1, n2, n3)
    if turn2 % 2 != 0:
        s1, s2, s3, n1, n2, n3 = turned(turns[3], turns[4], turns[5], s1, s2, s3, n1, n2, n3)
    square = s1 * s1 + s2 * s2 + s3 * s3
    lean = (s1 * n1 + s2 * n2 + s3 * n3) / square
    scale = 1 / root(square)
    n1, n2, n3 = n1 - lean * s1, n2 - lean * s2, n3 - lean * s3
    s1, s2, s3 = s1 * scale, s2 * scale, s3 * scale
    m1, m2, m3 = n2 * s3 - n3 * s2, n3 * s1 - n1 * s3, n1 * s2 - n2 * s1
    p, q, r, s = matrix
    out[place] = float(p * s1 + q * m1)
    out[place + 1] = float(p * s2 + q * m2)
    out[place + 2] = float(p * s3 + q * m3)
    out[place + 3] = float(r * s1 + s * m1)
    out[place + 4] = float(r * s2 + s * m2)
    out[place + 5] = float(r * s3 + s * m3)


def turned(
    t1: float, t2: float, t3: float, s1: Real, s2: Real, s3: Real, n1: Real, n2: Real, n3: Real
) -> tuple[Real, Real, Real, Real, Real, Real]:
    """The pairs with the signs t."""
    return t1 * s1, t2 * s2, t3 * s3, t1 * n1, t2 * n2, t3 * n3


def states_at_phases(torus: Any, phases: Row, out: Row) -> None:
    """γ and M at pairs of phases in turns, one after the other in ``phases``: six floats each."""
    zero = 0 * torus[1][0]
    for i in range(len(phases) // 2):
        first, turn1 = whole_turns(phases[2 * i] + zero)
        second, turn2 = whole_turns(phases[2 * i + 1] + zero)
        state_at(torus, first, second, turn1, turn2, out, 6 * i)


def states_at_tau(torus: Any, frequencies: Any, tau: Row, out: Row) -> None:
    """γ and M at the times ``tau`` of the flow, six floats each; ``frequencies`` are turns in a unit of τ."""
    for i in range(len(tau)):
        first, turn1 = whole_turns(frequencies[0] * tau[i])
        second, turn2 = whole_turns(frequencies[1] * tau[i])
        state_at(torus, first, second, turn1, turn2, out, 6 * i)


def states_at_times(torus: Any, pace: Any, clock: Any, times: Row, tau: Row, delays: Row, out: Row, room: Row) -> None:
    """γ and M at physical times, six floats each, the times of the flow into ``tau``, and how far they are from their
    mean into ``delays``.

    ``pace`` is (turns of either phase in a unit of t, frequencies, dτ/dt), all means; ``clock`` (periods of 1/g in
    turns, rough series, series) as :class:`integrable.torus_flow.TorusClock` makes them. τ = t·dτ/dt + x with a
    bounded x from :func:`delay`. ``room`` is for powers.
    """
    pace1, pace2, nu1, nu2, mean = pace
    (double1, double2), rough, series = clock
    for i in range(len(times)):
        first, turn1 = whole_turns(pace1 * times[i])
        second, turn2 = whole_turns(pace2 * times[i])
        a, b = (float(first) + turn1 % double1) / double1, (float(second) + turn2 % double2) / double2
        x = delay(rough, series, a, b, room)
        first, more1 = whole_turns(first + nu1 * x)
        second, more2 = whole_turns(second + nu2 * x)
        tau[i] = float(mean * times[i] + x)
        delays[i] = x
        state_at(torus, first, second, turn1 + more1, turn2 + more2, out, 6 * i)


def times_at_tau(frequencies: Any, clock: Any, mean: Real, tau: Row, times: Row, room: Row) -> None:
    """Physical times at the times ``tau`` of the flow, ``mean`` = dt/dτ."""
    (double1, double2), _, series = clock
    for i in range(len(tau)):
        first, turn1 = whole_turns(frequencies[0] * tau[i])
        second, turn2 = whole_turns(frequencies[1] * tau[i])
        a, b = (float(first) + turn1 % double1) / double1, (float(second) + turn2 % double2) / double2
        swing, _ = swing_and_rate(series, a, b, room)
        times[i] = float(mean * tau[i] + float(mean) * swing)


def delay(rough: Any, series: Any, a: float, b: float, room: Row) -> float:
    """x with x + S = 0 at the phases (a + ν₁x, b + ν₂x): how far τ is from its mean at a physical time.

    x + S grows with x: Newton's steps on the few largest modes, held inside the interval that signs leave; then on all.
    """
    nu1, nu2, bound = series[6]
    low, high, x = -bound, bound, 0.0
    for _ in range(100):
        rest, rate = swing_and_rate(rough, a + nu1 * x, b + nu2 * x, room)
        rest += x
        if rest > 0:
            high = x
        else:
            low = x
        step = rest / rate
        if not low < x - step < high:
            step = x - 0.5 * (low + high)
        x -= step
        if abs(step) <= 1e-5 * bound:
            break
    for _ in range(8):
        rest, rate = swing_and_rate(series, a + nu1 * x, b + nu2 * x, room)
        step = (rest + x) / rate
        x -= step
        if abs(step) <= 1e-9 * bound:
            break
    return x


def swing_and_rate(series: Any, a: float, b: float, room: Row) -> tuple[float, float]:
    """(S, mean rate + dS/dτ) at the phases (a, b) in turns, S a real Fourier series that vanishes at the start.

    ``series`` is (lines, real parts of the coefficients of S, imaginary, those of dS/dτ, imaginary, (least second mode,
    number of second modes), (ν₁, ν₂, bound of |S|), (−S at the start, mean rate)). For every first mode k = 0, 1, …
    three lines are the place of its first second mode, and where its coefficients begin and end; for k > 0 they are
    doubled, in place of those of −k. ``room`` is for twice the number of second modes.
    """
    lines, real, imaginary, slope_real, slope_imaginary, (least, count), _, (swing, rate) = series
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
    """Rows of Chebyshev series at ``times`` into ``out``: the panel p around middles[p], halves[p] to either side, has
    the series coefficients[p, k, column].

    Clenshaw's recurrence, all columns at once in the two rows of ``room``; the panel of the time before is tried first.
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
