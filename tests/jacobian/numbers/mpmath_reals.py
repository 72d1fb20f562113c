"""Bare reals on mpmath's mpf, for comparison: a second arithmetic that shares no code with GMP's and flint's."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from mpmath import MPContext
from mpmath.libmp import from_man_exp

from jacobian.numbers.long_reals import BareReals, _Open


class MpmathReals(BareReals):
    """Numbers of ``bits`` bits: mpmath's mpf."""

    def __init__(self, bits: int) -> None:
        self.bits = bits
        self._open = _Open()
        self._context: Any = MPContext()
        self._context.prec = bits
        self._type = self._context.mpf
        self.i = self._context.mpc(0, 1)

    @contextmanager
    def at(self, bits: int) -> Iterator[Any]:
        before = self._context.prec
        self._context.prec = bits
        try:
            yield self
        finally:
            self._context.prec = before

    def _finite(self, x: Any) -> bool:
        return bool(self._context.isfinite(x))

    def _made(self, mantissa: Any, exponent: int) -> Any:
        return self._context.make_mpf(from_man_exp(int(mantissa), exponent))

    def _parts(self, x: Any) -> tuple[Any, int]:
        sign, mantissa, exponent, _ = x._mpf_
        return (-mantissa if sign else mantissa), exponent
