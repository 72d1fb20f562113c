"""Types of arguments and results: the elements of a field, polynomials over it, and what a field reads as a number.

``HyperellipticCurve[Fraction]``, ``Jacobian[int]``, ``Divisor[float]`` name the type of the elements. Without the
bracket they are of any type.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Protocol, SupportsComplex, SupportsFloat, SupportsIndex, TypeAlias

if TYPE_CHECKING:
    from os import PathLike
    from random import Random
    from typing import Any

    import numpy as np
    from typing_extensions import TypeVar

    Element = TypeVar("Element", default=Any)
    Other = TypeVar("Other", default=Any)
    # where no field is given, the coordinates of a ball or a top are floats
    Coordinate = TypeVar("Coordinate", default=float)
else:
    # before Python 3.13 type variables have no defaults; only type checkers need them
    from typing import TypeVar

    Element, Other, Coordinate = TypeVar("Element"), TypeVar("Other"), TypeVar("Coordinate")


class Real(Protocol):
    """The operators of a real number: a float, mpf or mpfr, an array of these, or a symbol."""

    def __add__(self, other: Any, /) -> Any: ...
    def __radd__(self, other: Any, /) -> Any: ...
    def __sub__(self, other: Any, /) -> Any: ...
    def __rsub__(self, other: Any, /) -> Any: ...
    def __mul__(self, other: Any, /) -> Any: ...
    def __rmul__(self, other: Any, /) -> Any: ...
    def __truediv__(self, other: Any, /) -> Any: ...
    def __rtruediv__(self, other: Any, /) -> Any: ...
    def __pow__(self, other: Any, /) -> Any: ...
    def __neg__(self) -> Any: ...
    def __abs__(self) -> Any: ...
    def __lt__(self, other: Any, /) -> Any: ...
    def __le__(self, other: Any, /) -> Any: ...
    def __gt__(self, other: Any, /) -> Any: ...
    def __ge__(self, other: Any, /) -> Any: ...
    def __float__(self) -> float: ...


class Complex(Real, Protocol):
    """The operators of a real or complex number of gmpy2."""

    @property
    def real(self) -> Any: ...

    @property
    def imag(self) -> Any: ...

    def conjugate(self) -> Any: ...

    def __complex__(self) -> complex: ...


class Arithmetic(Protocol[Element]):
    """The operations that polynomials need from the field of their coefficients."""

    name: str
    exact: bool
    characteristic: int
    zero: Element
    one: Element

    def coerce(self, value: object, argument: str = "value") -> Element:
        """The element that ``value`` stands for, or a FieldError that names ``argument``.

        Every field reads rational numbers (:func:`jacobian.fields.coercion.rational`): ints of any kind, fractions,
        Decimals, and strings such as "3", "-1/3", "0.25" and "1e3". GF(p) takes rational numbers whose denominator p
        does not divide. GF(p^k) writes its elements as ints, so it takes only whole numbers and lists of coefficients.
        RR, CC and MP round a rational number once, and read floats too; CC and MP(dps, complex=True) also read complex
        numbers; exact fields refuse floats, because 0.1 is not 1/10. An array without dimensions counts as its number.
        NaN, infinities, bytes, sequences and other arrays are refused.
        """
        ...

    def add(self, x: Element, y: Element) -> Element: ...
    def sub(self, x: Element, y: Element) -> Element: ...
    def mul(self, x: Element, y: Element) -> Element: ...
    def neg(self, x: Element) -> Element: ...
    def inv(self, x: Element) -> Element:
        """1/x; ZeroDivisionError at zero."""
        ...

    def div(self, x: Element, y: Element) -> Element: ...

    def dot(self, xs: Sequence[Element], ys: Sequence[Element]) -> Element:
        """Σ x_i y_i, reduced (or rounded) once."""
        ...


class FormulaField(Arithmetic[Element], Protocol[Element]):
    """The arithmetic of the numbers in a formula: field elements, jets, long numbers, balls or arrays."""

    def sqrt(self, x: Element) -> Element: ...


class Polynomial(Protocol):
    """A polynomial of galois, python-flint or PARI."""

    @property
    def coeffs(self) -> object: ...


Number = SupportsFloat | SupportsComplex | SupportsIndex
"""A number of Python, numpy, mpmath, gmpy2, python-flint or PARI."""
Numbers: TypeAlias = "Number | Iterable[Number]"
Value = Number | str
"""The arguments that a field reads: a number, or a string such as "1/3" or "0.25"."""
Coefficients: TypeAlias = "Iterable[Value | Sequence[Value]] | Polynomial"
"""The arguments that are read as polynomials; a coefficient in GF(p^k) may itself be a sequence."""
File: TypeAlias = "str | PathLike[str]"
Table: TypeAlias = "Iterable[Value | Iterable[Value]]"
"""A vector, or a matrix by its rows."""
Rows: TypeAlias = "SupportsIndex | slice | Sequence[int] | np.ndarray"
"""A selection of rows: an int selects one, a slice or an array several."""
Rng: TypeAlias = "Random | np.random.Generator"
"""A source of random numbers."""
