"""Multiples by doubling and adding, in any group, from the scalar's non-adjacent form.

Over QQ the coefficients of m·D have about m² times as many digits as those of D. If they exceed MOST_BITS bits,
Infeasible is raised.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from jacobian.errors import Infeasible
from jacobian.fields import QQ

Class = TypeVar("Class")
MOST_BITS = 150_000
"""The largest number of bits of a numerator or denominator in a class over QQ that is doubled; the double has four
times as many. 1000·(0, 1) on y² = x⁵ + 2x + 1 has 380,000 bits and takes 3.5 s.
"""
PART = 1 << 15
"""The number of bits of a scalar in one call of compiled code. A call takes less than a second; Ctrl-C waits for it.
"""


def signed_digits(m: int, width: int) -> list[int]:
    """The digits of m > 0 in the width-w non-adjacent form, least significant first. A digit is 0, or odd and below
    2^(w−1) in absolute value.
    """
    digits = []
    while m:
        digit = 0
        if m & 1:
            digit = m & ((1 << width) - 1)
            if digit >> (width - 1):
                digit -= 1 << width
            m -= digit
        digits.append(digit)
        m >>= 1
    return digits


def bits_of(K: Any, *polynomials: Any) -> int:
    """The number of bits of the longest numerator or denominator in polynomials over QQ; 0 over other fields."""
    if K is not QQ:
        return 0
    return max((max(c.numerator.bit_length(), c.denominator.bit_length()) for a in polynomials for c in a), default=0)


def check_growth(K: Any, *polynomials: Any) -> None:
    """Raises Infeasible if coefficients over QQ are too long to double the class; other fields have no limit."""
    bits = bits_of(K, *polynomials)
    if bits > MOST_BITS:
        raise Infeasible(
            f"scalar: a multiple on the way has numbers of {bits} bits over {K.name}, and the next four times as many; "
            f"classes of more than {MOST_BITS} bits are not doubled again; modulo primes (change_ring) they stay short"
        )


def by_parts(
    m: int, a: Class, multiple_of: Callable[[int, Class], Class], sum_of: Callable[[Class, Class], Class]
) -> Class:
    """m·a for m > 0, by Horner's rule in base 2^PART; ``multiple_of`` multiplies by scalars up to 2^PART."""
    if m.bit_length() <= PART:
        return multiple_of(m, a)
    places = range(m.bit_length() // PART * PART, -1, -PART)
    result, mask = None, (1 << PART) - 1
    for place in places:
        digit = m >> place & mask
        result = multiple_of(1 << PART, result) if result is not None else None
        if digit:
            term = multiple_of(digit, a)
            result = term if result is None else sum_of(result, term)
    return result  # type: ignore[return-value]


def multiple(
    m: int,
    a: Class,
    sum_of: Callable[[Class, Class], Class],
    double: Callable[[Class], Class],
    negate: Callable[[Class], Class],
    zero: Class | None = None,
) -> Class:
    """m·a, by m's non-adjacent form of width 4, or 2 for at most 12 bits (Solinas 2000). Only m = 0 needs ``zero``."""
    if m < 0:
        m, a = -m, negate(a)
    if m == 0:
        return zero  # type: ignore[return-value]
    digits = signed_digits(m, 4 if m.bit_length() > 12 else 2)
    odd = {1: a}
    largest = max(map(abs, digits))
    if largest > 1:
        twice = double(a)
        for i in range(3, largest + 1, 2):
            odd[i] = sum_of(odd[i - 2], twice)
    odd |= {digit: negate(odd[-digit]) for digit in {*digits} if digit < 0}
    result = odd[digits[-1]]
    for digit in digits[-2::-1]:
        result = double(result)
        if digit:
            result = sum_of(result, odd[digit])
    return result
