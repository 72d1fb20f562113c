"""Factors and roots of polynomials over finite fields and QQ, by python-flint."""

from __future__ import annotations

from typing import Any

from jacobian import poly
from jacobian.element import Element
from jacobian.fields.flint_polynomials import conversions
from jacobian.fields.protocol import Field
from jacobian.poly import Poly


def factor(K: Field[Element], a: Poly) -> list[tuple[Poly, int]]:
    """The monic irreducible factors of a non-zero polynomial over a finite field or QQ with their multiplicities,
    sorted.
    """
    into, back = conversions(K)
    found = [(poly.monic(K, back(P)), int(e)) for P, e in into(a).factor()[1]]
    return sorted(found, key=lambda item: (len(item[0]), item[0][::-1]))


def roots(K: Any, a: Poly) -> list[Any]:
    """The distinct roots in K, a finite field or QQ, of a non-zero polynomial, sorted."""
    given = a if K.order is None else linear_part(K, a)
    return sorted(K.neg(P[0]) for P, _ in factor(K, given) if len(P) == 2)


def without_root(K: Field[Element], a: Poly, x: Element) -> tuple[int, Poly]:
    """(m, a/(X − x)^m), where m ≥ 0 is the multiplicity of the root x of a non-zero polynomial a."""
    line, multiplicity = (K.neg(x), K.one), 0
    while poly.evaluate(K, a, x) == K.zero:
        a, multiplicity = poly.quotient(K, a, line), multiplicity + 1
    return multiplicity, a


def linear_part(K: Field[Element], a: Poly) -> Poly:
    """The product of the distinct monic linear factors of a non-zero polynomial over a finite field."""
    into, back = conversions(K)
    given = into(a)
    x = into((K.zero, K.one))
    power = x.pow_mod(K.order, given) if given.degree() > 0 else x
    return poly.monic(K, back(given.gcd(power - x)))
