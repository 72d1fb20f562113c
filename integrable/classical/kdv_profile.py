"""A KdV solution at many x and one time t: from the compiled torus in genus 1 and 2, from tables in genus 3 to 6.

At a fixed t, u(x, t) is a motion in x that starts from the pair at (0, t)
(:mod:`integrable.mumford.real_torus`, :mod:`integrable.mumford.tabled`).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from integrable.mumford.columns import Column, Columns
from integrable.mumford.elliptic_torus import EllipticTorus
from integrable.mumford.flow import RIGHT
from integrable.mumford.motion import Start
from integrable.mumford.real_torus import RealTorus
from integrable.mumford.tabled import TabledStates
from jacobian.errors import PrecisionLoss
from jacobian.relatives.extended import Extended


class Profile:
    """u in floats at many x, along the motion in x whose start ``place`` returns.

    ``read(N, D)`` returns ((u, span of the edges),) at a divisor, ``by_additions(x)`` the same in floats at one x.
    """

    def __init__(
        self,
        place: Callable[[Any], Start],
        read: Callable[[Any, Extended], Any],
        by_additions: Callable[[float], list[list[float]]],
        genus: int,
    ) -> None:
        self._genus = genus
        self._place, self._by_additions, self._read_one = place, by_additions, read

    def from_torus(self, xs: np.ndarray) -> np.ndarray | None:
        """u at xs in genus 1 and 2; None if there is no torus, or if it does not reach them."""
        torus = self._torus
        return None if torus is None or not torus.reaches(xs) else self._on(torus, xs)

    def from_tables(self, xs: np.ndarray) -> np.ndarray:
        """u at xs in genus 3 to 6."""
        found: np.ndarray = self._tabled.at(xs)[0][:, 0]
        return found

    @cached_property
    def _tabled(self) -> TabledStates:
        return TabledStates(self._place, self._read, self._by_additions)

    @cached_property
    def _torus(self) -> RealTorus | EllipticTorus | None:
        """The torus, if it exists and agrees with additions."""
        try:
            torus = EllipticTorus(self._place) if self._genus == 1 else RealTorus(self._place)
            found = self._on(torus, torus.witnesses)
            true = [self._by_additions(x)[0] for x in torus.witnesses.tolist()]
        except (PrecisionLoss, ZeroDivisionError):
            return None
        right = all(abs(x - u) <= RIGHT * span for x, (u, span) in zip(found.tolist(), true, strict=True))
        return torus if right else None

    def _read(self, xs: np.ndarray, D: Extended) -> list[list[Column]]:
        ((u, span),) = self._read_one(Columns(), D)
        return [[u, Column(np.full(len(xs), span.hi))]]

    def _on(self, torus: RealTorus | EllipticTorus, xs: np.ndarray) -> np.ndarray:
        ((u, _),) = self._read(xs, torus.at(xs))
        found: np.ndarray = u.hi
        return found
