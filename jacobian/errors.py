"""Named errors of both packages.

A wrong argument is an :class:`ArgumentError`. A result that does not exist or cannot be computed has an error of its
own, so that a caller can tell a mistyped argument from a root that does not exist. All are ValueErrors.
"""

from __future__ import annotations

import os
from fractions import Fraction
from itertools import islice
from numbers import Real
from operator import index
from typing import Any, TypeVar

Choice = TypeVar("Choice")
NO_SEQUENCES = (str, bytes, bytearray, memoryview, dict, set, frozenset)
"""Types whose iteration does not give the entries of a sequence of numbers."""
SHOWN = 200
"""The number of characters of a value that a message shows."""
ENDS = 8
"""The number of digits shown at each end of an int with more than SHOWN digits."""
MOST_ENTRIES = 10_000_000
"""The largest number of entries taken from an iterator, a limit for endless generators. numpy arrays may be longer."""


class JacobianError(ValueError):
    """Base class of every error raised by :mod:`jacobian` and :mod:`integrable`."""


class ArgumentError(JacobianError):
    """An argument is wrong; the message names it, gives its value and says what is accepted."""


class FieldError(ArgumentError):
    """A value does not lie in the field, or values of two fields are mixed."""


class NotASquare(JacobianError):
    """The field does not contain the requested square root."""


class SingularCurve(ArgumentError):
    """The equation y² + h(x)y = f(x) has a singular point, affine or at infinity."""


class CurveMismatch(ArgumentError):
    """Two divisors of different curves were combined."""


class NotOnCurve(ArgumentError):
    """A point or a Mumford pair does not satisfy the equation of its curve."""


class NotRepresentable(JacobianError):
    """The class or quantity exists, but not in the requested representation."""


class PrecisionLoss(JacobianError, ArithmeticError):
    """The digits do not suffice for a result, or to decide whether a quantity is zero; more digits may suffice."""


class Infeasible(JacobianError):
    """The result exists, but this package's method would take too long; the message gives its limit."""


class NotAMultiple(JacobianError):
    """The requested discrete logarithm does not exist: the target is no multiple of the base."""


def entries(values: Any, argument: str, wanted: str = "a sequence of numbers") -> list[Any]:
    """The entries of a sequence, or an ArgumentError that names ``argument`` and says what is ``wanted``. Sets and
    dictionaries are refused; a pandas table, which iterates over its labels, gives the entries of its array.
    """
    if isinstance(values, NO_SEQUENCES):
        raise ArgumentError(f"{argument} = {shown(values)}: {wanted} is needed")
    try:
        found = list(_unmasked(values) if hasattr(values, "ndim") else islice(values, MOST_ENTRIES + 1))
    except Exception as error:
        raise ArgumentError(f"{argument} = {shown(values)}: {wanted} is needed ({error})") from None
    if len(found) > MOST_ENTRIES and not hasattr(values, "ndim"):
        raise ArgumentError(f"{argument}: more than {MOST_ENTRIES} entries; {wanted} is needed")
    return found


def _unmasked(values: Any) -> Any:
    """``values``, as an array if it has dimensions; ValueError where entries are masked."""
    import numpy as np

    if np.ma.is_masked(values):
        raise ValueError("some entries are masked")
    return np.asarray(values) if hasattr(values, "ndim") and not isinstance(values, np.ndarray) else values


def one_or_more(values: Any, argument: str) -> list[Any]:
    """``values`` as a list: one number, or the entries of a sequence of numbers."""
    if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__") or getattr(values, "ndim", 1) == 0:
        return [values]
    return entries(values, argument, "a number or a sequence of numbers")


def whole(
    value: Any, argument: str, wanted: str = "an int is needed", least: int | None = None, most: int | None = None
) -> int:
    """``value`` as an int in ``least`` … ``most`` (numpy integers too, truth values not), or an ArgumentError that
    names ``argument`` and says what is ``wanted``.
    """
    try:
        found = value if type(value) is int else None if isinstance(value, bool) else index(value)
    except Exception:
        found = None
    if found is None or (least is not None and found < least) or (most is not None and found > most):
        raise ArgumentError(f"{argument} = {shown(value)}: {wanted}")
    return found


def flag(value: object, argument: str) -> bool:
    """``value``, if it is True or False (numpy's too), or an ArgumentError that names ``argument``."""
    of_numpy = type(value).__module__ == "numpy" and type(value).__name__ in ("bool", "bool_")
    if not isinstance(value, bool) and not of_numpy:
        raise ArgumentError(f"{argument} = {shown(value)}: True or False is needed")
    return bool(value)


def names_a_file(path: object) -> bool:
    """Whether a path ends in a name that the file system can hold: no lone surrogates, no NUL."""
    if not isinstance(path, (str, os.PathLike)):
        return False
    from pathlib import PurePath

    try:
        return b"\0" not in os.fsencode(path) and bool(PurePath(path).name)
    except UnicodeEncodeError:
        return False


def floats(values: Any, argument: str, wanted: str) -> Any:
    """Numbers as an array of floats, or an ArgumentError that names ``argument`` and says what is ``wanted``."""
    import numpy as np

    try:
        return np.asarray(_unmasked(values), dtype=np.float64)
    except Exception:
        raise ArgumentError(f"{argument} = {shown(values)}: {wanted}") from None


def several(which: Any) -> bool:
    """Whether ``which`` selects several items (:func:`chosen`), and not one."""
    import numpy as np

    try:
        return isinstance(which, slice) or np.ndim(which) > 0
    except ValueError:
        # numpy refuses nested lists of different lengths; they select several items
        return True


def chosen(which: Any, count: int) -> Any:
    """The selection ``which`` from ``count`` items, a slice or an array of ints or truth values; else ArgumentError."""
    if isinstance(which, slice):
        return which
    import numpy as np

    wanted = "an int, a slice, or an array of ints or truth values is needed"
    try:
        found = np.asarray(_unmasked(which))
    except Exception:
        raise ArgumentError(f"[{shown(which)}]: {wanted}") from None
    if not found.size:
        return slice(0, 0)
    if found.ndim != 1 or not (found.dtype == bool or np.issubdtype(found.dtype, np.integer)):
        raise ArgumentError(f"[{shown(which)}]: {wanted}")
    fits = len(found) == count if found.dtype == bool else -count <= found.min() and found.max() < count
    if not fits:
        raise ArgumentError(f"[{shown(which)}]: there are {shown(count)}")
    return found


def one_of(value: object, argument: str, choices: tuple[Choice, ...], wanted: str) -> Choice:
    """The element of ``choices`` that equals ``value``, or an ArgumentError that names ``argument`` and says what is
    ``wanted``.
    """
    if isinstance(value, (str, Real)):
        for choice in choices:
            if value == choice:
                return choice
    raise ArgumentError(f"{argument} = {shown(value)}: {wanted}")


def shown(value: object) -> str:
    """``repr(value)`` for a message: on one line, shortened, and safe where the repr raises."""
    if isinstance(value, int) and value.bit_length() > 4 * SHOWN:
        return f"an int of {value.bit_length()} bits"
    try:
        text = repr(value)
    except ValueError:
        # Python refuses to write ints of more than 4300 digits, and the value contains one
        text = _by_parts(value)
    except Exception:
        return f"<{type(value).__name__}>"
    if isinstance(value, Fraction) and len(text) > SHOWN:
        return written(value)
    if "\n" in text:
        text = " ".join(text.split())
    return shortened(text)


def _by_parts(value: Any) -> str:
    try:
        if isinstance(value, Fraction):
            return written(value)
        if type(value).__name__ == "ndarray":
            return f"array({shown(value.tolist())})"
        if type(value) in (list, tuple):
            ends = "[]" if type(value) is list else "()"
            return ends[0] + ", ".join(map(shown, value[:SHOWN])) + ends[1]
    except RecursionError:
        pass
    return f"<{type(value).__name__}>"


def shortened(text: str) -> str:
    """``text``, shortened if it has more than SHOWN characters."""
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 20]}… ({len(text)} characters)"


def written(number: Any) -> str:
    """``str(number)`` for an element of a field. A numerator or denominator of more than 200 digits is shown by its
    ends and its length: 31415926…46095505[300 digits].
    """
    if type(number) is Fraction and number.denominator != 1:
        return f"{_digits(number.numerator)}/{_digits(number.denominator)}"
    return _digits(int(number)) if type(number) in (int, Fraction) else str(number)


def _digits(n: int) -> str:
    # since log₂ 10 > 3.3, an int of fewer than 3.3·SHOWN bits has at most SHOWN digits
    if n.bit_length() < 3.3 * SHOWN:
        return str(n)
    from gmpy2 import mpz

    size = mpz(abs(n))
    # num_digits may be one too large
    count = size.num_digits(10)
    head = size // mpz(10) ** (count - ENDS)
    if head < 10 ** (ENDS - 1):
        count -= 1
        head = size // mpz(10) ** (count - ENDS)
    if count <= SHOWN:
        return str(n)
    return f"{'-' if n < 0 else ''}{head}…{size % 10**ENDS:0{ENDS}d}[{count} digits]"
