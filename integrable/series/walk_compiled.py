"""The loop of :mod:`integrable.series.walk` compiled, once for all kinds of systems."""

from __future__ import annotations

from collections.abc import Callable

from integrable.series import walk
from integrable.series.walk import Codes, Given, Layout, Many, Outputs, Slots, walked, walked_abreast
from jacobian.native.kinds import FLOAT, FLOATS, INT, INTS, NONE, Value, record
from jacobian.native.library import Library
from jacobian.native.operators import Operators, real
from jacobian.native.special import SPECIAL

CODES = record(Codes, *[INT] * 5)
LAYOUT = record(Layout, FLOATS, *[INT] * 8)
GIVEN = record(Given, FLOATS, FLOATS)
MANY = record(Many, FLOATS, FLOATS, INTS, INTS, FLOATS)
SLOTS = record(Slots, INTS, INTS, FLOATS)
OUTPUTS = record(Outputs, *[FLOATS] * 4)


def _call(b: Operators, code: Value, *pointers: str) -> Value:
    there = b.write(f"inttoptr i64 {code.parts[0]} to ptr")
    b.lines.append(f"  call void {there}({', '.join(f'ptr {x}' for x in pointers)})")
    return Value(NONE, ())


def _in_lane(b: Operators, room: Value, lane: Value) -> str:
    return b.write(f"getelementptr double, ptr {room.parts[0]}, i64 {lane.parts[0]}")


def _logarithm(b: Operators, x: Value) -> Value:
    # for x = m·2^e the bits, read as an integer and divided by 2^52, are 1023 + e + (m − 1), where m − 1 is near log₂ m
    word = b.write(f"bitcast double {b.float_of(x)} to i64")
    found = Value(FLOAT, (b.write(f"sitofp i64 {word} to double"),))
    return b.binary("Sub", b.binary("Mult", found, real(2.0**-52)), real(1023.0))


def _power(b: Operators, x: Value) -> Value:
    # 2^(x − ⌊x⌋) is approximated by a parabola, and ⌊x⌋ becomes the exponent
    floor = b.function("floor", x)
    part = b.binary("Sub", x, floor)
    bent = b.binary("Add", b.binary("Mult", part, real(0.3371894346)), real(0.657636276))
    found = b.binary("Add", b.binary("Mult", part, bent), real(1.00172476))
    exponent = b.write(f"fptosi double {floor.parts[0]} to i64")
    word = b.write(f"shl i64 {b.write(f'add i64 {exponent}, 1023')}, 52")
    return b.binary("Mult", found, Value(FLOAT, (b.write(f"bitcast i64 {word} to double"),)))


NUMBERS = {walk.logarithm: _logarithm, walk.power: _power}
STRAIGHT: dict[object, Callable[..., Value]] = {
    walk.start: lambda b, code, constants, state, room, lane: _call(
        b, code, constants.parts[0], state.parts[0], _in_lane(b, room, lane)
    ),
    walk.execute: lambda b, code, room: _call(b, code, room.parts[0]),
    walk.dense: lambda b, code, room, lane, ahead: _call(b, code, _in_lane(b, room, lane), ahead.parts[0]),
}
WALK = CODES, FLOATS, LAYOUT
LIBRARY = Library(
    "walk",
    {
        "walked": (walked, (*WALK, GIVEN, FLOATS, OUTPUTS, INT, FLOAT)),
        "walked_abreast": (walked_abreast, (*WALK, MANY, FLOATS, OUTPUTS, SLOTS, FLOATS)),
    },
    SPECIAL | NUMBERS | STRAIGHT,
)
