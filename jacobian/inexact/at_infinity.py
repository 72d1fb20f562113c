"""Reduction at infinity on split models, for inexact sums.

A pair (u, v) with the ``lean`` s represents the class of div(u, v) − (deg u/2)(∞₊ + ∞₋) + (s/2)(∞₊ − ∞₋). Composition
adds leans, and its reduction steps preserve them except where y − v vanishes at infinity. In odd genus a class D in
general position is represented by g points with the lean −1. Cantor's steps reduce a sum of two such classes to g + 1
points with the lean −2. The opposite of a class is represented by g points with the lean 1. From both, one more step
leads to g points with the lean −1. Let P be the polynomial part of √f at ∞₊. The step uses y + P for a sum, y − P for
an opposite, up to lower terms (Galbraith, Harrison and Mireles Morales 2008).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from jacobian.errors import PrecisionLoss
from jacobian.inexact.dense import Coefficients, Number, added, divided, product, remainder, size
from jacobian.inexact.stacked import UNDETERMINED, Total, departure
from jacobian.numbers.roots import root


class Infinity(NamedTuple):
    """The argument ``infinity`` of :func:`reduced`. ``lean``: the sum of the summands' leans
    (:mod:`jacobian.inexact.at_infinity`); ``plus``: a number with the phase of (y + h/2)/x^(g+1) at ∞₊.
    """

    lean: int
    plus: complex


def lean_of(genus: int, degree: int, n: int) -> int:
    """The lean (:mod:`jacobian.inexact.at_infinity`) of a pair with deg u = ``degree`` and the weight n at ∞₊."""
    return 2 * n + degree - 2 * ((genus + 1) // 2)


def weight_of(genus: int, degree: int, lean: int) -> int:
    """The weight n at ∞₊ of a pair with this lean and deg u = ``degree``. A pair is reduced if 0 ≤ n ≤ g − deg u."""
    return (lean - degree) // 2 + (genus + 1) // 2


def reduced(field: Any, genus: int, f: Coefficients, total: Total, infinity: Infinity) -> tuple[Total, Number]:
    """The reduced pair in the class of ``total``, a pair with deg u ≤ g + 1; and the largest remainder of the divisions
    on the way, relative to its terms. Without rounding all these remainders would be 0.
    """
    u, v, lean, rest = total.u, total.v, total.lean + infinity.lean, field.zero
    plus = principal_part(genus, f, infinity.plus)
    while not 0 <= (n := weight_of(genus, len(u) - 1, lean)) <= genus - (len(u) - 1):
        part = [-c for c in plus] if n < 0 else plus
        other, whole, left = _turned(field, f, u, v, part)
        moved = 2 * (genus + 1) - (len(u) - 1) - (len(other) - 1)
        lean += moved if n < 0 else -moved
        u, v = other, remainder([-c for c in whole], other)
        rest = max(rest, left, departure(f, u, v))
    return total._replace(u=u, v=v, lean=lean), rest


def principal_part(genus: int, f: Sequence[Number], plus: complex) -> Coefficients:
    """The polynomial part of √f at ∞₊, ascending; ``plus`` selects one of the two roots."""
    top = root(f[-1])
    if (top * plus.conjugate()).real < 0:
        top = -top
    descending = [top]
    for i in range(1, genus + 2):
        known = sum((x * y for x, y in zip(descending[1:], descending[:0:-1], strict=True)), 0 * top)
        descending.append((f[len(f) - 1 - i] - known) / (2 * top))
    return descending[::-1]


def _turned(
    field: Any, f: Coefficients, u: Coefficients, v: Coefficients, part: Coefficients
) -> tuple[Coefficients, Coefficients, Number]:
    """(u', w, remainder): w ≡ v mod u has the leading terms of ``part``, and u' is (f − w²)/u, made monic.

    Since f − w² = (f − part²) − (w − part)(w + part), the leading terms cancel exactly.
    """
    change = remainder(added(v, [-c for c in part]), u)
    scale = max(size(v), size(part))
    while change and field.is_zero(change[-1], scale):
        change.pop()
    whole = added(part, change)
    below = added(f, [-c for c in product(part, part)])[: len(part) - 1]
    psi = added(below, [-c for c in product(change, added(part, whole))])
    while not change and psi and field.is_zero(psi[-1], size(f)):
        psi.pop()
    if len(psi) < len(u):
        raise PrecisionLoss(UNDETERMINED)
    quotient, rest = divided(psi, u)
    return [*(c / quotient[-1] for c in quotient[:-1]), field.one], whole, size(rest) / size(psi)
