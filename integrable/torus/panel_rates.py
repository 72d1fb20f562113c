"""Values of 1/g in compiled double-doubles, for a multiprecision clock that integrates 1/g panel by panel; and the
number of nodes that such a clock needs.

Each value takes one addition to a moving point that is known to all digits. So it keeps at least 28 digits, and takes a
fortieth of the time of multiprecision. Some values are computed again with all digits; if one differs by more than the
clock's tolerance, double-doubles are no longer used.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import log10

import numpy as np

from integrable.moving_point.addition import Row, moving_point, rate_after
from integrable.moving_point.compiled import SPECIAL
from integrable.moving_point.legendre import LegendreSeries
from integrable.moving_point.setup import Setup
from integrable.moving_point.translations import Translations
from jacobian.native.kinds import WIDES
from jacobian.native.library import Library
from jacobian.numbers.abreast import abreast
from jacobian.numbers.long_reals import BareReals

# one value in this many, and at least two values, are computed again with all digits
ONE_IN = 25
# the decrease of the Legendre coefficients of 1/g, up to the last one that exceeds LEAST_SEEN, is measured with as many
# nodes as SCOUT_NODES says: first for a basic step (Setup.step_length), then for a longer panel
SCOUT_NODES, LEAST_SEEN = (24, 80), 1e-12
SCOUT_BITS = 240
# if all coefficients except the mean of 1/g are below FLAT times the mean, their decrease is measured relative to the
# largest of them
FLAT = 1e-6
SAMPLES = range(0, 512, 61)


def rates_after(f: Row, axes: Row, point: Row, steps: Row, out: Row) -> None:
    """Writes to ``out`` 1/g at the point moved by each of the translations in ``steps``, which are ten numbers each."""
    near = moving_point(point)
    for n in abreast(0, len(out)):
        out[n] = rate_after(f, axes, near, moving_point(steps, 10 * n))


LIBRARY = Library("panel_rates", {"rates_after": (rates_after, (WIDES,) * 5)}, SPECIAL)


class PanelRates:
    """1/g around the moving points of a setup; the relative error of its values is at most 10^−``digits``."""

    def __init__(self, setup: Setup, digits: float) -> None:
        self._setup, self._bound = setup, 10.0**-digits
        self._curve = self._packed([setup.bare.f])[0], self._packed([setup.bare.axes])[0]
        self._checked = 0

    def steps(self, steps: Sequence[Row]) -> np.ndarray:
        """Translations as :meth:`around` takes them, ten double-doubles each."""
        return self._packed(steps).reshape(-1, 2)

    def around(self, point: Row, steps: Sequence[Row], packed: np.ndarray) -> np.ndarray | None:
        """1/g after each of ``steps``, as double-doubles of shape (N, 2); None if double-doubles have too few digits.
        ``packed`` is the result of :meth:`steps`.
        """
        rates = np.empty((len(steps), 2))
        LIBRARY.rates_after(*self._curve, self._packed([point])[0], packed, rates)
        return rates if self._right(point, steps, rates) else None

    def _right(self, point: Row, steps: Sequence[Row], rates: np.ndarray) -> bool:
        """Whether a sample of the values agrees with multiprecision. The sample contains the first and the last value,
        and others that vary from panel to panel.
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
        exact = np.array(rows, dtype=object)
        high = exact.astype(float)
        with self._setup.reals:
            low = (exact - high).astype(float)
        return np.stack([high, low], axis=-1)


class Scouts:
    """How fast the Legendre coefficients of 1/g decrease along a motion: measured once, for clocks of any precision."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        self._found: dict[tuple[int, int], float] = {}
        self._rules: dict[int, tuple[LegendreSeries, list[Row]]] = {}

    def digits_a_node(self, sign: int, length: int) -> float:
        """The number of decimal digits per degree by which the Legendre coefficients of 1/g decrease, on the worst of
        some panels of ``length`` steps (Setup.step_length); ``sign`` is the direction of time.
        """
        if (sign, length) not in self._found:
            sizes = self._sizes(sign, length)
            most = max(sizes[1:])
            if 0 < most < FLAT:
                sizes = [size / most for size in sizes]
            last = max((k for k in range(1, len(sizes)) if sizes[k] > LEAST_SEEN), default=1)
            self._found[sign, length] = -log10(max(sizes[last], LEAST_SEEN)) / last
        return self._found[sign, length]

    def _sizes(self, sign: int, length: int) -> list[float]:
        """The largest size of each Legendre coefficient over some panels, relative to the coefficient of degree 0."""
        setup, (series, steps) = self._setup, self._rule(length)
        bare, sizes = setup.bare, [0.0] * len(steps)
        for cell in SAMPLES:
            point = setup.reached(sign, cell)
            with setup.reals.at(SCOUT_BITS):
                values = [rate_after(bare.f, bare.axes, point, step) for step in steps[::sign]]
                found = [abs(float(c)) for c in series.coefficients(values)]
            sizes = [max(a, b / found[0]) for a, b in zip(sizes, found, strict=True)]
        return sizes

    def _rule(self, length: int) -> tuple[LegendreSeries, list[Row]]:
        """The Legendre series on a panel of ``length`` steps (Setup.step_length), and the translations to its nodes."""
        if length not in self._rules:
            problem, reals = self._setup.problem, BareReals(SCOUT_BITS)
            translations = Translations(reals, problem.f, problem.axes, problem.half_step)
            series = LegendreSeries(reals, SCOUT_NODES[length > 1])
            self._rules[length] = series, translations.at_nodes(series.nodes, length)
        return self._rules[length]
