"""Methods of a curve for its equation over other fields, its twist, and its points over finite fields.

They belong to the base class of :class:`jacobian.curve.curve.HyperellipticCurve`. Methods that need the arithmetic of
the Jacobian call methods of :class:`jacobian.finite.group.FiniteGroup`.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, Self

from jacobian import poly
from jacobian.curve.zeta import ZetaFunction
from jacobian.element import Element, File, Other, Value
from jacobian.errors import ArgumentError, JacobianError, SingularCurve, shown
from jacobian.fields.change import change_of_field
from jacobian.fields.protocol import Field, check_field
from jacobian.fields.quadratic import quadratic_roots
from jacobian.immutable import Immutable

if TYPE_CHECKING:
    import numpy as np

    from jacobian.arithmetic.record import LPolynomials
    from jacobian.curve.curve import HyperellipticCurve
    from jacobian.group import Jacobian


class CurveQuestions(Immutable, Generic[Element]):
    """Base of :class:`jacobian.curve.curve.HyperellipticCurve`."""

    field: Field[Element]
    f: poly.Poly[Element]
    h: poly.Poly[Element]
    genus: int
    model: str
    infinity_plus: Any

    def jacobian(self) -> Jacobian[Element]:
        """The Jacobian of this curve, always the same object (:class:`jacobian.group.Jacobian`)."""
        raise NotImplementedError

    @cached_property
    def discriminant(self) -> poly.Poly[Element]:
        """h² + 4f, whose roots are the branch points in characteristic other than 2."""
        K = self.field
        four_f = poly.scale(K, poly.integer(K, 4), self.f)
        return poly.add(K, poly.mul(K, self.h, self.h), poly.trim(K, four_f))

    # --- over other fields

    def change_ring(self, K: Field[Other]) -> HyperellipticCurve[Other]:
        """The curve with the same equation over the field K. From QQ, K may be any field (reduction modulo p); from a
        finite field, a larger one or a subfield that contains all coefficients; from RR, CC and MP(dps), any of these.

        ∞₊ is mapped to ∞₊ where possible. FieldError where the coefficients do not lie in K, SingularCurve at a prime
        of bad reduction of this equation (another equation may be good there: :meth:`bad_primes`).
        """
        from jacobian.curve.curve import HyperellipticCurve

        K = check_field(K, "K")
        move = change_of_field(self.field, K)
        f, h = (tuple(move(c) for c in a) for a in (self.f, self.h))
        try:
            reduced: HyperellipticCurve[Other] = HyperellipticCurve(K, f, h)
        except JacobianError as error:
            raise SingularCurve(f"K = {K.name}: {self!r} has bad reduction there: {error}") from None
        if reduced.genus != self.genus:
            raise SingularCurve(
                f"K = {K.name}: {self!r} has bad reduction there: all of f_{2 * self.genus + 2}, "
                f"f_{2 * self.genus + 1} and h_{self.genus + 1} vanish"
            )
        if self.model == reduced.model == "split":
            return HyperellipticCurve(K, f, h, move(self.infinity_plus))
        return reduced

    def bad_primes(self) -> list[int]:
        """The primes at which :meth:`change_ring` refuses this equation over QQ, ascending: those that divide a
        denominator, and those at which it is singular.
        """
        return self.jacobian().bad_primes()

    def quadratic_twist(self, d: Element | Value | None = None) -> Self:
        """The quadratic twist by d. It is isomorphic to the curve over K(√d), in characteristic 2 over K(root of y² + y
        + d).

        Its equation is y² = d·(h² + 4f), in characteristic 2 y² + hy = f + d·h². By default d is the first element of a
        finite field for which K(√d) is larger; over QQ there is no default. ArgumentError for a d whose twist is the
        curve itself.
        """
        K: Any = self.field
        even = K.characteristic == 2
        if d is None:
            if K.order is None:
                raise ArgumentError(f"d = None: over {K.name} there are many twists, say which")
            # in characteristic 2, d must have trace 1; the trace is linear, so the first such element is a power of a.
            # In odd characteristic and even degree, all elements of the prime field are squares
            odd = range(1 if K.degree % 2 else K.characteristic, K.order)
            first = (1 << k for k in range(K.degree)) if even else odd
            d = next(x for x in map(K.element, first) if not self._twists_nothing(x))
        by = K.coerce(d, "d")
        if (K.is_zero(by) and not even) or (K.exact and self._twists_nothing(by)):
            raise ArgumentError(f"d = {shown(by)}: the twist by it is the curve itself, or none; give a non-square")
        if even:
            f, h = poly.add(K, self.f, poly.scale(K, by, poly.mul(K, self.h, self.h))), self.h
        else:
            f, h = poly.scale(K, by, self.discriminant), ()
        return type(self)(K, f, h)  # type: ignore[call-arg]

    def _twists_nothing(self, d: Element) -> bool:
        K: Any = self.field
        b, c = (K.one, d) if K.characteristic == 2 else (K.zero, d)
        return bool(K.is_zero(d)) or len(quadratic_roots(K, b, c)) > 0

    # --- over QQ, at all primes

    def l_polynomials(self, bound: int, file: File | None = None, progress: bool = False) -> LPolynomials:
        """The L-polynomials of a curve over QQ of genus 1, 2 or 3 at all primes p ≤ ``bound`` of good reduction of this
        equation: :class:`jacobian.arithmetic.record.LPolynomials` (Harvey and Sutherland 2014, 2016).

        ``file``: where the state of a long run is saved; the same call resumes from it. ``progress``: show a bar (tqdm,
        of the extra ``app``). FieldError over other fields, Infeasible in other genera or for bound > 2^24.
        """
        return self.jacobian().l_polynomials(bound, file, progress)

    def hasse_witt_matrices(self, bound: int) -> tuple[np.ndarray, np.ndarray]:
        """(p, W) for a curve over QQ: odd primes of good reduction up to ``bound``, (N,), and W_p modulo p, (N, g, g),
        with L_p(T) ≡ det(1 − T·W_p). A few primes are left out:
        :func:`jacobian.arithmetic.l_polynomials.hasse_witt_matrices` says which.
        """
        return self.jacobian().hasse_witt_matrices(bound)

    # --- for other systems

    def to_flint(self) -> tuple[Any, Any]:
        """The pair (f, h) as python-flint's polynomials, over finite fields and QQ."""
        from jacobian.curve.export import to_flint

        f, h = to_flint(self.field, self.f, self.h)
        return f, h

    def to_pari(self) -> str:
        """The vector [f, h] as text for PARI's ``hyperellcharpoly``; ``cypari.pari(C.to_pari())`` reads it."""
        from jacobian.curve.export import to_pari

        return to_pari(self.field, self.f, self.h)

    def to_sage(self) -> str:
        """Two lines of Sage that make the ring R of polynomials and the curve C."""
        from jacobian.curve.export import to_sage

        return to_sage(self.field, self.f, self.h)

    # --- over finite fields

    def count_points(self, n: int = 1) -> list[int]:
        """The numbers of points over GF(q), GF(q²), … GF(qⁿ), those at infinity included.

        They are computed from :meth:`jacobian.finite.group.FiniteGroup.frobenius_polynomial`, within its limits
        (Infeasible beyond).
        """
        return self.zeta_function().count_points(n)

    def zeta_function(self) -> ZetaFunction:
        """Z(T) = exp Σ #C(GF(qⁿ)) Tⁿ/n = L(T)/((1 − T)(1 − qT)) (:class:`jacobian.curve.zeta.ZetaFunction`)."""
        chi = self.jacobian().frobenius_polynomial()
        q: Any = self.field.order
        return ZetaFunction(tuple(chi[::-1]), (1, -1 - q, q))

    def l_polynomial(self) -> list[int]:
        """L(T), ascending, of degree 2g, with L(0) = 1 and L(1) = #J: the numerator of the zeta function."""
        return list(self.zeta_function().numerator)

    def cartier_manin(self) -> list[list[Element]]:
        """The Cartier–Manin matrix A_ji, the coefficient of x^(ip−j) in F^((p−1)/2), F = h² + 4f (Yui 1978).

        The field is finite of odd characteristic (else FieldError). The time grows like √p over GF(p), p < 2^49, and
        like p over other fields (Infeasible beyond p = 10^8). Other authors transpose it, and call A^(1/p) the
        Hasse–Witt matrix.
        """
        return self.jacobian().cartier_manin()

    def p_rank(self) -> int:
        """The rank over GF(p) of the p-torsion of the Jacobian over the algebraic closure, 0 … g (finite fields).

        In characteristic 2 the p-rank follows from h, over any field. Otherwise the limits of :meth:`cartier_manin` or
        of point counting apply.
        """
        return self.jacobian().p_rank()

    def is_ordinary(self) -> bool:
        """Whether the p-rank is g."""
        return self.p_rank() == self.genus

    def is_supersingular(self) -> bool:
        """Whether all slopes of Frobenius are 1/2, so that over the algebraic closure the Jacobian is isogenous to a
        power of a supersingular elliptic curve (Oort 1974).
        """
        return self.jacobian().is_supersingular()
