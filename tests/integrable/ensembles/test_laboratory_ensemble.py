"""Many motions in the laboratory are the motions of their members."""

from __future__ import annotations

import numpy as np
import pytest

from integrable import RigidBody, RollingBall, ensemble, laboratory_ensemble
from jacobian import MP
from jacobian.errors import ArgumentError, NotRepresentable
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.threads import set_threads
from tests.integrable.laboratory.test_laboratory import MASS, RADIUS, UP, Unmade, lean, rotation, tensor

TENSOR = tensor((0.1, 0.12, 0.15), rotation(np.random.default_rng(1)))
BODIES = {"ball": RollingBall(TENSOR, MASS, RADIUS), "free body": RigidBody(TENSOR)}
RNG = np.random.default_rng(2)
STARTS = np.array([rotation(RNG) for _ in range(9)])
OMEGA = 2 * RNG.normal(size=(9, 3))


@pytest.mark.parametrize("name", BODIES)
def test_members_are_single_motions(name):
    body, times = BODIES[name], np.linspace(-3, 20, 12)
    contacts = RNG.normal(size=(9, 2)) if name == "ball" else None
    many = laboratory_ensemble(body, STARTS, OMEGA, contacts)
    set_threads(2)
    runs = many.at(times)
    set_threads(None)
    assert runs.status.tolist() == [0] * 9
    for k in range(9):
        one = many.motion(k).at(times)
        assert abs(runs.matrices[k] - one.matrices).max() < 1e-13
        assert abs(runs.omega[k] - one.omega).max() < 3e-13
        assert abs(runs.omega_body[k] - one.omega_body).max() < 3e-13
        assert abs(runs.quaternion[k] - one.quaternion).max() < 1e-13
        assert np.array_equal(runs[k].matrices, runs.matrices[k])
    if contacts is not None:
        for k, path in zip((7, 8), runs[7:].contact, strict=True):
            assert np.array_equal(path, many.motion(k).at(times).contact)


@pytest.mark.skipif(interpreted(), reason="short runs of many are compiled")
def test_short_runs_make_no_motion(monkeypatch):
    many = laboratory_ensemble(BODIES["ball"], STARTS, OMEGA)
    monkeypatch.setattr(RollingBall, "motion", lambda *_: pytest.fail("a motion was made"))
    assert many.at([0, 1.0]).status.tolist() == [0] * 9


def test_special_motions_and_refused_ones():
    """Constant ω, vertical and nearly vertical M, far times: equal to the member's own motion, to the bit."""
    ball, R = BODIES["ball"], STARTS[0]
    axis = R @ ball.axes[:, 0]
    omega = [0 * axis, axis, lean(TENSOR, R, [0, 0, 0.7]), OMEGA[0], OMEGA[1], 1e200 * OMEGA[0]]
    starts = [R, R, R, R, 2 * R, R]
    runs = laboratory_ensemble(ball, starts, omega).at([0, 1.0])
    assert runs.status.tolist() == [0, 0, 0, 0, 1, 2]
    # the ways of members without a short run said "short run"
    assert runs.ways == [*["own motion"] * 3, "own motion" if interpreted() else "short run", "", ""]
    assert "R Rᵀ differs from 1" in runs.reasons[1]
    for k in range(3):
        one = ball.motion(starts[k], omega[k]).at([0, 1.0])
        assert np.array_equal(runs.matrices[k], one.matrices)
        assert np.array_equal(runs.omega[k], one.omega)
    assert np.isnan(runs.matrices[4]).all()
    assert np.isnan(runs.quaternion[4]).all()
    assert len(runs.kept) == 4
    assert runs.kept.contact.shape == (4, 2, 2)
    with pytest.raises(ArgumentError, match=r"orientation = .* differs from 1"):
        _ = runs[4]
    with pytest.raises(NotRepresentable, match=r"take \.kept\.orientation"):
        _ = runs.orientation
    far = laboratory_ensemble(ball, R, OMEGA[0]).at([1e6])
    assert np.array_equal(far.matrices[0], ball.motion(R, OMEGA[0]).at([1e6]).matrices)


def test_times_of_their_own_and_parts():
    many = laboratory_ensemble(BODIES["free body"], STARTS, OMEGA)
    times = np.linspace(0, 5, 27).reshape(9, 3)
    runs = many.at(times)
    for k in (0, 8):
        assert abs(runs.matrices[k] - many.motion(k).at(times[k]).matrices).max() < 1e-13
    assert np.array_equal(many[3:5].at(times[3:5]).matrices, runs[3:5].matrices)
    assert np.array_equal(runs[[8, 0]].times, times[[8, 0]])
    assert len(many[:0].at([1.0])) == 0
    assert many.at([]).matrices.shape == (9, 0, 3, 3)
    assert [run.times.tolist() for run in runs] == times.tolist()


def test_arrays_that_were_given_may_change():
    starts, omega, contacts = STARTS.copy(), OMEGA.copy(), np.zeros((9, 2))
    many = laboratory_ensemble(BODIES["ball"], starts, omega, contacts)
    for given in (starts, omega, contacts):
        given[:] = 7
    assert many == laboratory_ensemble(BODIES["ball"], STARTS, OMEGA)


def test_rotations_of_scipy_in_and_out():
    rotations = pytest.importorskip("scipy.spatial.transform").Rotation
    many = laboratory_ensemble(BODIES["ball"], rotations.from_matrix(STARTS), OMEGA)
    runs = many.at([0, 1.0])
    found = runs.orientation
    assert len(found) == 18
    assert abs(found.as_matrix() - runs.matrices.reshape(-1, 3, 3)).max() < 1e-15
    assert abs(found[::2].as_matrix() - STARTS).max() < 1e-14


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: laboratory_ensemble((1, 2, 3), UP, (1, 2, 3)), "give a RollingBall or a RigidBody of floats"),
        (lambda: laboratory_ensemble(RigidBody((1, 2, 3), field=MP(20)), UP, (1, 2, 3)), "of floats"),
        (lambda: laboratory_ensemble(BODIES["free body"], UP, (1, 2, 3), (0, 0)), "contact: a free body has none"),
        (lambda: laboratory_ensemble(BODIES["ball"], UP[:2], (1, 2, 3)), r"orientation has shape \(2, 3\)"),
        (lambda: laboratory_ensemble(BODIES["ball"], "up", (1, 2, 3)), "orientation = 'up'"),
        (
            lambda: laboratory_ensemble(BODIES["ball"], Unmade, (1, 2, 3)),
            "orientation = .*Unmade.*: rotations of shape",
        ),
        (lambda: laboratory_ensemble(BODIES["ball"], 10**400, (1, 2, 3)), "orientation = an int"),
        (lambda: laboratory_ensemble(BODIES["ball"], UP, (1, 2, 10**400)), "omega = .*: numbers"),
        (lambda: laboratory_ensemble(BODIES["ball"], STARTS, OMEGA).at([10**400]), "times = .*: numbers"),
        (lambda: laboratory_ensemble(BODIES["ball"], UP, (1, 2)), r"omega has shape \(2,\)"),
        (lambda: laboratory_ensemble(BODIES["ball"], STARTS, OMEGA[:4]), "orientation has 9, omega has 4"),
        (lambda: laboratory_ensemble(BODIES["ball"], STARTS, OMEGA).at([[1, 2]] * 3), r"\(9, N\) is needed"),
        (lambda: laboratory_ensemble(BODIES["ball"], STARTS, OMEGA).at([np.nan]), "finite numbers"),
        (
            lambda: laboratory_ensemble(BODIES["ball"], UP, [OMEGA[0]] * 10**5).at(np.ones(10**6)),
            "times: 100000 members at 1000000 times are 9600 GB; take .chunks",
        ),
        (lambda: laboratory_ensemble(BODIES["ball"], STARTS, OMEGA).motion(9), "0 … 8"),
        (lambda: ensemble(BODIES["ball"], UP[0], UP[1]), "laboratory_ensemble"),
    ],
)
def test_bad_input_is_named_in_one_line(call, message):
    with pytest.raises(ArgumentError, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_a_free_body_has_no_contact_even_if_all_members_are_refused() -> None:
    runs = laboratory_ensemble(RigidBody((1, 1.5, 2)), np.eye(3), [[np.nan, 0, 1]] * 2).at([0.0, 1.0])
    assert runs.status.all()
    for name in ("contact", "centre"):
        with pytest.raises(NotRepresentable, match="it has no point of contact"):
            getattr(runs, name)
