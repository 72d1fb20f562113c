"""A motion on two curves with one wrong sign, period or phase is refused instead of computed."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from typing import Any

import numpy as np
import pytest

from integrable import Check, Hat, Tilde
from integrable.deformations.pole_flow import CubicCarrier
from integrable.deformations.separated_flow import OvalCarrier
from jacobian.errors import PrecisionLoss

START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
SYSTEMS = {
    "tilde": Tilde((1, 2, 4)),
    "tilde, d": Tilde((3, 1, 2), 0.7),
    "check": Check((2, 3, 1)),
    "hat": Hat((3, 2, 1)),
    "poles": Tilde((1, 2, 4), potential=(0, 0, 0.1, 0.2, 0.3)),
}
PAIRS = [name for name in SYSTEMS if name != "poles"]
Change = Callable[[Any], None]


def refused(name: str, monkeypatch: pytest.MonkeyPatch, change: Change) -> None:
    """The far state is computed, but not with ``change`` applied to the curves of every precision."""
    carrier = CubicCarrier if name == "poles" else OvalCarrier
    right, system = carrier.__init__, SYSTEMS[name]
    state = system.state(*START)
    assert np.isfinite(system.flow(state).at([1e4]).gamma).all()

    def wrong(self: Any, system: Any, state: Any) -> None:
        right(self, system, state)
        change(self)
        self.shown = self.moved((self.field.zero, self.field.zero))

    monkeypatch.setattr(carrier, "__init__", wrong)
    with pytest.raises(PrecisionLoss, match="does not follow from its two points"):
        system.flow(state).at([1e4])


def of_curve(k: int, change: Change) -> Change:
    def of_carrier(carrier: Any) -> None:
        carrier.curves = [*map(copy, carrier.curves)]
        change(carrier.curves[k])

    return of_carrier


def of_frame(name: str, i: int | None) -> Change:
    def of_carrier(carrier: Any) -> None:
        found = getattr(carrier.frame, name)
        wrong = -found if i is None else tuple(-x if j == i else x for j, x in enumerate(found))
        carrier.frame = carrier.frame._replace(**{name: wrong})

    return of_carrier


def opposite(name: str) -> Change:
    def change(made: Any) -> None:
        setattr(made, name, -getattr(made, name))

    return change


def root(i: int) -> Change:
    def change(curve: Any) -> None:
        curve.factors = tuple(-x if j == i else x for j, x in enumerate(curve.factors))

    return change


def longer(curve: Any) -> None:
    curve.period *= 1 + 1e-9


@pytest.mark.parametrize("name", SYSTEMS)
def test_time_that_runs_back_is_noticed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    refused(name, monkeypatch, opposite("speed"))


@pytest.mark.thinned(3)
@pytest.mark.parametrize("k", [0, 1])
@pytest.mark.parametrize(
    "change",
    [opposite("period"), opposite("phase"), longer, root(0), root(1), root(2)],
    ids=["direction", "phase", "period", "R1", "R2", "R3"],
)
@pytest.mark.parametrize("name", SYSTEMS)
def test_a_wrong_curve_is_noticed(name: str, change: Change, k: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The direction in which one point moves, its phase at the start, its period, and the signs of R₁, R₂ and R₃."""
    refused(name, monkeypatch, of_curve(k, change))


@pytest.mark.thinned(3)
@pytest.mark.parametrize(
    ("name", "which", "i"),
    [
        *((name, which, i) for name in PAIRS for which in ("weights", "leans") for i in range(3)),
        *((name, "side", None) for name in PAIRS),
        *(("poles", "signs", i) for i in range(3)),
    ],
)
def test_a_wrong_sign_of_an_axis_is_noticed(
    name: str, which: str, i: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    refused(name, monkeypatch, of_frame(which, i))
