"""Multiples by doubling and adding, in any group: the non-adjacent form and the ladder over it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

Class = TypeVar("Class")


def signed_digits(m: int, width: int) -> list[int]:
    """The width-w non-adjacent form of m > 0, least significant digit first: digits odd and below 2^(w−1) in size, or
    0.
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


def multiple(
    m: int,
    a: Class,
    sum_of: Callable[[Class, Class], Class],
    double: Callable[[Class], Class],
    negate: Callable[[Class], Class],
) -> Class:
    """m·a for m > 0, by signed windows of four bits (width-w non-adjacent form; Solinas 2000)."""
    digits = signed_digits(m, 4 if m.bit_length() > 12 else 2)
    odd = {1: a}
    largest = max(map(abs, digits))
    if largest > 1:
        twice = double(a)
        for i in range(3, largest + 1, 2):
            odd[i] = sum_of(odd[i - 2], twice)
    result = odd[digits[-1]]
    for digit in digits[-2::-1]:
        result = double(result)
        if digit:
            result = sum_of(result, odd[digit] if digit > 0 else negate(odd[-digit]))
    return result
