"""Translations by about 2^k basic steps. The number of additions to reach a time is then about log2 of its steps."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from integrable.moving_point.addition import opposite, shift, trust_of
from integrable.moving_point.translations import Translations

# the best conditioned translation is chosen among this many neighbours on either side of a doubled step count
SEARCH = 6


class StepTable:
    """The translations by 1, about 2, about 4, … basic steps, in bare reals, computed on request."""

    def __init__(self, translations: Translations) -> None:
        self._translations = translations
        self._counts = [1]

    def beyond(self, steps: int) -> tuple[list[int], list[tuple[Any, ...]]]:
        """(counts, translations by that many basic steps), ascending from 1 to beyond ``steps``."""
        while self._counts[-1] <= steps:
            self._add_level()
        return self._counts, self._levels

    @cached_property
    def _levels(self) -> list[tuple[Any, ...]]:
        with self._translations.reals:
            return [self._translations.near(2 * self._translations.half_step)]

    @cached_property
    def _multiples(self) -> list[tuple[Any, ...]]:
        """The translations by 1, 2, … basic steps."""
        return self._levels[:1]

    def _add_level(self) -> None:
        """Appends a translation by about twice the last count: the best conditioned one of the neighbours of the
        double.
        """
        double = self._translations.sum(self._levels[-1], self._levels[-1])
        rough = {m: self._near_sum(double, m) for m in range(-min(SEARCH, self._counts[-1] - 1), SEARCH + 1)}
        best = max(rough, key=lambda m: trust_of(rough[m]))
        exact = double if best == 0 else self._translations.sum(double, self._multiple(best))
        self._counts.append(2 * self._counts[-1] + best)
        self._levels.append(exact)

    def _near_sum(self, step: tuple[Any, ...], m: int) -> tuple[Any, ...]:
        """An approximation in floats of a translation plus m basic steps."""
        if m == 0:
            return tuple(map(float, step))
        problem = self._translations.f, self._translations.axes
        return shift(*(tuple(map(float, row)) for row in (*problem, step, self._multiple(m))))

    def _multiple(self, m: int) -> tuple[Any, ...]:
        """The translation by m basic steps, |m| ≤ SEARCH."""
        while len(self._multiples) < abs(m):
            self._multiples.append(self._translations.sum(self._multiples[-1], self._multiples[0]))
        step = self._multiples[abs(m) - 1]
        with self._translations.reals:
            return step if m > 0 else opposite(step)
