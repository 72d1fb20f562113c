"""Cantor's composition and reduction on python-flint's polynomials, which are faster on many curves.

Triples consist of raw elements (ints, Fractions); the polynomials inside are those of
:mod:`jacobian.fields.flint_polynomials`. An addition, conversions included, takes at most a third of the time of
Cantor's algorithm in Python (``python -m benchmarks single heights``). python-flint is not used where explicit formulas
are as fast: in genus 2 over GF(p) and small extensions, and in genus 3 over GF(p). Nor is it used over large fields of
characteristic 2, where converting an element takes as long as multiplying it.

The formulas are those of :mod:`jacobian.addition.cantor`; tests check that both agree.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from jacobian.addition import cantor
from jacobian.addition.explicit import formulas_of
from jacobian.curve.curve import HyperellipticCurve
from jacobian.fields.digits import DigitField
from jacobian.fields.extension import ExtensionField
from jacobian.fields.flint_polynomials import conversions
from jacobian.fields.prime import PrimeField
from jacobian.fields.rational import RationalField

Flint = tuple[Any, Any, "int | None"]


def pays(C: HyperellipticCurve) -> bool:
    """Whether python-flint is faster than the Python kernels on this curve."""
    K = C.field
    if type(K) is DigitField:
        # every operation splits elements into digits, which makes the explicit formulas in Python slow
        return K.p != 2
    if formulas_of(C) is not None:
        return isinstance(K, RationalField)
    return isinstance(K, RationalField | PrimeField | ExtensionField)


class FlintCantor:
    """Addition and doubling of reduced triples on a curve that is its own ``arithmetic_model``, over an exact field."""

    def __init__(self, C: HyperellipticCurve) -> None:
        self._into, self._back = conversions(C.field)
        self.f, self.h = self._into(C.f), self._into(C.h)
        self.genus, self.split = C.genus, C.model == "split"
        self.limit = C.genus + self.split
        if self.split:
            # ``parts`` are V₊ and V₋, ``lead`` is the coefficient of x^(g+1) in V₊
            self.parts = tuple(map(self._into, C.principal_parts))
            self.lead = self._into((C.infinity_plus,))[0]

    def sum_of(self, a: cantor.Triple, b: cantor.Triple) -> cantor.Triple:
        into = self._into
        u, v, n, _ = self.composed((into(a[0]), into(a[1]), a[2]), (into(b[0]), into(b[1]), b[2]))
        return self._reduced(u, v, n)

    def double(self, a: cantor.Triple) -> cantor.Triple:
        u, v, n, _ = self.doubled((self._into(a[0]), self._into(a[1]), a[2]))
        return self._reduced(u, v, n)

    def composed(self, a: Flint, b: Flint) -> tuple[Any, Any, int | None, Any]:
        """(u, v, n, d) in flint's polynomials: a + b before reduction, and d = gcd(u₁, u₂, v₁+v₂+h)."""
        (u1, v1, n1), (u2, v2, n2) = a, b
        d, _, s = u1.xgcd(u2)
        k = s * (v1 - v2)
        if d.degree() > 0:
            d, r, t = d.xgcd(v1 + v2 + self.h)
            k = r * k + t * self._cofactor(u2, v2)
            u1, u2 = u1 // d, u2 // d
        return self._assembled(u1, u2, v2, k, d, None if n1 is None or n2 is None else n1 + n2)

    def doubled(self, a: Flint) -> tuple[Any, Any, int | None, Any]:
        """(u, v, n, d) as in :meth:`composed`, for a + a."""
        u, v, n = a
        d, _, t = u.xgcd(v + v + self.h)
        k = t * self._cofactor(u, v)
        if d.degree() > 0:
            u = u // d
        return self._assembled(u, u, v, k, d, None if n is None else 2 * n)

    def _cofactor(self, u: Any, v: Any) -> Any:
        return (self.f - v * (v + self.h)) // u

    def _assembled(
        self, u1: Any, u2: Any, v: Any, k: Any, d: Any, weights: int | None
    ) -> tuple[Any, Any, int | None, Any]:
        """(u₁u₂, v + u₂·(k mod u₁), n, d). The factor d is already divided out of u₁ and u₂."""
        n = None if weights is None else weights + d.degree() - (self.genus + 1) // 2
        return u1 * u2, v + u2 * (k % u1), n, d

    def reductions(self, u: Any, v: Any, n: int | None) -> Iterator[tuple[Any, Flint]]:
        """Yields (v, (u', v', n')) for each step of :func:`jacobian.addition.cantor.reduce`, a reflection at y − v."""
        while u.degree() > self.limit:
            line = v
            u, v, n = self._reflect(u, v, n)
            yield line, (u, v, n)
        while n is not None and not 0 <= n <= self.genus - u.degree():
            part = self.parts[1 if n < 0 else 0]
            line = part + (v - part) % u
            u, v, n = self._reflect(u, line, n)
            yield line, (u, v, n)

    def _reduced(self, u: Any, v: Any, n: int | None) -> cantor.Triple:
        for _, last in self.reductions(u, v, n):
            u, v, n = last
        lead = u.leading_coefficient()
        if lead != 1:
            u = u * (1 / lead)
        return self._back(u), self._back(v % u), n

    def _reflect(self, u: Any, v: Any, n: int | None) -> tuple[Any, Any, int | None]:
        """The triple of :func:`jacobian.addition.cantor.reflect`, but u' is not made monic."""
        other = self._cofactor(u, v)
        if n is not None:
            size = self.genus + 1
            if v.degree() > size:
                n += v.degree() - other.degree()
            elif v[size] == self.lead:
                n += u.degree() - size
            else:
                n += size - other.degree()
        return other, -(v + self.h) % other, n
