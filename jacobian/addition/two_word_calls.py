"""One addition, doubling or multiple in genus 2 over GF(p), p of two words, or GF(2^n), n ≤ 127, each a single call of
compiled code.

The explicit formulas want h = 0 for odd p and, on a ramified model, a monic f
(:mod:`jacobian.addition.genus2_two_words`). What is not general goes to the kernel in Python; so does a
whole multiple that meets such a case on its way.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from jacobian.addition.cantor import Triple
from jacobian.addition.genus2_two_words import CONTEXTS, MODELS, SINGLE_LIBRARIES, context_of
from jacobian.addition.genus2_words import short_equation
from jacobian.addition.ladder import signed_digits
from jacobian.curve.curve import HyperellipticCurve
from jacobian.native.library import Packed

WINDOW = 5
"""Bits of a digit of a scalar."""


class TwoWordKernel:
    """Addition, doubling and multiples of reduced triples on one curve with a short equation; ``others`` are those of
    the kernel in Python.
    """

    def __init__(self, C: HyperellipticCurve, others: Any) -> None:
        K = context_of(C.field)
        equation: Any = short_equation(C, K.to_word)
        run = SINGLE_LIBRARIES[type(K), type(equation)]
        self._sum = run.add_lines.of_longs(K, equation)
        self._twice = run.double_line.of_longs(K, equation)
        self._times = run.multiple_line
        self._packed = Packed(K, CONTEXTS[type(K)]), Packed(equation, MODELS[type(equation)])
        self._others = others
        self._weight = 0 if C.model == "split" else None

    def sum_of(self, a: Triple, b: Triple) -> Triple:
        """The reduced triple of a + b."""
        (u1, v1, _), (u2, v2, _) = a, b
        if len(u1) == 3 == len(u2) and len(v1) == 2 == len(v2):
            found = self._sum(u1[1], u1[0], v1[1], v1[0], u2[1], u2[0], v2[1], v2[0])
            if found[0]:
                return self._triple(*found)
        return self._others.sum_of(a, b)

    def double(self, a: Triple) -> Triple:
        """The reduced triple of a + a."""
        u, v, _ = a
        if len(u) == 3 and len(v) == 2:
            found = self._twice(u[1], u[0], v[1], v[0])
            if found[0]:
                return self._triple(*found)
        return self._others.double(a)

    def multiple(self, m: int, a: Triple) -> Triple:
        """The reduced triple of m·a, m > 0."""
        u, v, _ = a
        if len(u) == 3 and len(v) == 2:
            digits = np.array(signed_digits(m, WINDOW), np.int64)
            odd = np.empty((4, 1 << (WINDOW - 2), 2), np.int64)
            found = self._times(*self._packed, (u[1], u[0], v[1], v[0]), digits, odd)
            if found[0]:
                return self._triple(*found)
        return self._others.multiple(m, a)

    def _triple(self, general: int, e1: int, e0: int, v1: int, v0: int) -> Triple:
        return (e0, e1, 1), (v0, v1) if v1 else (v0,) if v0 else (), self._weight
