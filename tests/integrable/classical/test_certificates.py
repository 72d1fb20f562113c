"""Certificates of systems of any genus: digits that agree between a run and additions at more digits."""

from __future__ import annotations

import numpy as np
import pytest

from integrable.classical.kuzmin_kutuzov import KuzminKutuzov
from integrable.classical.neumann import Neumann
from integrable.classical.spherical_pendulum import SphericalPendulum
from integrable.mumford.flow import MumfordFlow
from jacobian import MP, RR
from jacobian.errors import ArgumentError, NotRepresentable, PrecisionLoss
from jacobian.immutable import replaced
from tests.integrable.classical.rows import REAL, distance, integrated

CASES = [
    ("neumann", 1), ("neumann", 3), ("ellipsoid", 2), ("garnier", 2), ("henon_heiles", 1), ("barriers", 2),
    ("toda", 3), ("lagrange", 3), ("pendulum", 3), ("galaxy", 3), ("veselova", 3), ("two_gaps", 2),
    # the ball's own certificates are tested in tests/integrable/motion
    pytest.param("ball", 3, marks=pytest.mark.slow),
]  # fmt: skip


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("name", "n"), CASES)
def test_states_are_certified_to_their_last_digits_near_and_far(name, n) -> None:
    system, state = REAL[name](RR, n)
    path = system.flow(state).certify([2.5, -7.0, 3e6])
    assert path.digits.shape == path.error.shape == (3,)
    # a float has a relative error of 1.1e-16, the compiled flow of a body somewhat more
    assert (path.error < (2e-15 if name == "ball" else 1.2e-16)).all()
    assert (path.digits >= (14 if name == "ball" else 15)).all()
    assert path.q.dtype == float


@pytest.mark.parametrize(("name", "n"), [("neumann", 2), ("toda", 3), ("pendulum", 3), ("galaxy", 3)])
def test_the_certified_error_is_the_distance_from_an_integration(name, n, monkeypatch) -> None:
    """``error`` of a run that is late is what an integrator of the same equations finds, too."""
    K = MP(25)
    system, state = REAL[name](K, n)
    true_at = MumfordFlow.at

    def late(flow, times):
        delay = "1e-9" if flow.digits == K.dps else 0
        return replaced(true_at(flow, [t + flow.system.field.coerce(delay) for t in times]), _times=np.array(times))

    monkeypatch.setattr(MumfordFlow, "at", late)
    path = system.flow(state).certify([K.coerce(1.25)], digits=6)
    truth = integrated(system, state, 1.25, 8, 17)
    apart = [distance(K, [x[0]], [y]) / max(map(abs, y)) for x, y in zip((path.q, path.p), truth, strict=True)]
    # the distance is relative to 1 + |y|
    assert 1e-11 < max(apart) < 1e-8
    assert 0.3 < path.error[0] / max(apart) < 3
    assert path.digits[0] in (8, 9)


def test_a_certificate_fails_where_the_run_is_wrong(monkeypatch) -> None:
    true_at = MumfordFlow.at

    def late(flow, times):
        late = 1e-5 if flow.system.field == RR else 0
        return replaced(true_at(flow, [t + late for t in times]), _times=np.array(times))

    monkeypatch.setattr(MumfordFlow, "at", late)
    system, state = REAL["neumann"](RR, 2)
    with pytest.raises(PrecisionLoss, match=r"times\[0\] = 1\.0.*agree to [345] digits, not to 12"):
        system.flow(state).certify([1.0])
    assert system.flow(state).certify([1.0], digits=3).digits[0] in (4, 5)


def test_many_digits_are_certified_at_more() -> None:
    system, state = REAL["garnier"](MP(30), 2)
    path = system.flow(state).certify([1, "1e6"])
    assert (path.digits >= 29).all()
    assert path.q.dtype == path.error.dtype == object


def test_a_pendulum_that_passes_rest_and_one_that_stays() -> None:
    """p = 0 at the start, where an error has no size to be relative to."""
    system = SphericalPendulum()
    swinging = system.flow(system.state((0.6, 0, -0.8), (0, 0, 0))).certify([0, 3.0])
    assert (swinging.digits >= 15).all()
    hanging = system.flow(system.state((0, 0, -1), (0, 0, 0))).certify([0, 3.0])
    assert (hanging.error == 0).all()
    assert (hanging.digits == 30).all()


def test_inputs_off_their_constraints_by_rounding_are_projected_in_both_runs() -> None:
    system = Neumann((1, 2, 4))
    q = np.array([0.48, 0.6, 0.64])
    p = np.array([0.3, -0.4, 0.0])
    p -= (q @ p) * q / (q @ q)
    path = system.flow(system.state(q * (1 + 4e-16), p)).certify([100.0])
    assert path.digits[0] >= 15


@pytest.mark.parametrize("digits", [0, 16, 2.5, True])
def test_digits_that_there_are_not(digits) -> None:
    system, state = REAL["toda"](RR, 3)
    with pytest.raises(ArgumentError, match=r"digits = .*1 to 15 digits"):
        system.flow(state).certify([1], digits=digits)


def test_an_unbound_star_has_no_second_run() -> None:
    galaxy = KuzminKutuzov((1.5, 1))
    star = galaxy.flow(galaxy.state((1.1, 0, 0.2), (2, 1, 1)))
    with pytest.raises(NotRepresentable, match="unbound"):
        star.certify([1.0])
