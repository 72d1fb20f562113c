"""Invariants of curves of genus 2: Igusa–Clebsch, Igusa, and three that determine a curve over the algebraic closure.

Clebsch's invariants of the sextic F = h² + 4f are transvectants, which have denominators. Igusa's are polynomials in
the coefficients of f and h with integral coefficients. Over a finite field these coefficients are therefore lifted to
characteristic 0 and the result is reduced, which works in every characteristic. Elements of GF(p^k) are lifted to
polynomials modulo a lift of the polynomial that defines the field.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import reduce
from math import comb, factorial, perm
from typing import Any, NamedTuple

import flint

from jacobian.curve.curve import HyperellipticCurve, check_curve
from jacobian.element import Element
from jacobian.errors import ArgumentError, FieldError


class Ring(NamedTuple):
    """The ring in which invariants are computed; its elements have + and −.

    ``mul``: the product; ``scaled``: q·x for rational q; ``into`` and ``back``: the maps from and to the field.
    """

    into: Callable[[Any], Any]
    mul: Callable[[Any, Any], Any]
    scaled: Callable[[Fraction, Any], Any]
    back: Callable[[Any], Any]


def igusa_clebsch_invariants(C: HyperellipticCurve[Element]) -> tuple[Element, Element, Element, Element]:
    """(I2, I4, I6, I10) of the sextic h² + 4f (Mestre 1991, after Clebsch 1872); I10 is its discriminant.

    ArgumentError for another genus; FieldError in characteristic 2, where the invariants vanish: use
    :func:`igusa_invariants` there.
    """
    K = _genus_two(C).field
    if K.characteristic == 2:
        raise FieldError(f"field = {K.name}: h² + 4f is a square in characteristic 2; igusa_invariants(C) are defined")
    ring = _ring(K)
    i2, i4, i6, i10 = map(ring.back, _igusa_clebsch(ring, _sextic(C, ring)))
    return i2, i4, i6, i10


def igusa_invariants(C: HyperellipticCurve[Element]) -> tuple[Element, Element, Element, Element, Element]:
    """(J2, J4, J6, J8, J10) of a curve of genus 2 in any characteristic (Igusa 1960); 2¹²·J10 is the discriminant of
    h² + 4f. The map x' = (ax + b)/(cx + d), y' = (ey + t)/(cx + d)³ multiplies J_2k by (e²/(ad − bc)³)^2k.
    """
    K = _genus_two(C).field
    ring = _ring(K)
    i2, i4, i6, i10 = _igusa_clebsch(ring, _sextic(C, ring))
    mul, scaled = ring.mul, ring.scaled
    j2 = scaled(Fraction(1, 8), i2)
    square = mul(j2, j2)
    j4 = scaled(Fraction(1, 96), scaled(Fraction(4), square) - i4)
    j6 = scaled(Fraction(1, 576), scaled(Fraction(8), mul(square, j2)) - scaled(Fraction(160), mul(j2, j4)) - i6)
    j8 = scaled(Fraction(1, 4), mul(j2, j6) - mul(j4, j4))
    j2, j4, j6, j8, j10 = map(ring.back, (j2, j4, j6, j8, scaled(Fraction(1, 4096), i10)))
    return j2, j4, j6, j8, j10


def g2_invariants(C: HyperellipticCurve[Element]) -> tuple[Element, Element, Element]:
    """Three numbers that two curves of genus 2 share exactly if they are isomorphic over the algebraic closure
    (Cardona, Quer, Nart and Pujolàs 2005). The field is exact, of characteristic other than 2.

    The numbers are (J2⁵, J2³J4, J2²J6)/J10; if J2 = 0, (0, J4⁵/J10², J4J6/J10); if J4 = 0 too, (0, 0, J6⁵/J10³).
    """
    K = _genus_two(C).field
    if K.characteristic == 2 or not K.exact:
        raise FieldError(f"field = {K.name}: these invariants are for exact fields of characteristic other than 2")
    j2, j4, j6, _, j10 = igusa_invariants(C)

    def ratio(above: list[Any], below: int) -> Any:
        return K.div(reduce(K.mul, above), reduce(K.mul, [j10] * below))

    if j2 != K.zero:
        return ratio([j2] * 5, 1), ratio([j2] * 3 + [j4], 1), ratio([j2] * 2 + [j6], 1)
    if j4 != K.zero:
        return K.zero, ratio([j4] * 5, 2), ratio([j4, j6], 1)
    return K.zero, K.zero, ratio([j6] * 5, 3)


def _genus_two(C: HyperellipticCurve[Element]) -> HyperellipticCurve:
    if check_curve(C).genus != 2:
        raise ArgumentError(f"C = {C!r} has genus {C.genus}: these are invariants of curves of genus 2")
    return C


def _ring(K: Any) -> Ring:
    if K.order is None:
        return Ring(lambda x: x, K.mul, lambda q, x: K.mul(K.coerce(q), x), lambda x: x)
    if K.degree == 1:
        return Ring(Fraction, lambda x, y: x * y, lambda q, x: q * x, K.coerce)
    modulus = flint.fmpq_poly(list(map(int, K.modulus)))
    return Ring(
        lambda x: flint.fmpq_poly([int(c) for c in K.coefficients(x)]),
        lambda x, y: x * y % modulus,
        lambda q, x: flint.fmpq(q.numerator, q.denominator) * x,
        lambda x: K.coerce([Fraction(int(c.p), int(c.q)) for c in x.coeffs()]),
    )


def _sextic(C: HyperellipticCurve, ring: Ring) -> list[Any]:
    """The seven coefficients of h² + 4f in the ring."""
    zero = ring.into(C.field.zero)
    f = [ring.into(c) for c in C.f] + [zero] * (7 - len(C.f))
    h = [ring.into(c) for c in C.h] + [zero] * (4 - len(C.h))
    F = [ring.scaled(Fraction(4), c) for c in f]
    for i, x in enumerate(h):
        for j, y in enumerate(h):
            F[i + j] = F[i + j] + ring.mul(x, y)
    return F


def transvectant(ring: Ring, f: list[Any], g: list[Any], order: int) -> list[Any]:
    """The transvectant (f, g)_k, k = ``order``, of binary forms of degrees m = len f − 1 and n = len g − 1, with the
    factor (m−k)!(n−k)!/(m!n!).
    """
    m, n = len(f) - 1, len(g) - 1
    size = Fraction(factorial(m - order) * factorial(n - order), factorial(m) * factorial(n))
    total: list[Any] = [None] * (m + n - 2 * order + 1)
    for i in range(order + 1):
        sign = size * (-1) ** i * comb(order, i)
        for a, x in _derivative(f, order - i, i):
            for b, y in _derivative(g, i, order - i):
                term = ring.scaled(sign * x[0] * y[0], ring.mul(x[1], y[1]))
                total[a + b] = term if total[a + b] is None else total[a + b] + term
    return total


def _derivative(form: list[Any], by_x: int, by_y: int) -> list[tuple[int, tuple[int, Any]]]:
    """The terms of a form after ``by_x`` and ``by_y`` differentiations: (power of x, (factor, coefficient))."""
    degree = len(form) - 1
    return [(k - by_x, (perm(k, by_x) * perm(degree - k, by_y), form[k])) for k in range(by_x, degree - by_y + 1)]


def _igusa_clebsch(ring: Ring, F: list[Any]) -> tuple[Element, Element, Element, Element]:
    """(I2, I4, I6, I10) of the sextic F, from Clebsch's A, B, C, D (Mestre 1991)."""
    i = transvectant(ring, F, F, 4)
    delta = transvectant(ring, i, i, 2)
    y1 = transvectant(ring, F, i, 4)
    y2 = transvectant(ring, i, y1, 2)
    y3 = transvectant(ring, i, y2, 2)
    A, B = transvectant(ring, F, F, 6)[0], transvectant(ring, i, i, 4)[0]
    C, D = transvectant(ring, i, delta, 4)[0], transvectant(ring, y3, y1, 2)[0]

    def combined(*terms: tuple[int, str]) -> Any:
        named = {"A": A, "B": B, "C": C, "D": D}
        parts = [ring.scaled(Fraction(c), reduce(ring.mul, [named[x] for x in product])) for c, product in terms]
        return reduce(lambda x, y: x + y, parts)

    return (
        combined((-120, "A")),
        combined((-720, "AA"), (6750, "B")),
        combined((8640, "AAA"), (-108000, "AB"), (202500, "C")),
        combined(
            (-62208, "AAAAA"), (972000, "AAAB"), (1620000, "AAC"), (-3037500, "ABB"), (-6075000, "BC"), (-4556250, "D")
        ),
    )
