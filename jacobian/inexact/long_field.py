"""Long numbers as a field: gmpy2's mpfr and mpc, for computations with more digits than their results."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from jacobian.fields.inexact import InexactField
from jacobian.inexact.dense import product
from jacobian.numbers.long_reals import BareReals


class LongField(InexactField):
    """A field of numbers of ``bits`` bits, real or complex, that stand for elements of RR, CC, MP and QQ.

    They must be computed inside ``with field:``, which sets the precision of the thread.
    """

    name = "long numbers"

    def __init__(self, bits: int, complex: bool = False) -> None:
        import gmpy2

        self.bits = bits
        self.complex = complex
        self._reals = BareReals(bits)
        self._real: Any = self._reals.number
        self._mpc: Any = gmpy2.mpc
        self._sqrt: Any = gmpy2.sqrt
        self._exponent, self._times, self._over = gmpy2.get_exp, gmpy2.mul_2exp, gmpy2.div_2exp
        with self._reals:
            self.zero, self.one = self.coerce(0), self.coerce(1)
            self.eps = gmpy2.exp2(1 - bits)
            self.root_of_eps = gmpy2.sqrt(self.eps)

    def __reduce__(self) -> tuple[object, ...]:
        return LongField, (self.bits, self.complex)

    def _value(self) -> tuple[object, ...]:
        return self.bits, self.complex

    def __enter__(self) -> LongField:
        self._reals.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self._reals.__exit__(*error)

    def coerce(self, value: Any, argument: str = "value") -> Any:
        """The number of this field nearest to an int, a float, a complex number, an mpf or an mpc."""
        if isinstance(value, self._mpc):
            return value
        if self.complex:
            return self._mpc(self._real(value.real), self._real(value.imag))
        return self._real(value)

    def exponent(self, x: Any) -> int | None:
        """The exponent e with 2^(e−1) ≤ |x| < 2^e; None for 0."""
        return self._exponent(abs(x)) if x else None

    def doubled(self, x: Any, n: int) -> Any:
        """x·2^n."""
        return self._times(x, n) if n >= 0 else self._over(x, -n)

    def poly_sub(self, a: Sequence[Any], b: Sequence[Any]) -> tuple[Any, ...]:
        """a − b of polynomials."""
        return (*map(self.sub, a, b), *(a[len(b) :] or map(self.neg, b[len(a) :])))

    def poly_mul(self, a: Sequence[Any], b: Sequence[Any]) -> tuple[Any, ...]:
        """a·b of polynomials."""
        return tuple(product(a, b))

    def poly_divmod(self, a: Sequence[Any], b: Sequence[Any]) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """(quotient, remainder) of polynomials."""
        if not b or not b[-1]:
            raise ZeroDivisionError("division by a polynomial whose leading coefficient is zero")
        size, lead, rest, quotient = len(b) - 1, b[-1], list(a), []
        below = b[:-1]
        for i in range(len(a) - size - 1, -1, -1):
            c = rest.pop() / lead
            quotient.append(c)
            for j, y in enumerate(below, i):
                rest[j] -= c * y
        return tuple(quotient[::-1]), tuple(rest)

    def nearest(self, x: Any) -> int:
        """The integer nearest to the real part of x; half-integers are rounded up."""
        return self._reals.nearest(x.real)

    def sqrt(self, x: Any) -> Any:
        """√x, the principal root over complex numbers; NaN for a negative real x."""
        return self._sqrt(x)

    def balls(self, values: Sequence[Any]) -> list[Any]:
        """The values as flint's arb or acb, balls of radius 0."""
        from flint import acb, arb

        def ball(x: Any) -> Any:
            mantissa, exponent = x.as_mantissa_exp()
            return arb((int(mantissa), int(exponent)))

        return [acb(ball(x.real), ball(x.imag)) if self.complex else ball(x) for x in values]

    def from_ball(self, x: Any) -> Any:
        """The midpoint of a ball, flint's arb or acb, as a number of this field."""

        def middle(part: Any) -> Any:
            mantissa, exponent = part.mid().man_exp()
            number = self._real(int(mantissa))
            return self.doubled(number, int(exponent))

        return self._mpc(middle(x.real), middle(x.imag)) if self.complex else middle(x)
