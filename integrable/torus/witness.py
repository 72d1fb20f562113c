"""Times of the flow at which a torus is compared with other methods for the same states."""

from __future__ import annotations

import numpy as np

# turns of a phase at the checked times: more than one in either direction, after which all signs that the period
# changes have changed
TURNS = (1.23, -1.38)
# beyond this number of turns the faster phase loses its fraction
FAR = 2.0**48


def witnesses(rates: list[float]) -> np.ndarray:
    """Two times of the flow for each period, one in each direction, after which every sign that the period changes has
    changed.

    ``rates`` are turns of the phases per unit of τ.
    """
    # if the faster phase loses its fraction before a turn of the slower one, the signs of the latter do not matter
    farthest = FAR / max(map(abs, rates))
    return np.array([min(max(turns / nu, -farthest), farthest) for nu in rates for turns in TURNS])
