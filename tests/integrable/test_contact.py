"""The point of contact: its velocity r ω×γ in the axes of space, uniform across the momentum, exact at any time."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from integrable import ChaplyginBall, EulerTop, contact
from integrable.dense_panels import Panels
from integrable.panel_calculus import integrals
from jacobian import MP
from jacobian.errors import NotRepresentable, PrecisionLoss

GAMMA, M, LEANING = (0.6, 0.0, 0.8), (0.8, 1.0, -0.6), (0.9, 1.0, 0.3)
BALL = ChaplyginBall(inertia=(1, 2, 3), mass=2.0, radius=0.5)
MOTIONS = {"upright": (M, False), "tilted": (LEANING, True)}


@pytest.fixture(params=MOTIONS, scope="module")
def flow(request):
    momentum, tilted = MOTIONS[request.param]
    return BALL.flow(BALL.state(GAMMA, momentum, tilted=tilted))


def rolled(flow, times):
    """(x, y) by SciPy's DOP853 from the equations of motion and v = r ω×γ, turned into space by the attitude."""

    def rates(t, z):
        gamma, momentum = z[:3], z[3:6]
        omega = np.array(BALL.body.omega(gamma, momentum))
        velocity = BALL.radius * frame(gamma, momentum) @ np.cross(omega, gamma)
        return [*np.cross(gamma, omega), *np.cross(momentum, omega), *velocity[:2]]

    def frame(gamma, momentum):
        x = momentum - gamma @ momentum * gamma
        x /= np.linalg.norm(x)
        return np.array([x, np.cross(gamma, x), gamma])

    start = [*flow.state.gamma, *flow.state.M, 0, 0]
    forward = solve_ivp(rates, (0, max(times)), start, "DOP853", rtol=1e-12, atol=1e-13, t_eval=sorted(times))
    return forward.y[6:].T


def test_against_the_rolling_constraint(flow):
    times = np.linspace(0, 30, 31)
    assert np.abs(flow.at(times).contact - rolled(flow, times)).max() < 1e-9


def test_an_upright_ball_goes_uniformly_across_its_momentum():
    flow = BALL.flow(BALL.state(GAMMA, M))
    _, _, h1, h2 = BALL.integrals(flow.state)
    path = flow.at([-40, 0, 3, 100]).contact
    assert np.allclose(path[:, 1], -0.5 * h1 / h2**0.5 * np.array([-40, 0, 3, 100]), rtol=1e-15)
    assert np.array_equal(path[1], [0, 0])


def test_times_in_any_order_and_far(flow):
    times = np.array([5.0, -3.0, 2e3, 0.0, 7.5, -1e3])
    path = flow.at(times).contact
    for t, place in zip(times, path, strict=True):
        assert np.abs(flow.at(np.array([t])).contact - place).max() < 2e-13 * (1 + abs(t))
    assert flow.at(np.empty(0)).contact.shape == (0, 2)


def test_multiprecision_agrees_with_more_digits_and_with_floats():
    def path(field):
        ball = ChaplyginBall(inertia=(1, 2, 3), mass=2, radius="0.5", field=field)
        state = ball.state(("0.6", 0, "0.8"), ("0.8", 1, "-0.6"))
        return ball.flow(state).at(np.array([field.coerce(t) for t in ("2.5", "-1", "6")], dtype=object)).contact

    coarse, fine = path(MP(30)), path(MP(45))
    assert max(abs(x - y) for x, y in zip(coarse.ravel(), fine.ravel(), strict=True)) < 1e-28
    floats = BALL.flow(BALL.state(GAMMA, M)).at(np.array([2.5, -1.0, 6.0])).contact
    assert np.abs(fine.astype(float) - floats).max() < 1e-13


def test_lengths_are_radii_where_none_was_given():
    ball = ChaplyginBall(inertia=(1, 2, 3), d=0.5)
    path = ball.flow(ball.state(GAMMA, M)).at(np.array([4.0])).contact
    assert np.allclose(0.5 * path, BALL.flow(BALL.state(GAMMA, M)).at(np.array([4.0])).contact, atol=1e-13)


def test_a_top_touches_no_plane():
    top = EulerTop(inertia=(1, 2, 3))
    run = top.flow(top.state(GAMMA, M)).at(np.array([1.0]))
    with pytest.raises(NotRepresentable, match="turns about a fixed point"):
        contact.positions(run)


def test_far_away_the_torus_and_the_way_there_agree(flow, monkeypatch):
    times = np.array([70.0, -150.0, 400.0])
    path = flow.at(times).contact
    monkeypatch.setattr(contact, "FAR", 1e9)
    assert np.abs(path - flow.at(times).contact).max() < 1e-12


def test_at_any_distance(flow):
    # between two far times, by panels of their own
    start, end = 1e9, 1e9 + 20
    run = flow.at([start, end])

    def velocity(times):
        states = flow.at(times)
        return contact.velocities(flow, states.gamma, states.M)

    panels = Panels(velocity, start, end, 2.0)
    along = BALL.radius * integrals(panels, np.array([end]))[0, 0]
    assert abs(run.contact[1, 0] - run.contact[0, 0] - along) < 1e-5


def test_a_contact_point_that_would_take_hours_is_refused_by_name() -> None:
    """A heavy ball: its velocity is a small difference of large terms, and has no Fourier series in floats."""
    system = ChaplyginBall((1, 2, 3), 1e6)
    run = system.flow(system.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))).at([0.0, 1e12])
    with pytest.raises(PrecisionLoss, match=r"contact at time 1e\+12: .* integrated up to time"):
        _ = run.contact
