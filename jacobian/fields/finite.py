"""Code common to finite fields: powers, square roots, Artin–Schreier equations, enumeration."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from functools import cached_property
from random import Random
from typing import Any, Generic

from jacobian import poly
from jacobian.element import Element, Rng
from jacobian.errors import NotASquare, written
from jacobian.fields.randomness import random_below
from jacobian.immutable import Immutable


class FiniteFieldOf(Immutable, Generic[Element]):
    """A finite field of elements of type ``Element``: a subclass supplies coerce, add, mul, neg, inv and element."""

    name: str
    exact = True
    characteristic: int
    order: int
    zero: Element
    one: Element

    def coerce(self, value: object, argument: str = "value") -> Element:
        """The element that ``value`` stands for, or a FieldError that names ``argument``."""
        raise NotImplementedError

    def add(self, x: Element, y: Element) -> Element:
        raise NotImplementedError

    def sub(self, x: Element, y: Element) -> Element:
        return self.add(x, self.neg(y))

    def mul(self, x: Element, y: Element) -> Element:
        raise NotImplementedError

    def neg(self, x: Element) -> Element:
        raise NotImplementedError

    def inv(self, x: Element) -> Element:
        raise NotImplementedError

    def element(self, index: int) -> Element:
        """The element number ``index`` of an enumeration 0 … order − 1 that starts with zero and one."""
        raise NotImplementedError

    def div(self, x: Element, y: Element) -> Element:
        return self.mul(x, self.inv(y))

    def dot(self, xs: Sequence[Element], ys: Sequence[Element]) -> Element:
        """Σ x_i y_i."""
        total = self.zero
        for x, y in zip(xs, ys, strict=True):
            total = self.add(total, self.mul(x, y))
        return total

    def is_zero(self, x: Element, scale: object = None) -> bool:
        """Whether x is zero; ``scale`` is not used."""
        return bool(x == self.zero)

    def key(self, x: Element) -> Hashable:
        """x itself, which is hashable."""
        result: Hashable = x
        return result

    def from_key(self, key: Element) -> Element:
        """The element whose :meth:`key` is ``key``."""
        return key

    def random(self, rng: Rng) -> Element:
        """A uniform element. ``rng``: numpy Generator or random.Random."""
        return self.element(random_below(rng, self.order))

    def elements(self) -> Iterator[Element]:
        """All elements, in the order of :meth:`element`."""
        return (self.element(index) for index in range(self.order))

    def power(self, x: Element, exponent: int) -> Element:
        """x**exponent, exponent ≥ 0."""
        return poly.power(self, x, exponent)

    def is_square(self, x: Element) -> bool:
        """Whether x is a square, by Euler's criterion."""
        if self.characteristic == 2 or x == self.zero:
            return True
        return bool(self.power(x, (self.order - 1) // 2) == self.one)

    def sqrt(self, x: Element) -> Element:
        """One square root of x, or NotASquare (Tonelli 1891, Shanks 1973)."""
        if self.characteristic == 2:
            return self.power(x, self.order // 2)
        if x == self.zero:
            return x
        odd = self.order - 1
        twos = (odd & -odd).bit_length() - 1
        odd >>= twos
        start = self.power(x, odd // 2)
        root = self.mul(x, start)
        rest = self.mul(root, start)  # x^odd, an element of the 2-Sylow group; root² = x·rest
        generator: Any = None
        while rest != self.one:
            square, height = rest, 0
            while square != self.one:
                square = self.mul(square, square)
                height += 1
                if height == twos:
                    raise NotASquare(f"{written(x)} is not a square in {self.name}")
            if generator is None:
                generator = self.sylow_generator
            for _ in range(twos - height - 1):
                generator = self.mul(generator, generator)
            root = self.mul(root, generator)
            generator = self.mul(generator, generator)
            rest = self.mul(rest, generator)
            twos = height
        return root

    @cached_property
    def sylow_generator(self) -> Element:
        """A generator of the 2-Sylow group: a non-square to the power of the odd part of order − 1."""
        odd = self.order - 1
        odd //= odd & -odd
        rng = Random(0)
        # candidates are random, since the first elements may all lie in a subfield, and all be squares
        candidate = self.random(rng)
        while self.is_square(candidate):
            candidate = self.random(rng)
        return self.power(candidate, odd)

    def artin_schreier(self, c: Element) -> Element:
        """One z with z² + z = c in characteristic 2, or NotASquare when the absolute trace of c is 1.

        With Tr θ = 1, z = Σ_{i<j} c^(2^i) θ^(2^j) (IEEE P1363, A.4.7). In odd degree θ = 1, and z is the half-trace.
        """
        degree = self.order.bit_length() - 1
        theta = self._trace_one
        z, power, partial = self.zero, c, self.zero
        for _ in range(degree - 1):
            theta = self.mul(theta, theta)
            partial = self.add(partial, power)
            z = self.add(z, self.mul(partial, theta))
            power = self.mul(power, power)
        if self.add(self.mul(z, z), z) != c:
            raise NotASquare(f"z² + z = {written(c)} has no solution in {self.name}")
        return z

    @cached_property
    def _trace_one(self) -> Element:
        rng = Random(0)
        candidate = self.one
        while self.trace(candidate) == self.zero:
            candidate = self.random(rng)
        return candidate

    def trace(self, x: Element) -> Element:
        """The trace of x down to GF(2): zero or one (characteristic 2 only)."""
        total = x
        for _ in range(self.order.bit_length() - 2):
            x = self.mul(x, x)
            total = self.add(total, x)
        return total


class FiniteField(FiniteFieldOf[int]):
    """A finite field whose elements are the ints 0 … order − 1. :func:`jacobian.GF` returns it."""

    zero = 0
    one = 1

    @property
    def galois(self) -> Any:
        """galois's class of this field."""
        raise NotImplementedError

    def to_galois(self, elements: Sequence[int]) -> Any:
        """The galois array of elements."""
        return self.galois(list(elements))

    def element(self, index: int) -> int:
        return index
