"""The series of a clock from the spectrum of 1/g, on bare reals, compiled unchanged.

A spectrum is a flat array: for k = 0, …, rows/2 the coefficients of all (k, m) in the order of a discrete transform,
with real and imaginary parts alternating (:func:`jacobian.numbers.fourier.half_spectrum`). ``grid`` is the shape
(rows, columns) of the samples, powers of 2.
"""

from __future__ import annotations

from math import ceil, log2, sqrt
from typing import NamedTuple

from integrable.moving_point.addition import Real, Row
from jacobian.numbers.fourier import half_spectrum

# modes that no longer decrease, and are below this fraction of the largest, count as rounding errors
LEVEL = 1e-8
# the largest number of modes that are summed in numbers longer than floats. Ordinary bodies have fewer than 8 such
# modes, bodies whose moments differ by a factor of 10⁶ up to 90 (tests.fuzz flow). Each mode costs about 0.3 µs per
# time
MOST_LOUD = 400
# a mode by which a phase oscillates by more turns than this is in resonance: floats would invert the clock only to
# 1e-4 of a turn
MOST_SWING = 1e12


class Cutoffs(NamedTuple):
    """Thresholds of a clock's modes.

    A mode is kept if it exceeds ``noise`` times the largest or makes τ oscillate by more than ``least``, but never if
    it is below ``rounding`` times the largest. The rough series has the modes above ``rough`` times the mean rate.
    Modes by which τ oscillates by ``loud`` or more are summed separately.
    """

    rounding: float
    noise: float
    least: float
    rough: float
    loud: float


class Tables(NamedTuple):
    """Working memory. ``modes`` has four numbers for each mode, ``pairs`` the (k, m) of the loud ones. Lines and parts
    are those of three :class:`~integrable.torus.clock_loops.ClockSeries`: with all modes, with the larger ones (rough),
    and with all but the loud ones (quiet). ``counts`` has three numbers of the first series: the least m, and the
    numbers of rows and modes. The same three of the rough series follow, then the number of loud modes, or −1 − n if
    the n-th of ``modes`` is in resonance.
    """

    modes: Row
    lines: Row
    parts: Row
    rough_lines: Row
    rough_parts: Row
    quiet_parts: Row
    pairs: Row
    counts: Row


def spectrum_of_samples(
    samples: Row, grid: tuple[int, int], noise: tuple[float, float], circle: Row, rooms: tuple[Row, Row, Row], room: Row
) -> tuple[int, int]:
    """Writes the spectrum of samples on a grid to the last of ``rooms`` and returns its :func:`sizes_needed`. ``rooms``
    and ``circle`` are as for :func:`jacobian.numbers.fourier.half_spectrum`.
    """
    half_spectrum(samples, grid, circle, rooms[0], rooms[1], rooms[2])
    return sizes_needed(rooms[2], grid, noise, room)


def sizes_needed(values: Row, grid: tuple[int, int], noise: tuple[float, float], room: Row) -> tuple[int, int]:
    """:func:`integrable.torus.series.needed_sizes` of the spectrum ``values``.

    ``room`` holds rows/2 + columns/2 + 2 numbers.
    """
    rows, columns = grid
    height, width = rows // 2 + 1, columns // 2 + 1
    for k in range(height + width):
        room[k] = 0.0
    for k in range(height):
        for j in range(columns):
            x, y = float(values[2 * (k * columns + j)]), float(values[2 * (k * columns + j) + 1])
            m = height + min(j, columns - j)
            # most modes are below both maxima; this bound avoids their square roots
            if abs(x) + abs(y) > min(room[k], room[m]):
                size = size_of(x, y)
                room[k], room[m] = max(room[k], size), max(room[m], size)
    largest = 0.0
    for k in range(height):
        largest = max(largest, room[k])
    for k in range(height + width):
        room[k] = room[k] / largest
    return size_wanted(room, rows, noise[0]), size_wanted(room[height:], columns, noise[1])


def size_of(x: float, y: float) -> float:
    """|x + iy|."""
    return sqrt(x * x + y * y)


def size_wanted(modes: Row, size: int, noise: float) -> int:
    """The number of samples that resolve the modes to ``noise``. ``modes`` holds, for each k ≤ size/2, the largest mode
    of ±k relative to the largest of all; each entry is replaced by the maximum of it and the later ones.
    """
    half = size // 2
    for k in range(half - 1, -1, -1):
        modes[k] = max(modes[k], modes[k + 1])
    last = modes[half - max(1, size // 16)]
    if last < noise:
        return size
    if modes[half // 2] < min(LEVEL, 8 * last):
        # a mode's rounding errors decrease with the square root of the number of samples; 1/4 allows for their scatter
        ratio = last / noise
        return int(max(2.0 * size, 2.0 ** ceil(log2(size * ratio * ratio / 4))))
    known = 0
    for k in range(half + 1):
        if modes[k] > 32 * noise:
            known = k
    if known < 2:
        return 2 * size
    decay = log2(modes[known // 2] / modes[known]) / (known - known // 2)
    if decay <= 0:
        return 4 * size
    wanted = known + 2 * (log2(modes[known]) - log2(noise / 8)) / decay
    return int(min(max(2.0 * size, 2.0 ** ceil(log2(wanted))), 8.0 * size))


def clock_series(
    values: Row,
    grid: tuple[int, int],
    given: tuple[Row, tuple[int, int]],
    limits: Cutoffs,
    tables: Tables,
    loud: Row,
    pace: Row,
) -> tuple[float, float, float, float]:
    """Writes S with dS/dτ = (1/g − mean)/mean, from the spectrum of 1/g, to ``tables``.

    Returns four numbers. The first is a bound of |S|. The second is minus the sum of all modes at the start, which
    makes S vanish there; the third is the same without the modes in ``loud``. The last is the mean of the samples of
    1/g divided by the true mean, 1 up to rounding. ``given`` has the numbers (turns of phase 1 and of phase 2 per unit
    of τ, mean of 1/g, 2π), then the periods of 1/g in both phases, in turns. ``loud`` and ``pace`` are filled for
    :class:`integrable.torus.clock_loops.Clock`.
    """
    columns, (turns, doubled) = grid[1], given
    nu1, nu2, mean = turns[0], turns[1], turns[2]
    pace[0], pace[1], pace[2], pace[3], pace[4], pace[5] = nu1 / mean, nu2 / mean, nu1, nu2, 1 / mean, mean
    # (rate of phase 1, rate of phase 2, mean of 1/g, 2π); rates are in periods of 1/g per unit of τ
    rates = nu1 / doubled[0], nu2 / doubled[1], mean, turns[3]
    resonant, bound, swing = swings(values, grid, rates, limits, tables)
    tables.counts[6] = -1 - resonant
    if resonant >= 0:
        return bound, swing, swing, bound
    rough = packed_modes(tables, grid, limits.rough, tables.rough_lines, tables.rough_parts)
    series = packed_modes(tables, grid, 0.0, tables.lines, tables.parts)
    count, rest = part_loud(values, columns, rates, limits.loud, series, tables, loud)
    for n in range(3):
        tables.counts[n], tables.counts[3 + n] = series[n], rough[n]
    tables.counts[6] = count
    return bound + abs(swing), -swing, -rest, float(values[0] / mean)


def part_loud(
    values: Row, columns: int, rates: Row, least: float, series: tuple[int, int, int], tables: Tables, loud: Row
) -> tuple[int, float]:
    """Moves the modes by which τ oscillates by ``least`` or more from the quiet series to ``loud``. ``least`` is
    doubled until at most MOST_LOUD modes are moved. Returns their number, and the sum of the quiet modes at the start.
    """
    lines, parts, total, count = tables.lines, tables.quiet_parts, series[2], MOST_LOUD + 1
    for n in range(4 * total):
        parts[n] = tables.parts[n]
    while count > MOST_LOUD:
        count = 0
        for n in range(total):
            if size_of(parts[n], parts[total + n]) >= least:
                count += 1
        if count > MOST_LOUD:
            least = 2 * least
    loud[0] = 0 * rates[3]
    count, rest = 0, 0.0
    for k in range(series[1]):
        for n in range(lines[3 * k + 1], lines[3 * k + 2]):
            if size_of(parts[n], parts[total + n]) < least:
                rest += parts[n]
                continue
            m = series[0] + lines[3 * k] + n - lines[3 * k + 1]
            x, y = swing_of(values, columns, k, m, rates)
            tables.pairs[2 * count], tables.pairs[2 * count + 1] = k, m
            loud[1 + 2 * count], loud[2 + 2 * count] = x, y
            loud[0] = loud[0] - x
            count += 1
            for part in range(4):
                parts[part * total + n] = 0.0
    return count, rest


def swing_of(values: Row, columns: int, k: int, m: int, rates: Row) -> tuple[Real, Real]:
    """The coefficient for the modes ±(k, m) of the S of :func:`clock_series`: the coefficient of 1/g, divided by the
    mode's rate and by the mean of 1/g.
    """
    n = 2 * (k * columns + (m if m >= 0 else m + columns))
    factor = 2 / (rates[3] * (k * rates[0] + m * rates[1]) * rates[2])
    return values[n + 1] * factor, -values[n] * factor


def swings(values: Row, grid: tuple[int, int], rates: Row, limits: Cutoffs, tables: Tables) -> tuple[int, float, float]:
    """Computes the modes of the S of :func:`clock_series`. Returns (−1 or the place of a mode in resonance,
    Σ|coefficients of S|, the sum of the modes at the start). ``tables.modes`` receives four coefficients of S and dS/dτ
    for each mode, zeros for those dropped; ``tables.lines`` receives where the kept modes of each k begin and end.
    """
    (rows, columns), modes, lines = grid, tables.modes, tables.lines
    half, bound, total, largest = columns // 2, 0.0, 0.0, 0.0
    for n in range(rows * columns):
        largest = max(largest, abs(float(values[n])))
    mean, pace, small = float(rates[2]), float(rates[3] * rates[2]), limits.rounding * largest
    most = abs(float(rates[0])) + abs(float(rates[1]))
    for k in range(rows // 2):
        begin, end = columns, 0
        # a mode stands for its conjugate too: hence the factor 2, and only m > 0 in the row k = 0
        for i in range(half + 1 if k == 0 else 0, columns):
            m = i - half
            n = 2 * (k * columns + (m if m >= 0 else m + columns))
            x, y = 2 * float(values[n]), 2 * float(values[n + 1])
            # most modes are far below the threshold; this bound avoids their square roots
            if abs(x) + abs(y) <= small or size_of(x, y) <= small:
                continue
            turns, size = k * rates[0] + m * rates[1], size_of(x, y)
            if size * most >= MOST_SWING * abs(float(turns) * pace):
                return k * columns + i, 0.0, 0.0
            factor = 1 / (float(turns) * pace)
            p, q, swing = y * factor, -x * factor, size * abs(factor)
            if size <= limits.noise * largest and swing <= limits.least:
                continue
            if swing >= limits.loud / 2:
                s, t = swing_of(values, columns, k, m, rates)
                p, q = float(s), float(t)
            begin = min(begin, i)
            for place in range(4 * (k * columns + max(begin, end)), 4 * (k * columns + i)):
                modes[place] = 0.0
            place, end = 4 * (k * columns + i), i + 1
            modes[place], modes[place + 1], modes[place + 2], modes[place + 3] = p, q, x / mean, y / mean
            bound += swing
            total += p
        lines[3 * k], lines[3 * k + 1] = min(begin, end), end
    return -1, bound, total


def packed_modes(tables: Tables, grid: tuple[int, int], least: float, lines: Row, parts: Row) -> tuple[int, int, int]:
    """Packs those modes left by :func:`swings` whose coefficient of dS/dτ exceeds ``least``, in the layout of
    :class:`~integrable.torus.clock_loops.ClockSeries`. Returns the least m, and the numbers of rows and modes.
    """
    (height, columns), modes = (grid[0] // 2, grid[1]), tables.modes
    low, used, total = columns, 1, 0
    for k in range(height):
        begin, end = columns, 0
        for i in range(tables.lines[3 * k], tables.lines[3 * k + 1]):
            n = 4 * (k * columns + i)
            if size_of(modes[n + 2], modes[n + 3]) > least:
                begin, end = min(begin, i), i + 1
        lines[3 * k], lines[3 * k + 1] = min(begin, end), end
        if end > 0:
            low, used, total = min(low, begin), k + 1, total + end - begin
    place = 0
    for k in range(used):
        begin, end = lines[3 * k], lines[3 * k + 1]
        lines[3 * k], lines[3 * k + 1] = max(0, begin - low), place
        for i in range(begin, end):
            n = 4 * (k * columns + i)
            inside = size_of(modes[n + 2], modes[n + 3]) > least
            for part in range(4):
                parts[part * total + place] = modes[n + part] if inside else 0.0
            place += 1
        lines[3 * k + 2] = place
    return low - columns // 2, used, total
