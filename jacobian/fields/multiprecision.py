"""MP(dps): real or complex numbers of any precision, on an mpmath context of their own."""

from __future__ import annotations

import copyreg
from collections.abc import Hashable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from jacobian.element import Rng
from jacobian.errors import NotASquare, written
from jacobian.fields.coercion import is_complex, number, rational
from jacobian.fields.inexact import InexactField
from jacobian.fields.randomness import random_below

if TYPE_CHECKING:
    from mpmath.ctx_mp_python import _mpf

Mpf: TypeAlias = "_mpf"

# a number of this many digits takes half a megabyte
MOST_DIGITS = 1_000_000


class MultiprecisionField(InexactField[Mpf]):
    """Numbers of ``dps`` decimal digits; elements are mpf (or mpc) of :attr:`context`. Get one from
    :func:`jacobian.MP`.

    The context belongs to this field: the global ``mpmath.mp`` is neither read nor changed.
    """

    def __init__(self, dps: int, complex: bool) -> None:
        from mpmath import MPContext
        from mpmath.ctx_mp_python import _mpf
        from mpmath.libmp import from_man_exp, mpf_pos

        self.dps = dps
        self.complex = complex
        self.context: Any = MPContext()
        self.context.dps = dps
        self._is_finite = self.context.isfinite
        self.name = f"MP({dps}, complex=True)" if complex else f"MP({dps})"
        self.eps: Any = self.context.mpf(2) ** (1 - self.context.prec)
        self._type = self.context.mpc if complex else self.context.mpf
        # the common base class of the mpf classes of all contexts
        self._reals: Any = _mpf
        self._made: Any = from_man_exp
        self._rounded: Any = mpf_pos
        self.zero: Any = self._type(0)
        # each context has its own classes, which pickle cannot import
        copyreg.pickle(self.context.mpf, self._packed)
        copyreg.pickle(self.context.mpc, self._packed)
        self.one: Any = self._type(1)

    def _packed(self, x: Any) -> Any:
        parts = x._mpc_ if hasattr(x, "_mpc_") else (x._mpf_,)
        return _unpacked, (self, [(sign, int(mantissa), exponent, bits) for sign, mantissa, exponent, bits in parts])

    def __eq__(self, other: object) -> bool:
        return isinstance(other, MultiprecisionField) and (other.dps, other.complex) == (self.dps, self.complex)

    def __hash__(self) -> int:
        return hash(("MP", self.dps, self.complex))

    def __reduce__(self) -> tuple[object, ...]:
        return multiprecision_field, (self.dps, self.complex)

    def coerce(self, value: object, argument: str = "value") -> Mpf:
        """The number ``value``, as in :meth:`Field.coerce`, rounded once; mpf and mpc of any context are read."""
        if isinstance(value, self._reals) and not self.complex:
            parts = value._mpf_
            # a number without a mantissa is 0 or not finite
            if parts[1]:
                return self.context.make_mpf(self._rounded(parts, self.context.prec, "n"))
        return super().coerce(value, argument)

    def _convert(self, value: Any, argument: str) -> Any:
        context = self.context
        if hasattr(value, "_mpc_"):
            value = context.make_mpc(value._mpc_)
        elif hasattr(value, "_mpf_"):
            value = context.make_mpf(_parts(value) if type(value).__name__ == "mpfr" else value._mpf_)
        elif not isinstance(value, (int, float, complex)):
            value = number(value, argument)
            exact = rational(value, argument)
            if exact is not None:
                from mpmath.libmp import from_rational

                value = context.make_mpf(from_rational(exact.numerator, exact.denominator, context.prec, "n"))
            elif is_complex(value):
                value = complex(value)
            elif not isinstance(value, float):
                # numpy's long doubles have more digits than a float
                top, bottom = value.as_integer_ratio()
                value = context.mpf(top) / bottom
        # unary plus rounds to this precision
        return +self._type(value)

    def binary(self, mantissa: Any, exponent: int) -> Any:
        """mantissa·2^exponent, both integers, rounded once."""
        x = self.context.make_mpf(self._made(mantissa, exponent, self.context.prec, "n"))
        return self._type(x) if self.complex else x

    def dot(self, xs: Sequence[Mpf], ys: Sequence[Mpf]) -> Mpf:
        """Σ x_i y_i, rounded once."""
        return self.context.fdot(xs, ys) + self.zero

    def sqrt(self, x: Mpf) -> Mpf:
        """The non-negative (or principal) square root; NotASquare for a negative real."""
        if not self.complex and x < 0:
            raise NotASquare(f"{written(x)} is negative: no square root in {self.name}")
        return self.context.sqrt(x)

    def exponent(self, x: Mpf) -> int:
        """The e with 2^(e−1) ≤ max(|re x|, |im x|) < 2^e, for x ≠ 0."""
        parts = x._mpc_ if hasattr(x, "_mpc_") else (x._mpf_,)
        return max(int(exponent + bits) for _, mantissa, exponent, bits in parts if mantissa)

    def shift(self, x: Mpf, bits: int) -> Mpf:
        """x·2^bits."""
        return x * self.context.ldexp(1, bits)

    def random(self, rng: Rng) -> Mpf:
        """A random number, uniform in [−2, 2) or, on a complex field, in the square [−2, 2)²."""
        if self.complex:
            return self.context.mpc(self._random_real(rng), self._random_real(rng))
        return self._random_real(rng)

    def _random_real(self, rng: Rng) -> Mpf:
        bits = self.context.prec
        return self.context.ldexp(random_below(rng, 1 << bits), 2 - bits) - 2

    def key(self, x: Mpf) -> Hashable:
        """The sign, mantissa, exponent and length of the mantissa in bits; these numbers belong to no context."""
        result: Hashable = x._mpc_ if self.complex else x._mpf_
        return result

    def from_key(self, key: Any) -> Any:
        """The element whose :meth:`key` is ``key``."""
        return self.context.make_mpc(key) if self.complex else self.context.make_mpf(key)


def _parts(x: Any) -> Any:
    """The parts of a gmpy2 mpfr in mpmath's form. The mpfr's own ``_mpf_`` differs for zero and non-finite numbers."""
    from mpmath.libmp import fnan, from_man_exp

    if not x.is_finite():
        return fnan
    mantissa, exponent = x.as_mantissa_exp()
    return from_man_exp(mantissa, int(exponent))


def _unpacked(K: MultiprecisionField, parts: Any) -> Any:
    """The number that :meth:`MultiprecisionField._packed` took apart, in the context of K."""
    from mpmath.libmp import MPZ

    numbers = [(sign, MPZ(mantissa), exponent, bits) for sign, mantissa, exponent, bits in parts]
    return K.context.make_mpf(numbers[0]) if len(numbers) == 1 else K.context.make_mpc(tuple(numbers))


multiprecision_fields: dict[tuple[int, bool], MultiprecisionField] = {}
"""The fields made so far, by ``dps`` and ``complex``."""


def multiprecision_field(dps: int, complex: bool) -> MultiprecisionField:
    """The field of numbers of ``dps`` digits; equal arguments give the same object."""
    key = dps, complex
    return multiprecision_fields.get(key) or multiprecision_fields.setdefault(key, MultiprecisionField(*key))
