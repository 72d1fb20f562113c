"""States of a motion in separated coordinates at any phases of its torus, in floats."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from integrable.portrait.separated import SeparatedTorus

# number of samples of a turn about an axis: a state has only the harmonics 0 and ±1 of it
ROUND = 4


class TorusStates:
    """q and p at phases that are linear in t: a :class:`integrable.portrait.spectrum.Sampled`.

    ``ends`` are the branch points at which the state has signs. ``read(halves, turned)`` returns q and p, from
    (sin ½φ, cos ½φ) of each point and the angles about the axis since the start, all arrays. ``frequencies`` are those
    of the portrait.
    """

    def __init__(
        self,
        torus: SeparatedTorus,
        ends: Sequence[Any],
        read: Callable[[list[tuple[Any, Any]], list[Any]], tuple[Any, Any]],
        frequencies: Sequence[float],
    ) -> None:
        self._torus, self._read = torus, read
        self.dimension = len(torus.ovals)
        places = [torus.place_of(e) for e in ends]
        self._doubled = [2 if {o.place, o.place + 1} & set(places) else 1 for o in torus.ovals]
        self._frequencies = np.array(frequencies)
        # the portrait may count turns in the opposite direction
        own = np.array([float(f) for f in torus.frequencies])
        self._senses = np.where(own * self._frequencies < 0, -1, 1)

    def samples(self, sizes: tuple[int, ...]) -> dict[str, np.ndarray]:
        """q and p on a grid of phases from those of the start."""
        torus, further = self._torus, len(self._frequencies) - self.dimension
        shape = (*sizes, *(ROUND,) * further)
        counts = [n * np.arange(size) / size for n, size in zip([*self._doubled, *[1] * further], shape, strict=True)]
        grid = np.stack(np.meshgrid(*counts, indexing="ij"), axis=-1).reshape(-1, len(shape))
        phases = grid[:, : self.dimension] + np.array([float(x) for x in torus.phases])
        angles = torus.in_floats.at(phases)
        swings = torus.swings(angles, phases) - torus.swings(
            *(np.array([x], dtype=float) for x in (torus.start, torus.phases))
        )
        turned = 2 * np.pi * grid[:, self.dimension :] + swings
        halves = [(np.sin(phi / 2), np.cos(phi / 2)) for phi in angles.T]
        q, p = self._read(halves, list(turned.T))
        return {name: np.stack(x, axis=-1).reshape(*shape, -1) for name, x in (("q", q), ("p", p))}

    def lines(self, counted: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Modes and frequencies; a turn about the axis counts as two, like two turns in an oval, after which signs
        return.
        """
        further = len(self._frequencies) - self.dimension
        modes = np.rint(2 * counted / [*self._doubled, *[1] * further] * self._senses).astype(int)
        return modes, modes @ self._frequencies / 2
