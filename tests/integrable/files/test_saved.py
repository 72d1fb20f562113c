"""Results as files, each read back by its usual library; no partial files."""

import json
import re
import subprocess
import sys
from importlib.util import find_spec

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop, Tilde, ensemble
from integrable.files.writing import FORMATS
from integrable.scene.orbit import orbit
from jacobian import MP, ArgumentError
from jacobian.errors import NotRepresentable

GAMMA, M = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)
BALL = ChaplyginBall((1, 2, 3), 0.7)
STATE = BALL.state(GAMMA, M)
RUN = BALL.flow(STATE).at([0, 0.5, 1e30, 2], strict=False)
MANY = ensemble(BALL, GAMMA, M, d=[0.7, -1, 0.5]).at([0, 1.5])
OWN = ensemble(BALL, GAMMA, M, d=[0.7, 0.5]).at([[0, 1.5], [1, 2]])
RESULTS = {"run": RUN, "members": MANY, "members at times of their own": OWN}


def wanted(result):
    """{name: array}, the content that a file must have."""
    return {
        "time": result.times,
        "gamma": result.gamma,
        "M": result.M,
        "tau": result.tau,
        "omega": result._along("omega") if result is not RUN else omega_of_run(),
    }


def omega_of_run():
    found = np.full((4, 3), np.nan)
    found[RUN.status == 0] = RUN.kept.omega
    return found


def read_by_xarray(path):
    xarray = pytest.importorskip("xarray")
    with xarray.open_zarr(path, consolidated=False) if path.suffix == ".zarr" else xarray.open_dataset(path) as data:
        data.load()
    arrays = {name: data[name].values for name in ("time", "gamma", "M", "tau", "omega")}
    units = {name: data[name].attrs["units"] for name in ("time", "M")}
    return arrays, units, data.attrs


def read_by_h5py(path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(path) as file:
        arrays = {name: file[name][()] for name in ("time", "gamma", "M", "tau", "omega")}
        units = {name: file[name].attrs["units"] for name in ("time", "M")}
        return arrays, units, dict(file.attrs)


def unstacked(table, shape):
    """The arrays of a table with a row for each state."""
    names = {"gamma": 3, "M": 3, "omega": 3}
    arrays = {
        name: np.stack([table[f"{name}_{i + 1}"].to_numpy() for i in range(n)], axis=-1).reshape(*shape, n)
        for name, n in names.items()
    }
    times = table.index.get_level_values("time").to_numpy()
    return {**arrays, "tau": table["tau"].to_numpy().reshape(shape), "time": times.reshape(shape)}


def read_by_pandas(path, shape):
    pandas = pytest.importorskip("pandas")
    if path.suffix == ".parquet":
        table = pandas.read_parquet(path)
        attributes = table.attrs
    else:
        lines = path.read_text(encoding="utf-8").splitlines()
        attributes = dict(line[2:].split(": ", 1) for line in lines if line.startswith("# "))
        attributes = {name: json.loads(value) for name, value in attributes.items()}
        # numbers read by Python's ``float``, whatever the version of pandas
        table = pandas.read_csv(path, comment="#", dtype=str).map(float)
        table = table.set_index(["member", "time"] if len(shape) == 2 else "time")
    units = {"time": attributes["units"]["time"], "M": attributes["units"]["M_1"]}
    return unstacked(table, shape), units, attributes


def read_by_scipy(path):
    scipy_io = pytest.importorskip("scipy.io")
    found = scipy_io.loadmat(path, simplify_cells=True)
    arrays = {name: found[name] for name in ("time", "gamma", "M", "tau", "omega")}
    return arrays, found["units"], found["attributes"]


@pytest.mark.parametrize("what", RESULTS)
@pytest.mark.parametrize("suffix", FORMATS)
def test_files_are_read_back(suffix, what, tmp_path):
    result, path = RESULTS[what], tmp_path / f"result{suffix}"
    needs(suffix)
    result.save(path)
    readers = {
        ".h5": read_by_h5py,
        ".parquet": lambda path: read_by_pandas(path, result.tau.shape),
        ".csv": lambda path: read_by_pandas(path, result.tau.shape),
        ".mat": read_by_scipy,
    }
    arrays, units, attributes = readers.get(suffix, read_by_xarray)(path)
    for name, values in wanted(result).items():
        shape = values.shape
        if name == "time" and suffix in (".parquet", ".csv"):
            values = np.broadcast_to(values, result.tau.shape)
            shape = values.shape
        np.testing.assert_array_equal(arrays[name].reshape(shape), values, name)
    assert (units["time"], units["M"]) == ("s", "kg m2 s-1")
    assert attributes["system"] == "ChaplyginBall"
    assert attributes["source"].startswith("jacobian-integrable ")
    assert list(attributes["inertia"]) == [1, 2, 3]
    assert json.loads(attributes["reasons"]) == list(result.reasons[1:])
    assert [item.name for item in tmp_path.iterdir()] == [path.name]


def needs(suffix):
    for module in FORMATS[suffix].modules:
        pytest.importorskip(module)


def test_a_file_takes_the_place_of_the_old_one(tmp_path):
    for suffix in FORMATS:
        needs(suffix)
        path = tmp_path / f"result{suffix}"
        RUN.save(path)
        MANY.save(path)
        assert [item.name for item in tmp_path.iterdir()] == [path.name]
        assert suffix != ".nc" or read_by_xarray(path)[0]["gamma"].shape == (3, 2, 3)
        (__import__("shutil").rmtree if path.is_dir() else type(path).unlink)(path)


def test_quantities_and_other_systems(tmp_path):
    pytest.importorskip("xarray")
    data = BALL.flow(STATE).at([0, 1]).to_xarray(["contact", "quaternion"])
    assert data.contact.dims == ("time", "direction")
    assert set(data.data_vars) == {"contact", "quaternion", "tau", "status"}
    assert MANY.to_xarray("contact").contact.shape == (3, 2, 2)
    top = EulerTop((1, 2, 3))
    assert top.flow(top.state(GAMMA, M)).at([1]).to_xarray().attrs["d"] == 0
    tilde = Tilde((1, 2, 4), 0.7)
    assert tilde.flow(tilde.state(GAMMA, M)).at([1]).to_xarray().attrs["system"] == "Tilde"
    steps = orbit(BALL.keyless(), STATE, 3).to_xarray(["gamma"])
    assert steps.time.attrs["long_name"] == "number of the step"


def test_frames():
    pytest.importorskip("pandas")
    table = MANY.to_dataframe()
    assert table.index.names == ["member", "time"]
    assert table.loc[(2, 1.5), "gamma_3"] == MANY.gamma[2, 1, 2]
    assert table.attrs["units"]["omega_2"] == "rad s-1"
    assert RUN.to_dataframe("gamma").loc[0.5, "gamma_1"] == RUN.gamma[1, 0]


@pytest.mark.parametrize("none", [RUN[:0], MANY[:0], MANY.ensemble.at([])])
def test_frames_of_nothing(none):
    pytest.importorskip("pandas")
    table = none.to_dataframe()
    assert len(table) == 0
    assert {"gamma_1", "M_3", "omega_2", "tau", "status"} <= set(table.columns)


def test_more_digits_are_written_to_csv(tmp_path):
    pandas = pytest.importorskip("pandas")
    ball = ChaplyginBall((1, 2, 3), "0.7", field=MP(30))
    run = ball.flow(ball.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))).at([0, 1])
    run.save(tmp_path / "run.csv", "gamma")
    found = pandas.read_csv(tmp_path / "run.csv", comment="#", dtype=str)
    digits = [ball.field.context.mpf(x) for x in found["gamma_2"]]
    assert abs(digits[1] - run.gamma[1, 1]) < 1e-29
    with pytest.raises(ArgumentError, match=r"run.nc': numbers of MP\(30\) are written to .csv only"):
        run.save(tmp_path / "run.nc")
    assert [item.name for item in tmp_path.iterdir()] == ["run.csv"]


def test_bad_calls(tmp_path, monkeypatch):
    folder = tmp_path / "there.zarr"
    folder.mkdir()
    for call, said in (
        (lambda: RUN.save("run.xls"), "path = 'run.xls': a name that ends with one of .nc, .h5, .zarr, .parquet, .csv"),
        (lambda: RUN.save(3), "path = 3: give the path of a file"),
        (lambda: RUN.save(tmp_path / "none" / "run.mat"), "give a file in a folder that exists"),
        (lambda: RUN.save(tmp_path / f"{300 * 'a'}.mat"), "cannot be written: File name too long"),
        (lambda: RUN.save(tmp_path / "run.mat", "gama"), "quantities: 'gama' given; choose among gamma, M, omega"),
        (lambda: RUN.save(tmp_path / "run.mat", 3), "quantities = 3: "),
    ):
        with pytest.raises(ArgumentError, match=re.escape(said)):
            call()
    monkeypatch.setattr("integrable.extras.installed", lambda module: module not in ("zarr", "pyarrow"))
    with pytest.raises(ArgumentError, match=r"needs pyarrow, which is not installed: pip install .*\[io\]"):
        RUN.save(tmp_path / "run.parquet")
    monkeypatch.undo()
    if all(__import__("importlib").util.find_spec(name) for name in FORMATS[".zarr"].modules):
        with pytest.raises(ArgumentError, match=r"a folder is there that is no \.zarr store"):
            RUN.save(folder)


FULL = """
import resource, sys
from pathlib import Path
from integrable import ChaplyginBall
ball = ChaplyginBall((1, 2, 3), 0.7)
run = ball.flow(ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))).at([k / 400 for k in range(400)])
from jacobian.errors import ArgumentError
# what is imported and compiled is written before
for path in sys.argv[1:]:
    run.save(Path(path).with_stem("first"))
# a limit would cut short what Python keeps of imported modules as well, for every process after this one
sys.dont_write_bytecode = True
resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))
for path in sys.argv[1:]:
    try:
        run.save(path)
    except ArgumentError as error:
        print(error)
"""


@pytest.fixture(scope="module")
def full(tmp_path_factory):
    """{suffix: (path, what was said)} of a process whose files may have three kilobytes at most, as on a full disk."""
    pytest.importorskip("resource")
    able = [suffix for suffix, made in FORMATS.items() if all(map(find_spec, made.modules))]
    paths = [tmp_path_factory.mktemp("full") / f"run{suffix}" for suffix in able]
    command = [sys.executable, "-c", FULL, *map(str, paths)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return dict(zip(able, zip(paths, done.stdout.splitlines(), strict=True), strict=True))


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_full_disk_leaves_what_was_there(suffix, full):
    needs(suffix)
    path, line = full[suffix]
    assert line.startswith(f"path = {str(path)!r} cannot be written: ")
    assert [item.name for item in path.parent.iterdir()] == [f"first{suffix}"]


def test_rows_of_a_run():
    assert (RUN[1].gamma == RUN.gamma[1]).all()
    assert RUN[-1] == RUN[3]
    with pytest.raises(NotRepresentable, match="row 2 was refused: time 1e"):
        RUN[2]
    assert RUN[[0, 1, 3]].kept == RUN.kept
    assert RUN[RUN.status == 0] == RUN[[0, 1, 3]]
    assert RUN[1:].status.tolist() == [0, 1, 0]
    assert RUN[:1].concatenated(RUN[1:3], RUN[3:]) == RUN
    flow = RUN.flow
    both = flow.at([1.0]).concatenated(flow.at_tau([2.0]))
    assert both.times[1] == flow.physical_time([2.0])[0]
    assert flow.at_tau([1, 2])[1:].given_in_tau
    with pytest.raises(ArgumentError, match="the same system and the same start"):
        RUN.concatenated(EulerTop((1, 2, 3)).flow(EulerTop((1, 2, 3)).state(GAMMA, M)).at([1]))
    with pytest.raises(ArgumentError, match="there are 4"):
        RUN[[4]]


def test_rows_without_a_refused_one():
    part = RUN[:2]
    assert part == RUN.kept[:2]
    np.testing.assert_array_equal(part.omega, RUN.kept.omega[:2])


def test_rows_of_an_orbit():
    steps = orbit(BALL.keyless(), STATE, 3)
    assert steps[2] == steps.states[2]
    assert steps[1:].states == steps.states[1:]
    assert type(steps[1:]) is type(steps)
    with pytest.raises(NotRepresentable, match="concatenated: "):
        steps.concatenated(steps)
