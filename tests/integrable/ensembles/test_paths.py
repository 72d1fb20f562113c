"""Ensembles of systems of any genus agree with single flows, member by member, even if other members are refused."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from integrable import ChaplyginBall, ensemble, sweep
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.kuzmin_kutuzov import KuzminKutuzov
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.ensembles import paths
from integrable.mumford.flow import MumfordFlow
from integrable.systems.on_layer import BodyOnLayer
from jacobian import MP, RR, ArgumentError
from jacobian.numbers.threads import set_threads
from tests.integrable.classical.rows import REAL


def on_sphere(rng, count, size):
    q, p = rng.normal(size=(2, count, size))
    q /= np.linalg.norm(q, axis=1)[:, None]
    return q, p - (p * q).sum(axis=1)[:, None] * q


@pytest.fixture(params=[1, 2])
def threads(request):
    set_threads(request.param)
    yield
    set_threads(None)


@pytest.mark.thinned(5)
@pytest.mark.parametrize("name", ["neumann", "toda", "pendulum", "garnier"])
def test_members_are_single_flows_to_the_bit(name, threads) -> None:
    rng = np.random.default_rng(3)
    system, _ = REAL[name](RR, 3)
    q, p = (
        on_sphere(rng, 3, system.size) if name in ("neumann", "pendulum") else rng.normal(size=(2, 3, system.size)) / 2
    )
    many = ensemble(system, q, p)
    times = np.array([0.0, -3, 20, 1e5, 1e5 + 1, 2e5, 3e5])
    found = many.at(times)
    assert len(many) == len(found) == 3
    assert found.q.shape == found.p.shape == (3, 7, system.size)
    for k in range(3):
        path = system.flow(system.state(q[k], p[k])).at(times)
        np.testing.assert_array_equal(found.q[k], path.q)
        np.testing.assert_array_equal(found.p[k], path.p)
        assert found.ways[k] == path.way
        assert found[k] == path


@pytest.mark.parametrize(
    ("name", "tolerance", "times"),
    [
        ("neumann", None, np.linspace(0, 180, 41)),
        ("neumann", 1e-12, np.linspace(0, -60, 31)),
        ("toda", None, np.array([3.0, -2, 0, 70, -90, 5, 5, 0.25])),
        ("toda", 1e-12, np.random.default_rng(1).uniform(-40, 40, (11, 5))),
    ],
)
def test_members_that_walk_together_are_single_flows_to_the_bit(name, tolerance, times, monkeypatch) -> None:
    """Their steps have different lengths, and some members need finer steps or a torus."""
    rng = np.random.default_rng(5)
    system, _ = REAL[name](RR, 2)
    q, p = on_sphere(rng, 11, system.size) if name == "neumann" else rng.normal(size=(2, 11, system.size)) / 2
    many = ensemble(system, q, p, tolerance=tolerance)
    alone = [many.flow(k).at(times if times.ndim == 1 else times[k]) for k in range(11)]
    monkeypatch.setattr(paths, "MANY", 2)
    monkeypatch.setattr(MumfordFlow, "at", None)
    assert list(many.at(times)) == alone
    if times.max() == 180:
        assert {path.way for path in alone} == {"series", "series, torus"}


def test_members_may_have_times_of_their_own() -> None:
    system = TodaLattice(3)
    q, p = np.zeros(3), np.array([[1, 0, -1], [0.5, 0.5, -1]])
    times = np.array([[0, 1.0, 2.0], [5.0, -6.0, 7.0]])
    many = ensemble(system, q, p)
    found = many.at(times)
    np.testing.assert_array_equal(found.times, times)
    np.testing.assert_array_equal(found[1].q, many[1].at(times[1]).q)
    np.testing.assert_array_equal(found[1:].times, times[1])


def test_a_refused_member_does_not_affect_the_others() -> None:
    system = Neumann((1, 2, 4))
    q = np.array([[0.6, 0.48, 0.64], [1.0, 1.0, 0.0], [0.6, 0.48, 0.64]])
    found = ensemble(system, q, (0.4, -0.5, 0.0)).at([0, 10])
    assert found.status.tolist() == [0, 1, 0]
    assert "|q| = 1 is needed" in found.reasons[1]
    assert np.isnan(found.q[1]).all()
    np.testing.assert_array_equal(found.q[0], found.q[2])
    assert len(found.kept) == 2
    assert found.kept.ways == found.ways[::2]
    with pytest.raises(ArgumentError, match=r"member 1 was refused: q, p = "):
        found[1]


def test_rows_that_are_refused_stop_no_other() -> None:
    """The far motion of a star that is not bound is unknown."""
    many = ensemble(KuzminKutuzov((1.5, 1)), (1.1, 0, 0.2), [(0.1, 0.4, 0.35), (2, 1, 1)])
    near = many.at([0, 1.0])
    assert not near.status.any()
    found = many.at([0, 1e6, 1.0])
    assert found.status.tolist() == [0, 1]
    assert found.row_status(1).tolist() == [0, 1, 0]
    assert "unbound" in found.reasons[1]
    assert np.isnan(found.p[1, 1]).all()
    np.testing.assert_array_equal(found.q[1, [0, 2]], near.q[1])
    assert np.isfinite(found.p[0]).all()
    assert found.ways == [found.ways[0], "series"]
    with pytest.raises(ArgumentError, match=r"member 1 was refused: .*unbound"):
        found[1]
    far = many.at([1e6])
    assert far.ways[1] == ""
    assert far[::-1].status.tolist() == [1, 0]


def test_results_go_to_an_array_in_chunks_and_joined(tmp_path) -> None:
    system, times = TodaLattice(2), [1.0, 2.0, 30.0]
    many = ensemble(system, (0, 0), np.random.default_rng(1).normal(size=(5, 2)))
    whole, room = many.at(times), np.lib.format.open_memmap(tmp_path / "states.npy", "w+", float, (5, 3, 4))
    found = many.at(times, out=room)
    assert found == whole
    np.testing.assert_array_equal(np.load(tmp_path / "states.npy"), np.concatenate([whole.q, whole.p], axis=2))
    parts = list(many.chunks(times, 2))
    assert [len(part) for part in parts] == [2, 2, 1]
    joined = parts[0].concatenated(*parts[1:])
    assert joined == whole
    assert joined.ensemble == many
    assert joined.estimates.tolist() == whole.estimates.tolist()
    with pytest.raises(ArgumentError, match="Paths of the same system and number of times are needed"):
        whole.concatenated(ensemble(system, (0, 0), (0, 1), tolerance=1e-9).at(times))
    with pytest.raises(ArgumentError, match=r"float64 of shape \(5, 3, 4\) is needed"):
        many.at(times, out=np.empty((5, 3, 7)))


def test_files_have_q_and_p_their_status_way_and_estimate(tmp_path) -> None:
    system = Neumann((1, 2, 4))
    found = ensemble(system, [(0.6, 0.48, 0.64), (1, 1, 0)], (0.4, -0.5, 0.0)).at([0, 10])
    data = found.to_xarray()
    assert data.q.dims == ("member", "time", "coordinate")
    np.testing.assert_array_equal(data.p.values[0], found.p[0])
    assert data.status.values.tolist() == [[0, 0], [1, 1]]
    assert data.way.values.tolist() == [1, 0]
    assert list(data.attrs["a"]) == [1, 2, 4]
    assert data.estimate.values[0] == found.estimates[0]
    table = found.to_dataframe(["q"])
    assert [name for name in table if name.startswith(("q", "p"))] == ["q_0", "q_1", "q_2"]
    found.save(tmp_path / "paths.csv")
    assert "|q| = 1 is needed" in (tmp_path / "paths.csv").read_text()


@pytest.mark.parametrize("suffix", [".zarr", ".h5"])
def test_a_sweep_has_the_states_of_the_ensemble(suffix, tmp_path) -> None:
    pytest.importorskip("zarr" if suffix == ".zarr" else "h5netcdf")
    many = ensemble(KuzminKutuzov((1.5, 1)), (1.1, 0, 0.2), [(0.1, 0.4, 0.35), (2, 1, 1), (0.1, 0.4, 0.3)])
    times = [0, 1.0, 1e6]
    found, out = many.at(times), tmp_path / f"stars{suffix}"
    swept = sweep(many, times=times, out=out, executor="threads", chunk=2)
    assert (swept.members, swept.refused) == (3, 1)
    data = swept.to_xarray()
    np.testing.assert_array_equal(data.q.values, found.q)
    np.testing.assert_array_equal(data.p.values, found.p)
    np.testing.assert_array_equal(data.p_start.values, many.p)
    assert data.status.values.tolist() == [found.row_status(k).tolist() for k in range(3)]
    assert [data.way.attrs["flag_meanings"].split("; ")[way] for way in data.way.values] == found.ways
    with pytest.raises(ArgumentError, match="another file is there"):
        sweep(ensemble(many.system, many.q, many.p, tolerance=1e-9), times=times, out=out, executor="threads", chunk=2)


def test_a_tolerance_is_that_of_the_flows() -> None:
    system = TodaLattice(3)
    many = ensemble(system, np.zeros(3), np.array([[1, 0, -1], [0.5, 0.5, -1]]), tolerance=1e-9)
    found, times = many.at([0, 30.0]), [0, 30.0]
    assert many[0].tolerance == 1e-9
    np.testing.assert_array_equal(found.q[1], system.flow(system.state((0, 0, 0), (0.5, 0.5, -1)), 1e-9).at(times).q)
    assert found[1].estimate == found.estimates[1]


def test_equal_ensembles_and_results_are_equal_and_can_be_pickled() -> None:
    system = TodaLattice(2)
    many, again = (ensemble(system, (0, 0), [(1, 0), (0, 2)]) for _ in range(2))
    assert many == again == pickle.loads(pickle.dumps(many))
    assert many != ensemble(system, (0, 0), [(1, 0), (0, 3)])
    assert many.at([1.0]) == again.at([1.0]) == pickle.loads(pickle.dumps(again.at([1.0])))
    assert many[:1] == ensemble(system, [(0, 0)], [(1, 0)])
    assert [flow.start.p for flow in many] == [(1.0, 0.0), (0.0, 2.0)]
    with pytest.raises(ValueError, match="read-only"):
        many.q[0] = 1


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: ensemble(Neumann((1, 2, 4), MP(20)), (1, 0, 0), (0, 1, 0)), "an ensemble is of floats"),
        (lambda: ensemble(TodaLattice(3), (1, 0), (0, 1)), r"q has shape \(2,\): shape \(K, 3\) or \(3,\) is needed"),
        (lambda: ensemble(TodaLattice(2), np.zeros((3, 2)), np.zeros((2, 2))), "do not broadcast: q has 3, p has 2"),
        (lambda: ensemble(TodaLattice(2), (0, 0), (0, 1), d=1), "inertia, d, tilted: all members have the constants"),
        (lambda: ensemble(TodaLattice(2), (0, 0), (0, 1), tolerance=2), "tolerance = 2: a number between"),
        (lambda: ensemble(ChaplyginBall((1, 2, 3), 1), (0, 0, 1), (0, 1, 0), tolerance=1e-9), "tolerance = 1e-09"),
        (lambda: ensemble(TodaLattice(2), (0, 0), (0, 1)).at([np.inf]), "finite numbers are needed"),
        (lambda: ensemble(TodaLattice(2), (0, 0), (0, 1)).at(np.zeros((2, 3, 1))), r"\(N,\) or \(1, N\) is needed"),
        (lambda: ensemble(HenonHeiles((1,)), (0, 0), np.zeros((10**6, 2))).at(np.zeros(10**7)), "GB; take .chunks"),
        (lambda: ensemble(TodaLattice(2), (0, 0), (0, 1)).flow(-1), r"member = -1: the members are 0 … 0"),
    ],
)
def test_what_is_refused_by_name(call, said) -> None:
    with pytest.raises(ArgumentError, match=said):
        call()


def test_no_member_and_no_time() -> None:
    system = TodaLattice(2)
    assert ensemble(system, np.zeros((0, 2)), (0, 1)).at([1.0]).q.shape == (0, 1, 2)
    assert ensemble(system, (0, 0), (0, 1)).at([]).q.shape == (1, 0, 2)


def test_a_body_described_as_a_system():
    """The ways of a body's own flow, such as short runs, have their names in the outcome too."""
    ball = BodyOnLayer((1, 2, 3), 0.7)
    found = ensemble(ball, (0.48, 0.6, 0.64), [(0.384, 1.28, -1.488), (-0.384, -1.28, 1.488)]).at([0.5, 2])
    one = ball.flow(ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))).at([0.5, 2])
    assert (found[0].way, found[0].q.tolist()) == (one.way, one.q.tolist())
