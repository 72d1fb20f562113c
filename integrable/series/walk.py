"""A walk along Taylor series, with straight-line code compiled for the kind of system (:mod:`integrable.series.kinds`).

The loop is compiled once for all kinds (:mod:`integrable.series.walk_compiled`). A row is the state at one of the times
asked for. Two walks run together as lanes of one vector. The second walk takes its own longer steps, from a start
changed by about a rounding unit; its first step is short and backwards. The difference of the walks estimates the error
of a row. A wider vector holds the walks of several motions, which do not affect each other.
"""

from __future__ import annotations

import ctypes
from math import floor, log2, sqrt
from typing import TYPE_CHECKING, NamedTuple

from integrable.series.room import BENT, FIRST, STEP, UNITS, WALKS
from integrable.series.walk_text import TIMES

if TYPE_CHECKING:
    from numpy import ndarray as Array

# larger than any time
FARTHEST = 1e300
# fraction of its first step that the second walk goes back: from the same expansion point both walks would have the
# same terms in floats, with the same errors
BACK = 0.25
# steps are multiples of GRAIN in the walk's unit of time, so that their sums, up to MOST_UNITS, are exact
GRAIN, MOST_UNITS = 2.0**-36, 2.0**16
# coefficients of order k and k + 2 give a time scale only if that of order k + 1 is at most NOISE times their geometric
# mean: otherwise one of them is the rounding error of a zero
NOISE = 2.0**30
# if the unit of time is between LEAST_UNIT and 1/LEAST_UNIT, no coefficient in the unit 1 leaves the range of floats
LEAST_UNIT = 2.0**-8
# a walk goes on if ``most`` further steps of UNEVEN times the present length would reach the last time; after KNOWN
# steps, if ``most`` further steps of the mean length would
UNEVEN, KNOWN = 4, 64
# a walk ends after more than MOST_LOST lost rows. A row is lost if it is wrong. A row later than 1/KNOWN_FROM of the
# last time is also lost if the difference of the walks, continued linearly in time, exceeds HOPELESS times the allowed
# difference in the last row
MOST_LOST, KNOWN_FROM, HOPELESS = 2, 16, 4.0
# compared rows are about APART steps apart
APART = 1.0
# marks of rows
UNVISITED, COMPARED, WRONG = -1.0, 1.0, 2.0
# in arrays, the length of Bounds, of the result of a walk (:func:`put_result`), and of the integers of a Course
BOUNDS, RESULTS, COUNTS = 6, 6, 9


class Codes(NamedTuple):
    """The addresses of the straight-line code of a kind (:mod:`integrable.series.walk_text`)."""

    start: int
    series: int
    ratios: int
    advance: int
    dense: int


class Bounds(NamedTuple):
    """Bounds on the terms of a walk's series, relative to q and to p. They determine the steps of the walk.

    ``left_out`` bounds the last two terms, ``rounded`` the first two whose coefficients are floats. In the second walk
    these bounds are ``coarser`` and ``rougher`` times as large. Rows on which both walks agree to ``agreed`` count as
    right. The bounds are used only for times up to ``farthest`` times the length of the first step.
    """

    left_out: float
    rounded: float
    coarser: float
    rougher: float
    agreed: float
    farthest: float = FARTHEST


class Layout(NamedTuple):
    """The reciprocals 1/(k + 1) as pairs (hi, lo), and the layout of the memory of a walk.

    The variables are ``parts`` parts (q, p and any others) of ``half`` numbers each. Coefficients begin at ``highs``;
    those of consecutive orders are ``apart`` vectors of ``lanes`` floats apart. At ``spare`` begins the memory for
    TIMES times and the states at them: the distances from the expansion point, then the variables.
    """

    units: Array
    half: int
    parts: int
    order: int
    highs: int
    wide: int
    spare: int
    apart: int
    lanes: int


class Given(NamedTuple):
    """The constants of a system and a state, in floats."""

    constants: Array
    state: Array


class Outputs(NamedTuple):
    """The times asked for, and the states ``found`` at them.

    A motion has two walks. ``both`` has the states of both in the rows that are compared, as high and low parts.
    ``marks`` is UNVISITED for rows that no walk has reached, WRONG for wrong rows, COMPARED for compared rows that are
    right, 0 for all other rows.
    """

    both: Array
    marks: Array
    times: Array
    found: Array


class Compared(NamedTuple):
    """The comparison of the first ``rows`` rows of both walks.

    ``wrong`` counts the comparisons that failed, ``lost`` those that failed or predict that the last one will.
    ``first`` is the number of rows up to the last compared row before the first lost one. ``gap`` is the largest
    difference of the walks, relative to the largest component of q, or of p.
    """

    rows: int
    wrong: int
    lost: int
    first: int
    gap: float


class Place(NamedTuple):
    """The lane of a walk, its time, the step that its series allow, and the first row that it has not written."""

    lane: int
    now: float
    step: float
    row: int


class Course(NamedTuple):
    """The progress of a motion, in its ``unit`` of time: ``limit`` rows are to be reached, and ``steps`` were taken.

    ``tier`` is the index of the :class:`Bounds` in use. The first walk is at the time ``now``, its next row is
    ``done``. The second walk is at ``later``, its next row is ``behind``. ``seen`` is the comparison of both.
    """

    unit: float
    tier: int
    limit: int
    steps: int
    now: float
    done: int
    later: float
    behind: int
    seen: Compared


class Many(NamedTuple):
    """The states of K motions with the same constants. ``ends`` are the indices of their first times, then the number
    of all times. For each motion ``tiers`` has the index of the first bounds to be tried, ``most`` the largest number
    of steps.
    """

    constants: Array
    states: Array
    ends: Array
    tiers: Array
    most: Array


class Slots(NamedTuple):
    """The motions whose walks are in the lanes of a vector: ``members`` are their numbers, −1 for none. ``counts`` and
    ``floats`` hold COUNTS integers and four floats for each motion, the fields of its :class:`Course`.
    """

    members: Array
    counts: Array
    floats: Array


def walked(
    codes: Codes, tiers: Array, layout: Layout, given: Given, room: Array, outputs: Outputs, tier: int, most: float
) -> tuple[int, int, int, float, int, int]:
    """The number of times reached, ``wrong``, ``lost`` and ``gap`` of :class:`Compared`, the number of steps, and the
    index of the bounds.

    ``tiers`` are :class:`Bounds` one after the other. The walk uses the first bounds from the index ``tier`` on whose
    ``farthest`` admits the last time. A walk that is estimated to need more than ``most`` further steps is given up.
    Times must be of one sign and ascend in size; otherwise the number of times reached is −1.
    """
    course = begun(codes, tiers, layout, given, room, 0, outputs, tier)
    goes = course.limit > 0
    while goes:
        course, goes = onward(codes, bounds_of(tiers, course.tier), layout, most, room, 0, course, outputs)
        if goes:
            all_moved(codes, room)
    seen = course.seen
    return seen.rows, seen.wrong, seen.lost, seen.gap, course.steps, course.tier


def walked_abreast(
    codes: Codes, tiers: Array, layout: Layout, many: Many, room: Array, outputs: Outputs, slots: Slots, found: Array
) -> None:
    """Writes the results of :func:`walked` for K motions, RESULTS numbers for each. Two lanes hold the walks of a
    motion; as soon as these end, those of the next motion begin.
    """
    following, going = 0, True
    while going:
        going = False
        for slot in range(len(slots.members)):
            member, lane, course, goes = slots.members[slot], WALKS * slot, course_in(slots, slot), False
            if member >= 0:
                own = of_member(layout, many, member, slot, outputs)
                bounds = bounds_of(tiers, course.tier)
                course, goes = onward(codes, bounds, layout, many.most[member], room, lane, course, own)
                put_result(found, member, course)
            while following < len(many.most) and not goes:
                member, following = following, following + 1
                own, width = of_member(layout, many, member, slot, outputs), layout.parts * layout.half
                given = Given(many.constants, many.states[member * width : (member + 1) * width])
                course = begun(codes, tiers, layout, given, room, lane, own, many.tiers[member])
                if course.limit > 0:
                    bounds = bounds_of(tiers, course.tier)
                    course, goes = onward(codes, bounds, layout, many.most[member], room, lane, course, own)
                put_result(found, member, course)
            slots.members[slot] = member if goes else -1
            put_course(slots, slot, course)
            going = going or goes
        if going:
            all_moved(codes, room)


def bounds_of(tiers: Array, tier: int) -> Bounds:
    x = tiers[BOUNDS * tier : BOUNDS * tier + BOUNDS]
    return Bounds(x[0], x[1], x[2], x[3], x[4], x[5])


def of_member(layout: Layout, many: Many, member: int, slot: int, outputs: Outputs) -> Outputs:
    """The part of ``outputs`` for one motion. All motions of a slot in turn use the same part of ``outputs.both``."""
    width, begin, end = layout.parts * layout.half, many.ends[member], many.ends[member + 1]
    share = len(outputs.both) // (layout.lanes // WALKS)
    both = outputs.both[slot * share : slot * share + 2 * WALKS * width * (end - begin)]
    times, found = outputs.times[begin:end], outputs.found[begin * width : end * width]
    return Outputs(both, outputs.marks[begin:end], times, found)


def put_result(found: Array, member: int, course: Course) -> None:
    row, seen = found[RESULTS * member : RESULTS * member + RESULTS], course.seen
    row[0], row[1], row[2], row[3], row[4], row[5] = (
        seen.rows, seen.wrong, seen.lost, seen.gap, course.steps, course.tier,
    )  # fmt: skip


def course_in(slots: Slots, slot: int) -> Course:
    n, x = slots.counts[COUNTS * slot : COUNTS * slot + COUNTS], slots.floats[4 * slot : 4 * slot + 4]
    return Course(x[0], n[8], n[0], n[1], x[1], n[2], x[2], n[3], Compared(n[4], n[5], n[6], n[7], x[3]))


def put_course(slots: Slots, slot: int, course: Course) -> None:
    n, x, seen = (
        slots.counts[COUNTS * slot : COUNTS * slot + COUNTS],
        slots.floats[4 * slot : 4 * slot + 4],
        course.seen,
    )
    x[0], x[1], x[2], x[3] = course.unit, course.now, course.later, seen.gap
    n[0], n[1], n[2], n[3] = course.limit, course.steps, course.done, course.behind
    n[4], n[5], n[6], n[7], n[8] = seen.rows, seen.wrong, seen.lost, seen.first, course.tier


def begun(
    codes: Codes, tiers: Array, layout: Layout, given: Given, room: Array, lane: int, outputs: Outputs, tier: int
) -> Course:
    """Begins the walks of a motion in this lane. If the times are not in order, or the last of them is too far for all
    bounds, the walks do not begin: no row is to be reached.
    """
    times, unit, limit, rows = outputs.times, 1.0, 0, 0
    if in_order(times):
        start(codes.start, given.constants, given.state, room, lane)
        unit = unit_of(codes, layout, room, lane)
        last = abs(times[len(times) - 1]) / unit
        while BOUNDS * tier < len(tiers):
            bounds = bounds_of(tiers, tier)
            if last <= bounds.farthest * reach(bounds, layout, room, lane):
                break
            tier += 1
        if BOUNDS * tier < len(tiers):
            limit = len(times)
            for row in range(limit):
                outputs.marks[row] = UNVISITED
    else:
        rows = -1
    return Course(unit, tier, limit, 0, 0.0, 0, 0.0, 0, Compared(rows, 0, 0, 0, 0.0))


def onward(
    codes: Codes, bounds: Bounds, layout: Layout, most: float, room: Array, lane: int, course: Course, outputs: Outputs
) -> tuple[Course, bool]:
    """Writes the rows that the series of both walks reach, and stores the next steps in memory. Returns the progress,
    and whether a walk takes a step.
    """
    unit, tier, limit, steps, now, done, later, behind, seen = course
    times, ahead = outputs.times, -1.0 if outputs.times[len(outputs.times) - 1] < 0 else 1.0
    first, second = reach(bounds, layout, room, lane), reach(bounds, layout, room, lane + 1)
    second = BACK * second if steps == 0 and second < FARTHEST else second
    done = put_rows(codes, layout, room, Place(lane, now, first, done), limit, 1 / unit, outputs)
    if done < limit and not goes_on(first, now, times[limit - 1] / unit, steps, most):
        limit = done
    behind = put_rows(codes, layout, room, Place(lane + 1, later, second, behind), limit, 1 / unit, outputs)
    if behind < limit and not goes_on(second, later, times[limit - 1] / unit, steps, most):
        limit = behind
    seen = compared(layout, bounds.agreed, seen, min(done, behind, limit), outputs)
    if seen.lost > MOST_LOST:
        # rows after the first lost one may agree by chance, so they are dropped
        seen, limit = Compared(seen.first, 0, seen.lost, seen.first, seen.gap), 0
    to_first = ahead * first if done < limit else 0.0
    to_second = (-ahead if steps == 0 else ahead) * second if behind < limit else 0.0
    room[layout.lanes * STEP + lane], room[layout.lanes * STEP + lane + 1] = to_first, to_second
    goes = done < limit or behind < limit
    steps += 1 if goes else 0
    return Course(unit, tier, limit, steps, now + to_first, done, later + to_second, behind, seen), goes


def all_moved(codes: Codes, room: Array) -> None:
    """Advances each walk by its step, and computes the series there."""
    execute(codes.advance, room)
    execute(codes.series, room)
    execute(codes.ratios, room)


def in_order(times: Array) -> bool:
    """Whether times are finite, of one sign, and in ascending size."""
    before = 0.0
    down = times[len(times) - 1] < 0
    for i in range(len(times)):
        time = -times[i] if down else times[i]
        if not before <= time < FARTHEST:
            return False
        before = time
    return True


def unit_of(codes: Codes, layout: Layout, room: Array, lane: int) -> float:
    """Computes the series of a motion at its start, and returns the unit of time.

    The unit is a power of two near the shortest time scale of q or p. So coefficients stay within the range of floats,
    and steps do not depend on the unit in which the motion is given.
    """
    put_unit(layout, room, lane, 1.0)
    execute(codes.series, room)
    unit, shortest = 1.0, shortest_time(layout, room, lane)
    while unit < shortest < FARTHEST:
        unit *= 2.0
    while unit > shortest:
        unit /= 2.0
    if unit != 1:
        put_unit(layout, room, lane, unit)
        if LEAST_UNIT <= unit <= 1 / LEAST_UNIT:
            to_unit(layout, room, lane, unit)
        else:
            execute(codes.series, room)
    execute(codes.ratios, room)
    return unit


def to_unit(layout: Layout, room: Array, lane: int, unit: float) -> None:
    """Multiplies the coefficients of order k of a motion's variables by unit^k."""
    lanes, apart, power = layout.lanes, layout.lanes * layout.apart, 1.0
    for k in range(layout.order + 1):
        high = lanes * layout.highs + k * apart + lane
        low = high + (layout.order + 1) * apart
        for i in range(layout.apart):
            for walk in range(WALKS):
                room[high + i * lanes + walk] *= power
                if k <= layout.wide:
                    room[low + i * lanes + walk] *= power
        power *= unit


def put_unit(layout: Layout, room: Array, lane: int, unit: float) -> None:
    """Writes unit/(k + 1), by which coefficient k + 1 of a variable follows from coefficient k of its rate."""
    lanes = layout.lanes
    high, low = lanes * UNITS + lane, lanes * (UNITS + layout.order) + lane
    for k in range(layout.order):
        for walk in range(WALKS):
            room[high + lanes * k + walk] = unit * layout.units[2 * k]
            if k <= layout.wide:
                room[low + lanes * k + walk] = unit * layout.units[2 * k + 1]


def shortest_time(layout: Layout, room: Array, lane: int) -> float:
    """The shortest time scale of q or p, estimated from their first Taylor coefficients for the unit of time 1."""
    shortest = FARTHEST
    for begin in (0, layout.half):
        for j in range(FIRST):
            # near rest every second coefficient is small, so coefficients two orders apart are compared
            before, after = largest(layout, room[lane:], begin, j), largest(layout, room[lane:], begin, j + 2)
            mean = sqrt(before) * sqrt(after)
            if 0 < mean < FARTHEST and largest(layout, room[lane:], begin, j + 1) <= NOISE * mean:
                shortest = min(shortest, sqrt(before) / sqrt(after))
    return shortest


def largest(layout: Layout, room: Array, begin: int, k: int) -> float:
    """The largest coefficient of order k of q (``begin`` = 0) or of p."""
    found = 0.0
    for i in range(begin, begin + layout.half):
        found = max(found, abs(room[layout.lanes * (layout.highs + i + k * layout.apart)]))
    return found


def reach(bounds: Bounds, layout: Layout, room: Array, lane: int) -> float:
    """The longest step for which four terms of a walk's series meet the bounds: the last two terms, and the first two
    of those whose coefficients are floats. The memory has the ratios of these coefficients to the size of the
    variables.

    0 if a ratio is not finite, or if all ratios underflow to 0. FARTHEST if the motion is exactly linear in time.
    """
    left_out, rounded, order, wide, lanes = bounds.left_out, bounds.rounded, layout.order, layout.wide, layout.lanes
    if lane % WALKS > 0:
        left_out, rounded = left_out * bounds.coarser, rounded * bounds.rougher
    before, last, odd, even = room[lane], room[lanes + lane], room[2 * lanes + lane], room[3 * lanes + lane]
    if not (before < FARTHEST and last < FARTHEST and odd < FARTHEST and even < FARTHEST):
        return 0.0
    if before == 0 and last == 0 and odd == 0 and even == 0:
        return FARTHEST if room[lanes * BENT + lane] == 0 else 0.0
    left_out, rounded = logarithm(left_out), logarithm(rounded)
    found = min((left_out - logarithm(before)) / (order - 1), (left_out - logarithm(last)) / order)
    if wide >= 0:
        found = min(found, (rounded - logarithm(odd)) / (wide + 1))
        found = min(found, (rounded - logarithm(even)) / (wide + 2))
    return float(floor(power(min(found, 25.0)) / GRAIN)) * GRAIN if found > -1000 else 0.0


def put_rows(codes: Codes, layout: Layout, room: Array, at: Place, limit: int, per: float, outputs: Outputs) -> int:
    """Writes the rows that the series of one walk reach, from its next row on; returns the first row that they do not
    reach. The second walk writes only the compared rows. ``per`` is the reciprocal of the unit of time.
    """
    ahead = room[layout.spare : layout.spare + (2 + 2 * layout.parts * layout.half) * TIMES]
    lane, now, step, row = at
    before, fitting = last_compared(outputs, row), TIMES
    while fitting == TIMES:
        fitting, begin = 0, row
        while fitting < TIMES and row < limit:
            time = outputs.times[row] * per
            left = time - now
            if not (step > 0 and abs(left) <= step):
                break
            if outputs.marks[row] == UNVISITED:
                outputs.marks[row] = mark_of(outputs, row, before + APART * step / per)
            if outputs.marks[row] > 0:
                before = abs(outputs.times[row])
            if lane % WALKS == 0 or outputs.marks[row] > 0:
                # the low part of the distance is the rounding error of time − now
                back = left - time
                ahead[fitting] = left
                ahead[TIMES + fitting] = (time - (left - back)) - (now + back)
                fitting += 1
            row += 1
        if fitting > 0:
            for i in range(fitting, TIMES):
                ahead[i] = ahead[0]
                ahead[TIMES + i] = ahead[TIMES]
            dense(codes.dense, room, lane, ahead)
            put_states(layout, ahead, lane, begin, fitting, outputs)
    return row


def last_compared(outputs: Outputs, row: int) -> float:
    """|t| of the last compared row before ``row``; 0 if there is none."""
    before = row - 1
    while before >= 0 and outputs.marks[before] == 0:
        before -= 1
    return abs(outputs.times[before]) if before >= 0 else 0.0


def mark_of(outputs: Outputs, row: int, farthest: float) -> float:
    """The mark of a row: COMPARED if the row is the last one, or if the next one is beyond ``farthest``; else 0."""
    last = row + 1 == len(outputs.times)
    return COMPARED if last or abs(outputs.times[row + 1]) > farthest else 0.0


def put_states(layout: Layout, ahead: Array, lane: int, row: int, fitting: int, outputs: Outputs) -> None:
    """Copies ``fitting`` states of a walk from ``ahead``, where :func:`dense` has written them, to ``outputs``.

    The first walk's states go to the rows of ``found`` from ``row`` on. Both walks' states at marked rows, the only
    ones that the second walk computes, go to ``both``.
    """
    width, second = layout.parts * layout.half, lane % WALKS
    for i in range(fitting):
        while second > 0 and outputs.marks[row] == 0:
            row += 1
        if second == 0:
            for part in range(width):
                outputs.found[row * width + part] = ahead[2 * (1 + part) * TIMES + i]
        if outputs.marks[row] > 0:
            place = 2 * (second * len(outputs.times) + row) * width
            for part in range(2 * width):
                outputs.both[place + part] = ahead[(2 + part) * TIMES + i]
        row += 1


def goes_on(step: float, now: float, last: float, steps: int, most: float) -> bool:
    """Whether about ``most`` further steps reach the time ``last``, estimated from the present or the mean step."""
    left, gone = abs(last - now), abs(now)
    if not (step > 0 and gone < MOST_UNITS):
        return False
    return left < UNEVEN * most * step if steps < KNOWN else steps * left < most * gone


def compared(layout: Layout, agreed: float, seen: Compared, limit: int, outputs: Outputs) -> Compared:
    """``seen``, continued up to row ``limit``; marks the wrong rows. A row that is not compared counts as wrong if the
    nearest compared row before or after it is wrong.
    """
    times, marks, last = outputs.times, outputs.marks, abs(outputs.times[len(outputs.times) - 1])
    rows, wrong, lost, first, worst = seen
    for row in range(seen.rows, limit):
        if marks[row] > 0:
            off, widest = row_gap(layout, agreed, row, outputs)
            if off or (rows > 0 and marks[rows - 1] == WRONG):
                for i in range(rows, row):
                    marks[i] = WRONG
            if off:
                marks[row] = WRONG
                wrong += 1
            worst = widest if not widest <= worst else worst
            # the walks' difference grows at least linearly in time: in the last row it is at least ``widest``·last/way
            way = abs(times[row])
            if off or (way * KNOWN_FROM > last and not widest * last <= HOPELESS * agreed * way):
                first = rows if lost == 0 else first
                lost += 1
            rows = row + 1
    return Compared(rows, wrong, lost, first, worst)


def row_gap(layout: Layout, agreed: float, row: int, outputs: Outputs) -> tuple[bool, float]:
    """Whether the two walks of a motion disagree in a row, and their largest difference there: each of the parts q, p
    and any further part is measured relative to its largest component.
    """
    half, width, count, both = layout.half, layout.parts * layout.half, len(outputs.times), outputs.both
    off, widest = False, 0.0
    for part in range(layout.parts):
        size, gap = 0.0, 0.0
        for i in range(part * half, (part + 1) * half):
            first, second = 2 * (row * width + i), 2 * ((row + count) * width + i)
            size = max(size, abs(both[first]))
            rest = abs((both[first] - both[second]) + (both[first + 1] - both[second + 1]))
            gap = rest if not rest <= gap else gap
        if not gap <= agreed * size:
            off = True
        gap = gap / size if size > 0 else gap
        widest = gap if not gap <= widest else widest
    return off, widest


# --- these functions are replaced by instructions when the loop is compiled: calls of the straight-line code of a
# kind of systems, and approximate logarithms from the bits of a float


def start(code: int, constants: Array, state: Array, room: Array, lane: int) -> None:
    """Writes the constants and the state of a motion to memory."""
    _called(code, constants, state, room[lane:])


def execute(code: int, room: Array) -> None:
    """Runs the ``code`` that computes the coefficients in memory or their ratios, or advances the state by a step."""
    _called(code, room)


def dense(code: int, room: Array, lane: int, ahead: Array) -> None:
    """Writes the states of a walk to ``ahead``, at the distances with which ``ahead`` begins."""
    _called(code, room[lane:], ahead)


def _called(code: int, *arrays: Array) -> None:
    ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * len(arrays))(code)(*(x.ctypes.data for x in arrays))


def logarithm(x: float) -> float:
    """The logarithm log₂ x to within 0.1; about −1000 for x = 0."""
    return log2(x) if x > 0 else -1023.0


def power(x: float) -> float:
    """The power 2^x to within 1 %."""
    return float(2.0**x)
