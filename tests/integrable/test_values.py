"""Public objects are values: they are immutable, compare by content, and survive pickle and copy."""

import copy
import pickle
from functools import cache

import numpy as np
import pytest

import integrable
from integrable import ChaplyginBall, Trajectory
from jacobian import RR, NotRepresentable
from jacobian.immutable import Immutable, Record
from tests.integrable.public_values import FIELDS, GAMMA, M, other_values, systems_over, values_over
from tests.jacobian.test_values import assert_sealed, descendants

KINDS = (*FIELDS, "others")


@cache
def values(kind):
    """{what: value} of a field of FIELDS, or those of other fields. They take seconds, so none is made on import."""
    return values_over(FIELDS[kind]) if kind in FIELDS else other_values()


# internal number types and chunks of sweeps, never returned to users
INSIDE = {"Arrays", "Balls", "Columns", "_Operators", "SymbolField", "PairField", "Scenes"}
ARRAYS = ("times", "tau", "gamma", "M", "omega", "attitude", "quaternion", "contact", "error", "digits", "radius")
ARRAYS += (
    "ratios",
    "covariance",
    "lines",
    "phi",
    "momentum",
    "theta",
    "matrices",
    "omega_body",
    "centre",
    "matrix",
    "secular",
    "periodic",
)


def test_the_table_holds_every_public_class():
    kinds = {type(value) for kind in KINDS for value in values(kind).values()}
    for name in integrable.__all__:
        named = getattr(integrable, name)
        assert not isinstance(named, type) or named in kinds, name
    leaves = {kind for kind in descendants(Immutable) if not kind.__subclasses__()}
    ours = {kind.__name__ for kind in leaves if kind.__module__.startswith("integrable.")}
    assert ours - INSIDE <= {kind.__name__ for kind in kinds}


@pytest.mark.parametrize("kind", KINDS)
def test_pickles_and_copies_are_equal(kind):
    for what, value in values(kind).items():
        for again in (pickle.loads(pickle.dumps(value)), copy.deepcopy(value), copy.copy(value)):
            assert type(again) is type(value), what
            assert (again == value) is True, what
            assert hash(again) == hash(value), what
        assert (value == "something else") is False, what


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_can_be_set_or_deleted(kind):
    for value in values(kind).values():
        assert_sealed(value)


@pytest.mark.parametrize("kind", KINDS)
def test_arrays_of_results_cannot_be_written_to(kind):
    results = {what: value for what, value in values(kind).items() if isinstance(value, Record) or "orbit" in what}
    assert results
    for value in results.values():
        for run in (value, pickle.loads(pickle.dumps(value))):
            found = [_asked(run, name) for name in ARRAYS]
            if isinstance(run, Trajectory):
                found += [*run.integrals]
            for array in found:
                if array is not None:
                    with pytest.raises(ValueError, match="read-only"):
                        array[0] = array[0]


def _asked(run, name):
    """A quantity of a run; None where the system does not have it."""
    try:
        return getattr(run, name, None)
    except NotRepresentable:
        assert not what_rolls(run)
        return None


def what_rolls(run):
    return type(run) is Trajectory and isinstance(run.system, ChaplyginBall)


@pytest.mark.parametrize("kind", FIELDS)
def test_what_went_in_may_change_afterwards(kind):
    K = FIELDS[kind]
    number = np.float64 if K == RR else object
    inertia, gamma, momentum = [1, 2, 4], [K.coerce(x) for x in GAMMA], np.array([K.coerce(x) for x in M], dtype=number)
    ball = ChaplyginBall(inertia, "0.7", field=K)
    state = ball.state(gamma, momentum)
    times = np.array([K.coerce(1), K.coerce(2)], dtype=number)
    flow = ball.flow(state)
    runs = [flow.at(times), flow.at_tau(times), systems_over(K)["tilde"].flow(state).at(times)]
    kept = pickle.dumps([run.times for run in runs])
    inertia[0], gamma[0], momentum[0], times[:] = 7, K.zero, K.zero, K.zero
    assert ball == values(kind)["ball"]
    assert state == values(kind)["state"]
    assert pickle.dumps([run.times for run in runs]) == kept


def test_balls_of_two_radii_are_two():
    small, large = ChaplyginBall((1, 2, 3), mass=1, radius=1), ChaplyginBall((1, 2, 3), mass="1/4", radius=2)
    assert small.d == large.d
    assert small != large


def test_motions_and_runs_that_differ_compare_as_different():
    ball = systems_over(RR)["ball"]
    state, other = ball.state(GAMMA, M), ball.state(GAMMA, ("-48/125", "-32/25", "186/125"))
    assert ball.flow(state) == ball.flow(state) != ball.flow(other)
    assert ball.flow(state, kernel="python") != ball.flow(state)
    flow = ball.flow(state)
    assert flow.at([1, 2]) == flow.at([1, 2]) != flow.at([1, 3])
    assert flow.at([1]) != flow.certify([1])


def test_a_flow_in_another_process_goes_on():
    flow = values("RR")["flow"]
    again = pickle.loads(pickle.dumps(flow))
    assert again is not flow
    assert (again.at([3.0, 100.0]).gamma == flow.at([3.0, 100.0]).gamma).all()


@pytest.mark.parametrize("kind", KINDS)
def test_a_value_says_what_it_is(kind):
    """Flows, paths and enclosures had Python's default text, a module and an address."""
    for what, value in values(kind).items():
        assert " object at 0x" not in repr(value), what
