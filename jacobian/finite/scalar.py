"""Multiples of a fixed divisor, linear combinations of divisors, and the Frobenius endomorphism.

A single m·D is computed by :meth:`jacobian.group.Jacobian.multiply`. Every method here returns the same class as the
plain sum.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import zip_longest
from typing import Any

from jacobian import poly
from jacobian.addition.ladder import signed_digits
from jacobian.errors import ArgumentError, CurveMismatch, FieldError, entries, shown, whole
from jacobian.immutable import Immutable
from jacobian.law.divisor import Divisor, GroupLaw, check_scalar

WINDOW = 4


class FixedBase(Immutable):
    """A table of multiples of one divisor: ``table(m)``, ``m * table`` and ``table * m`` are m·D.

    Row i contains d·2^(wi)·D for 1 ≤ d ≤ 2^(w−1), w = ``window``. So a multiple takes one addition per w bits and no
    doubling (Brickell, Gordon, McCurley and Wilson 1992, with signed digits). Rows are added when a longer scalar needs
    them.
    """

    def __init__(self, D: Divisor, window: int = 5) -> None:
        self.divisor = D
        self.window = whole(window, "window", "an int from 2 to 12, the bits of a digit, is needed", 2, 12)
        self._rows: list[list[Divisor]] = []
        self._next = D

    def _row(self, i: int) -> list[Divisor]:
        while len(self._rows) <= i:
            row = [self._next]
            for _ in range((1 << (self.window - 1)) - 1):
                row.append(row[-1] + self._next)
            self._rows.append(row)
            vars(self)["_next"] = row[-1].double()
        return self._rows[i]

    def __call__(self, m: int) -> Divisor:
        """m·D."""
        m = check_scalar(m, "m")
        total = self.divisor.jacobian.zero()
        for i, digit in enumerate(_signed_windows(abs(m), self.window)):
            if digit:
                entry = self._row(i)[abs(digit) - 1]
                total = total + (entry if digit > 0 else -entry)
        return total if m >= 0 else -total

    __mul__ = __rmul__ = __call__
    __array_ufunc__ = None

    def _value(self) -> tuple[object, ...]:
        return self.divisor, self.window

    def __reduce__(self) -> tuple[object, ...]:
        return FixedBase, self._value()

    def __repr__(self) -> str:
        return f"FixedBase({self.divisor!r}, window={self.window})"


def combination(J: GroupLaw, scalars: Iterable[int], divisors: Iterable[Divisor]) -> Divisor:
    """Σ m_i·D_i, for any number of terms: Straus for few, Pippenger for many, whichever takes fewer additions.

    :func:`straus_cost` and :func:`pippenger_cost` count the additions beforehand. The sum of no terms is 0. For two
    terms interleaved windows take fewer additions than Shamir's joint table from about 40 bits on, so there is no third
    method.
    """
    ms = [check_scalar(m, f"scalars[{i}]") for i, m in enumerate(entries(scalars, "scalars", "a sequence of ints"))]
    Ds = entries(divisors, "divisors", "a sequence of Divisors")
    if len(ms) != len(Ds):
        raise ArgumentError(f"scalars, divisors: {len(ms)} scalars beside {len(Ds)} divisors; as many are needed")
    for i, D in enumerate(Ds):
        if getattr(D, "jacobian", None) != J:
            raise CurveMismatch(f"divisors[{i}] = {shown(D)} does not lie in the {J!r}")
    pairs = [(abs(m), D if m > 0 else -D) for m, D in zip(ms, Ds, strict=True) if m and D]
    if not pairs:
        return J.zero()
    bits = max(m.bit_length() for m, _ in pairs)
    window = best_bucket_window(len(pairs), bits)
    if straus_cost(len(pairs), bits) <= pippenger_cost(len(pairs), bits, window):
        return straus(J, pairs)
    return pippenger(J, pairs, window)


def straus_cost(terms: int, bits: int) -> int:
    """The number of group operations of :func:`straus`: the tables of the terms, one chain of doublings, an addition
    for each non-zero digit.
    """
    return bits + terms * ((1 << (WINDOW - 2)) + bits // (WINDOW + 1))


def pippenger_cost(terms: int, bits: int, window: int) -> int:
    """The number of sums in :func:`pippenger`: ``bits`` doublings; in each window one per term and one per bucket."""
    return bits + (bits // window + 1) * (terms + (1 << (window - 1)))


def best_bucket_window(terms: int, bits: int) -> int:
    """The window that makes :func:`pippenger` cheapest."""
    return min(range(1, 16), key=lambda window: pippenger_cost(terms, bits, window))


def straus(J: GroupLaw, pairs: list[tuple[int, Divisor]]) -> Divisor:
    """Σ m_i·D_i, m_i > 0, with one chain of doublings for all (Straus 1964; signed windows, Möller 2001)."""
    digits = [signed_digits(m, WINDOW) for m, _ in pairs]
    tables = []
    for (_, D), used in zip(pairs, digits, strict=True):
        table, double = {1: D}, D.double()
        for d in range(3, max(map(abs, used)) + 1, 2):
            table[d] = table[d - 2] + double
        tables.append(table)
    total = J.zero()
    for column in reversed(list(zip_longest(*digits, fillvalue=0))):
        total = total.double()
        for digit, table in zip(column, tables, strict=True):
            if digit:
                total = total + (table[digit] if digit > 0 else -table[-digit])
    return total


def pippenger(J: GroupLaw, pairs: list[tuple[int, Divisor]], window: int) -> Divisor:
    """Σ m_i·D_i, m_i > 0, by buckets, one per digit, summed by running totals (Pippenger 1976; Bernstein 2002)."""
    digits = [_signed_windows(m, window) for m, _ in pairs]
    total = J.zero()
    for column in reversed(list(zip_longest(*digits, fillvalue=0))):
        for _ in range(window if total else 0):
            total = total.double()
        buckets: dict[int, Divisor] = {}
        for (_, D), digit in zip(pairs, column, strict=True):
            if digit:
                term = D if digit > 0 else -D
                buckets[abs(digit)] = buckets[abs(digit)] + term if abs(digit) in buckets else term
        total = total + _weighted_sum(J, buckets)
    return total


def _signed_windows(m: int, window: int) -> list[int]:
    """The digits of m ≥ 0 in base 2^window, between −2^(window−1) and 2^(window−1), least significant first."""
    base, digits = 1 << window, []
    while m:
        digit = m & (base - 1)
        m >>= window
        if 2 * digit > base:
            digit -= base
            m += 1
        digits.append(digit)
    return digits


def _weighted_sum(J: GroupLaw, buckets: dict[int, Divisor]) -> Divisor:
    """The sum Σ d·bucket_d, by running totals from the highest bucket down."""
    running = total = J.zero()
    for d in range(max(buckets, default=0), 0, -1):
        if d in buckets:
            running = running + buckets[d]
        total = total + running
    return total


def frobenius(D: Divisor, power: int = 1) -> Divisor:
    """The image of D under the p^power-Frobenius (x, y) → (x^(p^power), y^(p^power)), an endomorphism of J.

    The curve must be defined over the subfield that x → x^(p^power) fixes; else CurveMismatch, because the image lies
    on another curve. FieldError over infinite fields, ArgumentError for a negative power.
    """
    J, power = D.jacobian, check_scalar(power, "power")
    K: Any = J.field
    C = J.curve
    if K.order is None:
        raise FieldError(f"field = {K.name}: Frobenius is an endomorphism over finite fields")
    if power < 0:
        raise ArgumentError(f"power = {shown(power)}: a number ≥ 0 of p-th powers is needed")
    # x^q = x on K of order q, so ``power`` is reduced modulo the degree of K
    exponent = K.characteristic ** (power % K.degree)

    def image(a: poly.Poly) -> poly.Poly:
        return tuple([K.power(c, exponent) for c in a])

    if image(C.f) != C.f or image(C.h) != C.h:
        raise CurveMismatch(
            f"power = {shown(power)}: {C!r} is not defined over the field fixed by x → "
            f"x^({K.characteristic}^{shown(power)}); its conjugate is another curve"
        )
    n = D.n
    if n is not None and K.power(C.infinity_plus, exponent) != C.infinity_plus:
        # ∞₊ and ∞₋ change places, in D as well as in D∞ = ⌈g/2⌉∞₊ + ⌊g/2⌋∞₋
        n = C.genus - D.degree - n + C.genus % 2
    return J._reduced(image(D.u), image(D.v), n)
