"""Toda lattices that are their own mirror image: all pairs of the motion are at special positions of additions."""

from __future__ import annotations

import numpy as np
import pytest

from integrable.classical.toda import TodaLattice
from jacobian import MP
from jacobian.errors import PrecisionLoss

WAVE = tuple(float(x) for x in np.sin(2 * np.pi * np.arange(5) / 5))


def mirrored(q: np.ndarray) -> np.ndarray:
    """−q_{−i}."""
    return -np.roll(q[..., ::-1], 1, axis=-1)


@pytest.mark.parametrize("drift", [0.0, 0.25])
def test_a_standing_wave_at_any_time(drift) -> None:
    """Additions lost more than 4,000 bits at every time, and raised PrecisionLoss for fewer than six far times."""
    lattice = TodaLattice(5)
    # an exact mirror image
    q = (0.0, WAVE[1], WAVE[2], -WAVE[2], -WAVE[1])
    flow = lattice.flow(lattice.state(q, (drift,) * 5))
    with pytest.raises(PrecisionLoss, match="special position"):
        flow._by_additions(np.array([1e5]))
    found = flow.at([1e5, -2e5])
    assert found.way == "torus"
    rest = found.q - drift * found.times[:, None]
    assert abs(rest - mirrored(rest)).max() < (1e-10 if drift else 1e-15)
    # the same states among many, by the torus in floats, and in more digits
    many = flow.at([1e5, -2e5, *np.linspace(2e5, 3e5, 8)])
    assert abs(many.q[:2] - found.q).max() < 1e-15 * abs(found.q).max()
    fine = lattice.over(MP(25))
    exact = fine.flow(fine.state(q, (drift,) * 5)).at([1e5])
    assert exact.way == "torus"
    assert abs(exact.q[0].astype(float) - found.q[0]).max() < 1e-15 * abs(found.q).max()


def test_sums_over_ovals_are_series_near_the_start() -> None:
    lattice = TodaLattice(5)
    q = (0.0, WAVE[1], WAVE[2], -WAVE[2], -WAVE[1])
    flow = lattice.flow(lattice.state(q, (0.5,) * 5))
    times = np.array([40.0, -7.5])
    near, far = flow.at(times), flow._far(times)
    assert (near.way, far.way) == ("series", "torus")
    assert abs(far.states - np.stack([near.q, near.p], axis=1)).max() < 1e-14
