"""The equation that compiled batches run on: h completed away where 2 ≠ 0, and monic of degree 5 or 7 in genus 2 or 3.

An :class:`Equation` knows the isomorphism to it, (x, y) → (cx, c^g·(y + shift(x))), and the two constants that move
Mumford pairs: v → v + shift modulo u, then u_i → c^(deg u − i)·u_i and v_i → c^(g − i)·v_i.
"""

from __future__ import annotations

from typing import Any

from jacobian import poly
from jacobian.curve.curve import HyperellipticCurve, coefficient


class Equation:
    """``curve``: the equation that rows are added on; ``shift``: g + 2 coefficients; ``scale``: c."""

    def __init__(self, C: HyperellipticCurve) -> None:
        K, g = C.field, C.genus
        self.scale = K.one
        if K.characteristic == 2:
            self.curve = C.arithmetic_model
            move = () if self.curve is C else poly.monomial(K, K.neg(C.infinity_plus), g + 1)
        else:
            move = poly.scale(K, K.inv(K.add(K.one, K.one)), C.h)
            self.curve = self._completed(C, move)
        self.shift = [coefficient(K, move, i) for i in range(g + 2)]

    def _completed(self, C: HyperellipticCurve, half_h: poly.Poly) -> HyperellipticCurve:
        """y² = f + h²/4, scaled to a monic f if it is a quintic or a septic."""
        K: Any = C.field
        g = C.genus
        f = poly.add(K, C.f, poly.mul(K, half_h, half_h))
        if g in (2, 3) and len(f) == 2 * g + 2 and f[-1] != K.one:
            # (c^g·y)² = (cx)^(2g + 1) + … for the leading coefficient c, times c^(2g)
            c = self.scale = f[-1]
            powers = [K.power(c, 2 * g - i) for i in range(2 * g + 1)]
            f = (*(K.mul(power, a) for power, a in zip(powers, f, strict=False)), K.one)
        if C.model != "split":
            return HyperellipticCurve(K, f) if C.h or self.scale != K.one else C
        return HyperellipticCurve(K, f, (), K.add(C.infinity_plus, coefficient(K, half_h, g + 1))) if C.h else C

    def powers(self, c: Any) -> list[Any]:
        """1, c, …, c^g."""
        K: Any = self.curve.field
        return [K.power(c, i) for i in range(self.curve.genus + 1)]
