"""States of a motion in separated coordinates at any phases of its torus, in floats."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from integrable.portrait.separated import SeparatedTorus
from integrable.portrait.spectrum import Sampled
from jacobian.element import Real

Pair = tuple[Sequence[np.ndarray], Sequence[np.ndarray]]
"""q and p by their components, each an array."""

# number of samples of a turn about an axis: a state has only the harmonics 0 and ±1 of it
ROUND = 4


def torus_states(
    torus: SeparatedTorus, ends: Sequence[Real], read: Callable[..., Pair], frequencies: Sequence[Real]
) -> Sampled:
    """q and p at phases that are linear in t.

    ``ends`` are the branch points at which the state has signs. ``read(halves, turned)`` returns q and p, from
    (sin ½φ, cos ½φ) of each point and the angles about the axis since the start, all arrays. ``frequencies`` are those
    of the portrait.
    """
    genus, further = len(torus.ovals), len(frequencies) - len(torus.ovals)
    places = {torus.place_of(e) for e in ends}
    doubled = [2 if {o.place, o.place + 1} & places else 1 for o in torus.ovals]
    # the portrait may count turns in the opposite direction
    senses = [-1.0 if own * f < 0 else 1.0 for own, f in zip(torus.frequencies, frequencies, strict=True)]
    start, swings_at_start = (np.array(x, dtype=float) for x in (torus.phases, torus.swings_at_start))

    def values(turns: np.ndarray) -> dict[str, np.ndarray]:
        phases = start + turns[:, :genus]
        angles = torus.in_floats.at(phases)
        turned = 2 * np.pi * turns[:, genus:] + torus.swings(angles, phases) - swings_at_start
        q, p = read([(np.sin(phi / 2), np.cos(phi / 2)) for phi in angles.T], list(turned.T))
        return {"q": np.stack(q, axis=-1), "p": np.stack(p, axis=-1)}

    return Sampled(values, (*doubled, *(1,) * further), np.diag(senses), frequencies, (ROUND,) * further)
