"""Quadratic equations over any field."""

from __future__ import annotations

from typing import Any

from jacobian.element import Element
from jacobian.errors import NotASquare
from jacobian.fields.protocol import Field
from jacobian.poly import integer


def quadratic_roots(K: Field[Element], b: Element, c: Element) -> list[Element]:
    """The solutions y of y² + b·y = c in the field K: none, one (a double root) or two.

    Over an inexact field the discriminant is compared with the size of its terms, and the smaller root follows from the
    product of the two, so neither suffers cancellation. PrecisionLoss when rounding decides whether the discriminant is
    0.
    """
    if K.characteristic == 2:
        return _roots_in_characteristic_two(K, b, c)
    square: Any
    product: Any
    square, product = K.mul(b, b), K.mul(integer(K, 4), c)
    discriminant = K.add(square, product)
    half = K.inv(integer(K, 2))
    if K.is_zero(discriminant, None if K.exact else abs(square) + abs(product)):
        return [K.neg(K.mul(b, half))]
    try:
        root = K.sqrt(discriminant)
    except NotASquare:
        return []
    plus: Any
    minus: Any
    plus, minus = K.sub(root, b), K.neg(K.add(root, b))
    if K.exact:
        return [K.mul(plus, half), K.mul(minus, half)]
    large = K.mul(plus if abs(plus) > abs(minus) else minus, half)
    small = K.neg(K.div(c, large))
    return [large, small] if abs(plus) > abs(minus) else [small, large]


def _roots_in_characteristic_two(K: Any, b: Element, c: Element) -> list[Element]:
    if K.is_zero(b):
        return [K.sqrt(c)]
    try:
        z = K.artin_schreier(K.div(c, K.mul(b, b)))
    except NotASquare:
        return []
    y = K.mul(b, z)
    return [y, K.add(y, b)]
