"""Fields: objects that compute with raw elements (:class:`jacobian.fields.protocol.Field`)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, SupportsIndex

from jacobian import poly
from jacobian.element import Coefficients
from jacobian.errors import ArgumentError, flag, shown, whole
from jacobian.fields.machine import ComplexField, RealField
from jacobian.fields.prime import PrimeField, check_prime, prime_field, prime_fields
from jacobian.fields.protocol import Field
from jacobian.fields.rational import RationalField

if TYPE_CHECKING:
    from jacobian.fields.finite import FiniteField
    from jacobian.fields.multiprecision import MultiprecisionField

QQ = RationalField()
RR = RealField()
CC = ComplexField()


def GF(p: SupportsIndex | type, k: int = 1, modulus: Coefficients | None = None) -> FiniteField:
    """The finite field of p^k elements; the same arguments give the same object.

    ``p`` is a prime, or a galois field class as the only argument. ``modulus``: ascending coefficients of a monic
    irreducible polynomial of degree k over GF(p); by default galois's Conway polynomial, or the first irreducible one
    where its table has none. Elements are ints: in [0, p), or Σ c_i p^i for Σ c_i a^i, a the root of the modulus.
    ArgumentError for a composite p, a k that is not a positive int, or a reducible modulus.
    """
    if isinstance(p, type) and hasattr(p, "irreducible_poly"):
        return _from_galois(p)
    k = whole(k, "k", "the degree of the field over GF(p) is an int ≥ 1", 1)
    if type(p) is not int or p not in prime_fields:
        p = check_prime(p)
    base = prime_field(p)
    if k == 1 and modulus is not None:
        raise ArgumentError(f"modulus = {shown(modulus)}: GF({shown(p)}) has none, it belongs to GF(p, k) with k > 1")
    return base if k == 1 else _extension(base, k, modulus)


def _extension(base: PrimeField, k: int, modulus: Any) -> FiniteField:
    from jacobian.fields.digits import DigitField, QuadraticField
    from jacobian.fields.extension import coerce_modulus, extension_field, extension_fields
    from jacobian.fields.irreducible import default_modulus, is_irreducible
    from jacobian.fields.table import TABLE_LIMIT, TableField

    modulus = coerce_modulus(base, k, default_modulus(base, k) if modulus is None else modulus)
    if (base.p, modulus) in extension_fields:
        return extension_fields[base.p, modulus]
    if not is_irreducible(base, modulus):
        formula = poly.text(base, modulus, "a")
        raise ArgumentError(f"modulus = {formula} is reducible over {base.name}: give an irreducible polynomial")
    small = base.p**k <= TABLE_LIMIT
    return extension_field(
        TableField if small else QuadraticField if k == 2 and base.p > 2 else DigitField, base, modulus
    )


def _from_galois(field: Any) -> FiniteField:
    if field.degree == 1:
        return GF(int(field.characteristic))
    from jacobian.fields.extension import galois_modulus

    K = GF(int(field.characteristic), int(field.degree), galois_modulus(field))
    K.__dict__.setdefault("galois", field)
    return K


def MP(dps: int, complex: bool = False) -> MultiprecisionField:
    """The real (or complex) numbers with ``dps`` decimal digits, on an mpmath context of its own.

    The field has ``.dps``, ``.context`` and ``.eps``; its elements are mpf (or mpc). The same arguments give the same
    object.
    """
    from jacobian.fields.multiprecision import MOST_DIGITS, multiprecision_field

    dps = whole(dps, "dps", f"the number of decimal digits is an int from 1 to {MOST_DIGITS}", 1, MOST_DIGITS)
    return multiprecision_field(dps, flag(complex, "complex"))


__all__ = ["CC", "GF", "MP", "QQ", "RR", "Field"]
