"""Explicit formulas in Python: additions and doublings of triples on one curve.

:mod:`jacobian.addition.emit` writes the code for the curve's equation. Cantor's algorithm takes over for classes of
lower weight and where a number to be inverted is 0. Tests compare the two methods in every special case.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from types import MethodType
from typing import Any

from jacobian.addition import cantor, genus2, genus3, ladder
from jacobian.addition.emit import OnElements, OnInts, maker, text_of
from jacobian.addition.straight import Formulas
from jacobian.curve.curve import HyperellipticCurve, coefficient
from jacobian.errors import ArgumentError
from jacobian.fields.prime import PrimeField


def formulas_of(C: HyperellipticCurve) -> Formulas | None:
    """The explicit formulas for a C that is its own ``arithmetic_model``; None if there are none."""
    if C.genus == 2:
        return genus2.OF_DEGREE_5 if C.model == "ramified" else genus2.OF_DEGREE_6
    if C.genus != 3 or type(C.field) is not PrimeField or C.h or C.model == "inert":
        return None
    if C.model == "split":
        return genus3.OF_DEGREE_8
    return genus3.OF_DEGREE_7 if C.f[-1] == C.field.one else None


def coefficients(C: HyperellipticCurve, names: tuple[str, ...]) -> dict[str, Any]:
    """The coefficients of C by name: "f3" is f₃, and "c" is the leading coefficient of y at ∞₊."""
    parts = {"f": C.f, "h": C.h}
    return {
        name: C.infinity_plus if name == "c" else coefficient(C.field, parts[name[0]], int(name[1:])) for name in names
    }


class ExplicitFormulas:
    """Addition and doubling of reduced triples on a curve that is its own ``arithmetic_model``, over an exact field.

    ``number`` converts the coefficients that are passed to the code.
    """

    style: Any = OnElements

    def __init__(self, C: HyperellipticCurve, number: Callable[[Any], Any] = lambda x: x) -> None:
        formulas, K = formulas_of(C), C.field
        if formulas is None:
            raise ArgumentError(f"C = {C}: explicit formulas are for genus 2, and for genus 3 over GF(p) with h = 0")
        self.curve, self.formulas = C, formulas
        values = coefficients(C, formulas.coefficients)
        # the formulas only add f₂, f₃ (genus 2) and f₃, f₄, f₅ (genus 3): code for their special values saves little
        factors = values.keys() - {f"f{k}" for k in range(C.genus, 2 * C.genus)}
        known = {x: int(values[x] == K.one) for x in values if x in factors and values[x] in (K.zero, K.one)}
        self.known = (*known.items(), *((("characteristic", 2),) if K.characteristic == 2 else ()))
        given = [getattr(K, name) for name in self.style.needs]
        given += [x for name, x in values.items() if name not in known]
        made = maker(formulas, self.known, self.style)
        functions = made(C, 0 if C.model == "split" else None, *map(number, given))
        for function in functions:
            function.__module__, function.__qualname__ = __name__, f"{type(self).__name__}.{function.__name__}"
        self.sum_of, self.double = (MethodType(function, self) for function in functions)

    def text(self) -> str:
        return text_of(self.formulas, self.known, self.style)


class PrimeFormulas(ExplicitFormulas):
    """The explicit formulas over GF(p), on ints."""

    style = OnInts


GMP_BITS = 32
"""The bits of p from which GMP's integers are faster than Python's; ``python -m benchmarks single`` measures it."""


class GmpFormulas:
    """Explicit formulas over GF(p), run on gmpy2's mpz. They take and return triples of ints."""

    def __init__(self, C: HyperellipticCurve) -> None:
        from gmpy2 import mpz

        # an operation of an int with an mpz returns an mpz, so converting p and the coefficients is enough
        self._integer, formulas = mpz, PrimeFormulas(C, mpz)
        self._sum_of, self._double = formulas.sum_of, formulas.double
        self._ladder = partial(
            ladder.multiple, sum_of=self._sum_of, double=self._double, negate=partial(cantor.negate, C)
        )

    def sum_of(self, a: cantor.Triple, b: cantor.Triple) -> cantor.Triple:
        return _on_ints(self._sum_of(a, b))

    def double(self, a: cantor.Triple) -> cantor.Triple:
        return _on_ints(self._double(a))

    def multiple(self, m: int, a: cantor.Triple) -> cantor.Triple:
        """The reduced triple of m·a, m > 0; intermediate results stay mpz."""
        u, v, n = a
        return _on_ints(self._ladder(m, (tuple(map(self._integer, u)), tuple(map(self._integer, v)), n)))


def _on_ints(a: cantor.Triple) -> cantor.Triple:
    u, v, n = a
    return tuple(map(int, u)), tuple(map(int, v)), n
