"""1/g around moving points, in compiled double-doubles, for a multiprecision clock that integrates 1/g panel by panel;
and the number of nodes that such a clock needs.

A moving point has all its digits, so 1/g near it loses only the digits of one addition. Double-doubles keep at least 28
digits, in a fortieth of the time of multiprecision. Some values are computed again with all digits; if one differs by
more than the clock's tolerance, double-doubles are no longer used.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import log10

import numpy as np

from integrable.moving_point.addition import Row, moving_point, opposite, rate_after
from integrable.moving_point.compiled import SPECIAL
from integrable.moving_point.legendre import legendre_transform
from integrable.moving_point.setup import Setup
from integrable.moving_point.translations import Translations
from jacobian.element import Real
from jacobian.native.kinds import WIDES
from jacobian.native.library import Library
from jacobian.numbers.abreast import abreast
from jacobian.numbers.long_reals import BareReals

# one value in this many, and at least two values, are computed again with all digits
ONE_IN = 25
# the numbers of nodes, for a basic step and for a long panel, of the rule that shows how fast Legendre coefficients
# decrease; coefficients below LEAST_SEEN are not used for this, since they may be rounding
SCOUT_NODES, LEAST_SEEN = (24, 80), 1e-12
SCOUT_BITS = 240
# a relative variation of 1/g is measured with many digits if it is below FLAT in floats or below FLATTEST in
# double-doubles, because rounding would hide it
FLAT, FLATTEST = 1e-6, 1e-16
SAMPLES = range(0, 512, 61)


def rates_after(f: Row, axes: Row, point: Row, steps: Row, out: Row) -> None:
    """Writes 1/g at a point moved by each translation of ``steps``, ten numbers each."""
    near = moving_point(point)
    for n in abreast(0, len(out)):
        out[n] = rate_after(f, axes, near, moving_point(steps, 10 * n))


LIBRARY = Library("panel_rates", {"rates_after": (rates_after, (WIDES,) * 5)}, SPECIAL)


class PanelRates:
    """1/g around the moving points of a setup; values are right to 10^−``digits``."""

    def __init__(self, setup: Setup, digits: float) -> None:
        self._setup, self._bound = setup, 10.0**-digits
        self._curve = self._packed([setup.bare.f])[0], self._packed([setup.bare.axes])[0]
        self._checked = 0

    def steps(self, steps: Sequence[Row]) -> np.ndarray:
        """Translations as :meth:`around` takes them, ten double-doubles each."""
        return self._packed(steps).reshape(-1, 2)

    def values(self, point: Row, packed: np.ndarray) -> np.ndarray:
        """1/g after each translation in ``packed``, which :meth:`steps` made, as double-doubles, shape (N, 2)."""
        rates = np.empty((len(packed) // 10, 2))
        LIBRARY.rates_after(*self._curve, self._packed([point])[0], packed, rates)
        return rates

    def around(self, point: Row, steps: Sequence[Row], packed: np.ndarray) -> np.ndarray | None:
        """The :meth:`values` for ``steps``, given also in packed form; None if double-doubles have too few digits."""
        rates = self.values(point, packed)
        return rates if self._right(point, steps, rates) else None

    def _right(self, point: Row, steps: Sequence[Row], rates: np.ndarray) -> bool:
        """Whether a sample of the values, which varies from panel to panel and includes the ends, agrees with values of
        all digits.
        """
        bare, count = self._setup.bare, len(steps)
        self._checked += 1
        places = {0, -1 % count, *(7 * self._checked + ONE_IN * k for k in range(1 + count // ONE_IN))}
        with self._setup.reals:
            for i in sorted({place % count for place in places}):
                truth = rate_after(bare.f, bare.axes, point, steps[i])
                if not abs(truth - float(rates[i, 0]) - float(rates[i, 1])) <= self._bound * abs(truth):
                    return False
        return True

    def _packed(self, rows: Sequence[Row]) -> np.ndarray:
        """Rows of bare reals as double-doubles, shape (rows, numbers, 2)."""
        with self._setup.reals:
            high = [[float(x) for x in row] for row in rows]
            low = [
                [float(x - h) for x, h in zip(row, floats, strict=True)] for row, floats in zip(rows, high, strict=True)
            ]
        return np.stack([high, low], axis=-1)


class Scouts:
    """How fast the Legendre coefficients of 1/g decrease along a motion: measured once, for clocks of any precision.

    Coefficients are computed in double-doubles if ``compiled``, else in floats; where 1/g is nearly constant, in many
    bits.
    """

    def __init__(self, setup: Setup, compiled: bool) -> None:
        self._setup = setup
        self._rates = PanelRates(setup, 0) if compiled else None
        self._found: dict[tuple[int, int], float] = {}
        self._rules: dict[int, tuple[list[Row], list[list[Real]]]] = {}

    def digits_a_node(self, sign: int, length: int) -> float:
        """The least number of digits gained per Legendre coefficient of 1/g on panels of ``length`` basic steps."""
        if (sign, length) not in self._found:
            self._found[sign, length] = self._fall(sign, length)
        return self._found[sign, length]

    def _fall(self, sign: int, length: int) -> float:
        sizes = self._sizes(sign, length, float)
        if max(sizes[1:]) < (FLATTEST if self._rates else FLAT):
            sizes = self._sizes(sign, length, self._setup.reals.plain)
        most = max(sizes[1:])
        if 0 < most < FLAT:
            sizes = [size / most for size in sizes]
        last = max((k for k in range(1, len(sizes)) if sizes[k] > LEAST_SEEN), default=1)
        return -log10(max(sizes[last], LEAST_SEEN)) / last

    def _sizes(self, sign: int, length: int, number: Callable[[Real], Real]) -> list[float]:
        """The largest Legendre coefficients over some panels, relative to the first, computed in ``number``."""
        setup = self._setup
        steps, rows = self._rule(length)
        if sign < 0:
            with setup.reals:
                steps = [opposite(step) for step in steps]
        sizes_at = self._transform(steps, rows, number)
        sizes = [0.0] * len(steps)
        for cell in SAMPLES:
            point = setup.reached(sign, cell)
            with setup.reals.at(SCOUT_BITS):
                found = sizes_at(point)
            sizes = [max(a, b / found[0]) for a, b in zip(sizes, found, strict=True)]
        return sizes

    def _rule(self, length: int) -> tuple[list[Row], list[list[Real]]]:
        """Translations to the nodes of a panel, and the matrix from values there to a Legendre series."""
        if length not in self._rules:
            problem, reals = self._setup.problem, BareReals(SCOUT_BITS)
            translations = Translations(reals, problem.f, problem.axes, problem.half_step)
            x, rows = legendre_transform(reals, SCOUT_NODES[length > 1])
            self._rules[length] = translations.at_nodes(x, length), rows
        return self._rules[length]

    def _transform(
        self, steps: list[Row], rows: list[list[Real]], number: Callable[[Real], Real]
    ) -> Callable[[Row], list[float]]:
        """A function that maps a moving point to the sizes of the Legendre coefficients of 1/g around it."""
        setup, rates = self._setup, self._rates
        if rates and number is float:
            packed, transform = rates.steps(steps), np.array(rows, dtype=float)

            def wide_sizes(point: Row) -> list[float]:
                high, low = rates.values(point, packed).T
                # the first value is subtracted, so that small coefficients keep their digits
                series = transform @ (high - high[0] + (low - low[0]))
                series[0] += high[0]
                return [abs(c) for c in series.tolist()]

            return wide_sizes
        nodes = [tuple(map(number, step)) for step in steps]
        matrix = [[number(c) for c in row] for row in rows]
        f, axes = (tuple(map(number, row)) for row in (setup.bare.f, setup.bare.axes))

        def sizes(point: Row) -> list[float]:
            values = [rate_after(f, axes, tuple(map(number, point)), step) for step in nodes]
            return [abs(float(sum(c * v for c, v in zip(row, values, strict=True)))) for row in matrix]

        return sizes
