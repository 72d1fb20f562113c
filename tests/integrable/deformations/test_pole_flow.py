"""The tilde pair at d = 0 in repelling poles, as additions on two elliptic curves, against an integration."""

from __future__ import annotations

from copy import copy
from random import Random

import numpy as np
import pytest

from integrable import Check, Tilde
from integrable.deformations import quick_states
from integrable.deformations.carrier import CurvesCarrier
from integrable.deformations.integrated import IntegratedMotion
from integrable.deformations.pole_flow import PoleFlow
from integrable.motion.precise import RoundedRows
from integrable.mumford.elliptic_torus import EllipticOval
from integrable.phase.state import State
from jacobian import GF, MP, RR
from jacobian.errors import ArgumentError, NotRepresentable
from tests.integrable.deformations import additions
from tests.integrable.deformations.extrapolation import extrapolate

START = (("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
K = MP(30)


def case(poles, field=K, inertia=(1, 2, 4), start=START):
    number = float if field is RR else field.coerce
    system = Tilde(inertia, potential=(0, 0, *map(number, poles)), field=field)
    return system, system.state(*([number(x) for x in v] for v in start))


def motion(system):
    def rates(y):
        rate = system.vector_field(State(tuple(y[:3]), tuple(y[3:])))
        return [*rate.gamma, *rate.M]

    return rates


@pytest.mark.parametrize(
    ("poles", "pieces"), [(("0.02", "0.04", "0.06"), 6), pytest.param(("2", "4", "6"), 14, marks=pytest.mark.slow)]
)
def test_against_an_integration_at_thirty_digits(poles, pieces) -> None:
    """γ and M agree to 1e-25 at t = 1, and to the last digit at t = 0."""
    system, start = case(poles, MP(32))
    run = system.flow(start).at([1, 0])
    y = extrapolate(motion(system), [*start.gamma, *start.M], system.field.coerce(1), pieces=pieces)
    for row, truth in enumerate((y, [*start.gamma, *start.M])):
        assert max(abs(a - b) for a, b in zip((*run.gamma[row], *run.M[row]), truth, strict=True)) <= 1e-25


def test_random_starts_and_moments_keep_the_integrals_far_out() -> None:
    """H, K, |γ| and (γ, M) at t = 1000 and −1000; no γ_i changes its sign."""
    rng, done = Random(1), 0
    while done < 10:
        inertia = [rng.randint(1, 9) for _ in range(3)]
        if len(set(inertia)) < 3:
            continue
        x = np.array([rng.gauss(0, 1) for _ in range(3)])
        x /= np.linalg.norm(x)
        m = np.cross(x, [rng.gauss(0, 1) for _ in range(3)])
        system = Tilde(inertia, potential=(0, 0, *(rng.uniform(0.1, 3) for _ in range(3))))
        start = system.state(x.tolist(), m.tolist())
        run = system.flow(start).at([1000.0, -1000.0, 0.0, 7.0])
        done += 1
        assert (np.sign(run.gamma) == np.sign(x)).all()
        before = system.integrals(start)
        for gamma, M in zip(run.gamma, run.M, strict=True):
            after = system.integrals(State(tuple(gamma), tuple(M)))
            assert after == pytest.approx(before, rel=1e-9, abs=1e-9)
        assert np.abs(run.gamma[2] - x).max() < 1e-14
        assert np.abs(run.M[2] - m).max() < 1e-13


@pytest.mark.parametrize("size", [10**4, 10**5, 10**7])
def test_ovals_that_nearly_touch_do_not_end_the_motion(size) -> None:
    """The ovals are b/M² apart. States at t = 5/size agree to 1e-18 and rounding with an integration in the unit of
    time 1/size.
    """
    K = MP(20)
    poles, M = [K.coerce(b) for b in ("0.02", "0.04", "0.06")], [K.coerce(m) for m in START[1]]
    scaled, start = case([b / size / size for b in poles], K)
    truth = IntegratedMotion(scaled, start).at([5])
    system, fast = case(poles, K, start=(START[0], [size * m for m in M]))
    run = system.flow(fast).at([K.coerce(5) / size])
    assert abs(run.gamma - truth.gamma).max() <= 1e-18
    assert abs(run.M / size - truth.M).max() <= 1e-18
    floats, same = case((0.02, 0.04, 0.06), RR, start=(START[0], [size * m for m in M]))
    again = floats.flow(same).at([5 / size])
    assert np.abs(again.gamma - truth.gamma.astype(float)).max() < 1e-14


@pytest.mark.parametrize("digits", [15, 40, 80])
def test_the_motion_of_large_momenta_that_was_refused(digits) -> None:
    """|M| = 2e5 at t = 5e-5, at 15, 40 and 80 digits: H and K to the last digits."""
    K = RR if digits == 15 else MP(digits)
    system, start = case(("0.02", "0.04", "0.06"), K, start=(START[0], ("38400", "128000", "-148800")))
    run = system.flow(start).at([5e-5])
    (before, after) = (system.integrals(x)[2:] for x in (start, State(tuple(run.gamma[0]), tuple(run.M[0]))))
    assert all(abs(x - y) <= 10 ** (3 - digits) * abs(x) for x, y in zip(before, after, strict=True))


def test_an_equilibrium_is_no_end_of_the_motion() -> None:
    """M = 0 at the minimum of the potential: up to rounding each oval is a point, and the state does not move."""
    context = K.context
    system = Tilde((1, 2, 4), potential=[K.coerce(x) for x in (0, 0, 2, 4, 6)], field=K)

    def state(x, y):
        length = context.sqrt(1 + x * x + y * y)
        return State((1 / length, x / length, y / length), (K.zero,) * 3)

    x, y = context.findroot(lambda x, y: list(system.vector_field(state(x, y)).M[1:]), (1, 1))
    found = state(x, y)
    start = system.state(found.gamma, found.M)
    run = system.motion_through(start).at([0, 1, 1e9])
    assert run.way == "elliptic curves"
    assert all(abs(g - e) < 1e-28 for row in run.gamma for g, e in zip(row, start.gamma, strict=True))


def test_floats_are_the_rounded_multiprecision_run() -> None:
    times = [0.5, -3.0, 100.0]
    runs = [system.flow(start).at(times) for system, start in (case((2, 4, 6), RR), case((2, 4, 6)))]
    assert runs[0].gamma.dtype == np.float64
    assert np.abs(runs[0].gamma - runs[1].gamma.astype(float)).max() < 1e-12
    assert np.abs(runs[0].M - runs[1].M.astype(float)).max() < 1e-11


def test_the_flow_is_what_motion_through_takes() -> None:
    system, start = case((2, 4, 6))
    found = system.motion_through(start)
    assert isinstance(found, PoleFlow)
    assert found.method == "elliptic curves"
    assert system.repels
    assert not system.separates


@pytest.mark.parametrize(
    "system",
    [
        Tilde((1, 2, 4), potential=(0, 0, 2, 4, -6)),
        Tilde((1, 2, 4), potential=(0, 0, 2, 4, 0)),
        Tilde((1, 2, 4), potential=(1, 0, 2, 4, 6)),
        Tilde((1, 2, 4), potential=(0, 1, 2, 4, 6)),
        Tilde((1, 2, 4), 0.5, potential=(0, 0, 2, 4, 6)),
        Check((1, 2, 4), potential=(0, 0, 2, 4, 6)),
        Tilde((1, 2, 4), potential=(0, 0, 2, 4, 6), field=GF(10007)),
    ],
    ids=repr,
)
def test_other_potentials_have_no_flow(system) -> None:
    with pytest.raises(ArgumentError, match="no separated curves are used"):
        system.flow(State((0, 0, 1), (1, 1, 0)))


def test_equal_moments_and_infinite_potentials_are_refused() -> None:
    system, start = case((2, 4, 6), inertia=(1, 1, 4))
    with pytest.raises(NotRepresentable, match="equal"):
        system.flow(start)
    assert system.motion_through(start).method == "integrated"
    at_pole = Tilde((1, 2, 4), potential=(0, 0, 2, 4, 6))
    with pytest.raises(NotRepresentable, match="infinite"):
        at_pole.flow(at_pole.state((1, 0, 0), (0, 1, 1)))


TAU = np.array([0, -0.37, 1e-9, 3.25, -41.5, 1234.5678, 9e4])


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e5])
@pytest.mark.parametrize("inertia", [(1, 2, 4), (4, 1, 2), (0.3, 7, 2.5)])
def test_compiled_states_are_those_of_additions_in_many_digits(size, inertia, monkeypatch) -> None:
    start = START[0], [str(size * float(m)) for m in START[1]]
    system, state = case([size**2 * b for b in (0.3, 0.4, 0.5)], RR, inertia, start)
    flow = system.flow(state)
    with monkeypatch.context() as changed:
        changed.setattr(EllipticOval, "moved", additions.moved)
        changed.setattr(CurvesCarrier, "_state", additions.state)
        readable = flow._curves.at_tau(TAU / size)

    def unwanted(*_):
        raise AssertionError("the compiled loops have been given up")

    monkeypatch.setattr(RoundedRows, "at_tau", unwanted)
    found = flow.at_tau(TAU / size)
    for rows, true in ((found.gamma, readable[:, :3]), (found.M, readable[:, 3:])):
        assert np.abs(rows - true).max() <= 2.3e-16 * np.abs(true).max()


@pytest.mark.parametrize("spoiled", ["moment", "pole", "sign", "lambda", "H"])
def test_numbers_that_are_off_go_the_readable_way(spoiled, monkeypatch) -> None:
    """A constant of the compiled loops is changed by one part in 10¹⁵, or a sign: the states come from many digits."""
    system, state = case((0.3, 0.4, 0.5), RR)
    truth = system.flow(state)._curves.at_tau(TAU)

    def changed(carrier, right=quick_states.packed):
        other, frame, more = copy(carrier), carrier.frame, 1 + 1e-15
        constants, before = [*carrier.inner.constants], right(carrier).before
        if spoiled in ("moment", "pole"):
            constants[0 if spoiled == "moment" else 7] *= more
            other.inner = carrier.inner._of_constants(carrier.field, constants)
        elif spoiled == "sign":
            other.frame = frame._replace(signs=(-frame.signs[0], *frame.signs[1:]))
        elif spoiled == "lambda":
            other.frame = frame._replace(lambdas=(frame.lambdas[0] * more, frame.lambdas[1]))
        else:
            before = before * [[1 + 1e-15], [1.0]]
        return right(other)._replace(before=before)

    monkeypatch.setattr(quick_states, "packed", changed)
    found = system.flow(state).at_tau(TAU)
    assert np.array_equal(np.hstack([found.gamma, found.M]), truth)
