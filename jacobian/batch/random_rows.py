"""Uniform random classes by the million: sums of random points.

Let P₁ … P_k be independent uniform affine points of a curve of genus g over GF(q), which has N such points and m
rational points at infinity. For every character χ ≠ 1 of the Jacobian, the sum over the affine points satisfies |Σ
χ(P)| ≤ (2g − 2)√q + m. Indeed, the sum over all rational points, also at infinity, is the linear coefficient of the
L-function of χ, a polynomial of degree 2g − 2 whose roots are of size 1/√q (Weil 1948).

Consequently the mean of χ(P₁ + … + P_k) has size at most ε^k, ε = ((2g − 2)√q + m)/N. By Cauchy and Parseval the sum is
within ½·√#J·ε^k of the uniform distribution, in total variation (Farashahi, Fouque, Shparlinski, Tibouchi and Voloch
2013, theorem 7). The number k of points is chosen to make this distance less than 2^-50: four at q = 2^61 in genus 2,
six in genus 3. Where ε is too large, as for q < 9 in genus 2, classes are drawn one by one
(:mod:`jacobian.law.sampling`).
"""

from __future__ import annotations

from math import log2
from typing import Any

import numpy as np

from jacobian.batch import libraries
from jacobian.batch.block_loops import BLOCK
from jacobian.batch.random_loops import CHAINS, Differences, Powers
from jacobian.batch.stored_rows import Rows, StoredRows
from jacobian.curve.points import AffinePoint
from jacobian.fields.randomness import random_below
from jacobian.fields.table import TableField
from jacobian.native.library import Packed
from jacobian.native.words import CONTEXTS
from jacobian.numbers.threads import in_ranges

LISTED = 1 << 12
"""All points are listed over fields with at most this many elements, and over fields with tables."""
CHUNK = 1 << 13
"""The number of classes drawn from one stream of random numbers; at most MOST of :mod:`jacobian.batch.stored_rows`."""
MOST_SETS = 64
"""The largest number of sets of g points that are added for one class."""
DISTANCE = 50
"""− log₂ of the allowed distance from the uniform distribution."""


class RandomRows:
    """Draws rows of random classes. ``possible`` says whether the curve has enough points and a loop can draw them."""

    def __init__(self, run: StoredRows) -> None:
        self.run, self.curve = run, run.equation.curve
        K, g = run.field, run.genus
        self.listed: Any = None
        count = K.order - 1 - 2 * g * K.order**0.5
        self._loops = libraries.points(run.kind)
        self._context = Packed(run.words, CONTEXTS[run.kind])
        if run.compiled and (K.order <= LISTED or isinstance(K, TableField)):
            points = [[run.words.to_word(c) for c in P] for P in self.curve.points() if isinstance(P, AffinePoint)]
            self.listed, count = np.array(points, np.int64).reshape(-1, 2).T, len(points)
        elif K.characteristic > 2:
            self.roots = _root_constants(K, run.words.to_word)
            self.f = run.numbers_in_words(self.curve.f)
        bias = ((2 * g - 2) * K.order**0.5 + len(self.curve.points_at_infinity())) / max(count, 1)
        # an upper bound of log₂(½·√#J·2^DISTANCE), from #J ≤ (1 + √q)^2g
        needed = g * log2(1 + K.order**0.5) - 1 + DISTANCE
        self.sets = int(-(-needed // (-g * log2(bias)))) if bias < 1 else MOST_SETS + 1
        self.possible = self.sets <= MOST_SETS and (self.listed is not None or K.characteristic > 2)

    def rows(self, rng: Any, count: int) -> Any:
        """``count`` rows of random classes, drawn on all threads. They do not depend on the number of threads."""
        seeds = np.random.SeedSequence(random_below(rng, 1 << 128)).spawn(-(-count // CHUNK))

        def work(begin: int, end: int) -> Any:
            sizes = [min(CHUNK, count - i * CHUNK) for i in range(begin, end)]
            parts = zip(seeds[begin:end], sizes, strict=True)
            return self.run.join([self._chunk(np.random.default_rng(seed), size) for seed, size in parts])

        return self.run.join([self.run.empty(0), *in_ranges(len(seeds), 1, work)])

    def _chunk(self, draw: np.random.Generator, count: int) -> Any:
        total = self._set(draw, count)
        for _ in range(self.sets - 1):
            total = self.run.add_here(total, self._set(draw, count))
        return total

    def _set(self, draw: np.random.Generator, count: int) -> Any:
        """``count`` rows, each the class of a sum P₁ + … + P_g of g random points."""
        run, g = self.run, self.run.genus
        points = self._points(draw, g * count)
        x, y = points.reshape(2, g, count, *points.shape[2:])
        words, double = run.memory(2 * g, count), np.zeros(count, np.uint8)
        self._loops.through_points(
            self._context, (x, y), words, double, Differences(run.memory(BLOCK), run.memory(BLOCK))
        )
        weight = np.zeros(count if run.split else 0, np.uint8)
        found = run.stored(Rows(run.of_memory(words), np.full(count, g, np.uint8), weight))
        if len(chosen := np.flatnonzero(double)):
            coordinates = np.ascontiguousarray(np.concatenate([x[:, chosen], y[:, chosen]]))
            columns = run.decoded(run.of_memory(coordinates)).T.tolist()
            J = self.curve.jacobian()
            divisors = [J.from_points(list(zip(column[:g], column[g:], strict=True))) for column in columns]
            run.put(found, chosen, run.of_triples([(D.u, D.v, D.n) for D in divisors]))
        return found

    def _points(self, draw: np.random.Generator, count: int) -> Any:
        """The coordinates x and y of uniform affine points, (2, count): a uniform x, and one ordinate over it."""
        if self.listed is not None:
            return np.ascontiguousarray(self.listed[:, draw.integers(self.listed.shape[1], size=count)])
        parts, missing = [], count
        room = Powers(self.run.memory(CHAINS), self.run.memory(CHAINS), self.run.memory(8, CHAINS))
        while missing > 0:
            tries = 2 * missing + missing // 8 + 64
            x = self.run.uniform(draw, tries)
            y, exists = np.empty_like(x), np.empty(len(x), np.uint8)
            second = draw.integers(2, size=len(x), dtype=np.uint8)
            self._loops.lift(self._context, self.f, self.roots, x, y, second, exists, room)
            found = exists == 1
            parts.append(np.stack([x[found], y[found]]))
            missing -= parts[-1].shape[1]
        return np.ascontiguousarray(np.concatenate(parts, axis=1)[:, :count])


def sampler(run: StoredRows) -> RandomRows:
    """The RandomRows that draws rows of ``run``, cached on ``run``."""
    if run.sampler is None:
        run.sampler = RandomRows(run)
    return run.sampler


def _root_constants(K: Any, to_word: Any) -> tuple[Any, int, int]:
    """The constants of Tonelli and Shanks' square root for p − 1 = m·2^twos, m odd: the windows of (m − 1)/2, the word
    of an element of order 2^twos, and twos.
    """
    p = K.p
    twos = ((p - 1) & (1 - p)).bit_length() - 1
    return windows((p - 1) >> (twos + 1)), to_word(K.sylow_generator), twos


def windows(exponent: int) -> Any:
    """Digits d_i with exponent = Σ d_i·2^i, one for each bit, the highest first. A digit is 0, or odd and below 16."""
    digits = [0] * exponent.bit_length()
    i = 0
    while i < len(digits):
        if exponent >> i & 1:
            digits[i] = exponent >> i & 15
            i += 3
        i += 1
    return np.array(digits[::-1], np.int64)
