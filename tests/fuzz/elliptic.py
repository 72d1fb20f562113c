"""Any top at any time by elliptic functions: :mod:`integrable.oracles.elliptic_top`, which imports nothing of the
flow."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from tests.fuzz.closed_forms import Closed
from tests.fuzz.distributions import Motion

EPS = 2.0**-52
# decimal digits of SciPy's floats, and of the second computation after a mismatch
FLOATS, WIDE = 15, 30


class General(Closed):
    """With 40 ``digits`` or more, multiprecision; with fewer, SciPy's floats, and ``doubted()`` is the same motion in
    30 digits.
    """

    def __init__(self, start: Motion, digits: int = 40, sure: bool = False) -> None:
        super().__init__(start, max(digits, 60))
        self.sure = sure
        self._digits = digits if digits > 40 else WIDE if sure else FLOATS
        self._form = self._made([1] * 7)

    def _made(self, factors: Any) -> Any:
        from integrable.oracles.elliptic_top import EllipticTop

        c, k = self.context, [self.context.mpf(float(x)) for x in factors]
        # the same factor for equal moments keeps them equal
        body = SimpleNamespace(d=0, inertia=[c.mpf(x) * k[self.start.inertia.index(x)] for x in self.start.inertia])
        M = [m * x for m, x in zip(self.vectors[1], k[3:6], strict=True)]
        # in units of |M|, time in units of 1/|M|
        return EllipticTop(body, SimpleNamespace(gamma=self.vectors[0], M=M), self._digits)

    def doubted(self) -> General | None:
        return None if self.sure else General(self.start, sure=True)

    def wide_rows(self, times: Any) -> list[list[Any]]:
        found = self._form.at([self.context.mpf(t) * self.length for t in times])
        return [[*x, *m] for x, m in zip(found.gamma.tolist(), found.M.tolist(), strict=True)]

    def floor(self, times: Any) -> np.ndarray:
        """The largest effect of three random relative changes of all inputs by 2^-46, scaled to changes of 2^-52."""
        if self._digits > 40:
            return np.array([EPS * (4 + 4 * self.start.speed * abs(t)) for t in times])
        wild, worst = np.random.default_rng(0), np.zeros(len(times))
        base = self.rows(times)
        for _ in range(3):
            moved = self._made(1 + 2.0**-46 * wild.choice([-1, 1], 7)).at(
                [self.context.mpf(t) * self.length for t in times]
            )
            change = np.hstack([moved.gamma, moved.M]).astype(float) - base
            worst = np.maximum(worst, abs(change).max(axis=1))
        return worst / 64 + 4 * EPS
