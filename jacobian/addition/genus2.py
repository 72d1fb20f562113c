"""Explicit formulas for genus 2 over exact fields: two divisors of weight 2 in general position, added or doubled.

With D = (U, V), U = x² + a₁x + a₀, V = b₁x + b₀, and D' = (U', V') likewise, ℓ = V + U·(s₁x + s₀) is the cubic through
both, and D + D' = (u, −ℓ − h mod u) with u = (ℓ² + hℓ − f)/(U U') made monic. Lange 2005 ("Formulae for arithmetic on
genus 2 hyperelliptic curves", tables 2 and 3) orders the steps so that one inversion is enough. Counted for h = 0 and a
monic f (multiplications by a coefficient that is 0 or 1 are not made): an addition takes 1I + 22M + 3S and, where f₄ =
0 too, a doubling 1I + 22M + 5S, as published. On models of degree 6, split or inert, the two divisors carry no weight
at infinity, nor does their sum, and the same cubic serves; for any h it takes 1I + 29M + 3S, and 1I + 38M + 5S for a
doubling (f₆ = 1, h = 0).

Special cases are left to Cantor's algorithm: weights below 2, common points (resultant r = 0), a cubic of lower degree
on a ramified model (s₁ = 0), a cubic that meets infinity on one of degree 6 (s₁² + h₃s₁ = f₆). Over GF(p) the same
steps run on bare ints in :mod:`jacobian.addition.genus2_prime`.
"""

from __future__ import annotations

from typing import Any

from jacobian.addition import cantor
from jacobian.curve.curve import HyperellipticCurve, coefficient

Quotient = tuple[Any, Any, Any]
Pair = tuple[Any, Any, Any, Any]


class ExplicitFormulas:
    """Addition and doubling of reduced triples on one curve of genus 2, on its arithmetic model over an exact field."""

    def __init__(self, C: HyperellipticCurve) -> None:
        K = C.field
        self.curve = C
        self.field = K
        self.f = [coefficient(K, C.f, i) for i in range(7)]
        self.h = [coefficient(K, C.h, i) for i in range(4)]
        self.weight = 0 if C.model == "split" else None

    def sum_of(self, a: cantor.Triple, b: cantor.Triple) -> cantor.Triple:
        """The reduced triple of a + b."""
        (u1, v1, _), (u2, v2, _) = a, b
        if len(u1) == 3 == len(u2):
            zero = self.field.zero
            first = (u1[1], u1[0], v1[1] if len(v1) == 2 else zero, v1[0] if v1 else zero)
            second = (u2[1], u2[0], v2[1] if len(v2) == 2 else zero, v2[0] if v2 else zero)
            triple = self._close(self._chord(first, second), first, second)
            if triple is not None:
                return triple
        return cantor.sum_of(self.curve, a, b)

    def double(self, a: cantor.Triple) -> cantor.Triple:
        """The reduced triple of a + a."""
        u, v, _ = a
        if len(u) == 3:
            zero = self.field.zero
            pair = (u[1], u[0], v[1] if len(v) == 2 else zero, v[0] if v else zero)
            quotient = self._tangent(pair) if self.curve.model == "ramified" else self._tangent_of_degree_six(pair)
            triple = self._close(quotient, pair, pair)
            if triple is not None:
                return triple
        return cantor.double(self.curve, a)

    def _close(self, quotient: Quotient, first: Pair, second: Pair) -> cantor.Triple | None:
        close = self._close_ramified if self.curve.model == "ramified" else self._close_of_degree_six
        return close(quotient, first, second)

    def _times(self, c: Any, x: Any) -> Any:
        """c·x for a coefficient c of the curve, without a multiplication if c is 0 or 1."""
        K = self.field
        return K.zero if c == K.zero else x if c == K.one else K.mul(c, x)

    def _chord(self, first: Pair, second: Pair) -> Quotient:
        """(r, r·s₁, r·s₀): s = (V' − V)/U modulo U', r the resultant of U and U'. 8M + 1S."""
        (a1, a0, b1, b0), (c1, c0, d1, d0) = first, second
        add, sub, mul = self.field.add, self.field.sub, self.field.mul
        # U modulo U' is z₁x − z₂, with the inverse −(z₁x + z₃)/r
        z1, z2 = sub(a1, c1), sub(c0, a0)
        z3 = add(mul(z1, c1), z2)
        r = add(mul(z2, z3), mul(mul(z1, z1), c0))
        w1, w0 = sub(b1, d1), sub(b0, d0)
        top, low = mul(z1, w1), mul(z3, w0)
        middle = sub(sub(mul(add(z1, z3), add(w1, w0)), top), low)
        return r, sub(middle, mul(top, c1)), sub(low, mul(top, c0))

    def _tangent(self, pair: Pair) -> Quotient:
        """(r, r·s₁, r·s₀): s = ((f − hV − V²)/U)/(2V + h) modulo U on a ramified model. 9M + 2S, 3S if h ≠ 0."""
        a1, a0, b1, b0 = pair
        add, sub, mul, times = self.field.add, self.field.sub, self.field.mul, self._times
        h0, h1, h2, _ = self.h
        _, _, f2, f3, f4, f5, _ = self.f
        square_a, square_b = mul(a1, a1), mul(b1, b1)
        t1, t0 = add(b1, b1), add(b0, b0)
        if self.curve.h:
            t1 = sub(add(t1, h1), times(h2, a1))
            t0 = sub(add(t0, h0), times(h2, a0))
            square_t = mul(t1, t1)
        else:
            square_t = add(square_b, square_b)
            square_t = add(square_t, square_t)
        t3 = sub(t0, mul(a1, t1))
        r = add(mul(a0, square_t), mul(t0, t3))
        double_a0, f4_a1 = add(a0, a0), times(f4, a1)
        q = sub(sub(f3, times(h2, b1)), f4_a1)
        k1 = times(f5, sub(add(add(square_a, square_a), square_a), double_a0))
        k1 = sub(add(q, k1), f4_a1)
        k0 = times(f5, sub(square_a, add(double_a0, double_a0)))
        k0 = sub(sub(sub(f2, square_b), mul(a1, add(q, k0))), times(f4, double_a0))
        if self.curve.h:
            k0 = sub(sub(k0, times(h2, b0)), times(h1, b1))
        return self._over_tangent(r, t1, t3, k1, k0, a1, a0)

    def _over_tangent(self, r: Any, t1: Any, t3: Any, k1: Any, k0: Any, a1: Any, a0: Any) -> Quotient:
        """(r, (t₃ − t₁x)(k₁x + k₀) modulo U). 5M."""
        add, sub, mul = self.field.add, self.field.sub, self.field.mul
        top, low = mul(t1, k1), mul(t3, k0)
        middle = add(sub(mul(sub(t3, t1), add(k1, k0)), low), top)
        return r, add(middle, mul(top, a1)), add(low, mul(top, a0))

    def _tangent_of_degree_six(self, pair: Pair) -> Quotient:
        """As :meth:`_tangent`, for any f of degree up to 6 and h of degree up to 3."""
        a1, a0, b1, b0 = pair
        add, sub, mul, times = self.field.add, self.field.sub, self.field.mul, self._times
        h0, h1, h2, h3 = self.h
        _, _, f2, f3, f4, f5, f6 = self.f
        # modulo U: x² = −a₁x − a₀, x³ = cube·x + a₁a₀
        product = mul(a1, a0)
        cube = sub(mul(a1, a1), a0)
        t1, t0 = add(b1, b1), add(b0, b0)
        # the quotient k₄x⁴ + … + k₀ of f − hV − V² by U
        k3 = sub(f5, times(f6, a1))
        k2, k1, k0 = f4, f3, sub(f2, mul(b1, b1))
        if self.curve.h:
            t1 = add(t1, add(sub(h1, times(h2, a1)), times(h3, cube)))
            t0 = add(t0, add(sub(h0, times(h2, a0)), times(h3, product)))
            k2 = sub(k2, times(h3, b1))
            k1 = sub(sub(k1, times(h3, b0)), times(h2, b1))
            k0 = sub(sub(k0, times(h2, b0)), times(h1, b1))
        k2 = sub(sub(k2, mul(a1, k3)), times(f6, a0))
        k1 = sub(sub(k1, mul(a1, k2)), mul(a0, k3))
        k0 = sub(k0, mul(a1, k1))
        # its remainder, by two more steps of the same division
        k3 = sub(k3, times(f6, a1))
        rest = sub(sub(k2, mul(a1, k3)), times(f6, a0))
        k1 = sub(sub(k1, mul(a1, rest)), mul(a0, k3))
        k0 = sub(k0, mul(a0, add(k2, rest)))
        t3 = sub(t0, mul(a1, t1))
        r = add(mul(a0, mul(t1, t1)), mul(t0, t3))
        return self._over_tangent(r, t1, t3, k1, k0, a1, a0)

    def _close_ramified(self, quotient: Quotient, first: Pair, second: Pair) -> cantor.Triple | None:
        """The sum from r and r·s: 1I + 14M + 2S after a chord, 1I + 13M + 3S after a tangent; None if r·s₁ = 0."""
        K = self.field
        add, sub, mul, times = K.add, K.sub, K.mul, self._times
        (r, s1, s0), (a1, a0, b1, b0), (c1, c0, _, _) = quotient, first, second
        h0, h1, h2, _ = self.h
        _, _, _, _, f4, f5, _ = self.f
        product = mul(r, s1)
        if product == K.zero:
            return None
        inverse = K.inv(product)
        shrink = mul(r, inverse)
        lead = mul(mul(s1, s1), inverse)
        w4 = mul(r, shrink)
        w5 = mul(w4, w4)
        s = mul(s0, shrink)
        # ℓ = lead·(x³ + l₂x² + l₁x + l₀) + V
        l2, l1, l0 = add(s, a1), add(mul(s, a1), a0), mul(s, a0)
        bent = times(h2, w4)
        e0 = add(mul(add(add(b1, b1), h1), w4), mul(sub(times(f5, add(a1, c1)), f4), w5))
        e1 = sub(add(add(s, s), bent), times(f5, w5))
        if first is second and h2 == K.zero:
            e0 = add(e0, mul(s, s))
        else:
            z1 = sub(a1, c1)
            e0 = add(e0, sub(add(mul(sub(s, c1), add(add(s, z1), bent)), l1), c0))
            e1 = add(e1, z1)
        w = sub(l2, e1)
        v1 = add(mul(lead, sub(sub(l1, e0), mul(e1, w))), add(b1, h1))
        v0 = add(mul(lead, sub(l0, mul(e0, w))), add(b0, h0))
        if h2 != K.zero:
            v1, v0 = sub(v1, times(h2, e1)), sub(v0, times(h2, e0))
        return self._triple(e1, e0, v1, v0)

    def _close_of_degree_six(self, quotient: Quotient, first: Pair, second: Pair) -> cantor.Triple | None:
        """The sum from r and r·s for deg f ≤ 6, deg h ≤ 3: 1I + 21M + 2S; None if r = 0 or ℓ meets infinity."""
        K = self.field
        add, sub, mul, times = K.add, K.sub, K.mul, self._times
        (r, s1, s0), (a1, a0, b1, b0), (c1, c0, _, _) = quotient, first, second
        h0, h1, h2, h3 = self.h
        _, _, _, _, f4, f5, f6 = self.f
        square = mul(r, r)
        lead = sub(mul(s1, s1), times(f6, square))
        if h3 != K.zero:
            lead = add(lead, times(h3, mul(r, s1)))
        product = mul(r, lead)
        if product == K.zero:
            return None
        inverse = K.inv(product)
        shrink = mul(lead, inverse)
        scale = mul(square, mul(r, inverse))
        s1, s0 = mul(s1, shrink), mul(s0, shrink)
        # U's = p₃x³ + … , and the cofactor k of V, from the top
        high, low = mul(a1, s1), mul(a0, s1)
        k3 = sub(f5, times(f6, a1))
        k2 = sub(sub(sub(f4, times(h3, b1)), mul(a1, k3)), times(f6, a0))
        p2 = add(add(s0, high), h2)
        t3 = sub(add(mul(s1, add(s0, p2)), times(h3, s0)), k3)
        t2 = add(mul(s0, add(p2, high)), mul(s1, add(add(low, h1), add(b1, b1))))
        e1 = sub(mul(t3, scale), c1)
        e0 = sub(sub(mul(sub(t2, k2), scale), mul(c1, e1)), c0)
        p3 = add(s1, h3)
        p1 = add(add(low, mul(a1, s0)), add(b1, h1))
        p0 = add(mul(a0, s0), add(b0, h0))
        q = sub(p2, mul(e1, p3))
        return self._triple(e1, e0, sub(sub(p1, mul(e0, p3)), mul(e1, q)), sub(p0, mul(e0, q)))

    def _triple(self, e1: Any, e0: Any, v1: Any, v0: Any) -> cantor.Triple:
        """(x² + e₁x + e₀, −v₁x − v₀, n) with v trimmed."""
        K = self.field
        u = (e0, e1, K.one)
        if v1 != K.zero:
            return u, (K.neg(v0), K.neg(v1)), self.weight
        return u, (K.neg(v0),) if v0 != K.zero else (), self.weight
