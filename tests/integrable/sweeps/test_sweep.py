"""Sweeps: every member is computed once and equals the serial result to the bit, whatever fails in between."""

import os
import re
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor

import numpy as np
import pytest

import integrable
from integrable import ChaplyginBall, ensemble, load_scene
from integrable.__main__ import main
from integrable.sweeps.grid import Grid, from_words
from integrable.sweeps.sweep import SweepStopped, sweep
from jacobian import ArgumentError

GAMMA, M = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)
TEXT = """
system = "chaplygin_ball"
[body]
inertia = [1, 2, 3]
d = "0.7"
[start]
gamma = ["0.48", "0.6", "0.64"]
M = ["0.384", "1.28", "-1.488"]
[run]
times = [0, 1, "2.5"]
"""
VARY = {"d": "-0.5:2:6", "M.scale": [0.5, 1, 3]}
needs_zarr = pytest.mark.skipif("not __import__('importlib').util.find_spec('zarr')", reason="zarr is not installed")
needs_hdf5 = pytest.mark.skipif("not __import__('importlib').util.find_spec('h5py')", reason="h5py is not installed")
SUFFIXES = [pytest.param(".zarr", marks=needs_zarr), pytest.param(".h5", marks=needs_hdf5)]


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "ball.toml"
    path.write_text(TEXT, encoding="utf-8")
    return load_scene(path)


def read(path):
    """{name: array} and attributes."""
    if path.suffix == ".zarr":
        import zarr

        group = zarr.open_group(path, mode="r")
        return {name: group[name][...] for name in group.array_keys()}, dict(group.attrs)
    import h5py

    with h5py.File(path) as file:
        return {name: file[name][()] for name in file}, dict(file.attrs)


def serial(vary=VARY):
    """The members of VARY, one by one."""
    first, last, count = (float(x) for x in vary["d"].split(":"))
    d = np.repeat(np.linspace(first, last, int(count)), 3)
    return ensemble(ChaplyginBall((1, 2, 3), 0.7), GAMMA, np.tile(vary["M.scale"], int(count))[:, None] * M, d=d)


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("executor", ["threads", pytest.param("processes", marks=pytest.mark.slow)])
def test_a_sweep_is_the_serial_result(scene, suffix, executor, tmp_path):
    found = sweep(scene, vary=VARY, out=tmp_path / f"out{suffix}", executor=executor, chunk=5)
    wanted = serial().at([0, 1, 2.5])
    arrays, attributes = read(found.path)
    np.testing.assert_array_equal(arrays["gamma"], wanted.gamma)
    np.testing.assert_array_equal(arrays["M"], wanted.M)
    np.testing.assert_array_equal(arrays["tau"], wanted.tau)
    np.testing.assert_array_equal(arrays["time"], [0, 1, 2.5])
    np.testing.assert_array_equal(arrays["status"][:, 0] > 0, serial().d < 0)
    np.testing.assert_array_equal(arrays["M_scale"], [0.5, 1, 3] * 6)
    assert (found.members, found.refused) == (18, 3) == (18, attributes["refused"])
    assert "d = -0.5 is negative" in attributes["reasons"]
    assert not (tmp_path / f"out{suffix}.part").exists()
    again = sweep(scene, vary=VARY, out=found.path, executor=Dead(), chunk=5)
    assert again == found


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_sweeps_are_datasets(scene, suffix, tmp_path):
    pytest.importorskip("xarray")
    found = sweep(scene, vary={"inertia.2": [2, 2.5]}, out=tmp_path / f"out{suffix}", executor="threads")
    with found.to_xarray() as data:
        assert data.gamma.dims == ("member", "time", "axis")
        assert data.inertia_2.values.tolist() == [2, 2.5]
        assert data.M.attrs["units"] == "kg m2 s-1"
        assert data.gamma.sel(time=2.5).shape == (2, 3)


@needs_zarr
def test_an_ensemble_is_swept(tmp_path):
    many = serial()
    found = sweep(many, times=[1, 2], out=tmp_path / "out.zarr", executor="threads", chunk=4)
    arrays, _ = read(found.path)
    np.testing.assert_array_equal(arrays["gamma"], many.at([1, 2]).gamma)
    np.testing.assert_array_equal(arrays["d"], many.d)


@needs_zarr
def test_a_chunk_of_more_members_than_there_are_is_one_chunk(tmp_path):
    """An int of 5001 digits raised Python's own ValueError; a sweep begun with one number goes on with the other."""
    many, out = serial(), tmp_path / "out.zarr"
    found = sweep(many, times=[1, 2], out=out, executor="threads", chunk=10**5000)
    assert sweep(many, times=[1, 2], out=out, executor=Dead(), chunk=len(many)) == found
    np.testing.assert_array_equal(read(out)[0]["gamma"], many.at([1, 2]).gamma)


@needs_zarr
def test_deformations_are_swept(tmp_path):
    path = tmp_path / "tilde.toml"
    path.write_text(TEXT.replace("chaplygin_ball", "tilde").replace("[1, 2, 3]", "[1, 2, 4]"), encoding="utf-8")
    found = sweep(path, vary={"d": [0.7, -1]}, out=tmp_path / "out.zarr", executor="threads")
    arrays, attributes = read(found.path)
    np.testing.assert_array_equal(arrays["gamma"][0], integrable.run(path).gamma)
    assert arrays["status"].tolist() == [[0, 0, 0], [1, 1, 1]]
    assert "d = -1" in attributes["reasons"]


def test_more_digits_are_refused(tmp_path):
    path = tmp_path / "ball.toml"
    path.write_text(TEXT + "digits = 30\n", encoding="utf-8")
    with pytest.raises(ArgumentError, match="scene ball: digits = 30; a sweep is of floats"):
        Grid(load_scene(path), {})


def test_mass_and_radius(tmp_path):
    path = tmp_path / "ball.toml"
    path.write_text(TEXT.replace('d = "0.7"', "mass = 2\nradius = 0.5"), encoding="utf-8")
    rows = Grid(load_scene(path), {"radius": [0.5, 2]}).rows(0, 2)
    assert rows[:, 3].tolist() == [0.5, 8]
    with pytest.raises(ArgumentError, match="vary: 'd' given"):
        Grid(load_scene(path), {"d": [1]})


class Dead(Executor):
    """An executor that ends after some jobs."""

    def __init__(self, after=0):
        self.left, self._max_workers = after, 1

    def submit(self, function, /, *arguments, **options):
        self.left -= 1
        future = Future()
        if self.left < 0:
            future.set_exception(RuntimeError("the cluster\nis gone"))
        else:
            future.set_result(function(*arguments, **options))
        return future


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_an_executor_that_dies(scene, suffix, tmp_path):
    out = tmp_path / f"out{suffix}"
    with pytest.raises(SweepStopped, match=r"^executor: it has stopped \(RuntimeError: the cluster is gone\); \d of 6"):
        sweep(scene, vary=VARY, out=out, executor=Dead(2), chunk=3)
    assert not out.exists()
    counted = Counting(1)
    sweep(scene, vary=VARY, out=out, executor=counted, chunk=3)
    assert counted.jobs == 4
    np.testing.assert_array_equal(read(out)[0]["gamma"], serial().at([0, 1, 2.5]).gamma)


class Counting(ThreadPoolExecutor):
    jobs = 0

    def submit(self, *arguments, **options):
        self.jobs += 1
        return super().submit(*arguments, **options)


KILLED = """
import sys, time
from concurrent.futures import ThreadPoolExecutor
import integrable
from integrable.sweeps import sweep
class Slow(ThreadPoolExecutor):
    def submit(self, *arguments):
        time.sleep(0.2)
        return super().submit(*arguments)
integrable.sweep(sys.argv[1], vary={"d": "0:2:200"}, out=sys.argv[2], executor=Slow(1), chunk=2)
"""


@pytest.mark.parametrize("suffix", [SUFFIXES[0], pytest.param(".h5", marks=[needs_hdf5, pytest.mark.slow])])
def test_a_killed_sweep_goes_on(scene, suffix, tmp_path):
    out = tmp_path / f"out{suffix}"
    journal = tmp_path / f"out{suffix}.part" / "journal.json"
    running = subprocess.Popen([sys.executable, "-c", KILLED, str(tmp_path / "ball.toml"), str(out)])
    try:
        begun = time.monotonic()
        while not (journal.exists() and '"done": [0, 1, 2' in journal.read_text()):
            assert running.poll() is None
            assert time.monotonic() - begun < 300
            time.sleep(0.05)
        with pytest.raises(ArgumentError, match="another sweep is writing to it"):
            sweep(scene, vary={"d": "0:2:200"}, out=out, executor="threads", chunk=2)
    finally:
        running.send_signal(signal.SIGKILL if hasattr(signal, "SIGKILL") else signal.SIGTERM)
        running.wait()
    counted = Counting(2)
    sweep(scene, vary={"d": "0:2:200"}, out=out, executor=counted, chunk=2)
    assert counted.jobs < 98
    many = ensemble(ChaplyginBall((1, 2, 3), 0.7), GAMMA, M, d=[float(f"{2 * k / 199!r}") for k in range(200)])
    np.testing.assert_allclose(read(out)[0]["gamma"], many.at([0, 1, 2.5]).gamma, atol=1e-14)
    arrays = read(out)[0]
    assert (arrays["way"] > 0).all()
    whole = sweep(scene, vary={"d": "0:2:200"}, out=tmp_path / f"whole{suffix}", executor="threads", chunk=64)
    for name, values in read(whole.path)[0].items():
        np.testing.assert_array_equal(arrays[name], values)


FULL = """
import resource, sys
import integrable
from jacobian.errors import ArgumentError
vary = {"d": "0:2:40"}
# what is compiled and imported is written before
integrable.sweep(sys.argv[1], vary=vary, out=sys.argv[2] + ".first" + sys.argv[3], executor="threads", chunk=40)
# a limit would cut short what Python keeps of imported modules as well, for every process after this one
sys.dont_write_bytecode = True
resource.setrlimit(resource.RLIMIT_FSIZE, (1500, 1500))
try:
    integrable.sweep(sys.argv[1], vary=vary, out=sys.argv[2], executor="threads", chunk=40)
except ArgumentError as error:
    print(error)
"""


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_full_disk_is_one_line(scene, suffix, tmp_path):
    """The operating system refuses files of more than 1500 bytes; the chunk is computed again when there is space."""
    pytest.importorskip("resource")
    out = tmp_path / f"out{suffix}"
    words = [sys.executable, "-c", FULL, str(tmp_path / "ball.toml"), str(out), suffix]
    done = subprocess.run(words, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    (line,) = done.stdout.splitlines()
    assert line.startswith(f"out = {str(out)!r} cannot be written: ")
    assert not out.exists()
    found = sweep(scene, vary={"d": "0:2:40"}, out=out, executor="threads", chunk=40)
    first = read(tmp_path / f"out{suffix}.first{suffix}")[0]
    for name, values in read(found.path)[0].items():
        np.testing.assert_array_equal(values, first[name])


def test_words():
    assert from_words(["d=1:2:3", "M.scale=1,2"]) == {"d": "1:2:3", "M.scale": "1,2"}
    for words in (["d"], ["=1"], ["d=1", "d=2"]):
        with pytest.raises(ArgumentError, match="--vary "):
            from_words(words)


def test_values(scene):
    grid = Grid(scene, {"d": "0.1:0.3:3", "inertia.1": "1/3,1e-1", "inertia.scale": "1:100:3:log"})
    assert grid.shape == (3, 2, 3)
    assert [values.tolist() for values in grid.axes.values()] == [[0.1, 0.2, 0.3], [1 / 3, 0.1], [1, 10, 100]]
    row = grid.rows(4, 5)[0]
    np.testing.assert_array_equal(row[:4], [1.0, 20.0, 30.0, 0.1])
    assert len(Grid(scene, {})) == 1


BAD = {
    "a name": (lambda s, out: sweep(s, vary={"q": [1]}, out=out), "vary: 'q' given; "),
    "a value too large": (lambda s, out: sweep(s, vary={"d": [10**400]}, out=out), "numbers, or "),
    "no values": (lambda s, out: sweep(s, vary={"d": []}, out=out), "vary: d = []: finite numbers are needed"),
    "a range": (lambda s, out: sweep(s, vary={"d": "1:2"}, out=out), "vary: d=1:2: first:last:count"),
    "no such spacing": (lambda s, out: sweep(s, vary={"d": "1:2:3:lg"}, out=out), "vary: d=1:2:3:lg: first:last:count"),
    "a word": (lambda s, out: sweep(s, vary={"d": "x"}, out=out), "vary: d=x: "),
    "infinity": (lambda s, out: sweep(s, vary={"d": [np.inf]}, out=out), "finite numbers are needed"),
    "no mapping": (lambda s, out: sweep(s, vary=3, out=out), "vary = 3: "),
    "a suffix": (lambda s, out: sweep(s, out=out.with_suffix(".nc")), "a name that ends with .zarr or .h5 is needed"),
    "an executor": (lambda s, out: sweep(s, out=out, executor="dask"), "executor = 'dask': "),
    "a chunk": (lambda s, out: sweep(s, out=out, chunk=0), "chunk = 0: an int ≥ 1"),
    "times of a scene": (lambda s, out: sweep(s, times=[1], out=out), "a scene has its times"),
    "an ensemble without times": (lambda s, out: sweep(serial(), out=out), "times = None: "),
    "an orbit": (lambda s, out: sweep("keyless", out=out), "has [steps]"),
    "nothing": (lambda s, out: sweep(3, out=out), "what = 3: "),
    "too many": (
        lambda s, out: sweep(s, vary={"d": "0:1:20000", "M.1": "0:1:20000"}, out=out),
        "members; 1e+08 at most",
    ),
}


@needs_zarr
@pytest.mark.parametrize("case", BAD)
def test_bad_calls(case, scene, tmp_path):
    call, said = BAD[case]
    with pytest.raises(ArgumentError, match=re.escape(said)):
        call(scene, tmp_path / "out.zarr")
    assert [path.name for path in tmp_path.iterdir()] == ["ball.toml"]


@needs_zarr
def test_another_sweep_is_not_gone_on_with(scene, tmp_path):
    out = tmp_path / "out.zarr"
    with pytest.raises(SweepStopped):
        sweep(scene, vary=VARY, out=out, executor=Dead(1), chunk=3)
    with pytest.raises(ArgumentError, match="has the chunks of another sweep"):
        sweep(scene, vary={"d": [1]}, out=out, executor="threads", chunk=3)
    sweep(scene, vary=VARY, out=out, executor="threads", chunk=3)
    with pytest.raises(ArgumentError, match="another file is there"):
        sweep(scene, vary={"d": [1]}, out=out, executor="threads")


@needs_zarr
def test_the_command(scene, tmp_path, capsys):
    out = str(tmp_path / "out.zarr")
    words = ["sweep", str(tmp_path / "ball.toml"), "--vary", "d=-1:1:3", "--out", out, "--executor", "threads"]
    assert main(words) == 0
    assert capsys.readouterr().out == f"3 motions, 1 of them refused\n\nwritten to {out}\n"
    assert main([*words[:2], "--vary", "dd=1"]) == 2
    assert capsys.readouterr().err.startswith("integrable: error: vary: 'dd' given; did you mean")


@needs_zarr
@pytest.mark.slow
def test_loky(scene, tmp_path):
    loky = pytest.importorskip("loky")
    executor = loky.get_reusable_executor(max_workers=2)
    found = sweep(scene, vary=VARY, out=tmp_path / "out.zarr", executor=executor, chunk=5)
    executor.shutdown()
    np.testing.assert_array_equal(read(found.path)[0]["gamma"], serial().at([0, 1, 2.5]).gamma)


@needs_zarr
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_dask_with_a_worker_killed(tmp_path):
    """10⁵ motions on a cluster of two local workers, one of which is killed on the way."""
    distributed = pytest.importorskip("distributed")
    rng = np.random.default_rng(4)
    count = 100_000
    many = ensemble(
        ChaplyginBall((1, 2, 3), 0.7), GAMMA, M, inertia=rng.uniform(1, 3, (count, 3)), d=rng.uniform(-0.01, 1, count)
    )
    times, killed = [0, 1, 2], []
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        executor = Killing(client.get_executor(), lambda: killed.append(kill_one(client)))
        found = sweep(many, times=times, out=tmp_path / "out.zarr", executor=executor, chunk=1000)
    assert len(killed) == 1
    arrays, _ = read(found.path)
    wanted = many.at(times)
    for name in ("gamma", "M", "tau"):
        np.testing.assert_array_equal(arrays[name], getattr(wanted, name))
    np.testing.assert_array_equal(arrays["status"][:, 0] > 0, many.d < 0)
    assert found.members == count
    assert found.refused == np.count_nonzero(many.d < 0)


def kill_one(client):
    pid = next(iter(client.run(os.getpid).values()))
    os.kill(pid, signal.SIGKILL)
    return pid


class Killing(Executor):
    """Another executor, with an action after forty jobs."""

    def __init__(self, other, action):
        self._other, self._action, self._count = other, action, 0

    def submit(self, function, /, *arguments, **options):
        self._count += 1
        if self._count == 40:
            self._action()
        return self._other.submit(function, *arguments, **options)
