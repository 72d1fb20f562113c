"""The inner loops of random access on the torus, on bare reals: written so that numba can compile them as they stand.

Arrays are flat and moving points are those of :mod:`integrable.moving_point.kernel`. Numbers are floats in lists, or
double-doubles when compiled (:mod:`integrable.torus.compiled`). An argument ``torus`` is the tuple that
:class:`integrable.torus.access.TorusFlow` makes: (f, axes, matrix, states, tables, parts, centres, turns, sizes), where

* ``states`` holds the moving points at the corners of the cells, row by row of ten numbers;
* ``tables`` two tables of ``sizes[2]`` terms of :func:`direction`, one for either centre;
* ``parts`` (p, q, r, s): the translation by (a, b) in periods takes the parts pa + qb and ra + sb of both reaches;
* ``turns`` the signs that σ1, σ2, σ3 change by in either period, ``sizes`` (rows, columns, terms);
* ``matrix`` (p, q, r, s): γ = pγ̃ + q·w̃×γ̃, M = rγ̃ + s·w̃×γ̃ from the upright γ̃ and w̃ = γ̃×M̃/|M̃|.
"""

from __future__ import annotations

from math import cos, floor, log2, pi, sin
from typing import Any

from integrable.moving_point.kernel import carried, clock_rate, moving_point, near_identity, rate_at, shift
from integrable.moving_point.translations import power_series
from integrable.torus.survey import about_centre
from jacobian.numbers.roots import root

Real = Any
Row = Any

# a part of a reach this small is none
IDENTITY = 1e-30
# translations that are conditioned worse than this are made in two parts
LEAST_CONDITION = 0.02


def directions(
    motion: Row,
    chart: Any,
    parts: Row,
    nodes: Row,
    passes: int,
    series: Row,
    roots: Row,
    room: Row,
    tables: Row,
    halves: Row,
) -> None:
    """:func:`direction` about either centre, one after the other into ``tables``, and into ``halves`` the translations
    by half a cell in either direction, both parts of the first, then of the second.

    ``motion`` is as for :func:`integrable.torus.survey.survey`; ``chart`` is (centres, reaches, cells); ``series`` and
    ``roots`` are room for power series, ``room`` for nine numbers and one for each node.
    """
    centres, reaches, cells = chart
    for k in range(2):
        centre = centres[k]
        # about the distance to the nearest branch point: no power of it leaves the range of floats, no product rounds
        near = abs(float(motion[7]) - centre)
        for i in range(3):
            near = min(near, abs(float(motion[4 + i]) - centre))
        if motion[8] > 0:
            near = min(near, abs(float(motion[10] / motion[8]) - centre))
        unit = 2.0 ** floor(log2(near))
        about_centre(motion, centre, unit, room)
        power_series(room, -1, series)
        power_series(room, 1, roots)
        f0, axes, reach = room[0], (room[6], room[7], room[8]), reaches[k] / unit + 0 * room[0]
        for n in range(2):
            x = parts[2 * k + n] * (0.5 / cells[n])
            step = near_identity(series, roots, f0, axes, reach * x, passes)
            put(recentred(step, axes, centre, unit), halves, 20 * n + 10 * k)
        direction(series, roots, f0, axes, reach, unit, nodes, passes, room, 4 * len(nodes) * k, tables)


def recentred(step: Row, axes: Row, centre: float, unit: float) -> Row:
    """A translation in x from one in (x − centre)/unit, in which the axes are ``axes``.

    Near the identity σ_i is α_i − c, whatever the centre c: continued around α_i it has no branch.
    """
    unit1, unit2, unit3 = alike(axes[0], unit), alike(axes[1], unit), alike(axes[2], unit)
    u0, u1, v0, v1 = step[0] * unit * unit, step[1] * unit, step[2], step[3] / unit
    return (
        u0 - u1 * centre + (0 * u0 + centre) * centre,
        u1 - 2 * centre,
        v0 - v1 * centre,
        v1,
        step[4] * unit1,
        step[5] * unit2,
        step[6] * unit3,
        step[7] / unit1,
        step[8] / unit2,
        step[9] / unit3,
    )


def alike(x: Real, size: Real) -> Real:
    """``size`` with the sign of x."""
    return -size if x < 0 else size


def direction(
    series: Row,
    roots: Row,
    f0: Real,
    axes: Row,
    reach: Real,
    unit: float,
    nodes: Row,
    passes: int,
    room: Row,
    begin: int,
    table: Row,
) -> None:
    """Polynomials of T(s) in one direction, |s| ≤ reach, into ``table`` from ``begin`` on: with x = s/reach and z = x²,
    its points are c + m ± √r, m = z·p(z), r = z·q(z), and V' = (x − c)·t(z)/x + x·v(z): the coefficients of p, q, t, v
    one after the other, ascending.

    ``reach``, ``axes`` and the series (:func:`integrable.moving_point.kernel.near_identity`) are taken about the centre
    c in units of ``unit``; ``nodes`` are values of z, ``room`` is for nine numbers more than there are nodes.
    """
    size = len(nodes)
    for n in range(size):
        x = root(nodes[n] + 0 * reach)
        step = near_identity(series, roots, f0, axes, reach * x, passes)
        m = -step[1] / 2
        table[begin + n] = m * unit / nodes[n]
        table[begin + size + n] = (m * m - step[0]) * (unit * unit) / nodes[n]
        table[begin + 2 * size + n] = step[3] / unit * x
        table[begin + 3 * size + n] = step[2] / x
    for part in range(4):
        first = begin + part * size
        # divided differences, and Newton's form as powers of z
        for k in range(1, size):
            for n in range(size - 1, k - 1, -1):
                table[first + n] = (table[first + n] - table[first + n - 1]) / (nodes[n] - nodes[n - k])
        for n in range(size):
            room[9 + n] = 0 * reach
        for k in range(size - 1, -1, -1):
            for n in range(size - 1, 0, -1):
                room[9 + n] = room[8 + n] - nodes[k] * room[9 + n]
            room[9] = table[first + k] - nodes[k] * room[9]
        for n in range(size):
            table[first + n] = room[9 + n]


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
    # as in recentred
    r1, r2, r3 = alike(a1, root(x1 * x1 - r)), alike(a2, root(x2 * x2 - r)), alike(a3, root(x3 * x3 - r))
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


def corners(
    f: Row,
    axes: Row,
    unit_axes: Row,
    start: Row,
    cells: Any,
    forward: int,
    most: int,
    halves: Row,
    steps: Row,
    states: Row,
    ends: Row,
    known: Row,
    turns: Row,
) -> None:
    """The moving points at the corners of the cells into ``states``.

    The first direction is walked in steps of an odd number of cells, up to ``most``, round and round, the second in
    such steps that may lead down by one cell as well; where ``forward`` is less than the number of columns, so many
    columns forward and the others backward, which takes ``most`` = 1. Into ``ends`` where every walk ends and into
    ``known`` where it should, signs included: that of the first direction, then those of the second from all rows.
    ``turns`` are the signs of the periods, ``unit_axes`` the axes of translations, κ = 1; ``halves`` are those of
    :func:`directions`, ``steps`` is room for forty numbers.
    """
    rows, columns = cells
    down, _, parts0 = step_over(f, unit_axes, halves, 0, min(rows, most), steps)
    across, lower, parts1 = step_over(f, unit_axes, halves, 1, min(columns, most), steps)
    left = moving_point(start)
    for i in range(rows):
        point = left
        for j in range(forward):
            put(point, states, 10 * ((down * i + lower * j) % rows * columns + across * j % columns))
            for k in range(parts1):
                point = shift(f, axes, point, point_in(steps, 20 + 10 * k))
        put(point, ends, 10 * (i + 1))
        point = left
        for j in range(-1, forward - columns - 1, -1):
            for k in range(parts1):
                point = shift(f, axes, point, opposite(point_in(steps, 20 + 10 * k)))
            put(point, states, 10 * ((down * i + lower * j) % rows * columns + across * j % columns))
        for k in range(parts0):
            left = shift(f, axes, left, point_in(steps, 10 * k))
    put(left, ends, 0)
    put(moving_point(start), known, 0)
    turn(known, 0, turns, 0)
    for i in range(rows):
        for j in range(forward - columns, forward):
            if (down * i + lower * j) // rows % 2 != 0:
                turn(states, 10 * ((down * i + lower * j) % rows * columns + across * j % columns), turns, 0)
    for i in range(rows):
        # a whole period away, times an odd number of cells: the walk that began, or went back, there
        place, below = 10 * (i + 1), down * i + lower * forward
        if below // rows % 2 != 0:
            turn(ends, place, turns, 0)
        put(point_in(states, 10 * (below % rows * columns + across * forward % columns)), known, place)
        turn(known, place, turns, 3)
    for i in range(rows):
        for j in range(forward - columns, forward):
            if across * j // columns % 2 != 0:
                turn(states, 10 * ((down * i + lower * j) % rows * columns + across * j % columns), turns, 3)


def turn(points: Row, place: int, turns: Row, first: int) -> None:
    """The pairs of the moving point at ``place`` with the signs turns[first … first + 2]."""
    for c in range(3):
        points[place + 4 + c] = turns[first + c] * points[place + 4 + c]
        points[place + 7 + c] = turns[first + c] * points[place + 7 + c]


def opposite(step: Row) -> Row:
    """The inverse of a translation."""
    return step[0], step[1], -step[2], -step[3], step[4], step[5], step[6], -step[7], -step[8], -step[9]


def point_in(row: Row, place: int) -> Row:
    """The moving point at row[place … place + 9]."""
    return (
        row[place],
        row[place + 1],
        row[place + 2],
        row[place + 3],
        row[place + 4],
        row[place + 5],
        row[place + 6],
        row[place + 7],
        row[place + 8],
        row[place + 9],
    )


def step_over(f: Row, axes: Row, halves: Row, direction: int, most: int, out: Row) -> tuple[int, int, int]:
    """The step over an odd number of cells in a direction into out[20·direction …], and (that number, 1 or 0 for one
    cell more in the first direction, where the second is asked for, number of translations): of the odd numbers up to
    ``most`` the one that is best conditioned. ``axes`` are those of κ = 1.

    One translation, or both parts of one cell where every sum is badly conditioned: a direction in which an oval runs
    through no more than a point, that of a body with two equal moments, has both points of its translations there.
    """
    first, second = point_in(halves, 20 * direction), point_in(halves, 20 * direction + 10)
    down1, down2 = point_in(halves, 0), point_in(halves, 10)
    down1, down2 = carried(f, axes, down1, down1), carried(f, axes, down2, down2)
    # multiples of either part, and one sum of both: sums lie anywhere, and at d = 0 those by one of the periods, the
    # residue of x dx/y, at infinity
    first, second = carried(f, axes, first, first), carried(f, axes, second, second)
    put(first, out, 20 * direction)
    put(second, out, 20 * direction + 10)
    double1, double2 = carried(f, axes, first, first), carried(f, axes, second, second)
    trust, later = min(conditioning(first), conditioning(second)), min(conditioning(double1), conditioning(double2))
    best, chosen, lower, parts = LEAST_CONDITION * trust, 1, 0, 2
    for count in range(1, most + 1, 2):
        total = carried(f, axes, first, second)
        found = min(trust, conditioning(total))
        if found > best:
            best, chosen, lower, parts = found, count, 0, 1
            put(total, out, 20 * direction)
        if direction == 1:
            more1, more2 = carried(f, axes, first, down1), carried(f, axes, second, down2)
            total = carried(f, axes, more1, more2)
            found = min(trust, conditioning(more1), conditioning(more2), conditioning(total))
            if found > best:
                best, chosen, lower, parts = found, count, 1, 1
                put(total, out, 20)
        first, second = carried(f, axes, first, double1), carried(f, axes, second, double2)
        trust = min(trust, later, conditioning(first), conditioning(second))
    return chosen, lower, parts


def offsets(
    f: Row,
    axes: Row,
    centres: Any,
    tables: Row,
    terms: int,
    parts: Row,
    cells: Any,
    finer: Any,
    steps: Row,
    counts: Row,
) -> None:
    """The translations from a corner to the finer[0] × finer[1] points around it, row by row: two in ``steps`` for
    each, of which ``counts`` says how many to take, 1 where their sum is well conditioned and none for the corner
    itself.
    """
    above, left = (finer[0] - 1) // 2, (finer[1] - 1) // 2
    zero, n = 0 * parts[0], 0
    for i in range(-above, finer[0] - above):
        for j in range(-left, finer[1] - left):
            a, b = zero + i / (finer[0] * cells[0]), zero + j / (finer[1] * cells[1])
            x, y = parts[0] * a + parts[1] * b, parts[2] * a + parts[3] * b
            place = 20 * n
            counts[n] = 0
            if abs(x) > IDENTITY:
                put(small_translation(axes, centres[0], tables, 0, terms, x), steps, place)
                counts[n] += 1
            if abs(y) > IDENTITY:
                put(small_translation(axes, centres[1], tables, 4 * terms, terms, y), steps, place + 10 * counts[n])
                counts[n] += 1
            if counts[n] == 2:
                both = carried(f, axes, point_in(steps, place), point_in(steps, place + 10))
                if conditioning(both) > LEAST_CONDITION:
                    put(both, steps, place)
                    counts[n] = 1
            n += 1


def conditioning(step: Row) -> float:
    """How well a translation adds, larger is better: its points away from the branch points, and not far out."""
    near = min(abs(float(step[4])), abs(float(step[5])), abs(float(step[6])))
    far = max(abs(float(step[0])), abs(float(step[1])), abs(float(step[2])), abs(float(step[3])))
    return near / (1 + far)


def put(point: Row, out: Row, place: int) -> None:
    """A moving point into out[place … place + 9]."""
    for c in range(10):
        out[place + c] = point[c]


def sampled(
    f: Row,
    axes: Row,
    states: Row,
    cells: Any,
    finer: Any,
    odd: Any,
    steps: Row,
    counts: Row,
    rates: Row,
    others: Row,
) -> None:
    """1/g on a grid that has finer[0] × finer[1] points to a cell, from the corners in ``states`` by the translations
    of :func:`offsets`, into ``rates``; for a tilted body, with an odd number of γ_i turned, into ``others``.

    ``odd``: whether a period turns an odd number of γ_i.
    """
    rows, columns = cells
    above, left = (finer[0] - 1) // 2, (finer[1] - 1) // 2
    height, width = rows * finer[0], columns * finer[1]
    for i in range(rows):
        for j in range(columns):
            corner = point_in(states, (i * columns + j) * 10)
            n = 0
            for a in range(-above, finer[0] - above):
                row, over = i * finer[0] + a, False
                if row < 0:
                    row, over = row + height, odd[0]
                for b in range(-left, finer[1] - left):
                    column, flipped = j * finer[1] + b, over
                    if column < 0:
                        column, flipped = column + width, over != odd[1]
                    point, last = corner, counts[n] - 1
                    for k in range(last):
                        point = carried(f, axes, point, point_in(steps, 20 * n + 10 * k))
                    if last >= 0 and axes[7] == 0:
                        rate = clock_rate(f, axes, point, point_in(steps, 20 * n + 10 * last))
                    elif last >= 0:
                        point = carried(f, axes, point, point_in(steps, 20 * n + 10 * last))
                        rate = rate_at(axes, point)
                    else:
                        rate = rate_at(axes, point)
                    n += 1
                    if axes[7] != 0:
                        square = point[4] * point[4] + point[5] * point[5] + point[6] * point[6]
                        other = 2 * axes[6] / root(square) - rate
                        if flipped:
                            rate, other = other, rate
                        others[row * width + column] = other
                    rates[row * width + column] = rate


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
    point = point_in(states, (i * columns + j) * 10)
    x, y = parts[0] * a + parts[1] * b, parts[2] * a + parts[3] * b
    # the translation has a pole at 0, where it is the identity
    if abs(x) > IDENTITY:
        point = carried(f, axes, point, small_translation(axes, centres[0], tables, 0, terms, x))
    if abs(y) > IDENTITY:
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


def states_at_times(
    torus: Any, pace: Any, clock: Any, modes: Row, loud: Row, times: Row, tau: Row, delays: Row, out: Row, room: Row
) -> None:
    """γ and M at physical times, six floats each, the times of the flow into ``tau``, and how far they are from their
    mean into ``delays``.

    ``pace`` is (turns of either phase in a unit of t, frequencies, dτ/dt), all means; ``clock`` (periods of 1/g in
    turns, rough series, series, series without its largest modes), ``modes`` and ``loud`` the latter
    (:func:`loud_swing`), as :class:`integrable.torus.access.TorusClock` makes them. τ = t·dτ/dt + x with a bounded x
    from :func:`delay`, whose rounding is then taken off. ``room`` is for powers.
    """
    pace1, pace2, nu1, nu2, mean = pace
    (double1, double2), rough, series, quiet = clock
    for i in range(len(times)):
        first, turn1 = whole_turns(pace1 * times[i])
        second, turn2 = whole_turns(pace2 * times[i])
        a, b = (float(first) + turn1 % double1) / double1, (float(second) + turn2 % double2) / double2
        start, rate = delay(rough, series, a, b, room)
        x = 0 * nu1 + start
        if len(modes) > 0:
            p, q = (first + turn1 % double1 + nu1 * x) / double1, (second + turn2 % double2 + nu2 * x) / double2
            rest, _ = swing_and_rate(quiet, float(p), float(q), room)
            x -= (loud_swing(modes, loud, p, q) + x + rest) / rate
        first, more1 = whole_turns(first + nu1 * x)
        second, more2 = whole_turns(second + nu2 * x)
        tau[i] = float(mean * times[i] + x)
        delays[i] = float(x)
        state_at(torus, first, second, turn1 + more1, turn2 + more2, out, 6 * i)


def times_at_tau(frequencies: Any, clock: Any, mean: Real, tau: Row, times: Row, room: Row) -> None:
    """Physical times at the times ``tau`` of the flow, ``mean`` = dt/dτ."""
    (double1, double2), _, series, _ = clock
    for i in range(len(tau)):
        first, turn1 = whole_turns(frequencies[0] * tau[i])
        second, turn2 = whole_turns(frequencies[1] * tau[i])
        a, b = (float(first) + turn1 % double1) / double1, (float(second) + turn2 % double2) / double2
        swing, _ = swing_and_rate(series, a, b, room)
        times[i] = float(mean * tau[i] + float(mean) * swing)


def loud_swing(modes: Row, loud: Row, a: Real, b: Real) -> Real:
    """The part of S in a few modes, pairs of integers (k, m) in ``modes``: ``loud`` holds a constant, 2π and the real
    and imaginary parts of the coefficients.
    """
    total = loud[0]
    for n in range(len(modes) // 2):
        c, s = on_circle(modes[2 * n] * a + modes[2 * n + 1] * b, loud[1])
        total += loud[2 + 2 * n] * c - loud[3 + 2 * n] * s
    return total


def on_circle(x: Real, two_pi: Real) -> tuple[Real, Real]:
    """(cos 2πx, sin 2πx) to 20 decimals."""
    quarters = floor(4 * float(x) + 0.5)
    y = (x - quarters / 4) * two_pi
    square = y * y
    c, s = 1 + 0 * y, 1 + 0 * y
    for n in range(20, 0, -2):
        c = 1 - square * c / (n * (n - 1))
        s = 1 - square * s / (n * (n + 1))
    s *= y
    if quarters % 2 != 0:
        c, s = -s, c
    return (-c, -s) if quarters % 4 > 1 else (c, s)


def delay(rough: Any, series: Any, a: float, b: float, room: Row) -> tuple[float, float]:
    """x with x + S = 0 at the phases (a + ν₁x, b + ν₂x), how far τ is from its mean at a physical time, and the slope
    of x + S there.

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
    return x, rate


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
