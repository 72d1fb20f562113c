"""Vectors, matrices and times of other libraries are taken by value; unordered collections are refused."""

import numpy as np
import pytest

from integrable import ChaplyginBall, RigidBody, RollingBall, ensemble, laboratory_ensemble
from jacobian import QQ, HyperellipticCurve
from jacobian.errors import JacobianError

BALL = ChaplyginBall((1, 2, 3), 0.7)
STATE = BALL.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
TENSOR = np.array([[0.11, 0.01, 0], [0.01, 0.12, 0.02], [0, 0.02, 0.13]])


def test_tables_of_pandas_are_read_by_value_and_not_by_label():
    """A DataFrame iterates over its labels: the labels 1, 2, 3 used to be taken for three moments without an error."""
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame(TENSOR, columns=[1, 2, 3], index=[1, 2, 3])
    assert RigidBody(table) == RigidBody(TENSOR)
    assert RigidBody((1, 2, 3)).motion(pandas.DataFrame(np.eye(3)), (1, 2, 3)).at([1]).times.tolist() == [1]
    times = pandas.Series([1.0, 2.0], index=[7, 9])
    assert BALL.flow(STATE).at(times) == BALL.flow(STATE).at([1.0, 2.0])
    with pytest.raises(JacobianError, match=r"times\[0\] = array\(\[5\.\]\)"):
        BALL.flow(STATE).at(pandas.DataFrame([5.0, 6.0]))


def test_arrays_of_xarray():
    xarray = pytest.importorskip("xarray")
    assert RigidBody(xarray.DataArray(TENSOR)) == RigidBody(TENSOR)
    assert ChaplyginBall(xarray.DataArray([1.0, 2.0, 3.0]), 0.7) == BALL


@pytest.mark.parametrize(
    "call",
    [
        lambda given: BALL.flow(STATE).at(given([1.0, 2.0])),
        lambda given: BALL.state(given([0.48, 0.6, 0.64]), STATE.M),
        lambda given: RigidBody(given(np.diag([1.0, 2.0, 3.0]))),
        lambda given: RollingBall(TENSOR, 1.3, 0.5).motion(np.eye(3), given([1.0, 2.0, 3.0])),
        lambda given: ensemble(BALL, STATE.gamma, given([[0.384, 1.28, -1.488]])),
        lambda given: laboratory_ensemble(RollingBall(TENSOR, 1.3, 0.5), np.eye(3), given([[1.0, 2.0, 3.0]])),
        lambda given: HyperellipticCurve(QQ, given([1, 0, 0, 0, 0, 1])),
    ],
)
@pytest.mark.parametrize(
    "given",
    [
        lambda rows: np.ma.array(rows, mask=np.arange(np.size(rows)).reshape(np.shape(rows)) == 1),
        lambda rows: set(np.ravel(rows).tolist()),
        lambda rows: dict.fromkeys(np.ravel(rows).tolist()),
    ],
    ids=["masked", "set", "dict"],
)
def test_what_has_holes_or_no_order_is_refused(call, given):
    with pytest.raises(JacobianError) as caught:
        call(given)
    assert "\n" not in str(caught.value)


def test_masked_arrays_without_holes_are_arrays():
    assert BALL.flow(STATE).at(np.ma.array([1.0, 2.0])) == BALL.flow(STATE).at([1.0, 2.0])


def test_members_are_indexed():
    many = ensemble(BALL, STATE.gamma, STATE.M, d=[0.7, 0.8])
    assert many[-1].system.d == 0.8
    assert [flow.system.d for flow in many] == [0.7, 0.8]
    ball = RollingBall(TENSOR, 1.3, 0.5)
    starts = laboratory_ensemble(ball, np.eye(3), [(1, 2, 3), (3, 2, 1)])
    assert starts[1] == ball.motion(np.eye(3), (3, 2, 1))
    assert list(starts) == [starts.motion(0), starts.motion(1)]
    for group in (many, starts):
        with pytest.raises(JacobianError, match="member = 2: the members are 0 … 1"):
            group[2]


@pytest.mark.parametrize("which", [[[0], [0, 1]], np.ma.array([0, 1], mask=[False, True])], ids=["ragged", "masked"])
def test_what_chooses_nothing_is_refused(which):
    """Ragged lists raised numpy's ValueError; a masked array selected the rows that its mask hides."""
    many = ensemble(BALL, STATE.gamma, STATE.M, d=[0.7, 0.8])
    starts = laboratory_ensemble(RollingBall(TENSOR, 1.3, 0.5), np.eye(3), [(1, 2, 3), (3, 2, 1)])
    results = [many.at([0, 1]), starts.at([0, 1]), starts[0].at([0, 1]), BALL.flow(STATE).at([0, 1])]
    for group in (many, starts, *results):
        with pytest.raises(JacobianError, match="an int, a slice, or an array of ints or truth values is needed"):
            group[which]
