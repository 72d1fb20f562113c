"""A Jacobian as an abelian group: multiples of several divisors and, over a finite field, orders, structure, logarithms
and pairings. Each method calls the module that does the work, imported on first use.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from jacobian.element import Element, Rng
from jacobian.errors import CurveMismatch, FieldError, shown
from jacobian.law.divisor import Divisor, GroupLaw, check_divisor

if TYPE_CHECKING:
    from jacobian.finite.scalar import FixedBase
    from jacobian.finite.structure import Structure
    from jacobian.relatives.rational_torsion import RationalTorsion


class FiniteGroup(GroupLaw[Element]):
    """Base of :class:`jacobian.group.Jacobian`: the methods for orders, structure, logarithms and pairings."""

    def _own(self, D: object, argument: str) -> Divisor[Element]:
        """D, a class of this group; ArgumentError if D is no Divisor, CurveMismatch if D belongs to another group."""
        own = check_divisor(D, argument)
        if own.jacobian != self:
            raise CurveMismatch(f"{argument} = {shown(D)} does not lie in the {self!r}")
        return own

    # --- scalars

    def fixed_base(self, D: Divisor[Element], window: int = 5) -> FixedBase:
        """A table of multiples of D: ``table(m)`` and ``m * table`` are m·D, several times as fast as ``m * D``."""
        from jacobian.finite.scalar import FixedBase

        return FixedBase(self._own(D, "D"), window)

    def combination(self, scalars: Iterable[int], divisors: Iterable[Divisor[Element]]) -> Divisor[Element]:
        """Σ m_i·D_i, faster than term by term: Straus's method for few terms, Pippenger's for many."""
        from jacobian.finite.scalar import combination

        return combination(self, scalars, divisors)

    def frobenius(self, D: Divisor[Element], power: int = 1) -> Divisor[Element]:
        """The image of D under (x, y) → (x^(p^power), y^(p^power)); CurveMismatch when the curve is not fixed by it."""
        from jacobian.finite.scalar import frobenius

        return frobenius(self._own(D, "D"), power)

    # --- order and structure

    def frobenius_polynomial(self) -> list[int]:
        """The characteristic polynomial of Frobenius, ascending: degree 2g, constant term q^g, value #J at 1.

        It is computed by counting or by a search. The search reaches prime fields up to 2^49 in genus 2 and 3, in time
        Õ(√p), and any field of up to 10^22 elements in genus 1, in time O(q^(1/4)). Curves y² = bx⁵ + a, and bx⁷ + a
        where p ≢ 2, 4 modulo 7, are covered over GF(p) of any size. Infeasible beyond
        these limits (:mod:`jacobian.finite.frobenius`). The result is proven. From p = 10^13 on this takes minutes;
        the logger ``jacobian.progress`` reports the remaining time.
        """
        from jacobian.finite.frobenius import frobenius_polynomial

        return frobenius_polynomial(self.curve)

    def cartier_manin(self) -> list[list[Element]]:
        """See :meth:`jacobian.curve.questions.CurveQuestions.cartier_manin`."""
        from jacobian.finite.hasse_witt import cartier_manin

        return cartier_manin(self.curve)

    def p_rank(self) -> int:
        """See :meth:`jacobian.curve.questions.CurveQuestions.p_rank`."""
        from jacobian.finite.slopes import p_rank

        return p_rank(self.curve)

    def is_supersingular(self) -> bool:
        """See :meth:`jacobian.curve.questions.CurveQuestions.is_supersingular`."""
        from jacobian.finite.slopes import is_supersingular

        return is_supersingular(self.curve)

    def bad_primes(self) -> list[int]:
        """See :meth:`jacobian.curve.questions.CurveQuestions.bad_primes`."""
        from jacobian.finite.reduction import bad_primes

        return bad_primes(self.curve)

    def order(self) -> int:
        """#J over a finite field, proven: the value of :meth:`frobenius_polynomial` at 1, within the limits of that
        method.
        """
        return sum(self.frobenius_polynomial())

    def order_bounds(self) -> tuple[int, int]:
        """The least and the largest #J that Weil's theorem allows over this finite field."""
        from jacobian.finite.weil import order_bounds

        if self.field.order is None:
            raise FieldError(f"field = {self.field.name}: a Jacobian has an order over finite fields")
        return order_bounds(self.field.order, self.curve.genus)

    def order_of(
        self, D: Divisor[Element], multiple: int | None = None, primes: Iterable[int] | None = None
    ) -> int | float:
        """The order of D, from a multiple of the order (default #J) and its prime factors
        (:func:`jacobian.finite.orders.order_of`)."""
        from jacobian.finite.orders import order_of

        return order_of(self._own(D, "D"), multiple, primes)

    def structure(self, primes: Iterable[int] | None = None) -> Structure:
        """The invariant factors d_1 | d_2 | … of the group and independent generators of these orders.

        ``primes``: the prime factors of #J, if known (:func:`jacobian.finite.structure.structure`).
        """
        from jacobian.finite.structure import structure

        return structure(self, primes)

    def exponent(self, primes: Iterable[int] | None = None) -> int:
        """The least m > 0 with m·D = 0 for all D."""
        return self.structure(primes).exponent

    def torsion(self, m: int) -> Structure:
        """The classes D with m·D = 0: invariant factors and generators; ``.elements()`` lists them."""
        from jacobian.finite.structure import torsion

        return torsion(self, m)

    def rational_torsion(self, height: int = 100) -> RationalTorsion:
        """The classes of finite order over QQ. In genus 2 the result is proven to be complete. In other genera it is
        the group that points of up to this height generate, with a bound from reductions, which may prove that it is
        complete (:func:`jacobian.relatives.rational_torsion.rational_torsion`).
        """
        from jacobian.relatives.rational_torsion import rational_torsion

        return rational_torsion(self, height)

    def is_divisible(self, D: Divisor[Element], m: int) -> bool:
        """Whether D = m·E for a class E."""
        from jacobian.finite.structure import is_divisible

        return is_divisible(self._own(D, "D"), m)

    # --- logarithms and pairings

    def log(
        self,
        base: Divisor[Element],
        target: Divisor[Element],
        *,
        order: int | None = None,
        primes: Iterable[int] | None = None,
        interval: tuple[int, int] | None = None,
        rng: Rng | None = None,
    ) -> int:
        """An m with m·base = target, or NotAMultiple.

        ``interval=(low, high)``: the range to search; without it the least m ≥ 0, by Pohlig and Hellman's method, which
        accepts ``order`` and ``primes`` (:func:`jacobian.finite.discrete_log.discrete_log`).
        """
        from jacobian.finite.discrete_log import discrete_log

        own = self._own(base, "base"), self._own(target, "target")
        return discrete_log(*own, order=order, primes=primes, interval=interval, rng=rng)

    def weil_pairing(self, D: Divisor[Element], E: Divisor[Element], m: int) -> Element:
        """e_m(D, E), an m-th root of unity in the field, for m·D = m·E = 0
        (:func:`jacobian.finite.pairing.weil_pairing`)."""
        from jacobian.finite.pairing import weil_pairing

        return weil_pairing(self._own(D, "D"), self._own(E, "E"), m)

    def tate_pairing(self, D: Divisor[Element], E: Divisor[Element], m: int) -> Element:
        """The reduced Tate pairing, for m·D = 0 and m | q − 1 (:func:`jacobian.finite.pairing.tate_pairing`)."""
        from jacobian.finite.pairing import tate_pairing

        return tate_pairing(self._own(D, "D"), self._own(E, "E"), m)
