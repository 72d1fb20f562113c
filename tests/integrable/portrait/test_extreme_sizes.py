"""Motions whose |M| is near or beyond the range of floats: results, or refusals by name."""

from __future__ import annotations

import numpy as np
import pytest

from integrable import ChaplyginBall, Check, EulerTop, Gyroscopic, Hat, Tilde
from jacobian import MP, RR
from jacobian.errors import FieldError, NotRepresentable, PrecisionLoss

K = MP(30)
GAMMA, M = ("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488")
BODIES = {"ball": lambda K: ChaplyginBall((1, 2, 3), "0.7", field=K), "top": lambda K: EulerTop((1, 2, 3), field=K)}
PAIRS = {
    "tilde": lambda K: Tilde((1, 2, 4), field=K),
    "check": lambda K: Check((1, 2, 4), field=K),
    "hat": lambda K: Hat((1, 2, 4), field=K),
    "poles": lambda K: Tilde((1, 2, 4), potential=(0, 0, 8, 8, 8), field=K),
    "gyroscopic": lambda K: Gyroscopic((1, 2, 4), 1, field=K),
}


def motion(made, size, field=K):
    system, unit = made(field), field.coerce(size)
    return system.motion_through(system.state(GAMMA, [unit * field.coerce(x) for x in M]))


@pytest.mark.parametrize("name", BODIES)
def test_sections_of_bodies_whose_momentum_is_no_float(name) -> None:
    for size in ("1e-400", "1e400"):
        with pytest.raises(NotRepresentable, match=r"section: \|M\| = "):
            motion(BODIES[name], size).section(2)
    one, small, large = (motion(BODIES[name], size).section(2) for size in ("1", "1e-300", "1e300"))
    for other in (small, large):
        assert abs(one.run.gamma - other.run.gamma).max() < 1e-25
        assert abs(one.momentum - other.momentum).max() < 1e-15


@pytest.mark.parametrize("size", ["1e-400", "1e400"])
@pytest.mark.parametrize("name", BODIES)
def test_sensitivities_to_numbers_that_are_no_floats(name, size) -> None:
    with pytest.raises(PrecisionLoss, match="beyond the range of floats"):
        motion(BODIES[name], size).sensitivity([1 / K.coerce(size)])


@pytest.mark.parametrize("name", ["tilde", "check", "hat"])
def test_rates_of_pairs_that_are_no_floats(name) -> None:
    flow = motion(PAIRS[name], "1e300")
    with pytest.raises(PrecisionLoss, match="the rates of this motion"):
        flow.sensitivity([1e-300])
    with pytest.raises(PrecisionLoss, match="beyond the range of floats"):
        motion(PAIRS[name], "1e-400").enclosure([K.coerce("1e400")], digits=5)


@pytest.mark.parametrize("name", PAIRS)
def test_integrals_of_pairs_beyond_floats(name) -> None:
    system = PAIRS[name](RR)
    for size in (1e100, 1e150, 1e200, 1e300):
        with pytest.raises(NotRepresentable, match=r"M = \(.*H and K are beyond the range of floats"):
            system.integrals(system.state([*map(float, GAMMA)], [size * float(x) for x in M]))
    assert np.isfinite(system.integrals(system.state([*map(float, GAMMA)], [1e60 * float(x) for x in M]))).all()


def test_moments_at_the_ends_of_floats() -> None:
    """1 − ds vanishes by rounding; a power of a_i overflows; products of the a_i underflow."""
    gamma, M = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)
    system = Tilde((1e-100, 2e-100, 3e-100), 1e99)
    with pytest.raises(NotRepresentable, match="divides by"):
        system.motion_through(system.state(gamma, M)).at([1e-100])
    system = Hat((1e-300, 2e-300, 3e-300))
    with pytest.raises(FieldError, match=r"e\+599.* is not finite"):
        _ = system.flow(system.state(gamma, M)).portrait
    system = Hat((1e160, 2e160, 3e160))
    with pytest.raises(NotRepresentable, match="divides by"):
        system.linearized(system.state(gamma, M))
