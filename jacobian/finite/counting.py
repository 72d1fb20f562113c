"""The number of points of a curve over small fields, and the Frobenius polynomial that follows from it.

In odd characteristic x is the abscissa of one point if h(x)² + 4f(x) = 0, and of two if this number is a non-zero
square. Tables of logarithms decide what is a square, in fields of up to 2^20 elements. In GF(q^i), q an odd prime, of
4097 to 10^7 elements, the norm to GF(q) decides. In characteristic 2, x is the abscissa of one point if h(x) = 0,
and of two if h(x) ≠ 0 and the trace of f(x)/h(x)² is 0.
"""

from __future__ import annotations

from typing import Any

from jacobian import poly
from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import FieldError, Infeasible, shown
from jacobian.fields.irreducible import first_irreducible
from jacobian.fields.prime import prime_field
from jacobian.fields.table import TableField
from jacobian.finite import weil

TABLE_SIZE = 1 << 20
ARRAY_SIZE = 10**7
_CHUNK = 1 << 18


def frobenius_polynomial(C: HyperellipticCurve) -> list[int]:
    """The characteristic polynomial of Frobenius on the Jacobian, ascending, of degree 2g (Weil)."""
    q: Any = C.field.order
    g = C.genus
    _check_feasible(C, g)
    return weil.from_leading(weil.leading([count_points(C, i) - q**i - 1 for i in range(1, g + 1)]), q)


def count_points(C: HyperellipticCurve, degree: int = 1) -> int:
    """The number of points of C over GF(q^degree), points at infinity included.

    Infeasible beyond the sizes named in the module's docstring.
    """
    K = C.field
    if K.order is None:
        raise FieldError(f"field = {K.name}: points are counted over finite fields")
    _check_feasible(C, degree)
    at_infinity = {"ramified": 1, "split": 2, "inert": 0 if degree % 2 else 2}[C.model]
    if K.order == K.characteristic != 2 and K.order**degree > 4096:
        return at_infinity + _count_by_norms(C, degree)
    return at_infinity + _count_by_tables(C, degree)


def _check_feasible(C: HyperellipticCurve, degree: int) -> None:
    q: Any = C.field.order
    limit = ARRAY_SIZE if q == C.field.characteristic != 2 else TABLE_SIZE
    if q**degree > limit:
        raise Infeasible(
            f"{q}^{shown(degree)} elements of the field that has to be searched: counting points one by one ends at "
            f"{limit}"
        )


def _count_by_tables(C: HyperellipticCurve, degree: int) -> int:
    import numpy as np

    K: Any = C.field
    size = degree * K.degree
    if size == 1:
        return sum(len(C.lift_x(x, all=True)) for x in range(K.order))
    base = prime_field(K.characteristic)
    L = K if degree == 1 and isinstance(K, TableField) else TableField(base, first_irreducible(base, size))
    if L.p == 2:
        return _count_by_trace(L, _embed(K, L, C.h), _embed(K, L, C.f))
    value = _values(L, _embed(K, L, C.discriminant))
    odd = np.array(L._log)[value[value != 0]] % 2
    return L.order + len(odd) - 2 * int(odd.sum())


def _count_by_trace(L: TableField, h: poly.Poly, f: poly.Poly) -> int:
    import numpy as np

    # the trace of an element is the parity of its bits in the mask
    mask = sum(1 << i for i in range(L.degree) if L.trace(1 << i))
    exp, log = np.array(L._exp), np.array(L._log)
    slope, value = _values(L, h), _values(L, f)
    ratio = np.where(value != 0, exp[(log[value] - 2 * log[slope]) % (L.order - 1)], 0)[slope != 0] & mask
    for shift in (16, 8, 4, 2, 1):
        ratio ^= ratio >> shift
    return L.order + len(ratio) - 2 * int((ratio & 1).sum())


def _values(L: TableField, a: poly.Poly) -> Any:
    """The values of the polynomial ``a`` at all elements 0, 1, … of L, an array."""
    import numpy as np

    exp, log, zech = np.array(L._exp), np.array(L._log), np.array(L._zech)
    x = np.arange(L.order)
    value = np.zeros_like(x)
    for c in reversed(a):
        value = np.where((value != 0) & (x != 0), exp[log[value] + log], 0)
        if L.p == 2:
            value ^= c
        elif c:
            # a negative difference of logarithms indexes the table from its end, as intended
            more = zech[log[c] - log[value]]
            value = np.where(value == 0, c, np.where(more >= 0, exp[log[value] + more], 0))
    return value


def _embed(K: Any, L: TableField, a: poly.Poly) -> poly.Poly:
    """The polynomial ``a`` over the larger field L; the generator of K is mapped to a root of the modulus of K."""
    if K is L or K.degree == 1:
        return a
    root = int((_values(L, K.modulus) == 0).argmax())
    return tuple(poly.evaluate(L, tuple(K.coefficients(c)), root) for c in a)


def _count_by_norms(C: HyperellipticCurve, degree: int) -> int:
    """The number Σ (1 + χ(h² + 4f)) of affine points over GF(p^degree), χ being the quadratic character.

    Many elements are one list of ascending coefficients, each an array. χ is computed from the norm to GF(p).
    """
    import numpy as np

    p: Any = C.field.order
    modulus = first_irreducible(prime_field(p), degree) if degree > 1 else (0, 1)
    character = np.full(p, -1, dtype=np.int64)
    character[np.arange(p, dtype=np.int64) ** 2 % p] = 1
    character[0] = 0
    frobenius = [poly.power_mod(C.field, (0, 1), p * i, modulus) for i in range(degree)] if degree > 1 else []
    total = 0
    for start in range(0, p**degree, _CHUNK):
        number = np.arange(start, min(start + _CHUNK, p**degree), dtype=np.int64)
        x = [number // p**i % p for i in range(degree)]
        value = [np.zeros_like(number) for _ in range(degree)]
        for c in reversed(C.discriminant):
            value = _multiply(value, x, modulus, p)
            value[0] = (value[0] + c) % p
        total += number.size + int(character[_norm(value, frobenius, modulus, p)].sum())
    return total


def _norm(value: list[Any], frobenius: list[poly.Poly], modulus: poly.Poly, p: int) -> Any:
    norm = conjugate = value
    for _ in range(len(value) - 1):
        # the p-th power of Σ c_i a^i is Σ c_i (a^i)^p, and row i of ``frobenius`` is (a^i)^p
        rows = [(*row, *[0] * (len(value) - len(row))) for row in frobenius]
        conjugate = [sum(c * row[j] for c, row in zip(conjugate, rows, strict=True)) % p for j in range(len(value))]
        norm = _multiply(norm, conjugate, modulus, p)
    return norm[0]


def _multiply(a: list[Any], b: list[Any], modulus: poly.Poly, p: int) -> list[Any]:
    """The products of elements of GF(p)[a]/(modulus), given as lists of ascending coefficients, each an array."""
    size = len(a)
    total = [0] * (2 * size - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            total[i + j] = total[i + j] + x * y
    for top in range(2 * size - 2, size - 1, -1):
        lead = total[top] % p
        for j, m in enumerate(modulus[:-1]):
            total[top - size + j] = total[top - size + j] - lead * m
    return [c % p for c in total[:size]]
