"""Many motions at once agree with single flows, member by member, even if other members are refused."""

import re

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop, Tilde, ensemble
from integrable.motion import flow as flows
from integrable.motion import short
from integrable.phase.ways import Cost
from jacobian import MP, ArgumentError
from jacobian.numbers.threads import set_threads

BALL = ChaplyginBall((1, 2, 3), 0.7)
GAMMA, M = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)


def refuses(call, said):
    with pytest.raises(ArgumentError, match=re.escape(said)):
        call()


def random_members(rng, count, tilted=False):
    """γ, M, moments and d."""
    gamma, momentum = rng.normal(size=(2, count, 3))
    gamma /= np.linalg.norm(gamma, axis=1)[:, None]
    if not tilted:
        momentum -= (momentum * gamma).sum(axis=1)[:, None] * gamma
    return gamma, momentum, rng.uniform(1, 2, (count, 3)), rng.uniform(0, 2, count)


@pytest.fixture
def two_threads():
    set_threads(2)
    yield
    set_threads(None)


@pytest.mark.parametrize("tilted", [False, True])
@pytest.mark.parametrize("until", [3, 60])
def test_members_are_single_flows(tilted, until, two_threads):
    """To the bit if a single flow uses the same method, otherwise to the bound of the clock."""
    gamma, momentum, inertia, d = random_members(np.random.default_rng(1), 40, tilted)
    d[:3] = 0
    inertia[3, 1] = inertia[3, 0]
    many = ensemble(BALL, gamma, momentum, inertia=inertia, d=d, tilted=tilted)
    times = np.array([0, until, -1.5, until / 3, 0])
    found = many.at(times)
    assert not found.status.any()
    assert found.ways[3] == "short run"
    same = 0
    for k in range(len(many)):
        short_run = found.ways[k] == "short run"
        one = single(many, k, times) if short_run else many.flow(k).at(times)
        np.testing.assert_array_equal(found.gamma[k], one.gamma)
        np.testing.assert_array_equal(found.M[k], one.M)
        np.testing.assert_array_equal(found.tau[k], one.tau)
        exact = compiled(many, k).at(times)
        size = np.linalg.norm(momentum[k])
        assert abs(found.gamma[k] - exact.gamma).max() < 5e-13
        assert abs(found.M[k] - exact.M).max() < 5e-13 * size
        assert found[k] == one
        same += short_run
    assert same > 30


def single(many, k, times):
    """A single flow without a walk, whose clock has the tolerance of an ensemble's clock."""
    with pytest.MonkeyPatch.context() as patch:
        for name in ("WALK_OF_BALL", "WALK_OF_TOP"):
            patch.setattr(flows, name, (Cost(0, 0), -1.0))
        patch.setattr(short, "DRIFT", short.DRIFT_OF_MANY)
        patch.setattr(short, "PACE", short.PACE_OF_MANY)
        patch.setattr(short, "panels_within", lambda *_: short.MOST_PANELS)
        return many.flow(k).at(times)


def compiled(many, k):
    """The torus of a member, or the reason why there is none."""
    flow = many.flow(k)
    return flow.system.flow(flow.state, "compiled")


def test_each_member_has_times_of_its_own():
    gamma, momentum, inertia, d = random_members(np.random.default_rng(2), 3)
    many = ensemble(BALL, gamma, momentum, inertia=inertia, d=d)
    times = np.array([[0, 1, 2], [5, 4, 3], [-1, 0, 1.0]])
    found = many.at(times)
    assert found.gamma.shape == found.M.shape == (3, 3, 3)
    assert found.times.shape == found.tau.shape == (3, 3)
    for k in range(3):
        np.testing.assert_array_equal(found.gamma[k], many.at(times[k]).gamma[k])
        np.testing.assert_array_equal(found[k].times, times[k])
    assert [run.times.tolist() for run in found] == times.tolist()
    np.testing.assert_array_equal(found[1:].times, times[1:])


def test_refused_members_and_rows_stop_no_other():
    inertia = [(1, 2, 3), (1, -2, 3), (1, 2, 3), (1, 2, 3)]
    momentum = [M, M, (1, 1, 1), M]
    times = np.array([[0, 1], [0, 1], [0, 1], [1, 1e30]])
    found = ensemble(BALL, GAMMA, momentum, inertia=inertia).at(times)
    assert found.status.tolist() == [0, 1, 2, 3]
    assert found.reasons[0] == ""
    assert found.reasons[1].startswith("inertia[1] = -2.0 is not positive")
    assert found.reasons[2].startswith("M = (1.0, 1.0, 1.0) has (γ, M) = ")
    assert found.reasons[3].startswith("time 1e+30: ")
    assert found.row_status(0).tolist() == [0, 0]
    assert found.row_status(1).tolist() == [1, 1]
    assert found.row_status(3).tolist() == [0, 3]
    assert np.isnan(found.gamma[1:3]).all()
    assert np.isnan(found.M[3, 1]).all()
    assert np.isfinite(found.gamma[0]).all()
    assert np.isfinite(found.M[3, 0]).all()
    assert len(found.kept) == 1
    assert found[3].status.tolist() == [0, 3]
    assert found[0].reasons == ("",)
    refuses(lambda: found[1], "inertia[1] = -2.0 is not positive")
    assert [len(part) for part in (found[:2], found[[0, 3]], found[found.status > 1])] == [2, 2, 2]
    assert found[[3, 0]].row_status(0).tolist() == [0, 3]


def test_concatenation():
    many = ensemble(BALL, GAMMA, M, d=(0.7, -1, 0.5, 0))
    found = many.at([1, 1e30])
    assert found[:2].concatenated(found[2:3], found[3:]) == found
    assert found[:1].concatenated(many[1:].at([1, 1e30])) == found
    other = many.at([1, 2])
    both = found.concatenated(other)
    assert both.times.shape == (8, 2)
    assert both.status.tolist() == [*found.status, 0, found.status[1], 0, 0]
    refuses(lambda: found.concatenated(many.at([1])), "the same system and number of times")


def test_quantities_are_those_of_the_members():
    many = ensemble(BALL, GAMMA, M, d=(0.7, -1, 0.5))
    found = many.at([1, 1e30, 2])
    for name in ("omega", "quaternion", "contact"):
        values = getattr(found, name)
        for k in (0, 2):
            np.testing.assert_array_equal(values[k, [0, 2]], getattr(found[k].kept, name))
        assert np.isnan(values[1]).all()
        assert np.isnan(values[:, 1]).all()


def test_chunks_are_the_whole(tmp_path):
    gamma, momentum, inertia, d = random_members(np.random.default_rng(3), 7)
    many = ensemble(BALL, gamma, momentum, inertia=inertia, d=d)
    whole = many.at([1, 2, 3])
    parts = list(many.chunks([1, 2, 3], 3))
    assert [len(part) for part in parts] == [3, 3, 1]
    assert parts[0].concatenated(*parts[1:]) == whole
    own = np.arange(21.0).reshape(7, 3)
    first, *rest = many.chunks(own, 5)
    assert first.concatenated(*rest) == many.at(own)
    out = np.memmap(tmp_path / "states", np.float64, "w+", shape=(7, 3, 7))
    assert many.at([1, 2, 3], out=out) == whole
    np.testing.assert_array_equal(
        np.memmap(tmp_path / "states", np.float64, "r", shape=(7, 3, 7))[..., :3], whole.gamma
    )


def test_tops_and_deformations():
    top = ensemble(EulerTop((1, 2, 3)), [GAMMA, (0, 0, 1)], M, tilted=True)
    found = top.at([2, 5])
    np.testing.assert_array_equal(found.tau, [[2, 5], [2, 5]])
    assert set(found.ways) == {"short run"}
    tilde = Tilde((1, 2, 4), 0.7)
    found = ensemble(tilde, [GAMMA, (0, 0, 0)], M).at([1])
    assert found.status.tolist() == [0, 1]
    np.testing.assert_array_equal(found.gamma[0], tilde.flow(tilde.state(GAMMA, M)).at([1]).gamma)


def test_few_members_and_none():
    none = ensemble(BALL, np.empty((0, 3)), M)
    assert len(none) == 0
    assert none.at([1, 2]).gamma.shape == (0, 2, 3)
    assert ensemble(BALL, GAMMA, M).at([]).gamma.shape == (1, 0, 3)


def test_where_nothing_is_compiled(monkeypatch):
    monkeypatch.setattr("integrable.ensembles.bodies.interpreted", lambda: True)
    many = ensemble(BALL, GAMMA, M)
    found = many.at([1])
    assert abs(found.gamma[0] - many.flow(0).at([1]).gamma).max() < 1e-14


BAD = {
    "no system": (lambda: ensemble(3, GAMMA, M), "system = 3: "),
    "a class": (lambda: ensemble(ChaplyginBall, GAMMA, M), "give a system, such as ChaplyginBall("),
    "another field": (
        lambda: ensemble(ChaplyginBall((1, 2, 3), 1, field=MP(30)), GAMMA, M),
        "an ensemble is of floats",
    ),
    "a complex d": (lambda: ensemble(BALL, GAMMA, M, d=1j), "d = 1j: numbers of shape (K,) or one for all are needed"),
    "shapes": (lambda: ensemble(BALL, [GAMMA] * 2, [M] * 3), "gamma has 2, M has 3"),
    "two numbers": (lambda: ensemble(BALL, (1, 0), M), "gamma has shape (2,): shape (K, 3) or (3,) is needed"),
    "words": (lambda: ensemble(BALL, GAMMA, "M"), "M = 'M': numbers of shape (K, 3)"),
    "moments of a deformation": (lambda: ensemble(Tilde((1, 2, 4)), GAMMA, M, inertia=(1, 2, 3)), "inertia: Tilde"),
    "a rolling top": (lambda: ensemble(EulerTop((1, 2, 3)), GAMMA, M, d=0.5), "d = 0.5: an EulerTop has d = 0"),
    "times": (lambda: ensemble(BALL, GAMMA, [M] * 2).at(np.ones((3, 2))), "times have shape (3, 2): (N,) or (2, N)"),
    "infinite times": (lambda: ensemble(BALL, GAMMA, M).at([np.inf]), "finite numbers are needed"),
    "an out": (lambda: ensemble(BALL, GAMMA, M).at([1], out=np.ones(3)), "float64 of shape (1, 1, 7) is needed"),
    "an out of others": (
        lambda: ensemble(BALL, GAMMA, M).at([1], out=np.broadcast_to(0.0, (1, 1, 7))),
        "out is read-only: an array that can be written to is needed",
    ),
    "a member": (lambda: ensemble(BALL, GAMMA, M).flow(1), "member = 1: the members are 0 … 0"),
    "more than memory": (lambda: ensemble(BALL, GAMMA, [M] * 10**6).at(np.ones(10**6)), "take .chunks(times)"),
    "chosen": (lambda: ensemble(BALL, GAMMA, M)[[0, 1]], "[[0, 1]]: there are 1"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_calls(case):
    call, said = BAD[case]
    refuses(call, said)
