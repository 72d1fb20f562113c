"""First-order jets x + Σ x_k ε_k, ε_iε_j = 0, over any field: derivatives without difference quotients.

:class:`JetField` meets the protocol of :class:`jacobian.fields.protocol.Field`, so polynomials, divisor sums and all
other code over a field run on jets unchanged. The slopes of the results are the derivatives, exact over an exact field
(forward-mode differentiation; Wengert 1964). Jets also have Python's operators, so formulas stay readable over fields
whose elements lack them.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import Any

from jacobian import poly
from jacobian.element import Real, Rng
from jacobian.errors import FieldError, NotRepresentable, shown, written


def _operators(name: str) -> tuple[Callable[[Jet, Jet | Real], Jet], Callable[[Jet, Jet | Real], Jet]]:
    """The methods x, y ↦ x op y and x, y ↦ y op x of :class:`Jet`, where op is the method ``name`` of the field."""

    def operator(x: Jet, other: Jet | Real, reflected: bool = False) -> Jet:
        y = x._other(other)
        if y is None:
            return NotImplemented
        return getattr(x.field, name)(*((y, x) if reflected else (x, y)))

    return operator, lambda x, other: operator(x, other, True)


class Jet:
    """A jet: its ``value``, and its ``slopes`` along the directions of a :class:`JetField`.

    Operators combine it with jets of its field, with ints (m stands for m·1), and over an inexact base field with
    floats.
    """

    __slots__ = ("field", "slopes", "value")

    def __init__(self, field: JetField, value: Real, slopes: tuple[Real, ...]) -> None:
        self.field = field
        self.value = value
        self.slopes = slopes

    def __repr__(self) -> str:
        return f"{self.value}" + "".join(f" + {s}·ε{k}" for k, s in enumerate(self.slopes))

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Jet):
            return bool(self.value == other.value and self.slopes == other.slopes)
        zero = self.field.base.zero
        return bool(self.value == other and all(s == zero for s in self.slopes))

    def __hash__(self) -> int:
        return hash(self.field.key(self))

    def __lt__(self, other: Real) -> bool:
        return bool(self.value < (other.value if isinstance(other, Jet) else other))

    def _other(self, other: object) -> Jet | None:
        if isinstance(other, Jet):
            return other
        if isinstance(other, int):
            return self.field.integer(other)
        return self.field.coerce(other) if isinstance(other, float) and not self.field.exact else None

    __add__, __radd__ = _operators("add")
    __sub__, __rsub__ = _operators("sub")
    __mul__, __rmul__ = _operators("mul")
    __truediv__, __rtruediv__ = _operators("div")

    def __neg__(self) -> Jet:
        return self.field.neg(self)

    def __pos__(self) -> Jet:
        return self

    def __pow__(self, exponent: int) -> Jet:
        return poly.power(self.field, self if exponent >= 0 else self.field.inv(self), abs(exponent))


class JetField:
    """The jets over the field ``base`` with ``directions`` infinitesimals ε_k. With 0 directions a jet is an element of
    the base with Python's operators.

    The methods also take elements of the base, as constants. Strictly this is a ring: a jet of value 0 has no inverse.
    ``order`` is the order of the base.
    """

    def __init__(self, base: Any, directions: int) -> None:
        self.base = base
        self.directions = directions
        self.exact = base.exact
        self.characteristic = base.characteristic
        self.order = base.order
        self.name = f"jets over {base.name}"
        self._flat = (base.zero,) * directions
        self.zero = self.constant(base.zero)
        self.one = self.constant(base.one)
        if not base.exact:
            self.eps = base.eps

    def __repr__(self) -> str:
        return self.name

    def __eq__(self, other: object) -> bool:
        return isinstance(other, JetField) and (other.base, other.directions) == (self.base, self.directions)

    def __hash__(self) -> int:
        return hash(("JetField", self.base, self.directions))

    def constant(self, value: Real) -> Jet:
        """The jet with a given value in the base and all slopes zero."""
        return Jet(self, value, self._flat)

    def variables(self, values: Sequence[Real]) -> tuple[Jet, ...]:
        """The jets values[k] + ε_k, one for each direction."""
        zero, one = self.base.zero, self.base.one
        return tuple(
            Jet(self, x, tuple(one if k == i else zero for k in range(self.directions))) for i, x in enumerate(values)
        )

    def integer(self, m: int) -> Jet:
        """The jet m·1 of an int m."""
        return self.constant(poly.integer(self.base, m))

    def coerce(self, value: object, argument: str = "value") -> Jet:
        """A jet of this field unchanged, or the constant jet of a value that the base accepts. FieldError for a
        jet with another number of slopes.
        """
        if not isinstance(value, Jet):
            return self.constant(self.base.coerce(value, argument))
        if len(value.slopes) != self.directions:
            raise FieldError(f"{argument} = {shown(value)} has {len(value.slopes)} slopes, not {self.directions}")
        return value

    def _jet(self, x: Jet | Real) -> Jet:
        return x if isinstance(x, Jet) else self.constant(x)

    def add(self, x: Jet | Real, y: Jet | Real) -> Jet:
        K, x, y = self.base, self._jet(x), self._jet(y)
        return Jet(self, K.add(x.value, y.value), tuple(map(K.add, x.slopes, y.slopes)))

    def sub(self, x: Jet | Real, y: Jet | Real) -> Jet:
        K, x, y = self.base, self._jet(x), self._jet(y)
        return Jet(self, K.sub(x.value, y.value), tuple(map(K.sub, x.slopes, y.slopes)))

    def neg(self, x: Jet | Real) -> Jet:
        K, x = self.base, self._jet(x)
        return Jet(self, K.neg(x.value), tuple(map(K.neg, x.slopes)))

    def mul(self, x: Jet | Real, y: Jet | Real) -> Jet:
        K, x, y = self.base, self._jet(x), self._jet(y)
        a, b = x.value, y.value
        slopes = tuple([K.add(K.mul(a, t), K.mul(s, b)) for s, t in zip(x.slopes, y.slopes, strict=True)])
        return Jet(self, K.mul(a, b), slopes)

    def inv(self, x: Jet | Real) -> Jet:
        """The inverse 1/x; ZeroDivisionError where the value of x is zero."""
        K, x = self.base, self._jet(x)
        inverse = K.inv(x.value)
        factor = K.neg(K.mul(inverse, inverse))
        return Jet(self, inverse, tuple([K.mul(factor, s) for s in x.slopes]))

    def div(self, x: Jet | Real, y: Jet | Real) -> Jet:
        return self.mul(x, self.inv(y))

    def dot(self, xs: Sequence[Jet | Real], ys: Sequence[Jet | Real]) -> Jet:
        """The sum Σ x_i y_i."""
        total = self.zero
        for x, y in zip(xs, ys, strict=True):
            total = self.add(total, self.mul(x, y))
        return total

    def is_zero(self, x: Jet | Real, scale: Jet | Real | None = None) -> bool:
        """Whether value and slopes are all zero. Over an inexact base only the value counts, relative to ``scale``."""
        x = self._jet(x)
        if self.exact:
            return x == self.zero
        return bool(self.base.is_zero(x.value, scale.value if isinstance(scale, Jet) else scale))

    def sqrt(self, x: Jet | Real, root: Real | None = None) -> Jet:
        """The square root of x whose value is ``root``, by default the base's own root; NotASquare if there is none.

        NotRepresentable if the value is 0 and a slope is not: the root is not differentiable there.
        """
        K, x = self.base, self._jet(x)
        root = K.sqrt(x.value) if root is None else root
        if root == K.zero:
            if x == self.zero:
                return self.zero
            raise NotRepresentable("a square root has no derivative where it vanishes")
        half = K.inv(K.add(root, root))
        return Jet(self, root, tuple([K.mul(half, s) for s in x.slopes]))

    def random(self, rng: Rng) -> Jet:
        """The constant jet of a random element of the base."""
        return self.constant(self.base.random(rng))

    def key(self, x: Jet | Real) -> Hashable:
        """A hashable key of a jet, from the base's keys of its value and slopes."""
        x = self._jet(x)
        return (self.base.key(x.value), *map(self.base.key, x.slopes))


def apply(field: Any, function: Callable[..., object], *values: Real) -> Any:
    """The value of ``function`` at elements of a field. The function uses Python's operators and is called on jets.

    NotRepresentable where it divides by zero.
    """
    jets = isinstance(field, JetField)
    numbers = field if jets else JetField(field, 0)
    try:
        found = numbers.coerce(function(*map(numbers.coerce if jets else numbers.constant, values)))
    except ZeroDivisionError:
        where = ", ".join(map(written, values))
        raise NotRepresentable(
            f"a given function of (h1, h2) divides by zero at ({where}): no point is there"
        ) from None
    return found if jets else found.value
