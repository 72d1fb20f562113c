"""The Jacobian of a hyperelliptic curve as a group."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import inf
from typing import TYPE_CHECKING, Any, Literal, SupportsIndex, overload

from jacobian import poly
from jacobian.addition import cantor
from jacobian.addition.choice import Kernel, compiled_kernel, explained, kernel
from jacobian.addition.ladder import by_parts, multiple
from jacobian.curve.curve import HyperellipticCurve, check_curve
from jacobian.curve.points import Given, Point
from jacobian.element import Coefficients, Element, File, Other, Rng, Value
from jacobian.errors import (
    ArgumentError,
    Infeasible,
    NotOnCurve,
    NotRepresentable,
    PrecisionLoss,
    shown,
    whole,
    written,
)
from jacobian.finite.group import FiniteGroup
from jacobian.inexact.dense import absolute, added, bound, product, remainder
from jacobian.law.divisor import Divisor, is_zero_int

if TYPE_CHECKING:
    import numpy as np

    from jacobian.arithmetic.record import LPolynomials
    from jacobian.batch.array import DivisorArray
    from jacobian.fields.protocol import Field

LONG_OVER_Q, LONG_SCALAR = 20, 4096
"""Scalars of more bits than these are first reduced: over QQ modulo the order of the class, in a small finite group
modulo its order.
"""
COUNTED_AT_ONCE = 1 << 20
"""The largest estimate q^g of a group's size for which computing the order takes less time than a long multiple."""


class Jacobian(FiniteGroup[Element]):
    """The group of divisor classes of degree 0 of a hyperelliptic curve; get it from ``HyperellipticCurve.jacobian()``.

    Over exact fields the kernel of :mod:`jacobian.addition.choice` adds, over inexact ones
    :mod:`jacobian.inexact.composition`. On a ramified model with deg f = 2g+2 or deg h = g+1, divisors are added in the
    coordinates of ``arithmetic_model``, but always show the curve's own coordinates. On an inert model of odd genus,
    divisors have no representation (NotRepresentable), but the order of the group can be computed.
    """

    _sum_of: Callable[[cantor.Triple, cantor.Triple], cantor.Triple]
    _double: Callable[[cantor.Triple], cantor.Triple]
    _multiple: Callable[[int, cantor.Triple], cantor.Triple]

    def __init__(self, curve: HyperellipticCurve[Element]) -> None:
        self.curve = check_curve(curve)
        self.field = curve.field
        self.weight_of_zero = cantor.weight_of_zero(curve)
        model = curve.arithmetic_model
        self._model = model
        # divisors move to the arithmetic model by v → v − infinity_plus·x^(g+1)
        self._move = None if model is curve else poly.monomial(self.field, curve.infinity_plus, curve.genus + 1)
        if self.field.exact:
            self._adopt(kernel(model, self._adopt))

    def _adopt(self, chosen: Kernel) -> None:
        """Makes the group add with this kernel from now on. A kernel in Python thus hands over to a compiled one."""
        for name, function in zip(("_sum_of", "_double", "_multiple"), chosen, strict=True):
            object.__setattr__(self, name, function)

    def compile(self) -> None:
        """Makes the group add with compiled code from now on, if the field has any.

        Compilation happens automatically after some work; this method compiles now. After ``python -m jacobian
        compile`` the wait is about a second (:mod:`jacobian.addition.choice`).
        """
        chosen = compiled_kernel(self._model) if self.field.exact else None
        if chosen is not None:
            self._adopt(chosen)

    def explain(self) -> str:
        """A text that names the current kernel, the reason for it, and what may replace it."""
        if not self.field.exact:
            return f"orthogonal transformations of a linear system (jacobian.inexact.stacked): {self.field.name} rounds"
        return explained(self._model, self._sum_of)

    def __repr__(self) -> str:
        return f"Jacobian of {self.curve!r}"

    def _latex_(self) -> str:
        return rf"\mathrm{{Jac}}\left({self.curve._latex_()}\right)"

    def _repr_latex_(self) -> str:
        return f"${self._latex_()}$"

    def _value(self) -> tuple[object, ...]:
        return (self.curve,)

    def __reduce__(self) -> tuple[object, ...]:
        return _jacobian_of, (self.curve,)

    # --- elements

    def zero(self) -> Divisor[Element]:
        """The identity: (1, 0), with n = ⌈g/2⌉ on a split model."""
        self._check_representable()
        return Divisor(self, (self.field.one,), (), self.weight_of_zero)

    def from_mumford(
        self, u: poly.Poly[Element] | Coefficients, v: poly.Poly[Element] | Coefficients | Value, n: int | None = None
    ) -> Divisor[Element]:
        """The class of the Mumford pair (u, v): ascending coefficients or galois.Poly, u monic, u | v² + hv − f.

        A pair with deg u ≤ g is stored with v taken modulo u; a semi-reduced pair with deg u > g is reduced. ``n``, the
        weight at ∞₊ on a split model, lies in 0 … g − deg u, and may be any int where deg u > g; the default ⌈(g − deg
        u)/2⌉ shares the weight evenly. On other models it must be None. Raises ArgumentError, FieldError, NotOnCurve
        with the remainder of v² + hv − f, PrecisionLoss where terms of this remainder exceed the range of floats.
        """
        self._check_representable()
        u = self._check_monic(poly.coerce(self.field, u, "u"))
        v = poly.mod(self.field, poly.coerce(self.field, v, "v", constant=True), u)
        if not self.field.exact:
            v = (*v, *[self.field.zero] * (len(u) - 1 - len(v)))
        n = self._check_weight(n, len(u) - 1)
        self._check_on_curve(u, v)
        if len(u) - 1 <= self.curve.genus:
            return Divisor(self, u, v, n)
        if not self.field.exact:
            raise NotRepresentable(
                f"u has degree {len(u) - 1} > g = {self.curve.genus}: over {self.field.name} add smaller ones"
            )
        return self._reduced(u, v, n)

    def _reduced(self, u: poly.Poly[Element], v: poly.Poly[Element], n: int | None) -> Divisor[Element]:
        """The class of a semi-reduced triple, of any degree, over an exact field; nothing is checked."""
        return self._out(cantor.reduce(self._model, self._in_triple(u, v, n)))

    def from_points(
        self,
        points: Iterable[Given[Element]],
        *,
        multiplicities: Iterable[int] | None = None,
        extension: Field[Element] | None = None,
    ) -> Divisor[Element]:
        """The class of Σ P_i minus the same number of points at infinity. The P_i are pairs (x, y) and points at
        infinity, repeated or with ``multiplicities``. ``extension``: a larger finite field that contains x and y; each
        point must then come with all its conjugates.

        For r points, r·∞ is subtracted on a ramified model, and ⌊r/2⌋(∞₊+∞₋) on a split one. If r is odd on a split
        model, one of ∞₊ and ∞₋ is subtracted too, such that the weight at ∞₊ becomes ⌈(g−r)/2⌉. An inert model needs an
        even r (else NotRepresentable).
        """
        self._check_representable()
        from jacobian.law.from_points import divisor_of_points, repeated

        points = repeated(points, multiplicities)
        if extension is not None:
            from jacobian.law.conjugates import divisor_of_conjugates

            return divisor_of_conjugates(self, points, extension)
        return divisor_of_points(self, [self.curve.check_point(point) for point in points])

    def support(self, D: Divisor[Element], extension: Field[Element] | None = None) -> list[tuple[Point[Element], int]]:
        """The points of D with multiplicities: see :meth:`jacobian.law.divisor.Divisor.support`."""
        from jacobian.law.conjugates import support

        return support(self._own(D, "D"), extension)

    def change_ring(self, K: Field[Other]) -> Jacobian[Other]:
        """The Jacobian of the curve over K: see :meth:`jacobian.curve.questions.CurveQuestions.change_ring`."""
        return self.curve.change_ring(K).jacobian()

    def __call__(self, P: Given[Element] | Literal[0], Q: Given[Element] | None = None) -> Divisor[Element]:
        """J(P, Q) is the class of P − Q; J(P) is ``from_points([P])``; J(0) the identity."""
        if Q is None:
            return self.zero() if is_zero_int(P) else self.from_points([P])
        points: list[Any] = [P, self.curve.involution(Q)]
        return self.from_points(points)

    @overload
    def random(self, rng: Rng | None = None) -> Divisor[Element]: ...

    @overload
    def random(self, rng: Rng | None = None, *, size: int) -> DivisorArray[Element]: ...

    @overload
    def random(self, rng: Rng | None, size: int) -> DivisorArray[Element]: ...

    def random(self, rng: Rng | None = None, size: int | None = None) -> Divisor[Element] | DivisorArray[Element]:
        """A random class: uniform in the group over a finite field, the sum of g random points elsewhere.

        ``rng``: a numpy Generator or a random.Random; equal seeds give equal classes. Without ``rng`` every call gives
        another class. ``size``: the number of classes, returned as a :class:`jacobian.batch.DivisorArray`.
        """
        self._check_representable()
        if rng is None:
            from random import Random

            rng = Random()  # seeded by the operating system
        if size is not None:
            from jacobian.batch.array import DivisorArray

            return DivisorArray.random(self, rng, size)
        from jacobian.law.sampling import random_divisor

        return random_divisor(self, rng)

    def points(self) -> Iterable[Divisor[Element]]:
        """All classes, over a small finite field, by trying every reduced (u, v, n)."""
        self._check_representable()
        from jacobian.law.sampling import all_divisors

        return all_divisors(self)

    # --- over QQ, at all primes

    def l_polynomials(self, bound: int, file: File | None = None, progress: bool = False) -> LPolynomials:
        """See :meth:`jacobian.curve.questions.CurveQuestions.l_polynomials`."""
        from jacobian.arithmetic.l_polynomials import with_progress

        return with_progress(self.curve, bound, file, progress)

    def hasse_witt_matrices(self, bound: int) -> tuple[np.ndarray, np.ndarray]:
        """See :meth:`jacobian.curve.questions.CurveQuestions.hasse_witt_matrices`."""
        from jacobian.arithmetic.l_polynomials import hasse_witt_matrices

        return hasse_witt_matrices(self.curve, bound)

    def _check_representable(self) -> None:
        if self.curve.model == "inert" and self.curve.genus % 2:
            raise NotRepresentable(
                f"{self.curve!r} is inert of odd genus {self.curve.genus}: its classes have no unique Mumford form; "
                "move a rational point of the curve to infinity, or extend the field so that the model splits"
            )

    def _check_monic(self, u: poly.Poly[Element]) -> poly.Poly[Element]:
        K = self.field
        if not u:
            raise ArgumentError("u = 0: a monic polynomial is needed")
        if u[-1] != K.one:
            raise ArgumentError(
                f"u = {poly.text(K, u)} is not monic: divide it by its leading coefficient {written(u[-1])}"
            )
        return u

    def _check_weight(self, n: SupportsIndex | None, degree: int) -> int | None:
        genus, model = self.curve.genus, self.curve.model
        if model == "inert" and degree % 2:
            raise NotRepresentable(
                f"u of degree {shown(degree)}: on an inert model deg u must be even, its infinity being one place"
            )
        if model != "split":
            if n is not None:
                raise ArgumentError(f"n = {shown(n)}: a {model} model has no weight at infinity, leave n out")
            return None
        if n is None:
            return (genus - degree + 1) // 2
        n = whole(n, "n", "the weight at ∞₊ is an int")
        if degree <= genus and not 0 <= n <= genus - degree:
            raise ArgumentError(
                f"n = {shown(n)}: beside deg u = {shown(degree)} the weight at ∞₊ lies in 0 … {shown(genus - degree)}"
            )
        return n

    def _check_on_curve(self, u: poly.Poly[Element], v: poly.Poly[Element]) -> None:
        K: Any = self.field
        f, h = self.curve.f, self.curve.h
        rest = poly.mod(K, poly.sub(K, poly.mul(K, v, poly.add(K, v, h)), f), u)
        on_curve = not rest if K.exact else all(map(K.is_rounding, rest, self._scales(u, v)))
        if not on_curve:
            raise NotOnCurve(
                f"(u, v) = ({poly.text(K, u)}, {poly.text(K, v)}) is not on {self.curve!r}: v² + hv − f leaves the "
                f"remainder {poly.text(K, rest)} modulo u"
            )

    def _scales(self, u: poly.Poly, v: poly.Poly) -> poly.Poly:
        """Bounds for the terms that add up to the coefficients of v² + hv − f modulo u."""
        a = absolute(v)
        terms = added(absolute(self.curve.f), product(a, added(a, absolute(self.curve.h))))
        return tuple(remainder(terms, bound(u)))

    # --- the group law

    def add(self, D: Divisor[Element], E: Divisor[Element]) -> Divisor[Element]:
        """D + E, for divisors of this Jacobian."""
        if not self.field.exact:
            return self._add_inexact(D, E)
        if self._move is None:
            return Divisor(self, *self._sum_of((D.u, D.v, D.n), (E.u, E.v, E.n)))
        return self._out(self._sum_of(self._in(D), self._in(E)))

    def double(self, D: Divisor[Element]) -> Divisor[Element]:
        """D + D."""
        if not self.field.exact:
            return self._add_inexact(D, D)
        return self._out(self._double(self._in(D)))

    def negate(self, D: Divisor[Element]) -> Divisor[Element]:
        """−D."""
        if not self.field.exact:
            return self._negate_inexact(D)
        return self._out(cantor.negate(self._model, self._in(D)))

    def _negate_inexact(self, D: Divisor[Element]) -> Divisor[Element]:
        u, v, n = cantor.opposite(self.curve, (D.u, D.v, D.n))
        if n is None or n <= self.curve.genus - D.degree:
            return Divisor(self, u, v, n)
        from jacobian.inexact import composition

        return Divisor(self, *composition.negated(self.curve, (u, v, n)))

    def _add_inexact(self, D: Divisor[Element], E: Divisor[Element]) -> Divisor[Element]:
        if not D or not E:
            return D if D else E
        if D.u == E.u and (D.u, D.v, D.n) == cantor.opposite(self.curve, (E.u, E.v, E.n)):
            # D + (−D) is the identity at any precision
            return self.zero()
        from jacobian.inexact import composition

        return self._out(composition.add(self._model, self._in(D), self._in(E)))

    def multiply(self, m: int, D: Divisor[Element]) -> Divisor[Element]:
        """m·D for any int m, by signed windows (:mod:`jacobian.addition.ladder`), or as one call of compiled code."""
        if m < 0:
            return self.multiply(-m, self.negate(D))
        if m == 0:
            return self.zero()
        if not self.field.exact:
            self._check_multiple(m)
            return multiple(m, D, self.add, self.double, self.negate)
        m = self._remainder(m, D)
        return self._out(by_parts(m, self._in(D), self._multiple, self._sum_of)) if m else self.zero()

    def _remainder(self, m: int, D: Divisor[Element]) -> int:
        """An integer r with r·D = m·D, for m > 0: m itself, or, if m is long, a remainder of m.

        Over QQ it is the remainder modulo the order of D, and Infeasible is raised for a D of infinite order. Over a
        finite field it is the remainder modulo the order of the group, if the group is small.
        """
        q, bits = self.field.order, m.bit_length()
        if q is None and bits > LONG_OVER_Q:
            order = D.order()
            if order == inf:
                raise Infeasible(
                    f"scalar = {shown(m)}: D is of infinite order, and m·D has numbers of about m² digits over "
                    f"{self.field.name}; modulo primes (change_ring) they stay short"
                )
            return m % int(order)
        if q is not None and bits > LONG_SCALAR and q**self.curve.genus <= COUNTED_AT_ONCE:
            return m % self.order()
        return m

    def _check_multiple(self, m: int) -> None:
        """Raises PrecisionLoss for an m > 0 that would leave less than two fifths of the digits, because m·D has m
        times the error of D.
        """
        K: Any = self.field
        if m > K.eps**-0.6:
            raise PrecisionLoss(
                f"scalar = {shown(m)}: m·D multiplies rounding by m, and {K.name} carries m up to "
                f"{float(K.eps**-0.6):.1e}; use more digits"
            )

    # --- to the arithmetic model and back

    def _in(self, D: Divisor[Element]) -> cantor.Triple:
        return (D.u, D.v, D.n) if self._move is None else self._in_triple(D.u, D.v, D.n)

    def _in_triple(self, u: poly.Poly[Element], v: poly.Poly[Element], n: int | None) -> cantor.Triple:
        if self._move is None:
            return u, v, n
        return u, poly.mod(self.field, poly.sub(self.field, v, self._move), u), n

    def _out(self, triple: cantor.Triple) -> Divisor[Element]:
        u, v, n = triple
        if self._move is not None:
            v = poly.mod(self.field, poly.add(self.field, v, self._move), u)
        return Divisor(self, u, v, n)


def _jacobian_of(curve: HyperellipticCurve[Element]) -> Jacobian[Element]:
    return curve.jacobian()
