"""Long real numbers with mpmath's functions, on gmpy2: some five times as fast as mpmath.

The field has those functions of mpmath's contexts that motions on elliptic curves use. So the formulas of these motions
run on mpmath's numbers and on long numbers.
"""

from __future__ import annotations

from typing import Any

from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField


class LongNumbers(LongField):
    """Real numbers of ``dps`` decimal digits, with as many bits as mpmath has for this ``dps``.

    They are computed inside ``with numbers:``, since the precision belongs to the thread.
    """

    def __init__(self, dps: int) -> None:
        from mpmath.libmp import dps_to_prec

        super().__init__(dps_to_prec(dps))
        self.dps = dps
        self.context = Functions()

    def __reduce__(self) -> Any:
        return LongNumbers, (self.dps,)


class Functions:
    """Functions of real numbers at the precision of the thread, by the names that mpmath's contexts have for them."""

    def __init__(self) -> None:
        import gmpy2

        self._gmpy2: Any = gmpy2
        self.sqrt, self.agm, self.nint = gmpy2.sqrt, gmpy2.agm, gmpy2.rint
        self.log10, self.exp, self.cos, self.sin, self.acos = gmpy2.log10, gmpy2.exp, gmpy2.cos, gmpy2.sin, gmpy2.acos

    @property
    def prec(self) -> int:
        """The precision of the thread, in bits."""
        return int(self._gmpy2.get_context().precision)

    @property
    def pi(self) -> Any:
        """π."""
        return self._gmpy2.const_pi()

    def log(self, x: Any, base: int) -> Any:
        """The logarithm of x to the given base."""
        return self._gmpy2.log(x) / self._gmpy2.log(base)

    def ldexp(self, x: Any, n: int) -> Any:
        """x·2^n."""
        x = self._gmpy2.mpfr(x)
        return self._gmpy2.mul_2exp(x, n) if n >= 0 else self._gmpy2.div_2exp(x, -n)

    def cospi(self, x: Any) -> Any:
        """cos πx."""
        return self.cos(self.pi * x)

    def sinpi(self, x: Any) -> Any:
        """sin πx."""
        return self.sin(self.pi * x)

    def elliprf(self, x: Any, y: Any, z: Any) -> Any:
        """Carlson's integral R_F(x, y, z) of numbers ≥ 0, at most one of them 0, by duplication (Carlson 1995).

        The series is that of DLMF 19.36.1 to the seventh order. PrecisionLoss where the integral has no value, such as
        for an argument that rounding has made negative.
        """
        root, one, bits = self.sqrt, self._gmpy2.mpfr(1), self.prec
        close = one / 2 ** (bits // 8 + 1)
        x, y, z = one * x, one * y, one * z
        # each round reduces the differences by two bits
        for _ in range(bits):
            mean = (x + y + z) / 3
            p, q = 1 - x / mean, 1 - y / mean
            r = -p - q
            if max(abs(p), abs(q), abs(r)) < close:
                break
            a, b, c = root(x), root(y), root(z)
            step = a * b + b * c + c * a
            x, y, z = (x + step) / 4, (y + step) / 4, (z + step) / 4
        else:
            raise PrecisionLoss(f"an elliptic integral has no value to {bits} bits: use more digits")
        e, f = p * q - r * r, p * q * r
        series = e * (-one / 10 + e / 24 - 5 * e * e / 208 - 3 * f / 44 + e * f / 16) + f * (one / 14 + 3 * f / 104)
        return (1 + series) / root(mean)
