"""The torus of the ball and the top by theta functions: its checks, its set-up in more digits and its limits."""

from __future__ import annotations

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.motion.precise import PreciseFlow
from integrable.torus import access
from integrable.torus.access import BodyTorus
from integrable.torus.lattice import beginning
from integrable.torus.loops import CompiledLoops, ReadableLoops, shortest
from integrable.torus.states import velocity
from integrable.torus.theta_setup import ALONG, FREQUENCIES, IMAGINARY, start_frame
from jacobian import PrecisionLoss
from tests.integrable.ways import torus_of

GAMMA, UPRIGHT, LEANING = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), (1.104, 2.18, -0.528)
MOST = 1 << 16
BODIES = {
    "ball": ChaplyginBall((1, 2, 3), 0.7),
    "ζ above the middle": ChaplyginBall((3, 1, 2), 0.7),
    "top": EulerTop((1, 2, 3)),
    "light": ChaplyginBall((2, 1, 3), 1e-9),
    "heavy": ChaplyginBall((1, 2, 3), 1e6),
    "thin": ChaplyginBall((1e-6, 1, 1.5), 1),
}


def setup_of(name: str, tilted: bool = False):
    body = BODIES[name]
    return body.flow(body.state(GAMMA, LEANING if tilted else UPRIGHT, tilted=tilted)).setup


class Wrong(CompiledLoops):
    """Loops whose survey of periods is changed."""

    def __init__(self, change) -> None:
        super().__init__()
        right = self.periods

        def periods(motion, near, room, found):
            basis = right(motion, near, room, found)
            return change(found, basis) or basis

        self.periods = periods


def times(place, factor):
    def change(found, basis):
        found[place] *= factor

    return change


def exchanged(found, basis):
    found[FREQUENCIES], found[FREQUENCIES + 1] = found[FREQUENCIES + 1].copy(), found[FREQUENCIES].copy()


CHANGES = {
    "the first frequency": times(FREQUENCIES, 1 + 1e-10),
    "the second frequency": times(FREQUENCIES + 1, 1 + 1e-10),
    "the sign of time": times(slice(FREQUENCIES, FREQUENCIES + 2), -1),
    "frequencies exchanged": exchanged,
    "Y₁₁": times(IMAGINARY, 1 + 1e-10),
    "Y₁₂": times(IMAGINARY + 1, 1 + 1e-10),
    "the sign of Y₁₂": times(IMAGINARY + 1, -1),
    "Y₂₂": times(IMAGINARY + 2, 1 + 1e-10),
    "the direction of the derivative": times(ALONG, 1 + 1e-10),
    "the sign of the derivative": times(slice(ALONG, ALONG + 2), -1),
    "the basis": lambda found, basis: (basis[2], basis[3], basis[0], basis[1]),
    "the second period": lambda found, basis: (basis[0], basis[1], basis[2] + basis[0], basis[3] + basis[1]),
}


@pytest.mark.thinned(3)
@pytest.mark.parametrize("tilted", [False, True])
@pytest.mark.parametrize("name", ["ball", "ζ above the middle"])
@pytest.mark.parametrize("change", CHANGES)
def test_a_wrong_torus_is_noticed(change, name, tilted) -> None:
    setup = setup_of(name, tilted)
    BodyTorus(setup, CompiledLoops())
    with pytest.raises(PrecisionLoss):
        BodyTorus(setup, Wrong(CHANGES[change]))


@pytest.mark.parametrize("name", ["ball", "top"])
@pytest.mark.parametrize("place", [(i, k) for i in range(3) for k in range(4)])
def test_a_wrong_characteristic_is_noticed(monkeypatch, name, place) -> None:
    """δ of an axis may be wrong in a component where ε is 0 for all axes: only then is its theta function the same."""
    right = access.characteristics

    def wrong(points, basis):
        found = [list(char) for char in right(points, basis)]
        found[place[0]][place[1]] = 1 - found[place[0]][place[1]]
        return [tuple(char) for char in found]

    setup = setup_of(name)
    monkeypatch.setattr(access, "characteristics", wrong)
    with pytest.raises(PrecisionLoss):
        BodyTorus(setup, CompiledLoops())


def test_a_flow_without_a_torus_to_trust_goes_the_next_way(monkeypatch) -> None:
    ball, when = BODIES["ball"], [200.0, -300.0]
    state = ball.state(GAMMA, UPRIGHT)
    exact = ball.flow(state, kernel="compiled").at(when)
    monkeypatch.setattr(access, "characteristics", lambda points, basis: [(1, 0, 1, 0)] * 3)
    flow = ball.flow(state, kernel="compiled")
    assert torus_of(flow) is None
    assert np.abs(flow.at(when).gamma - exact.gamma).max() < 1e-14


@pytest.mark.parametrize("tilted", [False, True])
@pytest.mark.parametrize("name", BODIES)
def test_the_start_is_met_in_double_doubles_and_in_more_digits(name, tilted) -> None:
    setup = setup_of(name, tilted)
    quick, exact = BodyTorus(setup, CompiledLoops()), BodyTorus(setup, ReadableLoops(setup))
    assert quick.closure < 1e-26
    assert exact.closure < 1e-30
    assert quick.basis == exact.basis
    phases = np.random.default_rng(4).uniform(-20, 20, (6, 2))
    first, second = quick.at_phases(phases), exact.at_phases(phases)
    size = np.abs(first).max(axis=0)
    assert (np.abs(first - second) <= 2e-15 * size).all()


def test_periods_of_very_unequal_moments_have_enough_digits() -> None:
    """Two moments of 5e-5 and one of 1e4 beside d = 2e4: periods in double-doubles had too few digits."""
    ball = ChaplyginBall((4.5405279319304756e-05, 4.6598070318943e-05, 13944.008497696977), 22781.7606139772)
    flow = ball.flow(ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488)))
    true = PreciseFlow(ball, flow.state, 30)
    tau = np.array([1e9, -1e6, 3.0]) / 1e3
    rows = np.array([[*map(float, gamma)] for gamma, _ in true.vectors(true.at_tau(tau.tolist()))])
    torus = torus_of(flow)
    assert torus.compiled
    assert torus.closure < 1e-28
    assert np.abs(torus.at_tau(tau)[:, :3] - rows).max() < 1e-15


@pytest.mark.parametrize("name", BODIES)
def test_velocities_are_those_of_the_body(name) -> None:
    """dτ of the torus is its time over 2·max a·|M|, dt/dτ = √Σr_iγ_i² of the upright body."""
    body, setup = BODIES[name], setup_of(name)
    loops = ReadableLoops(setup)
    units, motion, _, start, *_ = beginning(setup, loops)
    gamma, M = (np.array(x) for x in (GAMMA, UPRIGHT))
    spin, frame = np.linalg.norm(M), loops.room(6)
    omega = np.array(body.omega(body.state(GAMMA, UPRIGHT)), dtype=float)
    d = getattr(body, "d", 0)
    rate = np.sqrt(gamma**2 @ (np.array(body.inertia) / (np.array(body.inertia) + d)))
    scale = float(setup.time_scale) * units.time
    with setup.reals:
        start_frame(start, frame)
        found = np.array([float(x) for x in velocity(motion, frame[::2] + frame[1::2])])
    right = np.concatenate([np.cross(gamma, omega), np.cross(M / spin, omega)]) * rate / scale
    assert np.abs(found - right).max() < 1e-10 * np.abs(right).max()


def test_phases_that_are_not_numbers_are_no_start() -> None:
    def change(found, basis):
        found[0] = np.nan

    with pytest.raises(PrecisionLoss):
        BodyTorus(setup_of("ball"), Wrong(change))

    def places(found, basis):
        found[IMAGINARY] = np.inf

    with pytest.raises(PrecisionLoss, match="range of floats"):
        BodyTorus(setup_of("ball"), Wrong(places))


def test_states_do_not_depend_on_whole_turns_but_for_signs() -> None:
    for name in BODIES:
        torus = BodyTorus(setup_of(name), CompiledLoops())
        phases = np.array([[0.25, 0.375], [-0.5, 0.8125]])
        here = torus.at_phases(phases)
        for k in (0, 1):
            signs, turned = torus.turns[k], phases.copy()
            turned[:, k] += 2.0**40 + 1
            there = torus.at_phases(turned)
            # M = w × γ
            expected = np.hstack([here[:, :3] * signs, here[:, 3:] * signs * signs.prod()])
            assert np.abs(there - expected).max() < 1e-15 * np.abs(here).max()
        assert np.abs(torus.torus[0][1][:, 0]).max() < 2


def test_two_equal_moments_have_an_opened_oval() -> None:
    """Two equal moments make an oval a point; opened to 2^−130 it changes no float."""
    for inertia in ((1, 1, 2), (2, 1, 1), (1, 2, 1)):
        for d in (0.7, 0):
            body = ChaplyginBall(inertia, d) if d else EulerTop(inertia)
            flow = body.flow(body.state(GAMMA, UPRIGHT))
            torus = BodyTorus(flow.setup, CompiledLoops())
            tau = np.array([0.5, -40.0, 1e6])
            precise = PreciseFlow(body if d else body.body, flow.state, 25)
            true = [[*map(float, gamma), *map(float, M)] for gamma, M in precise.vectors(precise.at_tau(tau.tolist()))]
            torus.loops.phases_at(torus.rates, tau, phases := torus.loops.room(6))
            found = torus._read(phases)
            assert np.abs(found.reshape(3, 6) - true).max() < 2e-15


def test_the_least_values_of_a_form_along_its_rows() -> None:
    """nYn for n = (1, x) and n = (x, 1), compared with a grid of x: rows of a sum end where it is large."""
    x = np.linspace(-2, 2, 4001)
    least = (2 + 1.5 * x + 1.5 * x**2).min(), (2 * x**2 + 1.5 * x + 1.5).min()
    assert shortest((2.0, 0.75, 1.5)) == pytest.approx(least, rel=1e-12)
    assert shortest((0.0, 0.0, 3.0)) == (float("inf"), 3.0)
