"""Divisor classes in Mumford form: immutable values with a reference to their group, which does the arithmetic.

:class:`GroupLaw` is the interface that a divisor, and every function on divisors, uses. The groups themselves are
:class:`jacobian.group.Jacobian` and :class:`jacobian.relatives.glued.GeneralizedJacobian`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from operator import index
from typing import TYPE_CHECKING, Any, Generic, Literal, SupportsIndex

from jacobian import poly
from jacobian.curve import latex
from jacobian.curve.curve import HyperellipticCurve
from jacobian.curve.points import Given, Point
from jacobian.element import Coefficients, Element, Other, Rng, Value
from jacobian.errors import NO_SEQUENCES, ArgumentError, CurveMismatch, FieldError, shown, whole
from jacobian.fields.change import change_of_field
from jacobian.fields.protocol import Field
from jacobian.immutable import Immutable

if TYPE_CHECKING:
    from typing_extensions import TypeIs


class GroupLaw(Immutable, Generic[Element]):
    """A group of divisor classes on ``curve``, over ``field``. Its methods assume divisors of this group, without
    checks.
    """

    curve: HyperellipticCurve[Element]
    field: Field[Element]
    weight_of_zero: int | None
    """n of the identity on a split model, else None."""

    def zero(self) -> Divisor[Element]:
        """The identity."""
        raise NotImplementedError

    def add(self, D: Divisor[Element], E: Divisor[Element]) -> Divisor[Element]:
        """D + E."""
        raise NotImplementedError

    def double(self, D: Divisor[Element]) -> Divisor[Element]:
        """D + D."""
        raise NotImplementedError

    def negate(self, D: Divisor[Element]) -> Divisor[Element]:
        """−D."""
        raise NotImplementedError

    def multiply(self, m: int, D: Divisor[Element]) -> Divisor[Element]:
        """m·D for any int m."""
        raise NotImplementedError

    def from_mumford(
        self, u: poly.Poly[Element] | Coefficients, v: poly.Poly[Element] | Coefficients | Value, n: int | None = None
    ) -> Divisor[Element]:
        """The class of the Mumford pair (u, v), which is checked."""
        raise NotImplementedError

    def from_points(
        self,
        points: Iterable[Given[Element]],
        *,
        multiplicities: Iterable[int] | None = None,
        extension: Field[Element] | None = None,
    ) -> Divisor[Element]:
        """The class of Σ P_i minus as many points at infinity."""
        raise NotImplementedError

    def __call__(self, P: Given[Element] | Literal[0], Q: Given[Element] | None = None) -> Divisor[Element]:
        """The class of P − Q, or of P alone minus a point at infinity."""
        raise NotImplementedError

    def _reduced(self, u: poly.Poly[Element], v: poly.Poly[Element], n: int | None) -> Divisor[Element]:
        """The class of a semi-reduced triple, of any degree, over an exact field."""
        raise NotImplementedError

    def random(self, rng: Rng) -> Divisor[Element]:
        """A random class."""
        raise NotImplementedError

    def support(self, D: Divisor[Element], extension: Field[Element] | None = None) -> list[tuple[Point[Element], int]]:
        """The points of D with multiplicities: see :meth:`Divisor.support`."""
        raise NotImplementedError

    def change_ring(self, K: Field[Other]) -> GroupLaw[Other]:
        """The same group of the curve over another field."""
        raise NotImplementedError

    def order(self) -> int:
        """The number of classes, over a finite field."""
        raise NotImplementedError

    def order_of(
        self, D: Divisor[Element], multiple: int | None = None, primes: Iterable[int] | None = None
    ) -> int | float:
        """The order of D: see :meth:`Divisor.order`."""
        raise NotImplementedError


class Divisor(Immutable, Generic[Element]):
    """A reduced divisor class (u, v, n) of a Jacobian. Get one from :meth:`jacobian.group.Jacobian.from_mumford` or
    ``from_points``.

    ``u``: ascending coefficients, monic, of degree at most g. ``v``: the polynomial of degree below deg u that equals y
    on the roots of u; over an exact field it is trimmed, over an inexact one it has length deg u. ``n``: the weight at
    ∞₊ on a split model, in 0 … g − deg u; None on other models, where deg u determines it. ``jacobian``: the group.

    Operations: ``+``, ``−``, ``m * D``, ``==``, ``hash``. ``bool(D)`` is False for the identity; in sums the int 0
    stands for it. Over inexact fields ``==`` compares the numbers of the representation, which does not decide whether
    the classes are equal. Combining divisors of two curves raises CurveMismatch.
    """

    __slots__ = ("jacobian", "n", "u", "v")

    u: poly.Poly[Element]
    v: poly.Poly[Element]
    n: int | None
    jacobian: GroupLaw[Element]

    def __init__(
        self, jacobian: GroupLaw[Element], u: poly.Poly[Element], v: poly.Poly[Element], n: int | None
    ) -> None:
        _set_jacobian(self, jacobian)
        _set_u(self, u)
        _set_v(self, v)
        _set_n(self, n)

    @property
    def degree(self) -> int:
        """The number of affine points, deg u."""
        return len(self.u) - 1

    def support(self, extension: Field[Element] | None = None) -> list[tuple[Point[Element], int]]:
        """The points of D with their multiplicities: the affine ones by ascending x, then ∞₊ and ∞₋ of a split model.

        ``extension``: a larger finite field to find the points in. ``from_points`` of the result is D again. Raises
        NotRepresentable when the field does not contain all points, and names the degree of the extension that does;
        FieldError over an inexact field.
        """
        return self.jacobian.support(self, extension)

    def change_ring(self, K: Field[Other]) -> Divisor[Other]:
        """The image of D over the field K (:meth:`jacobian.curve.questions.CurveQuestions.change_ring`).

        FieldError where u and v have no image, such as modulo a prime at which a point of D goes to infinity.
        """
        J, move = self.jacobian.change_ring(K), change_of_field(self.jacobian.field, K)
        try:
            u, v = ([move(c) for c in a] for a in (self.u, self.v))
        except FieldError:
            if J.field.order is None or self.jacobian.field.order is not None:
                raise
            raise FieldError(f"K = {J.field.name}: {self!r} has a point that goes to infinity there") from None
        if self.n is not None and J.curve.model == "inert" and 2 * self.n + self.degree != J.curve.genus:
            raise FieldError(f"K = {J.field.name}: {self!r} has unlike weights at ∞₊ and ∞₋, which are conjugate there")
        # on an inert model n is None; where the model becomes split, from_mumford gives ∞₊ and ∞₋ equal weights
        return J.from_mumford(u, v, self.n if J.weight_of_zero is not None else None)

    def to_galois(self) -> tuple[Any, Any]:
        """The pair (u, v) as galois.Poly; FieldError if galois has no class for the field (QQ, RR, CC, MP)."""
        K = self.jacobian.curve.field
        return poly.to_galois(K, self.u), poly.to_galois(K, self.v)

    def to_flint(self) -> tuple[Any, Any]:
        """The pair (u, v) as python-flint's polynomials, over a finite field or QQ."""
        from jacobian.curve.export import to_flint

        u, v = to_flint(self.jacobian.curve.field, self.u, self.v)
        return u, v

    def __add__(self, other: Divisor[Element] | Literal[0]) -> Divisor[Element]:
        if not isinstance(other, Divisor):
            return self if is_zero_int(other) else NotImplemented
        return self.jacobian.add(self, self._compatible(other))

    def __radd__(self, other: int) -> Divisor[Element]:
        # sum([D, E]) begins with the int 0, which stands for the identity as in J(0)
        return self if is_zero_int(other) else NotImplemented

    def __rsub__(self, other: int) -> Divisor[Element]:
        return -self if is_zero_int(other) else NotImplemented

    def __sub__(self, other: Divisor[Element] | Literal[0]) -> Divisor[Element]:
        if not isinstance(other, Divisor):
            return self if is_zero_int(other) else NotImplemented
        return self.jacobian.add(self, self.jacobian.negate(self._compatible(other)))

    def _compatible(self, other: Divisor[Element]) -> Divisor[Element]:
        if other.jacobian is not self.jacobian and other.jacobian != self.jacobian:
            raise CurveMismatch(
                f"divisors of two curves cannot be combined: {self.jacobian.curve!r} and {other.jacobian.curve!r}"
            )
        return other

    def __neg__(self) -> Divisor[Element]:
        return self.jacobian.negate(self)

    def __pos__(self) -> Divisor[Element]:
        return self

    def double(self) -> Divisor[Element]:
        """D + D."""
        return self.jacobian.double(self)

    def order(self, multiple: int | None = None, primes: Iterable[int] | None = None) -> int | float:
        """The least m > 0 with m·D = 0; over QQ ``math.inf`` for infinite order (:mod:`jacobian.finite.orders`).

        ``multiple``: a known multiple of the order, by default #J; ``primes``: its prime factors, if known.
        """
        return self.jacobian.order_of(self, multiple, primes)

    def __mul__(self, scalar: SupportsIndex) -> Divisor[Element]:
        if isinstance(scalar, Divisor):
            return NotImplemented
        return self.jacobian.multiply(check_scalar(scalar), self)

    __rmul__ = __mul__
    # otherwise numpy would multiply a numpy integer and D element by element
    __array_ufunc__ = None

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Divisor):
            return NotImplemented
        same = self.u == other.u and self.v == other.v and self.n == other.n
        return same and (self.jacobian is other.jacobian or self.jacobian == other.jacobian)

    def __hash__(self) -> int:
        K = self.jacobian.curve.field
        return hash((tuple(map(K.key, self.u)), tuple(map(K.key, self.v)), self.n))

    def __bool__(self) -> bool:
        return len(self.u) > 1 or self.n != self.jacobian.weight_of_zero

    def __repr__(self) -> str:
        K = self.jacobian.curve.field
        weight = "" if self.n is None else f", n={self.n}"
        return f"({poly.text(K, self.u)}, {poly.text(K, self.v)}{weight})"

    def _latex_(self) -> str:
        K = self.jacobian.curve.field
        parts = [latex.polynomial(K, self.u), latex.polynomial(K, self.v)]
        return rf"\left({', '.join(parts if self.n is None else [*parts, f'n = {self.n}'])}\right)"

    def _repr_latex_(self) -> str:
        return f"${self._latex_()}$"

    def _repr_html_(self) -> str:
        from jacobian.notebook import named

        K = self.jacobian.curve.field
        facts = [("u", poly.text(K, self.u)), ("v", poly.text(K, self.v)), ("curve", self.jacobian.curve)]
        return named("divisor class", facts if self.n is None else [*facts, ("n", self.n)])

    def __reduce__(self) -> tuple[object, ...]:
        K = self.jacobian.curve.field
        return _rebuild, (self.jacobian, tuple(map(K.key, self.u)), tuple(map(K.key, self.v)), self.n)


_set_jacobian = Divisor.__dict__["jacobian"].__set__
_set_u = Divisor.__dict__["u"].__set__
_set_v = Divisor.__dict__["v"].__set__
_set_n = Divisor.__dict__["n"].__set__


def _rebuild(jacobian: GroupLaw[Element], u: Any, v: Any, n: int | None) -> Divisor[Element]:
    K: Any = jacobian.curve.field
    return Divisor(jacobian, tuple(map(K.from_key, u)), tuple(map(K.from_key, v)), n)


def is_zero_int(value: object) -> TypeIs[Literal[0]]:
    """Whether ``value`` is the int 0, Python's or numpy's, which stands for the identity of any group."""
    if isinstance(value, bool) or not hasattr(value, "__index__"):
        return False
    try:
        return index(value) == 0 and getattr(value, "ndim", 0) == 0
    except Exception:
        return False


def check_divisor(D: object, argument: str) -> Divisor:
    """``D``, or an ArgumentError that names ``argument``."""
    if not isinstance(D, Divisor):
        raise ArgumentError(f"{argument} = {shown(D)}: a Divisor is needed")
    return D


def check_scalar(scalar: SupportsIndex, argument: str = "scalar") -> int:
    """``scalar`` as an int (numpy integers too), or an ArgumentError that names ``argument``."""
    return scalar if type(scalar) is int else whole(scalar, argument)


def check_scalars(scalars: Any, count: int, argument: str = "scalar") -> int | list[int]:
    """``scalars`` as an int, or as a list of ``count`` ints if it is a sequence or a flat array; else ArgumentError."""
    import numpy as np

    several = isinstance(scalars, Sequence | np.ndarray) and not isinstance(scalars, NO_SEQUENCES)
    if not several or getattr(scalars, "ndim", 1) == 0:
        return check_scalar(scalars, argument)
    if getattr(scalars, "ndim", 1) != 1 or len(scalars) != count:
        raise ArgumentError(
            f"{argument} = {shown(scalars)} beside {shown(count)} rows: one int, or a flat array of one for each row"
        )
    if isinstance(scalars, np.ndarray) and scalars.dtype.kind in "iu" and not np.ma.is_masked(scalars):
        found: list[int] = scalars.tolist()
        return found
    return [check_scalar(m, f"{argument}[{i}]") for i, m in enumerate(scalars)]
