"""The result of all motions: its method, its rows, and the quantities that a system refuses."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

from integrable import ChaplyginBall, Check, EulerTop, Gyroscopic, Hat, Tilde, Trajectory, load_scene
from integrable.motion.refusals import kept_rows
from integrable.motion.trajectory import WAYS, Motion
from integrable.phase.state import State
from integrable.scene.orbit import orbit
from jacobian import MP, RR
from jacobian.errors import ArgumentError, FieldError, Infeasible, NotRepresentable, PrecisionLoss
from tests.integrable.ways import torus_of

START = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)
DECIMALS = ("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488")
POTENTIAL = (0.1, 0.05, 0.02, 0.04, 0.06)


def motion(system) -> Motion:
    return system.motion_through(system.state(*(START if system.field == RR else DECIMALS)))


BALL = ChaplyginBall((1, 2, 3), 0.7)
DEFORMED = [
    Tilde((1, 2, 4), 0.7),
    Tilde((1, 2, 4), 0.7, potential=POTENTIAL),
    Tilde((1, 2, 4), potential=(0, 0, 2, 4, 6)),
    Check((1, 2, 4)),
    Hat((1, 2, 4)),
    Gyroscopic((1, 2, 4), 0.3),
]
WAY = {
    "closed form": (ChaplyginBall((1, 1, 3), 0.7), [1e4]),
    "short run": (BALL, [30.0]),
    "torus": (BALL, [1e9]),
    "multiprecision": (ChaplyginBall((1, 2, 3), "0.7", field=MP(20)), [1.0]),
    "elliptic curves": (DEFORMED[0], [1e4]),
    "integrated": (DEFORMED[1], [1.0]),
}


@pytest.mark.parametrize("way", WAY)
def test_every_motion_gives_a_trajectory_that_says_what_computed_it(way) -> None:
    system, times = WAY[way]
    run = motion(system).at(times)
    assert type(run) is Trajectory
    assert run.way == way
    assert run.way in WAYS
    assert (run.status.tolist(), run.reasons, run.kept) == ([0], ("",), run)
    assert run.system == system


def test_the_steps_of_a_map_are_a_trajectory_without_times() -> None:
    state = BALL.state(*START)
    run = orbit(BALL.translation([1.8, 2.5]), state, 3)
    assert isinstance(run, Trajectory)
    assert run.way == "steps"
    assert run.way in WAYS
    assert run.integrals.H1.tolist() == pytest.approx([BALL.integrals(state).H1] * 4)
    for name in ("tau", "contact"):
        with pytest.raises(NotRepresentable, match=f"{name}: .* is a map"):
            getattr(run, name)


def test_steps_over_a_finite_field_have_integrals_and_no_attitude() -> None:
    scene = load_scene("finite_field")
    system, state = scene.start(15)
    run = orbit(scene.step(system, 15), state, 2)
    assert run.integrals.H1.tolist() == [system.integrals(state).H1] * 3
    for name in ("omega", "attitude", "quaternion"):
        with pytest.raises(NotRepresentable, match=r"not over GF\("):
            getattr(run, name)


@pytest.mark.parametrize("made", ["flow", "orbit"])
def test_states_one_after_the_other_and_by_their_number(made) -> None:
    """A loop over the states used to end in an error, and an orbit did not accept numpy integers."""
    state = BALL.state(*START)
    run = BALL.flow(state).at([0, 1, 2]) if made == "flow" else orbit(BALL.translation([1.8, 2.5]), state, 2)
    assert [x.gamma.tolist() for x in run] == run.gamma.tolist()
    assert run[np.int64(1)] == run[1] == list(run)[1]
    with pytest.raises(ArgumentError, match="row = 3: the rows are 0 … 2"):
        run[3]


# --- the quantities of a system


@pytest.mark.thinned(2)
@pytest.mark.parametrize("system", DEFORMED, ids=repr)
def test_a_deformation_has_integrals_and_an_angular_velocity_along_its_run(system) -> None:
    run = motion(system).at([0.0, 0.5, 1.5])
    states = [State(tuple(g), tuple(m)) for g, m in zip(run.gamma.tolist(), run.M.tolist(), strict=True)]
    assert run.integrals._fields == ("C1", "C2", "H", "K")
    for name in run.integrals._fields:
        assert getattr(run.integrals, name) == pytest.approx([getattr(system.integrals(s), name) for s in states])
    assert run.integrals.H.tolist() == pytest.approx([run.integrals.H[0]] * 3, rel=1e-13)
    rates = [system.vector_field(s).gamma for s in states]
    assert np.cross(run.gamma, run.omega) == pytest.approx(np.array(rates), abs=1e-14)


@pytest.mark.parametrize("system", [DEFORMED[0], DEFORMED[1], DEFORMED[4]], ids=repr)
def test_what_a_deformation_has_not_is_refused_by_name(system) -> None:
    run = motion(system).at([0.5])
    for name in ("attitude", "quaternion"):
        with pytest.raises(NotRepresentable, match="M does not rest in space"):
            getattr(run, name)
    with pytest.raises(NotRepresentable, match="no body that rolls"):
        _ = run.contact


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    "system", [BALL, DEFORMED[0], pytest.param(DEFORMED[1], marks=pytest.mark.slow), *DEFORMED[2:]], ids=repr
)
def test_times_and_own_times_are_inverse(system) -> None:
    flow = motion(system)
    run = flow.at([-0.3, 0.0, 0.5])
    again = flow.at_tau(run.tau)
    assert again.times == pytest.approx(run.times, abs=1e-14)
    assert flow.physical_time(run.tau) == pytest.approx(run.times, abs=1e-14)
    assert again.gamma == pytest.approx(run.gamma, abs=1e-13)


def test_the_clock_of_a_deformation_far_away() -> None:
    system = Tilde((1, 2, 4), "0.7", field=MP(30))
    flow = motion(system)
    run = flow.at(["1e12", "-3e8"])
    assert [float(abs(x / t - 1)) for x, t in zip(flow.physical_time(run.tau), run.times, strict=True)] < [1e-29] * 2


def test_trajectories_of_deformations_are_values() -> None:
    run = motion(DEFORMED[0]).at([0.5, 1.0])
    assert pickle.loads(pickle.dumps(run)) == run
    assert copy.deepcopy(run) is run
    with pytest.raises(ValueError, match="read-only"):
        run.gamma[0, 0] = 1.0


# --- rows that cannot be computed


BEYOND = {
    "closed form": (WAY["closed form"][0], 1e30),
    "torus": (BALL, 1e30),
    "torus, top": (EulerTop((1, 2, 3)), 1e30),
    "multiprecision": (ChaplyginBall((1, 2, 3), "0.7", field=MP(20)), "1e500"),
    "elliptic curves": (Check((1, 2, 4), field=MP(20)), "1e600"),
    "elliptic curves, d": (Tilde((1, 2, 4), "0.7", field=MP(20)), "1e600"),
}


@pytest.mark.parametrize("name", BEYOND)
@pytest.mark.parametrize("method", ["at", "at_tau"])
def test_rows_beyond_reach_are_marked_and_the_others_kept(name, method) -> None:
    system, far = BEYOND[name]
    flow = motion(system)
    asked = getattr(flow, method)
    near = [1.0, -2.0, 0.0]
    with pytest.raises(PrecisionLoss):
        asked([near[0], far, *near[1:]])
    run = asked([near[0], far, *near[1:]], strict=False)
    alone = asked(near)
    assert run.status.tolist() == [0, 1, 0, 0]
    assert run.reasons[0] == ""
    with pytest.raises(PrecisionLoss) as refusal:
        asked([far])
    assert run.reasons[1:] == (str(refusal.value),)
    assert run.kept.gamma.astype(float) == pytest.approx(alone.gamma.astype(float), abs=1e-13)
    assert run.kept.M.astype(float) == pytest.approx(alone.M.astype(float), abs=2e-13)
    assert run.kept.times.astype(float) == pytest.approx(alone.times.astype(float), abs=1e-13)
    assert run.kept.status.tolist() == [0, 0, 0]
    assert all(x != x for x in (*run.gamma[1], *run.M[1]))
    assert "1 of them refused" in repr(run)


def test_nothing_is_read_off_a_run_with_refused_rows() -> None:
    run = motion(BALL).at([1.0, 1e30], strict=False)
    for name in ("integrals", "omega", "attitude", "quaternion", "contact"):
        with pytest.raises(NotRepresentable, match=r"1 of 2 rows were refused, the first of them row 1: .*kept\."):
            getattr(run, name)
        assert len(getattr(run.kept, name)) in (1, 4)


def test_all_rows_may_be_had_or_refused() -> None:
    flow = motion(BALL)
    run, all_there = flow.at([1e30, -1e31], strict=False), flow.at([1.0, 2.0], strict=False)
    assert run.status.tolist() == [1, 2]
    assert len(run.kept) == 0
    assert all_there == flow.at([1.0, 2.0])
    assert all_there.status.tolist() == [0, 0]
    assert len(flow.at([], strict=False)) == 0


@pytest.mark.parametrize("method", ["at", "at_tau"])
def test_runs_with_refused_rows_are_values(method) -> None:
    asked = getattr(motion(BALL), method)
    # as long as there is no torus, few near times use another method
    asked([1e6])
    run = asked([1.0, 1e30], strict=False)
    assert run == asked([1.0, 1e30], strict=False)
    assert pickle.loads(pickle.dumps(run)) == run
    assert hash(pickle.loads(pickle.dumps(run))) == hash(run)
    assert run not in (asked([1.0, 2e30], strict=False), asked([1e30, 1.0], strict=False), run.kept)


def test_misuse_is_refused_whatever_strict_is() -> None:
    flow = motion(BALL)
    with pytest.raises(FieldError, match=r"times\[1\]"):
        flow.at([0.0, "x"], strict=False)
    with pytest.raises(ArgumentError, match="strict = 'no': True or False"):
        flow.at([0.0], strict="no")


def test_many_refused_rows_are_found_by_bisection() -> None:
    tried = []

    def compute(values):
        tried.append(len(values))
        if (np.abs(values) > 1e4).any():
            raise PrecisionLoss("too far")
        return np.repeat(values[:, None], 6, axis=1), values

    times = np.concatenate([np.linspace(0, 1e4, 20_000), np.linspace(1e30, -1e31, 20_000)])
    found = kept_rows(compute, times, np.nan)
    assert len(tried) < 50
    assert sum(tried) < 70_000
    assert found.status is not None
    assert (found.status == np.repeat([0, 1], 20_000)).all()
    assert (found.tau[:20_000] == times[:20_000]).all()
    assert np.isnan(found.rows[20_000:]).all()


def test_a_state_off_the_level_set_is_refused_alone(monkeypatch) -> None:
    flow = motion(BALL)
    way = torus_of(flow)

    def spoilt(times):
        rows, tau = type(way).at(way, times)
        rows[1] *= 1 + 1e-6
        return rows, tau

    monkeypatch.setattr(way, "at", spoilt)
    with pytest.raises(PrecisionLoss, match=r"^row 1: H1 and H2 are off by"):
        flow.at([1e9, 2e9, 3e9])
    run = flow.at([1e9, 2e9, 3e9], strict=False)
    assert run.status.tolist() == [0, 1, 0]
    assert run.reasons[1].startswith("H1 and H2 are off by")


@pytest.mark.slow
def test_a_motion_that_ends_keeps_the_rows_before_its_end() -> None:
    system = Check((1, 2, 4), potential=(0.0, 0.0, 0.0, 0.5, 0.0))
    flow = motion(system)
    run = flow.at([0.1, 5.0, -0.1, 0.2, 50.0], strict=False)
    assert run.status.tolist() == [0, 1, 0, 0, 1]
    assert "the motion ends, or cannot be followed" in run.reasons[1]
    assert run.kept.gamma == pytest.approx(flow.at([0.1, -0.1, 0.2]).gamma, abs=1e-15)


def test_what_would_take_minutes_is_refused_alone() -> None:
    flow = motion(DEFORMED[1])
    with pytest.raises(Infeasible):
        flow.at([1.0, 1e9])
    run = flow.at([1.0, 1e9], strict=False)
    assert run.status.tolist() == [0, 1]
    assert "takes more than" in run.reasons[1]


def test_rows_that_are_refused_together_only() -> None:
    """If more than three rows at once are refused, the nearest are kept, whatever happens to single rows."""

    def compute(values):
        if len(values) > 3:
            raise PrecisionLoss("more than three")
        return np.ones((len(values), 6)), values

    found = kept_rows(compute, np.array([5.0, 1.0, -2.0, 3.0, -4.0]), np.nan)
    assert found.status.tolist() == [1, 0, 0, 0, 1]
    assert found.reasons == ("", "more than three")
