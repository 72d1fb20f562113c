"""The coefficients of x^(p−1), x^(p−2), … in F^((p−1)/2), in Õ(√p) operations (Bostan, Gaudry and Schost 2007).

A matrix M(k)/k, M linear in k, advances the window of d = deg F neighbouring coefficients
(:mod:`jacobian.finite.hasse_witt`). The denominators have the product (p − 1)! = −1 (Wilson), so the start value is
negated and M(k) is used alone. For β = 2^m near √p the entries of P(x) = M(x + β − 1)·…·M(x + 1) are polynomials of
degree β − 1. Doubling gives their values at x = 0, β, 2β, …: P_2n(x) = P_n(x + n)·M(x + n)·P_n(x), P_n with n − 1
factors. Shifts give the values at x + n and at later points from the values at x. A shift by a, in units of β, is
a convolution with 1/(a + t), |t| < n (Bostan, Gaudry and Schost, theorem 5). No a + t vanishes modulo p. An integer a
is at least n. For a = n/β and n/β + n this follows from sβ/n ≠ ±1 modulo p for |s| ≤ 2n, n | β/2.
"""

from __future__ import annotations

from functools import cache
from math import log2
from typing import Any

import numpy as np

from jacobian.finite.product_kernels import BLOCK, kernels, room_for
from jacobian.numbers.convolution import LEAST, LONGEST, Convolutions, balanced
from jacobian.numbers.threads import in_ranges
from jacobian.progress import Progress

FIRST = LEAST // 2
"""The number of points whose values are computed factor by factor."""
MEMORY = 3 << 30
"""The approximate memory for the values of the products, in bytes."""


class Products:
    """The products of the matrices M(k) for one polynomial F over GF(p), p < 2^49, F(0) ≠ 0.

    ``ratios`` are f_i/f_0, i = 1 … d.

    ``part`` = (i, g) says that F is the i-th of g polynomials: the log shows the progress of all.
    """

    def __init__(self, p: int, ratios: list[int], part: tuple[int, int] = (0, 1), beta: int | None = None) -> None:
        self.p, self.d = p, len(ratios)
        self.beta = beta = step(p, self.d) if beta is None else beta
        self.convolutions = Convolutions(p, 2 * beta, kernels())
        self.P: Any = self.convolutions.P
        half = (p + 1) // 2
        rows = [[half * i * c for i, c in enumerate(ratios, 1)], ratios]
        self.c = np.array([[balanced(c, p) for c in row] for row in rows])
        self.factorials = np.empty(beta)
        kernels().inverse_factorials(self.P, self.factorials)
        work = transforms(p, beta) * self.d**2
        self.progress: Progress | None = Progress(f"Cartier–Manin matrix modulo {p}, β = {beta}", work, part)

    def last(self, start: int, count: int) -> list[int]:
        """The coefficients of x^(p−1), …, x^(p−count) in F^((p−1)/2); ``start`` is the coefficient of x^0."""
        p, beta = self.p, self.beta
        window = np.zeros(max(self.d, count))
        window[0] = balanced(-start, p)
        part, new = window[: self.d], np.empty(self.d)
        values, room = (np.empty((self.d**2, beta)) for _ in range(2))
        self._double(values, room)
        points = (p - 1) // beta
        kernels().chain(self.P, self.c, float(beta), 0, values, min(points, beta), part, new)
        for first in range(beta, points, beta):
            self._shift(values, [(first, room)])
            kernels().chain(self.P, self.c, float(beta), first, room, min(points - first, beta), part, new)
        kernels().walk(self.P, self.c, points * beta + 1, p, part)
        return [int(c) % p for c in window[:count]]

    def _double(self, values: Any, room: Any) -> None:
        """Writes the product P(x) of the module's docstring at x = 0, β, …, (β − 1)β into ``values``."""
        n = FIRST
        kernels().direct(self.P, self.c, float(self.beta), n - 1, values, n, room_for(self.d))
        while n < self.beta:
            a = n * pow(self.beta, -1, self.p) % self.p
            self._shift(values[:, :n], [(n, values[:, n:]), (a, room), (a + n, room[:, n:])])
            n *= 2

            def work(begin: int, end: int, n: int = n) -> None:
                span, beta, middle = (begin * BLOCK, end * BLOCK), float(self.beta), float(n // 2)
                kernels().join(self.P, self.c, beta, middle, room, values, span, room_for(self.d))

            in_ranges(n // BLOCK, max(64, n // BLOCK // 8), work)

    def _shift(self, values: Any, targets: list[tuple[int, Any]]) -> None:
        """Each row of ``values`` has the values of a polynomial at 0, β, …, (n − 1)β. For each (a, array) of
        ``targets`` the values of these polynomials at aβ, (a + 1)β, … are written to the first n columns of the array.
        """
        n, work = values.shape[1], self.convolutions
        weights = np.empty(n)
        kernels().lagrange(self.P, self.factorials, weights)
        prepared = []
        for a, array in targets:
            reciprocals, falling = np.empty(2 * n - 1), np.empty(n)
            kernels().inverses(self.P, balanced(a - n + 1, self.p), reciprocals)
            kernels().falling(self.P, balanced(a, self.p), reciprocals, falling)
            prepared.append((work.transform(reciprocals, 2 * n), falling, array))

        def entries(begin: int, end: int) -> None:
            weighted = np.empty(n)
            for e in range(begin, end):
                kernels().scaled(self.P, values[e], weights, weighted)
                transformed = work.transform(weighted, 2 * n)
                for kernel, falling, array in prepared:
                    work.product(transformed, kernel, n - 1, falling, array[e, :n])
                if self.progress:
                    self.progress.add((1 + len(prepared)) * n * log2(n))

        in_ranges(self.d**2, 1, entries)


@cache
def compiled() -> None:
    """Compiles all loops by running small products, so that compilation does not enter the estimate of the run time."""
    small = Products(8191, [1], beta=2 * FIRST)
    small.progress = None
    small.last(1, 1)


def step(p: int, d: int) -> int:
    """The β of the module's docstring: the power of 2 with the least work for which the values fit into memory."""
    largest = min(LONGEST // 2, MEMORY // (16 * d * d))
    sizes = (1 << m for m in range(FIRST.bit_length() - 1, largest.bit_length()))
    return min((beta for beta in sizes if 4 * beta < p), key=lambda beta: transforms(p, beta))


def transforms(p: int, beta: int) -> float:
    """The work for one entry of the matrices. A transform of length 2n counts n·log₂ n. Each doubling takes four
    transforms, and every β points beyond the first β take two.
    """
    levels = range(FIRST.bit_length() - 1, beta.bit_length() - 1)
    more = ((p - 1) // beta - 1) // beta
    return sum(4 * (1 << m) * m for m in levels) + 2 * more * beta * log2(beta)
