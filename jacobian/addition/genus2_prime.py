"""The formulas of :mod:`jacobian.addition.genus2` over GF(p) on bare ints, with one reduction for each sum of products.

In CPython a call costs as much as a multiplication of machine words. So this copy avoids Karatsuba's tricks, which
replace a multiplication by several additions. Tests compare it with Cantor's algorithm and with the other copy in every
special case. For long p the same code runs on GMP's integers.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from jacobian.addition import cantor, ladder
from jacobian.addition.genus2 import ExplicitFormulas
from jacobian.curve.curve import HyperellipticCurve

Row = tuple[int, ...]


class PrimeFormulas(ExplicitFormulas):
    """The explicit formulas over GF(p)."""

    def __init__(self, C: HyperellipticCurve) -> None:
        super().__init__(C)
        K: Any = C.field
        self.p = K.p
        self.ramified = C.model == "ramified"
        # one tuple: unpacking it once in a formula is cheaper than reading an attribute for each coefficient
        self.coefficients = (self.p, *self.h, *self.f[2:])

    def sum_of(self, a: cantor.Triple, b: cantor.Triple) -> cantor.Triple:
        """The reduced triple of a + b."""
        (u1, v1, _), (u2, v2, _) = a, b
        # both classes have weight 2 and two coefficients in v; all others are left to Cantor's algorithm
        if len(u1) == 3 == len(u2) and len(v1) == 2 == len(v2):
            p = self.p
            (a0, a1, _), (b0, b1), (c0, c1, _), (d0, d1) = u1, v1, u2, v2
            z1, z2, w1, w0 = a1 - c1, c0 - a0, b1 - d1, b0 - d0
            z3 = (z1 * c1 + z2) % p
            r = (z2 * z3 + z1 * z1 % p * c0) % p
            top = z1 * w1 % p
            s1 = (z1 * w0 + z3 * w1 - top * c1) % p
            s0 = (z3 * w0 - top * c0) % p
            close = self._ramified if self.ramified else self._of_degree_six
            triple = close(r, s1, s0, u1, v1, u2)
            if triple is not None:
                return triple
        return cantor.sum_of(self.curve, a, b)

    def double(self, a: cantor.Triple) -> cantor.Triple:
        """The reduced triple of a + a."""
        u, v, _ = a
        if len(u) == 3 and len(v) == 2:
            p, h0, h1, h2, h3, f2, f3, f4, f5, f6 = self.coefficients
            (a0, a1, _), (b0, b1) = u, v
            k3 = f5 - f6 * a1
            k2 = (f4 - h3 * b1 - a1 * k3 - a0 * f6) % p
            k1 = f3 - h3 * b0 - h2 * b1 - a1 * k2 - a0 * k3
            k0 = f2 - h2 * b0 - (h1 + b1) * b1 - a1 * k1
            k3 -= f6 * a1
            rest = (k2 - a1 * k3 - f6 * a0) % p
            k1 = (k1 - a1 * rest - a0 * k3) % p
            k0 = (k0 - a0 * (k2 + rest)) % p
            t1 = (b1 + b1 + h1 - h2 * a1 + h3 * (a1 * a1 - a0)) % p
            t0 = b0 + b0 + h0 - h2 * a0 + h3 * a1 * a0
            t3 = (t0 - a1 * t1) % p
            r = (a0 * t1 % p * t1 + t0 * t3) % p
            top = t1 * k1 % p
            s1 = (t3 * k1 - t1 * k0 + top * a1) % p
            s0 = (t3 * k0 + top * a0) % p
            close = self._ramified if self.ramified else self._of_degree_six
            triple = close(r, s1, s0, u, v, u)
            if triple is not None:
                return triple
        return cantor.double(self.curve, a)

    def _ramified(self, r: int, s1: int, s0: int, u1: Row, v1: Row, u2: Row) -> cantor.Triple | None:
        """The sum, from the resultant r and r·s; the cubic through both divisors is v₁ + u₁·s."""
        (a0, a1, _), (b0, b1), (c0, c1, _) = u1, v1, u2
        p, h0, h1, h2, _, _, _, f4, f5, _ = self.coefficients
        product = r * s1 % p
        if not product:
            return None
        inverse = pow(product, -1, p)
        shrink = r * inverse % p
        lead = s1 * s1 % p * inverse % p
        w4 = r * shrink % p
        w5 = w4 * w4 % p
        s = s0 * shrink % p
        l1 = s * a1 + a0
        bent = s + a1 - c1 + h2 * w4
        e1 = (s + bent - f5 * w5) % p
        e0 = ((s - c1) * bent + l1 - c0 + (b1 + b1 + h1) * w4 + (f5 * (a1 + c1) - f4) * w5) % p
        w = s + a1 - e1
        new1 = (h2 * e1 - h1 - b1 - lead * ((l1 - e0 - e1 * w) % p)) % p
        new0 = (h2 * e0 - h0 - b0 - lead * ((s * a0 - e0 * w) % p)) % p
        return (e0, e1, 1), (new0, new1) if new1 else (new0,) if new0 else (), None

    def _of_degree_six(self, r: int, s1: int, s0: int, u1: Row, v1: Row, u2: Row) -> cantor.Triple | None:
        """:meth:`_ramified` for deg f = 6 or deg h = 3."""
        (a0, a1, _), (b0, b1), (c0, c1, _) = u1, v1, u2
        p, h0, h1, h2, h3, _, _, f4, f5, f6 = self.coefficients
        square = r * r % p
        lead = (s1 * (s1 + h3 * r) - f6 * square) % p
        product = r * lead % p
        if not product:
            return None
        inverse = pow(product, -1, p)
        shrink = lead * inverse % p
        scale = r * inverse % p * square % p
        s1, s0 = s1 * shrink % p, s0 * shrink % p
        high, low = a1 * s1 % p, a0 * s1
        k3 = f5 - f6 * a1
        p2 = s0 + high + h2
        t3 = (s1 * (s0 + p2) + h3 * s0 - k3) % p
        t2 = (s0 * (p2 + high) + s1 * ((low + h1 + b1 + b1) % p) - f4 + h3 * b1 + a1 * k3 + a0 * f6) % p
        e1 = (t3 * scale - c1) % p
        e0 = (t2 * scale - c1 * e1 - c0) % p
        p3 = s1 + h3
        q = (p2 - e1 * p3) % p
        new1 = (e0 * p3 + e1 * q - low - a1 * s0 - b1 - h1) % p
        new0 = (e0 * q - a0 * s0 - b0 - h0) % p
        return (e0, e1, 1), (new0, new1) if new1 else (new0,) if new0 else (), self.weight


GMP_BITS = 32
"""The bits of p from which GMP's integers are faster than Python's; ``python -m benchmarks single`` measures it."""


class GmpFormulas:
    """Explicit formulas over GF(p), run on gmpy2's mpz. They take and return triples of ints."""

    def __init__(self, C: HyperellipticCurve, kind: Any = PrimeFormulas) -> None:
        from gmpy2 import mpz

        self._integer, formulas = mpz, kind(C)
        # an operation with one mpz returns an mpz, so converting p and the coefficients is enough
        formulas.p = mpz(formulas.p)
        formulas.coefficients = tuple(map(mpz, formulas.coefficients))
        self._sum_of, self._double = formulas.sum_of, formulas.double
        self._ladder = partial(
            ladder.multiple, sum_of=self._sum_of, double=self._double, negate=partial(cantor.negate, C)
        )

    def sum_of(self, a: cantor.Triple, b: cantor.Triple) -> cantor.Triple:
        """The reduced triple of a + b."""
        return _on_ints(self._sum_of(a, b))

    def double(self, a: cantor.Triple) -> cantor.Triple:
        """The reduced triple of a + a."""
        return _on_ints(self._double(a))

    def multiple(self, m: int, a: cantor.Triple) -> cantor.Triple:
        """The reduced triple of m·a, m > 0; intermediate results stay mpz."""
        u, v, n = a
        return _on_ints(self._ladder(m, (tuple(map(self._integer, u)), tuple(map(self._integer, v)), n)))


def _on_ints(a: cantor.Triple) -> cantor.Triple:
    u, v, n = a
    return tuple(map(int, u)), tuple(map(int, v)), n
