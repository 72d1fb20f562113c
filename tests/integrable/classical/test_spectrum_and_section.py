"""Spectra and Poincaré sections of every system: lines add up to the motion, crossings lie on it."""

from __future__ import annotations

import numpy as np
import pytest

from integrable.classical.garnier import Garnier
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.kuzmin_kutuzov import KuzminKutuzov
from integrable.classical.lagrange import LagrangeTop
from integrable.classical.spherical_pendulum import SphericalPendulum
from integrable.classical.veselova import Veselova
from integrable.mumford.motion import BITS_OF_TORUS
from integrable.portrait.spectrum import torus_states
from jacobian import MP, RR
from jacobian.errors import ArgumentError, NotRepresentable, PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.numbers.compiler import interpreted
from tests.integrable.classical.rows import REAL

PENDULUM, TOP = SphericalPendulum(), LagrangeTop(0.7)
VESELOVA = Veselova((2, 2.5, 3))
AXES = {
    "veselova": (VESELOVA, (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "pendulum": (PENDULUM, (0.48, 0.6, -0.64), (0.9036, -0.408, 0.2952)),
    "plane": (PENDULUM, (0.6, 0.0, -0.8), (0.0, 0.0, 0.0)),
    "over the top": (PENDULUM, (0.0, 0.0, -1.0), (2.5, 0.0, 0.0)),
    "conical": (PENDULUM, (0.6, 0.0, -0.8), (0.0, 0.6 * 0.8**-0.5, 0.0)),
    "top": (TOP, (0.48, 0.6, 0.64), (0.25, -0.375, 1.125)),
    "upright": (TOP, (0.0, 0.0, 1.0), (0.1, 0.0, 1.5)),
}
CASES = [
    ("neumann", 1), ("neumann", 2), ("ellipsoid", 1), ("ellipsoid", 2), ("garnier", 1), ("henon_heiles", 1),
    ("toda", 2), ("toda", 3), ("galaxy", 3), ("barriers", 2),
]  # fmt: skip


def flow_of(name, n=0):
    if name in AXES:
        system, q, p = AXES[name]
        return system.flow(system.state(q, p))
    system, state = REAL[name](RR, n)
    return system.flow(state)


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("name", "n"), [*CASES, *((name, 0) for name in AXES)])
def test_the_lines_add_up_to_the_motion(name, n) -> None:
    flow = flow_of(name, n)
    found = flow.spectrum()
    times = np.array([0, -3.7, 25.0, 1234.5])
    run, waves = flow.at(times), np.exp(2j * np.pi * times[:, None] * found.frequencies)
    # the centre of mass of a lattice moves uniformly
    drift = np.outer(times, [sum(flow.start.p) / n] * n) if name == "toda" else 0
    for lines, wanted in ((found.q, run.q - drift), (found.p, run.p)):
        assert abs((waves @ lines).real - wanted).max() < 1e-12 * (1 + abs(wanted).max())
    assert np.allclose(found.frequencies, found.modes @ flow.portrait.frequencies / 2, rtol=0, atol=1e-13)
    assert found.quantities == ("q", "p")


def next_to_a_separatrix(a, q, p):
    system = Garnier(a)
    return system.flow(system.state(q, p))


@pytest.mark.skipif(interpreted(), reason="the grid has more phases than interpreted loops reach in a minute")
def test_the_lines_add_up_to_the_motion_next_to_a_separatrix() -> None:
    """Newton's method for the angles of the points stalled: PrecisionLoss."""
    flow, times = next_to_a_separatrix((1, 4), (0.1, 0.3), (0.1, 0.2)), np.array([0, -3.7, 25.0, 123.4])
    found, run = flow.spectrum(), flow.at(times)
    waves = np.exp(2j * np.pi * times[:, None] * found.frequencies)
    assert abs((waves @ found.q).real - run.q).max() < 1e-12
    assert abs((waves @ found.p).real - run.p).max() < 1e-12


def test_states_at_phases_next_to_a_separatrix_are_those_of_the_motion() -> None:
    """Newton's method for the angles of the points stalled; the lines need a finer grid than a spectrum takes."""
    flow, times = next_to_a_separatrix((1, 2, 4), (0.1, 0.2, 0.3), (0.1, 0.0, 0.2)), np.linspace(-40, 60, 201)
    run = flow.at(times)
    with LongField(BITS_OF_TORUS) as N:
        torus = flow._separated(N)
        states = torus_states(torus, flow._ends(N), flow._reader_on(N, torus), torus.frequencies)
        found = states.read(np.outer(times, np.array(torus.frequencies, dtype=float)))
    assert abs(found["q"] - run.q).max() < 1e-12
    assert abs(found["p"] - run.p).max() < 1e-12
    if not interpreted():
        with pytest.raises(PrecisionLoss, match=r"spectrum: a grid of .* is needed"):
            flow.spectrum()


@pytest.mark.slow
def test_lines_of_three_frequencies() -> None:
    flow = flow_of("toda", 4)
    found, times = flow.spectrum(), np.array([0, 100.0])
    run, waves = flow.at(times), np.exp(2j * np.pi * times[:, None] * found.frequencies)
    assert found.modes.shape[1] == 3
    assert abs((waves @ found.p).real - run.p).max() < 2e-12


@pytest.mark.parametrize("count", [1, 300])
@pytest.mark.parametrize(
    ("name", "n", "oval", "end", "axis"),
    [
        ("neumann", 2, 0, "lower", 0),
        ("neumann", 2, 1, "upper", 2),
        ("neumann", 3, 2, "upper", 3),
        ("ellipsoid", 2, 1, "upper", 2),
        ("galaxy", 3, 0, "lower", 2),
        ("neumann", 1, 0, "lower", 0),
        ("veselova", 0, 1, "upper", 0),
        ("veselova", 0, 0, "lower", 2),
    ],
)
def test_a_section_is_where_a_coordinate_vanishes(name, n, oval, end, axis, count) -> None:
    flow = flow_of(name, n)
    section = flow.section(count, oval, end)
    assert len(section) == count
    assert abs(section.path.q[:, axis]).max() < 1e-12
    assert (np.diff(section.times) > 0).all()
    assert section.times[0] > 0
    steps = np.diff(section.theta, axis=0) - section.rotation
    assert abs((steps + 0.5) % 1 - 0.5).max(initial=0) < 1e-12
    if count > 1:
        # none is left out: between two crossings the coordinate keeps its sign
        between = flow.at((section.times[1:40] + section.times[:39]) / 2).q[:, axis]
        assert (between[1:] * between[:-1] < 0).all()


def test_what_is_refused() -> None:
    flow = flow_of("neumann", 2)
    for wrong in ({"count": 0}, {"count": 3, "oval": 2}, {"count": 3, "end": "left"}):
        with pytest.raises(ArgumentError, match=[*wrong][-1]):
            flow.section(**wrong)
    system, state = REAL["neumann"](MP(20), 2)
    with pytest.raises(NotRepresentable, match="spectrum"):
        system.flow(state).spectrum()
    with pytest.raises(NotRepresentable, match="section"):
        system.flow(state).section(3)


def test_a_spectrum_is_drawn() -> None:
    pytest.importorskip("matplotlib")
    figure = flow_of("galaxy", 3).spectrum().figure()
    assert [axes.get_ylabel() for axes in figure.axes] == ["amplitude of q", "amplitude of p"]


def test_a_motion_at_rest_has_no_lines() -> None:
    """It raised a ValueError of zip; a star at rest in the centre was divided by 0."""
    point, star = HenonHeiles.with_frequencies(1, 1.25), KuzminKutuzov((1.0, 0.5))
    assert len(point.flow(point.state((0.0, 0.0), (0.0, 0.0))).spectrum()) == 0
    rest = star.flow(star.state((0.0,) * 3, (0.0,) * 3)).spectrum()
    assert abs(rest.q).max(initial=0) < 1e-20
