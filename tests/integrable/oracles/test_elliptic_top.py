"""The closed form of the Euler top against shipped trajectories, Taylor series, and itself at more digits."""

from __future__ import annotations

import json
from itertools import permutations
from pathlib import Path
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.oracles.elliptic_top import EllipticTop
from integrable.oracles.reference import taylor
from jacobian import MP
from jacobian.errors import ArgumentError

SCENE = json.loads((Path(__file__).parents[2] / "data" / "trajectories.json").read_text(encoding="utf-8"))["scenes"][
    "S2"
]
GAMMA, M = (0.48, 0.6, 0.64), (1.104, 2.18, -0.528)


def largest(found, wanted):
    pairs = ((found.gamma, wanted.gamma), (found.M, wanted.M))
    return max(abs(mpmath.mpf(x) - mpmath.mpf(y)) for a, b in pairs for x, y in zip(a.flat, b.flat, strict=True))


def top(inertia, gamma, M):
    """A top and a start of exactly these floats, |γ| = 1 or not."""
    return SimpleNamespace(inertia=inertia, d=0), SimpleNamespace(gamma=gamma, M=M)


def test_the_shipped_trajectory_to_its_digits():
    K = MP(45)
    system = EulerTop([K.coerce(x) for x in SCENE["I"]], field=K)
    state = system.state(*([K.coerce(x) for x in SCENE[key]] for key in ("gamma0", "M0")))
    found = EllipticTop(system, state, 45).at([int(T) for T in SCENE["states"]])
    with mpmath.workdps(50):
        for k, values in enumerate(SCENE["states"].values()):
            for got, wanted in ((found.gamma[k], values["gamma"]), (found.M[k], values["M"])):
                assert max(abs(x - mpmath.mpf(y)) for x, y in zip(got, wanted, strict=True)) < 1e-34


@pytest.mark.thinned(5)
@pytest.mark.parametrize("inertia", list(permutations((1.0, 2.0, 3.5))))
@pytest.mark.parametrize("seed", [0, 1, pytest.param(2, marks=pytest.mark.slow)])
def test_every_order_of_the_axes(inertia, seed):
    """M near the largest or the smallest axis, of either sign; γ not orthogonal to M; times of either sign."""
    rng = np.random.default_rng(seed)
    system, state = top(inertia, *rng.normal(size=(2, 3)).tolist())
    times = [0.7, -2.3, 0.0, 6.1]
    exact = taylor(system, state, times, digits=30)
    assert largest(EllipticTop(system, state).at(times), exact) < 1e-14
    with mpmath.workdps(40):
        assert largest(EllipticTop(system, state, 32).at(times), exact) < 1e-29


def test_floats_are_as_good_at_any_time():
    system, state = top((1.0, 2.0, 3.0), GAMMA, M)
    times = [1.0, 1e4, -1e8, 1e12]
    assert largest(EllipticTop(system, state).at(times), EllipticTop(system, state, 60).at(times)) < 2e-14


SPECIAL = {
    "two equal moments": ((1.0, 1.0, 2.0), M),
    "two others": ((2.0, 1.0, 2.0), M),
    "three": ((2.0, 2.0, 2.0), M),
    "permanent rotation": ((1.0, 2.0, 3.0), (0.0, 0.0, -1.7)),
    "about the middle axis": ((1.0, 2.0, 3.0), (0.0, 1.3, 0.0)),
    "at rest": ((1.0, 2.0, 3.0), (0.0, 0.0, 0.0)),
    "almost a permanent rotation": ((1.0, 2.0, 3.0), (1e-9, 1e-10, 2.0)),
    "almost the separatrix": ((1.0, 2.0, 4.0), (0.5, 1.0, 2**-0.5)),
    "M passes a plane of the axes": ((1.0, 2.0, 3.0), (0.0, 1.2, 1.5)),
    "M1 = M2 = 0 never, M3 = 0 at the start": ((1.0, 2.0, 3.0), (1.0, 0.4, 0.0)),
}


@pytest.mark.parametrize("far", [5.5, pytest.param(11.0, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", SPECIAL)
def test_special_motions(name, far):
    inertia, momentum = SPECIAL[name]
    system, state = top(inertia, GAMMA, momentum)
    times = [0.4, -3.0, far]
    exact = taylor(system, state, times, digits=25)
    bound = 1e-12 if "separatrix" in name else 1e-14
    assert largest(EllipticTop(system, state).at(times), exact) < bound
    with mpmath.workdps(40):
        assert largest(EllipticTop(system, state, 25).at(times), exact) < 1e-22


@pytest.mark.thinned(4)
@pytest.mark.parametrize("off", [0.0, 1e-15, -1e-15, 1e-12, 1e-6])
@pytest.mark.parametrize("sign", [1, -1])
def test_on_and_near_the_separatrix(off, sign):
    """(1/I1 − 1/I2)·M1² = (1/I2 − 1/I3)·M3² exactly at off = 0, where the functions are elementary."""
    system, state = top((1.0, 4.0, 16.0), (0.6, 0.0, 0.8), (1.5, -0.25, sign * 3.0 * (1 + off)))
    closed = EllipticTop(system, state, 30)
    assert (closed.parameter == 1) == (off == 0)
    times = [0.5, -2.0, 6.0]
    exact = taylor(system, state, times, digits=32)
    with mpmath.workdps(40):
        assert largest(closed.at(times), exact) < 1e-26
    assert largest(EllipticTop(system, state).at(times), exact) < 1e-13


def test_refusals():
    ball = ChaplyginBall((1, 2, 3), 0.7)
    with pytest.raises(ArgumentError, match=r"d = 0\.7: the closed form is that of the Euler top"):
        EllipticTop(ball, ball.state(GAMMA, (0.384, 1.28, -1.488)))
    with pytest.raises(ArgumentError, match="digits = 0: give a positive number"):
        EllipticTop(*top((1, 2, 3), GAMMA, M), 0)
