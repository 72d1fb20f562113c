"""A second Cantor for comparison, written from the papers on python-flint's polynomials.

Cantor 1987 with h as in Koblitz 1989: composition by two extended gcds, then reduction step by step. The weight at
infinity of split models as in Galbraith, Harrison and Mireles Morales 2008.
"""

from fractions import Fraction

import flint

from jacobian.fields.irreducible import kept


def polynomials(K):
    """(to flint, from flint) for polynomials over K."""
    if K.order is None:
        return (
            lambda a: flint.fmpq_poly([flint.fmpq(c.numerator, c.denominator) for c in a]),
            lambda a: tuple(Fraction(int(c.p), int(c.q)) for c in a.coeffs()),
        )
    if getattr(K, "degree", 1) == 1:
        ring = kept(flint.fmpz_mod_poly_ctx(K.p))
        return (lambda a: ring(list(a) or [0])), (lambda a: tuple(int(c) for c in a.coeffs()))
    base = flint.fmpz_mod_poly_ctx(K.p)
    field = flint.fq_default_ctx(modulus=base(list(K.modulus)), var="a")
    ring = kept(flint.fq_default_poly_ctx(field))

    def into(a):
        return ring([field(K.coefficients(c)) for c in a] or [0])

    def back(a):
        return tuple(K.coerce([int(c) for c in x.to_list()]) for x in a.coeffs())

    return into, back


class FlintCantor:
    """Addition of triples (u, v, n) of flint polynomials on one curve, an arithmetic model."""

    def __init__(self, C):
        self.into, self.back = polynomials(C.field)
        self.f, self.h, self.genus = self.into(C.f), self.into(C.h), C.genus
        self.split = C.model == "split"
        self.limit = C.genus + self.split
        if self.split:
            self.plus, self.minus = map(self.into, C.principal_parts)
            self.lead = self.plus[C.genus + 1]
            assert self.lead == self.into((C.infinity_plus,))[0]
            for V in (self.plus, self.minus):
                assert (self.f - self.h * V - V * V).degree() <= C.genus

    def convert(self, triple):
        u, v, n = triple
        return self.into(u), self.into(v), n

    def convert_back(self, triple):
        u, v, n = triple
        return self.back(u), self.back(v), n

    def add(self, first, second):
        (u1, v1, n1), (u2, v2, n2) = first, second
        e, e1, e2 = u1.xgcd(u2)
        d, c1, c2 = e.xgcd(v1 + v2 + self.h)
        u = u1 * u2 // (d * d)
        v = (c1 * e1 * u1 * v2 + c1 * e2 * u2 * v1 + c2 * (v1 * v2 + self.f)) // d % u
        n = n1 + n2 + d.degree() - (self.genus + 1) // 2 if self.split else None
        while u.degree() > self.limit:
            u, v, n = self.reflect(u, v, n)
        while self.split and not 0 <= n <= self.genus - u.degree():
            part = self.minus if n < 0 else self.plus
            u, v, n = self.reflect(u, part + (v - part) % u, n)
        return u * (1 / u.leading_coefficient()), v % u, n

    def reflect(self, u, v, n):
        other = (self.f - self.h * v - v * v) // u
        if n is not None:
            if v.degree() > self.genus + 1:
                n += v.degree() - other.degree()
            elif v[self.genus + 1] == self.lead:
                n += u.degree() - self.genus - 1
            else:
                n += self.genus + 1 - other.degree()
        return other, (-self.h - v) % other, n

    def multiply(self, m, triple):
        """m times a triple, m > 0, by doubling and adding."""
        total = triple
        for bit in bin(m)[3:]:
            total = self.add(total, total)
            if bit == "1":
                total = self.add(total, triple)
        return total
