"""Short runs compiled from :mod:`integrable.moving_point.short`, wide numbers being double-doubles: one entry."""

from __future__ import annotations

from integrable.moving_point.compiled import SPECIAL
from integrable.moving_point.short import short_run as run
from integrable.moving_point.short_rows import (
    CLOCK,
    GIVEN,
    PHYSICAL,
    Request,
    Row,
    Rule,
    new_room,
)  # fmt: skip
from integrable.moving_point.short_rows import FLOATS as FLOAT_ROOM
from jacobian.native.kinds import BOOL, FLOAT, FLOATS, INT, INTS, WIDES, ArrayKind, TupleKind, record
from jacobian.native.library import Library

RULE = record(Rule, FLOATS, FLOATS, FLOATS, INTS)


def entry(
    given: Row, tilted: bool, rule: Rule, asked: tuple[bool, bool, int, float, float, float, int], centres: Row,
    times: Row, order: Row, rows: Row, other: Row, wide: Row, floats: Row, numbers: Row,
) -> None:  # fmt: skip
    """:func:`integrable.moving_point.short.short_run` for every row of ``given``, of shape (K, 10); the last three are
    room. ``asked`` and ``centres`` are those of a :class:`Request`. Found are γ and M in ``rows``, shape (K, 6N), the
    ``other`` times, (K, N), and first in ``numbers`` why each was given up, or 0, then what each has cost in panels.
    ``times`` and ``order`` have a row for each, or one for all.
    """
    count, members = times.shape[1], len(given)
    made, scaled = numbers[2 * members :], floats[FLOAT_ROOM:]
    for member in range(members):
        at = member % len(times)
        for i in range(GIVEN):
            wide[i] = given[member, i]
        made[0], made[1], made[2], made[3], made[4] = 0, 0, 0, 0, 0
        room = new_room(wide[GIVEN:], floats, made)
        request = Request(
            asked[0], asked[1], asked[2], asked[3], asked[4], times[at], order[at], scaled[:count], scaled[count:],
            rows[member], other[member], asked[5], asked[6], centres,
        )  # fmt: skip
        numbers[member] = run(room, rule, request, wide[:GIVEN], tilted)
        numbers[members + member] = made[3]
        # without a clock there is nothing in ``other``
        if asked[0] or asked[1]:
            unit = room.numbers[CLOCK if asked[0] else PHYSICAL]
            for i in range(count):
                other[member, i] = other[member, i] / unit


CENTRES, _ROWS, _INT_ROWS = WIDES, ArrayKind(FLOAT, 2), ArrayKind(INT, 2)
LIBRARY = Library(
    "short_runs",
    {
        "entry": (
            entry,
            (
                _ROWS, BOOL, RULE, TupleKind((BOOL, BOOL, INT, FLOAT, FLOAT, FLOAT, INT)), CENTRES, _ROWS,
                _INT_ROWS, _ROWS, _ROWS, WIDES, FLOATS, INTS,
            ),
        )
    },
    SPECIAL,
)  # fmt: skip
