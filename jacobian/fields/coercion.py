"""The rule by which every field reads rational numbers exactly.

:func:`rational` reads ints (numpy's, gmpy2's, flint's, PARI's too; truth values as 0 and 1), fractions, Decimals and
strings: "3", "-1/3", "0.25", "1e3". Every field accepts these. Only inexact fields accept floats: 0.1 is not 1/10, and
an exact field cannot tell which of the two is meant.

:func:`residue` reads residues of python-flint and PARI (cypari), which it recognises by their types, without importing
either library.
"""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from numbers import Rational
from operator import index
from typing import Any

from jacobian.errors import FieldError, shown

# a larger power of ten is probably a mistake, and takes seconds to write out
LARGEST_EXPONENT = 100_000

_NUMBER = re.compile(r"\s*([-+]?)(\d+)/(\d+)\s*|\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE]([-+]?\d+))?\s*", re.ASCII)


def rational(value: Any, argument: str = "value") -> int | Fraction | None:
    """The rational number that ``value`` stands for, or None; FieldError for one with too many digits."""
    if isinstance(value, (int, Fraction)):
        return value
    if isinstance(value, str):
        return _of_text(value, argument)
    if isinstance(value, Decimal):
        if not value.is_finite():
            return None
        _check_exponent(int(value.as_tuple().exponent), value, argument)
        return Fraction(value)
    if getattr(value, "ndim", 0) != 0:
        return None
    if isinstance(value, Rational):
        return Fraction(int(value.numerator), int(value.denominator))
    if _is_pari(value):
        known = value.type() in ("t_INT", "t_FRAC")
        return Fraction(int(value.numerator()), int(value.denominator())) if known else None
    if type(value).__name__ == "fmpq":
        return Fraction(int(value.p), int(value.q))
    try:
        return index(value)
    except Exception:
        # numpy's booleans have no __index__
        return int(value) if type(value).__name__ in ("bool", "bool_") else None


def _is_pari(value: Any) -> bool:
    return type(value).__name__ == "Gen" and type(value).__module__.startswith("cypari")


def residue(value: Any) -> tuple[int, int] | None:
    """(a, m) for a residue a modulo m of python-flint or PARI; None for anything else."""
    if _is_pari(value):
        return (int(value.lift()), int(value.mod())) if value.type() == "t_INTMOD" else None
    if type(value).__name__ in ("nmod", "fmpz_mod"):
        return int(value), int(-(value**0)) + 1
    return None


def _of_text(text: str, argument: str) -> Fraction | None:
    found = _NUMBER.fullmatch(text)
    if not found:
        return None
    try:
        _check_exponent(int(found[4] or 0), text, argument)
        return Fraction(text)
    except ZeroDivisionError:
        return None
    except ValueError as error:
        if isinstance(error, FieldError):
            raise
        # Python reads ints of 4300 digits at most
        raise FieldError(f"{argument} = {shown(text)}: {error}") from None


def _check_exponent(exponent: int, value: Any, argument: str) -> None:
    if abs(exponent) > LARGEST_EXPONENT:
        raise FieldError(
            f"{argument} = {shown(value)}: powers of ten up to {LARGEST_EXPONENT} are read; choose other units"
        )


def number(value: Any, argument: str) -> Any:
    """``value`` as inexact fields read it: a string as :func:`rational` reads it, which may be None, an array without
    dimensions as its entry, anything else unchanged. TypeError for bytes and other arrays.
    """
    if isinstance(value, str):
        value = rational(value, argument)
    if isinstance(value, (bytes, bytearray, memoryview)) or getattr(value, "ndim", 0) != 0:
        raise TypeError
    return value[()].item() if type(value).__name__ == "ndarray" else value


def is_complex(value: Any) -> bool:
    """Whether ``value`` is a complex number of Python, numpy or mpmath."""
    dtype = getattr(value, "dtype", None)
    return isinstance(value, complex) or hasattr(value, "_mpc_") or getattr(dtype, "kind", "") == "c"
