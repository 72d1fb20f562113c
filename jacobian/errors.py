"""Named errors of the divisor engine.

Misuse (a wrong argument) is a :class:`ValueError`; what the mathematics itself refuses has a name of
its own below, so that a caller can tell a typing mistake from a divisor that does not exist.
"""

from __future__ import annotations

from itertools import islice
from numbers import Real
from operator import index
from typing import Any, TypeVar

Choice = TypeVar("Choice")
NO_SEQUENCES = (str, bytes, bytearray, memoryview, dict, set, frozenset)
"""What iterates over something else than the entries of a sequence."""
SHOWN = 200
"""Characters of a value that a message shows."""
MOST_ENTRIES = 10_000_000
"""More of them come from a generator without an end; numpy arrays may be longer."""


class JacobianError(ValueError):
    """Base class of every error raised by :mod:`jacobian` and :mod:`integrable`."""


class ArgumentError(JacobianError):
    """An argument is wrong; the message names it, gives its value and says what would be right."""


class FieldError(ArgumentError):
    """A value does not lie in the field, or values of two fields are mixed."""


class NotASquare(JacobianError):
    """A square root was asked for that the field does not contain."""


class SingularCurve(ArgumentError):
    """The equation y² + h(x)y = f(x) has a singular point, affine or at infinity."""


class CurveMismatch(ArgumentError):
    """Two divisors of different curves were combined."""


class NotOnCurve(ArgumentError):
    """A point or a Mumford pair does not satisfy the equation of its curve."""


class NotRepresentable(JacobianError):
    """The class exists, but not in the representation that was asked for."""


class PrecisionLoss(JacobianError, ArithmeticError):
    """An inexact field cannot decide whether a quantity is zero; more digits may decide it."""


class Infeasible(JacobianError):
    """The answer exists, but the method at hand would take too long; the message says where its limit lies."""


class NotAMultiple(JacobianError):
    """A discrete logarithm was asked for that does not exist: the target is not in the group of the base."""


def entries(values: Any, argument: str, wanted: str = "a sequence of numbers") -> list[Any]:
    """The entries of a sequence, or an ArgumentError that names ``argument`` and says what is ``wanted``. Sets and
    dictionaries are none; a table of pandas, which iterates over its labels, has the entries of its array.
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
    """``values``, as an array what has dimensions and is none; ValueError where entries are masked."""
    import numpy as np

    if np.ma.is_masked(values):
        raise ValueError("some entries are masked")
    return np.asarray(values) if hasattr(values, "ndim") and not isinstance(values, np.ndarray) else values


def one_or_more(values: Any, argument: str) -> list[Any]:
    """A number, as a list of one, or the entries of a sequence of them."""
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


def flag(value: Any, argument: str) -> bool:
    """``value``, which is True or False (numpy's too), or an ArgumentError that names ``argument``."""
    if value is True or value is False:
        return bool(value)
    if type(value).__module__ == "numpy" and type(value).__name__ in ("bool", "bool_"):
        return bool(value)
    raise ArgumentError(f"{argument} = {shown(value)}: True or False is needed")


def floats(values: Any, argument: str, wanted: str) -> Any:
    """Numbers as an array of floats, or an ArgumentError that names ``argument`` and says what is ``wanted``."""
    import numpy as np

    try:
        return np.asarray(_unmasked(values), dtype=np.float64)
    except Exception:
        raise ArgumentError(f"{argument} = {shown(values)}: {wanted}") from None


def several(which: Any) -> bool:
    """Whether ``which`` chooses some of many things (:func:`chosen`), and not one."""
    import numpy as np

    try:
        return isinstance(which, slice) or np.ndim(which) > 0
    except ValueError:
        # lists of several lengths
        return True


def chosen(which: Any, count: int) -> Any:
    """What chooses some of ``count`` things: a slice, or an array of numbers or truth values."""
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
        raise ArgumentError(f"[{shown(which)}]: there are {count}")
    return found


def one_of(value: Any, argument: str, choices: tuple[Choice, ...], wanted: str) -> Choice:
    """The number or string among ``choices`` that ``value`` equals, or an ArgumentError that names ``argument`` and
    says what is ``wanted``.
    """
    if isinstance(value, (str, Real)):
        for choice in choices:
            if value == choice:
                return choice
    raise ArgumentError(f"{argument} = {shown(value)}: {wanted}")


def shown(value: Any) -> str:
    """``repr(value)`` for a message: on one line, cut where it is long, and without the errors that a repr may have."""
    if isinstance(value, int) and value.bit_length() > 4 * SHOWN:
        return f"an int of {value.bit_length()} bits"
    try:
        text = repr(value)
    except Exception:
        return f"<{type(value).__name__}>"
    if "\n" in text:
        text = " ".join(text.split())
    return shortened(text)


def shortened(text: str) -> str:
    """A text that a user wrote, cut where it is long."""
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 20]}… ({len(text)} characters)"
