"""The conditioning of a motion, compared with known derivatives."""

from __future__ import annotations

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop, Gyroscopic, load_scene
from integrable.motion.conditioning import conditioning
from jacobian import GF, MP, RR
from jacobian.errors import ArgumentError

GAMMA, M = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)


def test_at_time_zero_the_sensitivity_is_that_of_the_inputs_themselves():
    top = EulerTop((1, 2, 3))
    found = conditioning(top, top.state(GAMMA, M), [0.0])
    # γ_i(1 + h) on the unit sphere: ∂γ = γ_i(e_i − γ_iγ), its largest component; M does not enter γ
    expected = sum(max(abs(x * ((j == i) - x * GAMMA[j])) for j in range(3)) for i, x in enumerate(GAMMA))
    assert found.gamma == pytest.approx(expected, rel=1e-6)
    assert {name for name, part in found.inputs.items() if part > 1e-6} == {"γ1", "γ2", "γ3"}
    assert found.floor() == (pytest.approx(2**-52 * found.gamma), pytest.approx(2**-52 * found.M))


def test_a_free_symmetric_top_turns_in_proportion_to_its_inputs():
    # I1 = I2: M precesses at the rate Ω = M3(1/I1 − 1/I3), so ∂M/∂ log M3 at t is Ωt·|M⊥| to leading order
    top, t = EulerTop((1, 1, 2)), 1000.0
    gamma, momentum = (0.0, 0.6, 0.8), (1.0, 0.8, -0.6)
    found = conditioning(top, top.state(gamma, momentum), [t])
    rate, across, size = 0.6 * 0.5, np.hypot(1.0, 0.8), np.sqrt(2.0)
    assert 0.5 < found.M / (rate * t * across / size) < 20


@pytest.mark.parametrize("d", ["0.7", "0"])
def test_floats_and_multiprecision_agree(d):
    K, found = MP(30), []
    for field in (RR, K):
        numbers = [field.coerce(float(x)) for x in (*GAMMA, *M)]
        system = ChaplyginBall((1, 2, 3), float(d), field=field) if float(d) else EulerTop((1, 2, 3), field=field)
        length = field.sqrt(field.dot(numbers[:3], numbers[:3]))
        gamma = [x / length for x in numbers[:3]]
        tilt = field.dot(gamma, numbers[3:])
        state = system.state(gamma, [m - tilt * x for m, x in zip(numbers[3:], gamma, strict=True)])
        found.append(conditioning(system, state, [field.coerce(3)]))
    assert found[0].gamma == pytest.approx(found[1].gamma, rel=1e-4)
    assert pytest.approx(found[1].M, rel=1e-4) == found[0].M


def test_it_grows_in_proportion_to_time_and_zeros_are_exact():
    ball = ChaplyginBall((1, 2, 3), 0.7)
    state = ball.state((0.6, 0.0, 0.8), (0.8, 0.5, -0.6))
    near, far = (conditioning(ball, state, [t]) for t in (100.0, 800.0))
    assert 3 < far.gamma / near.gamma < 20
    assert "γ2" not in far.inputs
    assert {"I1", "I2", "I3", "d", "γ1", "γ3", "M1", "M2", "M3"} == set(far.inputs)


def test_parameters_of_a_deformation_are_inputs():
    system, state = load_scene("gyroscopic").start(15)
    assert isinstance(system, Gyroscopic)
    assert {"I1", "c", "γ1", "M1"} <= set(conditioning(system, state, [0.25]).inputs)


def test_a_motion_of_ones_own():
    ball = ChaplyginBall((1, 2, 3), 0.7)

    def still(_system, state, times):
        return np.array([state.gamma] * len(times)), np.array([state.M] * len(times))

    assert conditioning(ball, ball.state(GAMMA, M), [1.0, 2.0], still).gamma < 3


@pytest.mark.parametrize("field", [RR, MP(20)], ids=str)
def test_without_times_nothing_grows(field):
    ball = ChaplyginBall((1, 2, 3), 1, field=field)
    found = conditioning(ball, ball.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488")), [])
    assert (found.gamma, found.M) == (0, 0)


def test_an_exact_field_is_refused():
    top = EulerTop((1, 2, 4), field=GF(10007))
    with pytest.raises(ArgumentError, match=r"field = GF\(10007\).*needs a motion over RR or MP"):
        conditioning(top, top.state((1, 0, 0), (0, 1, 0)), [1])
