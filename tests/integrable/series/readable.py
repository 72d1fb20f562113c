"""A walk of a kind of systems in long numbers by its recorded formulas: the oracle of the compiled walks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import gmpy2

from integrable.series.kinds import Kind
from integrable.series.recurrences import coefficients, values_at
from integrable.series.symbols import Key, key_of
from integrable.series.tape import CONSTANT, DIFFERENCE, GROWTH, MULTIPLE, PRODUCT, QUOTIENT, ROOT, SUM, VARIABLE, Tape
from jacobian.inexact.long_field import LongField

# precision in bits, order of the series, and their largest last term
BITS, ORDER, LAST = 160, 40, 2.0**-130
OPERATIONS: dict[Any, Callable[[Any, Any], Any]] = {
    SUM: lambda x, y: x + y,
    DIFFERENCE: lambda x, y: x - y,
    MULTIPLE: lambda x, y: x * y,
    PRODUCT: lambda x, y: x * y,
    QUOTIENT: lambda x, y: x / y,
}


def states_of(kind: Kind, given: Sequence[float], state: Sequence[float], times: Sequence[float]) -> list[list[float]]:
    """The variables of a state at times, rounded, for a system of the kind with the constants ``given``."""
    with LongField(BITS) as N:
        begin = _results(N, kind.start, given, [N.coerce(x) for x in state])
        return [[float(x) for x in _moved(N, kind.rates, given, begin, N.coerce(t))[: len(state)]] for t in times]


def _moved(N: LongField, tape: Tape, given: Sequence[float], variables: list[Any], left: Any) -> list[Any]:
    """The variables after the time ``left``."""
    count, width = len(variables), ORDER + 1
    constants = _constants(N, tape, given)
    while left:
        series = [N.zero] * (width * len(tape.kinds))
        series[::width] = [*variables, *constants[count:]]
        coefficients(tape.kinds, tape.left, tape.right, tape.results, 0, ORDER, N.one, series)
        sizes = [max(abs(series[i * width + k]) for k in range(4)) for i in range(count)]
        step = abs(left)
        while any(
            abs(series[i * width + k]) * step**k > LAST * size
            for i, size in enumerate(sizes)
            for k in (ORDER - 1, ORDER)
        ):
            step = step / 2
        step = step if left > 0 else -step
        variables = [N.zero] * count
        values_at(step, ORDER, series, count, variables, 0)
        left = left - step
    return variables


def _constants(N: LongField, tape: Tape, given: Sequence[float]) -> list[Any]:
    """The values of the constant nodes of a tape, and 0 for the others."""
    return [
        _number(N, key_of(x), given) if kind == CONSTANT else N.zero
        for kind, x in zip(tape.kinds, tape.constants, strict=True)
    ]


def _number(N: LongField, key: Key, given: Sequence[float]) -> Any:
    kind, *rest = key
    if kind == "constant":
        return N.coerce(float(given[rest[0]]))
    if kind == "number":
        return N.coerce(rest[0])
    return OPERATIONS[kind](*(_number(N, each, given) for each in rest))


def _results(N: LongField, tape: Tape, given: Sequence[float], variables: Sequence[Any]) -> list[Any]:
    """The results of a tape for these variables."""
    found = _constants(N, tape, given)
    for n, (kind, p, q) in enumerate(zip(tape.kinds, tape.left, tape.right, strict=True)):
        if kind == VARIABLE:
            found[n] = variables[n]
        elif kind == ROOT:
            found[n] = N.sqrt(found[p])
        elif kind == GROWTH:
            found[n] = gmpy2.expm1(found[p])
        elif kind != CONSTANT:
            found[n] = OPERATIONS[kind](found[p], found[q])
    return [found[n] for n in tape.results]
