"""The interface of a field: an object that computes with raw elements.

Elements stay ordinary Python objects (``int``, ``Fraction``, ``float``, ``complex``, ``mpf``), and the field supplies
the operations. Polynomials and divisors leave every operation to the field, so one algorithm serves all fields.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Protocol, runtime_checkable

from jacobian.element import Arithmetic, Element, Rng
from jacobian.errors import ArgumentError, shown


def check_field(K: Field[Element], argument: str) -> Field[Element]:
    """``K``, or an ArgumentError that names ``argument``."""
    if not hasattr(K, "coerce") or not hasattr(K, "characteristic"):
        raise ArgumentError(f"{argument} = {shown(K)} is not a field: give GF(p), GF(p, k), QQ, RR, CC or MP(dps)")
    return K


@runtime_checkable
class Field(Arithmetic[Element], Protocol[Element]):
    """A field: the operations on raw elements of type ``Element``.

    ``exact`` fields decide equality; inexact ones decide it against a scale, or raise
    :class:`~jacobian.errors.PrecisionLoss`. Two fields are the same field when they compare equal.
    """

    @property
    def order(self) -> int | None:
        """The number of elements; None for an infinite field."""
        ...

    def is_zero(self, x: Element, scale: Element | None = None) -> bool:
        """Whether x is zero: exactly, or relative to ``scale``, the size of the terms whose difference is x."""
        ...

    def sqrt(self, x: Element) -> Element:
        """One square root of x, or NotASquare."""
        ...

    def random(self, rng: Rng) -> Element:
        """A random element: uniform over a finite field, of moderate size elsewhere. ``rng``: numpy Generator or
        random.Random.
        """
        ...

    def key(self, x: Element) -> Hashable:
        """A hashable value that represents x, equal for equal elements."""
        ...

    def __hash__(self) -> int: ...
