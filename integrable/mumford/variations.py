"""Derivatives of states near the start, by Taylor series of the equations of motion and of variation together.

The formulas of a system are recorded with jets x + x'ε, ε² = 0 (:mod:`integrable.phase.jets`). Their values are the
equations of motion, their slopes those of variation, so no system has formulas of its own for derivatives. One walk
(:mod:`integrable.series.kinds`) computes a motion and its derivative with respect to one input.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from integrable.phase.jets import Jet, JetField
from integrable.portrait.sensitivity import Sensitivity
from integrable.series.kinds import Formulas, Kind
from integrable.series.symbols import Symbol, SymbolField
from jacobian import RR
from jacobian.element import FormulaField, Real
from jacobian.errors import ArgumentError
from jacobian.immutable import made_once


def near_sensitivity(flow: Any, times: np.ndarray, longest: float) -> Sensitivity | None:
    """The derivatives of the states of a :class:`integrable.mumford.flow.MumfordFlow` over RR; None if series do not
    reach all ``times``. A walk takes at most about ``longest`` microseconds.
    """
    (inputs, names), system, width = flow._inputs(), flow.system, 2 * flow.system.size
    varied = [k for k, size in enumerate(inputs.sizes) if size]
    standing = tuple(k in varied for k in range(width + len(system.constants), len(inputs.numbers)))
    kind = made_once(("variations", *system._alike, standing), lambda: variations_of(flow, standing))
    if kind is None:
        return None
    matrix = np.empty((len(times), width, len(varied)))
    for column, k in enumerate(varied):
        change = [0.0] * len(inputs.numbers)
        change[k] = 1.0
        given = (*inputs.numbers[width:], *change[width:], 0.0), (*inputs.numbers[:width], *change[:width])
        near = kind.finished(kind.walked(given, times, longest), given, times, longest)
        if near.lacks(len(times)):
            return None
        reached = slice(None) if near.places is None else near.places
        matrix[reached, :, column] = near.states[:, 2:].reshape(-1, width)
    return Sensitivity(times, matrix, None, "integrated", flow, names)


def variations_of(flow: Any, standing: tuple[bool, ...]) -> Kind | None:
    """The walks of a motion like ``flow`` and a tangent vector of it; None if the formulas cannot be recorded.

    The variables are q, p, their derivatives, the auxiliary functions, and the derivatives of these. The constants are
    those of the system, then their derivatives. Parameters that are not ``standing`` are 0.
    """
    system, point_of = flow.system, type(flow.start)
    K, n, count = JetField(SymbolField(), 1), system.size, len(system.constants) + len(system.parameters)
    symbols: list[Any] = [Symbol(("constant", i)) for i in range(2 * count)]
    wide = system._with(K, [Jet(K, symbols[i], (symbols[count + i],)) for i in range(count)], standing)

    def jets(y: Sequence[Any], size: int) -> tuple[Jet, ...]:
        return tuple(Jet(K, x, (slope,)) for x, slope in zip(y[:size], y[size:], strict=True))

    def parts(numbers: Iterable[Real]) -> tuple[Real, ...]:
        found = [*map(K.coerce, numbers)]
        return (*(x.value for x in found), *(x.slopes[0] for x in found))

    def point(y: Sequence[Any]) -> Any:
        both = jets(y[: 4 * n], 2 * n)
        return point_of(both[:n], both[n:])

    def start(N: FormulaField, y: Sequence[Any]) -> tuple[Real, ...]:
        inner = wide._constrained(K, point(y))
        return *parts((*inner.q, *inner.p)), *parts(wide._auxiliary(K, inner))

    def rates(N: FormulaField, y: Sequence[Any]) -> tuple[Real, ...]:
        found = wide._rational_rates(K, point(y), jets(y[4 * n :], len(y[4 * n :]) // 2))
        return *parts(found[: 2 * n]), *parts(found[2 * n :])

    try:
        variables = 2 * (2 * n + len(system._auxiliary(RR, flow.start)))
        return Kind(f"{type(system).__name__}Variations", Formulas(rates, start, 4 * n, variables, n))
    except (TypeError, ArgumentError, AttributeError):
        # the equations call a function that cannot be recorded
        return None
