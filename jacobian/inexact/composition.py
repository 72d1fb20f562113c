"""Inexact composition: sums of Mumford pairs over RR, CC and MP.

The numbers are scaled by powers of two so that the points are at |x| ≤ 1 and f is of size 1. Composition commutes with
x → 2x and y → 2y to the bit. :mod:`jacobian.inexact.stacked` adds in these units.

More digits (:mod:`jacobian.inexact.decided`) are used in two cases: if the points, or the coefficients of the curve,
are of very different sizes, or if a remainder that must vanish exceeds rounding. The summands are then moved onto the
curve, within their last bits. A quantity that these bits can make zero counts as zero where a degree depends on it.
PrecisionLoss is raised where the last bits leave the sum undetermined.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from typing import Any, NamedTuple

from jacobian.errors import NotRepresentable, PrecisionLoss, shown
from jacobian.inexact import at_infinity, stacked
from jacobian.inexact.at_infinity import Infinity, lean_of, weight_of
from jacobian.inexact.dense import Coefficients, Number, added, index_of_largest, product, remainder
from jacobian.inexact.stacked import Pair, Total

Triple = tuple[tuple[Number, ...], tuple[Number, ...], "int | None"]

# Units are such that |x| ≤ 1 at all points and that f is of size 1 at |x| = 1. The field's own digits are tried if the
# leading coefficient of f is at least 2^−SPREAD, and so is the largest term of f at the point with the smallest |x|
SPREAD = 24
# the largest remainder of a division that counts as rounding, in units of the last digit
REMAINDER = 64
# precisions, in multiples of the field's bits, that are tried in turn where the field's own does not suffice
FACTORS = (4, 12)


def add(curve: Any, first: Triple, second: Triple) -> Triple:
    """The reduced sum of two Mumford triples (u, v, n) over an inexact field.

    Raises PrecisionLoss where the digits of the summands do not determine it, and NotRepresentable where a summand or
    the sum has a point at infinity on a split model of even genus.
    """
    if first[2] is not None and curve.genus % 2:
        return _split(curve, first, second)
    for u, _, n in (first, second):
        if n is not None and lean_of(curve.genus, len(u) - 1, n):
            raise NotRepresentable(
                f"a summand of {len(u) - 1} points with the weight n = {shown(n)} at ∞₊ has a point at infinity, "
                "which inexact split models of even genus do not carry; use an exact field"
            )
    pairs = [(list(u), list(v)) for u, v, _ in (first, second)]
    total = compose(curve.field, curve.genus, curve.f, pairs[0], pairs[1], curve.h)
    n = None if first[2] is None else weight_of(curve.genus, len(total.u) - 1, 0)
    return tuple(total.u), tuple(total.v), n


def _split(curve: Any, *summands: Triple) -> Triple:
    """The reduced triple of a class, or of the sum of two, on a split model of odd genus.

    The steps at infinity are computed with more digits than the field's.
    """
    K, g = curve.field, curve.genus
    lean = sum(lean_of(g, len(u) - 1, n) for u, _, n in summands if n is not None)
    pairs = [(list(u), list(v)) for u, v, _ in summands if len(u) > 1]
    units = units_of(K, curve.f, curve.h, pairs)
    # y/x^(g+1) at ∞₊ and ∞₋ has the mean −h/(2x^(g+1)), so half the difference of both is (y + h/2)/x^(g+1) at ∞₊
    plus = curve.infinity_plus - curve.infinity_minus
    infinity = Infinity(lean, complex(plus / abs(plus)))
    total, lean = _careful(K, partial(_turned, g, infinity), curve.f, curve.h, pairs, units)
    return tuple(total.u), tuple(total.v), weight_of(g, len(total.u) - 1, lean)


def _turned(genus: int, infinity: Infinity, field: Any, f: Coefficients, pairs: Sequence[Pair]) -> tuple[Total, Number]:
    """The reduced sum of zero, one or two pairs, and the largest relative remainder of its divisions.

    ``infinity`` has the sum of the leans of the pairs (:mod:`jacobian.inexact.at_infinity`), and the phase of
    (y + h/2)/x^(g+1) at ∞₊.
    """
    rest = field.zero
    if len(pairs) == 2:
        # reduction steps preserve the parity of the degree: they end at g or g + 1
        first, second = pairs
        degree = len(first[0]) + len(second[0]) - 2
        total, rest = stacked.compose(field, genus + (degree - genus) % 2, f, first, second, infinity.plus)
    else:
        total = Total(*pairs[0] if pairs else ([field.one], []), [], field.zero)
    total, left = at_infinity.reduced(field, genus, f, total, infinity)
    return total, max(rest, left)


def negated(curve: Any, D: Triple) -> Triple:
    """The reduced triple of −E for a class E on a split model of odd genus; D is a triple of −E that is not reduced."""
    return _split(curve, D)


def compose(field: Any, genus: int, f: Sequence[Number], first: Pair, second: Pair, h: Sequence[Number] = ()) -> Total:
    """The reduced sum of two pairs (u, v), neither of them (1, 0), on y² + h(x)y = f(x) of the given arithmetic genus.

    The result has p and q for which q·(y + h/2) − p(x) vanishes on both summands.

    A quartic f with ``genus=2`` is the elliptic curve with its two points at infinity glued. The sum is then that of
    the generalized Jacobian with modulus ∞₊ + ∞₋, because (y − p)/x³ takes the same value at both points.
    """
    units = units_of(field, f, h, (first, second))
    with suppress(PrecisionLoss, ZeroDivisionError, OverflowError):
        total = _quick(field, genus, f, h, (first, second), units)
        if total:
            return total
    total, _ = _careful(field, lambda K, f, pairs: stacked.compose(K, genus, f, *pairs), f, h, (first, second), units)
    return total


class Units(NamedTuple):
    """The units 2^x of abscissas and 2^y of ordinates.

    ``low``: the smallest nonzero abscissa of the summands is about 2^low; ``at_zero``: whether an abscissa is 0.
    """

    x: int
    y: int
    low: int
    at_zero: bool

    def of_u(self, u: Sequence[Any], move: Any, sign: int = -1) -> Coefficients:
        """u in these units; ``move(c, bits)`` is c·2^bits. ``sign=1`` converts back."""
        return [move(c, sign * self.x * (len(u) - 1 - i)) for i, c in enumerate(u)]

    def of_p(self, p: Sequence[Any], move: Any, sign: int = -1, power: int = 1) -> Coefficients:
        """p in these units; its values have the unit of y, or of y² with ``power=2``. The arguments are those of
        :meth:`of_u`.
        """
        return [move(c, sign * (power * self.y - self.x * i)) for i, c in enumerate(p)]


def units_of(field: Any, f: Sequence[Number], h: Sequence[Number], pairs: Sequence[Pair]) -> Units:
    """The units in which the points of all pairs are at |x| ≤ 1 and f at |x| = 1 is of size 1."""
    sizes = [[field.exponent(c) if c else None for c in u] for u, _ in pairs]
    # if |u_i| is about 2^e for a u of degree m, its largest root is about 2^(e/(m − i)) for one of the i
    largest = [-((-e) // (len(u) - 1 - i)) for u in sizes for i, e in enumerate(u[:-1]) if e is not None]
    of_f = [(i, field.exponent(c)) for i, c in enumerate(f) if c]
    if not largest:
        top, last = of_f[-1]
        largest = [-((last - e) // (top - i)) for i, e in of_f[:-1]] or [0]
    x = max(largest)
    smallest = [x]
    for u in sizes:
        first = next(i for i, e in enumerate(u) if e is not None)
        smallest += [(u[first] - e) // i for i, e in enumerate(u[first + 1 :], 1) if e is not None]
    height = [e + x * i for i, e in of_f] + [2 * (field.exponent(c) + x * i) for i, c in enumerate(h) if c]
    return Units(x, max(height) // 2, min(smallest), any(u[0] is None for u in sizes))


def _quick(
    field: Any, genus: int, f: Sequence[Number], h: Sequence[Number], pairs: Sequence[Pair], units: Units
) -> Total | None:
    """The sum in the field's own digits; None where they may not suffice."""
    move = field.shift
    f = units.of_p(f, move, power=2)
    half = [c / 2 for c in units.of_p(h, move)]
    if half:
        f = added(f, product(half, half))
    if not _even(f, units):
        return None
    first, second = (_centred(units.of_u(u, move), units.of_p(v, move), half) for u, v in pairs)
    (u, v, p, q, _), rest = stacked.compose(Plain(field), genus, f, first, second)
    if not rest <= REMAINDER * field.eps:
        return None
    return _returned(u, v, p, q, half, units, move)


class Plain:
    """A field for :mod:`jacobian.inexact.stacked` that raises PrecisionLoss for numbers that may be only rounding."""

    largest = staticmethod(index_of_largest)

    def __init__(self, field: Any) -> None:
        self.zero, self.one, self.eps = field.zero, field.one, field.eps
        self._clear = field.eps**0.5

    def is_zero(self, x: Number, scale: Number, of_degree: bool = True) -> bool:
        """False if |x| ≥ √ε·``scale``; otherwise PrecisionLoss, because x may be only rounding."""
        if abs(x) >= self._clear * scale:
            return False
        raise PrecisionLoss("not clear of noise")


def _returned(
    u: Coefficients, v: Coefficients, p: Coefficients, q: Number, half: Coefficients, units: Units, move: Any
) -> Total:
    """A sum converted back from the units, and from y + h/2 to y."""
    if half and len(u) > 1:
        v = added(v, remainder([-c for c in half], u))
    return Total(units.of_u(u, move, 1), units.of_p(v, move, 1), units.of_p(p, move, 1), move(q, 0))


def _even(f: Coefficients, units: Units) -> bool:
    """Whether the leading coefficient of f, and the largest term of f at the smallest |x| of a point, are at least
    2^−SPREAD; f is in ``units``.
    """
    depth, least = units.low - units.x, 2.0**-SPREAD
    at_low = max(abs(c) * 2.0 ** max(depth * i, -1000) for i, c in enumerate(f))
    return bool(min(at_low, abs(f[-1])) >= least and not (units.at_zero and 0 < abs(f[0]) < least))


def _centred(u: Coefficients, v: Coefficients, half: Coefficients) -> Pair:
    """The pair (u, v) moved to y² = f + h²/4 by y → y + h/2; ``half`` is h/2."""
    return u, added(v, remainder(half, u)) if half and v else v


def _careful(
    field: Any, law: Any, f: Sequence[Number], h: Sequence[Number], pairs: Sequence[Pair], units: Units
) -> tuple[Total, int]:
    """The sum computed with more digits by ``law`` and rounded to the field, and its lean
    (:mod:`jacobian.inexact.at_infinity`).
    """
    from jacobian.inexact.decided import Passes
    from jacobian.inexact.digits import Digits, MoreDigits

    bits = 1 - field.exponent(field.eps)
    spread = 2 * len(f) * (units.x - units.low)
    for factor in FACTORS:
        with Digits(field, bits * factor + spread) as digits:
            half = [c / 2 for c in units.of_p(h, digits.number)]
            wide = added(units.of_p(f, digits.number, power=2), product(half, half))
            moved = [(units.of_u(u, digits.number), units.of_p(v, digits.number)) for u, v in pairs]
            passes = Passes(digits, law, wide, half, moved, _even(wide, units))
            try:
                u, v, p, q, lean = passes.sum(2.0 ** max(units.low - units.x, -1000))
            except MoreDigits:
                continue
            return _returned(u, v, p, q, half, units, digits.element), lean
    raise PrecisionLoss(f"{FACTORS[-1]} times the digits of {field.name} do not settle this sum; use more digits")
