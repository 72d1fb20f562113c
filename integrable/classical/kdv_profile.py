"""A KdV solution at many x and one time t, from the torus.

At a fixed t, u(x, t) is a motion in x that starts from the pair at (0, t)
(:mod:`integrable.mumford.real_torus`, :mod:`integrable.mumford.phase_torus`).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from integrable.mumford.columns import Column, Columns
from integrable.mumford.elliptic_torus import EllipticTorus
from integrable.mumford.flow import BITS_OF_TORUS, RIGHT
from integrable.mumford.motion import Start
from integrable.mumford.phase_torus import PhaseTorus
from integrable.mumford.real_torus import RealTorus
from integrable.portrait.point_ovals import Form, Separation
from integrable.portrait.separated import SeparatedTorus
from jacobian.errors import NotRepresentable, PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.relatives.extended import Extended


class Profile:
    """u in floats at many x, along the motion in x whose start ``place`` returns.

    ``read(N, D)`` returns ((u, span of the edges),) at a divisor; ``by_additions(x)`` returns it at one x, in floats.
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

    def at(self, xs: np.ndarray) -> np.ndarray | None:
        """u at xs; None if there is no torus, or if it does not reach them."""
        torus = self._torus
        return None if torus is None or not torus.reaches(xs) else self._on(torus, xs)

    @cached_property
    def _torus(self) -> RealTorus | EllipticTorus | PhaseTorus | None:
        """The torus, if it exists and agrees with additions."""
        try:
            torus = self._made()
            found = self._on(torus, torus.witnesses)
            true = [self._by_additions(x)[0] for x in torus.witnesses.tolist()]
        except (NotRepresentable, PrecisionLoss, ZeroDivisionError):
            return None
        right = all(abs(x - u) <= RIGHT * span for x, (u, span) in zip(found.tolist(), true, strict=True))
        return torus if right else None

    def _made(self) -> RealTorus | EllipticTorus | PhaseTorus:
        if self._genus <= 2:
            return EllipticTorus(self._place) if self._genus == 1 else RealTorus(self._place)
        with LongField(BITS_OF_TORUS) as N:
            start = self._place(N)
            forms = [Form((*[N.zero] * j, N.one)) for j in range(self._genus)]
            torus = SeparatedTorus(N, (start.f, start.u, start.v), Separation(forms, start.direction))
            return PhaseTorus(torus, lambda halves, _: Extended(*torus.pair_at(Columns(), halves, ())[:2], ()))

    def _read(self, xs: np.ndarray, D: Extended) -> list[list[Column]]:
        ((u, span),) = self._read_one(Columns(), D)
        return [[u, Column(np.full(len(xs), span.hi))]]

    def _on(self, torus: RealTorus | EllipticTorus | PhaseTorus, xs: np.ndarray) -> np.ndarray:
        ((u, _),) = self._read(xs, torus.at(xs))
        found: np.ndarray = u.hi
        return found
