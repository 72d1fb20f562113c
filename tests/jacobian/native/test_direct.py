"""Entries that read Python's objects: each gives what the same function gives in Python."""

import pytest

from jacobian.native.direct import BYTES, Objects, Rows, Scratch
from jacobian.native.kinds import INT, INTS, LONG, ArrayKind, CompileError, TupleKind
from jacobian.native.library import Library


def total_of_longs(a, b, c):
    return a + b + c, 7


def of_tuples(n, pair, triple):
    (a, b), (c, d, e) = pair, triple
    return (n * a + c, (b - d, e)), n > a


def of_bytes(text, room, rows):
    total = 0
    for i in range(len(text)):
        total += text[i] << i
        room[i] = total
    rows[1, 2] = rows[0, 0] + len(room)


def reversed_in(pair, scratch):
    for i in range(2):
        scratch[0, i] = pair[i]
    return scratch[0, 1], scratch[0, 0], scratch.shape[1]


PAIR, TRIPLE = TupleKind((INT,) * 2), TupleKind((INT,) * 3)
LIBRARY = Library(
    "test_direct",
    {
        "total_of_longs": (total_of_longs, (LONG, Objects((LONG, LONG)))),
        "of_tuples": (of_tuples, (INT, Objects((PAIR, TRIPLE)))),
        "of_bytes": (of_bytes, (Objects((BYTES, INTS, Rows(2)), unlocked=True),)),
        "reversed_in": (reversed_in, (Objects((TupleKind((LONG,) * 2), Scratch(ArrayKind(LONG, 2, 2), (1, 5)))),)),
    },
)


def test_longs():
    first = LIBRARY.total_of_longs(2**100)
    assert first(1, 2**64) == total_of_longs(2**100, 1, 2**64) == (2**100 + 2**64 + 1, 7)
    assert LIBRARY.total_of_longs(5)(0, 0) == (5, 7)
    # each function keeps its own leading arguments
    assert first(0, 0) == (2**100, 7)


def test_tuples():
    for n in (0, -3, 2**40):
        assert LIBRARY.of_tuples(n)((5, -6), (1, 2, 3)) == of_tuples(n, (5, -6), (1, 2, 3))


def test_memory_of_the_caller():
    room, rows = bytearray(8 * 4), bytearray(8 * 2 * 3)
    rows[:8] = (100).to_bytes(8, "little")
    LIBRARY.of_bytes()(b"abc", room, rows)
    words = [int.from_bytes(room[k : k + 8], "little") for k in range(0, 32, 8)]
    assert words == [97, 97 + 2 * 98, 97 + 2 * 98 + 4 * 99, 0]
    assert int.from_bytes(rows[40:], "little") == 104


def test_memory_on_the_stack():
    assert LIBRARY.reversed_in()((2**90, 3)) == (3, 2**90, 5)


def test_other_objects_raise_the_errors_of_python():
    entry = LIBRARY.of_tuples(1)
    with pytest.raises(TypeError):
        entry(("a", 1), (1, 2, 3))
    with pytest.raises(OverflowError):
        entry((2**63, 1), (1, 2, 3))
    for wrong in (((1,), (1, 2, 3)), ([1, 2], (1, 2, 3)), ((1, 2),)):
        with pytest.raises(SystemError):
            entry(*wrong)


def test_what_is_no_object_is_refused():
    library = Library(
        "test_refused", {"of": (reversed_in, (Objects((TupleKind((LONG,) * 2), ArrayKind(LONG, 2, 2))),))}
    )
    with pytest.raises(CompileError, match="from an object"):
        library.of()
