"""The angles of points in their ovals at many times: loops over bare reals, compiled unchanged.

For each oval there is a sum of integrals that grows by 2π with the angle φ of this oval. It is periodic in all other
angles:

    2πθ_j = φ_j + Σ_k S_kj(φ_k),    S_kj a sine series.

The phases θ are linear in time (:mod:`integrable.portrait.separated`). Newton's method finds the angles in
floats, for eight times at once. One more step with sums in double-doubles doubles the digits. The derivative of θ by φ
has positive principal minors, because no combination of m of the forms vanishes at points of m ovals. So elimination
needs no pivots.
"""

from __future__ import annotations

from typing import NamedTuple

from integrable.moving_point.addition import Real, Row
from integrable.torus.clock_loops import greatest
from integrable.torus.states import whole_turns
from integrable.torus.theta_series import circle
from jacobian.native.kinds import EIGHTS, FLOATS, INT, INTS, WIDE_EIGHTS, WIDES, record
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL
from jacobian.numbers.abreast import abreast
from jacobian.numbers.sums import joined, plus_product

# in the first series of Newton's method modes are at least ROUGH radians, and it ends after a step below NEAR. In the
# second they are at least FINE, and it ends after a step below LAST: then the error is about the square of the step.
# The step with sums in double-doubles is at most CORRECTED
ROUGH, NEAR, FINE, LAST, MOST_EVALUATIONS, CORRECTED = 1e-5, 1e-3, 1e-17, 1e-8, 200, 1e-10
# modes below SMALL radians are summed in floats, modes below NEGLIGIBLE are omitted
SMALL, NEGLIGIBLE = 2.0**-26, 1e-24
SERIES = (ROUGH, SMALL, FINE, NEGLIGIBLE)


class PhaseSums(NamedTuple):
    """The sine series of g sums as in the module's docstring, then of any further sums, angles about an axis.

    ``waves`` has a row of all sums for each mode n = 1, 2, … of each oval; ``rough`` has the same in floats, each
    followed by its product with n. ``bounds`` has five numbers for each oval: its first row, and where the modes end
    that are larger than each of SERIES. The phases, in turns, are ``places`` + ``frequencies``·t. A further angle is 2π
    times its phase plus its series. ``inverse`` and ``circle`` are those of
    :class:`integrable.torus.clock_loops.Clock`.
    """

    waves: Row
    rough: Row
    bounds: Row
    places: Row
    frequencies: Row
    inverse: Row
    circle: Row


class PhaseRoom(NamedTuple):
    """The memory for the times that are computed together. Each item holds the numbers of all lanes; ``lengths`` has
    one number for each lane.

    ``rests`` are the phases minus the nearest integers. ``halves`` are cos ½φ and sin ½φ, ``totals`` the sums in
    double-doubles. ``gaps`` are the differences of the sums from the phases, later the Newton steps, and ``slopes`` the
    derivatives of all sums by each angle. ``steps`` are the previous steps, ``factors`` the :func:`eliminate` of the
    slopes before them, and ``trials`` the Newton steps with these factors.
    """

    rests: Row
    halves: Row
    totals: Row
    signs: Row
    angles: Row
    gaps: Row
    slopes: Row
    steps: Row
    factors: Row
    trials: Row
    lengths: Row


def points_at_times(sums: PhaseSums, times: Row, room: PhaseRoom, out: Row) -> bool:
    """Writes sin ½φ and cos ½φ of each point at ``times`` to two rows of ``out``, with the signs after whole turns,
    then a row for each further angle. Returns whether Newton's method has converged.
    """
    count, lanes, genus, converged = len(times), len(room.lengths), len(sums.bounds) // 5, True
    begin = 0
    while begin < count:
        end = min(begin + lanes, count)
        for i in abreast(begin, end):
            for j in range(len(sums.places)):
                rest, whole = whole_turns(sums.places[j] + sums.frequencies[j] * times[i] + 0.5)
                room.rests[j], room.signs[j] = rest - 0.5, 1.0 - 2.0 * (whole % 2)
        converged = found_angles(sums, room) and converged
        put_corrected(sums, room)
        converged = greatest(room.lengths) <= CORRECTED and converged
        for i in abreast(begin, end):
            for k in range(genus):
                out[count * 2 * k + i], out[count * (2 * k + 1) + i] = room.halves[2 * k + 1], room.halves[2 * k]
            for j in range(genus, len(sums.places)):
                out[count * (genus + j) + i] = room.totals[j]
        begin = end
    return converged


def angles_at_phases(sums: PhaseSums, phases: Row, room: PhaseRoom, out: Row) -> bool:
    """Writes the angle φ of each point to a row of ``out``, then the series of each further sum, all in floats.
    ``phases`` has a row for each oval, of numbers from −½ to ½. Returns whether Newton's method has converged.
    """
    lanes, genus, converged = len(room.lengths), len(sums.bounds) // 5, True
    count, begin = len(phases) // genus, 0
    while begin < count:
        end = min(begin + lanes, count)
        for i in abreast(begin, end):
            for k in range(genus):
                room.rests[k] = phases[count * k + i]
        converged = found_angles(sums, room) and converged
        # the series at angles that one more step improves
        put_gaps(sums, room, 3)
        eliminate(room.slopes, genus)
        substitute(room.slopes, room.gaps, genus)
        for i in abreast(begin, end):
            for k in range(genus):
                out[count * k + i] = room.angles[k] - room.gaps[k]
            for j in range(genus, len(sums.places)):
                series = room.gaps[j]
                for k in range(genus):
                    series -= room.slopes[genus * j + k] * room.gaps[k]
                out[count * j + i] = series
        begin = end
    return converged


def found_angles(sums: PhaseSums, room: PhaseRoom) -> bool:
    """Finds the ``angles`` in floats from the ``rests``. Returns whether Newton's method has converged."""
    for k in range(len(sums.bounds) // 5):
        room.angles[k] = sums.circle[0] * float(room.rests[k])
    find_angles(sums, room, 1, NEAR)
    return find_angles(sums, room, 3, LAST)


def find_angles(sums: PhaseSums, room: PhaseRoom, series: int, last: float) -> bool:
    """Finds the ``angles`` in floats by Newton's method, which ends after a whole step below ``last``. Returns whether
    it has converged. ``series`` is the number of :func:`put_gaps`.

    A step is halved until a step with the same derivative would be shorter after it (Deuflhard 2004, the natural
    monotonicity test). The next step is at most four times as large a part of Newton's step.
    """
    genus, angles, steps, lengths = len(sums.bounds) // 5, room.angles, room.steps, room.lengths
    zero = 0 * room.signs[0]
    length, whole, part, limit = zero + 1, zero, zero + 1, zero + 1e300
    for n in range(genus * genus):
        room.factors[n] = zero + (1.0 if n % (genus + 1) == 0 else 0.0)
    for _ in range(MOST_EVALUATIONS):
        put_gaps(sums, room, series)
        size = tried(room, genus, limit)
        share, moved = part / 2, whole
        if size <= limit:
            share, moved = min(4 * part, 1 + zero), largest_of(room.gaps, genus)
        for k in range(genus):
            angle, step = angles[k], steps[k] + zero
            # a solved angle is left as it is, so that a state does not depend on the other times
            if length > last:
                if size <= limit:
                    step = share * room.gaps[k]
                    angle -= step
                else:
                    step = step / 2
                    angle += step
            angles[k], steps[k] = angle, step
        if length > last:
            part, whole, limit, length = share, moved, (1 - share / 4) * moved, moved + (1 - share)
        for i in abreast(0, len(lengths)):
            lengths[i] = length
        if greatest(lengths) <= last:
            return True
    return False


def tried(room: PhaseRoom, genus: int, limit: Real) -> Real:
    """The length of the step from the ``gaps`` with the old ``factors``. Where it is at most ``limit``, the ``slopes``
    give the new factors. Replaces the gaps by the step with these.
    """
    for k in range(genus):
        room.trials[k] = room.gaps[k]
    substitute(room.factors, room.trials, genus)
    size = largest_of(room.trials, genus)
    eliminate(room.slopes, genus)
    for n in range(genus * genus):
        factor = room.factors[n]
        if size <= limit:
            factor = room.slopes[n]
        room.factors[n] = factor
    substitute(room.factors, room.gaps, genus)
    return size


def largest_of(values: Row, count: int) -> Real:
    """The largest absolute value of the first ``count`` numbers."""
    found = abs(values[0])
    for k in range(1, count):
        found = max(found, abs(values[k]))
    return found


def put_gaps(sums: PhaseSums, room: PhaseRoom, series: int) -> None:
    """Writes the differences of the sums at the ``angles`` from 2π times the phases, and the derivatives of all sums,
    in floats. They are sums of the modes up to number ``series`` of ``bounds``.
    """
    bounds, gaps, slopes, turn = sums.bounds, room.gaps, room.slopes, sums.circle[0]
    genus, width, zero = len(bounds) // 5, len(sums.places), 0 * room.signs[0]
    for j in range(width):
        gaps[j] = zero
    for k in range(genus):
        gaps[k] += room.angles[k] - turn * float(room.rests[k])
        for j in range(width):
            slopes[genus * j + k] = zero
        slopes[(genus + 1) * k] = zero + 1
        c, s = circle(room.angles[k] / turn, sums.circle)
        a, b = c, s
        for row in range(bounds[5 * k], bounds[5 * k + series]):
            for j in range(width):
                n = 2 * (width * row + j)
                gaps[j] += sums.rough[n] * b
                slopes[genus * j + k] += sums.rough[n + 1] * a
            a, b = a * c - b * s, a * s + b * c


def eliminate(slopes: Row, genus: int) -> None:
    """Replaces a square matrix by its triangular factors, the lower one with 1 on the diagonal."""
    for k in range(genus):
        over = 1 / slopes[(genus + 1) * k]
        for n in range(k + 1, genus):
            ratio = slopes[genus * n + k] * over
            slopes[genus * n + k] = ratio
            for m in range(k + 1, genus):
                slopes[genus * n + m] -= ratio * slopes[genus * k + m]


def substitute(factors: Row, values: Row, genus: int) -> None:
    """Replaces the first ``values`` y by the solution x of Ax = y; ``factors`` are those of A by :func:`eliminate`."""
    for n in range(genus):
        for k in range(n):
            values[n] -= factors[genus * n + k] * values[k]
    for k in range(genus - 1, -1, -1):
        for m in range(k + 1, genus):
            values[k] -= factors[genus * k + m] * values[m]
        values[k] /= factors[(genus + 1) * k]


def put_corrected(sums: PhaseSums, room: PhaseRoom) -> None:
    """Writes ``halves`` and the further angles in double-doubles, from the angles in floats by one Newton step, and the
    ``lengths`` of this step.
    """
    genus, turn = len(sums.bounds) // 5, sums.inverse[0]
    put_gaps(sums, room, 3)
    for k in range(genus):
        angle = room.angles[k] + 0 * turn
        room.halves[2 * k], room.halves[2 * k + 1] = circle(angle / (2 * turn), sums.inverse)
        room.totals[k] = angle - turn * room.rests[k]
    for j in range(genus, len(sums.places)):
        room.totals[j] = turn * room.rests[j]
    add_swings(sums, room)
    for k in range(genus):
        room.gaps[k] = float(room.totals[k])
    eliminate(room.slopes, genus)
    substitute(room.slopes, room.gaps, genus)
    for k in range(genus):
        late, c, s = room.gaps[k] / 2, room.signs[k] * room.halves[2 * k], room.signs[k] * room.halves[2 * k + 1]
        near = (0 * c + 1) - late * late / 2
        room.halves[2 * k], room.halves[2 * k + 1] = c * near + s * late, s * near - c * late
        for j in range(genus, len(sums.places)):
            room.totals[j] -= room.slopes[genus * j + k] * room.gaps[k]
    for i in abreast(0, len(room.lengths)):
        room.lengths[i] = largest_of(room.gaps, genus)


def add_swings(sums: PhaseSums, room: PhaseRoom) -> None:
    """Adds the series at the ``angles``, of which ``halves`` are the cosines and sines, to the ``totals``."""
    bounds, totals, width = sums.bounds, room.totals, len(sums.places)
    for k in range(len(bounds) // 5):
        a, b = room.halves[2 * k], room.halves[2 * k + 1]
        # the sines of nφ by a recurrence of three terms, and e^{inφ} of small modes in floats
        twice, last, sine = 2 * (a * a - b * b), 0 * a, 2 * a * b
        begin, fine = bounds[5 * k], bounds[5 * k + 2]
        for row in range(begin, fine):
            for j in range(width):
                totals[j] = plus_product(totals[j], sums.waves[width * row + j], sine)
            last, sine = sine, twice * sine - last
        c, s = circle(room.angles[k] / sums.circle[0], sums.circle)
        p, q = circle((fine - begin + 1) * (room.angles[k] / sums.circle[0]), sums.circle)
        for j in range(width):
            room.gaps[j] = 0 * p
        for row in range(fine, bounds[5 * k + 4]):
            for j in range(width):
                room.gaps[j] += sums.rough[2 * (width * row + j)] * q
            p, q = p * c - q * s, p * s + q * c
        for j in range(width):
            totals[j] = joined(totals[j], room.gaps[j] + 0 * a)


def put_modes(samples: Row, nodes: int, matrix: Row, inverse: Row, room: Row, out: Row) -> None:
    """Writes the series of all sums on one oval to ``out``, in the order of ``waves`` (:class:`PhaseSums`).

    ``samples`` has a row for each form: its coefficients of dφ at φ = π(k + ½)/n, with n ``nodes``. Row i of the
    ``matrix`` has the parts of form i in all sums.
    """
    width = len(samples) // nodes
    for row in abreast(0, nodes - 1):
        n = 0 * inverse[0] + (row + 1)
        c, s = circle(n / (4 * nodes), inverse)
        twice = 2 * (c * c - s * s)
        for j in range(width):
            last, now = 0 * c, 0 * c
            for k in range(nodes - 1, -1, -1):
                last, now = now, (samples[nodes * j + k] - last) + twice * now
            room[width * row + j] = c * (now - last) * 2 / (n * nodes)
        for j in range(width):
            total = 0 * c
            for k in range(width):
                total += room[width * row + k] * matrix[width * k + j]
            out[width * row + j] = total


SUMS = record(PhaseSums, WIDES, FLOATS, INTS, *(WIDES,) * 3, FLOATS)
ROOM = record(PhaseRoom, *(WIDE_EIGHTS,) * 3, *(EIGHTS,) * 7, FLOATS)
LIBRARY = Library(
    "phases",
    {
        "points_at_times": (points_at_times, (SUMS, FLOATS, ROOM, WIDES)),
        "angles_at_phases": (angles_at_phases, (SUMS, FLOATS, ROOM, FLOATS)),
        "put_modes": (put_modes, (WIDES, INT, *(WIDES,) * 4)),
    },
    SPECIAL,
)
