"""A rigid body and the constants of its motion.

Units are the user's: moments of inertia in kg·m², d = m r² in kg·m², angular momentum in kg·m²/s and time in s, or any
other consistent set. Axes are the principal axes of inertia, and A is the diagonal matrix of the a_i = 1/(I_i + d).
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from math import isfinite
from typing import Any, Generic, NamedTuple, TypeGuard

from jacobian import RR, poly
from jacobian.element import Arithmetic, Element, FormulaField, Real, Value
from jacobian.errors import ArgumentError, FieldError, NotASquare, entries, shown, written
from jacobian.fields.coercion import is_complex
from jacobian.fields.protocol import Field, check_field
from jacobian.immutable import quick_property

Vector = tuple[Element, Element, Element]

REALS: Any = RR
"""The default field. Its type is Any, so that a body's type follows from the field that is given."""

_unwarned = ContextVar("unwarned", default=False)


class UnphysicalMoments(UserWarning):
    """The warning for principal moments that no distribution of mass has."""


class Integrals(NamedTuple, Generic[Element]):
    """The four integrals of the motion: C1 = (γ, γ), C2 = (γ, M), H1 = (ω, M), H2 = (M, M)."""

    C1: Element
    C2: Element
    H1: Element
    H2: Element


def symmetry_axis(inertia: Vector) -> int | None:
    """The index of the symmetry axis: the moments of the two other axes are equal. None if all three moments differ."""
    # this is written out for speed, since every new flow calls it twice
    x, y, z = inertia
    return 0 if y == z else 1 if z == x else 2 if x == y else None


@dataclass(frozen=True)
class Body(Generic[Element]):
    """Principal moments of inertia and d = m r² over a field; d = 0 is the free rigid body.

    ``a`` holds 1/(I_i + d), the diagonal of A; ``contact`` holds the numbers 1 − d·a_i = I_i/(I_i + d).
    """

    inertia: Vector[Element]
    d: Element
    field: Field[Element] = REALS

    @staticmethod
    def make(inertia: Iterable[Value], d: Value, field: Field[Element]) -> Body[Element]:
        """A Body with checked parameters; ArgumentError names the parameter that is wrong."""
        check_body_field(field)
        K: Any = field
        moments = triple(K, inertia, "inertia")
        offset = K.coerce(d, "d")
        if field.characteristic == 0 and offset < 0:
            raise ArgumentError(f"d = {shown(d)} is negative: d = m r² ≥ 0 (0 for the Euler top)")
        # positive real moments give I_i + d > 0 and need no check
        if field.characteristic != 0 or not min(moments) > 0:
            for i, moment in enumerate(moments):
                _check_moment(field, moment, offset, i)
        return Body(moments, offset, field)

    @quick_property
    def a(self) -> Vector[Element]:
        """a_i = 1/(I_i + d)."""
        inv, add, (x, y, z), d = self.field.inv, self.field.add, self.inertia, self.d
        return inv(add(x, d)), inv(add(y, d)), inv(add(z, d))

    @quick_property
    def contact(self) -> Vector[Element]:
        """The numbers 1 − d·a_i, computed as I_i·a_i so that no digits cancel if I_i is small compared with d."""
        mul, (x, y, z), (a1, a2, a3) = self.field.mul, self.inertia, self.a
        return mul(x, a1), mul(y, a2), mul(z, a3)

    @quick_property
    def differences(self) -> Vector[Element]:
        """The products (a_i − a_j)(a_i − a_k) for i = 1, 2, 3; zero if another axis has the same moment.

        a_i − a_j is computed from I_j − I_i, which is exact where the moments are close.
        """
        K = self.field

        def difference(i: int, j: int) -> Element:
            return K.mul(K.sub(self.inertia[j], self.inertia[i]), K.mul(self.a[i], self.a[j]))

        c1, c2, c3 = (K.mul(difference(i, (i + 1) % 3), difference(i, (i + 2) % 3)) for i in range(3))
        return c1, c2, c3

    @property
    def rolls(self) -> bool:
        """Whether d ≠ 0."""
        return bool(self.d != self.field.zero)

    def conformal(self, gamma: Vector[Element]) -> Element:
        """g⁻² = 1 − d(γ, Aγ), computed as Σ (1 − d·a_i) γ_i²."""
        K = self.field
        return K.dot(self.contact, [K.mul(x, x) for x in gamma])

    def omega(self, gamma: Vector[Element], M: Vector[Element]) -> Vector[Element]:
        """The angular velocity ω = A M + d·n·A γ, n = g²(γ, A M)."""
        K = self.field
        AM = tuple(K.mul(a, x) for a, x in zip(self.a, M, strict=True))
        if not self.rolls:
            return AM[0], AM[1], AM[2]
        spin = K.mul(self.d, K.div(K.dot(gamma, AM), self.conformal(gamma)))
        w1, w2, w3 = (K.add(x, K.mul(spin, K.mul(a, y))) for x, a, y in zip(AM, self.a, gamma, strict=True))
        return w1, w2, w3

    def integrals(self, gamma: Vector[Element], M: Vector[Element]) -> Integrals[Element]:
        """C1, C2, H1, H2 at (γ, M)."""
        K = self.field
        return Integrals(K.dot(gamma, gamma), K.dot(gamma, M), K.dot(self.omega(gamma, M), M), K.dot(M, M))

    def energies(self, gamma: Iterable[Real], M: Iterable[Real]) -> tuple[Real, Real]:
        """H1 and H2, computed with Python's operators: γ and M are three real numbers each or three arrays each."""
        constants: tuple[Any, Any, Any] = self.a, self.contact, self.d
        return energies(*constants, gamma, M)

    def polynomial(self, h1: Element, h2: Element) -> poly.Poly[Element]:
        """Coefficients, ascending, of f(x) = 4(1 − dx)(a1 − x)(a2 − x)(a3 − x)(x h2 − h1): degree 5, or 4 at d = 0."""
        K = self.field
        four = poly.integer(K, 4)
        f: poly.Poly[Element] = (K.neg(K.mul(four, h1)), K.mul(four, h2))
        for a in self.a:
            f = poly.mul(K, f, (a, K.neg(K.one)))
        if self.rolls:
            f = poly.mul(K, f, (K.one, K.neg(self.d)))
        return f


def check_body_field(field: Field[Element]) -> None:
    """Raises FieldError if ``field`` is complex: bodies are over real or exact fields."""
    if field is not REALS and is_complex(check_field(field, "field").zero):
        raise FieldError(f"field = {field.name}: bodies are over RR, MP(dps) or exact fields, not complex numbers")


def say_unphysical(inertia: Sequence[Any], field: Any) -> None:
    """Warns the caller's caller if a moment exceeds the sum of the two others; the equations of motion still hold."""
    if field.characteristic != 0 or _unwarned.get():
        return
    least, middle, most = sorted(inertia)
    if most - least - middle > (0 if field.exact else 4 * field.eps * most):
        warnings.warn(
            f"inertia = {shown(tuple(inertia))}: no distribution of mass has these moments, for {written(most)} > "
            f"{written(least)} + {written(middle)}; the equations of motion hold all the same",
            UnphysicalMoments,
            stacklevel=3,
        )


@contextmanager
def unwarned() -> Iterator[None]:
    """A context that suppresses UnphysicalMoments, for bodies about which the user has already been warned."""
    before = _unwarned.set(True)
    try:
        yield
    finally:
        _unwarned.reset(before)


def energy(a: Iterable[Real], weight: Real, gamma: Iterable[Real], M: Iterable[Real]) -> Any:
    """H1 = (ω, M) = (M, AM) + weight·(γ, AM)² with weight = d·g², computed with Python's operators."""
    # this is written out for speed: every step of a map computes the energies of its image
    (a1, a2, a3), (x1, x2, x3), (m1, m2, m3) = a, gamma, M
    n1, n2, n3 = a1 * m1, a2 * m2, a3 * m3
    spin = x1 * n1 + x2 * n2 + x3 * n3
    return m1 * n1 + m2 * n2 + m3 * n3 + weight * spin * spin


def energies(
    a: Iterable[Real], contact: Iterable[Real], d: Real, gamma: Iterable[Real], M: Iterable[Real]
) -> tuple[Real, Real]:
    """H1 and H2 from a_i, r_i = 1 − d·a_i, d, γ and M. The compiler takes this function unchanged."""
    (r1, r2, r3), (x1, x2, x3), (m1, m2, m3) = contact, gamma, M
    weight = d / (r1 * x1 * x1 + r2 * x2 * x2 + r3 * x3 * x3)
    return energy(a, weight, gamma, M), m1 * m1 + m2 * m2 + m3 * m3


def finite_floats(values: object) -> TypeGuard[tuple[float, ...]]:
    """Whether ``values`` is a tuple of floats with a finite sum."""
    # finite floats with an infinite sum are rejected here, and are then checked one by one
    return type(values) is tuple and {*map(type, values)} == {float} and isfinite(sum(values))


def elements(
    K: FormulaField, values: Iterable[Value], argument: str, count: int | None, wanted: str = ""
) -> tuple[Real, ...]:
    """The elements of ``values``, which must be ``count`` numbers, or any number of them for None; ``wanted`` describes
    them in an ArgumentError.
    """
    if K is RR and finite_floats(values) and count in (len(values), None):
        return values
    wanted = wanted or f"a sequence of {count} numbers"
    given = entries(values, argument, wanted)
    if count not in (len(given), None):
        raise ArgumentError(f"{argument} = {shown(values)}: {wanted} is needed")
    return tuple(K.coerce(x, f"{argument}[{i}]") for i, x in enumerate(given))


def triple(field: Field, values: Any, argument: str) -> Vector:
    """The three given values as elements of the field; other input raises an ArgumentError that names ``argument``."""
    if getattr(values, "shape", None) == (3,) and hasattr(values, "tolist"):
        values = values.tolist()
    if field is RR and type(values) in (list, tuple) and len(values) == 3:
        x, y, z = values
        # names such as "M[0]", for messages, are not made here: they would take a large part of a short run's time
        if type(x) is type(y) is type(z) is float and isfinite(x + y + z):
            return x, y, z
    x, y, z = elements(field, values, argument, 3, "a sequence of three numbers")
    return x, y, z


def cross(field: Arithmetic, x: Vector, y: Vector) -> Vector:
    """The vector product x × y."""
    if field is RR:
        (x1, x2, x3), (y1, y2, y3) = x, y
        return x2 * y3 - x3 * y2, x3 * y1 - x1 * y3, x1 * y2 - x2 * y1
    sub, mul = field.sub, field.mul
    return (
        sub(mul(x[1], y[2]), mul(x[2], y[1])),
        sub(mul(x[2], y[0]), mul(x[0], y[2])),
        sub(mul(x[0], y[1]), mul(x[1], y[0])),
    )


def _check_moment(field: Field, moment: Real, d: Real, i: int) -> None:
    if field.characteristic == 0 and moment <= 0:
        raise ArgumentError(
            f"inertia[{i}] = {written(moment)} is not positive: a moment of inertia is > 0, so that d·a_i < 1"
        )
    if moment == field.zero or field.add(moment, d) == field.zero:
        raise ArgumentError(
            f"inertia[{i}] = {written(moment)} over {field.name}: inertia[{i}] and inertia[{i}] + d must not vanish"
        )


def square_root(field: FormulaField[Element], x: Element, name: str) -> Element:
    """The root √x that the field returns. NotASquare, with the ``name`` of the quantity, if the field has none."""
    try:
        return field.sqrt(x)
    except NotASquare:
        raise NotASquare(
            f"{name} = {written(x)} has no square root in {field.name}: the point has no image there"
        ) from None
