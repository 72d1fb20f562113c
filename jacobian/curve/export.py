"""Curves for other systems: python-flint's polynomials, and texts that PARI and Sage read.

The opposite direction needs no function: polynomials and fields (except GF(p^k)) accept polynomials and numbers of
python-flint and PARI (:mod:`jacobian.poly`, :mod:`jacobian.fields.coercion`).
"""

from __future__ import annotations

from typing import Any

from jacobian import poly
from jacobian.element import Arithmetic
from jacobian.errors import FieldError
from jacobian.fields.flint_polynomials import conversions
from jacobian.fields.protocol import Field


def to_flint(K: Field, *polynomials: poly.Poly) -> tuple[Any, ...]:
    """The polynomials, converted to python-flint's; FieldError over an inexact field."""
    into, _ = conversions(_exact(K))
    return tuple(map(into, polynomials))


def to_pari(K: Any, *polynomials: poly.Poly) -> str:
    """The vector of polynomials in x, as text for GP or ``cypari.pari``; over GF(p^k) it first defines ``a``."""
    vector = ", ".join(_pari_polynomial(_exact(K), a) for a in polynomials)
    if K.order is None or K.degree == 1:
        return f"[{vector}]"
    modulus = " + ".join(f"{c}*x^{i}" for i, c in enumerate(K.modulus) if c)
    return f"a = ffgen(Mod(1, {K.characteristic})*({modulus}), 'a); [{vector}]"


def _pari_polynomial(K: Field, a: poly.Poly) -> str:
    terms = [f"{_pari_element(K, c)}*x^{i}" for i, c in enumerate(a) if c != K.zero]
    return " + ".join(terms) or _pari_element(K, K.zero)


def _pari_element(K: Any, c: Any) -> str:
    if K.order is None:
        return f"({_exactly(c)})"
    if K.degree == 1:
        return f"Mod({c}, {K.p})"
    return f"({' + '.join(f'{part}*a^{i}' for i, part in enumerate(K.coefficients(c)))})"


def to_sage(K: Any, f: poly.Poly, h: poly.Poly) -> str:
    """Two lines of Sage that make R, the ring of polynomials over the field, and C, the curve.

    They mean the same at Sage's prompt and in a Python program, where ^ is not a power and 1/3 is a float.
    """
    if _exact(K).order is None:
        field = "QQ"
    elif K.degree == 1:
        field = f"GF({K.p})"
    else:
        field = f"GF({K.characteristic}**{K.degree}, 'a', modulus=GF({K.characteristic})['x']({list(K.modulus)}))"
    parts = (f"R([{', '.join(_sage_element(K, c) for c in a)}])" for a in (f, h))
    return f"R = PolynomialRing({field}, 'x')\nC = HyperellipticCurve({', '.join(parts)})"


def _sage_element(K: Any, c: Any) -> str:
    if K.order is None and c.denominator > 1:
        return f"QQ('{_exactly(c)}')"
    return _exactly(c) if K.order is None or K.degree == 1 else f"R.base_ring()({list(K.coefficients(c))})"


def _exactly(c: Any) -> str:
    """All digits of an int or a fraction; Python's str refuses more than 4300."""
    from gmpy2 import mpq

    return str(mpq(c))


def _exact(K: Arithmetic) -> Any:
    if not K.exact:
        raise FieldError(f"field = {K.name}: finite fields and QQ are written for other systems, not floats")
    return K
