"""The compiled entry to :mod:`integrable.moving_point.short`, with double-doubles as wide numbers."""

from __future__ import annotations

import numpy as np

from integrable.moving_point.addition import Row
from integrable.moving_point.compiled import SPECIAL
from integrable.moving_point.short import UNSORTED
from integrable.moving_point.short import short_run as run
from integrable.moving_point.short_rows import FLOATS as FLOAT_ROOM
from integrable.moving_point.short_rows import GIVEN, MADE, Request, Rule, new_room
from integrable.moving_point.short_rows import WIDES as WIDE_ROOM
from integrable.moving_point.short_start import set_up
from jacobian.native.kinds import BOOL, FLOAT, FLOATS, INT, INTS, WIDES, ArrayKind, TupleKind, record
from jacobian.native.library import Library, Packed

RULE = record(Rule, FLOATS, FLOATS, FLOATS, INTS)


def entry(
    given: Row, tilted: bool, rule: Rule, asked: tuple[bool, bool, int, float, float],
    times: Row, order: Row, rows: Row, other: Row, work: tuple[Row, Row, Row],
) -> None:  # fmt: skip
    """Calls :func:`integrable.moving_point.short.short_run` for every row of ``given``, shape (K, 10). ``work`` comes
    from :func:`work_room`; ``asked`` are the first five fields of a :class:`Request`.

    γ and M are written to ``rows``, shape (K, 6N), and τ or physical times to ``other``, shape (K, N). The integers of
    ``work`` get K statuses (0, or the reason for failure), then K costs in panels. ``times`` and ``order`` have one row
    per motion, or one for all. With an empty ``order`` the ``times`` must ascend; otherwise the status is UNSORTED.
    """
    wide, floats, numbers = work
    count, members = times.shape[1], len(given)
    made, scaled = numbers[2 * members :], floats[FLOAT_ROOM:]
    ascending = made[MADE : MADE + count]
    for i in range(count if len(order) == 0 else 0):
        ascending[i] = i
        if i > 0 and times[0, i] < times[0, i - 1]:
            numbers[0], numbers[1] = UNSORTED, 0
            return
    for member in range(members):
        at = member % len(times)
        for i in range(GIVEN):
            wide[i] = given[member, i]
        made[0], made[1], made[2], made[3], made[4] = 0, 0, 0, 0, 0
        motion = set_up(wide[:GIVEN], tilted, wide[GIVEN:], floats)
        room = new_room(motion, wide[GIVEN:], floats, made)
        request = Request(
            asked[0], asked[1], asked[2], asked[3], asked[4], times[at], order[at] if len(order) > 0 else ascending,
            scaled[:count], scaled[count:], rows[member], other[member],
        )  # fmt: skip
        numbers[member] = run(room, rule, request, wide[:GIVEN], tilted)
        numbers[members + member] = made[3]
        # ``other`` is empty if the times are τ and t is not wanted
        if asked[0] or asked[1]:
            unit = motion.tau_unit if asked[0] else motion.time_unit
            for i in range(count):
                other[member, i] = other[member, i] / unit


def work_room(members: int, times: int) -> Packed:
    """Working memory for up to this many motions and times, to be reused by many calls."""
    wide, floats = np.empty((GIVEN + WIDE_ROOM, 2)), np.empty(FLOAT_ROOM + 2 * times)
    return Packed((wide, floats, np.empty(2 * members + MADE + times, dtype=np.intp)), WORK)


WORK = TupleKind((WIDES, FLOATS, INTS))
ORDER, _ROWS = ArrayKind(INT, 2), ArrayKind(FLOAT, 2)
LIBRARY = Library(
    "short_runs",
    {
        "entry": (
            entry,
            (
                _ROWS, BOOL, RULE, TupleKind((BOOL, BOOL, INT, FLOAT, FLOAT)), _ROWS,
                ORDER, _ROWS, _ROWS, WORK,
            ),
        )
    },
    SPECIAL,
)  # fmt: skip
