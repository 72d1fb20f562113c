"""Maps between fields: reduction modulo p, finite fields inside larger ones and back, rounding."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from jacobian import poly
from jacobian.errors import FieldError, shown, written
from jacobian.fields.extension import ExtensionField
from jacobian.fields.factor import roots
from jacobian.fields.prime import PrimeField
from jacobian.linear import echelon


class Embedding:
    """The field K = GF(p^k) as a subfield of L = GF(p^(km)); get one from :func:`embedding`.

    The generator of K is mapped to the smallest root of its modulus in L, so the choice is the same in every run.
    """

    def __init__(self, K: Any, L: Any) -> None:
        self.small, self.large = K, L
        self._base = K if K.degree == 1 else K.base
        generator = roots(L, tuple(L.coerce(c) for c in K.modulus))[0] if K.degree > 1 else L.one
        self._generator = generator
        powers = [L.one]
        for _ in range(K.degree - 1):
            powers.append(L.mul(powers[-1], generator))
        rows = [[*self._digits(power), *(int(i == j) for j in range(K.degree))] for i, power in enumerate(powers)]
        # (pivot, row of the reduced echelon form of the powers' coordinates, the row as a combination of the powers)
        self._rows = [(i, row[: L.degree], row[L.degree :]) for i, row in echelon(self._base, rows, L.degree)]

    def __call__(self, x: Any) -> Any:
        """The image in L of an element of K."""
        K, L = self.small, self.large
        if K.degree == 1:
            return x
        return poly.evaluate(L, tuple(K.coefficients(x)), self._generator)

    def polynomial(self, a: poly.Poly) -> poly.Poly:
        """The image in L[x] of a polynomial over K."""
        return tuple(self(c) for c in a)

    def frobenius(self, y: Any) -> Any:
        """y to the power #K, the conjugate of y over K."""
        return self.large.power(y, self.small.order)

    def back(self, y: Any) -> Any:
        """The element of K whose image is y; FieldError for a y outside K."""
        base, rest = self._base, self._digits(y)
        digits = [0] * self.small.degree
        for pivot, row, combination in self._rows:
            c = rest[pivot]
            if c:
                rest = [base.sub(a, base.mul(c, b)) for a, b in zip(rest, row, strict=True)]
                digits = [base.add(a, base.mul(c, b)) for a, b in zip(digits, combination, strict=True)]
        if any(rest):
            raise FieldError(f"{written(y)} of {self.large.name} does not lie in {self.small.name}")
        return digits[0] if self.small.degree == 1 else self.small.coerce(digits)

    def _digits(self, y: Any) -> list[int]:
        return self.large.coefficients(y) if self.large.degree > 1 else [y]


_embedding = lru_cache(maxsize=64)(Embedding)


def embedding(K: Any, L: Any) -> Embedding:
    """The embedding of K into L, or a FieldError when L is not a finite field that contains K."""
    if K.order is None:
        raise FieldError(f"field = {K.name}: points are conjugate over finite fields")
    if not isinstance(L, PrimeField | ExtensionField):
        raise FieldError(f"extension = {shown(L)}: a finite field that contains {K.name} is needed")
    if L.characteristic != K.characteristic or L.degree % K.degree:
        raise FieldError(f"extension = {L.name} does not contain {K.name}")
    return _embedding(K, L)


def change_of_field(K: Any, L: Any) -> Callable[[Any], Any]:
    """The map from elements of K to elements of L; FieldError where there is none, or for an element without an image.

    QQ maps to every field: by reduction modulo p if p does not divide the denominator, or by rounding. A finite field
    maps into those that contain it, by :func:`embedding`, and back for elements of the smaller field. Inexact fields
    map to inexact fields.
    """
    if K == L:
        return lambda x: x
    both_finite = K.order is not None and L.order is not None and K.characteristic == L.characteristic
    if both_finite and L.degree % K.degree == 0:
        return embedding(K, L)
    if both_finite and K.degree % L.degree == 0:
        return embedding(L, K).back
    if K.order is not None or (L.exact and not K.exact):
        raise FieldError(f"K = {L.name}: there is no map from {K.name} to it that respects + and ·")
    # an int stands for an element of GF(p^k), so the image of a rational number is computed in GF(p)
    target = getattr(L, "base", L) if L.order is not None else L
    return lambda x: target.coerce(x, "coefficient")
