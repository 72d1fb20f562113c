"""Results of the laboratory as arrays: files read back by their usual libraries, slices, joins, pickles."""

import json
import pickle
import re

import numpy as np
import pytest

from integrable import RigidBody, RollingBall, laboratory_ensemble
from integrable.files.writing import FORMATS
from jacobian import MP
from jacobian.errors import ArgumentError, NotRepresentable
from tests.integrable.files.test_saved import needs

OMEGA = (1.0, -2.0, 0.5)
BALL = RollingBall([[0.11, 0.01, 0], [0.01, 0.12, 0.02], [0, 0.02, 0.13]], 1.3, 0.5)
MOTION = BALL.motion(np.eye(3), OMEGA, (0.3, -0.2))
RUN = MOTION.at([0, 0.5, 2, 1e6])
MANY = laboratory_ensemble(BALL, [np.eye(3), 2 * np.eye(3), np.eye(3)], [OMEGA, OMEGA, (2.0, 1.0, 0.5)]).at([0, 1.5])
FREE = RigidBody((1, 2, 3)).motion(np.eye(3), OMEGA)


def read_back(path):
    """({name: array}, the description of the whole file)."""
    if path.suffix in (".nc", ".zarr"):
        xarray = pytest.importorskip("xarray")
        store = {"engine": "zarr", "consolidated": False} if path.suffix == ".zarr" else {}
        with xarray.open_dataset(path, **store) as data:
            return {name: data[name].values for name in data.variables}, data.attrs
    if path.suffix == ".h5":
        with pytest.importorskip("h5py").File(path) as file:
            return {name: file[name][()] for name in file}, dict(file.attrs)
    if path.suffix == ".mat":
        found = pytest.importorskip("scipy.io").loadmat(path, simplify_cells=True)
        return found, found["attributes"]
    pandas = pytest.importorskip("pandas")
    if path.suffix == ".parquet":
        table = pandas.read_parquet(path)
        return table, table.attrs
    said = dict(line[2:].split(": ", 1) for line in path.read_text(encoding="utf-8").splitlines() if line[0] == "#")
    # numbers read by Python's ``float``, whatever the version of pandas
    return pandas.read_csv(path, comment="#", dtype=str).map(float), {k: json.loads(v) for k, v in said.items()}


@pytest.mark.parametrize("result", [RUN, MANY], ids=["run", "members"])
@pytest.mark.parametrize("suffix", FORMATS)
def test_files_are_read_back(suffix, result, tmp_path):
    needs(suffix)
    path = tmp_path / f"ball{suffix}"
    result.save(path)
    found, said = read_back(path)
    for name, parts in {"quaternion": "wxyz", "omega": "xyz", "contact": "xy"}.items():
        values = getattr(result, name)
        if suffix in (".parquet", ".csv"):
            got = np.stack([found[f"{name}_{part}"].to_numpy() for part in parts], axis=-1).reshape(values.shape)
        else:
            got = np.asarray(found[name])
        np.testing.assert_array_equal(got, values, name)
    assert (said["system"], said["mass"], said["radius"]) == ("RollingBall", 1.3, 0.5)
    np.testing.assert_array_equal(np.reshape(said["axes"], (3, 3)).T, BALL.axes)
    assert list(said["inertia"]) == list(BALL.moments)
    assert [item.name for item in tmp_path.iterdir()] == [path.name]


def test_centres_of_many_are_those_of_each():
    np.testing.assert_array_equal(MANY.centre[2], MANY[2].centre)
    assert np.isnan(MANY.centre[1]).all()
    with pytest.raises(ValueError, match="read-only"):
        MANY.centre[0, 0, 2] = 1


def test_datasets():
    pytest.importorskip("xarray")
    data = RUN.to_xarray(["omega_body", "centre"])
    assert set(data.data_vars) == {"omega_body", "centre"}
    assert data.centre.dims == ("time", "axis")
    assert (data.centre.attrs["units"], data.time.attrs["units"]) == ("m", "s")
    assert set(FREE.at([0, 1]).to_xarray().data_vars) == {"quaternion", "omega"}
    many = MANY.to_xarray()
    assert many.sel(member=2).omega.shape == (2, 3)
    assert many.status.values.tolist() == [0, 1, 0]
    assert "R Rᵀ differs from 1" in json.loads(many.attrs["reasons"])[0]
    assert MANY.to_xarray("centre").centre.shape == (3, 2, 3)
    own = laboratory_ensemble(BALL, np.eye(3), [OMEGA, OMEGA]).at([[0, 1], [2, 3]])
    assert own.to_xarray().time.dims == ("member", "row")


def test_more_digits_are_written_to_csv(tmp_path):
    pandas = pytest.importorskip("pandas")
    run = RigidBody((1, 2, 3), field=MP(30)).motion(np.eye(3), ("1", "-2", "0.5")).at(["0.1"])
    run.save(tmp_path / "run.csv", "omega")
    (found,) = pandas.read_csv(tmp_path / "run.csv", comment="#", dtype=str)["omega_x"]
    assert abs(MP(30).coerce(found) - run.omega[0, 0]) < 1e-29
    with pytest.raises(ArgumentError, match=r"numbers of MP\(30\) are written to .csv only"):
        run.save(tmp_path / "run.nc")


def test_parts_of_a_run():
    assert len(RUN[1:]) == 3
    assert np.array_equal(RUN[1:].matrices, RUN.matrices[1:])
    assert np.array_equal(RUN[RUN.times > 1].contact, RUN.contact[2:])
    assert RUN[-1].time == 1e6
    assert np.array_equal(RUN[1].matrix, RUN.matrices[1])
    assert np.array_equal([at.contact for at in RUN], RUN.contact)
    assert FREE.at([2])[0].contact is None
    assert RUN[:1].concatenated(RUN[1:3], RUN[3:]) == RUN
    assert np.array_equal(RUN[:1].concatenated(RUN[1:]).omega, RUN.omega)
    assert np.array_equal(MOTION.at([0, 1, 2])[[2, 0]].matrices, MOTION.at([2, 0]).matrices)
    again = pickle.loads(pickle.dumps(RUN))
    assert again == RUN
    assert np.array_equal(again.contact, RUN.contact)


def test_joined_members():
    both = MANY[:1].concatenated(MANY[1:], MANY[2:])
    assert both.status.tolist() == [0, 1, 0, 0]
    assert both.reasons == MANY.reasons
    assert both[:3] == MANY
    assert np.array_equal(both[3].contact, MANY[2].contact)
    other = laboratory_ensemble(BALL, np.eye(3), OMEGA).at([0, 2.5])
    assert MANY[:1].concatenated(other).times.tolist() == [[0, 1.5], [0, 2.5]]
    assert pickle.loads(pickle.dumps(both)) == both


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: RUN.save("run.mat", "gamma"), "quantities: 'gamma' given; choose among quaternion, omega, omega_body"),
        (lambda: RUN[4], "row = 4"),
        (lambda: RUN["a"], "row = 'a'"),
        (lambda: RUN[[7]], "there are 4"),
        (lambda: RUN.concatenated(FREE.at([0])), "runs of the same motion are needed"),
        (lambda: RUN.concatenated(3), "others: 3 given"),
        (lambda: MANY.concatenated(RUN), "the same body and number of times are needed"),
        (lambda: MANY.concatenated(laboratory_ensemble(BALL, np.eye(3), OMEGA).at([0])), "number of times are needed"),
    ],
)
def test_bad_input_is_named_in_one_line(call, said):
    with pytest.raises(ArgumentError, match=re.escape(said)) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_a_free_body_has_no_contact():
    pytest.importorskip("xarray")
    with pytest.raises(NotRepresentable, match="it has no point of contact"):
        FREE.at([0]).to_xarray("contact")
    with pytest.raises(NotRepresentable, match="it has no point of contact"):
        laboratory_ensemble(RigidBody((1, 2, 3)), np.eye(3), OMEGA).at([0]).to_xarray("contact")
