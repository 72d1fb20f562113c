"""The point of contact: its velocity is r ω×γ in the axes of space; orthogonally to the momentum it moves uniformly;
paths are right at any time.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from integrable import ChaplyginBall, EulerTop
from integrable.motion import contact
from integrable.motion.flow import Flow
from integrable.phase.brackets import over
from integrable.phase.state import onto_constraints
from integrable.torus.panels import Panels, panel_integrals
from jacobian import MP, RR
from jacobian.errors import NotRepresentable, PrecisionLoss

GAMMA, M, LEANING = (0.6, 0.0, 0.8), (0.8, 1.0, -0.6), (0.9, 1.0, 0.3)
BALL = ChaplyginBall(inertia=(1, 2, 3), mass=2.0, radius=0.5)
MOTIONS = {"upright": (M, False), "tilted": (LEANING, True)}


@pytest.fixture(params=MOTIONS, scope="module")
def flow(request):
    momentum, tilted = MOTIONS[request.param]
    return BALL.flow(BALL.state(GAMMA, momentum, tilted=tilted))


def rolled(flow, times, pace=1.0):
    """(x, y) by SciPy's DOP853 from the equations of motion and v = r ω×γ, turned into space by the attitude; ``pace``:
    turns per unit of time.
    """
    system, size = flow.system, np.linalg.norm(flow.state.M)
    radius = system.radius or 1.0

    def rates(t, z):
        gamma, momentum = z[:3], size * z[3:6]
        omega = np.array(system.body.omega(gamma, momentum))
        velocity = radius * frame(gamma, momentum) @ np.cross(omega, gamma)
        return np.array([*np.cross(gamma, omega), *np.cross(momentum, omega) / size, *velocity[:2]]) / pace

    def frame(gamma, momentum):
        x = momentum - gamma @ momentum * gamma
        x /= np.linalg.norm(x)
        return np.array([x, np.cross(gamma, x), gamma])

    start = [*flow.state.gamma, *(np.array(flow.state.M) / size), 0, 0]
    ends = pace * np.sort(times)
    forward = solve_ivp(rates, (0, ends[-1]), start, "DOP853", rtol=1e-12, atol=1e-13, t_eval=ends)
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


@pytest.mark.parametrize(("start", "accuracy"), [(1e8, 3e-13), (1e9, 1e-12)])
def test_at_any_distance(flow, start, accuracy):
    # between two far times, by separate panels
    end = start + 20
    run = flow.at([start, end])

    def velocity(times):
        states = flow.at(times)
        # r ω×γ along the horizontal part of M
        return BALL.radius * np.einsum("ij,ij->i", states.attitude[:, 0], np.cross(states.omega, states.gamma))[:, None]

    along = panel_integrals(Panels(velocity, start, end, 2.0), np.array([end]))[0, 0]
    assert abs(run.contact[1, 0] - run.contact[0, 0] - along) < accuracy


# moments, d, γ, M, tilted: equal moments of both kinds and nearly so, heavy and light, fast and slow, next to M ∥ γ
BODIES = {
    "three equal": ((2, 2, 2), 5.0, (0, 0.6, 0.8), (1, -0.8, 0.6), False),
    "three equal, tilted": ((2, 2, 2), 5.0, (0, 0.6, 0.8), (1, -0.8, 0.9), True),
    "oblate": ((2, 2, 3), 0.7, (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), False),
    "oblate, tilted": ((2, 2, 3), 0.7, (0.48, 0.6, 0.64), (0.384, 1.28, 1.488), True),
    "prolate, tilted": ((3, 2, 3), 0.7, (0.48, 0.6, 0.64), (0.384, 1.28, 1.488), True),
    "prolate": ((1, 4, 4), 2.7, (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), False),
    "nearly oblate, tilted": ((2, 2 + 1e-7, 3), 0.7, (0.48, 0.6, 0.64), (0.384, 1.28, 1.488), True),
    "heavy": ((1, 2, 3), 1e4, (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), False),
    "heavy, tilted": ((1, 2, 3), 1e4, (0.48, 0.6, 0.64), (0.384, 1.28, 1.488), True),
    "heavy and oblate, tilted": ((2, 2, 3), 1e4, (0.48, 0.6, 0.64), (0.384, 1.28, 1.488), True),
    "light, tilted": ((1, 2, 3), 1e-4, (0.48, 0.6, 0.64), (0.384, 1.28, 1.488), True),
    "fast": ((1, 2, 3), 0.7, (0.48, 0.6, 0.64), (0.384e13, 1.28e13, -1.488e13), False),
    "slow, tilted": ((1, 2, 3), 0.7, (0.48, 0.6, 0.64), (0.384e-13, 1.28e-13, 1.488e-13), True),
    "thin, next to M ∥ γ": (
        (0.040448380630925554, 23.15270006172952, 4.972592134955445),
        0.7555376165201327,
        (-0.002085771970611901, -0.9996702327612066, 0.025594438584221824),
        (-3149370900.453172, -1657674773518.8013, 43851889625.27099),
        True,
    ),
    "next to M ∥ γ": ((1, 2, 3), 0.7, (0.48, 0.6, 0.64), (0.48, 0.6, 0.65), True),
}


@pytest.fixture(params=BODIES, scope="module")
def any_flow(request):
    inertia, d, gamma, momentum, tilted = BODIES[request.param]
    ball = ChaplyginBall(inertia, d)
    return ball.flow(ball.state(gamma, momentum, tilted=tilted))


def fastest(flow):
    """An upper bound of |ω|: (Iω, ω) ≤ H1."""
    return (flow.system.integrals(flow.state).H1 / min(flow.system.inertia)) ** 0.5


@pytest.mark.thinned(3)
def test_paths_of_all_kinds_of_bodies(any_flow):
    """Compared with an integration of the rolling constraint whose steps follow the body's turns."""
    pace = fastest(any_flow)
    times = np.array([0.7, 12.0, 25.0]) / pace
    found, true = any_flow.at(times).contact, rolled(any_flow, times, pace)
    loss = np.linalg.norm(any_flow.state.M) / np.linalg.norm(np.cross(any_flow.state.gamma, any_flow.state.M))
    assert np.abs(found - true).max() < 1e-10 * max(1e-3, np.abs(true).max()) * max(1, loss / 100)
    # backwards: the same path from there
    back = any_flow.at([-times[2], 0.0, times[2], times[2]]).contact
    assert np.array_equal(back[1], [0, 0])
    assert np.array_equal(back[2], back[3])
    assert np.abs(any_flow.at([times[2]]).contact[0] - back[2]).max() < 1e-13 * max(1e-3, np.abs(true).max())


def test_paths_do_not_depend_on_how_they_are_asked_for(any_flow, monkeypatch):
    """Panels along the motion and a Fourier series agree, as do times and values of τ."""
    times = np.array([60.0, -20.0, 30.0]) / fastest(any_flow)
    path = any_flow.at(times).contact
    gamma, momentum = any_flow.state.gamma, any_flow.state.M
    loss = np.linalg.norm(momentum) / np.linalg.norm(np.cross(gamma, momentum))
    size = max(1e-3, np.abs(path).max()) * max(1, loss)
    assert np.abs(any_flow.at_tau(any_flow.at(times).tau).contact - path).max() < 1e-12 * size
    for far in (-1, 10**9):
        monkeypatch.setattr(contact, "FAR", far)
        assert np.abs(any_flow.at(times).contact - path).max() < 1e-12 * size


@pytest.mark.thinned(3)
@pytest.mark.parametrize("t", [1e8, 1e12])
def test_far_away_the_path_goes_on(any_flow, t):
    """On average the path is that of a ball with three equal moments 1/ζ − d; the difference is bounded."""
    rate = fastest(any_flow)
    t /= rate
    here = any_flow.at([t, -t]).contact
    near = np.abs(any_flow.at(np.linspace(-3000, 3000, 2000) / rate).contact[:, 0]).max()
    drift = here[0, 1] / t
    assert np.abs(here[:, 0]).max() <= 3 * near + 1e-12
    assert abs(here[1, 1] / t + drift) <= 1e-5 * abs(drift)


def test_three_equal_moments_roll_straight():
    ball = ChaplyginBall((2, 2, 2), 5.0)
    path = ball.flow(ball.state((0, 0.6, 0.8), (1, -0.8, 0.6))).at([100, 1e12]).contact
    assert np.allclose(path, [[0, -20.2030508910442], [0, -20.2030508910442e10]], rtol=1e-14, atol=0)


def test_a_heavy_ball_far_away():
    """Its velocity is a small difference of large terms; the reference has 40 digits."""
    values = (1, 2, 3), 1e6, (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)
    found = _path(RR, *values, [30.0, 4000.0, 1e12])
    true = _path(MP(40), *values, [30.0, 4000.0])
    assert np.abs(found[:2, 0] - true[:, 0]).max() < 1e-14 * 1e-4
    assert abs(found[2, 1] - 1e12 / 4000 * float(true[1, 1])) < 1e-10 * abs(found[2, 1])
    assert abs(found[2, 0]) < 1e-3


def test_a_heavy_ball_in_multiprecision():
    values = (2, 3.1, 4.2), 9.72, (0.48, 0.6, 0.64), (3, 2, -4), [2.0, -1.0], True
    found, true = _path(MP(30), *values), _path(MP(42), *values)
    assert max(abs(x - y) for x, y in zip(found.ravel(), true.ravel(), strict=True)) < 1e-28


@pytest.mark.slow
@pytest.mark.parametrize("tilted", [False, True], ids=["upright", "tilted"])
def test_far_away_in_multiprecision(tilted, monkeypatch):
    """A Fourier series on the torus, compared with quadrature along the motion, more digits, and floats; t = 1e9 used
    to take for ever.
    """
    momentum = (1, 1.28, 1.488) if tilted else (0.384, 1.28, -1.488)
    ball = ChaplyginBall((1, 2, 3), 50.0)
    state = onto_constraints(over(ball, MP(18)), ball.state((0.48, 0.6, 0.64), momentum, tilted=tilted))

    def path(digits, times):
        wide = over(ball, MP(digits))
        # the same numbers over both fields
        return Flow(wide, state).at(times).contact

    times = [400.0, -90.0, 1e9]
    found, true = path(18, times), path(25, times)
    assert abs(found[:, 0] - true[:, 0]).max() < 1e-15
    assert abs(found[:, 1] / true[:, 1] - 1).max() < 1e-16
    monkeypatch.setattr(contact, "FAR_GAUSS", 1000)
    assert abs(path(18, times[1:2]) - true[1]).max() < 1e-15
    floats = ball.flow(ball.state((0.48, 0.6, 0.64), momentum, tilted=tilted)).at(times).contact
    assert abs(floats[:, 0] - true[:, 0].astype(float)).max() < 1e-12


def test_on_the_separatrix_a_far_path_in_multiprecision_is_refused():
    """There is no torus, hence no series: the path used to be integrated over 200 panels, for minutes."""
    ball = ChaplyginBall((1, 2, 3), "0.7", field=MP(20))
    run = ball.flow(ball.state(("0.6", 0, "0.8"), (0, 1, 0))).at([300])
    with pytest.raises(PrecisionLoss, match=r"no Fourier series .* ask for times nearer to 0"):
        _ = run.contact


def _path(field, inertia, d, gamma, momentum, times, tilted=False):
    ball = ChaplyginBall(inertia, d)
    state = ball.state(gamma, momentum, tilted=tilted)
    if field != RR:
        ball = over(ball, field)
        state = onto_constraints(ball, state)
    return ball.flow(state).at(times).contact
