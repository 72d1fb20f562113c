"""The straight-line code of a walk, except its series: it fills memory from a state, takes a step, and computes states
between steps.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import factorial

from integrable.series.room import STEP, WALKS, WIDEST, Room
from integrable.series.steps_text import Series
from integrable.series.symbols import Key, key_of
from integrable.series.tape import CONSTANT, DIFFERENCE, GROWTH, MULTIPLE, PRODUCT, QUOTIENT, ROOT, VARIABLE, Tape
from integrable.series.text import Text, Wide, joined_lanes
from jacobian.numbers.double_double import split
from jacobian.numbers.double_double_steps import (
    fast_two_sum,
    product,
    quotient,
    square_root,
    total,
    two_product,
    two_sum,
)

# the relative change of the start of the second walk, about a rounding unit, in double-doubles and in floats
MOVED, MOVED_IN_FLOATS = 2.0**-104, 2.0**-52
# for states between steps, the last 1/FLOATS of the double-double terms are summed in floats: their sum is less than a
# thousandth of the state
FLOATS = 3
# how many of the times asked for fit into one vector
TIMES = WIDEST
# for |x| below about 2^9, e^x − 1 takes TERMS terms of its series at x/2^HALVED, then HALVED doublings of the argument
HALVED, TERMS = 11, 18


def module(room: Room, start: Tape, count: int) -> str:
    """The LLVM module with the walks of one kind of systems (:mod:`integrable.series.kinds`). The first ``count``
    variables are the state, from which ``start`` computes all variables.
    """
    series = Series(room, count)
    texts = [_declared(), _growth(), series.function(), series.ratios(), _advance(room), _dense(room, count)]
    return "\n".join([*texts, _start(room, start)])


def _declared() -> str:
    found = []
    for text in map(Text, (1, 2, 4, 8, 16, 32)):
        double, suffix = text.types.double, text.types.suffix
        for name, count in (("fma", 3), ("sqrt", 1), ("fabs", 1)):
            found.append(f"declare {double} @llvm.{name}.{suffix}({', '.join([double] * count)})")
    return "\n".join(found)


def _advance(room: Room) -> str:
    """The function that advances the variables, stored as the coefficients of order 0, by a step."""
    single = Text(room.lanes)
    # lanes are gathered in registers: a load of the vector would wait for the stores of its lanes just before
    one = Text(1, single)
    step = single.gathered([one.load(room.lanes * STEP + lane) for lane in range(room.lanes)])
    square = single.fmul(step, step)
    powers = step, square, single.fmul(square, square)
    parts = [(first, width, Text(room.lanes * width, single)) for first, width in room.chunks(room.count)]
    steps = {width: [joined_lanes(text, [x] * width, room.lanes) for x in powers] for _, width, text in parts}
    # the variables are interleaved, so that the latency of one is hidden by the others
    for _ in zip(*[_further(room, text, steps[width], first, width) for first, width, text in parts], strict=True):
        pass
    return _function("advance", "ptr noalias %s", single)


def _further(room: Room, text: Text, powers: Sequence[str], first: int, width: int) -> Iterator[bool]:
    """Writes the instructions that advance a group of variables by a step h, by Horner's rule; ``powers`` are h, h² and
    h⁴. Each yield ends the instructions of one order.
    """
    (wide, order), (step, square, fourth) = room.orders, powers

    def high(k: int) -> str:
        return text.load(room.high(first, k) // width)

    def low(k: int) -> str:
        return text.load(room.low(first, k) // width)

    # four sums, each of every fourth term, because a single sum would wait at each term; in a walk in floats the
    # largest terms are added one by one, which rounds less
    last = wide + 1 if wide >= 0 else 3
    sums = [high(k) for k in range(order, order - 4, -1)]
    for k in range(order - 4, last - 1, -1):
        sums = [*sums[1:], text.fma(sums[0], fourth, high(k))]
        yield True
    high3, high2, high1, high0 = sums
    rest = text.fma(text.fma(high3, step, high2), square, text.fma(high1, step, high0))
    found: Wide = rest, ""
    if wide < 0:
        rest = text.fma(text.fma(rest, step, high(2)), step, high(1))
        found = two_sum(text, high(0), text.fma(rest, step, low(0)))
    for k in range(wide, -1, -1):
        found = _onward(text, found, (step, ""), (high(k), low(k)))
        yield True
    if wide >= 0:
        found = fast_two_sum(text, *found)
    text.store(found[0], room.high(first, 0) // width)
    text.store(found[1], room.low(first, 0) // width)


def _onward(text: Text, x: Wide, step: Wide, coefficient: Wide) -> Wide:
    """x·step + coefficient, where x and step may lack a low part."""
    p, e = two_product(text, x[0], step[0])
    if x[1]:
        e = text.fma(x[1], step[0], e)
    if step[1]:
        e = text.fma(x[0], step[1], e)
    s, f = two_sum(text, coefficient[0], p)
    return s, text.fadd(text.fadd(coefficient[1], f), e)


def _dense(room: Room, count: int) -> str:
    """The function that evaluates the first ``count`` variables of one walk at given distances from the expansion
    point.

    The lane of the walk begins at %s. %x holds vectors of TIMES floats: the high and the low parts of the distances,
    then, as results, the high and the low parts of each variable.
    """
    text, (wide, order), lanes = Text(TIMES), room.orders, room.lanes
    ahead, one = (text.load(0, "%x"), text.load(1, "%x")), Text(1, text)

    def spread(place: int) -> str:
        return text.spread(one.load(place * lanes))

    first, variables = wide - wide // FLOATS, range(count)
    # the variables are interleaved, so that the latency of one is hidden by the others
    rest = [spread(room.high(i, order)) for i in variables]
    for k in range(order - 1, max(first, 1) - 1, -1):
        rest = [text.fma(x, ahead[0], spread(room.high(i, k))) for i, x in enumerate(rest)]
    found: list[Wide] = [(x, "") for x in rest]
    if wide < 0:
        for i, x in enumerate(rest):
            moved = text.fma(x, ahead[0], text.fma(spread(room.high(i, 1)), ahead[1], spread(room.low(i, 0))))
            found[i] = two_sum(text, spread(room.high(i, 0)), moved)
    for k in range(first - 1, -1, -1):
        terms = [(spread(room.high(i, k)), spread(room.low(i, k))) for i in variables]
        found = [_onward(text, x, ahead, term) for x, term in zip(found, terms, strict=True)]
    for i, pair in enumerate(found):
        for part, x in enumerate(fast_two_sum(text, *pair)):
            text.store(x, 2 + 2 * i + part, "%x")
    return _function("dense", "ptr noalias %s, ptr noalias %x", text)


def _start(room: Room, start: Tape) -> str:
    """The function that fills memory with the constants and variables of both walks, from a system's constants and
    state. The lanes of the walks begin at %s.
    """
    text, wide, rates = Text(WALKS), room.orders.wide, room.tape
    apart, shown = room.lanes // WALKS, start.kinds.count(VARIABLE)
    single = Text(1, text)
    known: dict[Key, Wide] = {}
    results = _values(single, start, known)
    moved = MOVED if wide >= 0 else MOVED_IN_FLOATS
    for n, kind in enumerate(rates.kinds):
        if kind not in (VARIABLE, CONSTANT):
            continue
        high, low = results[n] if kind == VARIABLE else _constant(single, key_of(rates.constants[n]), known)
        # the start of the second walk. All constants, and all variables that are functions of the state, change by the
        # same factor, so that a variable that is equal to a constant stays equal to it
        again = single.fma(high, single.real(moved * (min(n, shown) % 5 - 2.5)), low)
        # constants of a walk in floats have no low part, so their change must show in the high part
        both = kind == CONSTANT and wide < 0
        highs = [single.fadd(high, low), single.fadd(high, again)] if both else [high]
        text.store(text.gathered((highs * WALKS)[:WALKS]), apart * room.high(n, 0))
        text.store(text.gathered([low, again]), apart * room.low(n, 0))
    return _function("start", "ptr noalias %constants, ptr noalias %state, ptr noalias %s", text)


def _values(text: Text, tape: Tape, known: dict[Key, Wide]) -> list[Wide]:
    """The results of a tape whose variables are the floats in %state."""
    found: list[Wide] = []
    for n, (kind, p, q) in enumerate(tape.nodes):
        if kind == VARIABLE:
            found.append((text.load(n, "%state"), text.real(0.0)))
        elif kind == CONSTANT:
            found.append(_constant(text, key_of(tape.constants[n]), known))
        elif kind == ROOT:
            found.append(square_root(text, *found[p]))
        elif kind == GROWTH:
            pair = text.write(f"call {{double, double}} @growth(double {found[p][0]}, double {found[p][1]})")
            high, low = (text.write(f"extractvalue {{double, double}} {pair}, {i}") for i in (0, 1))
            found.append((high, low))
        else:
            found.append(_combined(text, kind, found[p], found[q]))
    return [found[n] for n in tape.results]


def _combined(text: Text, kind: int, x: Wide, y: Wide) -> Wide:
    operation = product if kind in (MULTIPLE, PRODUCT) else quotient if kind == QUOTIENT else total
    return operation(text, *x, *(text.wide_negative(y) if kind == DIFFERENCE else y))


def _constant(text: Text, key: Key, known: dict[Key, Wide]) -> Wide:
    """The constant with this key; ``known`` are those that have been computed."""
    if key not in known:
        kind, *rest = key
        if kind == "constant":
            known[key] = text.load(rest[0], "%constants"), text.real(0.0)
        elif kind == "number":
            known[key] = text.real(rest[0]), text.real(0.0)
        else:
            x, y = (_constant(text, each, known) for each in rest)
            known[key] = _combined(text, kind, x, y)
    return known[key]


def _growth() -> str:
    """The LLVM function e^x − 1 of a double-double."""
    text = Text(1)
    small = text.real(2.0**-HALVED)
    x = text.fmul("%hi", small), text.fmul("%lo", small)
    halves = (split(Fraction(1, factorial(k))) for k in range(1, TERMS + 1))
    terms = [(text.real(high), text.real(low)) for high, low in halves]
    found = terms[-1]
    for term in terms[-2::-1]:
        found = total(text, *product(text, *found, *x), *term)
    found = product(text, *found, *x)
    two = text.real(2.0), text.real(0.0)
    for _ in range(HALVED):
        # e^2x − 1 = (e^x − 1)(e^x + 1)
        found = product(text, *found, *total(text, *found, *two))
    pair = text.write(f"insertvalue {{double, double}} undef, double {found[0]}, 0")
    pair = text.write(f"insertvalue {{double, double}} {pair}, double {found[1]}, 1")
    head = "define internal {double, double} @growth(double %hi, double %lo) nounwind noinline {"
    return "\n".join([head, *text.lines, f"  ret {{double, double}} {pair}", "}"])


def _function(name: str, arguments: str, text: Text) -> str:
    return "\n".join([f"define void @{name}({arguments}) nounwind {{", *text.lines, "  ret void", "}"])
