"""Addition, doubling and multiples on two words, each a single call of compiled code: genus 2 and 3 over GF(p), and
genus 2 over GF(2^n), n ≤ 127.

The explicit formulas need h = 0 for odd p and, on a ramified model, a monic f
(:mod:`jacobian.addition.two_word_loops`). Special cases go to the kernel in Python, and so does any multiple whose
ladder meets a special case.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from jacobian.addition.cantor import Triple
from jacobian.addition.ladder import signed_digits
from jacobian.addition.two_word_libraries import CONTEXTS, MODELS, SINGLE_LIBRARIES, context_of, equation_of
from jacobian.curve.curve import HyperellipticCurve
from jacobian.native.library import Packed

WINDOW = 5
"""The width of the non-adjacent form of a scalar, in bits."""


class TwoWordKernel:
    """Addition, doubling and multiples of reduced triples on a curve with a short equation. ``others`` holds the same
    three functions of the kernel in Python, for special cases.
    """

    def __init__(self, C: HyperellipticCurve, others: Any) -> None:
        K = context_of(C.field)
        equation = equation_of(C, K.to_word)
        run = SINGLE_LIBRARIES[type(K), type(equation)]
        self._sum = run.add_classes.of_longs(K, equation)
        self._twice = run.double_class.of_longs(K, equation)
        self._times = run.multiple_of_class
        self._packed = Packed(K, CONTEXTS[type(K)]), Packed(equation, MODELS[type(equation)])
        self._others, self._genus = others, C.genus
        self._weight = 0 if C.model == "split" else None

    # a class whose v has g coefficients has weight g; all others are left to the other kernel

    def sum_of(self, a: Triple, b: Triple) -> Triple:
        """The reduced triple of a + b."""
        (u1, v1, _), (u2, v2, _) = a, b
        if len(v1) == self._genus == len(v2):
            found = self._sum(*u1[:-1], *v1, *u2[:-1], *v2)
            if found[0]:
                return self._triple(found)
        return self._others.sum_of(a, b)

    def double(self, a: Triple) -> Triple:
        """The reduced triple of a + a."""
        u, v, _ = a
        if len(v) == self._genus:
            found = self._twice(*u[:-1], *v)
            if found[0]:
                return self._triple(found)
        return self._others.double(a)

    def multiple(self, m: int, a: Triple) -> Triple:
        """The reduced triple of m·a, m > 0."""
        u, v, _ = a
        if len(v) == self._genus:
            digits = np.array(signed_digits(m, WINDOW), np.int64)
            odd = np.empty((2 * self._genus, 1 << (WINDOW - 2), 2), np.int64)
            found = self._times(*self._packed, u[:-1] + v, digits, odd)
            if found[0]:
                return self._triple(found)
        return self._others.multiple(m, a)

    def _triple(self, found: tuple[int, ...]) -> Triple:
        """The triple of the result (true, u, v) of a call, where u lacks its leading 1."""
        end = self._genus + 1
        v = found[end:]
        while v and not v[-1]:
            v = v[:-1]
        # slicing and adding tuples: unpacking with a star would take as long as a product
        return found[1:end] + (1,), v, self._weight  # noqa: RUF005
