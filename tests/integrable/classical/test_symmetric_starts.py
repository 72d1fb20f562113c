"""Starts with a symmetry: mirror-symmetric Toda lattices, and motions in coordinate planes."""

from __future__ import annotations

import numpy as np
import pytest

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from jacobian import MP
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField

WAVE = tuple(float(x) for x in np.sin(2 * np.pi * np.arange(5) / 5))


def mirrored(q: np.ndarray) -> np.ndarray:
    """−q_{−i}."""
    return -np.roll(q[..., ::-1], 1, axis=-1)


@pytest.mark.slow
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


@pytest.mark.parametrize(
    ("system", "q", "p", "axes"),
    [
        (Neumann((1, 2, 3, 4, 5, 6)), (0, 0, 0, 0, 0, 1), (1e-8, 0, 0, 0, 0, 0), (0, 5)),
        (Neumann((1, 2, 4)), (0.6, 0, 0.8), (0.4, 0, -0.3), (0, 2)),
        (Neumann((1, 2, 3, 5)), (0.6, 0, 0.8, 0), (0.4, 0.25, -0.3, 0), (0, 1, 2)),
        (Ellipsoid((1, 2, 3, 4)), (0, 0, 0, 2), (1, 1e-9, 0, 0), (0, 1, 3)),
        (Garnier((0, 1, 2, 3)), (0, 0.5, 0, 0), (0.25, 0, 0, 0), (0, 1)),
    ],
)
def test_a_motion_in_a_coordinate_plane_is_that_of_a_system_with_fewer_axes(system, q, p, axes) -> None:
    """Points of the pair stay at double points of the curve: at far times additions lost all digits or took seconds."""
    flow, times = system.flow(system.state(q, p)), [5.0, 1e6, -3e5]
    found = flow.at(times)
    arguments = system.arguments | {"a": [system.constants[i] for i in axes]}
    alone = type(system)(**arguments)
    fewer = alone.flow(alone.state([q[i] for i in axes], [p[i] for i in axes])).at(times)
    assert abs(found.q[:, axes] - fewer.q).max() < 1e-15 * abs(fewer.q).max()
    assert abs(found.p[:, axes] - fewer.p).max() < 1e-15 * abs(fewer.p).max()
    rest = [i for i in range(system.size) if i not in axes]
    assert not found.q[:, rest].any()
    assert not found.p[:, rest].any()
    # the equations of motion of the whole system, by series
    walked = flow._walked(np.array([5.0]))
    assert abs(walked.states[0, 0] - found.q[0]).max() < 1e-14 * abs(found.q).max()


def test_a_point_at_rest_moves_on_no_axis() -> None:
    system = Neumann((1, 2, 4))
    found = system.flow(system.state((0, 0, 1), (0, 0, 0))).at([1e6])
    assert found.q.tolist() == [[0, 0, 1]]
    assert not found.p.any()


def test_near_and_far_times_name_each_way_once() -> None:
    system = Neumann((1, 2, 4))
    path = system.flow(system.state((0.6, 0, 0.8), (0.4, 0, -0.3))).at([0.5, -5e5])
    assert path.way == "series, torus"


def test_numbers_beyond_floats_are_refused_as_before() -> None:
    lattice = TodaLattice(4, field=MP(30))
    with pytest.raises(PrecisionLoss, match="additions lose"):
        lattice.flow(lattice.state((1, -1, 1, -1), ("1e400", "-1e400", "1e400", "-1e400"))).at(["1e-380"])


def test_a_lattice_and_its_mirror_image_have_a_double_branch_point_at_zero() -> None:
    """At x = 0 every coefficient but one vanishes, and rounding there is that of the other coefficients."""
    q = 0.1 * np.arange(6) - 0.02 * np.arange(6) ** 2
    q = (*q, 0.0, *-q[:0:-1])
    lattice = TodaLattice(12)
    flow = lattice.flow(lattice.state(q, [0.0] * 12))
    for bits in (124, 160, 400):
        with LongField(bits) as N:
            ovals = flow._separated(N).ovals
            assert len(ovals) == 11
            assert (ovals[5].radius, abs(ovals[5].middle) < 2.0 ** (10 - bits)) == (0, True)
            assert min(oval.radius for oval in ovals[:5]) > 1e-4
