"""Conversion of polynomials over exact fields to python-flint's: ``nmod_poly`` and ``fmpz_mod_poly`` over GF(p),
``fq_default_poly`` over GF(p^k), ``fmpq_poly`` over QQ.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache, lru_cache
from typing import Any

from jacobian.fields.irreducible import kept, prime_ring
from jacobian.fields.prime import PrimeField
from jacobian.fields.rational import RationalField
from jacobian.fields.table import TableField

Conversions = tuple[Callable[[Any], Any], Callable[[Any], Any]]


@lru_cache(maxsize=64)
def conversions(K: Any) -> Conversions:
    """Two functions: from ascending coefficients over K to a flint polynomial, and back."""
    # flint is imported here, since single divisors over small fields do not need it
    import flint

    if isinstance(K, RationalField):
        return (
            lambda a: flint.fmpq_poly([flint.fmpq(c.numerator, c.denominator) for c in a]),
            lambda a: tuple([Fraction(int(c.p), int(c.q)) for c in a.coeffs()]),
        )
    if isinstance(K, PrimeField):
        p = K.p
        word = p < 1 << 63
        into: Any = None if word else prime_ring(p)
        return (
            (lambda a: flint.nmod_poly(list(a), p)) if word else (lambda a: into(list(a) or [0])),
            lambda a: tuple(map(int, a.coeffs())),
        )
    return _extension_conversions(K)


def _extension_conversions(K: Any) -> Conversions:
    field, ring = _extension_ring(K.p, tuple(K.modulus))

    def element(x: int) -> Any:
        return field(K.coefficients(x))

    if isinstance(K, TableField):
        element = cache(element)

    def back(a: Any) -> tuple[int, ...]:
        return tuple([K._pack(list(map(int, c.to_list()))) for c in a.coeffs()])

    return lambda a: ring([element(c) for c in a] or [0]), back


@cache
def _extension_ring(p: int, modulus: tuple[int, ...]) -> tuple[Any, Any]:
    """The field GF(p)[a]/modulus, and the ring of polynomials over it."""
    import flint

    field = flint.fq_default_ctx(modulus=prime_ring(p)(list(modulus)), var="a")
    return field, kept(flint.fq_default_poly_ctx(field))
