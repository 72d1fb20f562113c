"""States near the start of a motion, by Chebyshev panels. The same source is compiled or interpreted.

A panel is an interval of the flow's own time. The moving points at the centres of panels are kept in wide numbers. The
next few centres are computed together, each by one addition to the last centre of the previous group, and are restored
to their level set. A second motion on a slightly different level set, the shadow, shows how errors have grown. Each
node of a panel is reached from its centre by one addition in floats. States come from the interpolants of γ and
w = γ × M/|M|, and physical time from the antiderivative of 1/g.

A panel is halved where the last coefficients of its interpolants, or a jump between its ends and those of its
neighbours, require it. Where rounding requires it, its nodes are computed in wide numbers. Neighbouring panels share
only the additions of earlier centres, and a wrong sign of γ or w would show as a jump. So the signs on an accepted
panel are correct.

Wide numbers are double-doubles in compiled code (:mod:`integrable.moving_point.short_compiled`) and bare reals in
interpreted code (:mod:`integrable.moving_point.short_start`, :mod:`integrable.moving_point.short_steps`). All other
numbers are floats. Units are those of :class:`integrable.moving_point.problem.Problem`.
"""

from __future__ import annotations

from math import floor, frexp, ldexp

from integrable.moving_point.addition import Row, moving_point, put
from integrable.moving_point.problem import TIME_SCALE
from integrable.moving_point.short_reading import largest_drift, read_off
from integrable.moving_point.short_rows import (
    AHEAD,
    BEGIN,
    HALF,
    LEVELS,
    LOT,
    OFF,
    POINT,
    RATE,
    SHADOW,
    TIME_UNIT,
    Request,
    Rule,
    ShortRoom,
)  # fmt: skip
from integrable.moving_point.short_start import at_start, cast_shadow, scaled
from integrable.moving_point.short_steps import (
    contact_in_floats,
    go_ahead,
    moved_row,
    node_steps,
    node_values,
    panel_steps,
    wide_values,
)  # fmt: skip

# the length of a panel, before doublings, in basic steps (:meth:`integrable.moving_point.setup.Setup.step_length`)
LENGTH = 5.0
# a panel is doubled only while the body turns by at most this many radians on half of it
TURN = 1.7
# a panel is doubled at least this many times or not at all, because doubled panels need wide numbers
WORTHWHILE = 3
# upper bounds for a panel: TAIL for its last coefficients of γ, w and 1/g, STEP for the jump from the panel before.
# WIDE_STEP replaces STEP if the nodes are computed in wide numbers, since those of the panel before may be in floats
TAIL = 4e-15
STEP, WIDE_STEP = 2e-14, 6e-14
# cost of a panel with nodes in wide numbers, relative to a panel with nodes in floats
CAREFUL = 10
# INTEGRALS is the relative tolerance of H1 and H2 of returned states, CENTRE that of H2 at the centres of panels. Each
# centre is computed from an earlier one by an addition, which loses most digits near a cluster of branch points. Later
# centres have the same error, so that no jump between panels shows it
INTEGRALS, CENTRE = 1e-9, 1e-19
# short runs leave a motion to the torus if the largest moment I exceeds the least by less than (I + d)/CLOSEST, or if
# Chaplygin's transformation from the upright motion to γ and M multiplies errors by more than 4·STEEPEST
CLOSEST, STEEPEST = 4e4, 25.0
# the largest permitted distance of the shadow, which starts at OFF_BY (:mod:`integrable.moving_point.short_steps`)
APART = 2.0**-45
# after PACED panels the time per panel is known up to a factor of UNSTEADY; a run that cannot reach its end at that
# pace is abandoned
PACED, UNSTEADY = 32, 1.05
# a run under way may take more panels than planned, by the fraction 1/SPARE, because a run abandoned near its end would
# waste all its panels
SPARE = 4
# reasons to abandon a run: rounding in floats (ROUNDING), panels that do not converge (UNRESOLVED), too many panels
# (FAR), too few digits (LOST). UNSORTED times are a reason not to start it
ROUNDING, UNRESOLVED, FAR, LOST, UNSORTED = 1, 2, 3, 4, 5


def short_run(room: ShortRoom, rule: Rule, request: Request, given: Row, tilted: bool) -> int:
    """Computes the requested states of the motion from the moments, d, γ and M in ``given``. Returns 0, or the reason
    for failure.
    """
    motion, wide = room.motion, room.wide
    scaled(request.times, wide, TIME_UNIT if request.physical else TIME_SCALE, request.high, request.low)
    if not (motion.close <= CLOSEST and motion.lift <= STEEPEST):
        return LOST
    h = first_half(room)
    careful = room.made[4] > 0
    if too_far(room, request, h, request.most // CAREFUL if careful else request.most):
        return FAR
    cast_shadow(wide, room.ahead)
    if not panel_steps(room, h):
        return LOST
    status = run_both_ways(room, rule, request, h, careful)
    if status == ROUNDING and not careful and room.made[3] * CAREFUL <= request.most:
        far = too_far(room, request, h, request.most // CAREFUL)
        status = FAR if far else run_both_ways(room, rule, request, h, True)
    if status == 0 and not largest_drift(motion, request.out, len(request.times)) <= INTEGRALS:
        status = LOST
    at_start(given, tilted, request.times, request.out, request.other)
    return status


def first_half(room: ShortRoom) -> float:
    """Half the length of a panel of this motion. If branch points have very different sizes, panels can be far longer
    than basic steps; their length is then doubled while the body turns by at most TURN radians on half a panel.
    """
    h, most, longer = panel_half(room.motion.half_step), TURN * room.motion.radian, 0
    while longer < LEVELS and h * 2.0 ** (longer + 1) <= most:
        longer += 1
    room.made[4] = longer if longer >= WORTHWHILE else 0
    return h * 2.0 ** room.made[4]


def panel_half(reach: float) -> float:
    """Half the length of a panel, from half of a basic step. It is rounded to few digits, so that positions of panels
    are exact in floats.
    """
    mantissa, exponent = frexp(LENGTH * reach)
    return ldexp(floor(mantissa * 2**20) / 2**20, exponent)


def too_far(room: ShortRoom, request: Request, h: float, most: int) -> bool:
    """Whether the first or the last time is beyond the reach of ``most`` panels, by the bound of 1/g."""
    count = len(request.order)
    if count == 0:
        return False
    reach = 2 * h * (room.motion.fastest if request.physical else 1.0) * most
    first, last = abs(request.high[request.order[0]]), abs(request.high[request.order[count - 1]])
    return not (first <= reach and last <= reach)


def run_both_ways(room: ShortRoom, rule: Rule, request: Request, h: float, careful: bool) -> int:
    """Computes the requested states in both directions of time. Returns 0, or the reason for failure."""
    first = 0
    while first < len(request.order) and request.high[request.order[first]] < 0:
        first += 1
    status = one_way(room, rule, request, h, careful, first, 1) if first < len(request.order) else 0
    if status == 0 and first > 0:
        status = one_way(room, rule, request, h, careful, first - 1, -1)
    return status


def one_way(room: ShortRoom, rule: Rule, request: Request, h: float, careful: bool, i: int, sign: int) -> int:
    """:func:`run_both_ways` in one direction, from the ``i``-th time on."""
    for e in range(6):
        room.last[e] = room.point[BEGIN + e]
    room.sums[0], room.sums[1], room.sums[2] = 0.0, 0.0, 0.0
    most = request.most // CAREFUL if careful else request.most
    farthest = abs(request.high[request.order[len(request.order) - 1 if sign > 0 else 0]])
    level, n = 0, 0
    while 0 <= i < len(request.order):
        # ``n`` counts a halved panel as one; made[3] counts the cost of all its parts
        if n >= most + most // SPARE or room.made[3] > 2 * request.most:
            return FAR
        status = centre_after(room, n, sign)
        if status != 0:
            return status
        status, level, i = panel(room, rule, request, h, careful, n, level, i, sign)
        if status != 0:
            return status
        n += 1
        gone = room.sums[0] if request.physical else 2 * h * n
        if n == PACED and UNSTEADY * gone * most < n * farthest:
            return FAR
    # ``pace`` allows for the constant relative error of the rate in floats
    allowed = (request.drift + request.pace * abs(room.sums[0])) * abs(room.point[RATE])
    return 0 if abs(room.sums[2]) <= allowed else ROUNDING


def centre_after(room: ShortRoom, n: int, sign: int) -> int:
    """Writes the centre of the n-th panel to the first row of points, by one addition to an earlier centre. Returns 0,
    or LOST if wide numbers have too few digits.
    """
    place = (n + AHEAD - 1) % AHEAD
    if n == 0 or place == 0:
        go_ahead(room, n == 0, sign)
    put(moving_point(room.ahead, 10 * place), room.points, 0)
    for i in range(POINT):
        if not BEGIN <= i < OFF:
            room.point[i] = room.seen[POINT * place + i]
    return 0 if room.seen[POINT * place + SHADOW] <= APART else LOST


def panel(
    room: ShortRoom, rule: Rule, request: Request, h: float, careful: bool, n: int, hint: int, i: int, sign: int
) -> tuple[int, int, int]:
    """Computes the n-th panel, halved where necessary, at least ``hint`` times. Returns (status, the ``hint`` for the
    next panel, index of the next time).
    """
    level, place, least, status = 0, 0, LEVELS, 0
    while True:
        if level > 0:
            side = sign if place & 1 else -sign
            moved_row(room.wide, room.points, level - 1, room.steps, HALF - level, side, level, room.point)
        if level >= hint:
            status = piece(room, rule, request, h, careful, level, sign)
            if status == UNRESOLVED and level == LEVELS:
                return UNRESOLVED, least, i
            if status in (ROUNDING, LOST):
                return status, least, i
        if level < hint or status == UNRESOLVED:
            level, place, status = level + 1, 2 * place, 0
            continue
        least = min(least, level)
        half = h / 2.0**level
        left = 2 * h * n + 2 * half * place
        i = read_off(room, rule, request, left, half, i, sign)
        place += 1
        while level > 0 and place & 1 == 0:
            place >>= 1
            level -= 1
        if level == 0 or not 0 <= i < len(request.order):
            return 0, max(0, least - (n & 1)), i


def piece(room: ShortRoom, rule: Rule, request: Request, h: float, careful: bool, level: int, sign: int) -> int:
    """Computes the values at the nodes of one panel or part of it. Returns 0 if they are accurate, else the reason."""
    count = len(rule.nodes)
    begin = 10 * level * count
    if not room.point[OFF] <= CENTRE:
        return LOST
    while room.made[1] <= level:
        node_steps(room, rule, h)
    room.made[3] += 1
    if not careful:
        point = moving_point(room.point)
        motion = room.motion.f, room.motion.axes, contact_in_floats(room.wide)
        node_values(motion, point, room.nodes, begin, sign < 0, room.values, room.rates)
        tail, before = tails(room, rule, request)
        if tail <= TAIL and stepless(room, rule) <= STEP:
            return 0
        if tail < before / 4 and level < LEVELS:
            return UNRESOLVED
    room.made[3] += CAREFUL
    wide_values(room.wide, room.points, level, room.wide_nodes, begin, sign < 0, room.values, room.rates)
    tail, before = tails(room, rule, request)
    if not tail <= TAIL:
        return UNRESOLVED
    if stepless(room, rule) <= WIDE_STEP:
        return 0
    # halving reduces a jump between neighbouring panels only if the coefficients of the series still decrease
    return UNRESOLVED if tail < before / 4 and level < LEVELS else ROUNDING


def tails(room: ShortRoom, rule: Rule, request: Request) -> tuple[float, float]:
    """(the largest of the last coefficients, the largest of earlier ones), both multiplied by the ``lift`` of
    :class:`~integrable.moving_point.short_rows.FloatMotion`. The series are those of γ, w = γ × M/|M| and, if t(τ) is
    needed, 1/g divided by four times its mean.
    """
    count, tail, before = len(rule.nodes), 0.0, 0.0
    for e in range(6):
        last, earlier = two_ends(rule, room.values, e * count)
        # comparisons with NaN are false, so this form with ``not`` keeps a NaN
        tail = last if not last <= tail else tail
        before = max(before, earlier)
    if request.physical or request.clock:
        mean = 0.0
        for j in range(count):
            mean += room.rates[j] / count
        last, earlier = two_ends(rule, room.rates, 0)
        last, earlier = last / (4 * abs(mean)), earlier / (4 * abs(mean))
        tail = last if not last <= tail else tail
        before = max(before, earlier)
    return tail * room.motion.lift, before * room.motion.lift


def two_ends(rule: Rule, values: Row, place: int) -> tuple[float, float]:
    """The sums of the absolute values of the last two Chebyshev coefficients, and of the two four orders lower."""
    count, matrix = len(rule.nodes), rule.coefficients
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    for j in range(count):
        value = values[place + j]
        end = (j + 1) * count
        a += matrix[end - 1] * value
        b += matrix[end - 2] * value
        c += matrix[end - 5] * value
        d += matrix[end - 6] * value
    return abs(a) + abs(b), abs(c) + abs(d)


def stepless(room: ShortRoom, rule: Rule) -> float:
    """The largest jump of γ or w between the right end of the previous panel and the left end of this one, times
    ``lift`` of :class:`~integrable.moving_point.short_rows.FloatMotion`.
    """
    worst = 0.0
    for e in range(6):
        step = abs(room.values[e * len(rule.nodes) + LOT] - room.last[e])
        worst = step if not step <= worst else worst
    return worst * room.motion.lift
