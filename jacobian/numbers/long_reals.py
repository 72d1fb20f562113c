"""Real numbers of many digits for long loops: gmpy2's mpfr or python-flint's arb where installed, else mpmath's mpf.

An operation on mpf costs about 1 µs, on mpfr or arb at 200 digits 0.1 µs. Both keep their precision in a context of the
thread (gmpy2) or of the process (python-flint); it is set inside ``with`` only and put back afterwards.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any

from jacobian.errors import ArgumentError
from jacobian.numbers.roots import ROOTS

KINDS = ("gmpy2", "python-flint", "mpmath")


class BareReals:
    """Numbers of ``bits`` bits. ``kind`` is one of ``KINDS``; by default the first that is installed.

    ``with reals:`` sets the precision, ``with reals.at(bits):`` another one. Numbers made by :meth:`number` do not
    depend on it; results of operations do.
    """

    def __new__(cls, bits: int, kind: str | None = None) -> BareReals:
        if kind is not None and kind not in KINDS:
            raise ArgumentError(f"kind = {kind!r}: choose one of {', '.join(map(repr, KINDS))}")
        kind = kind or _installed()
        return object.__new__({"gmpy2": _Gmpy2, "python-flint": _Flint, "mpmath": _Mpmath}[kind])

    def __init__(self, bits: int, kind: str | None = None) -> None:
        self.bits = bits
        self._open: list[AbstractContextManager[Any]] = []

    kind: str

    def __enter__(self) -> BareReals:
        manager = self.at(self.bits)
        manager.__enter__()
        self._open.append(manager)
        return self

    def __exit__(self, *error: Any) -> None:
        self._open.pop().__exit__(*error)

    def at(self, bits: int) -> AbstractContextManager[Any]:
        """A context in which operations round to ``bits`` bits."""
        raise NotImplementedError

    def number(self, x: Any) -> Any:
        """An int, a float, an mpf of any context or a number of this kind; what has more digits may be rounded."""
        if isinstance(x, int):
            return self._made(x, 0)
        if isinstance(x, float):
            numerator, denominator = x.as_integer_ratio()
            return self._made(numerator, 1 - denominator.bit_length())
        sign, mantissa, exponent, _ = x._mpf_
        return self._made(-mantissa if sign else mantissa, exponent)

    def row(self, values: Iterable[Any]) -> tuple[Any, ...]:
        """:meth:`number` of each."""
        return tuple(map(self.number, values))

    def element(self, field: Any, x: Any) -> Any:
        """x as an mpf of ``field``, MP(digits); nan where a division by 0 or nearly 0 left no number."""
        from mpmath.libmp import from_man_exp

        if not self._finite(x):
            return field.context.nan

        mantissa, exponent = self._parts(x)
        return field.coerce(field.context.make_mpf(from_man_exp(mantissa, exponent)))

    def elements(self, field: Any, values: Iterable[Any]) -> tuple[Any, ...]:
        """:meth:`element` of each."""
        return tuple(self.element(field, x) for x in values)

    def nearest(self, x: Any) -> int:
        """The integer nearest to x, the upper of two."""
        mantissa, exponent = self._parts(x)
        if exponent >= 0:
            return int(mantissa) << exponent
        return (int(mantissa) + (1 << (-exponent - 1))) >> -exponent

    def plain(self, x: Any) -> Any:
        """x without the error bound that arb carries along: here numbers are rounded, not enclosed."""
        return x

    def plain_row(self, values: Iterable[Any]) -> tuple[Any, ...]:
        """:meth:`plain` of each."""
        return tuple(map(self.plain, values))

    def _finite(self, x: Any) -> bool:
        raise NotImplementedError

    def _made(self, mantissa: Any, exponent: int) -> Any:
        raise NotImplementedError

    def _parts(self, x: Any) -> tuple[Any, int]:
        raise NotImplementedError


class _Gmpy2(BareReals):
    kind = "gmpy2"

    def __init__(self, bits: int, kind: str | None = None) -> None:
        import gmpy2

        super().__init__(bits)
        self._gmpy2: Any = gmpy2
        self._type = type(gmpy2.mpfr(0))
        self._exact: Any = gmpy2.context(precision=bits)
        ROOTS[self._type] = gmpy2.sqrt

    def at(self, bits: int) -> AbstractContextManager[Any]:
        result: AbstractContextManager[Any] = self._gmpy2.context(self._gmpy2.get_context(), precision=bits)
        return result

    def number(self, x: Any) -> Any:
        return x if isinstance(x, self._type) else super().number(x)

    def _finite(self, x: Any) -> bool:
        return bool(self._gmpy2.is_finite(x))

    def _made(self, mantissa: Any, exponent: int) -> Any:
        x = self._gmpy2.mpfr(mantissa, self.bits)
        return self._exact.mul_2exp(x, exponent) if exponent >= 0 else self._exact.div_2exp(x, -exponent)

    def _parts(self, x: Any) -> tuple[Any, int]:
        mantissa, exponent = x.as_mantissa_exp()
        return mantissa, int(exponent)


class _Flint(BareReals):
    kind = "python-flint"

    def __init__(self, bits: int, kind: str | None = None) -> None:
        import flint

        super().__init__(bits)
        self._flint: Any = flint
        ROOTS[flint.arb] = flint.arb.sqrt

    @contextmanager
    def at(self, bits: int) -> Iterator[Any]:
        context, before = self._flint.ctx, self._flint.ctx.prec
        context.prec = bits
        try:
            yield self
        finally:
            context.prec = before

    def number(self, x: Any) -> Any:
        return x if isinstance(x, self._flint.arb) else super().number(x)

    def plain(self, x: Any) -> Any:
        return x.mid()

    def _finite(self, x: Any) -> bool:
        return bool(x.is_finite())

    def _made(self, mantissa: Any, exponent: int) -> Any:
        return self._flint.arb((int(mantissa), exponent))

    def _parts(self, x: Any) -> tuple[Any, int]:
        mantissa, exponent = x.mid().man_exp()
        return int(mantissa), int(exponent)


class _Mpmath(BareReals):
    kind = "mpmath"

    def __init__(self, bits: int, kind: str | None = None) -> None:
        from mpmath import MPContext

        super().__init__(bits)
        self._context: Any = MPContext()
        self._context.prec = bits

    @contextmanager
    def at(self, bits: int) -> Iterator[Any]:
        before = self._context.prec
        self._context.prec = bits
        try:
            yield self
        finally:
            self._context.prec = before

    def number(self, x: Any) -> Any:
        return x if isinstance(x, self._context.mpf) else super().number(x)

    def _finite(self, x: Any) -> bool:
        return bool(self._context.isfinite(x))

    def _made(self, mantissa: Any, exponent: int) -> Any:
        from mpmath.libmp import from_man_exp

        return self._context.make_mpf(from_man_exp(mantissa, exponent))

    def _parts(self, x: Any) -> tuple[Any, int]:
        sign, mantissa, exponent, _ = x._mpf_
        return (-mantissa if sign else mantissa), exponent


def _installed() -> str:
    for kind, module in (("gmpy2", "gmpy2"), ("python-flint", "flint")):
        try:
            __import__(module)
        except ImportError:
            continue
        return kind
    return "mpmath"
