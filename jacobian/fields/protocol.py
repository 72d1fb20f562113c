"""The interface of a field, an object that computes with raw elements, and the base of fields with operators.

Elements stay ordinary Python objects (``int``, ``Fraction``, ``float``, ``complex``, ``mpf``), and the field supplies
the operations. Polynomials and divisors leave every operation to the field, so one algorithm serves all fields.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Hashable, Sequence
from typing import Any, Generic, Protocol, runtime_checkable

from jacobian.element import Arithmetic, Element, Rng
from jacobian.errors import ArgumentError, shown
from jacobian.immutable import Immutable


def check_field(K: Field[Element], argument: str) -> Field[Element]:
    """``K``, or an ArgumentError that names ``argument``."""
    if not hasattr(K, "coerce") or not hasattr(K, "characteristic"):
        raise ArgumentError(f"{argument} = {shown(K)} is not a field: give GF(p), GF(p, k), QQ, RR, CC or MP(dps)")
    return K


@runtime_checkable
class Field(Arithmetic[Element], Protocol[Element]):
    """A field: the operations on raw elements of type ``Element``.

    ``exact`` fields decide equality; inexact ones decide it relative to a scale, or raise
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


class OperatorField(Immutable, Generic[Element]):
    """Base of the fields whose operations are Python's operators: QQ, RR, CC and MP."""

    name: str
    characteristic = 0
    order = None
    zero: Element

    def __repr__(self) -> str:
        return self.name

    # these are the operators themselves, since a wrapping method would double the cost
    add: Callable[[Element, Element], Element] = staticmethod(operator.add)
    sub: Callable[[Element, Element], Element] = staticmethod(operator.sub)
    mul: Callable[[Element, Element], Element] = staticmethod(operator.mul)
    div: Callable[[Element, Element], Element] = staticmethod(operator.truediv)
    neg: Callable[[Element], Element] = staticmethod(operator.neg)  # type: ignore[assignment]

    def inv(self, x: Element) -> Element:
        result: Element = operator.truediv(1, x)
        return result

    def dot(self, xs: Sequence[Element], ys: Sequence[Element]) -> Element:
        """Σ x_i y_i; fields that round it once override this method."""
        zero: Any = self.zero
        result: Element = sum(map(operator.mul, xs, ys), zero)
        return result

    def key(self, x: Element) -> Hashable:
        """x itself, which is hashable."""
        return x

    def from_key(self, key: Element) -> Element:
        """The element whose :meth:`key` is ``key``."""
        return key
