"""What a field is: a context that computes with bare elements.

Elements stay ordinary Python objects (``int``, ``Fraction``, ``float``, ``complex``, ``mpf``), and the field supplies
the operations. Polynomials and divisors ask the field for every operation, so one Cantor serves them all.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any, Protocol, TypeVar, runtime_checkable

from jacobian.errors import ArgumentError, shown

Element = TypeVar("Element")


def check_field(K: Any, argument: str) -> Any:
    """``K``, or an ArgumentError that names ``argument``."""
    if not hasattr(K, "coerce") or not hasattr(K, "characteristic"):
        raise ArgumentError(f"{argument} = {shown(K)} is not a field: give GF(p), GF(p, k), QQ, RR, CC or MP(dps)")
    return K


@runtime_checkable
class Field(Protocol[Element]):
    """A field as a context over raw elements of type ``Element``.

    ``exact`` fields decide equality; inexact ones decide it against a scale, or raise
    :class:`~jacobian.errors.PrecisionLoss`. Two fields are the same field when they compare equal.
    """

    name: str
    exact: bool
    characteristic: int
    order: int | None
    zero: Element
    one: Element

    def coerce(self, value: Any, argument: str = "value") -> Element:
        """The element that ``value`` stands for, or a FieldError that names ``argument``.

        Every field reads rational numbers (:func:`jacobian.fields.coercion.rational`): ints of any kind, fractions,
        Decimals, and strings such as "3", "-1/3", "0.25" and "1e3". GF(p) takes those whose denominator p does not
        divide. GF(p^k) writes its elements as ints, so it takes whole numbers only, and lists of coefficients. RR, CC
        and MP round them once, and read floats too; CC and MP(dps, complex=True) also read complex numbers; exact
        fields refuse floats, because 0.1 is not 1/10. Arrays without dimensions count as their number. NaN, infinities,
        bytes, and arrays and sequences are refused.
        """
        ...

    def add(self, x: Element, y: Element) -> Element: ...

    def sub(self, x: Element, y: Element) -> Element: ...

    def mul(self, x: Element, y: Element) -> Element: ...

    def neg(self, x: Element) -> Element: ...

    def inv(self, x: Element) -> Element:
        """1/x; ZeroDivisionError at zero."""
        ...

    def div(self, x: Element, y: Element) -> Element: ...

    def dot(self, xs: Sequence[Element], ys: Sequence[Element]) -> Element:
        """Σ x_i y_i, reduced (or rounded) once."""
        ...

    def is_zero(self, x: Element, scale: Any = None) -> bool:
        """Whether x is zero: exactly, or relative to ``scale``, the size of the terms of the difference x."""
        ...

    def sqrt(self, x: Element) -> Element:
        """One square root of x, or NotASquare."""
        ...

    def random(self, rng: Any) -> Element:
        """A random element: uniform over a finite field, of moderate size elsewhere. ``rng``: numpy Generator or
        random.Random.
        """
        ...

    def key(self, x: Element) -> Hashable:
        """A hashable stand-in for x, equal for equal elements."""
        ...

    def __hash__(self) -> int: ...
