"""Images of divisor classes under correspondences: the sum of the images of their points, computed without the points.

A class of genus 2 in general position is that of P + Q minus two points at infinity, (u, v) with deg u = 2. Let A be
the ring K[t]/u. The point (t, v(t)) over A is mapped to a pair (U_t, V_t) on the target. The sum of the pairs for both
roots t of u is (U, V) over K, where U is the norm of U_t, and V ≡ V_t modulo U_t. A class in special position is
written as the difference of two classes in general position.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from random import Random
from typing import Any

from jacobian import poly
from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import CurveMismatch, NotRepresentable
from jacobian.fields import GF
from jacobian.fields.change import change_of_field
from jacobian.fields.protocol import Field
from jacobian.law.divisor import Divisor
from jacobian.linear import solution

TRIES = 50


class Family:
    """A pair (U_t, V_t) = (``modulus``, ``value``) over A = K[t]/u, deg u = 2: ascending coefficients in A.

    Elements of A are polynomials in t of degree at most one; ``generator`` is t.
    """

    def __init__(self, K: Field, u: poly.Poly) -> None:
        self.field, self.u = K, u
        self.generator: poly.Poly = (K.zero, K.one)
        self.modulus: list[poly.Poly] = []
        self.value: list[poly.Poly] = []

    def reduced(self, a: poly.Poly) -> poly.Poly:
        return poly.mod(self.field, a, self.u)

    def times(self, a: poly.Poly, b: poly.Poly) -> poly.Poly:
        """The product a·b in A = K[t]/u."""
        return self.reduced(poly.mul(self.field, poly.trim(self.field, a), poly.trim(self.field, b)))

    def over(self, a: poly.Poly, b: poly.Poly) -> poly.Poly | None:
        """The quotient a/b in A = K[t]/u; None where b is no unit."""
        if not b:
            return None
        common, inverse = poly.half_xgcd(self.field, self.u, b)
        return self.times(a, inverse) if len(common) == 1 else None

    def set_modulus(self, form: list[poly.Poly]) -> bool:
        """Sets U_t to a form made monic; returns False where its leading coefficient is no unit."""
        monic = [self.over(c, form[-1]) for c in form]
        self.modulus = [c for c in monic if c is not None]
        return len(self.modulus) == len(form)

    def set_value(self, value: list[poly.Poly]) -> None:
        """Sets V_t to ``value`` modulo U_t."""
        size, rest = len(self.modulus) - 1, list(value)
        while len(rest) > size:
            top = rest.pop()
            for i in range(size):
                k = len(rest) - size + i
                rest[k] = poly.sub(self.field, rest[k], self.times(top, self.modulus[i]))
        self.value = rest

    def norm(self) -> poly.Poly:
        """The polynomial U, the product of the U_t for both roots t of u."""
        K, (c, b, _) = self.field, self.u
        real = tuple(x[0] if x else K.zero for x in self.modulus)
        other = tuple(x[1] if len(x) > 1 else K.zero for x in self.modulus)
        first, mixed, last = poly.mul(K, real, real), poly.mul(K, real, other), poly.mul(K, other, other)
        return poly.trim(K, poly.add(K, poly.sub(K, first, poly.scale(K, b, mixed)), poly.scale(K, c, last)))

    def trace(self) -> poly.Poly | None:
        """The V over K with V ≡ V_t modulo U_t, by a linear system; None if the U_t of both t have a common root."""
        K, size = self.field, len(self.modulus) - 1
        columns, power = [], [(K.one,), *[()] * (size - 1)]
        for _ in range(2 * size):
            columns.append([x for c in power for x in self._numbers(c)])
            top = power[-1]
            power = [(), *power[:-1]]
            power = [poly.sub(K, x, self.times(top, m)) for x, m in zip(power, self.modulus, strict=False)]
        right = [x for c in [*self.value, *[()] * size][:size] for x in self._numbers(c)]
        found = solution(K, [list(row) for row in zip(*columns, strict=True)], right)
        return None if found is None else poly.trim(K, found)

    def _numbers(self, a: poly.Poly) -> list[Any]:
        return [*a, *[self.field.zero] * (2 - len(a))]


# a correspondence, as a function of a field L ⊇ K, the map K[x] → L[x], and u, v over L. Its result is the Family of
# the images of the points of (u, v), or None if they are not defined
Families = Callable[[Any, Callable[[poly.Poly], poly.Poly], poly.Poly, poly.Poly], "Family | None"]


def pushed(C: HyperellipticCurve, E: HyperellipticCurve, D: Divisor, families: Families) -> Divisor:
    """The image on E of a class D on C, a curve of genus 2, under the correspondence that ``families`` describes.

    CurveMismatch for a D on another curve, NotRepresentable where no classes in general position are found.
    """
    if D.jacobian.curve != C:
        raise CurveMismatch(f"D = {D!r} lies on {D.jacobian.curve!r}, the isogeny begins at {C!r}")
    if not D:
        return E.jacobian().zero()
    for L in _fields(C.field):
        found = _pushed(E.change_ring(L), D.change_ring(L), families, change_of_field(C.field, L))
        if found is not None:
            return found.change_ring(C.field)
    raise NotRepresentable(f"D = {D!r}: no classes in general position were found over {C.field.name}")


def _fields(K: Any) -> Iterator[Any]:
    """K, and extensions of odd degree of a finite K, because small fields have few points in general position."""
    yield K
    if K.order is not None:
        yield from (GF(K.characteristic, k * K.degree) for k in (3, 5, 7))


def _pushed(E: HyperellipticCurve, D: Divisor, families: Families, move: Callable[[Any], Any]) -> Divisor | None:
    """The image of D, or that of D + R minus that of R for a class R; None if for no R tried both are defined."""

    def image(R: Divisor) -> Divisor | None:
        """The image of a class P + Q minus infinity with P and Q in general position."""
        family = families(E.field, lambda a: tuple(map(move, a)), R.u, R.v) if R.degree == 2 else None
        value = None if family is None else family.trace()
        if family is None or value is None:
            return None
        u = family.norm()
        # the points of C over x = ∞ are mapped to a multiple of those of E, so ∞₊ and ∞₋ are subtracted equally often
        n = (E.genus + 1) // 2 - (len(u) - 1) // 2 if E.model == "split" else None
        return E.jacobian()._reduced(u, value, n)

    direct = image(D)
    if direct is not None:
        return direct
    for R in _others(D):
        both, one = image(D + R), image(R)
        if both is not None and one is not None:
            return both - one
    return None


def _others(D: Divisor) -> Iterator[Divisor]:
    """Yields multiples of D, then random classes."""
    multiple, rng = D, Random(f"{D!r}")
    for _ in range(8):
        multiple = multiple + D
        yield multiple
    with suppress(NotRepresentable):
        for _ in range(TRIES):
            yield D.jacobian.random(rng)
