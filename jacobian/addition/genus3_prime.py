"""Explicit formulas of genus 3 over GF(p) on Python's or GMP's integers: those of
:mod:`jacobian.addition.genus3_words`, and those of split models.

Like :mod:`jacobian.addition.genus2_prime` this is a copy for Python: sums of products are reduced once. Special
positions are left to Cantor's algorithm, and tests compare both.
"""

from __future__ import annotations

from typing import Any

from jacobian.addition import cantor
from jacobian.addition.genus3_words import is_short_septic
from jacobian.curve.curve import HyperellipticCurve, coefficient
from jacobian.fields.prime import PrimeField

Row = tuple[int, ...]


class SepticFormulas:
    """Addition and doubling of reduced triples on y² = f over GF(p), f monic of degree 7."""

    def __init__(self, C: HyperellipticCurve) -> None:
        K: Any = C.field
        self.curve, self.p = C, K.p
        self.coefficients = (self.p, *(coefficient(K, C.f, i) for i in range(3, 9)), C.infinity_plus)

    def sum_of(self, a: cantor.Triple, b: cantor.Triple) -> cantor.Triple:
        """The reduced triple of a + b."""
        (u1, v1, _), (u2, v2, _) = a, b
        # a class whose v has three coefficients has weight 3; all others are left to Cantor's algorithm
        if len(v1) == 3 == len(v2):
            (a0, a1, a2, _), (b0, b1, b2), (c0, c1, c2, _), (d0, d1, d2) = u1, v1, u2, v2
            quotient = _quotient(self.p, (a2 - c2, a1 - c1, a0 - c0), (d2 - b2, d1 - b1, d0 - b0), u2)
            triple = self._close(quotient, u1, v1, u2)
            if triple is not None:
                return triple
        return cantor.sum_of(self.curve, a, b)

    def double(self, a: cantor.Triple) -> cantor.Triple:
        """The reduced triple of a + a."""
        u, v, _ = a
        if len(v) == 3:
            b0, b1, b2 = v
            quotient = _quotient(self.p, (b2 + b2, b1 + b1, b0 + b0), self._rest(u, v), u)
            triple = self._close(quotient, u, v, u)
            if triple is not None:
                return triple
        return cantor.double(self.curve, a)

    def _rest(self, u: Row, v: Row) -> Row:
        """(f − v²)/u modulo u, from the top."""
        p, f3, f4, f5, f6, *_ = self.coefficients
        (a0, a1, a2, _), (_, b1, b2) = u, v
        k3 = f6 - a2
        k2 = (f5 - a1 - a2 * k3) % p
        k1 = (f4 - b2 * b2 - a0 - a1 * k3 - a2 * k2) % p
        k0 = f3 - 2 * b2 * b1 - a0 * k3 - a1 * k2 - a2 * k1
        k3 -= a2
        return (k2 - a1 - a2 * k3) % p, (k1 - a0 - a1 * k3) % p, (k0 - a0 * k3) % p

    def _close(self, quotient: Row, u1: Row, v1: Row, u2: Row) -> cantor.Triple | None:
        """The sum, from (r, r·s₂, r·s₁, r·s₀); None in special positions. The quintic through both is v₁ + u₁·s."""
        (a0, a1, a2, _), (b0, b1, b2), (c0, c1, c2, _) = u1, v1, u2
        p, _, _, _, f6, f7, f8, _ = self.coefficients
        r, s2, s1, s0 = quotient
        product = r * s2 % p
        if not product:
            return None
        inverse = pow(product, -1, p)
        shrink = r * inverse % p
        lead = s2 * s2 % p * inverse % p
        t1, t0, w4 = s1 * shrink % p, s0 * shrink % p, r * shrink % p
        w5, twice = w4 * w4 % p, w4 + w4
        # (f − v₁²)/(u₁s₂²) from the top; for a septic its second coefficient is unchanged
        q5, q4, q3 = 0, w5, w5 * (f6 - a2)
        if f8:
            g4 = f7 - a2 * f8
            q5, q4, q3 = w5 * f8, w5 * g4, w5 * ((f6 - a1 * f8 - a2 * g4) % p)
        # t·u₁, and the other four intersections of the quintic
        l4 = a2 + t1
        l3 = (a1 + t0 + t1 * a2) % p
        l2 = a0 + t1 * a1 + t0 * a2
        l1 = t1 * a0 + t0 * a1
        y2 = (l2 + twice * b2) % p
        e3 = l4 + t1 - c2
        e2 = (l3 + t0 - c1 - q5 + t1 * l4 - c2 * e3) % p
        e1 = (y2 - c0 - q4 + t1 * l3 + t0 * l4 - c2 * e2 - c1 * e3) % p
        e0 = (l1 + twice * b1 + t1 * y2 + t0 * l3 - q3 - c2 * e1 - c1 * e2 - c0 * e3) % p
        # the quintic modulo their polynomial
        g = c2 - t1
        k3 = lead * ((l3 - e2 - g * e3) % p) % p
        k2 = (lead * ((l2 - e1 - g * e2) % p) + b2) % p
        k1 = (lead * ((l1 - e0 - g * e1) % p) + b1) % p
        k0 = lead * ((t0 * a0 - g * e0) % p) + b0
        return self._reduced((e3, e2, e1, e0), (k3, k2, k1, k0))

    def _reduced(self, e: Row, k: Row) -> cantor.Triple | None:
        """The three other intersections of the cubic k that passes through the four points of e."""
        (e3, e2, e1, _), (k3, k2, k1, k0) = e, k
        p, _, f4, f5, f6, *_ = self.coefficients
        n2 = (f6 - e3 - k3 * k3) % p
        n1 = (f5 - e2 - 2 * k3 * k2 - e3 * n2) % p
        n0 = (f4 - e1 - 2 * k3 * k1 - k2 * k2 - e2 * n2 - e3 * n1) % p
        return (n0, n1, n2, 1), _trimmed(((k0 - k3 * n0) % p, (k1 - k3 * n1) % p, (k2 - k3 * n2) % p)), None


class OcticFormulas(SepticFormulas):
    """Addition and doubling on split models, f of degree 8.

    The quintic through both divisors meets the curve in four more points, as for degree 7. Let c be the leading
    coefficient of y at ∞₊. A quartic with leading coefficient c passes through these four points; it meets the curve at
    ∞₊ and in three more points. This is the step at infinity of Galbraith, Harrison and Mireles Morales (2008). It
    costs a second inversion, that of f₇ − 2c·(the quartic's next coefficient).
    """

    def _rest(self, u: Row, v: Row) -> Row:
        """(f − v²)/u modulo u, from the top."""
        p, f3, f4, f5, f6, f7, f8, _ = self.coefficients
        (a0, a1, a2, _), (_, b1, b2) = u, v
        k4 = (f7 - a2 * f8) % p
        k3 = (f6 - a1 * f8 - a2 * k4) % p
        k2 = f5 - a0 * f8 - a1 * k4 - a2 * k3
        k1 = f4 - b2 * b2 - a0 * k4 - a1 * k3 - a2 * (k2 % p)
        k0 = f3 - 2 * b2 * b1 - a0 * k3 - a1 * (k2 % p) - a2 * (k1 % p)
        k4 = (k4 - a2 * f8) % p
        k3 = (k3 - a1 * f8 - a2 * k4) % p
        k2 -= a0 * f8 + a1 * k4
        return (k2 - a2 * k3) % p, (k1 - a0 * k4 - a1 * k3) % p, (k0 - a0 * k3) % p

    def _reduced(self, e: Row, k: Row) -> cantor.Triple | None:
        """The three other intersections of the quartic k + c·e that passes through the four points of e; None if there
        are fewer.
        """
        e3, e2, e1, _ = e
        p, _, f4, f5, f6, f7, _, c = self.coefficients
        w3, w2, w1, w0 = ((x + c * y) % p for x, y in zip(k, e, strict=True))
        twice = c + c
        lead = (f7 - twice * w3) % p
        if not lead:
            return None
        inverse = pow(lead, -1, p)
        n2 = ((f6 - twice * w2 - w3 * w3) % p * inverse - e3) % p
        n1 = ((f5 - twice * w1 - 2 * w3 * w2) % p * inverse - e2 - e3 * n2) % p
        n0 = ((f4 - twice * w0 - 2 * w3 * w1 - w2 * w2) % p * inverse - e1 - e2 * n2 - e3 * n1) % p
        g = (w3 - c * n2) % p
        v = (w0 - g * n0) % p, (w1 - c * n0 - g * n1) % p, (w2 - c * n1 - g * n2) % p
        return (n0, n1, n2, 1), _trimmed(v), 0


def genus3_formulas(C: HyperellipticCurve) -> type[SepticFormulas] | None:
    """The class of the explicit formulas for C; None if there are none."""
    if type(C.field) is not PrimeField or C.genus != 3 or C.h:
        return None
    return SepticFormulas if is_short_septic(C) else OcticFormulas if C.model == "split" else None


def _trimmed(v: Row) -> Row:
    """v without leading zeros."""
    while v and not v[-1]:
        v = v[:-1]
    return v


def _quotient(p: int, m: Row, w: Row, u: Row) -> Row:
    """(r, r·s₂, r·s₁, r·s₀) for s = w/m modulo u."""
    (m2, m1, m0), (w2, w1, w0), (c0, c1, c2, _) = m, w, u
    n2, n1, n0 = (m1 - c2 * m2) % p, (m0 - c1 * m2) % p, -c0 * m2 % p
    p2, p1 = (n1 - c2 * n2) % p, (n0 - c1 * n2) % p
    i0, i1, i2 = (n1 * p2 - p1 * n2) % p, (p1 * m2 - m1 * p2) % p, (m1 * n2 - n1 * m2) % p
    r = (m0 * i0 + n0 * i1 - c0 * n2 % p * i2) % p
    q4 = i2 * w2 % p
    q3 = (i2 * w1 + i1 * w2 - c2 * q4) % p
    s2 = (i2 * w0 + i1 * w1 + i0 * w2 - c1 * q4 - c2 * q3) % p
    return r, s2, (i1 * w0 + i0 * w1 - c0 * q4 - c1 * q3) % p, (i0 * w0 - c0 * q3) % p
