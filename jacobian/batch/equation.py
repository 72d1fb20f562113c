"""The equation on which compiled code adds rows. It has h = 0 unless the characteristic is 2, and a monic f if deg f
is 5 in genus 2 or 7 in genus 3.

An :class:`Equation` holds the isomorphism of the given curve to this equation, (x, y) ↦ (cx, c^g·(y + shift(x))). On
Mumford pairs it replaces v by v + shift modulo u, then u_i by c^(deg u − i)·u_i and v_i by c^(g − i)·v_i.
"""

from __future__ import annotations

from typing import Any

from jacobian import poly
from jacobian.curve.curve import HyperellipticCurve, coefficient


class Equation:
    """The equation ``curve`` on which rows are added, and the isomorphism to it, (x, y) ↦ (cx, c^g·(y + shift(x))).
    ``shift`` has g + 2 coefficients, ``scale`` is c.
    """

    def __init__(self, C: HyperellipticCurve) -> None:
        K, g = C.field, C.genus
        self.scale = K.one
        if K.characteristic == 2:
            moved = C.arithmetic_model
            move = () if moved is C else poly.monomial(K, K.neg(C.infinity_plus), g + 1)
        else:
            move = poly.scale(K, K.inv(K.add(K.one, K.one)), C.h)
            moved = self._completed(C, move) if C.h else C
        self.curve = self._monic(moved)
        self.shift = [coefficient(K, move, i) for i in range(g + 2)]

    def _completed(self, C: HyperellipticCurve, half_h: poly.Poly) -> HyperellipticCurve:
        """The curve y² = f + h²/4."""
        K = C.field
        f = poly.add(K, C.f, poly.mul(K, half_h, half_h))
        plus = K.add(C.infinity_plus, coefficient(K, half_h, C.genus + 1)) if C.model == "split" else None
        return HyperellipticCurve(K, f, (), plus)

    def _monic(self, C: HyperellipticCurve) -> HyperellipticCurve:
        """C, scaled to a monic f if deg f = 5 in genus 2 or 7 in genus 3; sets ``scale``."""
        K: Any = C.field
        g = C.genus
        if g not in (2, 3) or C.model != "ramified" or len(C.f) != 2 * g + 2 or C.f[-1] == K.one:
            return C
        # multiplied by c^(2g), c = lead f, the equation reads (c^g·y)² + c^g·h·(c^g·y) = (cx)^(2g + 1) + …
        c = self.scale = C.f[-1]
        powers = [K.power(c, 2 * g - i) for i in range(2 * g + 1)]
        f, h = ([K.mul(*pair) for pair in zip(powers[start:], a, strict=False)] for start, a in ((0, C.f), (g, C.h)))
        return HyperellipticCurve(K, (*f, K.one), h)

    def powers(self, c: Any) -> list[Any]:
        """The powers 1, c, …, c^g."""
        K: Any = self.curve.field
        return [K.power(c, i) for i in range(self.curve.genus + 1)]
